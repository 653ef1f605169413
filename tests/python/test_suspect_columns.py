# SPDX-License-Identifier: BSD-3-Clause
"""Columns are checked before they are believed.

Codes, glitches and frozen rows are planted in every column in turn: they are told, and mislead
neither fit, diagnose nor add. Clean columns are left alone.
"""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from apps import Outcome, run
from faults import FAULTS, ROWS, Columns, write
from recorded import CHECKOUT, find_fixture

TUBE = ("--probe", "pitot-static")


def fly(seed: int = 1, shear: float = 0.02) -> Columns:
    """A tube, s_va 0.95 and c_va -0.6, in a wind of (-4, 2) m/s that grows with the height."""
    draw = np.random.default_rng(seed)
    t = 0.2 * np.arange(ROWS)
    turn = 2 * np.pi * t / t[-1]
    speed = 18 + 4 * np.sin(5 * turn)
    altitude = 1200 + 200 * np.sin(2 * turn + 0.3)
    columns = {
        "time_s": t,
        "vn_mps": speed * np.cos(3 * turn) - 4 + shear * (altitude - 1200),
        "ve_mps": speed * np.sin(3 * turn) + 2,
        "airspeed_mps": 0.95 * speed - 0.6,
        "altitude_m": altitude,
        "temp_degc": 15 - 0.0065 * altitude + 3 * np.sin(turn),
        "throttle_pct": 60 + 20 * np.sin(7 * turn),
    }
    spread = (0, 0.05, 0.05, 0.1, 0.5, 0.05, 1)
    for name, sd in zip(columns, spread, strict=True):
        columns[name] = columns[name] + draw.normal(0, sd, ROWS) if sd else columns[name]
    return {**columns, "vd_mps": np.zeros(ROWS)}


MEASURED = ("vn_mps", "ve_mps", "airspeed_mps")
DRIVERS = ("altitude_m", "temp_degc", "throttle_pct")
CANDIDATES = ("wind[altitude_m]", "airspeed_bias[temp_degc]", "airspeed_bias[throttle_pct]")
# A throttle may be set for ten rows: it is told apart from a glitch by nobody.
PLANTED = [
    (fault, column)
    for fault in FAULTS
    for column in (*MEASURED, *DRIVERS)
    if (fault, column) != ("burst", "throttle_pct")
]


@pytest.fixture
def spoilt(tmp_path: Path) -> Callable[[str, str], Path]:
    """Writes flight.csv with a fault in a column."""

    def spoil(fault: str, column: str) -> Path:
        columns = fly()
        FAULTS[fault](columns[column])
        write(columns, tmp_path / "flight.csv")
        return tmp_path

    return spoil


def tube(folder: Path, verb: str, *options: str) -> Outcome:
    """Runs sepcal-pitot on what lies in the folder."""
    return run("sepcal-pitot", verb, *options, folder=folder)


@pytest.mark.parametrize(("fault", "column"), PLANTED)
def test_a_fault_is_told_by_its_column(
    spoilt: Callable[[str, str], Path], fault: str, column: str
) -> None:
    """By check, and by fit: of the column that has it and of no other."""
    folder = spoilt(fault, column)
    notes = tube(folder, "check", "flight.csv", "--json", *TUBE).result["notes"]
    assert {header for note in notes for header in note["columns"]} == {column}
    assert column in tube(folder, "fit", "flight.csv", *TUBE).err


@pytest.mark.parametrize(("fault", "column"), PLANTED)
def test_a_fault_changes_no_verdict(
    spoilt: Callable[[str, str], Path], fault: str, column: str
) -> None:
    """The hidden shear is found, and add keeps what was promised of it."""
    folder = spoilt(fault, column)
    assert tube(folder, "fit", "flight.csv", "-o", "base.json", *TUBE).code in (0, 4)
    only = [f"--only={effect}" for effect in CANDIDATES]
    found = tube(folder, "diagnose", "flight.csv", "base.json", "--json", *only)
    assert found.code == 3, found.err
    result = found.result
    assert result["effects"][0]["name"] == "wind[altitude_m]"
    assert column in found.err
    hidden = ("wind[altitude_m]", "-o", "more.json")
    added = tube(folder, "add", "flight.csv", "base.json", *hidden, "--json")
    assert added.code == 0, added.err
    more = added.result
    assert more["parameters"]["wind[altitude_m].n"]["value"] == pytest.approx(0.02, abs=0.002)
    assert more["parameters"]["s_va"]["value"] == pytest.approx(0.95, abs=0.03)


