# SPDX-License-Identifier: BSD-3-Clause
"""A calibration as what a vehicle loads: a header in C or C++, or an autopilot's parameters."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, Literal

from sepcal import _core
from sepcal.arguments import checked
from sepcal.calibration import Calibration, Path
from sepcal.flight import AnyFlight, to_flight_of
from sepcal.whole_files import name_of

Target = Literal["c", "cpp", "px4", "ardupilot"]


class Exported(_core.Exported):
    """The result of export(): what was written and what the vehicle's correction lacks.

    Example:
        >>> flight = sepcal.datasets.load("magnetometer")
        >>> base = sepcal.fit(sepcal.Magnetometer(), flight)
        >>> written = sepcal.export(base, folder / "compass.h", to="c")
        >>> written.to_dict()["to"]
        'c'
    """

    def __str__(self) -> str:
        return self.page

    def to_json(self) -> str:
        """The JSON that the app's export prints.

        Example:
            >>> flight = sepcal.datasets.load("magnetometer")
            >>> base = sepcal.fit(sepcal.Magnetometer(), flight)
            >>> sepcal.export(base, folder / "compass.h", to="c").to_json().startswith("{")
            True
        """
        return self.json

    def to_dict(self) -> dict[str, Any]:
        """The same as a dictionary; None where a number is undefined.

        Example:
            >>> flight = sepcal.datasets.load("magnetometer")
            >>> base = sepcal.fit(sepcal.Magnetometer(), flight)
            >>> sepcal.export(base, folder / "compass.param", to="ardupilot").to_dict()["to"]
            'ardupilot'
        """
        read: dict[str, Any] = json.loads(self.json)
        return read


@checked
def export(
    calibration: Calibration,
    file: Path,
    to: Target | str,
    *,
    flight: AnyFlight | None = None,
    sensor: int | None = None,
    device_id: int | None = None,
    mounting: Sequence[float] | None = None,
    in_use: float | None = None,
    logged_airspeed: Literal["true", "equivalent"] | str = "true",
    airspeed_sensor: Literal["membrane", "sdp3x"] | str | None = None,
    cal_air: Sequence[float] | None = None,
    without: Sequence[str] = (),
    force: bool = False,
    rotation: Literal["keep", "refit"] | str | None = None,
    single: bool = False,
) -> Exported:
    """Writes what a vehicle loads of a calibration; the file appears whole or not at all.

    An autopilot holds less than a calibration: the best that it holds is kept of it or fitted to
    the flight, and `loss` says what that costs.

    Args:
        calibration: Calibration of a magnetometer, a Pitot-static tube or, for a header, a
            five-hole probe.
        file: To write.
        to: "c" or "cpp", a header with the whole correction; "px4" or "ardupilot", parameters.
        flight: To fit anew and to compare on [the one that was fitted].
        sensor: Which, as the autopilot counts [its first]; of a header, its names end so.
        device_id: For PX4, the sensor's CAL_MAGn_ID, or the pressure sensor's id, which says its
            kind.
        mounting: For PX4, roll, pitch, yaw [deg] by which the flight's readings were turned, for
            CAL_MAGn_ROT.
        in_use: For a logged airspeed, the ARSPD_RATIO or ASPD_SCALE_n in use then.
        logged_airspeed: Its kind: "true", or "equivalent", which autopilots call indicated.
        airspeed_sensor: For a tube, "membrane" or "sdp3x" (SDP31, 32, 33) [by device_id or the
            log].
        cal_air: For PX4 with an SDP3x, its CAL_AIR_CMODEL, CAL_AIR_TUBELEN [m] and CAL_AIR_TUBED_MM
            [mm] [the log's, else 0, 0.2, 1.5].
        without: Effects to leave out; the rest is fitted anew.
        force: Exports also what did not converge, is not all determined, or is at a bound.
        rotation: For a magnetometer on an autopilot, which can't turn it: "keep", the calibration
            as it is less its rotation, or "refit", the symmetric matrix that fits the flight best
            [the better by its largest error of heading; without a flight "keep"].
        single: For a header: it computes in float, for a processor without double.

    Raises:
        Error: A calibration that no vehicle should load, an effect that the vehicle can't follow, a
            value beyond what the autopilot takes, a flight that is needed and not there.

    Example:
        >>> flight = sepcal.datasets.load("magnetometer")
        >>> base = sepcal.fit(sepcal.Magnetometer(), flight)
        >>> sepcal.export(base, folder / "compass.h", to="c").notes
        []
    """
    chosen = calibration.flight
    if flight is not None:
        chosen = to_flight_of(calibration.core, flight, "export(..., flight=")
    turned = None if mounting is None else [float(angle) for angle in mounting]
    if turned is not None and len(turned) != 3:
        raise _core.Error("mounting is not three angles; give roll, pitch, yaw in degrees")
    air = None if cal_air is None else [float(value) for value in cal_air]
    if air is not None and len(air) != 3:
        raise _core.Error(
            "cal_air is not three numbers; give CAL_AIR_CMODEL, CAL_AIR_TUBELEN, CAL_AIR_TUBED_MM"
        )
    if isinstance(without, str):
        raise _core.Error(f"without is the text {without!r}; give a list of effects")
    written = _core.export_to_file(
        calibration.core,
        name_of(file),
        to,
        None if chosen is None else chosen._core,
        sensor,
        device_id,
        turned,
        in_use,
        logged_airspeed,
        airspeed_sensor,
        air,
        list(without),
        force,
        rotation,
        single,
    )
    return Exported(written)
