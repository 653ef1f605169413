# SPDX-License-Identifier: BSD-3-Clause
"""An aircraft's columns are checked before they are believed.

Codes, glitches and frozen rows are planted in every column in turn: they are told by that column
alone, and what is hidden is found all the same, by equation error and along a path.
"""

import csv
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from apps import Outcome, run
from faults import FAULTS, ROWS, Columns, write
from recorded import find_fixture

Array = NDArray[np.float64]

GRAVITY = 9.80665
AREA, CHORD, SPAN, MASS = 16.2, 1.49, 10.9, 1050.0
INERTIA = (1285.0, 1825.0, 2667.0, 60.0)
GEOMETRY = {
    "area_m2": AREA,
    "chord_m": CHORD,
    "span_m": SPAN,
    "mass_kg": MASS,
    "inertia_kgm2": INERTIA,
    "rate_reference": "c/2V",
}
ANGLES = ("alpha_rad", "beta_rad", "roll_rad", "pitch_rad", "yaw_rad")
SPREAD = {
    **dict.fromkeys(("ax_mps2", "ay_mps2", "az_mps2"), 0.02),
    **dict.fromkeys(("p_radps", "q_radps", "r_radps"), 0.0005),
    **dict.fromkeys(ANGLES, 0.001),
    **dict.fromkeys(("vn_mps", "ve_mps", "vd_mps", "airspeed_mps"), 0.05),
    "elevator_rad": 0.0005,
    "rho_kgpm3": 0.0005,
    "altitude_m": 0.5,
    "imu_temp_degc": 0.05,
}


def motion(t: Array) -> tuple[Array, ...]:
    """Airspeed [m/s], alpha, beta, roll, pitch and yaw [rad]: turns, waves, a dive and a climb."""
    return (
        55 + 4 * np.sin(0.19 * t),
        0.05 + 0.04 * np.sin(0.9 * t) + 0.02 * np.sin(2.3 * t + 1),
        0.03 * np.sin(0.7 * t + 2),
        0.4 * np.sin(0.31 * t),
        0.05 + 0.1 * np.sin(0.43 * t + 1) + 0.02 * np.sin(3.1 * t),
        0.08 * t + 0.3 * np.sin(0.2 * t),
    )


def air(t: Array) -> Array:
    """Velocity through the air in body axes [m/s], shape (3, N)."""
    speed, alpha, beta = motion(t)[:3]
    return speed * np.array(
        [np.cos(alpha) * np.cos(beta), np.sin(beta), np.sin(alpha) * np.cos(beta)]
    )


def rates(t: Array) -> Array:
    """p, q, r [rad/s], shape (3, N)."""
    roll, pitch = motion(t)[3:5]
    droll, dpitch, dyaw = slope(lambda at: np.array(motion(at)[3:]), t)
    return np.array(
        [
            droll - dyaw * np.sin(pitch),
            dpitch * np.cos(roll) + dyaw * np.cos(pitch) * np.sin(roll),
            dyaw * np.cos(pitch) * np.cos(roll) - dpitch * np.sin(roll),
        ]
    )


def slope(f: Callable[[Array], Array], t: Array, h: float = 1e-4) -> Array:
    """The derivative in time."""
    return (f(t + h) - f(t - h)) / (2 * h)


def to_ground(t: Array, body: Array) -> Array:
    """North, east, down of a vector in body axes, shape (3, N)."""
    roll, pitch, yaw = motion(t)[3:]
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (np.cos, np.sin))
    x, y, z = body
    ahead = cp * x + sp * (sr * y + cr * z)
    right = cr * y - sr * z
    return np.array(
        [cy * ahead - sy * right, sy * ahead + cy * right, cp * (sr * y + cr * z) - sp * x]
    )


