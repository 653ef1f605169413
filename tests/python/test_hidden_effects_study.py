# SPDX-License-Identifier: BSD-3-Clause
"""The study of hidden effects: its sizes, its rates, and what it writes."""

import pytest
from scipy.stats import beta

from sepcal.quantiles import upper_limit
from studies.hidden_effects import cases, experiments, sizes
from studies.hidden_effects.experiments import StudyOptions, hidden_effects
from studies.hidden_effects.write_up import write_up


@pytest.mark.parametrize("case", sizes.SIZED, ids=lambda case: case.effect)
def test_size_in_sigmas_is_the_root_of_the_noncentrality(case):
    """Of eight flights, which show a size that is a third too large; the study has 40."""
    assert sizes.check_size(case, range(8)).holds


@pytest.mark.parametrize(("events", "trials"), [(0, 300), (3, 120), (24, 1200), (7, 7)])
def test_upper_limit_is_that_of_clopper_and_pearson(events, trials):
    expected = 1.0 if events == trials else beta.ppf(0.99, events + 1, trials - events)
    assert upper_limit(events, trials) == pytest.approx(expected, rel=1e-9)


@pytest.fixture
def small(monkeypatch):
    """Two effects, one pair, one noise: a study of 20 seconds."""
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


@pytest.mark.slow
def test_a_small_study_runs_and_is_written_up(small, tmp_path):
    told = []
    rows = hidden_effects(small, told.append)
    assert told[-1] == 1.0
    assert [row["found"] for row in rows["power"]] == [True, True]
    assert [row["verdict"] for row in rows["null"]] == ["adequate", "adequate"]
    assert len(rows["pairs"]) == len(rows["unmeasured"]) == 1
    for experiment in ("power", "null"):  # by seed, not by who was first
        tasks = [task for task in experiments._tasks(small) if task[0] == experiment]
        assert [experiments._run(*task)[1] for task in tasks] == rows[experiment]

    file = tmp_path / "study.md"
    write_up(rows, small, file)
    text = file.read_text(encoding="utf-8")
    assert "| pitot-static | `wind[time]` | 100/100 |" in text
    assert "| white | 0 of 2 |" in text
    assert "<svg" in file.with_suffix(".svg").read_text(encoding="utf-8")
