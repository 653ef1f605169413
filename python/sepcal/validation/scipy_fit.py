# SPDX-License-Identifier: BSD-3-Clause
"""The same problem by SciPy, as a careful user would write it: one nonlinear least squares."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from sepcal._core import Error
from sepcal.columns import Array, Columns
from sepcal.models import Model

SMALLEST = 1e-15  # of SciPy's three tolerances
MOST_EVALUATIONS = 2000


@dataclass(frozen=True, eq=False)
class ScipyFit:
    """SciPy's fit of the n parameters in the model's order; those held have no standard error."""

    values: Array  # (n,)
    standard_errors: Array  # (n,); NaN of those held
    squares: float  # sum of squared residuals in units of the noise


def least_squares() -> Any:  # noqa: ANN401
    """SciPy's. Raises Error, which names the extra, where it isn't there."""
    try:
        return importlib.import_module("scipy.optimize").least_squares
    except ImportError:
        raise Error("validate() needs SciPy: pip install sepcal[validate]") from None


def residuals_of(
    model: Model, data: Columns, noise: Mapping[str, float], values: Mapping[str, float]
) -> Array:
    """The residuals over the noise, (N n_z,)."""
    A, b = model.evaluate(data, {name: values[name] for name in model.nonlinear})
    z = np.stack([np.asarray(data[name], dtype=np.float64) for name in model.outputs], axis=-1)
    left = z - A @ np.array([values[name] for name in model.linear]) - b
    return np.ravel(left / np.array([noise[name] for name in model.outputs]))


def fit_by_scipy(
    model: Model,
    data: Columns,
    noise: Mapping[str, float],
    start: Mapping[str, float],
    held: Mapping[str, float],
    bounds: Mapping[str, tuple[float, float]],
) -> ScipyFit:
    """Minimises over all parameters that aren't held, within bounds.

    By differences of three points: nothing of sepcal's derivatives is used.

    Args:
        model: The model.
        data: Its inputs and outputs by name.
        noise: Standard deviation of every output.
        start: A value of every parameter.
        held: Those that are not estimated.
        bounds: (lower, upper) of every parameter, infinite where open.
    """
    solve = least_squares()
    free = [name for name in model.parameters if name not in held]
    values = {**start, **held}
    ends = np.array([bounds[name] for name in free]).T
    at = np.array([values[name] for name in free])
    scales = np.maximum(np.abs(at), 1e-3)

    def residuals(x: Array) -> Array:
        return residuals_of(model, data, noise, {**values, **dict(zip(free, x, strict=True))})

    found = solve(
        residuals,
        np.clip(at, *ends),
        jac="3-point",
        bounds=tuple(ends),
        x_scale=scales,
        ftol=SMALLEST,
        xtol=SMALLEST,
        gtol=SMALLEST,
        max_nfev=MOST_EVALUATIONS,
    )
    estimates = np.array([values[name] for name in model.parameters])
    errors = np.full(estimates.size, np.nan)
    places = [model.parameters.index(name) for name in free]
    estimates[places] = found.x
    errors[places] = np.sqrt(np.diag(np.linalg.pinv(found.jac.T @ found.jac)))
    return ScipyFit(estimates, errors, 2.0 * float(found.cost))
