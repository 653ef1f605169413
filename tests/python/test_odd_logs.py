# SPDX-License-Identifier: BSD-3-Clause
"""Logs with changes on the way, with gaps, of other makes, and without most."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import flown_dataflash
import flown_flight as flown
import flown_ulog
import sepcal
from flown_logs import magnetic, stack, turns_between, write, write_logs
from log_writers import DataFlashWriter, ULogWriter
from oracle.dataflash_reader import read_messages

pytest.importorskip("pyulog")
pytest.importorskip("pymavlink")
pytest.importorskip("pygeomag")

MILLIGAUSS = 0.1  # [uT]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return write_logs(tmp_path_factory.mktemp("logs"))


def test_the_check_against_raw_samples_speaks_up(tmp_path):
    """A correction that the parameters don't tell: more than noise between raw and undone."""
    data = flown_ulog.new_ulog(1.0, 20.0).data()
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
    parameters = {n: v for n, v in flown_dataflash.ARDUPILOT.items() if n != "COMPASS_SCALE"}
    log = flown_dataflash.new_dataflash(parameters)
    for at, (time, order, message) in enumerate(log._messages):
        if message[2] == log._forms["MAG"][0] and message[11] == 0:
            taken = time - 0.004
            amperes = flown.current([taken])
            reading, motors = flown_dataflash.ardupilot_corrects(
                flown.raw([taken]), amperes, parameters, before=True
            )
            offsets = [parameters[f"COMPASS_OFS_{a}"] for a in "XYZ"]
            s = round(taken * 1e6)
            values = (*np.round(reading[0]), *offsets, *np.round(motors[0]), 1, s)
            log._messages[at] = (time, order, log._pack("MAG", round(time * 1e6), 0, *values))
    flight = sepcal.read_log(write(tmp_path, "a.bin", log))
    assert_allclose(magnetic(flight), flown.raw(flight["time_s"]), atol=1.5 * MILLIGAUSS)


def test_parameters_that_change_on_the_way(tmp_path):
    log = flown_ulog.new_ulog(raw_rate=0, corrected_rate=20.0)
    changed = tuple((dict(flown_ulog.PX4) | {"CAL_MAG0_XOFF": 0.21}).items())
    later = flown_ulog.new_ulog(raw_rate=0, corrected_rate=20.0, parameters=changed)
    half = flown.START + 30
    log._messages = [m for m in log._messages if m[0] < half]
    log._messages += [m for m in later._messages if m[0] >= half]
    log.set(half - 0.01, "CAL_MAG0_XOFF", 0.21)
    flight = sepcal.read_log(write(tmp_path, "a.ulg", log))
    assert_allclose(magnetic(flight), flown.raw(flight["time_s"]), atol=1e-4)


def test_offsets_that_were_learned_in_flight(tmp_path):
    """The log's own offsets count where the parameter is another."""
    parameters = flown_dataflash.ARDUPILOT | {"COMPASS_OFS_X": -300.0}
    log = flown_dataflash.new_dataflash()
    stale = flown_dataflash.new_dataflash(parameters)
    log._messages = [
        (stale._messages[i] if m[2][2] == log._forms["PARM"][0] else m)
        for i, m in enumerate(log._messages)
    ]
    flight = sepcal.read_log(write(tmp_path, "a.bin", log))
    assert_allclose(magnetic(flight), flown.raw(flight["time_s"]), atol=2 * MILLIGAUSS)
    done = " ".join(flight.conversion["columns"]["mx_ut"]["done"])
    assert "the offsets as logged" in done


def test_a_gap_stays_a_gap(tmp_path):
    log = flown_ulog.new_ulog(raw_rate=20.0)
    attitude = [m for m in log._messages if len(m[2]) == 3 + 2 + 8 + 16]
    lost = {m[:2] for m in attitude if 40 < m[0] < 42}
    log._messages = [m for m in log._messages if m[:2] not in lost]
    flight = sepcal.read_log(write(tmp_path, "a.ulg", log))
    t = flight["time_s"]
    assert not ((t > 40.1) & (t < 41.9)).any()
    assert flight.conversion["left_out"]["nothing for roll_rad"] >= 38
    assert turns_between(flight, flown.attitude(t)).max() < 5e-3