def test_the_way_out_of_a_note_leads_out(spoilt: Callable[[str, str], Path]) -> None:
    """The condition of a note, typed, takes the rows and the note away."""
    for fault in FAULTS:
        folder = spoilt(fault, "airspeed_mps")
        (note,) = tube(folder, "check", "flight.csv", "--json", *TUBE).result["notes"]
        condition = note["advice"].split('--where "')[1].split('"')[0]
        followed = tube(folder, "check", "flight.csv", "--json", "--where", condition, *TUBE).result
        assert followed["notes"] == []
        assert followed["inputs"]["rows_used"] == ROWS - note["rows"]


def test_fit_says_what_a_loss_would_change(tmp_path: Path) -> None:
    """The numbers that it names are those of the fit that it names."""
    columns = fly(shear=0)
    for first in (200, 650, 1300):
        columns["vn_mps"][first : first + 10] += 30
        columns["ve_mps"][first : first + 10] -= 20
    write(columns, tmp_path / "flight.csv")
    plain = tube(tmp_path, "fit", "flight.csv", "--json", *TUBE)
    (told,) = [line for line in plain.err.splitlines() if "pull the fit" in line]
    robust = tube(tmp_path, "fit", "flight.csv", "--json", "--loss", "cauchy", *TUBE).result
    name, there = told.split("with --loss cauchy ")[1].split()[0:3:2]
    assert float(there) == pytest.approx(robust["parameters"][name]["value"], rel=1e-3)
    assert robust["parameters"]["s_va"]["value"] == pytest.approx(0.95, abs=0.01)


def test_what_auto_writes_is_of_readings_alone(tmp_path: Path) -> None:
    """Where nothing is added, too: its verdict is of the fit that it hands on."""
    columns = fly(shear=0)
    columns["airspeed_mps"][[150, 700, 1450]] = -99
    write(columns, tmp_path / "flight.csv")
    tube(tmp_path, "fit", "flight.csv", "-o", "base.json", *TUBE)
    told = tube(tmp_path, "diagnose", "flight.csv", "base.json", "--auto", "-o", "auto.json")
    assert "nothing added" in told.out
    assert "airspeed_mps != -99" in told.err
    kept = json.loads((tmp_path / "auto.json").read_text())
    assert kept["parameters"]["s_va"]["value"] == pytest.approx(0.95, abs=0.01)
    assert kept["rmse"]["airspeed"] < 0.2


def test_a_column_that_never_changes_is_named(tmp_path: Path) -> None:
    """A tube that is clogged is no calibration, and not one of another unit."""
    columns = fly()
    columns["airspeed_mps"][:] = 12
    write(columns, tmp_path / "flight.csv")
    (note,) = tube(tmp_path, "check", "flight.csv", "--json", *TUBE).result["notes"]
    assert (note["kind"], note["columns"]) == ("frozen", ["airspeed_mps"])
    assert tube(tmp_path, "fit", "flight.csv", "-o", "base.json", *TUBE).code == 4
    diagnosis = tube(tmp_path, "diagnose", "flight.csv", "base.json")
    assert diagnosis.code == 2
    assert "airspeed_mps reads 12 mps in every row" in diagnosis.err


# --- what must not be called a fault