def fly() -> Columns:
    """A minute at 25 Hz in a wind of (4, -3) m/s, without errors but noise."""
    t = 0.04 * np.arange(ROWS)
    speed, alpha, beta, roll, pitch, yaw = motion(t)
    turn = rates(t)
    down = GRAVITY * np.array(
        [-np.sin(pitch), np.sin(roll) * np.cos(pitch), np.cos(roll) * np.cos(pitch)]
    )
    force = slope(air, t) + np.cross(turn, air(t), axis=0) - down
    ground = to_ground(t, air(t)) + np.array([[4.0], [-3.0], [0.0]])
    names = ("ax_mps2", "ay_mps2", "az_mps2", "p_radps", "q_radps", "r_radps", "airspeed_mps")
    columns = dict(zip(names, (*force, *turn, speed), strict=True))
    columns |= dict(zip(ANGLES, (alpha, beta, roll, pitch, yaw), strict=True))
    columns |= dict(zip(("vn_mps", "ve_mps", "vd_mps"), ground, strict=True))
    columns["rho_kgpm3"] = 1.1 + 0.005 * np.sin(0.1 * t)
    columns["altitude_m"] = 1000 + 60 * np.sin(0.2 * t)
    columns["imu_temp_degc"] = 30 + 6 * np.sin(0.17 * t)
    return {"time_s": t, **{name: values.copy() for name, values in columns.items()}}


def read(columns: Columns, seed: int) -> Columns:
    """With noise."""
    draw = np.random.default_rng(seed)
    return {
        name: values + draw.normal(0, SPREAD[name], ROWS) if name in SPREAD else values
        for name, values in columns.items()
    }


def fly_by_coefficients(seed: int = 1, bend: float = -3.0) -> Columns:
    """The forces and the elevator that CZ and Cm make of that motion; Cm bends with alpha^2."""
    columns = fly()
    t, alpha, speed = columns["time_s"], columns["alpha_rad"], columns["airspeed_mps"]
    p, q, r = (columns[name] for name in ("p_radps", "q_radps", "r_radps"))
    pressure = 0.5 * columns["rho_kgpm3"] * speed**2
    q_hat = q * CHORD / (2 * speed)
    about_x, about_y, about_z, about_xz = INERTIA
    moment = about_y * slope(lambda at: rates(at)[1], t)
    moment += (about_x - about_z) * p * r + about_xz * (p**2 - r**2)
    pitching = moment / (pressure * AREA * CHORD)
    elevator = (pitching - (0.03 - 0.9 * alpha - 14 * q_hat + bend * alpha**2)) / -1.2
    lift = -0.3 - 4.8 * alpha - 7 * q_hat - 0.4 * elevator
    columns["az_mps2"] = pressure * AREA * lift / MASS
    columns["elevator_rad"] = elevator
    return read(columns, seed)


def fly_along_path(seed: int = 1, warmth: float = 0.0005) -> Columns:
    """A pitch gyro whose bias follows its temperature [rad/s per degC], what is added to it."""
    columns = fly()
    columns["q_radps"] += warmth * (columns["imu_temp_degc"] - 30)
    return read(columns, seed)


FIT: dict[str, tuple[str, ...]] = {
    "aero": (
        *("--model", "aero", "--geometry", "aircraft.json"),
        *("--equation", "CZ=1,alpha,q_hat,elevator", "--equation", "Cm=1,alpha,q_hat,elevator"),
    ),
    "path": ("--model", "path"),
}
FLY = {"aero": fly_by_coefficients, "path": fly_along_path}
HIDDEN = {"aero": "Cm[alpha^2]", "path": "gyro_bias[imu_temp_degc]"}
CANDIDATES = {
    "aero": ("Cm[alpha^2]", "Cm[imu_temp_degc]", "Cm[altitude_m]"),
    "path": ("gyro_bias[imu_temp_degc]", "gyro_bias[altitude_m]", "airspeed_scale[altitude_m]"),
}
TRUTH = {"aero": ("Cm_alpha^2", -3.0, 0.4), "path": ("gyro_bias[imu_temp_degc].y", -0.0005, 0.0001)}
BOTH = ("ax_mps2", "ay_mps2", "az_mps2", "p_radps", "q_radps", "r_radps", "airspeed_mps")
COLUMNS = {
    "aero": (*BOTH, "alpha_rad", "beta_rad", "rho_kgpm3", "elevator_rad", "roll_rad", "altitude_m"),
    "path": ("q_radps", "alpha_rad", "yaw_rad", "imu_temp_degc"),
}
# Along a path, where a diagnosis takes ten seconds, each column has one fault and each fault one
# column. An elevator may be set for ten rows: it is told apart from a glitch by nobody.
PLANTED = [
    (model, fault, column)
    for model, columns in COLUMNS.items()
    for i, column in enumerate(columns)
    for j, fault in enumerate(FAULTS)
    if (fault, column) != ("burst", "elevator_rad") and (model == "aero" or i == j)
]


