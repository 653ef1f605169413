# SPDX-License-Identifier: BSD-3-Clause
"""Least squares over samples from Python, recursive and iterated: batches, SciPy, refusals."""

from functools import partial

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.optimize import least_squares

import sepcal
from refusals import refuse


def covariance() -> np.ndarray:
    root = np.random.default_rng(4).standard_normal((3, 4))
    return root @ root.T


def samples() -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    draws = np.random.default_rng(8)
    found = []
    for _ in range(12):
        root = draws.standard_normal((2, 3))
        found.append((draws.standard_normal((2, 3)), draws.standard_normal(2), root @ root.T))
    return found


@pytest.mark.parametrize("form", ["square_root", "information", "covariance"])
def test_the_recursion_is_the_batch(form: str) -> None:
    begin, known = np.array([0.5, -1.0, 2.0]), covariance()
    recursion = sepcal.RecursiveLeastSquares(begin, known, form)
    information, sum_of = np.linalg.inv(known), np.linalg.solve(known, begin)
    for at, y, W in samples():
        recursion.absorb(at, y, W)
        information = information + at.T @ np.linalg.solve(W, at)
        sum_of = sum_of + at.T @ np.linalg.solve(W, y)
    assert_allclose(
        recursion.solution, np.linalg.solve(information, sum_of), rtol=1e-12, atol=1e-14
    )
    assert_allclose(recursion.covariance, np.linalg.inv(information), rtol=1e-11, atol=1e-14)


def test_without_a_start_it_is_ordinary_least_squares() -> None:
    x = np.linspace(0, 1, 9)
    y = 2 - 3 * x + 0.1 * np.random.default_rng(1).standard_normal(9)
    recursion = sepcal.RecursiveLeastSquares(2)
    assert not recursion.determined
    for at, value in zip(x, y, strict=True):
        recursion.absorb([1.0, at], value)
    recursion.absorb([1.0, 0.5], np.nan)  # not measured
    assert recursion.determined
    assert_allclose(recursion.solution[::-1], np.polyfit(x, y, 1), rtol=1e-12)


def test_what_a_recursion_refuses() -> None:
    recursion = sepcal.RecursiveLeastSquares(2)
    refuse(lambda: recursion.absorb([1.0, 2.0, 3.0], 1.0), "H", "(1, 3)", "(1, 2)")
    refuse(lambda: recursion.absorb([1.0, 2.0], 1.0, -1.0), "absorb()", "W is no covariance")
    refuse(lambda: recursion.absorb([1.0, 2.0], 1.0, 0.0), "absorb()", "W is singular")
    refuse(lambda: recursion.absorb([1.0, np.inf], 1.0), "H is not a finite")
    refuse(lambda: recursion.absorb([1.0, 2.0], 1j), "y is complex")
    refuse(lambda: sepcal.RecursiveLeastSquares([5.0, 5.0]), "p has no weight", "covariance")
    refuse(lambda: sepcal.RecursiveLeastSquares(2, form="information"), "'square_root' needs none")
    refuse(lambda: sepcal.RecursiveLeastSquares(2, np.eye(2), "fading"), "'fading'")
    refuse(lambda: sepcal.RecursiveLeastSquares(2, np.zeros((2, 2))), "positive definite")
    assert_array_equal(recursion.solution, 0.0)
    assert np.isnan(recursion.covariance).all()  # all is open
    assert len(sepcal.RecursiveLeastSquares(np.int64(2)).solution) == 2
    refuse(lambda: sepcal.RecursiveLeastSquares(2, -np.eye(2), "covariance"), "covariance", "-1")
    refuse(lambda: sepcal.RecursiveLeastSquares(-1), "p is -1")


# --- iterated


TIMES = np.linspace(0.0, 3.0, 16)
DECAY = 2.0 * np.exp(-0.7 * TIMES) + 0.05 * np.random.default_rng(3).standard_normal(16)
WEIGHTS = np.linspace(0.01, 0.04, 16)


