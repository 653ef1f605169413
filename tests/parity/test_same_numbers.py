# SPDX-License-Identifier: BSD-3-Clause
"""C++, Python and app give one file the same calibration, bit for bit: same build, same threads.

A JSON's numbers are the shortest that read back as the same doubles, so equal texts are equal bits.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import sepcal
from parity.programs import BUILD, run, write_flight

ROWS, SEED = 600, 3


@dataclass(frozen=True)
class Setup:
    """One probe, as each of the three takes it."""

    app: str
    options: tuple[str, ...]  # the app's
    settings: tuple[str, ...]  # fit_file's
    model: sepcal.FiveHoleProbe | sepcal.Magnetometer


SETUPS = [
    Setup(
        "sepcal-pitot",
        ("--k-alpha", "4.5", "--k-beta", "4.5", "--lever-arm", "0.35,0,-0.02"),
        ("five-hole", "4.5", "4.5", "0.35", "0", "-0.02"),
        sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02)),
    ),
    Setup(
        "sepcal-mag",
        ("--field", "19.7,-1.4,49.4"),
        ("magnetometer", "19.7", "-1.4", "49.4"),
        sepcal.Magnetometer(field=(19.7, -1.4, 49.4)),
    ),
]


@pytest.fixture(scope="module", params=SETUPS, ids=lambda setup: setup.app)
def setup(request: pytest.FixtureRequest) -> Setup:
    """Each probe in turn."""
    return request.param


@pytest.fixture(scope="module")
def flight(setup: Setup, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short simulated flight."""
    file = tmp_path_factory.mktemp("same_numbers") / "flight.csv"
    write_flight(sepcal.simulate(setup.model, rows=ROWS, seed=SEED), file)
    return file


@pytest.fixture(scope="module")
def calibration(setup: Setup, flight: Path) -> sepcal.Calibration:
    """What Python makes of it."""
    return sepcal.fit(setup.model, sepcal.read_csv(flight), threads=2)


def test_cpp_is_python(setup: Setup, flight: Path, calibration: sepcal.Calibration) -> None:
    """A program that links the library and nothing else."""
    probe, *values = setup.settings
    assert run(BUILD / "tests" / "fit_file", probe, flight, *values) == calibration.to_json()


def test_app_is_python(
    setup: Setup, flight: Path, calibration: sepcal.Calibration, tmp_path: Path
) -> None:
    """The file that fit writes, to the last byte; its options stand in it, file name and all."""
    output = tmp_path / "base.json"
    app = BUILD / "apps" / setup.app
    run(app, "fit", flight, *setup.options, "--threads", "2", "-o", output)
    assert output.read_text() == calibration.to_json()


def test_arrays_are_the_file(setup: Setup, calibration: sepcal.Calibration) -> None:
    """The same flight, never written: only where it came from differs."""
    from_arrays = sepcal.fit(
        setup.model, sepcal.simulate(setup.model, rows=ROWS, seed=SEED), threads=2
    )
    expected, actual = calibration.to_dict(), from_arrays.to_dict()
    assert expected.pop("inputs")["sha256"] != actual.pop("inputs")["sha256"]
    assert actual == expected


def test_app_applies_what_python_applies(
    setup: Setup, flight: Path, calibration: sepcal.Calibration, tmp_path: Path
) -> None:
    """The corrected columns, bit for bit."""
    base, output = tmp_path / "base.json", tmp_path / "corrected.csv"
    calibration.save(base)
    run(BUILD / "apps" / setup.app, "apply", flight, base, "-o", output)
    corrected = sepcal.read_csv(output)
    for header, values in calibration.apply(sepcal.read_csv(flight)).items():
        np.testing.assert_array_equal(corrected[header], values, strict=True)


def test_app_compares_as_python_does(
    setup: Setup, flight: Path, calibration: sepcal.Calibration, tmp_path: Path
) -> None:
    """The same JSON."""
    base = tmp_path / "base.json"
    calibration.save(base)
    printed = run(BUILD / "apps" / setup.app, "compare", flight, base, "--json")
    assert json.loads(printed) == calibration.compare().to_dict()


def test_app_finds_the_intervals_that_python_finds(
    setup: Setup, flight: Path, calibration: sepcal.Calibration, tmp_path: Path
) -> None:
    """The same text, on another number of threads, from the file or as it was fitted."""
    base, output = tmp_path / "base.json", tmp_path / "intervals.json"
    calibration.save(base)
    printed = run(
        BUILD / "apps" / setup.app, "intervals", flight, base, "--level", "0.9", "-o", output,
        "--json",
    )  # fmt: skip
    assert printed == output.read_text() == calibration.intervals(level=0.9).to_json()
    assert sepcal.load(base).intervals(sepcal.read_csv(flight), level=0.9).to_json() == printed
