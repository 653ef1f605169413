# SPDX-License-Identifier: BSD-3-Clause
"""ULogs of the flight, as old and new PX4s write them."""

import numpy as np

from flown_flight import (
    PLACE,
    START,
    altitude,
    at_rate,
    current,
    differential_pressure,
    quaternion,
    raw,
    throttle,
    velocity,
)
from log_writers import ULogWriter

# What PX4 is set to: offsets [G], scales, off-diagonals, compensation [G/kA], mounted by yaw 90.
PX4 = (
    ("CAL_MAG0_ID", 197388),
    ("CAL_MAG0_ROT", 2),
    ("CAL_MAG0_XOFF", 0.11),
    ("CAL_MAG0_YOFF", -0.06),
    ("CAL_MAG0_ZOFF", 0.19),
    ("CAL_MAG0_XSCALE", 0.97),
    ("CAL_MAG0_YSCALE", 1.05),
    ("CAL_MAG0_ZSCALE", 1.01),
    ("CAL_MAG0_XODIAG", 0.02),
    ("CAL_MAG0_YODIAG", -0.01),
    ("CAL_MAG0_ZODIAG", 0.03),
    ("CAL_MAG0_XCOMP", 1.5),
    ("CAL_MAG0_YCOMP", -2.0),
    ("CAL_MAG0_ZCOMP", 0.7),
    ("CAL_MAG_COMP_TYP", 2),
    ("SENS_DPRES_OFF", 1.5),
)
TURN = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])  # yaw 90: sensor to body
DEVICE = 197388


def sensor_axes(t):
    """The raw sensor in its own axes [G], (n, 3)."""
    return raw(t) @ TURN / 100


def px4_corrects(t, parameters=PX4):
    """M = R S (raw + COMP kA - OFF) [G] by PX4's documentation."""
    p = dict(parameters)
    x, y, z = (p[f"CAL_MAG0_{a}SCALE"] for a in "XYZ")
    xy, xz, yz = (p.get(f"CAL_MAG0_{a}ODIAG", 0.0) for a in "XYZ")
    matrix = np.array([[x, xy, xz], [xy, y, yz], [xz, yz, z]])
    offset = np.array([p[f"CAL_MAG0_{a}OFF"] for a in "XYZ"])
    comp = np.array([p.get(f"CAL_MAG0_{a}COMP", 0.0) for a in "XYZ"])
    amperes = np.outer(px4_current(t), comp) / 1000
    return (sensor_axes(t) + amperes - offset) @ matrix.T @ TURN.T


def px4_current(t):
    """Of the last battery_status before, which comes at 10 Hz from START + 0.03 on."""
    t = np.asarray(t)
    last = START + 0.03 + np.floor((t - START - 0.03) * 10 + 1e-6) / 10
    return current(np.maximum(last, START + 0.03))


def new_ulog(raw_rate=50.0, corrected_rate=0.0, parameters=PX4, utc=True, device=DEVICE):
    """sensor_mag as the raw sensor, and vehicle_magnetometer where a rate is given."""
    log = ULogWriter(parameters, [("sys_name", "PX4")])
    log.form(
        "sensor_mag",
        "uint64_t timestamp_sample;uint32_t device_id;float x;float y;float z;float temperature",
    )
    log.form(
        "vehicle_magnetometer",
        "uint64_t timestamp_sample;uint32_t device_id;float[3] magnetometer_ga",
    )
    log.form("differential_pressure", "float differential_pressure_pa;float temperature")
    _add_px4_context(log, utc)
    for t in at_rate(raw_rate) if raw_rate else ():
        log.add(t + 0.002, "sensor_mag", round(t * 1e6), device, *sensor_axes([t])[0], 31.0)
    for t in at_rate(corrected_rate) if corrected_rate else ():
        reading = px4_corrects([t], parameters)[0]
        log.add(t + 0.005, "vehicle_magnetometer", round(t * 1e6), device, *reading)
    for t in at_rate(10, 0.03):
        log.add(t, "differential_pressure", differential_pressure(t) + 1.5, 18.5)
    return log


def old_ulog(relative=True):
    """sensor_combined.magnetometer_ga at 100 Hz of a 25 Hz sensor, corrected by its driver."""
    parameters = [(n, v) for n, v in PX4 if "ODIAG" not in n and "COMP" not in n]
    log = ULogWriter(parameters, [("sys_name", "PX4")])
    fields = "float[3] magnetometer_ga"
    log.form(
        "sensor_combined", fields + (";int32_t magnetometer_timestamp_relative" if relative else "")
    )
    _add_px4_context(log, True)
    for count, t in enumerate(at_rate(100)):
        taken = START + (count // 4) / 25
        reading = px4_corrects([taken], parameters)[0]
        extra = (round((taken - t) * 1e6),) if relative else ()
        log.add(t, "sensor_combined", *reading, *extra)
    return log


def _add_px4_context(log, utc):
    log.form("vehicle_attitude", "float[4] q")
    log.form("vehicle_local_position", "float vx;float vy;float vz;bool v_xy_valid;bool v_z_valid")
    log.form("battery_status", "float voltage_v;float current_a")
    log.form("vehicle_thrust_setpoint", "float[3] xyz")
    log.form("vehicle_air_data", "float baro_alt_meter;float baro_pressure_pa;float rho")
    log.form("vehicle_status", "uint8_t nav_state;uint8_t arming_state")
    log.form(
        "vehicle_gps_position",
        "double latitude_deg;double longitude_deg;double altitude_msl_m;"
        "uint64_t time_utc_usec;uint8_t fix_type",
    )
    for t in at_rate(20, 0.03):
        log.add(t, "vehicle_attitude", *quaternion([t])[0])
    for t in at_rate(10, 0.03):
        log.add(t, "vehicle_local_position", *velocity(t), True, True)
        log.add(t, "battery_status", 16.0, current(t))
        log.add(t, "vehicle_air_data", altitude(t), 95000.0, 1.15)
    for t in at_rate(100, 0.001):
        log.add(t, "vehicle_thrust_setpoint", 0.0, 0.0, -throttle(t))
    for t in at_rate(1, 0.04):
        log.add(t, "vehicle_status", 3 if t < START + 30 else 4, 2)
    for t in at_rate(5, 0.02):
        unix = round((1_710_742_386.0 + t) * 1e6) if utc else 0
        log.add(t, "vehicle_gps_position", *PLACE, unix, 3)
