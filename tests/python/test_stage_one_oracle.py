# SPDX-License-Identifier: BSD-3-Clause
"""Stage one against NumPy: Tr[R] at the xi2 that it reports, and whether they are minima."""

from collections.abc import Mapping

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal
from oracle.cases import CASE_NAMES, Case, state_case
from oracle.closed_form import fit_scalar_example_1
from oracle.model import Array
from oracle.residual_sampling import estimate_linear
from own_models import BUILT_IN


@pytest.fixture(scope="module", params=CASE_NAMES)
def case(request: pytest.FixtureRequest) -> Case:
    """Each problem in turn."""
    return state_case(request.param)


@pytest.fixture(scope="module")
def stage_one(case: Case) -> sepcal.StageOne:
    """What stage one found within the case's bounds."""
    return search(case, case.bounds)


def search(case: Case, bounds: dict[str, tuple[float, float]]) -> sepcal.StageOne:
    """Stage one of a fit with the paper's 500 samples."""
    return sepcal.fit(
        BUILT_IN[case.name], case.record, bounds=bounds, samples=500, seed=5
    ).stage_one


def order(case: Case, xi2: Mapping[str, float]) -> Array:
    """The values of xi2 in the model's order, shape (n_2,)."""
    return np.array([xi2[name] for name in case.model.nonlinear])


def test_trace_r_is_that_of_lstsq(case: Case, stage_one: sepcal.StageOne) -> None:
    """Sum over the outputs of the mean square residual, at the best sample and every minimum."""
    reported = [(stage_one.best, np.min(stage_one.trace_r))]
    reported += [(minimum.xi2, minimum.trace_r) for minimum in stage_one.minima]
    expected = [estimate_linear(case.model, case.record, order(case, xi2)) for xi2, _ in reported]
    assert_allclose(
        [trace_r for _, trace_r in reported], [at.trace_r for at in expected], rtol=1e-10
    )


def test_nothing_lies_below_the_lowest_minimum(case: Case, stage_one: sepcal.StageOne) -> None:
    """Neither a sample of stage one nor any of 500 draws of the oracle's own."""
    lowest = min(minimum.trace_r for minimum in stage_one.minima)
    assert lowest <= np.min(stage_one.trace_r)
    lower, upper = np.array(list(case.bounds.values())).T
    draws = np.random.default_rng(6).uniform(lower, upper, size=(500, lower.size))
    sampled = [estimate_linear(case.model, case.record, xi2).trace_r for xi2 in draws]
    assert lowest <= min(sampled)


def test_minima_are_stationary(case: Case, stage_one: sepcal.StageOne) -> None:
    """A Newton step from each stays within 1e-5 of the bounds' width; on a bound it points out."""
    lower, upper = np.array(list(case.bounds.values())).T
    width = upper - lower
    assert len(stage_one.minima) > 0
    for minimum in stage_one.minima:
        xi2 = order(case, minimum.xi2)
        at_xi2 = estimate_linear(case.model, case.record, xi2)
        on_lower, on_upper = xi2 <= lower + 1e-9 * width, xi2 >= upper - 1e-9 * width
        assert np.all(at_xi2.gradient[on_lower] > 0)
        assert np.all(at_xi2.gradient[on_upper] < 0)
        free = ~(on_lower | on_upper)
        step = np.linalg.solve(at_xi2.curvature[np.ix_(free, free)], at_xi2.gradient[free])
        assert np.all(np.abs(step) < 1e-5 * width[free])


@pytest.mark.parametrize("name", ["scalar_1", "five_hole", "magnetometer"])
def test_a_single_minimum_is_called_unique(name: str) -> None:
    """Sixty bounded descents from random starts, and a scan of the scalar, find no second one."""
    case = state_case(name)
    stage_one = search(case, case.bounds)
    assert stage_one.unique_minimum
    assert len(stage_one.minima) == 1


def test_every_turn_of_the_phase_is_a_minimum() -> None:
    """Half a turn of b changes the sign of 1 + a alone: within +-4 rad there are three."""
    case = state_case("scalar_1")
    stage_one = search(case, {"b": (-4.0, 4.0)})
    phase = fit_scalar_example_1(case.record)[2]
    assert not stage_one.unique_minimum
    found = sorted(minimum.xi2["b"] for minimum in stage_one.minima)
    assert_allclose(found, phase + np.pi * np.array([-1, 0, 1]), atol=1e-4)
