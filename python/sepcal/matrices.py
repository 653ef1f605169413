# SPDX-License-Identifier: BSD-3-Clause
"""Vectors and matrices as filters take them; Error names the one that is wrong."""

import numpy as np
from numpy.typing import ArrayLike

from sepcal import _core
from sepcal.columns import Array

REFUSED = (
    "a number is not finite, or a covariance is not positive semidefinite; nothing was changed"
)


def to_vector(name: str, values: ArrayLike) -> Array:
    """(n,), of what is like it."""
    vector = np.asarray(values, dtype=np.float64)
    if vector.ndim > 1:
        raise _core.Error(f"{name} has the shape {vector.shape}; it is a vector, (n,)")
    return vector


def to_matrix(name: str, values: ArrayLike) -> Array:
    """(n, m), of what is like it."""
    matrix = np.asarray(values, dtype=np.float64)
    if matrix.ndim != 2:
        raise _core.Error(f"{name} has the shape {matrix.shape}; it is a matrix, (n, m)")
    return matrix


def finite(name: str, values: Array) -> Array:
    """The values, where all are numbers."""
    if not np.isfinite(values).all():
        raise _core.Error(f"{name} is not a finite number at {np.argmin(np.isfinite(values))}")
    return values


def to_covariance(name: str, values: ArrayLike) -> Array:
    """(n, n), symmetric and positive semidefinite but for rounding."""
    matrix = finite(name, to_matrix(name, values))
    if matrix.shape[0] != matrix.shape[1]:
        raise _core.Error(f"{name} has the shape {matrix.shape}; it is a covariance, (n, n)")
    size = np.abs(matrix).max(initial=0.0)
    if np.abs(matrix - matrix.T).max(initial=0.0) > 1e-9 * size:
        raise _core.Error(f"{name} is no covariance: it isn't symmetric")
    lowest = np.linalg.eigvalsh(matrix).min(initial=0.0)
    if lowest < -1e-9 * size:
        raise _core.Error(f"{name} is no covariance: it has the eigenvalue {lowest:.3g}, below 0")
    return matrix


def times(name: str, matrix: Array, x: Array) -> Array:
    """Matrix times state."""
    if matrix.shape[1] != len(x):
        raise _core.Error(f"{name} has the shape {matrix.shape}; the filter has {len(x)} states")
    return np.asarray(matrix @ x)
