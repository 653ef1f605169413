# SPDX-License-Identifier: BSD-3-Clause
"""ArduPilot's DataFlash logs, of old (TimeMS, EKF1, MAG2) and new (TimeUS, XKF1, MAG with I)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sepcal.columns import Array
from sepcal.logs import clock, modes
from sepcal.logs.attitude import from_euler
from sepcal.logs.dataflash_columns import Messages
from sepcal.logs.dataflash_messages import DataFlash
from sepcal.logs.dataflash_sensors import read_compasses, read_tubes
from sepcal.logs.parameters import Parameters
from sepcal.logs.recording import (
    Channel,
    Labels,
    Recording,
    Utc,
    make_channel,
)
from sepcal.logs.words import one_line

FIX_3D = 3
ARMED, DISARMED = 10, 11  # of EV
VEHICLES = ("Copter", "Plane", "Rover", "Sub", "Tracker", "Blimp")


def read(file: str, cut_off: bool, progress: Callable[[str], None]) -> Recording:
    """The log. Raises Error for one that can't be read."""
    log = DataFlash(file, cut_off, progress)
    vehicle = _find_vehicle(log)
    parameters = _read_parameters(log)
    notes = []
    if log.damaged:
        notes.append(f"{log.damaged} bytes between the messages are damaged and were skipped")
    if log.torn:
        notes.append(f"the log is cut off inside {log.torn}; what is whole before it is used")
    ends = [t for m in log.by_name.values() if (t := _spread(log, m)) is not None]
    span = (min(e[0] for e in ends), max(e[1] for e in ends)) if ends else (0.0, 0.0)
    return Recording(
        file=file,
        form="DataFlash",
        vehicle=vehicle,
        span=span,
        sensors=(*read_compasses(log, parameters), *read_tubes(log, parameters)),
        attitude=_read_attitude(log),
        velocity=_read_velocity(log, parameters),
        rates=log.first_of(("IMU",), "GyrX", "GyrY", "GyrZ", done="the gyroscope's own bias stays"),
        position=_read_position(log),
        drivers=_read_drivers(log, vehicle),
        labels=_read_labels(log, vehicle),
        utc=_read_utc(log),
        notes=tuple(notes),
    )


def _spread(log: DataFlash, messages: Messages) -> tuple[float, float] | None:
    if messages.first("TimeUS", "TimeMS") is None or messages.name.startswith(("GPS", "CAM")):
        return None
    times = log.times(messages)
    return float(times.min()), float(times.max())


def _find_vehicle(log: DataFlash) -> str:
    messages = log["MSG"]
    for text in messages.texts("Message") if messages is not None and "Message" in messages else ():
        if any(vehicle in text for vehicle in VEHICLES):
            return one_line(text)
    return ""


def _read_parameters(log: DataFlash) -> Parameters:
    messages = log["PARM"]
    if messages is None or "Name" not in messages or "Value" not in messages:
        return Parameters(())
    times = log.times(messages)
    return Parameters(zip(times, messages.texts("Name"), messages["Value"], strict=True))


def _read_attitude(log: DataFlash) -> Channel | None:
    for name in ("ATT", "XKF1", "NKF1", "EKF1", "AHR2"):
        angles = log.first_of((name,), "Roll", "Pitch", "Yaw")
        if angles is not None:
            done = ("Euler angles from the autopilot's own filter",)
            q = from_euler(np.radians(angles.values))
            return Channel(angles.source, angles.times, q, (*angles.done, *done))
    return None


def _read_velocity(log: DataFlash, parameters: Parameters) -> Channel | None:
    """The velocity of the filter that flew, its primary core; otherwise that of the GPS."""
    order = ("XKF1", "NKF1", "EKF1")
    if parameters.first("AHRS_EKF_TYPE") == 2:
        order = ("NKF1", "XKF1", "EKF1")
    for name in order:
        messages = log[name]
        if messages is None or not all(column in messages for column in ("VN", "VE", "VD")):
            continue
        said: tuple[str, ...] = ()
        if "C" in messages:
            core = _primary_core(log, name[:3] + "4")
            cores = messages["C"]
            core = core if (cores == core).any() else cores[0]
            messages = messages.where(cores == core)
            said = (f"of core {core:.0f}, the primary one",)
        values = np.stack([messages[column] for column in ("VN", "VE", "VD")], axis=-1)
        if values.any():
            return make_channel(f"{name}.VN, VE, VD", log.times(messages), values, said)
    for messages in log.instances("GPS", "GPS2"):
        speed, course = messages.first("Spd", "SPD"), messages.first("GCrs")
        if speed and course and "VZ" in messages:
            fixed = (
                messages["Status"] >= FIX_3D
                if "Status" in messages
                else np.isfinite(messages[course])
            )
            track = np.radians(messages[course])
            values = np.stack(
                (
                    messages[speed] * np.cos(track),
                    messages[speed] * np.sin(track),
                    messages["VZ"],
                ),
                axis=-1,
            )
            source = f"{messages.name}.{speed}, {course}, VZ"
            channel = make_channel(source, log.times(messages)[fixed], values[fixed])
            if channel is not None:
                return channel
    return None


