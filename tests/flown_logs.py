# SPDX-License-Identifier: BSD-3-Clause
"""One tumbling flight with a magnetometer, and logs of it as old and new autopilots write them.

All is a formula of time, so that what a column should hold is known at any stamp.
"""

import numpy as np

from log_writers import DataFlashWriter, ULogWriter
from oracle.five_hole_probe import rotate_to_navigation

START, LENGTH = 20.0, 60.0  # [s]
FIELD = np.array([21.5, 1.3, 43.2])  # north, east, down [uT]
PLACE = (47.4, 8.5, 500.0)  # degrees, metres
MATRIX = np.array([[1.05, 0.02, -0.01], [0.02, 0.96, 0.03], [-0.01, 0.03, 1.01]])
BIAS = np.array([12.0, -7.0, 20.0])  # [uT]
WEEK, WEEK_START = 2306, 118_000.0  # GPS week; its second at time 0: 2024-03-18


def at_rate(rate, late=0.0, length=LENGTH):
    return START + late + np.arange(int(length * rate)) / rate


def attitude(t):
    """Roll, pitch, yaw [rad], shape (n, 3)."""
    t = np.asarray(t) - START
    return np.stack((0.9 * np.sin(0.7 * t), 0.8 * np.sin(0.43 * t + 1), 0.5 * t), axis=-1)


def wrap(angles):
    return np.mod(angles + np.pi, 2 * np.pi) - np.pi


def velocity(t):
    return np.stack((20 * np.cos(0.5 * t), 20 * np.sin(0.5 * t), -0.1 * np.ones_like(t)), axis=-1)


def throttle(t):
    return 0.5 + 0.3 * np.sin(0.9 * np.asarray(t))


def current(t):
    return 20 * throttle(t)


def altitude(t):
    return 100 + 5 * np.sin(0.2 * np.asarray(t))


def differential_pressure(t):
    return 250 + 40 * np.sin(0.5 * np.asarray(t))


def true_field(t):
    """In body axes [uT], (n, 3)."""
    angles = dict(zip(("roll", "pitch", "yaw"), attitude(t).T, strict=True))
    return np.einsum("kji,j->ki", rotate_to_navigation(angles), FIELD)


def raw(t):
    """What the raw sensor reads in body axes [uT], (n, 3)."""
    return true_field(t) @ MATRIX.T + BIAS


def quaternion(t):
    """W first, by turning about z, y and x one after another."""
    half = attitude(t) / 2
    (cr, cp, cy), (sr, sp, sy) = np.cos(half).T, np.sin(half).T
    product = np.stack((cy * cp, -sy * sp, cy * sp, sy * cp), axis=-1)
    w, x, y, z = product.T
    return np.stack((w * cr - x * sr, w * sr + x * cr, y * cr + z * sr, z * cr - y * sr), axis=-1)


# What ArduPilot is set to: offsets [mG], matrix, scale and the motors' field [mG/A].
OFFSETS = np.array([-118.4, 71.6, -196.0])
DIAGONAL, OFF_DIAGONAL = np.array([0.97, 1.04, 1.0]), np.array([-0.02, 0.01, -0.03])
SCALE, MOTORS = 1.06, np.array([1.5, -2.0, 0.7])
ARDUPILOT = {
    "COMPASS_DEV_ID": 97539.0,
    "COMPASS_MOTCT": 2.0,
    **{f"COMPASS_OFS_{a}": v for a, v in zip("XYZ", OFFSETS, strict=True)},
    **{f"COMPASS_DIA_{a}": v for a, v in zip("XYZ", DIAGONAL, strict=True)},
    **{f"COMPASS_ODI_{a}": v for a, v in zip("XYZ", OFF_DIAGONAL, strict=True)},
    **{f"COMPASS_MOT_{a}": v for a, v in zip("XYZ", MOTORS, strict=True)},
    "COMPASS_SCALE": SCALE,
}


