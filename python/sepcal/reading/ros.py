# SPDX-License-Identifier: BSD-3-Clause
"""ROS's own messages in sepcal's columns: units by their definitions, axes by REP 103.

REP 103 has the body's axes forward, left and up and the world's east, north and up; a frame whose
name ends in _ned or _frd has sepcal's.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sepcal.columns import Array

TURNED = "axes forward, left, up (REP 103) are turned to forward, right, down"
WORLD = "axes east, north, up (REP 103) are turned to north, east, down"
SCALARS = {
    "FluidPressure": ("fluid_pressure", "ps_pa"),
    "Temperature": ("temperature", "temp_degc"),
}
HALF = np.sqrt(0.5)


def known_columns(
    kind: str, columns: Mapping[str, Array], frame: str
) -> tuple[dict[str, Array], set[str], str]:
    """Columns by sepcal's headers, the fields they are of, and what was done.

    Args:
        kind: The message's type, "sensor_msgs/msg/Imu".
        columns: Its fields.
        frame: header.frame_id.
    """
    name = kind.rpartition("/")[2]
    is_ned = frame.lower().endswith(("_ned", "_frd"))
    sign = 1.0 if is_ned else -1.0
    if name == "MagneticField" and _has(columns, "magnetic_field"):
        x, y, z = (columns[f"magnetic_field.{axis}"] * 1e6 for axis in "xyz")
        note = "magnetic_field in T is read as mx_ut, my_ut, mz_ut"
        found = {"mx_ut": x, "my_ut": sign * y, "mz_ut": sign * z}
        return found, _fields("magnetic_field", "xyz"), note + ("" if is_ned else f"; {TURNED}")
    if name == "Imu":
        return _imu(columns, is_ned)
    if name == "NavSatFix" and {"latitude", "longitude"} <= set(columns):
        found = {"lat_deg": columns["latitude"], "lon_deg": columns["longitude"]}
        if "altitude" in columns:
            found["altitude_m"] = columns["altitude"]
        return found, {"latitude", "longitude", "altitude"}, ""
    if name in ("TwistStamped", "Vector3Stamped", "TwistWithCovarianceStamped"):
        return _velocity(columns, frame, is_ned)
    if name in SCALARS and SCALARS[name][0] in columns:
        field, header = SCALARS[name]
        return {header: columns[field]}, {field}, ""
    return {}, set(), ""


def _imu(columns: Mapping[str, Array], is_ned: bool) -> tuple[dict[str, Array], set[str], str]:
    sign = 1.0 if is_ned else -1.0
    found: dict[str, Array] = {}
    taken: set[str] = set()
    if _has(columns, "angular_velocity"):
        x, y, z = (columns[f"angular_velocity.{axis}"] for axis in "xyz")
        found |= {"p_radps": x, "q_radps": sign * y, "r_radps": sign * z}
        taken |= _fields("angular_velocity", "xyz")
    if _has(columns, "orientation", "wxyz"):
        w, x, y, z = (columns[f"orientation.{axis}"] for axis in "wxyz")
        if np.any(w != 0) or np.any(x != 0):
            q = (w, x, y, z) if is_ned else _to_ned(w, x, y, z)
            found |= dict(zip(("qw", "qx", "qy", "qz"), q, strict=True))
            taken |= _fields("orientation", "wxyz")
    return found, taken, "" if is_ned or not found else f"{TURNED}, and {WORLD}"


def _velocity(
    columns: Mapping[str, Array], frame: str, is_ned: bool
) -> tuple[dict[str, Array], set[str], str]:
    """Over the ground, in the world's axes; one in the body's stays as it is."""
    start = next(
        (s for s in ("twist.twist.linear", "twist.linear", "vector") if _has(columns, s)), ""
    )
    if not start or any(word in frame.lower() for word in ("base", "body", "imu")):
        return {}, set(), ""
    x, y, z = (columns[f"{start}.{axis}"] for axis in "xyz")
    north, east, down = (x, y, z) if is_ned else (y, x, -z)
    found = {"vn_mps": north, "ve_mps": east, "vd_mps": down}
    note = f"{start} is read as the velocity vn_mps, ve_mps, vd_mps"
    return found, _fields(start, "xyz"), note + ("" if is_ned else f"; {WORLD}")


def _to_ned(w: Array, x: Array, y: Array, z: Array) -> tuple[Array, Array, Array, Array]:
    """Body to world, both turned: (0, 1, 1, 0) / sqrt 2 times q times (0, 1, 0, 0)."""
    turned = HALF * (-x - y), HALF * (w + z), HALF * (w - z), HALF * (y - x)
    a, b, c, d = turned
    return -b, a, d, -c


def _has(columns: Mapping[str, Array], start: str, axes: str = "xyz") -> bool:
    return all(f"{start}.{axis}" in columns for axis in axes)


def _fields(start: str, axes: str) -> set[str]:
    return {f"{start}.{axis}" for axis in axes}