def aircraft(folder: Path, verb: str, *options: str) -> Outcome:
    """Runs sepcal-aircraft on what lies in the folder."""
    return run("sepcal-aircraft", verb, *options, folder=folder)


def lay_out(columns: Columns, folder: Path) -> None:
    """flight.csv and aircraft.json."""
    write(columns, folder / "flight.csv")
    (folder / "aircraft.json").write_text(json.dumps(GEOMETRY))


def notes_of(outcome: Outcome) -> list[str]:
    """What is said of the flight's columns, beside how many rows were dropped."""
    lines = [line for line in outcome.err.splitlines() if "flight.csv: " in line]
    return [line for line in lines if " were dropped: " not in line]


def headers_in(notes: list[str]) -> set[str]:
    """The columns that open these notes."""
    return {note.split("flight.csv: ")[1].split(": ")[0].split(" jumps")[0] for note in notes}


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("model", FIT)
def test_a_clean_log_has_no_note(tmp_path: Path, model: str, seed: int) -> None:
    lay_out(FLY[model](seed), tmp_path)
    fitted = aircraft(tmp_path, "fit", "flight.csv", *FIT[model])
    assert fitted.code == 0, fitted.err
    assert notes_of(fitted) == []


SOME = [pytest.param(*one, marks=[pytest.mark.slow] * (k % 3 > 0)) for k, one in enumerate(PLANTED)]


@pytest.mark.parametrize(("model", "fault", "column"), SOME)
def test_a_fault_changes_no_verdict(tmp_path: Path, model: str, fault: str, column: str) -> None:
    """Fit tells the column; what is hidden is found, and add keeps what was promised of it."""
    columns = FLY[model]()
    FAULTS[fault](columns[column])
    lay_out(columns, tmp_path)
    fitted = aircraft(tmp_path, "fit", "flight.csv", "-o", "base.json", *FIT[model])
    assert fitted.code in (0, 4, 5)
    assert headers_in(notes_of(fitted)) == {column}
    only = [f"--only={effect}" for effect in CANDIDATES[model]]
    found = aircraft(tmp_path, "diagnose", "flight.csv", "base.json", "--json", *only)
    assert found.code == 3, found.err
    assert found.result["effects"][0]["name"] == HIDDEN[model]
    assert column in found.err
    added = aircraft(
        tmp_path, "add", "flight.csv", "base.json", HIDDEN[model], "-o", "n.json", "--json"
    )
    assert added.code == 0, added.err
    assert column in added.err
    name, size, error = TRUTH[model]
    assert added.result["parameters"][name]["value"] == pytest.approx(size, abs=error)


@pytest.mark.parametrize("model", FIT)
@pytest.mark.parametrize("fault", FAULTS)
def test_the_way_out_of_a_note_leads_out(tmp_path: Path, fault: str, model: str) -> None:
    """The condition of a note, typed, takes the rows and the note away."""
    columns = FLY[model]()
    FAULTS[fault](columns["alpha_rad"])
    lay_out(columns, tmp_path)
    (note,) = notes_of(aircraft(tmp_path, "fit", "flight.csv", *FIT[model]))
    condition = note.split('--where "')[1].split('"')[0]
    followed = aircraft(tmp_path, "fit", "flight.csv", "--where", condition, *FIT[model])
    assert followed.code == 0, followed.err
    assert notes_of(followed) == []


