# SPDX-License-Identifier: BSD-3-Clause
"""Trials of one design: side by side they are what they are one by one, on any executor."""

import pickle
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest
from numpy.random import SeedSequence, default_rng
from numpy.testing import assert_allclose, assert_array_equal

import sepcal

ETA = np.linspace(1.0, 10.0, 60)
TRUTH = {"a": 0.3, "c": 1.0, "b": 0.2}
PLAIN = {"samples": 0, "coloured_errors": False}


def scalar_trial(**options) -> sepcal.DesignTrial:
    return sepcal.DesignTrial(
        sepcal.ScalarExample1(), {"eta": ETA}, TRUTH, 0.1, **{**PLAIN, **options}
    )


def assert_same(together: sepcal.MonteCarlo, single: sepcal.MonteCarlo) -> None:
    errors = single.standard_errors
    assert together.names == single.names
    assert (np.abs(together.estimates - single.estimates) <= 1e-9 * np.nan_to_num(errors)).all()
    assert_allclose(together.standard_errors, errors, rtol=1e-8)
    assert_array_equal(together.truth, single.truth)
    for one, other in zip(together.values, single.values, strict=True):
        assert (one.status, one.message) == (other.status, other.message)
        assert one.degrees_of_freedom == other.degrees_of_freedom


def alone(trial: sepcal.DesignTrial):
    """The same trial, with nothing but its call."""
    return lambda rng: trial(rng)


@pytest.mark.parametrize(
    "options",
    [{}, {"fix": {"c": 1.0}}, {"noise": {"z": 0.1}}, {"samples": 50, "descents": 1}],
    ids=["middle", "fix", "noise", "sampled"],
)
def test_a_study_is_the_same_side_by_side(options):
    trial = scalar_trial(**options)
    assert trial.goes_together
    together = sepcal.monte_carlo(trial, trials=37, seed=4)
    assert_same(together, sepcal.monte_carlo(alone(trial), trials=37, seed=4))


def test_a_probe_is_too():
    rng = default_rng(1)
    heading = rng.uniform(-np.pi, np.pi, 150)
    speed = rng.uniform(15.0, 30.0, 150)
    design = {
        "vn": speed * np.cos(heading),
        "ve": speed * np.sin(heading),
        "vd": rng.uniform(-6.0, 6.0, 150),
    }
    truth = {"s_va": 0.95, "c_va": -0.6, "w_n": -3.8, "w_e": 2.4, "w_d": 0.0}
    trial = sepcal.DesignTrial(
        sepcal.PitotStatic(), design, truth, {"airspeed": 0.2}, start={"w_n": -3.0}, **PLAIN
    )
    together = sepcal.monte_carlo(trial, trials=10)
    assert_same(together, sepcal.monte_carlo(alone(trial), trials=10))


@pytest.mark.parametrize("executor", [ThreadPoolExecutor, ProcessPoolExecutor])
def test_the_executor_does_not_matter(executor):
    trial = scalar_trial()
    serial = sepcal.monte_carlo(trial, trials=30, batch=8)
    elsewhere = sepcal.monte_carlo(trial, trials=range(30), batch=7, executor=executor)
    assert_array_equal(serial.estimates, elsewhere.estimates)
    assert_array_equal(serial.standard_errors, elsewhere.standard_errors)


def test_draws_are_those_of_the_generator():
    trial = scalar_trial()
    rng = default_rng(SeedSequence(3, spawn_key=(5,)))
    drawn = trial.draw(rng)["z"]
    noise = default_rng(SeedSequence(3, spawn_key=(5,))).standard_normal(60)
    assert_allclose(drawn, 1.3 * np.cos(ETA + 0.2) + 1.0 + 0.1 * noise, rtol=1e-14)


def test_what_side_by_side_leaves_out():
    assert not scalar_trial(coloured_errors=True).goes_together
    assert not scalar_trial(samples=20).goes_together
    assert isinstance(
        sepcal.monte_carlo(scalar_trial(), trials=1, keep_fits=True).values[0][0], sepcal.Fit
    )
    assert pickle.loads(pickle.dumps(scalar_trial())).goes_together


def test_measurements_of_ones_own():
    z = scalar_trial().exact["z"] + 0.1 * default_rng(8).standard_normal((9, 60))
    z[4, 7] = np.nan
    fits = sepcal.fit_trials(sepcal.ScalarExample1(), {"eta": ETA}, {"z": z}, **PLAIN)
    assert list(fits.failures) == [4]
    assert "row 7" in fits.failures[4]
    assert fits.in_lanes.sum() == 8
    one = sepcal.fit(sepcal.ScalarExample1(), {"eta": ETA, "z": z[2]}, **PLAIN)
    assert_allclose(fits.estimates[2], one.values, rtol=1e-9)
    assert_allclose(fits.squared_residuals[2, 0], 60 * one.rmse["z"] ** 2, rtol=1e-8)
    coloured = sepcal.fit_trials(sepcal.ScalarExample1(), {"eta": ETA}, {"z": z[:2]}, samples=20)
    assert not coloured.in_lanes.any()


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: scalar_trial(descent=1), "no option 'descent'"),
        (
            lambda: sepcal.DesignTrial(sepcal.ScalarExample1(), {"eta": ETA}, {"a": 1.0}, 0.1),
            "the truth lacks c, b",
        ),
        (
            lambda: sepcal.fit_trials(sepcal.ScalarExample1(), {"eta": ETA}, {"z": ETA}),
            r"have the shape \(60,\); give a row a trial, \(K, N\)",
        ),
        (
            lambda: sepcal.fit_trials(
                sepcal.ScalarExample1(), {"eta": ETA}, {"z": np.ones((2, 9))}
            ),
            "output 'z' has 18 values; give 60",
        ),
    ],
)
def test_misuse_is_said(call, said):
    with pytest.raises((sepcal.Error, TypeError), match=said):
        call()
