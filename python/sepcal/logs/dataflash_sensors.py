# SPDX-License-Identifier: BSD-3-Clause
"""The compasses and tubes of a DataFlash log."""

from __future__ import annotations

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.logs import ardupilot_compass
from sepcal.logs.dataflash_columns import Messages
from sepcal.logs.dataflash_messages import DataFlash
from sepcal.logs.parameters import Parameters
from sepcal.logs.recording import MAGNETOMETER, TUBE, Channel, Sensor, make_channel

MILLIGAUSS = 10.0  # to a microtesla
SDP3X = 6  # of ARSPD_TYPE
DEFAULT_RATIO = 1.9936  # of ARSPD_RATIO
KELVIN = 273.15
LATEST = 0.5  # [s]: a reading's own stamp may be so much older than its message's


def read_compasses(log: DataFlash, parameters: Parameters) -> list[Sensor]:
    """Magnetometers as the raw sensors read, in body axes."""
    sensors = []
    for instance, messages in enumerate(log.instances("MAG", "MAG2", "MAG3")):
        if not all(f"Mag{axis}" in messages for axis in "XYZ"):
            continue
        field = _vectors(messages, "Mag")
        if not field.any():
            continue  # no compass there
        offsets = _vectors(messages, "Ofs")
        motors = _vectors(messages, "MOfs") if "MOfsX" in messages else _vectors(messages, "MO")
        times, stamped = _reading_times(messages, log.times(messages))
        suffix = ardupilot_compass.find_set(parameters, instance, offsets)
        raw, undone = ardupilot_compass.undo(field, offsets, motors, times, parameters, suffix)
        done = (*stamped, *(undone or ("the autopilot corrected nothing",)))
        if parameters.first("COMPASS_MOTCT") and "MOfsX" not in messages and "MOX" not in messages:
            done += ("the motors' field was taken off and isn't logged: that stays",)
        source = f"{messages.name}.MagX, MagY, MagZ"
        channel = make_channel(source, times, raw / MILLIGAUSS, (*done, "mG to uT"))
        if channel is None:
            continue
        device = parameters.first(f"COMPASS_DEV_ID{suffix}")
        title = f"device {device:.0f}" if device else ""
        sensors.append(Sensor(f"mag{instance}", MAGNETOMETER, channel, title=title))
    return sensors


def _vectors(messages: Messages, name: str) -> Array:
    """X, Y and Z of a name, (n, 3); zeros where they aren't logged."""
    columns = [f"{name}{axis}" for axis in "XYZ"]
    if not all(column in messages for column in columns):
        return np.zeros((len(messages), 3))
    return np.stack([messages[column] for column in columns], axis=-1)


def _reading_times(messages: Messages, times: Array) -> tuple[Array, tuple[str, ...]]:
    """When the readings were taken, S [us, 32 bits], where it fits the messages' own times."""
    if "S" not in messages or messages.letters["S"] not in "IQ":
        return times, ()
    late = np.mod(np.round(times * 1e6) - messages["S"], 2.0**32) / 1e6
    if not (late < LATEST).mean() > 0.9:
        return times, ()
    taken = np.where(late < LATEST, np.round((times - late) * 1e6) / 1e6, np.nan)
    before = f"{np.median(late) * 1e3:.3g} ms before TimeUS"
    return taken, (f"at the time S of the reading, {before}",)


def read_tubes(log: DataFlash, parameters: Parameters) -> list[Sensor]:
    """Pitot-static tubes by the differential pressure at their sensors."""
    sensors = []
    for instance, messages in enumerate(log.instances("ARSP", "ASP2")):
        if "DiffPress" not in messages or not messages["DiffPress"].any():
            continue
        times = log.times(messages)
        name = "ARSPD" if instance == 0 else f"ARSPD{instance + 1}"
        kind = f"{name}_TYPE"
        pressure = messages["DiffPress"]
        done: tuple[str, ...] = ()
        if parameters.first(kind) == SDP3X:
            pressure, done = _undo_flow(log, messages, times, parameters, name)
        done += (
            "less the offset that the autopilot found on the ground",
            "no ratio: ARSPD_RATIO makes the autopilot's airspeed of it",
        )
        channel = make_channel(f"{messages.name}.DiffPress", times, pressure, done)
        if channel is None:
            continue
        own = {}
        if "Temp" in messages and messages["Temp"].any():
            warm = make_channel(f"{messages.name}.Temp", times, messages["Temp"])
            if warm is not None:
                own["temp_degc"] = warm
        title = ""
        if kind in parameters:
            types = parameters.at(kind, channel.times)
            own["arspd_type"] = Channel(kind, channel.times, types[:, None])
            title = f"{kind} {types[0]:.0f}"
        sensors.append(Sensor(f"pitot{instance}", TUBE, channel, "dp_pa", own, title))
    return sensors


def _undo_flow(
    log: DataFlash, messages: Messages, times: Array, parameters: Parameters, name: str
) -> tuple[Array, tuple[str, ...]]:
    """The pressure at an SDP3x, to which ArduPilot's driver added what the flow loses, and how."""
    baro = log.first_of(("BARO",), "Press")
    if baro is None or "Temp" not in messages:
        said = "what the flow through the sensor loses stays in it: no BARO.Press or Temp undoes it"
        return messages["DiffPress"], (said,)
    ratio = parameters.at(f"{name}_RATIO", times, DEFAULT_RATIO)
    static = np.interp(times, baro.times, baro.values[:, 0])
    handed_on = messages["DiffPress"]
    raw = _core.sdp3x_pressure(np.abs(handed_on), ratio, static, messages["Temp"] + KELVIN)
    return np.copysign(raw, handed_on), (
        f"undone: what ArduPilot adds for the flow through an SDP3x, by {ratio[0]:g} as the ratio",
    )