def _primary_core(log: DataFlash, name: str) -> float:
    messages = log[name]
    if messages is None or "PI" not in messages:
        return 0.0
    cores, counts = np.unique(messages["PI"], return_counts=True)
    return float(cores[np.argmax(counts)])


def _read_position(log: DataFlash) -> Channel | None:
    for messages in log.instances("GPS", "GPS2"):
        if not all(column in messages for column in ("Lat", "Lng", "Alt")):
            continue
        values = np.stack([messages[column] for column in ("Lat", "Lng", "Alt")], axis=-1)
        fixed = values[:, :2].any(axis=1)
        if "Status" in messages:
            fixed &= messages["Status"] >= FIX_3D
        if fixed.any():
            source = f"{messages.name}.Lat, Lng, Alt"
            return make_channel(source, log.times(messages)[fixed], values[fixed])
    return None


def _read_drivers(log: DataFlash, vehicle: str) -> dict[str, Channel]:
    found = {
        "altitude_m": log.first_of(("BARO",), "Alt") or log.first_of(("GPS",), "Alt"),
        "ps_pa": log.first_of(("BARO",), "Press"),
        "temp_degc": log.first_of(("BARO",), "Temp"),
        "throttle": _read_throttle(log, vehicle),
        "current_a": _read_battery(log, "Curr"),
        "voltage_v": _read_battery(log, "Volt"),
    }
    return {header: channel for header, channel in found.items() if channel is not None}


def _read_battery(log: DataFlash, column: str) -> Channel | None:
    """In whole hundredths in logs of old."""
    for messages in log.instances("BAT", "CURR"):
        if column in messages:
            hundredths = messages.letters[column] in "hH"
            done = "hundredths to one" if hundredths else ""
            factor = 0.01 if hundredths else 1.0
            return log.first_of((messages.name,), column, factor=factor, done=done)
    return None


def _read_throttle(log: DataFlash, vehicle: str) -> Channel | None:
    """From 0 to 1, whatever the vehicle counts in."""
    for name, column in (("CTUN", "ThO"), ("CTUN", "ThrOut"), ("CURR", "ThrOut"), ("CURR", "Thr")):
        messages = log[name]
        if messages is None or column not in messages or not messages[column].any():
            continue
        highest = float(np.abs(messages[column]).max())
        if "Plane" in vehicle:
            full = 100.0
        elif "Copter" in vehicle and name == "CTUN":
            full = 1000.0 if messages.letters[column] in "hHiI" else 1.0
        else:
            full = next(f for f in (1.0, 100.0, max(1000.0, highest)) if highest <= 1.05 * f)
        return log.first_of((name,), column, factor=1 / full, done=f"{full:g} to 1")
    return None


def _read_labels(log: DataFlash, vehicle: str) -> Labels | None:
    messages = log["MODE"]
    if messages is None or (column := messages.first("ModeNum", "Mode")) is None:
        return None
    names = _mode_names(vehicle)
    if messages.is_text(column):
        words = [one_line(word).lower() for word in messages.texts(column)]
        flown = [names.get(int(w), f"mode_{w}").lower() if w.isdigit() else w for w in words]
    else:
        numbers = messages[column].astype(int)
        flown = [names.get(n, f"mode_{n}").lower() for n in numbers]
    switched = (log.times(messages), flown)
    arming = _read_arming(log)
    source = f"MODE.{column}" + (" and arming" if arming else "; arming isn't logged")
    return modes.combine(source, switched, arming)


def _mode_names(vehicle: str) -> dict[int, str]:
    try:
        from pymavlink import mavutil
    except ImportError:  # a log of text is read without; its modes mostly have names
        return {}
    tables = {
        "Copter": "acm",
        "Plane": "apm",
        "Rover": "rover",
        "Sub": "sub",
        "Tracker": "tracker",
        "Blimp": "blimp",
    }
    known = next((table for name, table in tables.items() if name in vehicle), None)
    return dict(getattr(mavutil, f"mode_mapping_{known}", {})) if known else {}


def _read_arming(log: DataFlash) -> tuple[Array, np.ndarray] | None:
    messages = log["ARM"]
    if messages is not None and "ArmState" in messages:
        return log.times(messages), messages["ArmState"] > 0
    messages = log["EV"]
    if messages is None or (column := messages.first("Id", "ID")) is None:
        return None
    said = np.isin(messages[column], (ARMED, DISARMED))
    if not said.any():
        return None
    return log.times(messages)[said], messages[column][said] == ARMED


def _read_utc(log: DataFlash) -> Utc | None:
    for messages in log.instances("GPS", "GPS2"):
        week, milliseconds = messages.first("GWk", "Week"), messages.first("GMS", "TimeMS")
        if week is None or milliseconds is None:
            continue
        fixed = messages["Status"] >= FIX_3D if "Status" in messages else messages[week] > 0
        found = clock.from_gps(
            log.times(messages)[fixed],
            messages[week][fixed],
            messages[milliseconds][fixed],
            f"{messages.name}.{week}, {milliseconds}",
        )
        if found is not None:
            return found
    return None
