# SPDX-License-Identifier: BSD-3-Clause
"""`residuals`: a row for each of the flight's, against the model's equation written anew."""

import csv
from pathlib import Path

import numpy as np
import pytest

import sepcal
from apps import run


def read_table(file: Path) -> dict[str, list[str]]:
    """The cells of each column."""
    with file.open(newline="") as text:
        rows = list(csv.DictReader(text))
    return {name: [row[name] for row in rows] for name in rows[0]}


def numbers(cells: list[str]) -> np.ndarray:
    return np.array([float(cell) if cell else np.nan for cell in cells])


@pytest.fixture
def tube(tmp_path: Path) -> Path:
    """A tube's flight, and its calibration of a part of it by one condition and two times."""
    made = ["simulate", "--probe", "pitot-static", "--rows", "600", "-o", "flight.csv"]
    assert run("sepcal-pitot", *made, folder=tmp_path).code == 0
    told = run(
        "sepcal-pitot", "fit", "flight.csv", "-o", "base.json", "--where", "airspeed > 18",
        "--from", "2", folder=tmp_path,
    )  # fmt: skip
    assert told.code == 0, told.err
    return tmp_path


def test_every_row_of_the_flight(tube: Path) -> None:
    told = run("sepcal-pitot", "residuals", "flight.csv", "base.json", "-o", "r.csv", folder=tube)
    assert told.code == 0, told.err
    table, flight = read_table(tube / "r.csv"), read_table(tube / "flight.csv")
    assert list(table) == [
        "time_s",
        "airspeed_measured_mps",
        "airspeed_modelled_mps",
        "airspeed_residual_mps",
        "airspeed_whitened",
        "used",
        "why_not",
    ]
    assert numbers(table["time_s"]) == pytest.approx(numbers(flight["time_s"]))
    chosen = (numbers(flight["airspeed_mps"]) > 18) & (numbers(flight["time_s"]) >= 2)
    assert 0 < chosen.sum() < chosen.size
    used = np.array(table["used"]) == "1"
    np.testing.assert_array_equal(used, chosen)
    assert {why for why, is_used in zip(table["why_not"], used, strict=True) if not is_used} == {
        "not among the rows that were chosen"
    }
    assert f"{chosen.size} rows, of which {chosen.sum()} were used" in told.out

    fitted = run("sepcal-pitot", "compare", "flight.csv", "base.json", "-j", folder=tube)
    assert fitted.code == 0
    base = sepcal.load(tube / "base.json")
    value = {name: base[name].value for name in ("s_va", "c_va", "w_n", "w_e")}
    over_ground = np.stack([numbers(flight[f"v{axis}_mps"]) for axis in "ned"])
    wind = np.array([[value["w_n"]], [value["w_e"]], [0.0]])
    modelled = value["s_va"] * np.linalg.norm(over_ground - wind, axis=0) + value["c_va"]
    measured = numbers(flight["airspeed_mps"])
    for name, expected in (
        ("measured_mps", measured),
        ("modelled_mps", modelled),
        ("residual_mps", measured - modelled),
        ("whitened", (measured - modelled) / base.noise["airspeed"]),
    ):
        cells = numbers(table[f"airspeed_{name}"])
        np.testing.assert_allclose(cells[used], expected[used], rtol=1e-9, atol=1e-9)
        assert np.isnan(cells[~used]).all()


def test_python_gives_the_same(tube: Path) -> None:
    run("sepcal-pitot", "residuals", "flight.csv", "base.json", "-o", "r.csv", folder=tube)
    table = read_table(tube / "r.csv")
    calibration = sepcal.load(tube / "base.json")
    columns = calibration.residuals(sepcal.read_csv(tube / "flight.csv"))
    assert [*columns] == [name for name in table if name != "used"]
    for name, values in columns.items():
        if name == "why_not":
            assert values == table[name]
        else:
            np.testing.assert_array_equal(values, numbers(table[name]))


def test_an_aircraft_has_them_too(tmp_path: Path) -> None:
    words = ["simulate", "-o", "flight.csv", "--rows", "400"]
    assert run("sepcal-aircraft", *words, folder=tmp_path).code == 0
    told = run(
        "sepcal-aircraft", "fit", "flight.csv", "--model", "path", "-o", "p.json", folder=tmp_path
    )
    assert told.code in (0, 4, 5), told.err
    told = run(
        "sepcal-aircraft", "residuals", "flight.csv", "p.json", "-o", "r.csv", folder=tmp_path
    )
    assert told.code == 0, told.err
    table = read_table(tmp_path / "r.csv")
    names = [name.removesuffix("_whitened") for name in table if name.endswith("_whitened")]
    assert len(names) > 2
    for name in names:
        units = [each.rpartition("_")[2] for each in table if each.startswith(f"{name}_measured_")]
        measured, modelled, residual = (
            numbers(table[f"{name}_{what}_{units[0]}"])
            for what in ("measured", "modelled", "residual")
        )
        np.testing.assert_allclose(measured - modelled, residual, atol=1e-9)


def test_what_is_read_is_not_written_over(tube: Path) -> None:
    before = (tube / "flight.csv").read_bytes()
    told = run(
        "sepcal-pitot", "residuals", "flight.csv", "base.json", "-o", "flight.csv", folder=tube
    )
    assert told.code == 2
    assert (tube / "flight.csv").read_bytes() == before
