# SPDX-License-Identifier: BSD-3-Clause
"""Several tables of one file, each with a clock of its own, as one flight; and autopilots' logs."""

import json
import subprocess
import sys

import numpy as np
import pytest

import flown_logs
import sepcal
from refusals import refuse
from sepcal.reading import AIR, MAGNETIC, reading_for

h5py = pytest.importorskip("h5py")
pytest.importorskip("mcap")

T0 = 1_772_366_400  # 2026-03-01 12:00 UTC
GEOMETRY = """geometry_msgs/Vector3 {0}
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
"""
HEADER = """================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""


def speed(time):
    return 20 + 3 * np.sin(time / 9)


def field(time):
    return np.stack([20 * np.cos(time / 7), 20 * np.sin(time / 7), 40 + time / 50], axis=1)


def yaw(time):
    """Degrees, which wrap at 180."""
    return (time * 12 + 170 + 180) % 360 - 180


def write_groups(file, with_air=True, with_mag=True):
    """A magnetometer at 20 Hz, a tube at 5 Hz in microseconds, an attitude at 10 Hz."""
    fast, slow, middle = np.arange(0, 60, 0.05), np.arange(0.02, 60, 0.2), np.arange(0.01, 60, 0.1)
    with h5py.File(file, "w") as opened:
        if with_mag:
            opened["mag/time_s"] = fast
            for axis, values in zip("xyz", field(fast).T, strict=True):
                opened[f"mag/m{axis}_ut"] = values
        if with_air:
            opened["air/TimeUS"] = np.round(slow * 1e6).astype(np.int64)
            opened["air/airspeed_mps"] = speed(slow)
        opened["att/time_s"] = middle
        opened["att/yaw_deg"] = yaw(middle)
        opened["info/serial"] = np.arange(7)
    return fast, slow


def test_rows_are_those_of_the_measured_sensor(tmp_path):
    fast, _ = write_groups(tmp_path / "a.h5", with_air=False)
    flight = sepcal.read(tmp_path / "a.h5")
    np.testing.assert_array_equal(flight["time_s"], fast)
    inside = (fast > 0.1) & (fast < 59.8)
    np.testing.assert_allclose(flight["yaw_deg"][inside], yaw(fast[inside]), atol=1e-9)
    notes = " ".join(flight.notes)
    assert "rows are those of table 'mag'" in notes
    assert "table 'att' comes to these rows interpolated from 10 Hz" in notes
    assert "left out: info" in notes


@pytest.mark.parametrize(
    ("kind", "header", "rows"), [(MAGNETIC, "mx_ut", 1200), (AIR, "airspeed_mps", 300)]
)
def test_a_verb_takes_the_sensor_of_its_subject(kind, header, rows, tmp_path):
    write_groups(tmp_path / "a.h5")
    with reading_for(kind):
        flight = sepcal.read(tmp_path / "a.h5")
    assert flight.rows == rows
    assert np.isfinite(flight[header]).all()


def test_rows_of_both_where_nobody_said_which(tmp_path):
    fast, slow = write_groups(tmp_path / "a.h5")
    flight = sepcal.read(tmp_path / "a.h5")
    assert flight.rows == fast.size + slow.size
    assert (np.diff(flight["time_s"]) >= 0).all()
    of_air = np.isfinite(flight["airspeed_mps"])
    np.testing.assert_allclose(flight["airspeed_mps"][of_air], speed(slow), atol=1e-12)
    np.testing.assert_array_equal(flight["time_s"][np.isfinite(flight["mx_ut"])], fast)
    assert of_air.sum() + np.isfinite(flight["mx_ut"]).sum() == flight.rows
    inside = (flight["time_s"] > 0.1) & (flight["time_s"] < 59.8)
    assert np.isfinite(flight["yaw_deg"][inside]).all()
    assert any("'::mag' behind the file" in note for note in flight.notes)
    one = sepcal.read(f"{tmp_path / 'a.h5'}::air")
    np.testing.assert_allclose(one["airspeed_mps"], speed(slow), atol=1e-12)
    assert one.rows == slow.size
    assert one.name.endswith("a.h5::air")


def test_two_that_measure_the_same_are_named(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as opened:
        for name in ("left", "right"):
            opened[f"{name}/time_s"] = np.arange(20.0)
            opened[f"{name}/airspeed_mps"] = np.arange(20.0) + (name == "right")
    file = str(tmp_path / "a.h5")
    refuse(lambda: sepcal.read(file), "'left', 'right'", f"'{file}::left'")
    assert sepcal.read(f"{file}::left")["airspeed_mps"][0] == 0.0
    both = sepcal.read(file, table="right")
    assert both["airspeed_mps"][0] == 1.0
    assert both["left.airspeed_mps"][0] == 0.0
    refuse(lambda: sepcal.read(file, table="up"), "no table 'up'", "left, right")


def test_tables_that_begin_on_either_side_of_midnight(tmp_path):
    before = np.int64(T0 + 12 * 3600) * 10**6  # of March 2, in us
    with h5py.File(tmp_path / "a.h5", "w") as opened:
        opened["air/timestamp"] = before + np.arange(-500_000, 2_000_000, 100_000)
        opened["air/airspeed_mps"] = np.arange(25.0)
        opened["gps/timestamp"] = before + np.arange(100_000, 2_000_000, 100_000)
        opened["gps/vn_mps"] = np.arange(6, 25.0)
    flight = sepcal.read(tmp_path / "a.h5")
    np.testing.assert_allclose(flight["time_s"], 86399.5 + np.arange(25) / 10, atol=1e-6)
    np.testing.assert_allclose(flight["vn_mps"][7:], flight["airspeed_mps"][7:], atol=1e-6)


def test_matlab_variables_with_clocks_of_their_own(tmp_path):
    from scipy.io import savemat

    fast, slow = np.arange(0, 30, 0.05), np.arange(0, 30, 0.25)
    variables = {"t_mag": fast, "mag_ut": field(fast), "t_air": slow, "tas_kmh": 3.6 * speed(slow)}
    savemat(tmp_path / "a.mat", variables)
    with reading_for(AIR):
        flight = sepcal.read(tmp_path / "a.mat")
    np.testing.assert_array_equal(flight["time_s"], slow)
    np.testing.assert_allclose(flight["tas_kmh"], 3.6 * speed(slow))
    inside = slow < 29
    expected = field(slow)[inside, 0]
    np.testing.assert_allclose(
        flight["mag_ut[0]"][inside], expected, atol=2e-3
    )  # a mean over 0.25 s


def test_mcap_topics_in_json(tmp_path):
    from mcap.writer import Writer

    with open(tmp_path / "a.mcap", "wb") as opened:
        writer = Writer(opened)
        writer.start()
        schema = writer.register_schema("any", "jsonschema", b"{}")
        air = writer.register_channel("/air", "json", schema)
        gps = writer.register_channel("/gps", "json", schema)
        other = writer.register_channel("/camera", "protobuf", schema)
        writer.add_message(other, T0 * 10**9, b"\x01\x02", 0)
        for row in range(100):
            at = T0 * 10**9 + row * 200_000_000
            message = {"airspeed_mps": speed(row * 0.2), "state": {"ok": True, "name": "x"}}
            writer.add_message(air, at, json.dumps(message).encode(), at)
            later = at + 50_000_000
            velocity = {"vn_mps": 10 + row * 0.2 + 0.05, "ve_mps": 1.0, "vd_mps": 0.0}
            writer.add_message(gps, later, json.dumps(velocity).encode(), later)
        writer.finish()
    flight = sepcal.read(tmp_path / "a.mcap")
    time = np.arange(100) * 0.2
    np.testing.assert_allclose(flight["time_s"], 43200 + time, atol=1e-9)
    np.testing.assert_allclose(flight["airspeed_mps"], speed(time))
    np.testing.assert_allclose(flight["vn_mps"][1:], 10 + time[1:], atol=1e-9)
    assert flight["state.ok"].tolist() == [1.0] * 100
    assert any("/camera (protobuf) is left out" in note for note in flight.notes)


def test_mcap_of_ros_2(tmp_path):
    """Axes forward, left, up and east, north, up become sepcal's, units too."""
    from mcap_ros2.writer import Writer
    from scipy.spatial.transform import Rotation

    with open(tmp_path / "a.mcap", "wb") as opened:
        writer = Writer(opened)
        mag = writer.register_msgdef(
            "sensor_msgs/msg/MagneticField",
            "std_msgs/Header header\n" + GEOMETRY.format("magnetic_field") + HEADER,
        )
        imu = writer.register_msgdef(
            "sensor_msgs/msg/Imu",
            "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
            + GEOMETRY.format("angular_velocity")
            + HEADER
            + "=" * 80
            + "\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
        )
        angles = np.radians([[30.0, 10.0, -5.0], [200.0, -20.0, 40.0]])  # yaw, pitch, roll
        for row in range(2):
            head = {"stamp": {"sec": T0 + row, "nanosec": 500_000_000}, "frame_id": "imu_link"}
            body = np.array([20e-6 + row * 1e-6, 1e-6, 40e-6])  # forward, right, down
            vector = dict(zip("xyz", (body * [1, -1, -1]).tolist(), strict=True))
            writer.write_message(
                "/mag", mag, {"header": head, "magnetic_field": vector}, T0 * 10**9
            )
            to_ned = Rotation.from_euler("ZYX", angles[row]).as_matrix()
            swap = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]])
            x, y, z, w = Rotation.from_matrix(swap @ to_ned @ np.diag([1.0, -1, -1])).as_quat()
            turn = {"x": x, "y": y, "z": z, "w": w}
            rate = {"x": 0.1, "y": -0.2, "z": -0.3}
            message = {"header": head, "orientation": turn, "angular_velocity": rate}
            writer.write_message("/imu", imu, message, T0 * 10**9)
        writer.finish()
    flight = sepcal.read(tmp_path / "a.mcap")
    assert flight["time_s"].tolist() == [43200.5, 43201.5]
    np.testing.assert_allclose(flight["mx_ut"], [20, 21])
    np.testing.assert_allclose(flight["my_ut"], 1)
    np.testing.assert_allclose(flight["mz_ut"], 40)
    np.testing.assert_allclose([flight[f"{a}_radps"][0] for a in "pqr"], [0.1, 0.2, 0.3])
    q = np.stack([flight[name] for name in ("qx", "qy", "qz", "qw")], axis=1)
    turned = Rotation.from_quat(q) * Rotation.from_euler("ZYX", angles).inv()
    np.testing.assert_allclose(turned.magnitude(), 0, atol=1e-12)
    assert any("header.stamp" in note for note in flight.notes)
    assert any("REP 103" in note for note in flight.notes)


