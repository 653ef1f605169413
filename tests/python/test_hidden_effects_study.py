# SPDX-License-Identifier: BSD-3-Clause
"""The study of hidden effects: its sizes, its rates, and what it writes."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import beta

import sepcal
from sepcal import fit
from sepcal.study import StudyOptions, cases, experiments, hidden_effects
from sepcal.study.write_up import upper_limit, write_up

LINEAR = {case.effect: case for case in cases.CASES if case.probe != "pitot-static"}


@pytest.mark.parametrize("name", ["wind[altitude_m]", "heading_bias", "bias[current_a]"])
def test_size_in_sigmas_is_the_root_of_the_noncentrality(name):
    """The drop of chi-squared by the effect itself is noncentral: mean 25 + q, variance 100 + 2 q.

    At four standard errors of the mean of 40 flights: one false alarm in 16,000 runs.
    """
    case = LINEAR[name]
    factor = cases.factor_for(case, 5.0)
    noise = dict.fromkeys(cases.OUTPUTS[case.probe], cases.NOISE[case.probe])
    drops = []
    for seed in range(40):
        flight = cases.fly(case.probe, {case.effect: case.sizes(factor)}, seed, case.rows)
        square = [
            sum((calibration.rmse[z] / sigma) ** 2 for z, sigma in noise.items()) * case.rows
            for calibration in (
                fit(cases.PROBES[case.probe], flight, noise=noise, effects=effects, threads=1)
                for effects in ([], flight.effects)
            )
        ]
        drops.append(square[0] - square[1])
    freedom = {"wind[altitude_m]": 2, "heading_bias": 1, "bias[current_a]": 3}[name]
    error = np.sqrt((100.0 + 2.0 * freedom) / len(drops))
    assert abs(np.mean(drops) - 25.0 - freedom) < 4.0 * error


@pytest.mark.parametrize(("events", "trials"), [(0, 300), (3, 120), (24, 1200), (7, 7)])
def test_upper_limit_is_that_of_clopper_and_pearson(events, trials):
    expected = 1.0 if events == trials else beta.ppf(0.99, events + 1, trials - events)
    assert upper_limit(events, trials) == pytest.approx(expected, rel=1e-9)


@pytest.fixture
def small(monkeypatch):
    """Two effects, one pair, one noise: a study of a minute."""
    by_name = {(case.probe, case.effect): case for case in cases.CASES}
    flap = by_name["pitot-static", "airspeed_scale[flap]"]
    wind = by_name["pitot-static", "wind[time]"]
    chosen = {
        "CASES": (flap, wind),
        "PAIRS": ((flap, wind),),
        "PROBES": {"pitot-static": cases.PROBES["pitot-static"]},
        "NOISES": ("white",),
        "UNLOGGED": (flap,),
    }
    for name, value in chosen.items():
        monkeypatch.setattr(experiments, name, value)
    return StudyOptions(seeds=1, null_seeds=2, sigmas=(10.0,), processes=2)


def test_a_small_study_runs_and_is_written_up(small, tmp_path):
    told = []
    rows = hidden_effects(small, told.append)
    assert told[-1] == 1.0
    assert [row["found"] for row in rows["power"]] == [True, True]
    assert [row["verdict"] for row in rows["null"]] == ["adequate", "adequate"]
    assert len(rows["pairs"]) == len(rows["unlogged"]) == 1
    again = hidden_effects(small)
    assert again == rows  # by seed, not by who was first

    file = tmp_path / "study.md"
    write_up(rows, small, file)
    text = file.read_text(encoding="utf-8")
    assert "| pitot-static | `wind[time]` | 100 / 100 |" in text
    assert "| white | 0 of 2 |" in text
    assert "<svg" in file.with_suffix(".svg").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        (["--seeds", "0"], "--seeds"),
        (["--processes", "0"], "--processes"),
        (["-o", "nowhere/study.md"], "nowhere"),
    ],
)
def test_bad_usage_is_one_line(arguments, culprit, tmp_path):
    package = Path(sepcal.__file__).parent.parent
    run = subprocess.run(
        [sys.executable, "-m", "sepcal", "study", "hidden-effects", *arguments],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(package)},
        check=False,
    )
    assert run.returncode == 2
    assert culprit in run.stderr
    assert run.stderr.count("\n") == 1
