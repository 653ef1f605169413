# SPDX-License-Identifier: BSD-3-Clause
"""A magnetometer's columns are checked before they are believed, as a tube's are.

Each fault in each column is told by that column alone; the bias that follows the temperature is
still found, and add keeps it.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from apps import Outcome, run
from faults import FAULTS, ROWS, Columns, write

FIELD = np.array([20.0, 1.5, 45.0])  # north, east, down [uT]
IRON = np.array([12.0, -7.0, 4.0])  # uT
WARMTH = np.array([0.3, -0.2, 0.1])  # uT per degC, hidden
ANGLES = ("roll_rad", "pitch_rad", "yaw_rad")
AXES = ("mx_ut", "my_ut", "mz_ut")
DRIVERS = ("temp_degc", "current_a", "altitude_m")
# A current may be drawn for ten rows: it is told apart from a glitch by nobody.
PLANTED = [
    (fault, column)
    for fault in FAULTS
    for column in (*AXES, *ANGLES, *DRIVERS)
    if (fault, column) != ("burst", "current_a")
]


def turn(columns: Columns, warmth: float = 1.0, seed: int = 1) -> Columns:
    """Body axes in the field by yaw, pitch, roll, with iron and a warmth."""
    draw = np.random.default_rng(seed)
    roll, pitch, yaw = (columns[name] for name in ANGLES)
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (np.cos, np.sin))
    north, east, down = FIELD
    ahead = cy * north + sy * east
    right = cy * east - sy * north
    below = sp * ahead + cp * down
    field = np.array([cp * ahead - sp * down, cr * right + sr * below, cr * below - sr * right])
    warm = warmth * np.outer(WARMTH, columns["temp_degc"] - columns["temp_degc"].mean())
    read = 1.05 * field + IRON[:, None] + warm + draw.normal(0, 0.2, field.shape)
    return dict(zip(AXES, read, strict=True))


def fly(seed: int = 1, warmth: float = 1.0) -> Columns:
    """Turned all round within five minutes, five rows a second."""
    draw = np.random.default_rng(seed)
    time = 0.2 * np.arange(ROWS)
    share = 2 * np.pi * time / time[-1]
    columns = {
        "time_s": time,
        "roll_rad": 2.6 * np.cos(5 * share),
        "pitch_rad": 1.1 * np.sin(4 * share + 1),
        "yaw_rad": np.remainder(5 * share + np.pi, 2 * np.pi) - np.pi,
        "temp_degc": 25 + 8 * np.sin(1.5 * share),
        "current_a": 8 + 3 * np.sin(9 * share),
        "altitude_m": 300 + 60 * np.sin(3 * share),
    }
    read = turn(columns, warmth, seed)
    spread = {**dict.fromkeys(ANGLES, 0.003), "temp_degc": 0.05, "current_a": 0.3}
    for name, sd in {**spread, "altitude_m": 0.5}.items():
        columns[name] = columns[name] + draw.normal(0, sd, ROWS)
    return {**columns, **read}


def compass(folder: Path, verb: str, *options: str) -> Outcome:
    """Runs sepcal-mag on what lies in the folder."""
    field = ("--field", ",".join(map(str, FIELD))) if verb in ("fit", "check") else ()
    return run("sepcal-mag", verb, *options, *field, folder=folder)


@pytest.fixture
def spoilt(tmp_path: Path) -> Callable[[str, str], Path]:
    """Writes flight.csv with a fault in a column."""

    def spoil(fault: str, column: str) -> Path:
        columns = fly()
        if fault == "burst" and column in ANGLES:
            columns[column][600:610] += 1.0
        else:
            FAULTS[fault](columns[column])
        write(columns, tmp_path / "flight.csv")
        return tmp_path

    return spoil


@pytest.mark.parametrize("seed", range(3))
def test_a_clean_log_has_no_note(tmp_path: Path, seed: int) -> None:
    write(fly(seed, warmth=0), tmp_path / "flight.csv")
    assert compass(tmp_path, "check", "flight.csv", "--json").result["notes"] == []


@pytest.mark.parametrize(("fault", "column"), PLANTED)
def test_a_fault_is_told_by_its_column(
    spoilt: Callable[[str, str], Path], fault: str, column: str
) -> None:
    """By check, and by fit: of the column that has it and of no other."""
    folder = spoilt(fault, column)
    notes = compass(folder, "check", "flight.csv", "--json").result["notes"]
    assert {header for note in notes for header in note["columns"]} == {column}
    assert column in compass(folder, "fit", "flight.csv").err


@pytest.mark.parametrize(("fault", "column"), PLANTED)
def test_a_fault_changes_no_verdict(
    spoilt: Callable[[str, str], Path], fault: str, column: str
) -> None:
    """The hidden bias is found, and add keeps what was promised of it."""
    folder = spoilt(fault, column)
    assert compass(folder, "fit", "flight.csv", "-o", "base.json").code in (0, 4, 5)
    only = [f"--only=bias[{driver}]" for driver in DRIVERS]
    found = compass(folder, "diagnose", "flight.csv", "base.json", "--json", *only)
    assert found.code == 3, found.err
    assert found.result["effects"][0]["name"] == "bias[temp_degc]"
    assert column in found.err
    hidden = ("bias[temp_degc]", "-o", "more.json")
    added = compass(folder, "add", "flight.csv", "base.json", *hidden, "--json")
    assert added.code == 0, added.err
    values = {name: entry["value"] for name, entry in added.result["parameters"].items()}
    for axis, warmth, iron in zip("xyz", WARMTH, IRON, strict=True):
        assert values[f"bias[temp_degc].{axis}"] == pytest.approx(warmth, abs=0.02)
        assert values[f"n_{axis}"] == pytest.approx(iron, abs=0.8)  # at the rows' own mean
        assert values[f"lambda_{axis}"] == pytest.approx(0.05, abs=0.01)


@pytest.mark.parametrize("fault", FAULTS)
def test_the_way_out_of_a_note_leads_out(spoilt: Callable[[str, str], Path], fault: str) -> None:
    """The condition of a note, typed, takes the rows and the note away."""
    folder = spoilt(fault, "my_ut")
    (note,) = compass(folder, "check", "flight.csv", "--json").result["notes"]
    condition = note["advice"].split('--where "')[1].split('"')[0]
    followed = compass(folder, "check", "flight.csv", "--json", "--where", condition).result
    assert followed["notes"] == []
    assert followed["inputs"]["rows_used"] == ROWS - note["rows"]


@pytest.mark.parametrize("column", AXES)
def test_an_axis_that_never_changes_is_named(tmp_path: Path, column: str) -> None:
    """By check and by fit, and diagnose refuses it."""
    columns = fly()
    columns[column][:] = 17
    write(columns, tmp_path / "flight.csv")
    notes = compass(tmp_path, "check", "flight.csv", "--json").result["notes"]
    assert [note["columns"] for note in notes if note["kind"] == "frozen"] == [[column]]
    frozen = f"{column} reads 17 ut in every row"
    assert frozen in compass(tmp_path, "fit", "flight.csv", "-o", "base.json").err
    diagnosis = compass(tmp_path, "diagnose", "flight.csv", "base.json")
    assert diagnosis.code == 2
    assert frozen in diagnosis.err
