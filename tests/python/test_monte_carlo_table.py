# SPDX-License-Identifier: BSD-3-Clause
"""A study as it prints: failures first, no truth, no bias."""

import numpy as np

import sepcal
from sepcal.trials import Estimates


def test_failures_are_counted_in_the_table():
    def trial(rng, index):
        if index < 6:
            raise ValueError(f"no luck with {index}")
        return 1.0

    lines = str(sepcal.monte_carlo(trial, 8)).splitlines()
    assert lines[0] == "8 trials: 6 failed"
    assert lines[-4:] == [
        *(f"trial {index} failed: ValueError: no luck with {index}" for index in range(3)),
        "and 3 more failed; `failed` has the record of each",
    ]
    assert "more failed" not in str(sepcal.monte_carlo(trial, range(3, 8)))


def test_a_study_that_failed_altogether_says_so_first():
    def trial(rng, index):
        raise ValueError(f"no luck\nwith {index}")

    assert str(sepcal.monte_carlo(trial, range(3, 5))).splitlines() == [
        "all 2 trials failed; trial 3: ValueError: no luck with 3",
        "trial 4 failed: ValueError: no luck with 4",
    ]
    assert str(sepcal.monte_carlo(trial, 6)).splitlines()[-1].startswith("and 2 more failed")
    one = str(sepcal.monte_carlo(trial, 1))
    assert one == "the only trial failed; trial 0: ValueError: no luck with 0"


def test_the_table_without_a_truth():
    study = sepcal.monte_carlo(lambda rng, index: {"x": float(index), "longer_name": 2.0}, 3)
    assert str(study).splitlines() == [
        "3 trials",
        "parameter    mean  scatter  std. error  of",
        "x               1        1           -   3",
        "longer_name     2        0           -   3",
    ]


def test_trials_far_from_the_truth_are_counted():
    """Two of five end 20 standard errors off, which `5 converged` alone would hide."""

    def trial(rng, index):
        value = 1.0 if index in (1, 3) else 0.0
        errors = np.array([0.05, np.nan])
        estimates = np.array([value, 9.0])
        return Estimates(("x", "fixed"), estimates, errors, 10, "converged", "", np.zeros(2))

    study = sepcal.monte_carlo(trial, 5)
    assert study.far == [1, 3]
    assert str(study).splitlines()[:2] == [
        "5 trials: 5 converged",
        "2 of 5 lie over 6 standard errors from the truth: another minimum, or errors that are too "
        "small; `far` lists them",
    ]
    assert "lie over" not in str(sepcal.monte_carlo(trial, range(4, 8)))
