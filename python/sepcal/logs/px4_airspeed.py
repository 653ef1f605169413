# SPDX-License-Identifier: BSD-3-Clause
"""PX4's settings of a tube's pressure sensor: its kind, and those for one with a flow.

An export to PX4 asks for both, so that they go with the readings as columns.
"""

from __future__ import annotations

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.logs.parameters import Parameters
from sepcal.logs.recording import Channel

SETTINGS = {  # of an SDP3x: column, parameter, PX4's default
    "cal_air_cmodel": ("CAL_AIR_CMODEL", 0.0),
    "cal_air_tubelen_m": ("CAL_AIR_TUBELEN", 0.2),
    "cal_air_tubed_mm": ("CAL_AIR_TUBED_MM", 1.5),
}
VENTURI = 3  # CAL_AIR_CMODEL of a sensor whose ports are the other way round


def describe(
    device: int, readings: Channel, parameters: Parameters
) -> tuple[Channel, dict[str, Channel], str]:
    """The readings with the sign of a tube's, the vehicle's settings as columns, and a title.

    `device` is 0 where the log doesn't say it.
    """
    times = readings.times
    if parameters.first("CAL_AIR_CMODEL") == VENTURI:
        done = (*readings.done, "with the sign changed, as CAL_AIR_CMODEL is 3")
        readings = Channel(readings.source, times, -readings.values, done)
    if device == 0:
        return readings, {}, ""
    columns = {"air_device_id": _column("device_id", times, np.full(times.shape, float(device)))}
    known = _core.px4_pressure_sensor(device)
    if known is None:
        return readings, columns, f"device {device}"
    name, has_flow = known
    if has_flow:
        for header, (parameter, default) in SETTINGS.items():
            columns[header] = _column(parameter, times, parameters.at(parameter, times, default))
    return readings, columns, f"device {device}, {name}"


def _column(source: str, times: Array, values: Array) -> Channel:
    return Channel(source, times, values[:, None])
