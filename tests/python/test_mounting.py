# SPDX-License-Identifier: BSD-3-Clause
"""A magnetometer that is turned against the body: found, given, carried by every later verb.

The flights are made here, m = R' (C h + n) with R of SciPy, so that m_body = R m_sensor.
"""

import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import headers
import sepcal
from apps import Log, Outcome, run
from recorded import find_case

FIELD = np.array([19.7, -1.4, 49.4])
C = np.array([[1.05, 0.02, -0.03], [0.02, 0.95, 0.01], [-0.03, 0.01, 1.1]])  # turns nothing
HARD_IRON = np.array([10.0, -5.0, 7.0])
NOISE = 0.2
APP = "sepcal-mag"
GIVEN = ("--field", "19.7,-1.4,49.4")
Array = NDArray[np.float64]


def turn(roll: float, pitch: float, yaw: float) -> Array:
    return Rotation.from_euler("ZYX", [yaw, pitch, roll], degrees=True).as_matrix()


def tumble(draw: np.random.Generator, rows: int) -> Array:
    """Roll, pitch and yaw [rad] that wander all round, shape (rows, 3)."""
    t = np.arange(rows) / 20.0
    rates = draw.uniform(0.5, 1.5, 3)
    return np.column_stack(
        [
            2.8 * np.sin(rates[0] * t),
            1.2 * np.sin(rates[1] * t + 1.0),
            np.pi * np.sin(0.7 * rates[2] * t + 2.0),
        ]
    )


def level(draw: np.random.Generator, rows: int) -> Array:
    """A vehicle that only turns about down."""
    heading = draw.uniform(0.5, 1.5) * np.arange(rows) / 20.0
    yaw = (heading + np.pi) % (2 * np.pi) - np.pi
    return np.column_stack([np.zeros(rows), np.zeros(rows), yaw])


def fly(
    file: Path,
    mounting: tuple[float, float, float],
    seed: int = 1,
    attitudes: Callable[[np.random.Generator, int], Array] = tumble,
    matrix: Array = C,
    rows: int = 800,
) -> Array:
    """Writes a flight; the true field in body axes, shape (rows, 3)."""
    draw = np.random.default_rng(seed)
    angles = attitudes(draw, rows)
    h = Rotation.from_euler("ZYX", angles[:, ::-1]).inv().apply(FIELD)
    body = h @ matrix.T + HARD_IRON
    m = body @ turn(*mounting) + draw.normal(0.0, NOISE, (rows, 3))
    table = np.column_stack([np.arange(rows) / 20.0, m, angles])
    names = "time_s,mx_ut,my_ut,mz_ut,roll_rad,pitch_rad,yaw_rad"
    np.savetxt(file, table, "%.10g", ",", header=names, comments="")
    return h


def fit(folder: Path, *options: str, code: int = 0) -> Outcome:
    done = run(APP, "fit", "flight.csv", *GIVEN, *options, folder=folder)
    assert done.code == code, done.err
    return done


MOUNTINGS = [(0.0, 0.0, 30.0), (180.0, 0.0, 0.0), (90.0, 0.0, 45.0), (-120.0, 40.0, 170.0)]


@pytest.mark.parametrize("mounting", MOUNTINGS)
def test_it_is_found(tmp_path: Path, mounting: tuple[float, float, float]):
    h = fly(tmp_path / "flight.csv", mounting, seed=int(mounting[2]) % 7)
    result = fit(tmp_path, "--mounting", "--json", "-o", "m.json").result
    found = result["options"]["mounting"]
    error = Rotation.from_matrix(turn(*found) @ turn(*mounting).T).magnitude()
    assert np.degrees(error) < 0.3
    assert result["restated"]["mounting"]["angles_deg"] == found
    assert result["status"] == "converged"
    assert max(result["rmse"].values()) < 1.1 * NOISE
    for name, value in zip(("n_x", "n_y", "n_z"), HARD_IRON, strict=True):
        entry = result["parameters"][name]
        assert abs(entry["value"] - value) < 0.1 + 4.5 * entry["standard_error"]
    applied = run(APP, "apply", "flight.csv", "m.json", "-o", "applied.csv", folder=tmp_path)
    assert applied.code == 0, applied.err
    log = Log(tmp_path / "applied.csv")
    corrected = np.column_stack([log.column(f"m{axis}_cal_ut") for axis in "xyz"])
    assert np.sqrt(np.mean((corrected - h) ** 2)) < 1.3 * NOISE


def test_one_that_is_given_is_the_fit_of_turned_readings(tmp_path: Path):
    mounting = (0.0, 180.0, 135.0)
    fly(tmp_path / "flight.csv", mounting, seed=5)
    given = fit(tmp_path, "--mounting", "0,180,135", "--json").result
    log = Log(tmp_path / "flight.csv")
    body = np.column_stack([log.column(f"m{axis}_ut") for axis in "xyz"]) @ turn(*mounting).T
    for i, axis in enumerate("xyz"):
        log.replace(f"m{axis}_ut", body[:, i])
    (tmp_path / "flight.csv").write_text(log.text())
    by_hand = fit(tmp_path, "--json").result
    for name, entry in by_hand["parameters"].items():
        assert given["parameters"][name]["value"] == pytest.approx(
            entry["value"], rel=1e-6, abs=1e-8
        )
    assert given["cost"] == pytest.approx(by_hand["cost"], rel=1e-9)
    assert "mounting" not in by_hand["options"]


