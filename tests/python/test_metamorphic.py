# SPDX-License-Identifier: BSD-3-Clause
"""What must not matter to an estimate: from when on time is counted, units, axes, where files end.

Of a ramp's start, 1.7e9 s, the last digit is 2.4e-7 s: no estimate of it can move by less, and the
others follow.
"""

from collections.abc import Iterable, Mapping

import numpy as np
import pytest

import sepcal
from sepcal.columns import Array
from shifts import largest_shift
from studies.hidden_effects.cases import PROBES

EPOCH = 1.7e9  # [s] a stamp of today, counted from 1970
EFFECTS = [
    (),
    ("time_offset",),
    ("pneumatic_lag",),
    ("wind[delay(throttle)]",),
    ("airspeed_bias[time^2]",),
    ("airspeed_bias[spline(time,6)]",),
    ("airspeed_bias[spline(time,7)]", "time_offset"),
    ("airspeed_bias[step(time)]",),
    ("airspeed_bias[decay(time)]",),
    ("icing_ramp",),
    ("icing_ramp", "time_offset"),
]
SIMULATED = [  # with time in it, each with what is hidden
    ("five-hole", "wind[time]", (0.02, -0.01)),
    ("five-hole", "time_offset", 0.08),
    ("pitot-static", "wind[time]", 0.03),
    ("pitot-static", "pneumatic_lag", 0.1),
    ("magnetometer", "bias[time]", 0.02),
    ("magnetometer", "sensor_lag", 0.06),
]

Columns = dict[str, Array]


def fly(start: float, step: float, hide: Mapping[str, float] | None = None) -> sepcal.Flight:
    """A tube's flight whose rows are `step` seconds apart, the first at `start`."""
    columns = dict(sepcal.simulate("pitot-static", hide=hide, rows=600, seed=3))
    columns["time_s"] = start + step * np.arange(600)
    return sepcal.Flight(columns)


def shifted_by(flight: sepcal.Flight, other: sepcal.Flight, effects: tuple[str, ...]) -> float:
    """The largest shift between two fits, the other's time counted from EPOCH before."""
    first, second = (
        sepcal.fit(sepcal.PitotStatic(), at, effects=effects) for at in (flight, other)
    )
    times = {name: first[name].value + EPOCH for name in first.names if name.endswith(".t0")}
    return largest_shift(first, second, times)


def hidden(effects: Iterable[str]) -> dict[str, float] | None:
    """A ramp that begins somewhere: without one its start is where noise has it."""
    return {"icing_ramp": -0.003} if "icing_ramp" in effects else None


@pytest.mark.parametrize("effects", EFFECTS, ids=lambda effects: " ".join(effects) or "none")
def test_stamps_of_today_in_binary_fractions(effects: tuple[str, ...]):
    """1/64 s at 1.7e9 s has every bit."""
    tolerance = 1e-6 if "icing_ramp" in effects else 1e-9
    at = (fly(start, 1 / 64, hidden(effects)) for start in (0.0, EPOCH))
    assert shifted_by(*at, effects) < tolerance


@pytest.mark.parametrize("effects", EFFECTS, ids=lambda effects: " ".join(effects) or "none")
def test_stamps_of_today_in_decimals(effects: tuple[str, ...]):
    """A stamp is then off by 1e-7 s, a step of time by 5e-6 of itself."""
    at = (fly(start, 0.02, hidden(effects)) for start in (0.0, EPOCH))
    assert shifted_by(*at, effects) < 1e-4


def simulate(probe: str, effect: str, size: float | tuple[float, ...]) -> Columns:
    sizes = list(np.atleast_1d(size))
    return dict(sepcal.simulate(probe, hide={effect: sizes}, rows=400, seed=5))


def fit(probe: str, columns: Columns, effect: str) -> sepcal.Fit:
    return sepcal.fit(PROBES[probe], sepcal.Flight(columns), effects=(effect,))


OTHER_UNITS = {  # of a header's last part: its unit elsewhere, and how many of it there are
    "s": ("ms", 1e3, 0.0),
    "mps": ("kt", 3600.0 / 1852.0, 0.0),
    "rad": ("deg", 180.0 / np.pi, 0.0),
    "radps": ("degps", 180.0 / np.pi, 0.0),
    "pa": ("hpa", 0.01, 0.0),
    "ut": ("nt", 1e3, 0.0),
    "k": ("degc", 1.0, -273.15),
}


