# SPDX-License-Identifier: BSD-3-Clause
"""All parameters at once by SciPy, at a fixed diagonal R or in turn with it (Eqs. 5 and 6).

SciPy stops where the cost no longer falls, that is about sqrt(eps) short of the minimum; plain
Gauss-Newton steps by QR then close the gap, down to the rounding of the residuals.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import qr, solve_triangular
from scipy.optimize import least_squares

from oracle.model import Array, Model, Record

TIGHTEST = {"ftol": 1e-15, "xtol": 1e-15, "gtol": 1e-15}


@dataclass(frozen=True)
class Estimate:
    """The minimum of Eq. 6 at a fixed R."""

    values: Array  # xi, shape (n,)
    covariance: Array  # inv(J' R^-1 J), unscaled, shape (n, n)
    noise: Array  # square root of R's diagonal, shape (n_z,)
    residual: Array  # z - f(u, xi), shape (n_z, N)

    @property
    def standard_errors(self) -> Array:
        """Shape (n,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def rmse(self) -> Array:
        """Root mean square of each output's residual, shape (n_z,)."""
        return np.sqrt(np.mean(self.residual**2, axis=1))

    @property
    def cost(self) -> float:
        """J of Eq. 6."""
        rows = self.residual.shape[1]
        whitened = self.residual / self.noise[:, np.newaxis]
        return float(0.5 * np.sum(whitened**2) + rows * np.sum(np.log(self.noise)))


def fit_at_fixed_noise(
    model: Model, record: Record, noise: ArrayLike, start: ArrayLike, method: str = "trf"
) -> Estimate:
    """Minimises Eq. 6 over xi with R = diag(noise^2); noise (n_z,), start (n,).

    Raises RuntimeError where SciPy gives up, or where the Gauss-Newton steps do not settle below
    1e-11 standard errors (plus the rounding of the values).
    """
    deviation = np.asarray(noise, dtype=float)
    residual, jacobian = _whiten(model, record, deviation)
    found = least_squares(
        residual, np.asarray(start, dtype=float), jac=jacobian, method=method, **TIGHTEST
    )
    if not found.success:
        raise RuntimeError(f"least_squares({method}) did not converge: {found.message}")

    xi = found.x
    for _ in range(50):
        q, r = qr(jacobian(xi), mode="economic")
        step = solve_triangular(r, -q.T @ residual(xi))
        xi = xi + step
        covariance = _invert_gram(r)
        if np.all(np.abs(step) < 1e-11 * np.sqrt(np.diag(covariance)) + 1e-15 * np.abs(xi)):
            break
    else:
        raise RuntimeError(f"Gauss-Newton steps did not settle; the last one is {step}")
    return Estimate(xi, covariance, deviation, model.measured(record) - model.predict(record, xi))


def fit_with_noise(model: Model, record: Record, start: ArrayLike) -> Estimate:
    """The same with R = SSE_j / N, fitted in turn with xi until R changes by less than 1e-13.

    Raises RuntimeError where a hundred turns do not settle it.
    """
    noise = np.ones(len(model.outputs))
    values = np.asarray(start, dtype=float)
    for _ in range(100):
        estimate = fit_at_fixed_noise(model, record, noise, values)
        if np.allclose(estimate.rmse**2, noise**2, rtol=1e-13, atol=0.0):
            return estimate
        noise, values = estimate.rmse, estimate.values
    raise RuntimeError(f"R did not settle; the last noise is {noise}")


@dataclass(frozen=True)
class RobustEstimate:
    """The minimum of sum rho(s) at a fixed R, s the whitened residual."""

    values: Array  # (n,)
    covariance: Array  # the sandwich, times M / (M - n), (n, n)
    cost: float  # half the sum of rho, and N ln |R| / 2


def fit_with_loss(
    model: Model, record: Record, noise: ArrayLike, start: ArrayLike, loss: str, width: float
) -> RobustEstimate:
    """Minimises sum rho(s) by SciPy's trf, then by Newton's method, rho in SciPy's own form.

    Raises RuntimeError where Newton's steps do not settle below 1e-10 standard errors.
    """
    deviation = np.asarray(noise, dtype=float)
    residual, jacobian = _whiten(model, record, deviation)
    found = least_squares(
        residual, np.asarray(start, float), jac=jacobian, loss=loss, f_scale=width, **TIGHTEST
    )
    xi = found.x
    for _ in range(100):
        s, J = residual(xi), jacobian(xi)
        psi, slope = _influence(s, loss, width)
        gradient = J.T @ psi
        bread = np.linalg.inv(J.T @ (slope[:, np.newaxis] * J))
        step = -bread @ gradient
        xi = xi + step
        covariance = bread @ (J.T @ (psi[:, np.newaxis] ** 2 * J)) @ bread
        if np.all(np.abs(step) < 1e-10 * np.sqrt(np.diag(covariance))):
            break
    else:
        raise RuntimeError(f"Newton's steps did not settle; the last one is {step}")
    cost = least_squares(residual, xi, jac=jacobian, loss=loss, f_scale=width, max_nfev=1).cost
    logarithms = float(s.size / deviation.size * np.sum(np.log(deviation)))
    freedom = s.size / (s.size - xi.size)
    return RobustEstimate(xi, covariance * freedom, cost + logarithms)


def _whiten(
    model: Model, record: Record, noise: Array
) -> tuple[Callable[[Array], Array], Callable[[Array], Array]]:
    """The residual over noise (n_z,), output by output in one row, and its Jacobian."""
    deviation = noise[:, np.newaxis]
    measured = model.measured(record)

    def residual(xi: Array) -> Array:
        return ((measured - model.predict(record, xi)) / deviation).ravel()

    def jacobian(xi: Array) -> Array:
        return -(model.jacobian(record, xi) / deviation[..., np.newaxis]).reshape(-1, xi.size)

    return residual, jacobian


def _influence(s: Array, loss: str, width: float) -> tuple[Array, Array]:
    """Psi = d rho / ds / 2 and its slope."""
    if loss == "huber":
        return np.clip(s, -width, width), (np.abs(s) <= width).astype(float)
    u = (s / width) ** 2
    return s / (1 + u), (1 - u) / (1 + u) ** 2


def _invert_gram(r: Array) -> Array:
    """inv(R' R) of an upper triangular R, without forming R' R."""
    inverse = solve_triangular(r, np.eye(r.shape[0]))
    return inverse @ inverse.T