OTHERS = [
    pytest.param(one, marks=pytest.mark.slow) for one in ("az_mps2", "q_radps", "airspeed_mps")
]


@pytest.mark.parametrize("column", ["alpha_rad", *OTHERS])
def test_a_column_that_never_changes_is_named(tmp_path: Path, column: str) -> None:
    for model in ("aero",) if column == "alpha_rad" else FIT:  # a path without it hardly ends
        columns = FLY[model]()
        columns[column][:] = columns[column][0]
        lay_out(columns, tmp_path)
        assert f"{column} reads " in aircraft(tmp_path, "fit", "flight.csv", *FIT[model]).err


def test_what_is_written_takes_the_bridged_rows(tmp_path: Path) -> None:
    """One code in the pitch gyro bends no path: apply's pitch is that of the clean log."""
    flown = {}
    for name in ("clean", "spoilt"):
        columns = fly_along_path(warmth=0)
        if name == "spoilt":
            FAULTS["twenty codes"](columns["q_radps"])
        lay_out(columns, tmp_path)
        assert aircraft(tmp_path, "fit", "flight.csv", "-o", "b.json", *FIT["path"]).code == 0
        assert aircraft(tmp_path, "apply", "flight.csv", "b.json", "-o", "out.csv").code == 0
        table = np.genfromtxt(tmp_path / "out.csv", delimiter=",", names=True)
        flown[name] = table["pitch_model_rad"]
    assert np.abs(flown["spoilt"] - flown["clean"]).max() < 0.002


@pytest.mark.parametrize(
    ("column", "fault"), list(zip(["q_radps", "alpha_rad"] * 2, FAULTS, strict=True))
)
def test_an_aircraft_that_is_integrated_bends_no_answer(
    tmp_path: Path, column: str, fault: str
) -> None:
    """Cm follows alpha^2 in the simulator's flight, with and without the fault."""
    hide = ("--hide", "Cm[alpha^2]=-3", "--seed", "2")
    made = aircraft(tmp_path, "simulate", "-o", "s.csv", "--geometry", "aircraft.json", *hide)
    assert made.code == 0
    with (tmp_path / "s.csv").open() as file:
        header, *rows = csv.reader(file)
    at = header.index(column)
    values = np.array([float(row[at]) for row in rows])
    FAULTS[fault](values)
    for row, value in zip(rows, values, strict=True):
        row[at] = repr(float(value))
    with (tmp_path / "flight.csv").open("w", newline="") as file:
        csv.writer(file).writerows([header, *rows])
    model = ("--model", "longitudinal", "--geometry", "aircraft.json", "-o", "base.json")
    fitted = aircraft(tmp_path, "fit", "flight.csv", *model)
    assert headers_in(notes_of(fitted)) == {column}
    added = aircraft(tmp_path, "add", "flight.csv", "base.json", "Cm[alpha^2]", "--json")
    assert added.code == 0, added.err
    assert column in added.err
    entry = added.result["parameters"]["Cm_alpha^2"]
    assert abs(entry["value"] + 3.0) < 4.0 * entry["standard_error"]


def test_recorded_and_simulated_flights_have_no_fault(tmp_path: Path) -> None:
    """HARV's, and the simulator's with steps and doublets of the controls."""
    made = aircraft(
        tmp_path, "simulate", "-o", "s.csv", "--geometry", "aircraft.json", "--seed", "4"
    )
    assert made.code == 0
    logs = (
        (str(find_fixture("harv_longitudinal.csv")), "path"),
        ("s.csv", "path"),
        ("s.csv", "longitudinal"),
        ("s.csv", "aero"),
    )
    for file, model in logs:
        geometry = ("--geometry", "aircraft.json") if model != "path" else ()
        fitted = aircraft(tmp_path, "fit", file, "--model", model, *geometry)
        words = ("a code and no reading", "jump", "stand still", "in every row")
        assert not any(word in fitted.err for word in words), fitted.err