# --- autopilots' logs


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    for library in ("pyulog", "pymavlink", "pygeomag"):
        pytest.importorskip(library)
    return flown_logs.write_logs(tmp_path_factory.mktemp("logs"))


@pytest.mark.parametrize("name", list(flown_logs.LOGS))
@pytest.mark.parametrize("kind", [MAGNETIC, AIR])
def test_a_log_is_what_the_converter_writes(name, kind, folder, tmp_path):
    sensor = "mag0" if kind == MAGNETIC else "pitot0"
    file = folder / name
    if sensor not in sepcal.list_log(file).sensors:
        pytest.skip(f"{name} has no {sensor}")
    converted = sepcal.read_log(file, sensor)
    converted.save(tmp_path / "a.csv")
    expected = sepcal.read_csv(tmp_path / "a.csv")
    with reading_for(kind):
        flight = sepcal.read(file)
    assert list(flight) == list(expected)
    for header in flight:
        np.testing.assert_array_equal(flight[header], expected[header])
    assert flight.maneuvers == expected.maneuvers
    assert flight.sha256 == converted.conversion["log"]["sha256"]
    named = sepcal.read(f"{file}::{sensor}")
    np.testing.assert_array_equal(named["time_s"], flight["time_s"])


def test_a_fit_takes_a_log(folder):
    file = folder / "new.bin"
    for probe, sensor in (
        (sepcal.Magnetometer(field_strength=48.3), "mag0"),
        (sepcal.PitotStatic(), "pitot0"),
    ):
        expected = sepcal.fit(probe, sepcal.read_log(file, sensor))
        fitted = sepcal.fit(probe, file)
        assert fitted.values.tolist() == expected.values.tolist()
        assert any(f"readings of {sensor}" in note for note in fitted.notes)
        again = fitted.compare(str(file))
        assert again.residuals.tolist() == expected.compare().residuals.tolist()


