# SPDX-License-Identifier: BSD-3-Clause
"""The notebooks of examples/: their cells run, and say what the text around them promises."""

from __future__ import annotations

import ast
import json
from pathlib import Path
from typing import Any

import pytest

import sepcal

pytest.importorskip("plotly", reason="notebooks draw with plotly: pip install sepcal[report]")

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
NOTEBOOKS = sorted(EXAMPLES.glob("*.ipynb"))


def read_cells(notebook: Path) -> list[dict]:
    """Those of code."""
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    return [cell for cell in cells if cell["cell_type"] == "code"]


def run_cell(source: str, names: dict) -> object:
    """A cell; its last line's value, as a notebook shows it."""
    tree = ast.parse(source)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "cell", "exec"), names)
    return eval(compile(ast.Expression(last.value), "cell", "eval"), names) if last else None


def run(name: str) -> tuple[dict[str, Any], int]:
    """The names that a notebook's cells leave, and how many pictures they drew."""
    notebook = EXAMPLES / f"{name}.ipynb"
    if not notebook.exists():
        pytest.skip("the examples are not beside these tests")
    names: dict[str, Any] = {}
    shown = [run_cell("".join(cell["source"]), names) for cell in read_cells(notebook)]
    return names, sum(hasattr(at, "to_json") and hasattr(at, "layout") for at in shown)


def check_truth(calibration: sepcal.Calibration, truth: dict[str, float]) -> None:
    """Each estimate lies within three of its errors about the truth."""
    for name, parameter in calibration.parameters.items():
        off = abs(parameter.value - truth[name])
        assert parameter.fixed or off <= 3.0 * parameter.standard_error, name


def test_a_tube_is_calibrated_from_its_log(capsys: pytest.CaptureFixture[str]) -> None:
    names, drawn = run("first_calibration")
    assert drawn == 3
    check_truth(names["fit"], names["simulated"].truth)
    said = capsys.readouterr().out
    assert "nothing to note" in said
    assert "status: converged" in said
    assert "Nothing is missing" in said
    assert isinstance(names["again"], sepcal.Calibration)


def test_the_hidden_effect_is_found_and_the_error_falls(capsys: pytest.CaptureFixture[str]) -> None:
    names, drawn = run("hidden_effect")
    assert drawn == 7
    flight, better = names["flight"], names["better"]
    assert [step.effect for step in better.history] == list(flight.effects)
    assert better.history[0].rmse_after < 0.75 * better.history[0].rmse_before
    assert names["again"].verdict == "adequate"
    check_truth(better, flight.truth)
    assert (names["folder"] / "report.html").exists()
    assert isinstance(sepcal.load(names["folder"] / "tube.json"), sepcal.Calibration)
    assert "standard errors" in capsys.readouterr().out


def test_a_model_and_an_effect_of_ones_own_give_the_truth_back() -> None:
    names, drawn = run("own_model")
    assert drawn == 4
    assert names["found"].advice.effect == "e2_bias[temp_degc]"
    check_truth(names["better"], names["truth"])
    assert names["better"].diagnose().verdict == "adequate"


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda notebook: notebook.stem)
def test_no_output_is_kept(notebook: Path) -> None:
    """Outputs would hold a machine's paths, and grow stale."""
    assert all(at["outputs"] == [] and at["execution_count"] is None for at in read_cells(notebook))
