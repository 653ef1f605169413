# SPDX-License-Identifier: BSD-3-Clause
"""With effects, app and Python give one file the same calibration, bit for bit."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import sepcal
from parity.programs import BUILD, run, write_flight


@dataclass(frozen=True)
class Setup:
    """A probe and its effects, as both take them."""

    app: str
    options: tuple[str, ...]
    model: sepcal.FiveHoleProbe | sepcal.PitotStatic | sepcal.Magnetometer
    hidden: dict[str, float]
    effects: tuple[str, ...]  # of the fit
    added: str  # later


SETUPS = [
    Setup(
        "sepcal-pitot",
        ("--k-alpha", "4.5", "--k-beta", "4.5"),
        sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5),
        {"wind[altitude_m]": 0.02, "pressure_offset[throttle]": 8.0},
        ("wind[altitude_m]", "airspeed_scale[alpha^2]", "wind[spline(time,4)]"),
        "propwash+heading_bias",
    ),
    Setup(
        "sepcal-pitot",
        ("--probe", "pitot-static"),
        sepcal.PitotStatic(),
        {"airspeed_bias[throttle]": 0.5},
        ("airspeed_bias[throttle]",),
        "wind_drift",
    ),
    Setup(
        "sepcal-mag",
        ("--field", "19.7,-1.4,49.4"),
        sepcal.Magnetometer(field=(19.7, -1.4, 49.4)),
        {"bias[current_a]": 0.05},
        ("bias[current_a]", "bias_step"),
        "bias_drift",
    ),
    Setup(
        "sepcal-mag",
        ("--field-strength", "53.2"),
        sepcal.Magnetometer(field_strength=53.2),
        {"bias[current_a]": 0.05},
        ("bias[current_a]",),
        "scale[temp_degc]",
    ),
]


@pytest.fixture(scope="module", params=SETUPS, ids=lambda setup: setup.model.name)
def setup(request: pytest.FixtureRequest) -> Setup:
    """Each probe in turn."""
    return request.param


@pytest.fixture(scope="module")
def folder(setup: Setup, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Holds flight.csv and what the app made of it: fit.json, added.json, corrected.csv."""
    folder = tmp_path_factory.mktemp("same_effects")
    flight, fit = folder / "flight.csv", folder / "fit.json"
    write_flight(sepcal.simulate(setup.model, rows=400, seed=5, hide=setup.hidden), flight)
    app, effects = BUILD / "apps" / setup.app, [f"--effect={name}" for name in setup.effects]
    run(app, "fit", flight, *setup.options, *effects, "--threads", "2", "-o", fit)
    run(app, "add", flight, fit, setup.added, "-o", folder / "added.json")
    run(app, "apply", flight, folder / "added.json", "-o", folder / "corrected.csv")
    return folder


@pytest.fixture(scope="module")
def calibration(setup: Setup, folder: Path) -> sepcal.Calibration:
    """What Python makes of the same file."""
    flight = sepcal.read_csv(folder / "flight.csv")
    return sepcal.fit(setup.model, flight, effects=setup.effects, threads=2)


def test_the_app_fits_what_python_fits(folder: Path, calibration: sepcal.Calibration) -> None:
    assert (folder / "fit.json").read_text() == calibration.to_json()


def test_the_app_adds_what_python_adds(
    setup: Setup, folder: Path, calibration: sepcal.Calibration
) -> None:
    """Also from the app's own file."""
    added = (folder / "added.json").read_text()
    assert calibration.add(setup.added).to_json() == added
    loaded = sepcal.load(folder / "fit.json")
    assert loaded.add(setup.added, sepcal.read_csv(folder / "flight.csv")).to_json() == added


def test_the_app_applies_what_python_applies(folder: Path) -> None:
    corrected = sepcal.read_csv(folder / "corrected.csv")
    added = sepcal.load(folder / "added.json")
    for header, values in added.apply(sepcal.read_csv(folder / "flight.csv")).items():
        np.testing.assert_array_equal(corrected[header], values, strict=True)


def test_the_app_lists_what_python_lists(setup: Setup) -> None:
    printed = json.loads(run(BUILD / "apps" / setup.app, "effects", "--json"))["effects"]
    of_model = [effect for effect in printed if effect.pop("model") == setup.model.name]
    assert of_model == [effect._asdict() for effect in sepcal.effects(setup.model)]


def test_the_app_compares_as_python_does(setup: Setup, folder: Path) -> None:
    flight, base = folder / "flight.csv", folder / "added.json"
    printed = run(BUILD / "apps" / setup.app, "compare", flight, base, "--json")
    assert json.loads(printed) == sepcal.load(base).compare(sepcal.read_csv(flight)).to_dict()
