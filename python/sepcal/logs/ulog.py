# SPDX-License-Identifier: BSD-3-Clause
"""PX4's ULog, of old (sensor_combined.magnetometer_ga) and new (sensor_mag as the raw sensor)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sepcal.columns import Array
from sepcal.logs import clock, modes, px4_airspeed
from sepcal.logs.recording import TUBE, Channel, Labels, Recording, Sensor, Utc, make_channel
from sepcal.logs.ulog_magnetometers import read_magnetometers
from sepcal.logs.ulog_topics import Topic, ULog

ARMED = 2  # vehicle_status.arming_state
FIX_3D = 3
GPS = ("vehicle_gps_position", "sensor_gps")
COLDEST = -100.0  # [degC]: what is below is a stand-in for none
HECTOPASCALS = 2000.0  # a static pressure below is in hPa


def read(file: str, cut_off: bool, progress: Callable[[str], None]) -> Recording:
    """The log. Raises Error for one that can't be read."""
    log = ULog(file, cut_off, progress)
    notes = []
    if log.damaged:
        notes.append("parts of the file are damaged and were skipped")
    if log.torn:
        notes.append(f"the log is cut off inside {log.torn}; what is whole before it is used")
    if log.dropouts:
        notes.append(f"the logger dropped {log.dropouts:.2f} s of messages")
    magnetometers, said = read_magnetometers(log)
    return Recording(
        file=file,
        form="ULog",
        vehicle=log.vehicle,
        span=log.span,
        sensors=(*magnetometers, *_read_tubes(log)),
        attitude=_read_attitude(log),
        velocity=_read_velocity(log),
        rates=_read_rates(log),
        position=_read_position(log),
        drivers=_read_drivers(log),
        labels=_read_labels(log),
        utc=_read_utc(log),
        notes=(*notes, *said),
    )


def _read_attitude(log: ULog) -> Channel | None:
    for topic in log.topics("vehicle_attitude"):
        columns = ("q[0]", "q[1]", "q[2]", "q[3]")
        if all(column in topic for column in columns):
            return topic.channel(*columns, kept=_says_something(topic.stack(columns)))
    return None


def _says_something(values: Array) -> np.ndarray:
    return np.asarray(values.any(axis=1))


def _read_rates(log: ULog) -> Channel | None:
    for topic, columns in (
        ("vehicle_angular_velocity", ("xyz[0]", "xyz[1]", "xyz[2]")),
        ("vehicle_attitude", ("rollspeed", "pitchspeed", "yawspeed")),
        ("sensor_combined", ("gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]")),
    ):
        found = log.first_of((topic,), *columns)
        if found is not None:
            return found
    return None


def _read_velocity(log: ULog) -> Channel | None:
    """The filter's velocity, if it says that it is valid; otherwise that of the GPS."""
    for topic in log.topics("vehicle_local_position"):
        valid = np.ones(len(topic), dtype=bool)
        for flag in ("v_xy_valid", "v_z_valid"):
            if flag in topic:
                valid &= topic[flag] > 0
        found = topic.channel("vx", "vy", "vz", kept=valid)
        if found is not None and found.values.any():
            return found
    for topic in log.topics(*GPS):
        found = topic.channel("vel_n_m_s", "vel_e_m_s", "vel_d_m_s", kept=_has_fix(topic))
        if found is not None and found.values.any():
            return found
    return None


def _has_fix(topic: Topic) -> np.ndarray:
    kind = topic.first("fix_type")
    return np.asarray(topic[kind] >= FIX_3D) if kind else np.ones(len(topic), dtype=bool)


def _read_position(log: ULog) -> Channel | None:
    """The GPS position; older ones are in 1e-7 degrees and millimetres."""
    for topic in log.topics(*GPS):
        for columns, factors in (
            (("latitude_deg", "longitude_deg", "altitude_msl_m"), (1.0, 1.0, 1.0)),
            (("lat", "lon", "alt"), (1e-7, 1e-7, 1e-3)),
        ):
            found = topic.channel(*columns, kept=_has_fix(topic))
            if found is not None and found.values[:, :2].any():
                return Channel(
                    found.source, found.times, found.values * np.array(factors), found.done
                )
    return log.first_of(("vehicle_global_position",), "lat", "lon", "alt")