def decay_at(k: int, p: np.ndarray) -> tuple[float, list[float], float]:
    size, rate = p
    fallen = np.exp(-rate * TIMES[k])
    return DECAY[k] - size * fallen, [fallen, -size * TIMES[k] * fallen], WEIGHTS[k]


def test_iterations_find_what_scipy_finds() -> None:
    found = sepcal.iterate_least_squares(decay_at, 16, [1.0, 0.2])
    best = least_squares(
        lambda p: (DECAY - p[0] * np.exp(-p[1] * TIMES)) / np.sqrt(WEIGHTS),
        [1.0, 0.2], xtol=1e-15, ftol=1e-15, gtol=1e-15,
    )  # fmt: skip
    assert found.status == "converged"
    assert_allclose(found.p, best.x, rtol=1e-7)
    assert found.cost == pytest.approx(best.cost, rel=1e-12)
    assert_allclose(found.covariance, np.linalg.inv(best.jac.T @ best.jac), rtol=1e-5)
    information = found.root[:2, :2].T @ found.root[:2, :2]
    assert_allclose(np.linalg.inv(information), found.covariance, rtol=1e-10)
    assert found.count == 16


def test_what_is_missing_is_left_out() -> None:
    def with_gap(k: int, p: np.ndarray) -> tuple[float, list[float], float]:
        z, H, W = decay_at(k, p)
        return (np.nan if k == 4 else z), H, W

    def without(k: int, p: np.ndarray) -> tuple[float, list[float], float]:
        return decay_at(k if k < 4 else k + 1, p)

    found = sepcal.iterate_least_squares(with_gap, 16, [1.0, 0.2])
    assert found.count == 15
    assert_allclose(found.p, sepcal.iterate_least_squares(without, 15, [1.0, 0.2]).p, rtol=1e-9)


def test_an_open_parameter_and_a_cap_are_statuses() -> None:
    both = sepcal.iterate_least_squares(lambda _, p: (1.0 - p[0] - p[1], [1.0, 1.0]), 5, [0.0, 0.0])
    assert both.status == "not_determined"
    assert np.isnan(both.covariance).all()
    capped = sepcal.iterate_least_squares(decay_at, 16, [1.0, 0.2], iterations=1)
    assert capped.status == "not_converged"


def test_what_iterations_refuse() -> None:
    refuse(lambda: sepcal.iterate_least_squares(decay_at, 0, [1.0, 0.2]), "count is 0")
    refuse(lambda: sepcal.iterate_least_squares(decay_at, 1.5, [1.0]), "count is 1.5")  # type: ignore[arg-type]
    for word, given in (("z", (np.inf, [1.0])), ("H", (1.0, [np.nan])), ("W", (1.0, [1.0], 0.0))):
        sample = partial(lambda given, k, p: given, given)
        refuse(lambda sample=sample: sepcal.iterate_least_squares(sample, 3, [1.0]), f"(0): {word}")
    refuse(lambda: sepcal.iterate_least_squares(decay_at, 9, [1.0, 1.0], halvings=-1), "halvings")
    refuse(
        lambda: sepcal.iterate_least_squares(decay_at, 16, [1.0, 0.2], tolerance=np.nan),
        "tolerance is nan",
    )
    refuse(lambda: sepcal.iterate_least_squares(lambda k, p: (1.0,), 3, [1.0]), "1 parts")
    refuse(
        lambda: sepcal.iterate_least_squares(lambda k, p: (1.0, [1.0, 2.0]), 3, [1.0]),
        "H",
        "(1, 1)",
    )
    refuse(lambda: sepcal.iterate_least_squares(lambda k, p: (1.0, [1.0], -1.0), 3, [1.0]), "W")
    with pytest.raises(KeyError):
        sepcal.iterate_least_squares(lambda k, p: {}[k], 3, [1.0])