@pytest.mark.parametrize(("probe", "effect", "size"), SIMULATED)
def test_units(probe: str, effect: str, size: float | tuple[float, ...]):
    """The same log in knots, degrees, hectopascals, nanotesla, milliseconds."""
    columns = simulate(probe, effect, size)
    others = {}
    for header, values in columns.items():
        name, _, unit = header.rpartition("_")
        other, factor, offset = OTHER_UNITS.get(unit, (unit, 1.0, 0.0))
        others[f"{name}_{other}" if name else header] = values * factor + offset
    assert largest_shift(fit(probe, columns, effect), fit(probe, others, effect), {}) < 1e-9


def turn_horizontally(pair: tuple[Array, Array] | tuple[float, float], angle: float):
    """North and east of a frame that is turned back by `angle` [rad]; right angles are exact."""
    north, east = pair
    cos, sin = np.cos(angle), np.sin(angle)
    if angle == np.pi / 2:
        cos, sin = 0.0, 1.0
    return cos * north - sin * east, sin * north + cos * east


@pytest.mark.parametrize(("probe", "effect", "size"), SIMULATED)
def test_a_navigation_frame_that_is_turned(
    probe: str, effect: str, size: float | tuple[float, ...]
):
    """Velocities, fields and headings turn, and the wind with them; what the probe is does not.

    A five-hole probe's outputs have each a noise of their own: by right angles alone.
    """
    angle = np.pi / 2 if probe == "five-hole" else 0.7
    columns = simulate(probe, effect, size)
    turned = dict(columns)
    turned["yaw_rad"] = columns["yaw_rad"] + angle
    for pair in (("vn_mps", "ve_mps"), ("bn_ut", "be_ut")):
        if pair[0] in columns:
            values = turn_horizontally((columns[pair[0]], columns[pair[1]]), angle)
            turned |= dict(zip(pair, values, strict=True))
    first = fit(probe, columns, effect)
    winds = {}
    for pair in (("w_n", "w_e"), ("wind[time].n", "wind[time].e")):
        if pair[0] in first.names:
            values = turn_horizontally((first[pair[0]].value, first[pair[1]].value), angle)
            winds |= dict(zip(pair, values, strict=True))
    assert largest_shift(first, fit(probe, turned, effect), winds) < 1e-9


@pytest.mark.parametrize("effect", ["bias[time]", "sensor_lag"])
def test_the_axes_of_a_magnetometer_in_another_order(effect: str):
    """x, y, z are called y, z, x: the same sensor, its parameters renamed."""
    size = 0.02 if effect == "bias[time]" else 0.06
    flight = dict(simulate("magnetometer", effect, size))
    roll, pitch, yaw = (flight.pop(name) for name in ("roll_rad", "pitch_rad", "yaw_rad"))
    field = np.stack([flight.pop(name) for name in ("bn_ut", "be_ut", "bd_ut")])
    columns = flight | dict(
        zip(("hx_ut", "hy_ut", "hz_ut"), to_body(roll, pitch, yaw, field), strict=True)
    )
    after = {"x": "y", "y": "z", "z": "x"}
    turned = dict(columns)
    for axis, other in after.items():
        for kind in ("m", "h"):
            turned[f"{kind}{other}_ut"] = columns[f"{kind}{axis}_ut"]
    first = fit("magnetometer", columns, effect)
    second = fit("magnetometer", turned, effect)
    expected = {renamed_axes(name, after): first[name].value for name in first.names}
    assert expected.keys() == set(first.names)
    assert largest_shift(first, second, expected) < 1e-9


def renamed_axes(name: str, after: Mapping[str, str]) -> str:
    """lambda_x becomes lambda_y, alpha_xz becomes alpha_xy."""
    stem, mark, axes = name.rpartition("." if "." in name else "_")
    if not mark or any(axis not in after for axis in axes):
        return name
    return stem + mark + "".join(sorted(after[axis] for axis in axes))


def to_body(roll: Array, pitch: Array, yaw: Array, field: Array) -> Array:
    """From navigation to body axes, turn by turn: yaw, pitch, roll; shape (3, N)."""
    x, y, z = field
    x, y = np.cos(yaw) * x + np.sin(yaw) * y, np.cos(yaw) * y - np.sin(yaw) * x
    x, z = np.cos(pitch) * x - np.sin(pitch) * z, np.sin(pitch) * x + np.cos(pitch) * z
    y, z = np.cos(roll) * y + np.sin(roll) * z, np.cos(roll) * z - np.sin(roll) * y
    return np.stack([x, y, z])