def _read_tubes(log: ULog) -> list[Sensor]:
    tubes: list[Sensor] = []
    for topic in log.topics("differential_pressure"):
        column = topic.first(
            "differential_pressure_raw_pa",
            "differential_pressure_pa",
            "differential_pressure_filtered_pa",
        )
        if column is None or not topic[column].any():
            continue
        readings = topic.channel(column)
        if readings is None:
            continue
        if column == "differential_pressure_pa":  # of old it was raw_pa, less the offset already
            zero = log.parameters.at("SENS_DPRES_OFF", readings.times)[:, None]
            done = (*readings.done, f"less SENS_DPRES_OFF, {zero[0, 0]:g} Pa")
            readings = Channel(readings.source, readings.times, readings.values - zero, done)
        own = {}
        if "temperature" in topic:
            warm = topic.channel("temperature", kept=topic["temperature"] > COLDEST)
            if warm is not None and warm.values.any():
                own["temp_degc"] = warm
        devices = topic.devices()
        device = 0 if devices is None else int(devices[0])
        readings, settings, title = px4_airspeed.describe(device, readings, log.parameters)
        own |= settings
        tubes.append(Sensor(f"pitot{len(tubes)}", TUBE, readings, "dp_pa", own, title))
    if not tubes:
        for topic in log.topics("airspeed"):
            column = topic.first("true_airspeed_m_s", "true_airspeed_unfiltered_m_s")
            if column is not None and topic[column].any():
                readings = topic.channel(column)
                if readings is not None:
                    name = f"pitot{len(tubes)}"
                    tubes.append(Sensor(name, TUBE, readings, "airspeed_mps"))
    return tubes


def _read_drivers(log: ULog) -> dict[str, Channel]:
    found = {
        "altitude_m": log.first_of(("vehicle_air_data", "sensor_combined"), "baro_alt_meter"),
        "rho_kgpm3": log.first_of(("vehicle_air_data",), "rho"),
        "ps_pa": _read_static_pressure(log),
        "temp_degc": _read_temperature(log),
        "throttle": _read_throttle(log),
        "current_a": _read_battery(log, "current_a", "current_filtered_a"),
        "voltage_v": _read_battery(log, "voltage_v", "voltage_filtered_v"),
    }
    return {header: channel for header, channel in found.items() if channel is not None}


def _read_static_pressure(log: ULog) -> Channel | None:
    found = log.first_of(("vehicle_air_data",), "baro_pressure_pa")
    found = found or log.first_of(("sensor_baro",), "pressure")
    if found is not None and np.median(found.values) < HECTOPASCALS:
        return Channel(found.source, found.times, found.values * 100, (*found.done, "hPa to Pa"))
    return found


def _read_temperature(log: ULog) -> Channel | None:
    """The air's temperature, or a board's if only that is logged."""
    for topic, column in (
        ("airspeed", "air_temperature_celsius"),
        ("vehicle_air_data", "ambient_temperature"),
        ("vehicle_air_data", "baro_temp_celcius"),
        ("sensor_baro", "temperature"),
    ):
        for one in log.topics(topic):
            if column in one and (kept := one[column] > COLDEST).any() and one[column][kept].any():
                return one.channel(column, kept=kept)
    return None


def _read_battery(log: ULog, *columns: str) -> Channel | None:
    """The first battery that is measured: -1 stands for none."""
    for topic in log.topics("battery_status"):
        column = topic.first(*columns)
        if column is None or not (topic[column] > 0).any():
            continue
        return topic.channel(column, kept=topic[column] >= 0)
    return None


def _read_throttle(log: ULog) -> Channel | None:
    """The thrust that is asked for, 0 to 1."""
    for topic in log.topics("vehicle_thrust_setpoint"):
        if "xyz[0]" in topic:
            thrust = np.linalg.norm(topic.stack(("xyz[0]", "xyz[1]", "xyz[2]")), axis=1)
            return make_channel("vehicle_thrust_setpoint.|xyz|", topic.times, thrust, topic.said)
    for topic in log.topics("vehicle_attitude_setpoint"):
        if "thrust_body[0]" in topic:
            columns = ("thrust_body[0]", "thrust_body[1]", "thrust_body[2]")
            thrust = np.linalg.norm(topic.stack(columns), axis=1)
            return make_channel(
                "vehicle_attitude_setpoint.|thrust_body|", topic.times, thrust, topic.said
            )
    return log.first_of(("actuator_controls_0",), "control[3]") or log.first_of(
        ("vehicle_attitude_setpoint",), "thrust"
    )


def _read_labels(log: ULog) -> Labels | None:
    armed: tuple[Array, np.ndarray] | None = None
    source = "vehicle_status.nav_state"
    for topic in log.topics("vehicle_status"):
        if "nav_state" not in topic:
            continue
        times = np.nan_to_num(topic.times, nan=-np.inf)
        flown = [modes.NAV_STATES.get(int(n), f"mode_{n:.0f}") for n in topic["nav_state"]]
        if "arming_state" in topic:
            armed = times, topic["arming_state"] == ARMED
            source += " and arming_state"
        return modes.combine(source, (times, flown), armed)
    for topic in log.topics("actuator_armed"):
        if "armed" in topic:
            times = np.nan_to_num(topic.times, nan=-np.inf)
            return modes.combine(
                "actuator_armed.armed", (np.empty(0), []), (times, topic["armed"] > 0)
            )
    return None


def _read_utc(log: ULog) -> Utc | None:
    for topic in log.topics(*GPS):
        column = topic.first("time_utc_usec")
        if column is None:
            continue
        kept = np.isfinite(topic.times)
        source = f"{topic.name}.{column}"
        fixed = kept & _has_fix(topic) & (topic[column] > 0)
        kept = fixed if fixed.any() else kept
        found = clock.from_unix(topic.times[kept], topic[column][kept], source)
        if found is not None:
            return found
    return None
