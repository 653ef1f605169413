# SPDX-License-Identifier: BSD-3-Clause
"""DataFlash logs of the flight, as old and new ArduPilots write them."""

import numpy as np

from flown_flight import (
    PLACE,
    START,
    altitude,
    at_rate,
    attitude,
    current,
    differential_pressure,
    raw,
    throttle,
    velocity,
)
from log_writers import DataFlashWriter

WEEK, WEEK_START = 2306, 118_000.0  # GPS week; its second at time 0: 2024-03-18


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
