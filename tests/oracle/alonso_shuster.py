# SPDX-License-Identifier: BSD-3-Clause
"""TWOSTEP of Alonso and Shuster (J. Astronautical Sciences 50(4), 2002, 433-451 and 477-490).

A reading B = C h + n with C = inv(I + D), and only |h| known: with I + E = (I + D)^2, c = (I + D) b
    z = |B|^2 - |h|^2 = L theta - |b|^2 + v,   theta = (c, E_xx, E_yy, E_zz, E_xy, E_xz, E_yz),
    L = 2 B', -(B_x^2, B_y^2, B_z^2, 2 B_x B_y, 2 B_x B_z, 2 B_y B_z),   |b|^2 = c' inv(I + E) c.
The noise of v has the mean mu = -tr Sigma in both papers, and the variance
sigma_k^2 = 4 |(I + D) B - b|^2_Sigma + 2 tr Sigma^2. Both hold for an error that is independent of
B; given the true field instead, the mean of z - L theta + |b|^2 is +tr Sigma: mean_sign = 1.
Sigma is that of the error of (I + D) B - b; here it is sigma^2 I.

Where |h| is the same in each row, step one of the complete version says nothing: E = -I and c = 0
make L theta = |B|^2, so that they fit what is centred exactly. Step two then starts at theta = 0,
and the weights stay those of theta = 0 unless reweight_at is "theta".
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from oracle.model import Array

PAIRS = ((0, 1), (0, 2), (1, 2))  # of E_xy, E_xz, E_yz


@dataclass(frozen=True)
class TwoStep:
    """Both estimates. In the bias-only version theta is the bias itself."""

    centred: Array  # theta of step one, (9,) or (3,)
    theta: Array  # theta of step two, the same shape
    bias: Array  # n [uT], (3,)
    shape: Array  # C C' = inv(I + E), (3, 3)
    covariance: Array  # of theta: the inverse of the Fisher matrix, centre included
    cost: float  # half the sum of ((z - L theta + |b|^2 - mu) / sigma_k)^2
    iterations: int  # Gauss-Newton steps taken
    converged: bool  # the last step was nothing, and theta is usable


def alonso_shuster(
    readings: Array,
    strengths: Array | float,
    sigma: float,
    *,
    bias_only: bool = False,
    reweight: int = 1,
    reweight_at: Literal["centred", "theta"] = "centred",
    iterations: int = 100,
    mean_sign: float = -1.0,
) -> TwoStep:
    """Calibrates readings (N, 3) in fields of the strengths (N,) or one, all in uT.

    The weights 1 / sigma_k^2 are those of theta = 0. `reweight` times they are computed again, at
    the last centred estimate or the last theta, and both steps are redone with them; they stay as
    they are where that one is not usable. The steps of Gauss and Newton hold them.
    """
    rows = build_rows(readings, bias_only)
    z = np.sum(readings**2, axis=1) - np.broadcast_to(strengths, readings.shape[:1]) ** 2
    z = z - mean_sign * 3 * sigma**2
    found = _fit(rows, z, weights_at(readings, np.zeros(rows.shape[1]), sigma), iterations)
    for _ in range(reweight):
        at = found.centred if reweight_at == "centred" else found.theta
        if not is_usable(at):
            break
        found = _fit(rows, z, weights_at(readings, at, sigma), iterations)
    return found


def build_rows(readings: Array, bias_only: bool) -> Array:
    """L, shape (N, 9), or (N, 3) without the columns of E."""
    if bias_only:
        return 2 * readings
    products = [2 * readings[:, i] * readings[:, j] for i, j in PAIRS]
    return np.column_stack([2 * readings, -(readings**2), *[-product for product in products]])


def weights_at(readings: Array, theta: Array, sigma: float) -> Array:
    """1 / sigma_k^2 [uT^-4], shape (N,): |(I + D) B - b| = |C^-1 (B - n)| by Q = I + E alone."""
    bias, shape = bias_and_shape(theta)
    deviation = readings - bias
    square = np.sum(deviation * np.linalg.solve(shape, deviation.T).T, axis=1)
    return np.asarray(1 / (4 * sigma**2 * square + 6 * sigma**4))


def bias_and_shape(theta: Array) -> tuple[Array, Array]:
    """The bias inv(I + E) c and the shape inv(I + E); for a theta of three, theta and I."""
    if theta.size == 3:
        return theta, np.eye(3)
    shape = np.linalg.inv(_square_of(theta))
    return shape @ theta[:3], shape


def is_usable(theta: Array) -> bool:
    """Whether I + E is positive definite, and no gain of C above ten."""
    return theta.size == 3 or bool(np.linalg.eigvalsh(_square_of(theta))[0] > 0.01)


def _square_of(theta: Array) -> Array:
    """I + E = (I + D)^2, shape (3, 3)."""
    xx, yy, zz, xy, xz, yz = theta[3:]
    return np.asarray(np.eye(3) + np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))


def square_and_slope(theta: Array) -> tuple[float, Array]:
    """|b|^2 = c' inv(I + E) c and its slope by theta: 2 n by c, -n n' by E."""
    bias, _ = bias_and_shape(theta)
    if theta.size == 3:
        return float(bias @ bias), 2 * bias
    products = [2 * bias[i] * bias[j] for i, j in PAIRS]
    return float(bias @ theta[:3]), np.concatenate([2 * bias, -(bias**2), -np.array(products)])


class _Centred:
    """z and L less their weighted means, and those means: the centre."""

    def __init__(self, rows: Array, z: Array, weights: Array) -> None:
        self._root = np.sqrt(np.sum(weights))  # 1 / sigma bar
        share = weights / np.sum(weights)
        self._row, self._z = share @ rows, share @ z
        whitening = np.sqrt(weights)
        self._rows = (rows - self._row) * whitening[:, np.newaxis]
        self._zs = (z - self._z) * whitening
        self.estimate: Array = np.linalg.lstsq(self._rows, self._zs, rcond=None)[0]

    def linearise(self, theta: Array) -> tuple[Array, Array]:
        """The whitened L and the misfit at theta, the centre as one more row (N + 1)."""
        square, slope = square_and_slope(theta)
        centre = self._root * (self._row - slope)
        misfit = self._root * (self._z - self._row @ theta + square)
        whole = np.append(self._zs - self._rows @ theta, misfit)
        return np.vstack([self._rows, centre]), whole


def _fit(rows: Array, z: Array, weights: Array, iterations: int) -> TwoStep:
    """Both steps at fixed weights (N,); z is less mu."""
    centred = _Centred(rows, z, weights)
    start = centred.estimate if is_usable(centred.estimate) else np.zeros(rows.shape[1])
    theta, taken, settled = _descend(centred, start, iterations)
    bias, shape = bias_and_shape(theta)
    covariance = _invert_gram(centred.linearise(theta)[0])
    cost = float(0.5 * weights @ (z - rows @ theta + square_and_slope(theta)[0]) ** 2)
    converged = settled and is_usable(theta)
    return TwoStep(centred.estimate, theta, bias, shape, covariance, cost, taken, converged)


def _descend(centred: _Centred, start: Array, iterations: int) -> tuple[Array, int, bool]:
    """By Gauss and Newton: theta, the steps taken, whether they settled."""
    theta = start
    for taken in range(1, iterations + 1):
        tangent, misfit = centred.linearise(theta)
        step = np.linalg.lstsq(tangent, misfit, rcond=None)[0]
        theta = theta + step
        errors = np.sqrt(np.diag(_invert_gram(tangent)))
        if np.all(np.abs(step) < 1e-10 * errors + 1e-14 * np.abs(theta)):
            return theta, taken, True
    return theta, iterations, False


def _invert_gram(tangent: Array) -> Array:
    """inv(A' A), without forming A' A."""
    inverse = np.linalg.inv(np.linalg.qr(tangent, mode="r"))
    return np.asarray(inverse @ inverse.T)
