# SPDX-License-Identifier: BSD-3-Clause
"""sepcal.validate(): both solvers end in the same minimum, and where they don't, it says so."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import sepcal
from example_models import FILE, models
from sepcal.validation import command, designs, scipy_fit

APART = 1e-5  # standard errors


def _run(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "sepcal", "validate", *words], capture_output=True, text=True,
        check=False, env=os.environ,
    )  # fmt: skip


@pytest.mark.parametrize("name", designs.DESIGNS)
def test_models_that_ship_end_where_scipy_does(name: str) -> None:
    """The same estimates and standard errors, in every trial."""
    design = designs.make_design(name, 200)
    found = sepcal.validate(
        design.model, design.inputs, truth=design.truth, scatter=design.scatter, trials=4, seed=3
    )
    assert found.same_minimum.all(), str(found)
    assert found.largest_difference < APART, str(found)
    assert found.converged == 4
    for row in found.to_dict()["parameters"]:
        assert row["largest_error_difference"] < 1e-5


def test_own_models_too() -> None:
    """A static one, and one with a state."""
    speed = np.linspace(3.0, 25.0, 120)
    wire = sepcal.validate(
        models.HotWire(), {"u": speed}, truth={"A": 2.0, "B": 1.1, "n": 0.45}, scatter=0.01,
        trials=5,
    )  # fmt: skip
    assert wire.largest_difference < APART
    time = 0.05 * np.arange(120)
    swing = sepcal.validate(
        models.Pendulum(),
        {"time": time, "torque": 3.0 * np.sin(time / 0.7)},
        truth={"zero": 0.01, "w2": 12.0, "d": 0.3, "k": 2.0, "theta_0": 0.3, "rate_0": -0.2},
        scatter=0.002,
        trials=2,
        options={"samples": 64},
    )
    assert swing.largest_difference < 1e-4, str(swing)


def test_the_table_is_of_its_numbers() -> None:
    """Bias, coverage and its limits are those of the estimates that it holds."""
    design = designs.make_design("scalar-1", 100)
    found = sepcal.validate(
        design.model, design.inputs, truth=design.truth, scatter=design.scatter, trials=40
    )
    rows = {row["name"]: row for row in found.to_dict()["parameters"]}
    b = found.names.index("b")
    errors = found.estimates[:, b] - 0.1
    assert rows["b"]["bias"] == pytest.approx(errors.mean())
    inside = np.abs(errors) < 1.959964 * found.standard_errors[:, b]
    assert rows["b"]["coverage"] == pytest.approx(inside.mean())
    low, high = rows["b"]["coverage_limits"]
    assert low < inside.mean() <= high
    assert "40 trials of 100 rows" in str(found)


def test_another_minimum_is_told() -> None:
    """A start from which sepcal ends higher than SciPy does."""
    design = designs.make_design("scalar-2", 200)
    found = sepcal.validate(
        design.model,
        design.inputs,
        truth=design.truth | {"b": 0.3},
        scatter=0.1,
        trials=3,
        options={"start": {"b": -0.45, "c": 0.9}},
    )
    assert found.lower == (0, 3), str(found)
    assert np.isnan(found.largest_difference)
    assert "SciPy's in 3" in str(found)
    assert not command._agree(found)


def test_a_solver_that_errs_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """A hundredth of a standard error is seen."""
    right = scipy_fit.fit_by_scipy

    def wrong(*given: object) -> scipy_fit.ScipyFit:
        fit = right(*given)  # type: ignore[arg-type]
        off = fit.values + 0.005 * np.nan_to_num(fit.standard_errors)
        return scipy_fit.ScipyFit(off, fit.standard_errors, fit.squares)

    monkeypatch.setattr("sepcal.validation.study.fit_by_scipy", wrong)
    design = designs.make_design("scalar-1", 100)
    found = sepcal.validate(
        design.model, design.inputs, truth=design.truth, scatter=design.scatter, trials=2
    )
    assert found.largest_difference == pytest.approx(0.005, rel=1e-3)
    assert not command._agree(found)


def test_what_it_can_not_compare_is_refused() -> None:
    """In a line that says what to leave out."""
    design = designs.make_design("scalar-1", 100)
    for options in ({"loss": "huber"}, {"prior": {"a": (1.0, 0.1)}}):
        with pytest.raises(sepcal.Error, match=f"leave out {next(iter(options))}"):
            sepcal.validate(
                design.model, design.inputs, truth=design.truth, scatter=0.3, options=options
            )
    with pytest.raises(sepcal.Error, match="the truth lacks b"):
        sepcal.validate(design.model, design.inputs, truth={"a": 1.0, "c": 1.0}, scatter=0.3)


def test_without_scipy_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """It says pip install sepcal[validate]."""
    monkeypatch.setitem(sys.modules, "scipy.optimize", None)
    design = designs.make_design("scalar-1", 100)
    with pytest.raises(sepcal.Error, match=r"pip install sepcal\[validate\]"):
        sepcal.validate(design.model, design.inputs, truth=design.truth, scatter=0.3)


def test_from_the_command_line(tmp_path: Path) -> None:
    """Chosen models as tables and as JSON; a model of one's own on a log."""
    told = _run("scalar-1", "scalar-2", "--trials", "3", "--rows", "100")
    assert told.returncode == 0, told.stderr
    assert told.stdout.count("the same minimum in 3 of 3") == 2
    read = json.loads(_run("scalar-1", "--trials", "3", "--json").stdout)
    assert read[0]["same_minimum"] == 3
    speed = np.linspace(3.0, 25.0, 150)
    noise = 0.01 * np.random.default_rng(1).normal(size=150)
    log, base = tmp_path / "tunnel.csv", tmp_path / "base.json"
    rows = np.column_stack([0.1 * np.arange(150), speed, 2.0 + 1.1 * speed**0.45 + noise])
    np.savetxt(log, rows, delimiter=",", header="time_s,u_mps,e2", comments="")
    flight = sepcal.read_csv(str(log))
    fitted = sepcal.fit(models.HotWire(), flight)
    assert isinstance(fitted, sepcal.Calibration)
    fitted.save(base)
    own = _run("--model", f"{FILE}:HotWire", str(log), str(base), "--trials", "3")
    assert own.returncode == 0, own.stderr
    assert "HotWire: 3 trials of 150 rows" in own.stdout


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("scalar-3",), "there is no model 'scalar-3'"),
        (("scalar-1", "--rows", "5"), "5 rows are too few"),
        (("scalar-1", "--trials", "1"), "--trials 1: give at least 2"),
        (("--model", f"{FILE}:HotWire"), "give LOG.csv CAL.json"),
    ],
)
def test_what_it_can_not_do_is_said(words: tuple[str, ...], said: str) -> None:
    """In one line, with exit code 2."""
    refused = _run(*words)
    assert refused.returncode == 2
    assert said in refused.stderr
    assert len(refused.stderr.splitlines()) == 1
