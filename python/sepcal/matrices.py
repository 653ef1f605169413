# SPDX-License-Identifier: BSD-3-Clause
"""Vectors and matrices as filters take them; Error names the one that is wrong."""

import operator
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sepcal import _core
from sepcal.columns import Array


def to_numbers(name: str, values: ArrayLike) -> Array:
    """An array of what is like one; what is masked in it is NaN."""
    try:
        array: Any = np.ma.asarray(values)
        numbers = array.real.astype(np.float64).filled(np.nan)
    except (TypeError, ValueError):
        raise _core.Error(f"{name} is no array of numbers") from None
    if array.dtype.kind == "c":
        raise _core.Error(f"{name} is complex; give real numbers")
    return np.asarray(numbers)


def to_whole_number(name: str, value: int) -> int:
    """An int, of what is one."""
    try:
        return operator.index(value)
    except TypeError:
        raise _core.Error(f"{name} is {value!r}; it is a whole number") from None


def to_vector(name: str, values: ArrayLike) -> Array:
    """(n,), of what is like it."""
    vector = to_numbers(name, values)
    if vector.ndim != 1:
        raise _core.Error(f"{name} has the shape {vector.shape}; it is a vector, (n,)")
    return vector


def to_matrix(name: str, values: ArrayLike) -> Array:
    """(n, m), of what is like it."""
    matrix = to_numbers(name, values)
    if matrix.ndim != 2:
        raise _core.Error(f"{name} has the shape {matrix.shape}; it is a matrix, (n, m)")
    return matrix


def finite(name: str, values: Array) -> Array:
    """The values, where all are numbers."""
    if not np.isfinite(values).all():
        raise _core.Error(f"{name} is not a finite number at {np.argmin(np.isfinite(values))}")
    return values


def to_symmetric(name: str, values: ArrayLike) -> Array:
    """(n, n), symmetric but for rounding: a covariance whose sign is looked at where it is used."""
    matrix = finite(name, to_matrix(name, values))
    if matrix.shape[0] != matrix.shape[1]:
        raise _core.Error(f"{name} has the shape {matrix.shape}; it is a covariance, (n, n)")
    if np.abs(matrix - matrix.T).max(initial=0.0) > 1e-9 * np.abs(matrix).max(initial=0.0):
        raise _core.Error(f"{name} is no covariance: it isn't symmetric")
    return matrix


def to_covariance(name: str, values: ArrayLike) -> Array:
    """(n, n), symmetric and positive semidefinite but for rounding."""
    matrix = to_symmetric(name, values)
    lowest = np.linalg.eigvalsh(matrix).min(initial=0.0)
    if lowest < -1e-9 * np.abs(matrix).max(initial=0.0):
        raise _core.Error(f"{name} is no covariance: it has the eigenvalue {lowest:.3g}, below 0")
    return matrix


def refusal(
    verb: str, numbers: Mapping[str, Array], covariances: Mapping[str, Array], otherwise: str
) -> _core.Error:
    """What to raise where a filter took none of it: the argument that is wrong, or `otherwise`."""
    for name, values in numbers.items():
        if not np.isfinite(values).all():
            return _core.Error(f"{verb}: {name} is not a finite number; nothing was changed")
    for name, matrix in covariances.items():
        try:
            to_covariance(name, matrix)
        except _core.Error as error:
            return _core.Error(f"{verb}: {error}; nothing was changed")
    return _core.Error(f"{verb}: {otherwise}; nothing was changed")


def times(name: str, matrix: Array, x: Array) -> Array:
    """Matrix times state."""
    if matrix.shape[1] != len(x):
        raise _core.Error(f"{name} has the shape {matrix.shape}; the filter has {len(x)} states")
    return np.asarray(matrix @ x)
