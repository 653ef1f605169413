# SPDX-License-Identifier: BSD-3-Clause
"""examples/first_calibration.ipynb: its cells run, and say what the text around them promises."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import pytest

import sepcal

pytest.importorskip("plotly", reason="the notebook draws with plotly: pip install sepcal[report]")

NOTEBOOK = Path(__file__).resolve().parents[2] / "examples" / "first_calibration.ipynb"


@pytest.fixture(scope="module")
def notebook() -> dict:
    if not NOTEBOOK.exists():
        pytest.skip("the examples are not beside these tests")
    return json.loads(NOTEBOOK.read_text(encoding="utf-8"))


def run(source: str, names: dict) -> object:
    """A cell; its last line's value, as a notebook shows it."""
    tree = ast.parse(source)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "cell", "exec"), names)
    return eval(compile(ast.Expression(last.value), "cell", "eval"), names) if last else None


def test_it_runs_and_the_error_falls(notebook: dict, capsys: pytest.CaptureFixture[str]) -> None:
    names: dict = {}
    shown = [
        run("".join(cell["source"]), names)
        for cell in notebook["cells"]
        if cell["cell_type"] == "code"
    ]
    drawn = [at for at in shown if hasattr(at, "to_json") and hasattr(at, "layout")]
    assert len(drawn) == 7
    flight, base, better = names["flight"], names["base"], names["better"]
    assert [step.effect for step in better.history] == list(flight.effects)
    assert better.history[0].rmse_after < 0.75 * better.history[0].rmse_before
    assert names["again"].verdict == "adequate"
    for name in base.names:  # each lies within its errors about the truth
        off = abs(better[name].value - flight.truth[name])
        within = off <= 3.0 * better[name].standard_error
        assert better[name].fixed or within, name
    assert (names["folder"] / "report.html").exists()
    assert isinstance(sepcal.load(names["folder"] / "tube.json"), sepcal.Calibration)
    assert "standard errors" in capsys.readouterr().out


def test_no_output_is_kept(notebook: dict) -> None:
    """Outputs would hold a machine's paths, and grow stale."""
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in cells)