def clean_channels(seed: int) -> Columns:
    """Channels as flights have them: set, held, on steps, at a limit, at rest, in pulses."""
    draw = np.random.default_rng(seed)
    columns = fly(seed, shear=0)
    phase = np.linspace(0, 2 * np.pi, ROWS)
    altitude = columns["altitude_m"]
    every_tenth = altitude[::10]
    pulses = 0.5 + draw.normal(0, 0.005, ROWS)
    for first in draw.integers(50, ROWS - 50, 3):
        pulses[first : first + 10] += 0.3
    throttle = np.repeat(draw.choice([0.3, 0.5, 0.65, 1.0], ROWS // 50), 50)
    columns |= {
        "stepped_throttle": throttle,
        "flap_deg": np.repeat(draw.choice([0.0, 10.0, 30.0], ROWS // 100, p=[0.8, 0.1, 0.1]), 100),
        "gear": ((phase < 1) | (phase > 5.5)).astype(float),
        "elevator_rad": pulses,
        "current_a": 2 + 18 * throttle**3 + draw.normal(0, 0.5, ROWS),
        "transmitter_a": 0.1 + draw.normal(0, 0.01, ROWS) + 2.0 * (draw.random(ROWS) < 0.02),
        "satellites": np.round(11 + draw.normal(0, 0.6, ROWS)),
        "heading_deg": np.degrees(3 * phase) % 360,
        "course_deg": draw.normal(0, 3, ROWS) % 360,
        "held_m": np.repeat(every_tenth, 10),
        "straight_m": np.interp(np.arange(ROWS), np.arange(0, ROWS, 10), every_tenth),
        "whole_m": np.round(altitude),
        "above_ground_m": np.maximum(0, 1200 + 200 * np.sin(2 * phase) - 1150),
        "limited_mps": np.minimum(columns["airspeed_mps"], 18),
        "level_m": np.where(np.arange(ROWS) // 150 % 2, 500 + 50 * np.sin(40 * phase), 500),
    }
    return columns


@pytest.mark.parametrize("seed", range(3))
def test_clean_channels_are_left_alone(tmp_path: Path, seed: int) -> None:
    """No note of a code, a glitch or a frozen row."""
    write(clean_channels(seed), tmp_path / "flight.csv")
    notes = tube(tmp_path, "check", "flight.csv", "--json", *TUBE).result["notes"]
    kinds = {"sentinels", "outliers", "glitches", "frozen"}
    assert [note["found"] for note in notes if note["kind"] in kinds] == []


def test_a_landed_tube_is_at_rest_and_not_at_fault(tmp_path: Path) -> None:
    """Zeros on the ground, between two flights too: the way out keeps the flight alone."""
    columns = fly(shear=0)
    ground = np.r_[0:150, 600:800, 1400:ROWS]
    for name in MEASURED:
        columns[name][ground] = 0
    write(columns, tmp_path / "flight.csv")
    notes = tube(tmp_path, "check", "flight.csv", "--json", *TUBE).result["notes"]
    assert [note["kind"] for note in notes] == ["at_rest"]
    condition = notes[0]["advice"].split('--where "')[1].split('"')[0]
    fitted = tube(tmp_path, "fit", "flight.csv", "--json", "--where", condition, *TUBE)
    assert fitted.result["inputs"]["rows_used"] == ROWS - len(ground)
    assert fitted.result["parameters"]["s_va"]["value"] == pytest.approx(0.95, abs=0.01)


# --- recorded and reduced logs


def case(name: str) -> Path:
    """A reduced log beside the recorded ones."""
    file = CHECKOUT.parent / "shared" / "cases" / "verdicts" / name
    if not file.exists():
        pytest.skip(f"no reduced log {file}")
    return file


def test_the_advice_on_a_log_that_mostly_stands_is_good(tmp_path: Path) -> None:
    """Following it once leaves no advice, and the scale that the flight alone gives (0.86)."""
    file = str(case("f2_mostly_at_rest.csv"))
    notes = tube(tmp_path, "check", file, "--json", *TUBE).result["notes"]
    (rest,) = [note for note in notes if note["kind"] == "at_rest"]
    condition = rest["advice"].split('--where "')[1].split('"')[0]
    fitted = tube(tmp_path, "fit", file, "--json", "--where", condition, *TUBE)
    assert fitted.result["parameters"]["s_va"]["value"] == pytest.approx(0.86, abs=0.03)
    assert "stand on the ground" not in fitted.err


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("f4_false_clip_50hz.csv", "limit"),
        ("f5_column_p.csv", "no known unit"),
        ("highwind26.csv", "rename"),
    ],
)
def test_notes_that_were_untrue_are_gone(tmp_path: Path, name: str, word: str) -> None:
    fitted = tube(tmp_path, "fit", str(case(name)), *TUBE)
    assert fitted.code == 0
    assert word not in fitted.err


def test_a_condition_holds_beside_dropped_rows(tmp_path: Path) -> None:
    """No note of rows that were not chosen."""
    file = str(case("f2b_empty_cell_in_flight.csv"))
    fitted = tube(tmp_path, "fit", file, "--drop-invalid", "--where", "altitude_m > 80", *TUBE)
    assert fitted.code == 0
    assert "stand on the ground" not in fitted.err


def test_a_large_hard_iron_is_no_wrong_unit(tmp_path: Path) -> None:
    """The unit is judged by the radius of what the readings lie on."""
    fitted = run(
        "sepcal-mag", "fit", case("big_offset.csv"), "--field", "19.7,-1.4,49.4", folder=tmp_path
    )
    assert (fitted.code, fitted.err) == (0, "")


def test_codes_below_zero_in_a_tube_are_said_to_be_left_out(tmp_path: Path) -> None:
    """Nothing flows there: the fit takes none of these rows, and the note agrees."""
    made = run(
        "sepcal-pitot", "simulate", "-o", "f.csv", "--probe", "pitot-static", folder=tmp_path
    )
    assert made.code == 0
    header, *rows = (tmp_path / "f.csv").read_text().splitlines()
    at = header.split(",").index("airspeed_mps")
    for row in range(50, len(rows), 90):
        cells = rows[row].split(",")
        cells[at] = "-99"
        rows[row] = ",".join(cells)
    (tmp_path / "f.csv").write_text("\n".join([header, *rows]) + "\n")
    fitted = run("sepcal-pitot", "fit", "f.csv", "--probe", "pitot-static", folder=tmp_path)
    assert "were dropped: airspeed is not above zero" in fitted.err
    assert "hold -99, a code and no reading" in fitted.err
    assert "these rows are left out" in fitted.err
    assert "takes it for a reading" not in fitted.err


@pytest.mark.parametrize(
    ("app", "name", "options"),
    [
        ("sepcal-pitot", "uav_pitot_static_2022_05_07_11.csv", TUBE),
        ("sepcal-pitot", "airliner_mode_s.csv", TUBE),
        ("sepcal-pitot", "rv_deceleration_stall.csv", TUBE),
        ("sepcal-mag", "octocopter_internal_mag.csv", ("--field-strength", "50")),
        ("sepcal-mag", "octocopter_external_mag.csv", ("--field-strength", "50")),
    ],
)
def test_recorded_logs_have_no_fault(
    tmp_path: Path, app: str, name: str, options: tuple[str, ...]
) -> None:
    checked = run(app, "check", find_fixture(name), "--json", *options, folder=tmp_path).result
    kinds = {"sentinels", "glitches", "frozen"}
    assert [note["found"] for note in checked["notes"] if note["kind"] in kinds] == []


@pytest.mark.parametrize("rows", [5, 25, 200])
@pytest.mark.parametrize("first", [0, 700])
def test_a_receiver_without_a_fix_is_named_and_left_out(
    tmp_path: Path, first: int, rows: int
) -> None:
    """Zeros in all of the velocity while the tube reads flow: the way out gives the scale."""
    columns = fly(shear=0)
    lost = np.arange(first, first + rows)
    for name in ("vn_mps", "ve_mps"):
        columns[name][lost] = 0
    write(columns, tmp_path / "flight.csv")
    notes = tube(tmp_path, "check", "flight.csv", "--json", *TUBE).result["notes"]
    (note,) = [note for note in notes if note["kind"] in ("frozen", "glitches")]
    assert note["columns"][:2] == ["vn_mps", "ve_mps"]
    assert note["rows"] == rows
    condition = note["advice"].split('--where "')[1].split('"')[0]
    fitted = tube(tmp_path, "fit", "flight.csv", "--json", "--where", condition, *TUBE)
    scale = fitted.result["parameters"]["s_va"]
    assert abs(scale["value"] - 0.95) < 4 * scale["standard_error"]
