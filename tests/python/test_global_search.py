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
    """Scalar example 2 over every phase: each end of a hundred descents that lies low is listed."""
    case = state_case("scalar_2")
    bounds = {"b": (-0.5, 0.5), "c": (-np.pi, np.pi)}
    stage_one = sepcal.fit(
        sepcal.ScalarExample2(), case.record, bounds=bounds, search="global", descents=30
    ).stage_one
    found = np.array([[at.xi2["b"], at.xi2["c"]] for at in stage_one.minima])
    lower, upper = np.array(list(bounds.values())).T
    ends = [
        minimize(
            lambda xi2: np.log(estimate_linear(case.model, case.record, xi2).trace_r),
            start,
            bounds=list(zip(lower, upper, strict=True)),
            method="L-BFGS-B",
        )
        for start in np.random.default_rng(1).uniform(lower, upper, size=(100, 2))
    ]
    lowest = min(end.fun for end in ends)
    assert_allclose(np.log(stage_one.minima[0].trace_r), lowest, atol=1e-8)
    deep = [end.x for end in ends if end.fun < lowest + 1e-6]
    assert len(deep) > 0
    for xi2 in deep:
        assert np.min(np.linalg.norm(found - xi2, axis=1)) < 1e-3


def test_both_searches_end_in_the_same_fit() -> None:
    """Stage two starts at the same minimum."""
    case = state_case("scalar_1")
    model = sepcal.ScalarExample1()
    sampled = sepcal.fit(model, case.record, bounds=case.bounds)
    searched = sepcal.fit(model, case.record, bounds=case.bounds, search="global", samples=100)
    assert searched.stage_one.samples.shape == (100, 1)
    assert searched.method == sampled.method
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