def test_a_fit_without_it_says_what_to_type(tmp_path: Path):
    """Followed, the advice brings the error down to the noise."""
    fly(tmp_path / "flight.csv", (0.0, 0.0, 140.0), seed=6)
    done = run(APP, "fit", "flight.csv", *GIVEN, "--json", folder=tmp_path)
    (note,) = (line for line in done.err.splitlines() if "--mounting" in line)
    advised = note.split("give --mounting ")[1].split(" ")[0]
    assert [float(angle) for angle in advised.split(",")] == pytest.approx([0, 0, 140], abs=0.3)
    followed = fit(tmp_path, "--mounting", advised, "--json")
    assert "--mounting" not in followed.err
    assert max(followed.result["rmse"].values()) < 1.1 * NOISE
    assert max(done.result["rmse"].values()) > 5 * NOISE


@pytest.mark.parametrize("yaw", [0.0, 8.0])
def test_a_fit_that_holds_the_turn_says_nothing(tmp_path: Path, yaw: float):
    """A few degrees are what the misalignment is there for."""
    fly(tmp_path / "flight.csv", (0.0, 0.0, yaw), seed=7)
    assert "--mounting" not in fit(tmp_path).err


def test_a_turn_that_the_fit_can_hold_is_told_as_one(tmp_path: Path):
    """Of 30 deg the misalignment and the scales make the best, and look like faults."""
    fly(tmp_path / "flight.csv", (0.0, 0.0, 30.0), seed=11)
    (note,) = (line for line in fit(tmp_path).err.splitlines() if "--mounting" in line)
    assert "the sensor is turned by 30 deg" in note
    advised = note.split("give --mounting ")[1].split(" ")[0]
    followed = fit(tmp_path, "--mounting", advised, "--json")
    assert "--mounting" not in followed.err
    eta = (followed.result["parameters"][f"eta_{axis}"]["value"] for axis in "xyz")
    assert max(map(abs, eta)) < 0.1


def test_one_axis_tells_it_too(tmp_path: Path):
    """Of level turns the sensor's scale and soft iron are not known, its mounting is."""
    fly(tmp_path / "flight.csv", (0.0, 0.0, 120.0), 8, level, np.eye(3))
    done = run(APP, "fit", "flight.csv", *GIVEN, "--mounting", "--json", folder=tmp_path)
    found = done.result["options"]["mounting"]
    assert found == pytest.approx([0.0, 0.0, 120.0], abs=1.0)


def test_no_turn_tells_none(tmp_path: Path):
    fly(tmp_path / "flight.csv", (0.0, 0.0, 90.0), 9, lambda _, rows: np.zeros((rows, 3)))
    done = fit(tmp_path, "--mounting", code=2)
    assert "the field hardly turns about the sensor" in done.err
    assert "give --mounting its roll, pitch and yaw in degrees" in done.err


def test_a_mirror_is_no_mounting(tmp_path: Path):
    fly(tmp_path / "flight.csv", (0.0, 0.0, 0.0), seed=10, matrix=C @ np.diag([1.0, -1.0, 1.0]))
    assert "mirror the field" in fit(tmp_path, "--mounting", code=2).err


def test_later_verbs_turn_the_readings_too(tmp_path: Path):
    """Of a calibration in body axes and one of the sensor's, the same."""
    mounting = (10.0, -20.0, 150.0)
    fly(tmp_path / "flight.csv", mounting, seed=11)
    fit(tmp_path, "--mounting", "10,-20,150", "-o", "m.json")
    compared = run(APP, "compare", "flight.csv", "m.json", "--json", folder=tmp_path)
    assert compared.code == 0, compared.err
    assert max(compared.result["rmse"].values()) < 1.1 * NOISE
    diagnosed = run(APP, "diagnose", "flight.csv", "m.json", "--json", folder=tmp_path)
    assert diagnosed.code == 0, diagnosed.err
    assert diagnosed.result["verdict"] == "adequate"
    added = run(APP, "add", "flight.csv", "m.json", "bias[time]", "--json", folder=tmp_path)
    assert added.code == 0, added.err
    assert added.result["options"]["mounting"] == list(mounting)
    assert max(added.result["rmse"].values()) < 1.1 * NOISE