def ardupilot_corrects(reading, amperes, parameters=ARDUPILOT, before=False):
    """M = M s (raw + OFS) + MOT I in mG, by ArduPilot's documentation; `before` as of old."""
    x, y, z = (parameters.get(f"COMPASS_DIA_{a}", 0) for a in "XYZ")
    xy, xz, yz = (parameters.get(f"COMPASS_ODI_{a}", 0) for a in "XYZ")
    matrix = np.array([[x, xy, xz], [xy, y, yz], [xz, yz, z]]) if x or y or z else np.eye(3)
    offsets = np.array([parameters[f"COMPASS_OFS_{a}"] for a in "XYZ"])
    motors = np.outer(amperes, [parameters.get(f"COMPASS_MOT_{a}", 0) for a in "XYZ"])
    if before:
        return (10 * reading + offsets + motors) @ matrix.T, motors
    scale = parameters.get("COMPASS_SCALE", 1)
    return scale * (10 * reading + offsets) @ matrix.T + motors, motors


def new_dataflash(parameters=ARDUPILOT, mag_rate=10.0, **options):
    """TimeUS, MAG with I, XKF1 of two cores, BAT, ARM, ARSP, GPS with GWk and GMS."""
    log = DataFlashWriter()
    log.form("PARM", "QNff", "TimeUS,Name,Value,Default")
    log.form("MSG", "QZ", "TimeUS,Message")
    log.form("MODE", "QMBB", "TimeUS,Mode,ModeNum,Rsn")
    log.form("ARM", "QBIBB", "TimeUS,ArmState,ArmChecks,Forced,Method")
    log.form(
        "MAG",
        "QBhhhhhhhhhBI",
        "TimeUS,I,MagX,MagY,MagZ,OfsX,OfsY,OfsZ,MOX,MOY,MOZ,Health,S",
    )
    log.form("ATT", "QccccCCCCB", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,ErrRP,ErrYaw,AEKF")
    log.form("XKF1", "QBccCfff", "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD")
    log.form("XKF4", "QBB", "TimeUS,C,PI")
    log.form("BAT", "QBffff", "TimeUS,Inst,Volt,VoltR,Curr,CurrTot")
    log.form("BARO", "QBffc", "TimeUS,I,Alt,Press,Temp")
    log.form("CTUN", "Qff", "TimeUS,ThI,ThO")
    log.form("ARSP", "QBffcff", "TimeUS,I,Airspeed,DiffPress,Temp,RawPress,Offset")
    log.form("IMU", "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ")
    log.form(
        "GPS", "QBBIHBcLLeffff", "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,Yaw"
    )
    add = log.add
    for name, value in parameters.items():
        add(START - 1, "PARM", (START - 1) * 1e6, name, value, 0.0)
    add(START - 1, "MSG", (START - 1) * 1e6, "ArduCopter V4.5.7 (abc)")
    for time, mode in ((START - 1, 0), (START + 30, 5)):
        add(time, "MODE", time * 1e6, mode, mode, 0)
    add(START + 5, "ARM", (START + 5) * 1e6, 1, 0, 0, 0)
    offsets = [parameters[f"COMPASS_OFS_{a}"] for a in "XYZ"]
    for t in at_rate(mag_rate):
        (reading,), motors = ardupilot_corrects(raw([t - 0.004]), current([t - 0.004]), parameters)
        s = (round(t * 1e6) - 4000) % 2**32
        values = (*np.round(reading), *offsets, *np.round(motors[0]), 1, s)
        add(t, "MAG", round(t * 1e6), 0, *values)
        if options.get("second", True):
            add(
                t,
                "MAG",
                round(t * 1e6),
                1,
                *np.round(10 * raw([t])[0] / 2),
                *[0] * 6,
                1,
                round(t * 1e6),
            )
    for t in at_rate(10, 0.03):
        roll, pitch, yaw = np.degrees(attitude(t))
        us = round(t * 1e6)
        add(t, "ATT", us, 0, roll, 0, pitch, 0, yaw % 360, 0, 0, 3)
        vn, ve, vd = velocity(t)
        add(t, "XKF1", us, 0, 0, 0, 0, vn + 3, ve, vd)
        add(t, "XKF1", us, 1, 0, 0, 0, vn, ve, vd)
        add(t, "XKF4", us, 0, 1)
        add(t, "BAT", us, 0, 16.0, 16.0, current(t), 0.0)
        add(t, "CTUN", us, 0.0, throttle(t))
        add(t, "ARSP", us, 0, 20.0, differential_pressure(t), 18.5, 0.0, 0.0)
    for t in at_rate(2, 0.01):
        add(t, "BARO", round(t * 1e6), 0, altitude(t), 95000.0, 25.0)
    for t in at_rate(50, 0.001):
        add(t, "IMU", round(t * 1e6), 0, np.sin(t), np.cos(t), 0.1, 0.0, 0.0, -9.8)
    for t in at_rate(5, 0.02):
        seconds = WEEK_START + t
        week = options.get("week", WEEK)
        add(
            t, "GPS", round(t * 1e6), 0, 3, round(seconds * 1000), week, 12, 0.8, *PLACE, *[0.0] * 4
        )
    return log


def old_dataflash(mag_rate=10.0):
    """TimeMS, MAG and MAG2, EKF1, CURR in hundredths, GPS with its own TimeMS, EV, no DIA."""
    log = DataFlashWriter()
    log.form("PARM", "Nf", "Name,Value")
    log.form("MSG", "Z", "Message")
    log.form("MODE", "Mh", "Mode,ThrCrs")
    log.form("EV", "B", "Id")
    columns = "TimeMS,MagX,MagY,MagZ,OfsX,OfsY,OfsZ,MOfsX,MOfsY,MOfsZ"
    log.form("MAG", "Ihhhhhhhhh", columns)
    log.form("MAG2", "Ihhhhhhhhh", columns)
    log.form("ATT", "IccccCC", "TimeMS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw")
    log.form("EKF1", "IccCfff", "TimeMS,Roll,Pitch,Yaw,VN,VE,VD")
    log.form("CURR", "IhIhhhf", "TimeMS,ThrOut,ThrInt,Volt,Curr,Vcc,CurrTot")
    log.form(
        "GPS", "BIHBcLLeeEefI", "Status,TimeMS,Week,NSats,HDop,Lat,Lng,RelAlt,Alt,Spd,GCrs,VZ,T"
    )
    log.form("BARO", "Iffc", "TimeMS,Alt,Press,Temp")
    add = log.add
    for axis, value, second in zip("XYZ", (-120, 70, -200), (5, 6, 7), strict=True):
        add(START - 1, "PARM", f"COMPASS_OFS_{axis}", value)
        add(START - 1, "PARM", f"COMPASS_OFS2_{axis}", second)
    add(START - 1, "MSG", "ArduPlane V3.1.1")
    add(START - 1, "MODE", 10, 0)
    add(START + 5.01, "EV", 10)
    for t in at_rate(mag_rate):
        reading = np.round(10 * raw([t])[0] + (-120, 70, -200))
        add(t, "MAG", round(t * 1000), *reading, -120, 70, -200, 0, 0, 0)
        second = np.round(10 * raw([t])[0]) + np.array([5, 6, 7])
        add(t, "MAG2", round(t * 1000), *second, 5, 6, 7, 0, 0, 0)
    for t in at_rate(10, 0.03):
        roll, pitch, yaw = np.degrees(attitude(t))
        ms = round(t * 1000)
        add(t, "ATT", ms, 0, roll, 0, pitch, 0, yaw % 360)
        add(t, "EKF1", ms, 0, 0, 0, *velocity(t))
        add(t, "CURR", ms, 100 * throttle(t), 0, 1600, 100 * current(t), 0, 0.0)
    for t in at_rate(2, 0.01):
        add(t, "BARO", round(t * 1000), altitude(t), 95000.0, 25.0)
    for t in at_rate(5, 0.02):
        week_ms = round((WEEK_START + t) * 1000)
        add(t, "GPS", 3, week_ms, WEEK, 9, 1.0, *PLACE[:2], 0, PLACE[2], 0, 0, 0.0, round(t * 1000))
    return log


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
