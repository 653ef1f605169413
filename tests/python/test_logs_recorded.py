# SPDX-License-Identifier: BSD-3-Clause
"""Two recorded logs end to end, each column against a reading of the log that shares no code."""

import json
import subprocess
import sys
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation, Slerp

import sepcal
from apps import Log, run
from oracle import dataflash_reader, ulog_reader
from recorded import find_fixture

pytest.importorskip("pyulog")
pytest.importorskip("pymavlink")
pytest.importorskip("pygeomag")

LOGS = ("arducopter_log.bin", "px4_log.ulg")
ROWS = 10


def log_command(*arguments, folder):
    command = [sys.executable, "-m", "sepcal", "log", *map(str, arguments)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


@pytest.fixture(scope="module", params=LOGS)
def converted(request, tmp_path_factory):
    """The log's name, the folder of flight.csv and its sidecar, and what was printed."""
    file = find_fixture(request.param)
    folder = tmp_path_factory.mktemp("converted")
    printed = log_command(file, "-o", "flight.csv", folder=folder)
    return request.param, folder, printed


@cache
def read_independently(name):
    """{column: (times, values)} as the log has them, before they are brought to other stamps."""
    data = find_fixture(name).read_bytes()
    return (read_dataflash if name.endswith(".bin") else read_ulog)(data)


def read_dataflash(data):
    """The compass' offsets are in the messages themselves, truncated as they are here."""
    messages = dataflash_reader.read_messages(data)

    def rows(kind, *columns, factor=1.0):
        found = [m for name, m in messages if name == kind]
        times = [m["TimeMS"] / 1000 for m in found]
        return np.array(times), np.array([[m[c] for c in columns] for m in found]) * factor

    times, mag = rows("MAG", "MagX", "MagY", "MagZ")
    _, offsets = rows("MAG", "OfsX", "OfsY", "OfsZ")
    gps = [m for name, m in messages if name == "GPS" and m["Status"] >= 3]
    return {
        "magnetometer": (times, (mag - offsets) / 10),
        "attitude": euler(*rows("ATT", "Yaw", "Pitch", "Roll")),
        "rates": rows("IMU", "GyrX", "GyrY", "GyrZ"),
        "altitude_m": rows("BARO", "Alt"),
        "temp_degc": rows("BARO", "Temp"),
        "throttle": rows("CTUN", "ThrOut", factor=1e-3),
        "place": (gps[0]["Lat"], gps[0]["Lng"], gps[0]["Alt"]),
        "day": 2014 + 338.45 / 365,
        "offsets": offsets[0],
    }


def euler(times, degrees):
    return times, Rotation.from_euler("ZYX", degrees, degrees=True)


def read_ulog(data):
    topics, parameters = ulog_reader.read_log(data)
    assert parameters["CAL_MAG0_XOFF"] == 0 == parameters["CAL_MAG0_XODIAG"]
    assert parameters["CAL_MAG0_ROT"] == -1
    assert parameters["SENS_BOARD_ROT"] == 0

    def rows(name, *columns, stamp="timestamp", kept=lambda _: True):
        found = [m for m in topics[name, 0] if kept(m)]
        times = [m[stamp] / 1e6 for m in found]
        return np.array(times), np.array([[m[c] for c in columns] for m in found])

    sampled = "timestamp_sample"
    vector = [f"magnetometer_ga[{i}]" for i in range(3)]
    times, mag = rows("vehicle_magnetometer", *vector, stamp=sampled)
    q_times, q = rows("vehicle_attitude", *(f"q[{i}]" for i in (1, 2, 3, 0)), stamp=sampled)
    thrust_times, thrust = rows("vehicle_thrust_setpoint", *(f"xyz[{i}]" for i in range(3)))
    gps = [m for m in topics["vehicle_gps_position", 0] if m["fix_type"] >= 3]
    return {
        "magnetometer": (times, 100 * mag),
        "attitude": (q_times, Rotation.from_quat(q)),
        "rates": rows("vehicle_angular_velocity", *(f"xyz[{i}]" for i in range(3)), stamp=sampled),
        "altitude_m": rows("vehicle_air_data", "baro_alt_meter", stamp=sampled),
        "throttle": (thrust_times, np.linalg.norm(thrust, axis=1, keepdims=True)),
        "voltage_v": rows("battery_status", "voltage_v"),
        "place": (gps[0]["latitude_deg"], gps[0]["longitude_deg"], gps[0]["altitude_msl_m"]),
        "day": 2024 + 77.6 / 366,
    }


def bring(times, values, t, every):
    """At t: the mean of the lines around it where twice as fast, else the line; written anew."""
    lines = [lambda at, column=column: np.interp(at, times, column) for column in values.T]
    if np.median(np.diff(times)) > every / 2:
        return np.array([line(t) for line in lines])
    window = np.linspace(t - every / 2, t + every / 2, 4001)
    return np.array([np.trapezoid(line(window), window) / every for line in lines])


def test_each_column_at_ten_times(converted):
    name, folder, _ = converted
    log, expected = Log(folder / "flight.csv"), read_independently(name)
    time = log.column("time_s")
    groups = {
        "magnetometer": ["mx_ut", "my_ut", "mz_ut"],
        "rates": ["p_radps", "q_radps", "r_radps"],
        **{
            header: [header]
            for header in ("altitude_m", "temp_degc", "throttle", "voltage_v")
            if header in log.headers
        },
    }
    field = ["bn_ut", "be_ut", "bd_ut", "field_strength_ut"]
    attitude = ["roll_rad", "pitch_rad", "yaw_rad"]
    seen = {
        "time_s",
        "maneuver",
        *attitude,
        *field,
        *(h for headers in groups.values() for h in headers),
    }
    assert set(log.headers) == seen  # none is left unchecked

    every = np.median(np.diff(expected["magnetometer"][0]))
    turned = Slerp(*expected["attitude"])
    for row in np.linspace(3, len(time) - 4, ROWS).astype(int):
        t = time[row]
        for group, headers in groups.items():
            want = bring(*expected[group], t, every)
            got = [log.column(header)[row] for header in headers]
            assert_allclose(got, want, rtol=1e-6, atol=2e-6, err_msg=f"{headers} at {t}")
        angles = [log.column(header)[row] for header in attitude[::-1]]
        apart = Rotation.from_euler("ZYX", angles).inv() * turned(t)
        assert apart.magnitude() < 1e-4
        earth = sepcal.earth_field(*expected["place"], expected["day"])
        want = [earth.north, earth.east, earth.down, earth.strength]
        got = [log.column(header)[row] for header in field]
        assert_allclose(got, want, atol=0.005)


def test_times_are_the_sensors(converted):
    name, folder, _ = converted
    time = Log(folder / "flight.csv").column("time_s")
    stamps = read_independently(name)["magnetometer"][0]
    assert np.isin(time, stamps).all()
    assert len(time) > 0.99 * len(stamps)


def test_the_sidecar(converted):
    name, folder, _ = converted
    told = json.loads((folder / "flight.csv.json").read_text())
    log = Log(folder / "flight.csv")
    assert set(told["columns"]) == set(log.headers) - {"maneuver"}
    assert told["rows"] == len(log.rows)
    assert told["log"]["file"].endswith(name)
    first = {"px4_log.ulg": "2024-03-18T14:49:10.454Z", LOGS[0]: "2014-12-05T10:54:51.569Z"}
    assert told["utc"]["first_row"] == first[name]


def test_modes_are_maneuvers(converted):
    name, folder, _ = converted
    log = Log(folder / "flight.csv")
    labels = [row[log.index("maneuver")] for row in log.rows]
    expected = {
        LOGS[0]: ["alt_hold", "loiter", "guided", "auto", "land"],
        LOGS[1]: ["disarmed", "takeoff", "hold", "return"],
    }
    assert list(dict.fromkeys(labels)) == expected[name]


def test_calibrated_by_strength_and_compared(converted):
    name, folder, printed = converted
    strength = json.loads((folder / "flight.csv.json").read_text())["field"]["strength_ut"]
    assert f"--field-strength {strength:.4f}" in printed
    option = ("--field-strength", f"{strength:.4f}")
    checked = run("sepcal-mag", "check", "flight.csv", *option, folder=folder)
    assert checked.code == 0
    assert "a fit would take all rows" in checked.out
    fitted = run("sepcal-mag", "fit", "flight.csv", *option, "-o", "base.json", folder=folder)
    # The simulated vehicle of one log hardly turns, and sepcal says so.
    assert fitted.code == (0 if name == LOGS[0] else 4), fitted.err
    compared = run("sepcal-mag", "compare", "flight.csv", "base.json", folder=folder)
    assert compared.code == 0
    assert "segment" in compared.out
    against = run("sepcal-mag", "fit", "flight.csv", "-o", "field.json", folder=folder)
    assert against.code == fitted.code


def test_the_hard_iron_is_the_raw_sensors(tmp_path):
    """A fit to what the log reports differs by the offsets alone, which it had added."""
    file = find_fixture(LOGS[0])
    log_command(file, "-o", "raw.csv", folder=tmp_path)
    reported = Log(tmp_path / "raw.csv")
    offsets = read_independently(LOGS[0])["offsets"] / 10
    assert_allclose(offsets, [-3.6, 0.1, -5.6])
    for header, offset in zip(("mx_ut", "my_ut", "mz_ut"), offsets, strict=True):
        reported.replace(header, reported.column(header) + offset)
    (tmp_path / "reported.csv").write_text(reported.text())
    for option in (("--field-strength", "45.749"), ("--field", "24.1973,-0.4105,38.8239")):
        raw, corrected = (
            run("sepcal-mag", "fit", f"{name}.csv", *option, "--json", folder=tmp_path).result
            for name in ("raw", "reported")
        )
        for axis, offset in zip("xyz", offsets, strict=True):
            n_raw, n_corrected = (
                fit["parameters"][f"n_{axis}"]["value"] for fit in (raw, corrected)
            )
            assert_allclose(n_raw - n_corrected, -offset, atol=2e-3)
            lambdas = [fit["parameters"][f"lambda_{axis}"]["value"] for fit in (raw, corrected)]
            assert_allclose(*lambdas, atol=1e-4)


def test_listed(converted):
    name, folder, _ = converted
    page = log_command(find_fixture(name), "--list", folder=folder)
    for words in ("mag0", "attitude", "velocity", "position", "throttle", "can be calibrated:"):
        assert words in page
    assert "sepcal-mag fit mag0.csv --field-strength" in page
    told = json.loads(log_command(find_fixture(name), "--list", "--json", folder=folder))
    assert [s["name"] for s in told["sensors"]] == ["mag0"]


@pytest.mark.parametrize("name", LOGS)
@pytest.mark.parametrize("share", [0.3, 0.71])  # inside a message, by luck
def test_cut_off(name, share, tmp_path):
    data = find_fixture(name).read_bytes()
    file = tmp_path / name
    file.write_bytes(data[: int(share * len(data))])
    with pytest.raises(sepcal.Error, match="cut off inside"):
        sepcal.read_log(file)
    whole = sepcal.read_log(find_fixture(name), field=False)
    part = sepcal.read_log(file, cut_off=True, field=False)
    assert 0.8 * share * whole.rows < part.rows < whole.rows
    inner = slice(0, part.rows - 20)
    assert_allclose(part["mx_ut"][inner], whole["mx_ut"][: part.rows][inner])


def test_reading_a_ulog_leaves_the_streams_alone(monkeypatch, capsys):
    """They are the whole process', and threads that read side by side restored each other's."""
    import pyulog.core

    before = sys.stdout, sys.stderr
    seen = []

    def parse(*_, **__):
        pyulog.core.print("damaged here")
        seen.append((sys.stdout, sys.stderr))
        raise ValueError("no more")

    monkeypatch.setattr(pyulog, "ULog", parse)
    with pytest.raises(sepcal.Error, match="no more"):
        sepcal.read(find_fixture("px4_log.ulg"))
    assert seen == [before]
    pyulog.core.print("another's reading")
    assert capsys.readouterr() == ("another's reading\n", "")
