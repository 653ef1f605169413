# SPDX-License-Identifier: BSD-3-Clause
"""The two-step estimator of Haupt and Kasdin (Eqs. 28 to 32), and the states y = f(xi) it works on.

Step one is linear in y: z = H y + v. Step two takes its y as measurements of f(xi). The row that
Eq. 28 prints lacks the 1 of the state c.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from oracle.magnetometer import soft_iron
from oracle.model import Array

TIGHTEST = {"ftol": 1e-15, "xtol": 1e-15, "gtol": 1e-15}


@dataclass(frozen=True)
class FirstStep:
    """Linear least squares of the states."""

    y: Array  # of least norm where H is singular, (p,)
    information: Array  # H' H / sigma^2, (p, p); singular where H is
    sigma: float  # of the noise of z: as given, or the root of SSE / M
    rank: int  # of H


@dataclass(frozen=True)
class SecondStep:
    """The minimum of Eq. 32."""

    xi: Array  # (n,)
    cost: float  # (y - f)' information (y - f)
    covariance: Array  # inv(F' information F), F = df / dxi; NaN where that is singular; (n, n)
    converged: bool


def first_step(H: Array, z: Array, sigma: float | None = None) -> FirstStep:
    """Fits z (M,) by H (M, p); the noise is estimated where sigma is None."""
    y, _, rank, _ = np.linalg.lstsq(H, z, rcond=None)
    if sigma is None:
        sigma = float(np.sqrt(np.mean((z - H @ y) ** 2)))
    return FirstStep(y, H.T @ H / sigma**2, sigma, int(rank))


def second_step(
    first: FirstStep,
    f: Callable[[Array], Array],
    start: Array,
    lower: ArrayLike = -np.inf,
    upper: ArrayLike = np.inf,
) -> SecondStep:
    """Minimises Eq. 32 from start (n,) within the bounds, by differences in three points."""
    root = _root_of(first.information)
    found = least_squares(
        lambda xi: root @ (first.y - f(xi)),
        start,
        jac="3-point",
        bounds=(lower, upper),
        x_scale="jac",
        max_nfev=2000,
        **TIGHTEST,
    )
    covariance = _invert_gram(found.jac)
    return SecondStep(found.x, float(2 * found.cost), covariance, bool(found.success))


def example_states(xi: Array) -> Array:
    """Eq. 28: (a cos b, a sin b, cos b, sin b, c) of xi = (a, c, b)."""
    a, c, b = xi
    return np.array([a * np.cos(b), a * np.sin(b), np.cos(b), np.sin(b), c])


def example_rows(eta: Array) -> Array:
    """H for eta (N,) [rad], shape (N, 5): columns 3 and 4 repeat 1 and 2, so its rank is 3."""
    cosine, sine = np.cos(eta), np.sin(eta)
    return np.stack([cosine, -sine, cosine, -sine, np.ones_like(eta)], axis=-1)


def reduced_states(xi: Array) -> Array:
    """((1 + a) cos b, (1 + a) sin b, c) of xi = (a, c, b): as many states as parameters."""
    a, c, b = xi
    return np.array([(1 + a) * np.cos(b), (1 + a) * np.sin(b), c])


def reduced_rows(eta: Array) -> Array:
    """H for eta (N,) [rad], shape (N, 3)."""
    return np.stack([np.cos(eta), -np.sin(eta), np.ones_like(eta)], axis=-1)


def quadric_states(xi: Array, field_strength: float) -> Array:
    """The nine ratios of the ellipsoid (m - n)' Q (m - n) = F^2, over Q_xx; Q = inv(C C').

    xi = (lambda_x..z, alpha_xy, alpha_xz, alpha_yz, n_x..z), C = C_alpha (I + diag(lambda)).
    y = (Q_yy, Q_zz, Q_xy, Q_xz, Q_yz, Q n, n' Q n - F^2) / Q_xx; n and F in uT.
    """
    matrix = soft_iron(xi[3:6]) @ np.diag(1 + xi[:3])
    inverse = np.linalg.inv(matrix)
    Q = inverse.T @ inverse
    n = xi[6:]
    shape = [Q[1, 1], Q[2, 2], Q[0, 1], Q[0, 2], Q[1, 2]]
    return np.array([*shape, *(Q @ n), n @ Q @ n - field_strength**2]) / float(Q[0, 0])


def quadric_rows(m: Array) -> tuple[Array, Array]:
    """H (N, 9) and z = -m_x^2 (N,) of readings m (N, 3) [uT]."""
    x, y, z = m.T
    squares = [y**2, z**2, 2 * x * y, 2 * x * z, 2 * y * z]
    return np.stack([*squares, -2 * x, -2 * y, -2 * z, np.ones_like(x)], axis=-1), -(x**2)


def _root_of(information: Array) -> Array:
    """A matrix whose Gram matrix it is; eigenvalues that are rounding count as zero."""
    values, vectors = np.linalg.eigh(information)
    rounding = values.size * np.finfo(float).eps * values[-1]
    root = np.sqrt(np.where(values > rounding, values, 0.0))
    return np.asarray(root[:, np.newaxis] * vectors.T)


def _invert_gram(jacobian: Array) -> Array:
    """inv(J' J) by J's singular values with its columns scaled to one; NaN where it is singular."""
    scale = np.linalg.norm(jacobian, axis=0)
    if not np.all(scale > 0):
        return np.full((scale.size, scale.size), np.nan)
    _, values, vectors = np.linalg.svd(jacobian / scale, full_matrices=False)
    if values.size < scale.size or values[-1] < 1e-10 * values[0]:
        return np.full((scale.size, scale.size), np.nan)
    inverse = vectors.T / values / scale[:, np.newaxis]
    return np.asarray(inverse @ inverse.T)
