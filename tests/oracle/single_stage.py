# SPDX-License-Identifier: BSD-3-Clause
"""The single-stage benchmark: all parameters at once from a given start, by SciPy (Eqs. 5 and 6).

Unlike maximum_likelihood.py it says so where the solver gives up, and it closes no gap by itself.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.optimize import Bounds, least_squares, minimize

from oracle.model import Array, Model, Record

Solver = Literal["trf", "slsqp"]
TRF = {"ftol": 1e-14, "xtol": 1e-14, "gtol": 1e-14}
SLSQP = {"ftol": 1e-12, "maxiter": 1000}
TURNS = 100  # of xi and R


@dataclass(frozen=True)
class SingleStage:
    """Where the solver ended."""

    xi: Array  # (n,)
    noise: Array  # the root of R's diagonal: as given, or the rmse at xi; (n_z,)
    cost: float  # J of Eq. 6 at xi and noise
    converged: bool  # each call of the solver did, and R settled


def single_stage(
    model: Model,
    record: Record,
    start: Array,
    lower: Array,
    upper: Array,
    noise: Array | None,
    solver: Solver,
    tolerance: float = 0.05,
) -> SingleStage:
    """Minimises Eq. 6 within the bounds, each (n,); a start outside them is moved onto them.

    Where noise (n_z,) is None, R starts at I and is estimated in turn with xi, each turn from where
    the last one ended, until no variance changes by `tolerance` of itself (Eq. 26). SLSQP stops
    some 1e-4 standard errors short of the minimum: below 1e-7 its R may never settle.
    """
    xi = np.clip(np.asarray(start, dtype=float), lower, upper)
    minimise = _minimise_by_trf if solver == "trf" else _minimise_by_slsqp
    cost = _Cost(model, record, np.ones(len(model.outputs)) if noise is None else noise)
    converged, settled = True, False
    for _ in range(TURNS):
        xi, success = minimise(cost, xi, lower, upper)
        converged = converged and success
        before, cost = cost, cost if noise is not None else cost.with_noise_at(xi)
        settled = bool(np.all(np.abs(cost.variance / before.variance - 1) < tolerance))
        if settled:
            break
    return SingleStage(xi, np.sqrt(cost.variance), cost.value(xi), converged and settled)


class _Cost:
    """Eq. 6 at a fixed R, by its whitened residual."""

    def __init__(self, model: Model, record: Record, noise: Array) -> None:
        self._model = model
        self._record = record
        self._measured = model.measured(record)
        self._noise = np.asarray(noise, dtype=float)[:, np.newaxis]
        self.variance = self._noise[:, 0] ** 2
        self.rows = self._measured.shape[1]

    def with_noise_at(self, xi: Array) -> "_Cost":
        """The same with R = SSE / N at xi."""
        residual = self._measured - self._model.predict(self._record, xi)
        return _Cost(self._model, self._record, np.sqrt(np.mean(residual**2, axis=1)))

    def residual(self, xi: Array) -> Array:
        """Output by output, shape (n_z N,)."""
        misfit = self._measured - self._model.predict(self._record, xi)
        return np.asarray(misfit / self._noise).ravel()

    def jacobian(self, xi: Array) -> Array:
        """Its derivative, shape (n_z N, n)."""
        slope = self._model.jacobian(self._record, xi) / self._noise[..., np.newaxis]
        return -np.asarray(slope).reshape(-1, xi.size)

    def value(self, xi: Array) -> float:
        """J."""
        logarithm = self.rows * np.sum(np.log(self._noise))
        return float(0.5 * np.sum(self.residual(xi) ** 2) + logarithm)

    def gradient(self, xi: Array) -> Array:
        """The slope of J by xi, shape (n,)."""
        return np.asarray(self.jacobian(xi).T @ self.residual(xi))


def _minimise_by_trf(cost: _Cost, start: Array, lower: Array, upper: Array) -> tuple[Array, bool]:
    """Where SciPy's trust region ends, and whether it says that it is done."""
    found = least_squares(
        cost.residual, start, jac=cost.jacobian, bounds=(lower, upper), method="trf", **TRF
    )
    return found.x, bool(found.success)


def _minimise_by_slsqp(cost: _Cost, start: Array, lower: Array, upper: Array) -> tuple[Array, bool]:
    """The same by sequential quadratic programming of J / N."""
    found = minimize(
        lambda xi: cost.value(xi) / cost.rows,
        start,
        jac=lambda xi: cost.gradient(xi) / cost.rows,
        bounds=Bounds(lower, upper),
        method="SLSQP",
        options=SLSQP,
    )
    return found.x, bool(found.success)
