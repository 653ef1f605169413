# SPDX-License-Identifier: BSD-3-Clause
"""Opens a log of either format and finds the sensor that is meant."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sepcal import _core
from sepcal.logs import dataflash, ulog
from sepcal.logs.dataflash_binary import looks_like_binary
from sepcal.logs.dataflash_messages import START
from sepcal.logs.dataflash_text import looks_like_text
from sepcal.logs.recording import MAGNETOMETER, Recording, Sensor
from sepcal.logs.ulog_topics import HEADER, MAGIC

DAMAGES = (LookupError, ValueError, TypeError, ArithmeticError, np.linalg.LinAlgError)


def quiet(_: str) -> None:
    """Progress that nobody watches."""


def open_log(
    file: str, cut_off: bool = False, progress: Callable[[str], None] = quiet
) -> Recording:
    """Reads a log.

    Raises:
        Error: No such file, another format, cut off (unless `cut_off`), damaged beyond reading, no
            pyulog or pymavlink.
    """
    try:
        with open(file, "rb") as opened:
            start = opened.read(START)
    except OSError as error:
        raise _core.Error(f"{file}: can't be read: {error.strerror}") from error
    if start.startswith(MAGIC):
        if len(start) < HEADER:
            raise _core.Error(f"{file}: the log is cut off inside its header; nothing is in it")
        read = ulog.read
    elif looks_like_binary(start) or looks_like_text(start):
        read = dataflash.read
    else:
        raise _core.Error(f"{file}: {_guess(start)}")
    try:
        with np.errstate(all="ignore"):
            return read(file, cut_off, progress)
    except _core.Error:
        raise
    except DAMAGES as error:
        raise _core.Error(f"{file}: damaged beyond reading: {error!r}") from error


def choose_sensor(log: Recording, name: str | None) -> Sensor:
    """The sensor of this name, by default the first.

    Raises:
        Error: No such sensor, or one that can't be calibrated from this log.
    """
    if not log.sensors:
        wanted = (
            "sensor_mag, vehicle_magnetometer, sensor_combined.magnetometer_ga, "
            "differential_pressure and airspeed"
            if log.form == "ULog"
            else "MAG and ARSP"
        )
        raise _core.Error(
            f"{log.file}: nothing to calibrate: of {wanted} no message with readings is logged"
        )
    names = [sensor.name for sensor in log.sensors]
    if name is not None and name not in names:
        raise _core.Error(f"{log.file}: there is no sensor '{name}'; it has {', '.join(names)}")
    sensor = log.sensors[names.index(name) if name is not None else 0]
    if lacking := find_lacking(log, sensor):
        others = [s.name for s in log.sensors if not find_lacking(log, s)]
        instead = f"; --sensor {others[0]} could" if others else ""
        raise _core.Error(
            f"{log.file}: {sensor.name} can't be calibrated: {lacking} is logged{instead}"
        )
    return sensor


def find_lacking(log: Recording, sensor: Sensor) -> str:
    """Without what a sensor can't be calibrated; nothing where it can."""
    if sensor.kind == MAGNETOMETER:
        return ""
    if log.velocity is None and log.position is None:
        return "neither velocity over the ground nor position"
    drivers = {**log.drivers, **sensor.own}
    if sensor.header == "dp_pa" and "rho_kgpm3" not in drivers:
        missing = [h for h in ("ps_pa", "temp_degc") if h not in drivers]
        if missing:
            return f"no {' and no '.join(missing)} for the density"
    return ""


def _guess(start: bytes) -> str:
    if not start:
        return "the file is empty"
    if start[8:9] in (b"\xfd", b"\xfe"):
        return "a telemetry log (.tlog); give the one that the vehicle wrote (.bin or .ulg)"
    if b"\0" not in start and b"," in start.splitlines()[0]:
        return "a table as text, not a log; the apps read CSV files themselves: sepcal-mag check"
    return "neither a ULog (.ulg) nor a DataFlash log (.bin)"