@pytest.mark.parametrize(
    ("words", "name", "sensor"),
    [
        (("mag", "fit", "--field-strength", "48.3"), "new.bin", "mag0"),
        (("mag", "fit", "--field-strength", "48.3"), "new.bin::mag0", "mag0"),
        (("pitot", "fit"), "new.bin", "pitot0"),
        (("pitot", "fit"), "new.ulg", "pitot0"),
    ],
)
def test_the_command_line_takes_a_log(words, name, sensor, folder, tmp_path):
    command = [sys.executable, "-m", "sepcal", *words, str(folder / name), "-o", "base.json"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    probe = sepcal.load(tmp_path / "base.json")
    log, _, _ = name.partition("::")
    model = sepcal.PitotStatic() if sensor == "pitot0" else sepcal.Magnetometer(field_strength=48.3)
    expected = sepcal.fit(model, sepcal.read_log(folder / log, sensor))
    assert probe.values.tolist() == expected.values.tolist()
    compared = subprocess.run(
        [*command[:4], "compare", command[-3], "base.json"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert compared.returncode in (0, 3), compared.stderr


def test_a_text_has_no_tables(folder, tmp_path):
    (tmp_path / "a.csv").write_text("time_s,airspeed_mps\n0,1\n1,2\n")
    for read in (sepcal.read, sepcal.read_csv):
        refuse(lambda read=read: read(f"{tmp_path / 'a.csv'}::x"), "a.csv: it is one table", "'x'")
        refuse(lambda read=read: read(f"{tmp_path / 'b.csv'}::x"), "b.csv::x: no such file")


def test_both_sensors_of_a_log(folder):
    file = folder / "new.bin"
    flight = sepcal.read(file)
    rows = [sepcal.read_log(file, sensor).rows for sensor in ("mag0", "pitot0")]
    assert flight.rows == sum(rows)
    assert np.isfinite(flight["mx_ut"]).sum() == rows[0]
    assert any("mag0 and of pitot0" in note for note in flight.notes)
    magnetometer = sepcal.Magnetometer(field_strength=48.3)
    fitted = sepcal.fit(magnetometer, flight, drop_invalid=True)
    expected = sepcal.fit(magnetometer, sepcal.read_log(file, "mag0"))
    np.testing.assert_allclose(fitted.values, expected.values, rtol=1e-6)


def test_a_log_without_the_sensor_that_is_meant(folder, tmp_path):
    refuse(lambda: sepcal.read(folder / "new.bin", "mag9"), "no sensor 'mag9'", "mag0")


def test_a_cut_log_is_read_as_far_as_it_is_whole(folder, tmp_path):
    data = (folder / "new.ulg").read_bytes()
    (tmp_path / "a.ulg").write_bytes(data[: len(data) // 2 + 3])
    flight = sepcal.read(tmp_path / "a.ulg", "mag0")
    assert flight.rows == sepcal.read_log(tmp_path / "a.ulg", "mag0", cut_off=True).rows
    assert any("cut off inside" in note for note in flight.notes)