def test_stamps_that_repeat_or_jump(tmp_path):
    log = flown_dataflash.old_dataflash()
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
    log = flown_dataflash.new_dataflash()
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
    log = ULogWriter(flown_ulog.PX4)
    log.form("vehicle_gps_position", "int32_t lat;int32_t lon;int32_t alt;uint64_t time_utc_usec")
    log.form("vehicle_magnetometer", "float[3] magnetometer_ga")
    for t in flown.at_rate(10):
        unix = round((1_710_742_386.0 + t) * 1e6)
        log.add(t, "vehicle_gps_position", 474000000, 85000000, 500000, unix)
        still = dict(flown_ulog.PX4) | {f"CAL_MAG0_{a}COMP": 0.0 for a in "XYZ"}
        log.add(t, "vehicle_magnetometer", *flown_ulog.px4_corrects([t], still)[0])
    flight = sepcal.read_log(write(tmp_path, "a.ulg", log))
    assert_allclose(magnetic(flight), flown.raw(flight["time_s"]), atol=1e-4)
    expected = sepcal.earth_field(*flown.PLACE, "2024-03-18")
    assert_allclose(flight["field_strength_ut"], expected.strength, atol=1e-3)


def test_two_magnetometers_of_a_ulog(tmp_path):
    """Each is undone by the parameters that name its device, in whatever order."""
    second = [(n.replace("MAG0", "MAG1"), v) for n, v in flown_ulog.PX4 if n.startswith("CAL_MAG0")]
    first = [("CAL_MAG0_ID", 5), ("CAL_MAG0_XOFF", 0.3), ("CAL_MAG0_ROT", 0)]
    written = ULogWriter([*first, *second, ("CAL_MAG_COMP_TYP", 2)])
    fields = "uint64_t timestamp_sample;uint32_t device_id;float[3] magnetometer_ga"
    written.form("vehicle_magnetometer", fields)
    written.form("battery_status", "float voltage_v;float current_a")
    written.form("vehicle_status", "uint8_t nav_state;uint8_t arming_state")
    for t in flown.at_rate(20):
        stamp = round(t * 1e6)
        corrected = flown_ulog.px4_corrects([t])[0]
        written.add(
            t + 0.005, "vehicle_magnetometer", stamp, flown_ulog.DEVICE, *corrected, instance=1
        )
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
    assert titles == ["device 5, CAL_MAG0", f"device {flown_ulog.DEVICE}, CAL_MAG1"]


@pytest.mark.parametrize("name", ["new.bin", "old.bin"])
def test_a_log_as_text(folder, tmp_path, name):
    """As ground stations wrote it: numbers in their units, modes by name."""
    lines = []
    for kind, message in read_messages((folder / name).read_bytes()):
        values = dict(message)
        if kind == "MODE":
            values["Mode"] = {0: "STABILIZE", 5: "LOITER", 10: "AUTO"}[message["Mode"]]
            values.pop("ModeNum", None)
        if kind == "FMT" and values["Name"] == "MODE":
            values["Format"] = values["Format"].replace("QMBB", "QMB")
            values["Columns"] = values["Columns"].replace("ModeNum,", "")
        cells = (f"{v:.9g}" if isinstance(v, float) else str(v) for v in values.values())
        lines.append(", ".join((kind, *cells)))
    text = "\n".join(lines) + "\n"
    flight = sepcal.read_log(write(tmp_path, "a.log", text.encode()))
    binary = sepcal.read_log(folder / name)
    assert flight.columns == binary.columns
    for header in binary:
        assert_allclose(flight[header], binary[header], rtol=1e-6, atol=1e-6, err_msg=header)
    assert flight.maneuvers == binary.maneuvers
    with pytest.raises(sepcal.Error, match=r"cut off inside line .*, the last"):
        sepcal.read_log(write(tmp_path, "b.log", text[:-3].encode()))
