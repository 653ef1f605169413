# SPDX-License-Identifier: BSD-3-Clause
"""The flights that ship: made again to the last byte, small, and with the truth within errors."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

import numpy as np
import pytest

import sepcal
from sepcal.datasets import make

MODELS = {
    "pitot": sepcal.PitotStatic(),
    "magnetometer": sepcal.Magnetometer(),
    "aircraft": sepcal.FlightPath(),
}
LARGEST = 150e3  # bytes, all together
FAR = 4.0  # standard errors


def shipped(file: str) -> str:
    return resources.files("sepcal.datasets").joinpath(file).read_text(encoding="utf-8")


def test_the_command_that_stands_beside_makes_them_again(tmp_path: Path) -> None:
    make.main(str(tmp_path))
    files = sorted(file.name for file in tmp_path.iterdir())
    assert files == ["aircraft.csv", "magnetometer.csv", "pitot.csv", "truth.json"]
    for file in files:
        assert (tmp_path / file).read_text() == shipped(file), file
    assert sum((tmp_path / file).stat().st_size for file in files) < LARGEST


@pytest.mark.parametrize("name", sepcal.datasets.NAMES)
def test_the_truth_lies_within_the_errors_once_all_effects_are_added(name: str) -> None:
    flight = sepcal.datasets.load(name)
    fitted = sepcal.fit(MODELS[name], flight)
    for effect in flight.effects:
        fitted = fitted.add(effect)
    assert fitted.success
    compared = 0
    for parameter in fitted.parameters.values():
        if parameter.name in flight.truth and parameter.standard_error > 0:
            off = parameter.value - flight.truth[parameter.name]
            assert abs(off) < FAR * parameter.standard_error, parameter.name
            compared += 1
    assert compared >= 6


@pytest.mark.parametrize("name", ["pitot", "magnetometer"])
def test_what_is_hidden_is_what_the_diagnosis_advises(name: str) -> None:
    flight = sepcal.datasets.load(name)
    found = sepcal.fit(MODELS[name], flight).diagnose()
    assert found.advice.effect in flight.effects
    assert found[flight.effects[0]].status == "found"


def test_readings_lie_on_the_steps_that_are_told() -> None:
    for name, recipe in make.RECIPES.items():
        flight = sepcal.datasets.load(name)
        assert list(flight) == list(recipe.steps)
        for header, step in recipe.steps.items():
            places = flight[header] / step
            np.testing.assert_allclose(places, np.round(places), atol=1e-6)


def test_outliers_stand_where_they_are_told() -> None:
    """Their second differences are the largest of the column but for those of other outliers."""
    import json

    told = json.loads(shipped("truth.json"))
    for name, header in (("magnetometer", "mx_ut"), ("aircraft", "alpha_rad")):
        values = sepcal.datasets.load(name)[header]
        bend = np.abs(np.diff(values, 2))
        size = abs(told[name]["outliers"]["sizes"][header])
        for row in told[name]["outliers"]["rows"]:
            assert bend[row - 1] > size, (name, row)


def test_it_is_called_the_same_wherever_the_package_is() -> None:
    flight = sepcal.datasets.load("pitot")
    assert flight.name == "pitot.csv"
    assert str(Path(sepcal.__file__).parent) not in sepcal.fit(MODELS["pitot"], flight).to_json()


def test_another_name_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(sepcal.Error, match=r"'pito'; there are: aircraft, magnetometer, pitot$"):
        sepcal.datasets.load("pito")


@pytest.mark.parametrize("module", [sepcal, sepcal.rivals, sepcal.triads, sepcal.datasets])
def test_dir_shows_what_is_public_alone(module) -> None:
    assert dir(module) == sorted(module.__all__)
    assert all(hasattr(module, name) for name in module.__all__)
