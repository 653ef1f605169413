# SPDX-License-Identifier: BSD-3-Clause
"""The compasses and tubes of a DataFlash log."""

from __future__ import annotations

import numpy as np

from sepcal.columns import Array
from sepcal.logs import ardupilot_compass
from sepcal.logs.dataflash_columns import Messages
from sepcal.logs.dataflash_messages import DataFlash
from sepcal.logs.parameters import Parameters
from sepcal.logs.recording import MAGNETOMETER, TUBE, Sensor, make_channel

MILLIGAUSS = 10.0  # to a microtesla
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


def read_tubes(log: DataFlash) -> list[Sensor]:
    """Pitot-static tubes by their differential pressure."""
    sensors = []
    for instance, messages in enumerate(log.instances("ARSP", "ASP2")):
        if "DiffPress" not in messages or not messages["DiffPress"].any():
            continue
        done = (
            "less the offset that the autopilot found on the ground",
            "no ratio: ARSPD_RATIO makes the autopilot's airspeed of it",
        )
        times = log.times(messages)
        source = f"{messages.name}.DiffPress"
        channel = make_channel(source, times, messages["DiffPress"], done)
        if channel is None:
            continue
        own = {}
        if "Temp" in messages and messages["Temp"].any():
            warm = make_channel(f"{messages.name}.Temp", times, messages["Temp"])
            if warm is not None:
                own["temp_degc"] = warm
        sensors.append(Sensor(f"pitot{instance}", TUBE, channel, "dp_pa", own))
    return sensors
