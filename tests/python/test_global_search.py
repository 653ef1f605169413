# SPDX-License-Identifier: BSD-3-Clause
"""Stage one by NLopt against SciPy's own minima, and the screens as fit() shows them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import minimize

import sepcal
from oracle.cases import state_case
from oracle.residual_sampling import estimate_linear


def test_minima_are_those_that_scipy_descends_to() -> None:
    """Scalar example 2 over every phase: the ends below twice the lowest Tr[R], and no others.

    Descents of ln Tr[R] by its exact gradient from 100 points. Those that stop on a slope, as they
    do in narrow valleys, are no ends.
    """
    case = state_case("scalar_2")
    bounds = {"b": (-2.0, 2.0), "c": (-np.pi, np.pi)}
    stage_one = sepcal.fit(
        sepcal.ScalarExample2(), case.record, bounds=bounds, search="global", descents=30
    ).stage_one
    lower, upper = np.array(list(bounds.values())).T

    def log_trace(xi2: np.ndarray) -> tuple[float, np.ndarray]:
        estimate = estimate_linear(case.model, case.record, xi2)
        return np.log(estimate.trace_r), estimate.gradient / estimate.trace_r

    ends: list[tuple[float, np.ndarray]] = []
    for start in np.random.default_rng(1).uniform(lower, upper, size=(100, 2)):
        end = minimize(
            log_trace,
            start,
            jac=True,
            bounds=list(zip(lower, upper, strict=True)),
            method="L-BFGS-B",
            options={"ftol": 1e-15, "gtol": 1e-8},
        )
        slope = np.clip(end.x - end.jac, lower, upper) - end.x  # without what bounds hold
        met = any(np.linalg.norm(end.x - xi2) < 1e-3 for _, xi2 in ends)
        if np.linalg.norm(slope) < 1e-5 and not met:
            ends.append((end.fun, end.x))
    lowest = min(value for value, _ in ends)
    deep = [(value, xi2) for value, xi2 in ends if value < lowest + np.log(2.0)]
    found = [(np.log(at.trace_r), np.array([at.xi2["b"], at.xi2["c"]])) for at in stage_one.minima]
    found_deep = [(value, xi2) for value, xi2 in found if value < lowest + np.log(2.0)]
    # Two pairs half a turn apart, one of them on a bound of b, and one minimum on a bound of c.
    assert len(deep) == len(found_deep) == 5
    assert len({round(value, 6) for value, _ in deep}) == 3
    for value, xi2 in deep:
        value_found, nearest = min(found_deep, key=lambda at: np.linalg.norm(at[1] - xi2))
        assert_allclose(nearest, xi2, atol=1e-5)
        assert_allclose(value_found, value, atol=1e-9)


def test_both_searches_end_in_the_same_fit() -> None:
    """Stage two starts at the same minimum."""
    case = state_case("scalar_1")
    model = sepcal.ScalarExample1()
    sampled = sepcal.fit(model, case.record, bounds=case.bounds)
    searched = sepcal.fit(model, case.record, bounds=case.bounds, search="global", samples=100)
    assert searched.stage_one.samples.shape == (100, 1)
    assert searched.second_stage == sampled.second_stage
    assert_allclose(searched.values, sampled.values, rtol=1e-8)


def test_screens_are_shown_where_they_are_asked_for() -> None:
    """Ratios and curvatures of every sample, and which were used."""
    case = state_case("scalar_1")
    model = sepcal.ScalarExample1()
    assert sepcal.fit(model, case.record, bounds=case.bounds).stage_one.screens is None
    stage_one = sepcal.fit(
        model, case.record, bounds=case.bounds, samples=50, screens={"t_1": 0.6, "l_2": 0.5}
    ).stage_one
    screens = stage_one.screens
    assert screens is not None
    eta = np.asarray(case.record["eta"], dtype=float)[:, np.newaxis]
    wave = np.cos(eta + stage_one.samples[:, 0])
    slope = np.sin(eta + stage_one.samples[:, 0])
    expected = 0.5 * np.sqrt((slope**2).sum(axis=0) / (wave**2 + 1).sum(axis=0))
    assert_allclose(screens.ratio_a, expected, rtol=1e-10)
    assert_allclose(
        screens.ratio_b, 0.5 * np.sqrt((slope**2).sum(axis=0) / (wave**2).sum(axis=0)), rtol=1e-10
    )
    assert np.array_equal(screens.accepted, screens.ratio_a <= 0.6)
    assert np.array_equal(np.sign(screens.curvature_a), np.sign(-wave.sum(axis=0)))


def test_screens_that_reject_everything_say_what_would_pass() -> None:
    """One line with the threshold to loosen."""
    case = state_case("scalar_1")
    with pytest.raises(sepcal.Error, match=r"the screens reject all .* loosen t_1 to at least"):
        sepcal.fit(sepcal.ScalarExample1(), case.record, bounds=case.bounds, screens={"t_1": 1e-3})
