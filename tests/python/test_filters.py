# SPDX-License-Identifier: BSD-3-Clause
"""Filters and smoothers from Python: textbook formulas, batches, refusals."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.linalg import block_diag
from scipy.optimize import least_squares
from scipy.stats import multivariate_normal

import sepcal
from refusals import refuse

FORMS = ["square_root", "joseph", "information"]
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

    def outputs(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return H @ x, H

    y, here = [0.0, 0.0], "nothing was changed"
    refuse(lambda: filter.update([np.inf, 0.0], H, R), "update()", "y is not", here)
    refuse(lambda: filter.update(y, H, -100 * R), "update()", "R is no covariance", "below 0", here)
    refuse(lambda: filter.update(y, [[1, np.nan, 0], [0, 0, 1]], R), "H is not a finite", here)
    refuse(lambda: filter.iterated_update(y, outputs, -100 * R), "R is no covariance", here)
    refuse(lambda: filter.iterated_update(y, outputs, R, tolerance=np.nan), "tolerance", "nan")
    refuse(lambda: filter.iterated_update(y, outputs, R, iterations=0), "iterations", "above 0")
    refuse(lambda: filter.predict(np.full((3, 3), np.nan), np.eye(3)), "Phi is not a finite", here)
    refuse(lambda: filter.predict(np.eye(3), -100 * np.eye(3)), "Q is no covariance", here)
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
    refuse(lambda: filter.update(5.0, H, R), "y", "()", "vector")
    refuse(lambda: filter.predict(np.eye(3), np.eye(3), shift=[5.0]), "shift has 1", "3")
    refuse(lambda: filter.predict(np.eye(3), np.eye(3), shift=[0] * 3, x=[0] * 3), "x", "shift")
    refuse(lambda: filter.iterated_update([0, 0], lambda x: (0.0, H), R), "expected", "()")
    nowhere = (np.full(2, np.nan), H)
    refuse(lambda: filter.iterated_update([0, 0], lambda x: nowhere, R), "expected is not a finite")
    refuse(lambda: filter.predict(np.eye(3), np.eye(3), shift=[np.nan, 0, 0]), "shift is not a")
    refuse(lambda: filter.predict(1e308 * np.eye(3), np.eye(3), shift=[0] * 3), "range of numbers")
    refuse(lambda: sepcal.Filter(np.zeros(3), P, None), "form is None")  # type: ignore[arg-type]


def test_what_is_no_array_of_real_numbers_is_told() -> None:
    filter = sepcal.Filter(np.zeros(3), P)
    upper = np.array([[0.5, 0.2], [0.0, 0.1]])  # half of a covariance, or a root
    refuse(lambda: filter.update([0, 0], H, upper), "R is no covariance", "symmetric")
    refuse(lambda: filter.predict(np.eye(3), np.triu(P + 1.0)), "Q is no covariance", "symmetric")
    refuse(lambda: filter.update([1j, 0], H, R), "y is complex")
    refuse(lambda: filter.update(["high", 0], H, R), "y", "numbers")
    refuse(lambda: filter.update([0, 0], [[1, 0], [1]], R), "H", "numbers")


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("unknown", [np.nan, np.inf])
def test_noise_of_what_is_missing_may_be_unknown(form: str, unknown: float) -> None:
    """A log that carries accuracies has none where it has no reading."""
    filter, known = sepcal.Filter(np.zeros(3), P, form), sepcal.Filter(np.zeros(3), P, form)
    noise = R.copy()
    noise[0, :] = noise[:, 0] = unknown
    filter.update([np.nan, 1.0], H, noise)
    known.update([np.nan, 1.0], H, R)
    assert_array_equal(filter.x, known.x)
    assert_array_equal(filter.covariance, known.covariance)


def test_what_rounding_has_made_negative_is_a_covariance() -> None:
    wide = np.random.default_rng(138).standard_normal((6, 3))
    low = wide @ wide.T  # its lowest eigenvalue is -6e-16
    assert np.linalg.eigvalsh(low)[0] < 0.0
    filter = sepcal.Filter(np.zeros(6), low)
    filter.predict(np.eye(6), low)
    assert_allclose(filter.covariance, 2 * low, atol=1e-12)
    filter.update(np.zeros(6), np.eye(6), low)
    assert_allclose(filter.covariance, 2 / 3 * low, atol=1e-7)


def test_what_is_masked_is_missing() -> None:
    masked, missing = sepcal.Filter(np.zeros(3), P), sepcal.Filter(np.zeros(3), P)
    masked.update(np.ma.masked_array([7.0, 1.0], [True, False]), H, R)
    missing.update([np.nan, 1.0], H, R)
    assert_array_equal(masked.x, missing.x)


def test_what_singular_matrices_do_is_told() -> None:
    twice, nothing = [[1.0, 0.0, 0.0]] * 2, np.zeros((2, 2))
    refuse(lambda: sepcal.Filter(np.zeros(3), P).update([0, 0], twice, nothing), "R above 0")
    information = sepcal.Filter(np.zeros(3), P, "information")
    refuse(lambda: information.update([0, 0], H, nothing), "R is singular", "'square_root'")
    refuse(lambda: information.predict(np.zeros((3, 3)), P), "Phi is singular", "'square_root'")


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: sepcal.Filter([0, 0], -np.eye(2), "joseph"), ("P", "eigenvalue -1")),
        (lambda: sepcal.Filter([0, 0], [[1, 2], [2, 1]]), ("P", "eigenvalue -1")),
        (lambda: sepcal.Filter([0, 0], [[1, 2], [0, 1]]), ("P", "symmetric")),
        (lambda: sepcal.Filter([0, np.nan], np.eye(2)), ("x", "not a finite number")),
        (lambda: sepcal.Filter([0, 0]), ("P", "information_root", "one of them")),
        (lambda: sepcal.Filter([0, 0], np.zeros((2, 2)), "information"), ("P is singular",)),
        (lambda: sepcal.Filter([0], information_root=[[1]]), ('form="information"',)),
        (
            lambda: sepcal.Filter([0, 0], form="information", information_root=[[1, 0], [1, 1]]),
            ("upper triangular",),
        ),
    ],
)
def test_what_is_no_covariance_is_no_start(
    make: Callable[[], object], words: tuple[str, ...]
) -> None:
    refuse(make, *words)


# --- information, iterations, smoothing


def test_a_batchs_factor_goes_on_as_information() -> None:
    rows = rng.standard_normal((9, 3))
    R_batch = np.linalg.qr(rows, mode="r")
    filter = sepcal.Filter(np.ones(3), form="information", information_root=R_batch)
    assert_allclose(filter.covariance, np.linalg.inv(rows.T @ rows), rtol=1e-10)
    filter.update([0.3, 0.7], H, R)
    information = rows.T @ rows + H.T @ np.linalg.solve(R, H)
    root = filter.information_root
    assert_allclose(root.T @ root, information, rtol=1e-10)
    assert_array_equal(np.tril(root, -1), 0.0)
    refuse(lambda: sepcal.Filter([0.0], [[1.0]]).information_root, 'form="information"')


@pytest.mark.parametrize("form", FORMS)
def test_iterations_end_at_the_most_probable_state(form: str) -> None:
    """Two ranges of a point in the plane; SciPy minimises the same sum of squares."""
    beacons, prior, spread = (
        np.array([[0.0, 0.0], [4.0, 0.0]]),
        np.array([1.0, 1.0]),
        2.0 * np.eye(2),
    )
    noise, y = np.diag([0.04, 0.01]), np.array([3.0, 2.5])

    def ranges(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        away = x - beacons
        distances = np.hypot(*away.T)
        return distances, away / distances[:, None]

    filter = sepcal.Filter(prior, spread, form)
    found = filter.iterated_update(y, ranges, noise)
    best = least_squares(
        lambda x: np.r_[(y - ranges(x)[0]) / np.sqrt(np.diag(noise)), (x - prior) / np.sqrt(2.0)],
        prior, xtol=1e-15, ftol=1e-15, gtol=1e-15,
    )  # fmt: skip
    assert_allclose(filter.x, best.x, rtol=1e-7)
    assert_allclose(filter.covariance, np.linalg.inv(best.jac.T @ best.jac), rtol=1e-5)
    assert found.count == 2
    refuse(lambda: filter.iterated_update(y, lambda x: (y, [[1.0]]), noise), "H", "(2, 2)")
    again = sepcal.Filter(prior, spread, form)
    refuse(lambda: again.iterated_update(y, ranges, noise, iterations=1), "1 iterations", "prior")
    with pytest.raises(ZeroDivisionError):
        again.iterated_update(y, lambda _: 1 / 0, noise)


@pytest.mark.parametrize("form", FORMS)
def test_a_pass_is_smoothed_as_the_batch_of_all_samples(form: str) -> None:
    """Of all states and noises at once: a least-squares problem of dense matrices."""
    samples, n, n_w = 6, 3, 2
    y = rng.standard_normal((samples, 2))
    filter = sepcal.Filter(np.zeros(n), P, form, keep_pass=True)
    for k in range(samples):
        filter.update(y[k], H, R)
        if k < samples - 1:
            filter.predict(PHI, Q, Gamma=GAMMA)
    # x(k) of the unknowns x(0), w(0), ..., w(N - 2).
    unknowns = n + n_w * (samples - 1)
    state = [np.eye(n, unknowns)]
    for k in range(samples - 1):
        noise = np.zeros((n, unknowns))
        noise[:, n + n_w * k : n + n_w * (k + 1)] = GAMMA
        state.append(PHI @ state[-1] + noise)
    information = np.linalg.inv(block_diag(P, *[Q] * (samples - 1)))
    slope = np.zeros(unknowns)
    for k in range(samples):
        seen = H @ state[k]
        information += seen.T @ np.linalg.solve(R, seen)
        slope += seen.T @ np.linalg.solve(R, y[k])
    every = np.linalg.inv(information)
    best = every @ slope

    smoothed = filter.smooth()
    assert_allclose(smoothed.x, [rows @ best for rows in state], rtol=1e-7, atol=1e-9)
    assert_allclose(
        smoothed.covariance, [rows @ every @ rows.T for rows in state], rtol=1e-6, atol=1e-9
    )
    assert_allclose(smoothed.noise, best[n:].reshape((-1, n_w)), rtol=1e-7, atol=1e-9)
    for k in range(samples - 1):
        part = slice(n + n_w * k, n + n_w * (k + 1))
        assert_allclose(smoothed.noise_covariance[k], every[part, part], rtol=1e-6, atol=1e-9)
    assert_allclose(smoothed.x[-1], filter.x, rtol=1e-12)


def test_only_a_pass_that_was_kept_is_smoothed() -> None:
    filter = sepcal.Filter([0.0], [[1.0]])
    refuse(filter.smooth, "keep_pass=True")
    kept = sepcal.Filter([0.0], [[1.0]], keep_pass=True)
    assert kept.smooth().noise.shape == (0, 0)
    kept.predict([[1.0]], [[1.0]])
    kept.predict([[1.0]], np.eye(2), Gamma=[[1.0, 2.0]])
    refuse(kept.smooth, "noises of different number")
