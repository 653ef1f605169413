# SPDX-License-Identifier: BSD-3-Clause
"""Autopilots' logs, old and new, against the formulas of the flight that they are of."""

import datetime
import json

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation, Slerp

import flown_dataflash
import flown_flight as flown
import sepcal
from flown_logs import LOGS, magnetic, stack, turns_between, write_logs
from sepcal.logs.clock import count_leaps
from sepcal.logs.mounting import rotation_of

pytest.importorskip("pyulog")
pytest.importorskip("pymavlink")
pytest.importorskip("pygeomag")

MILLIGAUSS = 0.1  # [uT]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return write_logs(tmp_path_factory.mktemp("logs"))


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
    expected = week + datetime.timedelta(
        seconds=flown_dataflash.WEEK_START + told["span"]["from_s"] - 18
    )
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
