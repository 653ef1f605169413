# SPDX-License-Identifier: BSD-3-Clause
"""Filters and recursive least squares from Python: textbook formulas, batches, refusals."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.stats import multivariate_normal

import sepcal
from refusals import refuse

FORMS = ["square_root", "joseph"]
rng = np.random.default_rng(4)
PHI, GAMMA = rng.standard_normal((3, 3)), rng.standard_normal((3, 2))
H = rng.standard_normal((2, 3))


def covariance(n: int) -> np.ndarray:
    root = rng.standard_normal((n, n + 1))
    return root @ root.T


P, Q, R = covariance(3), covariance(2), covariance(2)


@pytest.mark.parametrize("form", FORMS)
def test_one_cycle_is_the_textbooks(form: str) -> None:
    x, y, shift = np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.7]), np.array([0.1, 0.0, -0.2])
    filter = sepcal.Filter(x, P, form)
    innovation = filter.update(y, H, R)
    S = H @ P @ H.T + R
    K = P @ H.T @ np.linalg.inv(S)
    assert_allclose(innovation.e, y - H @ x, rtol=1e-12)
    assert_allclose(innovation.covariance, S, rtol=1e-12)
    assert_allclose(innovation.w @ innovation.w, innovation.e @ np.linalg.solve(S, innovation.e))
    assert filter.log_likelihood == pytest.approx(multivariate_normal(H @ x, S).logpdf(y))
    after, P_after = x + K @ (y - H @ x), (np.eye(3) - K @ H) @ P
    assert_allclose(filter.x, after, rtol=1e-11)
    assert_allclose(filter.covariance, P_after, rtol=1e-10)
    filter.predict(PHI, Q, Gamma=GAMMA, shift=shift)
    assert_allclose(filter.x, PHI @ after + shift, rtol=1e-11)
    assert_allclose(filter.covariance, PHI @ P_after @ PHI.T + GAMMA @ Q @ GAMMA.T, rtol=1e-10)


@pytest.mark.parametrize("form", FORMS)
def test_a_missing_output_is_left_out(form: str) -> None:
    one, other = sepcal.Filter(np.zeros(3), P, form), sepcal.Filter(np.zeros(3), P, form)
    innovation = one.update([np.nan, 0.7], H, R)
    other.update([0.7], H[1:], R[1:, 1:])
    assert innovation.count == 1
    assert_allclose(one.x, other.x, rtol=1e-12)
    assert_allclose(one.covariance, other.covariance, rtol=1e-12)
    assert one.log_likelihood == pytest.approx(other.log_likelihood)


def test_a_nonlinear_system_says_what_it_expects() -> None:
    filter = sepcal.Filter([0.5], [[0.1]])
    filter.update([0.5], [[np.cos(0.5)]], [[0.01]], expected=[np.sin(0.5)])
    S = 0.1 * np.cos(0.5) ** 2 + 0.01
    assert filter.x == pytest.approx(0.5 + 0.1 * np.cos(0.5) / S * (0.5 - np.sin(0.5)))
    filter.predict([[2.0]], [[0.0]], x=[7.0])
    assert filter.x == 7.0


@pytest.mark.parametrize("form", FORMS)
def test_what_is_refused_changes_nothing(form: str) -> None:
    filter = sepcal.Filter(np.zeros(3), P, form)
    refuse(lambda: filter.update([np.inf, 0.0], H, R), "update()", "nothing was changed")
    refuse(lambda: filter.update([0.0, 0.0], H, -100 * R), "update()", "not positive")
    refuse(lambda: filter.predict(np.full((3, 3), np.nan), np.eye(3)), "predict()", "not finite")
    assert_array_equal(filter.x, 0.0)
    assert_allclose(filter.covariance, P, rtol=1e-14)
    assert filter.log_likelihood == 0.0


def test_shapes_are_told() -> None:
    filter = sepcal.Filter(np.zeros(3), P)
    refuse(lambda: sepcal.Filter(np.zeros(2), P), "P has the shape (3, 3)", "(2, 2)")
    refuse(lambda: sepcal.Filter(np.zeros(3), P, "ud"), "'ud'", "'square_root'", "'joseph'")
    refuse(lambda: filter.predict(np.eye(2), np.eye(3)), "Phi", "(2, 2)", "3 states")
    refuse(lambda: filter.predict(np.eye(3), np.eye(2)), "Q", "(2, 2)", "(3, 3)")
    refuse(lambda: filter.predict(np.eye(3), [1.0]), "Q", "(1,)", "matrix")
    refuse(lambda: filter.update([1.0], H, R), "H", "(2, 3)", "(1, 3)")
    refuse(lambda: filter.update([1.0, 2.0], H, R, expected=[1.0]), "expected", "1 entries", "2")
    refuse(lambda: filter.update([[1.0]], H, R), "y", "vector")


# --- recursive least squares


def samples() -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    draws = np.random.default_rng(8)
    found = []
    for _ in range(12):
        root = draws.standard_normal((2, 3))
        found.append((draws.standard_normal((2, 3)), draws.standard_normal(2), root @ root.T))
    return found


@pytest.mark.parametrize("form", ["square_root", "information", "covariance"])
def test_the_recursion_is_the_batch(form: str) -> None:
    begin, known = np.array([0.5, -1.0, 2.0]), covariance(3)
    recursion = sepcal.RecursiveLeastSquares(begin, known, form)
    information, sum_of = np.linalg.inv(known), np.linalg.solve(known, begin)
    for at, y, W in samples():
        recursion.absorb(at, y, W)
        information = information + at.T @ np.linalg.solve(W, at)
        sum_of = sum_of + at.T @ np.linalg.solve(W, y)
    assert_allclose(recursion.solution, np.linalg.solve(information, sum_of), rtol=1e-12)
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


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: sepcal.Filter([0, 0], -np.eye(2), "joseph"), ("P", "eigenvalue -1")),
        (lambda: sepcal.Filter([0, 0], [[1, 2], [2, 1]]), ("P", "eigenvalue -1")),
        (lambda: sepcal.Filter([0, 0], [[1, 2], [0, 1]]), ("P", "symmetric")),
        (lambda: sepcal.Filter([0, np.nan], np.eye(2)), ("x", "not a finite number")),
        (lambda: sepcal.RecursiveLeastSquares(2, -np.eye(2), "covariance"), ("covariance",)),
        (lambda: sepcal.RecursiveLeastSquares(-1), ("p is -1",)),
    ],
)
def test_what_is_no_covariance_is_no_start(
    make: Callable[[], object], words: tuple[str, ...]
) -> None:
    refuse(make, *words)


def test_what_a_recursion_refuses() -> None:
    recursion = sepcal.RecursiveLeastSquares(2)
    refuse(lambda: recursion.absorb([1.0, 2.0, 3.0], 1.0), "H", "(1, 3)", "(1, 2)")
    refuse(lambda: recursion.absorb([1.0, 2.0], 1.0, -1.0), "absorb()", "not positive")
    refuse(lambda: sepcal.RecursiveLeastSquares(2, form="information"), "'square_root' needs none")
    refuse(lambda: sepcal.RecursiveLeastSquares(2, np.eye(2), "fading"), "'fading'")
    refuse(lambda: sepcal.RecursiveLeastSquares(2, np.zeros((2, 2))), "positive definite")
    assert_array_equal(recursion.solution, 0.0)
