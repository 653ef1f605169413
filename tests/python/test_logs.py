# SPDX-License-Identifier: BSD-3-Clause
"""Autopilots' logs, old and new, against the formulas of the flight that they are of."""

import datetime
import json
import re
import subprocess
import sys

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation, Slerp

import flown_logs as flown
import sepcal
from documents import ROOT
from log_writers import DataFlashWriter, ULogWriter
from sepcal.logs.clock import count_leaps
from sepcal.logs.mounting import rotation_of

pytest.importorskip("pyulog")
pytest.importorskip("pymavlink")
pytest.importorskip("pygeomag")

MILLIGAUSS = 0.1  # [uT]
LOGS = {
    "new.bin": flown.new_dataflash,
    "old.bin": flown.old_dataflash,
    "new.ulg": flown.new_ulog,
    "corrected.ulg": lambda: flown.new_ulog(raw_rate=1.0, corrected_rate=20.0),
    "old.ulg": flown.old_ulog,
    "older.ulg": lambda: flown.old_ulog(relative=False),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("logs")
    for name, write in LOGS.items():
        (folder / name).write_bytes(write().data())
    return folder


def write(folder, name, log):
    file = folder / name
    file.write_bytes(log.data() if hasattr(log, "data") else log)
    return file


def stack(flight, headers):
    return np.stack([flight[header] for header in headers.split()], axis=-1)


def magnetic(flight):
    return stack(flight, "mx_ut my_ut mz_ut")


def turns_between(flight, angles):
    """By how much the flight's attitude is turned from these Euler angles [rad], (n,)."""
    logged = Rotation.from_euler("ZYX", stack(flight, "yaw_rad pitch_rad roll_rad"))
    return (logged.inv() * Rotation.from_euler("ZYX", angles[:, ::-1])).magnitude()


# What comes out is the raw sensor. ArduPilot logs field, offsets and motors' field in whole mG.
@pytest.mark.parametrize(
    ("name", "tolerance", "rows"),
    [
        ("new.bin", 1.5 * MILLIGAUSS, 590),
        ("old.bin", 0.51 * MILLIGAUSS, 590),
        ("new.ulg", 1e-4, 2900),
        ("corrected.ulg", 1e-4, 1180),
        ("old.ulg", 1e-4, 1480),
        ("older.ulg", 0.6, 1480),  # stamped when it is logged, up to 10 ms late, here 0 ms
    ],
)
def test_the_raw_sensor(folder, name, tolerance, rows):
    flight = sepcal.read_log(folder / name)
    assert flight.rows >= rows
    assert_allclose(magnetic(flight), flown.raw(flight["time_s"]), atol=tolerance)
    assert flight.sensor == "mag0"


@pytest.mark.parametrize("name", LOGS)
def test_what_goes_with_it(folder, name):
    flight = sepcal.read_log(folder / name)
    t = flight["time_s"]
    assert np.all(np.diff(t) > 0)
    assert turns_between(flight, flown.attitude(t)).max() < 5e-3
    assert np.abs(flight["yaw_rad"]).max() <= np.pi
    inner = (t > flown.START + 0.6) & (t < flown.START + flown.LENGTH - 0.6)  # ends are held
    assert_allclose(flight["throttle"][inner], flown.throttle(t[inner]), atol=0.0101)
    assert_allclose(flight["current_a"][inner], flown.current(t[inner]), atol=0.1)
    assert_allclose(flight["voltage_v"], 16, atol=1e-6)
    assert_allclose(flight["altitude_m"][inner], flown.altitude(t[inner]), atol=0.1)
    assert_allclose(flight["bn_ut"], flight["bn_ut"][0], atol=1e-3)
    strength = np.linalg.norm(stack(flight, "bn_ut be_ut bd_ut"), axis=1)
    assert_allclose(strength, flight["field_strength_ut"], atol=2e-4)
    expected = sepcal.earth_field(*flown.PLACE, datetime.date(2024, 3, 18))
    assert_allclose(flight["bd_ut"], expected.down, atol=1e-3)


@pytest.mark.parametrize("name", ["new.bin", "new.ulg"])
def test_a_tube(folder, name):
    flight = sepcal.read_log(folder / name, "pitot0")
    t = flight["time_s"]
    assert flight.rows > 590
    assert_allclose(flight["dp_pa"], flown.differential_pressure(t), atol=1e-4)
    assert_allclose(stack(flight, "vn_mps ve_mps vd_mps"), flown.velocity(t), atol=0.03)
    assert "bn_ut" not in flight
    if name == "new.bin":
        assert_allclose(flight["ps_pa"], 95000)
        assert_allclose(flight["temp_degc"], 18.5)
    else:
        assert_allclose(flight["rho_kgpm3"], 1.15, atol=1e-6)
    probe = sepcal.PitotStatic()
    assert not sepcal.check(probe, flight).refused


def test_a_fit_finds_the_raw_sensors_hard_iron(folder):
    for name in ("new.bin", "new.ulg", "old.ulg"):
        flight = sepcal.read_log(folder / name)
        fit = sepcal.fit(sepcal.Magnetometer(field=tuple(flown.FIELD)), flight)
        bias = [fit[f"n_{axis}"].value for axis in "xyz"]
        assert_allclose(bias, flown.BIAS, atol=0.1)


def test_labels(folder):
    flight = sepcal.read_log(folder / "new.bin")
    t = flight["time_s"]
    labels = np.array(flight.maneuvers)
    assert set(labels[t < flown.START + 4.95]) == {"disarmed"}
    assert set(labels[(t > flown.START + 5.01) & (t < flown.START + 29.9)]) == {"stabilize"}
    assert set(labels[t > flown.START + 30.01]) == {"loiter"}
    old = sepcal.read_log(folder / "old.bin")
    assert list(dict.fromkeys(old.maneuvers)) == ["disarmed", "auto"]
    px4 = sepcal.read_log(folder / "new.ulg")
    assert list(dict.fromkeys(px4.maneuvers)) == ["mission", "hold"]


def test_utc(folder):
    # GPS week 2306 begins on 17 March 2024; GPS time was 18 s ahead of UTC.
    told = sepcal.read_log(folder / "new.bin").conversion
    first = datetime.datetime.fromisoformat(told["utc"]["first_row"])
    week = datetime.datetime(2024, 3, 17, tzinfo=datetime.UTC)
    expected = week + datetime.timedelta(seconds=flown.WEEK_START + told["span"]["from_s"] - 18)
    assert abs((first - expected).total_seconds()) < 2e-3
    assert "less 18 leap seconds" in told["utc"]["source"]
    px4 = sepcal.read_log(folder / "new.ulg").conversion
    moment = datetime.datetime.fromisoformat(px4["utc"]["first_row"])
    assert abs(moment.timestamp() - 1_710_742_386.0 - px4["span"]["from_s"]) < 2e-3
    assert "time_utc_usec" in px4["utc"]["source"]


def test_what_was_undone_is_said(folder):
    for name, words in (
        ("new.bin", ["COMPASS_OFS, -118.4, 71.6, -196 mG", "COMPASS_SCALE, 1.06", "COMPASS_DIA",
                     "the motors' field as logged, applied after the matrix", "4 ms before"]),
        ("old.bin", ["COMPASS_OFS, -120, 70, -200 mG"]),
        ("new.ulg", ["the raw sensor: nothing to undo", "turned into body axes"]),
        ("corrected.ulg", ["CAL_MAG0_?OFF, 0.11, -0.06, 0.19 G", "CAL_MAG0_?COMP times the power",
                           "sensor_mag has 1 Hz", "as a check,"]),
        ("old.ulg", ["CAL_MAG0_?OFF", "the 1500 rows with a new reading of 6000"]),
    ):  # fmt: skip
        done = " ".join(sepcal.read_log(folder / name).conversion["columns"]["mx_ut"]["done"])
        for word in words:
            assert word in done, (name, done)


def test_the_check_against_raw_samples_speaks_up(tmp_path):
    """A correction that the parameters don't tell: more than noise between raw and undone."""
    data = flown.new_ulog(1.0, 20.0).data()
    name = b"float CAL_MAG0_XOFF"
    assert name + np.float32(0.11).tobytes() in data
    file = tmp_path / "a.ulg"
    file.write_bytes(
        data.replace(name + np.float32(0.11).tobytes(), name + np.float32(0.16).tobytes())
    )
    done = " ".join(sepcal.read_log(file).conversion["columns"]["mx_ut"]["done"])
    assert "more than noise, another correction was at work" in done


def test_second_compasses(folder):
    new = sepcal.read_log(folder / "new.bin", "mag1")
    assert_allclose(magnetic(new), flown.raw(new["time_s"]) / 2, atol=0.06)
    old = sepcal.read_log(folder / "old.bin", "mag1")
    assert_allclose(magnetic(old), flown.raw(old["time_s"]), atol=0.06)
    assert sepcal.list_log(folder / "new.bin").sensors == ("mag0", "mag1", "pitot0")


def test_the_matrix_comes_last_in_logs_of_old(tmp_path):
    parameters = {n: v for n, v in flown.ARDUPILOT.items() if n != "COMPASS_SCALE"}
    log = flown.new_dataflash(parameters)
    for at, (time, order, message) in enumerate(log._messages):
        if message[2] == log._forms["MAG"][0] and message[11] == 0:
            taken = time - 0.004
            amperes = flown.current([taken])
            reading, motors = flown.ardupilot_corrects(
                flown.raw([taken]), amperes, parameters, before=True
            )
            offsets = [parameters[f"COMPASS_OFS_{a}"] for a in "XYZ"]
            s = round(taken * 1e6)
            values = (*np.round(reading[0]), *offsets, *np.round(motors[0]), 1, s)
            log._messages[at] = (time, order, log._pack("MAG", round(time * 1e6), 0, *values))
    flight = sepcal.read_log(write(tmp_path, "a.bin", log))
    assert_allclose(magnetic(flight), flown.raw(flight["time_s"]), atol=1.5 * MILLIGAUSS)


def test_parameters_that_change_on_the_way(tmp_path):
    log = flown.new_ulog(raw_rate=0, corrected_rate=20.0)
    changed = tuple((dict(flown.PX4) | {"CAL_MAG0_XOFF": 0.21}).items())
    later = flown.new_ulog(raw_rate=0, corrected_rate=20.0, parameters=changed)
    half = flown.START + 30
    log._messages = [m for m in log._messages if m[0] < half]
    log._messages += [m for m in later._messages if m[0] >= half]
    log.set(half - 0.01, "CAL_MAG0_XOFF", 0.21)
    flight = sepcal.read_log(write(tmp_path, "a.ulg", log))
    assert_allclose(magnetic(flight), flown.raw(flight["time_s"]), atol=1e-4)


def test_offsets_that_were_learned_in_flight(tmp_path):
    """The log's own offsets count where the parameter is another."""
    parameters = flown.ARDUPILOT | {"COMPASS_OFS_X": -300.0}
    log = flown.new_dataflash()
    stale = flown.new_dataflash(parameters)
    log._messages = [
        (stale._messages[i] if m[2][2] == log._forms["PARM"][0] else m)
        for i, m in enumerate(log._messages)
    ]
    flight = sepcal.read_log(write(tmp_path, "a.bin", log))
    assert_allclose(magnetic(flight), flown.raw(flight["time_s"]), atol=2 * MILLIGAUSS)
    done = " ".join(flight.conversion["columns"]["mx_ut"]["done"])
    assert "the offsets as logged" in done


def test_a_gap_stays_a_gap(tmp_path):
    log = flown.new_ulog(raw_rate=20.0)
    attitude = [m for m in log._messages if len(m[2]) == 3 + 2 + 8 + 16]
    lost = {m[:2] for m in attitude if 40 < m[0] < 42}
    log._messages = [m for m in log._messages if m[:2] not in lost]
    flight = sepcal.read_log(write(tmp_path, "a.ulg", log))
    t = flight["time_s"]
    assert not ((t > 40.1) & (t < 41.9)).any()
    assert flight.conversion["left_out"]["nothing for roll_rad"] >= 38
    assert turns_between(flight, flown.attitude(t)).max() < 5e-3


def test_fast_channels_are_averaged_and_slow_ones_interpolated(folder):
    flight = sepcal.read_log(folder / "corrected.ulg")
    t = flight["time_s"]
    told = flight.conversion["columns"]
    assert "averaged over 0.05 s from 100 Hz" in told["throttle"]["done"][-1]
    assert "interpolated from 10 Hz" in told["altitude_m"]["done"][-1]
    # Of lines between samples, by summing two thousand points of each window.
    stamps = flown.at_rate(100, 0.001)
    width = 0.05
    for row in (7, 500, 1100):
        window = np.linspace(t[row] - width / 2, t[row] + width / 2, 2001)
        line = np.interp(window, stamps, np.float32(flown.throttle(stamps)).astype(float))
        assert_allclose(flight["throttle"][row], np.trapezoid(line, window) / width, atol=1e-7)
    stamps = flown.at_rate(10, 0.03)
    line = np.interp(t, stamps, np.float32(flown.altitude(stamps)).astype(float))
    assert_allclose(flight["altitude_m"], line, atol=1e-9)


def test_attitude_between_samples(folder):
    flight = sepcal.read_log(folder / "new.ulg")
    t = flight["time_s"]
    stamps = flown.at_rate(20, 0.03)
    q = flown.quaternion(stamps)
    expected = Slerp(stamps, Rotation.from_quat(np.roll(q, -1, axis=1)))(t)
    angles = expected.as_euler("ZYX")[:, ::-1]
    assert turns_between(flight, angles).max() < 1e-5


def test_from_and_to(folder):
    whole = sepcal.read_log(folder / "new.bin")
    part = sepcal.read_log(folder / "new.bin", start=30.0, end=40.0)
    t = whole["time_s"]
    kept = (t >= 30) & (t <= 40)
    for header in whole:
        assert_allclose(part[header], whole[header][kept], rtol=1e-12, atol=1e-12)
    assert part.conversion["left_out"]["outside from 30 s to 40 s"] > 480


def test_what_is_saved_reads_back(folder, tmp_path):
    flight = sepcal.read_log(folder / "new.bin")
    flight.save(tmp_path / "f.csv")
    back = sepcal.read_csv(tmp_path / "f.csv")
    assert set(back) == set(flight)
    for header in flight:
        assert np.array_equal(back[header], flight[header])
    assert back.maneuvers == flight.maneuvers
    told = json.loads((tmp_path / "f.csv.json").read_text())
    assert told == flight.conversion
    assert set(told["columns"]) == set(flight)
    assert told["rows"] == flight.rows


def test_stamps_that_repeat_or_jump(tmp_path):
    log = flown.old_dataflash()
    number = log._forms["MAG"][0]
    spoiled = 0
    for at, (time, order, message) in enumerate(log._messages):
        if message[2] == number and 30 <= time < 30.35:
            stamp = (10**9, round(29.9 * 1000), 5)[spoiled % 3]
            spoiled += 1
            body = message[:3] + int(stamp).to_bytes(4, "little") + message[7:]
            log._messages[at] = (time, order, body)
    flight = sepcal.read_log(write(tmp_path, "a.bin", log))
    assert_allclose(magnetic(flight), flown.raw(flight["time_s"]), atol=0.06)
    assert flight.rows > 580
    done = " ".join(flight.conversion["columns"]["mx_ut"]["done"])
    assert f"{spoiled} samples whose time repeats or runs back" in done


def test_a_log_without_most(tmp_path):
    """A magnetometer alone: no attitude, no place, no modes."""
    log = DataFlashWriter()
    log.form("MAG", "QBhhh", "TimeUS,I,MagX,MagY,MagZ")
    for t in flown.at_rate(10):
        log.add(t, "MAG", round(t * 1e6), 0, *np.round(10 * flown.raw([t])[0]))
    file = write(tmp_path, "a.bin", log)
    flight = sepcal.read_log(file)
    assert flight.columns == ("time_s", "mx_ut", "my_ut", "mz_ut")
    assert flight.maneuvers == []
    assert "--field-strength F" in str(sepcal.list_log(file))


def test_ekf2(tmp_path):
    log = flown.new_dataflash()
    data = log.data().replace(b"XKF1", b"NKF1").replace(b"XKF4", b"NKF4")
    flight = sepcal.read_log(write(tmp_path, "a.bin", data), "pitot0")
    t = flight["time_s"]
    assert_allclose(stack(flight, "vn_mps ve_mps vd_mps"), flown.velocity(t), atol=0.03)
    assert "NKF1" in flight.conversion["columns"]["vn_mps"]["source"]


def write_tube_and_gps(folder, form, columns, values):
    """A DataFlash log of a tube and a GPS alone."""
    log = DataFlashWriter()
    log.form("ARSP", "QBffc", "TimeUS,I,Airspeed,DiffPress,Temp")
    log.form("BARO", "QBffc", "TimeUS,I,Alt,Press,Temp")
    log.form("GPS", form, columns)
    for t in flown.at_rate(10):
        us = round(t * 1e6)
        log.add(t, "ARSP", us, 0, 20.0, flown.differential_pressure(t), 18.5)
        log.add(t, "BARO", us, 0, flown.altitude(t), 95000.0, 25.0)
        log.add(t, "GPS", us, *values(t))
    return write(folder, "a.bin", log)


def test_velocity_of_the_gps(tmp_path):
    def values(t):
        vn, ve, vd = flown.velocity(t)
        course = np.degrees(np.arctan2(ve, vn)) % 360
        return 3, *flown.PLACE, np.hypot(vn, ve), course, vd

    form, columns = "QBLLefff", "TimeUS,Status,Lat,Lng,Alt,Spd,GCrs,VZ"
    flight = sepcal.read_log(write_tube_and_gps(tmp_path, form, columns, values))
    assert flight.sensor == "pitot0"
    velocity = stack(flight, "vn_mps ve_mps vd_mps")
    assert_allclose(velocity, flown.velocity(flight["time_s"]), atol=1e-4)


def test_positions_where_no_velocity_is_logged(tmp_path):
    def values(t):
        return 47.4 + 1e-4 * (t - 20), 8.5, 500.0

    form, columns = "QLLe", "TimeUS,Lat,Lng,Alt"
    flight = sepcal.read_log(write_tube_and_gps(tmp_path, form, columns, values))
    assert "vn_mps" not in flight
    assert_allclose(flight["lat_deg"], 47.4 + 1e-4 * (flight["time_s"] - 20), atol=1e-7)
    assert_allclose(flight["lon_deg"], 8.5)


def test_a_gps_of_old_in_a_ulog(tmp_path):
    """Whole 1e-7 degrees and millimetres; and a vehicle_magnetometer that names no device."""
    log = ULogWriter(flown.PX4)
    log.form("vehicle_gps_position", "int32_t lat;int32_t lon;int32_t alt;uint64_t time_utc_usec")
    log.form("vehicle_magnetometer", "float[3] magnetometer_ga")
    for t in flown.at_rate(10):
        unix = round((1_710_742_386.0 + t) * 1e6)
        log.add(t, "vehicle_gps_position", 474000000, 85000000, 500000, unix)
        still = dict(flown.PX4) | {f"CAL_MAG0_{a}COMP": 0.0 for a in "XYZ"}
        log.add(t, "vehicle_magnetometer", *flown.px4_corrects([t], still)[0])
    flight = sepcal.read_log(write(tmp_path, "a.ulg", log))
    assert_allclose(magnetic(flight), flown.raw(flight["time_s"]), atol=1e-4)
    expected = sepcal.earth_field(*flown.PLACE, "2024-03-18")
    assert_allclose(flight["field_strength_ut"], expected.strength, atol=1e-3)


def test_two_magnetometers_of_a_ulog(tmp_path):
    """Each is undone by the parameters that name its device, in whatever order."""
    second = [(n.replace("MAG0", "MAG1"), v) for n, v in flown.PX4 if n.startswith("CAL_MAG0")]
    first = [("CAL_MAG0_ID", 5), ("CAL_MAG0_XOFF", 0.3), ("CAL_MAG0_ROT", 0)]
    written = ULogWriter([*first, *second, ("CAL_MAG_COMP_TYP", 2)])
    fields = "uint64_t timestamp_sample;uint32_t device_id;float[3] magnetometer_ga"
    written.form("vehicle_magnetometer", fields)
    written.form("battery_status", "float voltage_v;float current_a")
    written.form("vehicle_status", "uint8_t nav_state;uint8_t arming_state")
    for t in flown.at_rate(20):
        stamp = round(t * 1e6)
        corrected = flown.px4_corrects([t])[0]
        written.add(t + 0.005, "vehicle_magnetometer", stamp, flown.DEVICE, *corrected, instance=1)
        other = flown.raw([t])[0] / 100 - (0.3, 0, 0)
        written.add(t + 0.005, "vehicle_magnetometer", stamp, 5, *other, instance=0)
    for t in flown.at_rate(10, 0.03):
        written.add(t, "battery_status", 16.0, flown.current(t))
    for t in flown.at_rate(1):
        written.add(t, "vehicle_status", 3, 2)
    file = write(tmp_path, "a.ulg", written)
    for name in ("mag0", "mag1"):
        flight = sepcal.read_log(file, name)
        assert_allclose(magnetic(flight), flown.raw(flight["time_s"]), atol=1e-4)
    titles = [sensor["title"] for sensor in sepcal.list_log(file).to_dict()["sensors"]]
    assert titles == ["device 5, CAL_MAG0", f"device {flown.DEVICE}, CAL_MAG1"]


@pytest.mark.parametrize(
    ("gps", "ahead"),
    [
        ((1990, 6, 1), 6),
        ((2014, 12, 5), 16),
        ((2015, 6, 30), 16),
        ((2015, 7, 2), 17),
        ((2016, 12, 31), 17),
        ((2017, 1, 2), 18),
        ((2026, 3, 1), 18),
    ],
)
def test_leap_seconds(gps, ahead):
    assert count_leaps(datetime.datetime(*gps, tzinfo=datetime.UTC)) == ahead


def test_mountings_are_those_of_mavlink():
    """The names of MAVLink's enumeration say the angles."""
    common = pytest.importorskip("pymavlink.dialects.v20.common")
    for number in range(48):
        if number not in common.enums["MAV_SENSOR_ORIENTATION"]:
            continue
        name = common.enums["MAV_SENSOR_ORIENTATION"][number].name
        words = name.removeprefix("MAV_SENSOR_ROTATION_").split("_")
        angles = dict(zip(words[::2], map(float, words[1::2]), strict=False))
        order = [angles.get(axis, 0.0) for axis in ("YAW", "PITCH", "ROLL")]
        expected = Rotation.from_euler("ZYX", order, degrees=True).as_matrix()
        assert_allclose(rotation_of(number), expected, atol=1e-12, err_msg=name)
    assert rotation_of(48) is None


def test_every_option_is_explained():
    text = (ROOT / "docs" / "commands.md").read_text()
    for command in ("log", "field"):
        done = subprocess.run(
            [sys.executable, "-m", "sepcal", command, "--help"],
            capture_output=True,
            text=True,
            check=True,
        )
        options = set(re.findall(r"--[a-z][a-z-]*", done.stdout)) - {"--help", "--output"}
        assert {o for o in options if f"{command} {o}" not in text} == set()


def run_log(folder, *arguments):
    command = [sys.executable, "-m", "sepcal", "log", *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def test_the_command(folder, tmp_path):
    log = str(folder / "corrected.ulg")
    page = run_log(tmp_path, log, "-o", "f.csv", "--from", "30", "--to", "50")
    assert {file.name for file in tmp_path.iterdir()} == {"f.csv", "f.csv.json"}
    flight = sepcal.read_log(log, start=30, end=50)
    assert page.startswith(f"wrote f.csv: {flight.rows} rows of mag0 (magnetometer, device 197388")
    for words in (
        "undone: CAL_MAG0_?OFF, 0.11, -0.06, 0.19 G",
        "rows left out: 799, outside from 30 s to 50 s",
        "field by WMM-2020: 21.5266,1.2875,43.2224 uT",
        "also in the log: pitot0 (--sensor)",
        "next: sepcal-mag check f.csv --field-strength 48.3035",
    ):
        assert words in page
    told = run_log(tmp_path, log, "-o", "g.csv", "--from", "30", "--to", "50", "--json")
    assert json.loads(told) == flight.conversion
    assert (tmp_path / "f.csv").read_bytes() == (tmp_path / "g.csv").read_bytes()
    tube = run_log(tmp_path, log, "-o", "t.csv", "--sensor", "pitot0")
    assert "next: sepcal-pitot check t.csv" in tube


def test_the_list(folder, tmp_path):
    page = run_log(tmp_path, str(folder / "new.bin"), "--list")
    assert list(tmp_path.iterdir()) == []
    assert page == f"{sepcal.list_log(folder / 'new.bin')}\n"
    for words in (
        "DataFlash, ArduCopter V4.5.7",
        "starts 2024-03-18T08:46:",
        "undone: COMPASS_OFS, -118.4, 71.6, -196 mG",
        "disarmed",
        "sepcal-pitot fit pitot0.csv",
        "--field 21.5266,1.2875,43.2224",
    ):
        assert words in page
    told = json.loads(run_log(tmp_path, str(folder / "new.bin"), "--list", "--json"))
    modes = [(mode["maneuver"], mode["from_s"]) for mode in told["modes"]]
    assert modes == [("disarmed", 19.0), ("stabilize", 25.0), ("loiter", 50.0)]


def test_a_reader_that_has_enough(folder):
    """As with `| head`: no traceback."""
    command = f"'{sys.executable}' -m sepcal log '{folder / 'new.bin'}' --list | true"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert done.stderr == ""
