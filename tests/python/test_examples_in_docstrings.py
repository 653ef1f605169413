# SPDX-License-Identifier: BSD-3-Clause
"""Every public function and class has an example in its docstring, and all of them run."""

from __future__ import annotations

import doctest
import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import sepcal

pytest.importorskip("plotly", reason="examples draw: pip install sepcal[report]")
pytest.importorskip("matplotlib", reason="examples draw: pip install sepcal[plot]")
pytest.importorskip("pygeomag", reason="an example has the Earth's field: pip install sepcal[logs]")

# What a call gives and nobody makes is shown where it is given; a model's contract and a model of
# one's own are shown as whole programs, which other tests run.
SHOWN_ELSEWHERE = {
    "AddedRegressor", "AeroCoefficients", "Certificate", "Concatenation", "CostBound",
    "DiscreteInputs", "EarthField", "Estimates", "Failure", "FitOptions", "LeastSquares",
    "LogContents", "LoggedFlight", "ParameterStudy", "Transition", "TrajectoryModel",
    "TrajectoryOptions", "TrialFits", "TrialRecord", "TwoSteps", "Validation",
    "DesignTrial", "Model", "OwnModel", "SeparableModel", "StateModel", "Trajectory",
}  # fmt: skip
# Takes a log of an autopilot, two logs with clocks of their own, a long search, or a model with a
# state of one's own: other tests run what the documentation shows of them.
WITHOUT = {
    "aero_coefficients", "bound_cost", "certify", "join", "list_log", "read_log", "smooth", "track",
    "validate",
}  # fmt: skip
OWN = [
    name
    for name in sepcal.__all__
    if (inspect.isclass(at := getattr(sepcal, name)) or inspect.isfunction(at))
    and not at.__module__.startswith("sepcal._")
    and name != "Error"
]


def collect() -> Iterator[doctest.DocTest]:
    """Of every module, each example with numpy, sepcal and a folder."""
    finder = doctest.DocTestFinder(exclude_empty=True)
    for found in pkgutil.walk_packages(sepcal.__path__, "sepcal."):
        if found.name.endswith("__main__"):
            continue
        try:
            module = importlib.import_module(found.name)
        except ImportError:  # of an extra that is not installed
            continue
        globs = {"np": np, "sepcal": sepcal}
        yield from (one for one in finder.find(module, found.name, module, globs) if one.examples)


@pytest.mark.parametrize("example", [pytest.param(one, id=one.name) for one in collect()])
def test_an_example_says_what_comes_of_it(example: doctest.DocTest, tmp_path: Path) -> None:
    example.globs["folder"] = tmp_path
    runner = doctest.DocTestRunner(verbose=False, optionflags=doctest.NORMALIZE_WHITESPACE)
    said: list[str] = []
    failed, tried = runner.run(example, out=said.append)
    assert tried > 0
    assert failed == 0, "".join(said)


@pytest.mark.parametrize("name", OWN)
def test_what_is_public_has_an_example(name: str) -> None:
    has_one = ">>>" in (inspect.getdoc(getattr(sepcal, name)) or "")
    assert has_one or name in SHOWN_ELSEWHERE | WITHOUT


def test_what_is_shown_elsewhere_is_public() -> None:
    assert set(OWN) >= SHOWN_ELSEWHERE | WITHOUT
