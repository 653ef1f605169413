# SPDX-License-Identifier: BSD-3-Clause
"""Misuse of monte_carlo() and of what it returns: one line that names the culprit."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import sepcal
from trial_functions import TRUTH, fit_scalar


def test_a_pool_that_was_shut_down_is_said_to_be():
    with ThreadPoolExecutor(1) as pool:
        pass
    with pytest.raises(sepcal.Error, match="the executor was shut down before the work was done"):
        sepcal.monte_carlo(fit_scalar, 3, executor=pool)


def test_a_truth_of_other_names_is_refused_at_the_first_fit():
    ran = []

    def trial(rng, index):
        ran.append(index)
        if index == 0:
            raise ValueError("not yet")
        return fit_scalar(rng)

    words = "truth: no trial estimates 'aa'; they estimate: a, c, b"
    with pytest.raises(sepcal.Error, match=words):
        sepcal.monte_carlo(trial, 9, truth={"aa": 2.0, "c": 1.0})
    assert ran == [0, 1]
    records = list(sepcal.stream_trials(trial, 2))
    with pytest.raises(sepcal.Error, match=words):
        sepcal.MonteCarlo(records, {"c": 1.0, "aa": 2.0})
    assert len(sepcal.MonteCarlo(records[:1], {"aa": 2.0})) == 1


def test_studies_that_do_not_go_together():
    def trial(rng, index):
        return {"a": 1.0, "x": np.zeros(index + 1)} if index else {"b": 1.0, "x": np.zeros(1)}

    study = sepcal.monte_carlo(trial, 3)
    for use in (study.summary, lambda: study["a"], lambda: study["x"]):
        with pytest.raises(sepcal.Error):
            use()
    assert "different parameters" in str(study)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"trials": 0}, "trials=0 must be at least 1"),
        ({"trials": [1, 1]}, "each once"),
        ({"trials": []}, "a whole number or indices"),
        ({"trials": 2.5}, "trials=2.5 must be a whole number or indices"),
        ({"trials": [0, 1.5]}, "a whole number or indices"),
        ({"trials": "10"}, "a whole number or indices"),
        ({"seed": 0.5}, "seed=0.5 must be an integer"),
        ({"trials": range(-1, 4)}, "0 and above"),
        ({"seed": -1}, "seed=-1 must not be negative"),
        ({"batch": 0}, "batch=0"),
        ({"executor": "threads"}, "executor is a str"),
        ({"trial": 3}, "the trial is a int; give a function"),
    ],
)
def test_refusals(arguments, words):
    with pytest.raises(sepcal.Error, match=words):
        sepcal.monte_carlo(**{"trial": fit_scalar, **arguments})


@pytest.mark.parametrize("level", [0.0, 1.0, 95])
def test_a_level_is_a_probability(level):
    study = sepcal.monte_carlo(fit_scalar, 2, truth=TRUTH)
    with pytest.raises(sepcal.Error, match="must be between 0 and 1"):
        study.summary(level=level)


@pytest.mark.parametrize(
    ("model", "arguments", "error", "words"),
    [
        (sepcal.ScalarExample1(), {}, sepcal.Error, "can't be flown.*trial of your own"),
        (sepcal.PitotStatic(), {"simulation": {"seed": 1}}, sepcal.Error, "simulation has a seed"),
        (sepcal.PitotStatic(), {"simulation": {"noise": "brown"}}, sepcal.Error, "brown"),
        (sepcal.PitotStatic(), {"simulation": {"hide": {"gusts": 1}}}, sepcal.Error, "gusts"),
        (sepcal.PitotStatic(), {"sampels": 3}, TypeError, "sampels"),
        (sepcal.Magnetometer(field_strength=50), {}, sepcal.Error, "doesn't show a rotation"),
    ],
)
def test_a_simulated_trial_refuses_at_once(model, arguments, error, words):
    with pytest.raises(error, match=words):
        sepcal.SimulatedTrial(model, **arguments)