def test_a_header_turns_them_first(tmp_path: Path):
    fly(tmp_path / "flight.csv", (180.0, 0.0, 90.0), seed=12)
    fit(tmp_path, "--mounting", "-o", "m.json")
    done = run(APP, "export", "m.json", "--to", "c", "-o", "sensor.h", folder=tmp_path)
    assert done.code == 0, done.err
    run(APP, "apply", "flight.csv", "m.json", "-o", "applied.csv", folder=tmp_path)
    applied = Log(tmp_path / "applied.csv")
    readings = np.column_stack([applied.column(f"m{axis}_ut") for axis in "xyz"])
    expected = np.column_stack([applied.column(f"m{axis}_cal_ut") for axis in "xyz"])
    program = headers.build(tmp_path / "sensor.h", "c", "c99")
    status, found = headers.run_rows(program, readings)
    assert not np.any(status)
    assert np.abs(found - expected).max() < 1e-9


def test_an_autopilot_is_told_of_the_mounting(tmp_path: Path):
    """PX4's numbers are in the sensor's axes, before CAL_MAGn_ROT turns them; ArduPilot's after."""
    fly(tmp_path / "flight.csv", (0.0, 0.0, 90.0), seed=13)
    fit(tmp_path, "--mounting", "0,0,90", "-o", "m.json")
    names = ("CAL_MAG0_XOFF", "CAL_MAG0_YOFF", "CAL_MAG0_ZOFF")
    for target, said, offsets in (
        ("px4", "CAL_MAG0_ROT", HARD_IRON @ turn(0, 0, 90) / 100),
        ("ardupilot", "COMPASS_ORIENT", -10 * HARD_IRON),
    ):
        done = run(
            APP, "export", "m.json", "--to", target, "-o", "v", "--json", folder=tmp_path
        )  # fmt: skip
        assert done.code == 0, done.err
        assert said in done.err
        found = done.result["parameters"]
        keys = names if target == "px4" else [f"COMPASS_OFS_{axis}" for axis in "XYZ"]
        assert [found[key] for key in keys] == pytest.approx(offsets, abs=0.02 * abs(offsets).max())


def test_it_needs_a_known_field(tmp_path: Path):
    fly(tmp_path / "flight.csv", (0.0, 0.0, 0.0))
    options = ("--field-strength", "53.2", "--mounting", "0,0,90")
    done = run(APP, "fit", "flight.csv", *options, folder=tmp_path)
    assert (done.code, "--mounting is of no use to --field-strength" in done.err) == (2, True)
    done = fit(tmp_path, "--mounting", "north", code=2)
    assert "--mounting" in done.err
    with pytest.raises(sepcal.Error, match="mounting is of no use to field_strength"):
        sepcal.Magnetometer(field_strength=53.2, mounting=(0, 0, 90))
    with pytest.raises(sepcal.Error, match='give three angles \\[deg\\] or "estimate"'):
        sepcal.Magnetometer(FIELD, mounting="north")  # type: ignore[arg-type]


def test_the_same_in_python(tmp_path: Path):
    fly(tmp_path / "flight.csv", (0.0, 180.0, 30.0), seed=14)
    by_app = fit(tmp_path, "--mounting", "--threads", "1", "--json").result
    flight = sepcal.read_csv(tmp_path / "flight.csv")
    model = sepcal.Magnetometer(FIELD, mounting="estimate")
    assert pickle.loads(pickle.dumps(model)).mounting == "estimate"
    fitted = sepcal.fit(model, flight, threads=1)
    for name, entry in by_app["parameters"].items():
        assert fitted[name].value == entry["value"]
    again = sepcal.fit(
        sepcal.Magnetometer(FIELD, mounting=by_app["options"]["mounting"]), flight, threads=1
    )
    assert again["n_x"].value == fitted["n_x"].value
    columns = {"hx": np.ones(9), "mx": np.ones(9)}
    with pytest.raises(sepcal.Error, match="mounting turns the readings of a Flight"):
        sepcal.fit(model, columns)


def test_several_flights_share_it(tmp_path: Path):
    for seed, name in ((15, "a.csv"), (16, "b.csv")):
        fly(tmp_path / name, (0.0, 0.0, 60.0), seed=seed)
    options = (*GIVEN, "--mounting", "--json")
    done = run(APP, "fit", "a.csv", "b.csv", *options, folder=tmp_path)
    assert done.code == 0, done.err
    assert done.result["options"]["mounting"] == pytest.approx([0, 0, 60], abs=0.3)
    assert max(done.result["rmse"].values()) < 1.1 * NOISE


def test_the_case_of_30_deg(tmp_path: Path):
    case = find_case("mount_yaw30.csv")
    done = run(APP, "fit", case, *GIVEN, "--mounting", "--json", folder=tmp_path)
    assert done.code == 0, done.err
    found = done.result["options"]["mounting"]
    assert found[:2] == pytest.approx([0, 0], abs=0.3)
    assert abs(found[2]) == pytest.approx(30.0, abs=0.3)
    assert max(done.result["rmse"].values()) < 0.25
    plain = run(APP, "fit", case, *GIVEN, folder=tmp_path)
    assert "eta_z" in plain.out.splitlines()[2]  # which goes beyond its default bounds for it
    assert "the sensor is turned by 30 deg" in plain.err
