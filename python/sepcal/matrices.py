# SPDX-License-Identifier: BSD-3-Clause
"""Vectors and matrices as filters take them; Error names the one that is wrong."""

import operator
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sepcal import _core
from sepcal.columns import NUMBERS, Array

UNCHANGED = "nothing was changed"
ROUNDING = 1e-9  # of the largest entry of a covariance


def to_numbers(name: str, values: ArrayLike) -> Array:
    """An array of what is like one; what is masked in it is NaN."""
    try:
        array: Any = np.ma.asarray(values)
        numbers = array.real.astype(np.float64).filled(np.nan)
    except (TypeError, ValueError, OverflowError):
        raise _core.Error(f"{name} is no array of numbers") from None
    if array.dtype.kind == "c":
        raise _core.Error(f"{name} is complex; give real numbers")
    if array.dtype.kind not in f"{NUMBERS}O":
        raise _core.Error(f"{name} holds {array.dtype}, not numbers")
    return np.asarray(numbers)


def to_whole_number(name: str, value: int) -> int:
    """An int, of what is one."""
    try:
        whole = operator.index(value)
    except TypeError:
        raise _core.Error(f"{name} is {value!r}; it is a whole number") from None
    if abs(whole) >= 2**31:
        raise _core.Error(f"{name} is {whole}; it is below 2**31")
    return int(whole)


def to_number(name: str, value: float) -> float:
    """A float, of what is one."""
    if isinstance(value, str):
        raise _core.Error(f"{name} is {value!r}; it is a number")
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise _core.Error(f"{name} is {value!r}; it is a number") from None


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


def to_symmetric(name: str, values: ArrayLike, y: Array | None = None) -> Array:
    """A copy, (n, n), symmetric but for rounding: a covariance whose sign is looked at elsewhere.

    Rows and columns of what is missing in y may hold anything.
    """
    matrix = to_matrix(name, values).copy()
    if matrix.shape[0] != matrix.shape[1]:
        raise _core.Error(f"{name} has the shape {matrix.shape}; it is a covariance, (n, n)")
    if y is None or len(y) != len(matrix):
        there = matrix
    else:
        seen = ~np.isnan(y)
        there = matrix[np.ix_(seen, seen)]
    finite(name, there)
    if np.abs(there - there.T).max(initial=0.0) > ROUNDING * np.abs(there).max(initial=0.0):
        raise _core.Error(f"{name} is no covariance: it isn't symmetric")
    return matrix


def to_covariance(name: str, values: ArrayLike) -> Array:
    """(n, n), symmetric and positive semidefinite; made so where it is so but for rounding."""
    matrix = to_symmetric(name, values)
    lowest = np.linalg.eigvalsh(matrix).min(initial=0.0)
    if lowest < -ROUNDING * np.abs(matrix).max(initial=0.0):
        raise _core.Error(f"{name} is no covariance: it has the eigenvalue {lowest:.3g}, below 0")
    return without_rounding(matrix)


def without_rounding(matrix: Array) -> Array:
    """The matrix raised to positive semidefinite, of one that is so but for rounding."""
    lowest = np.linalg.eigvalsh(matrix).min(initial=0.0)
    if lowest >= 0.0:
        return matrix
    margin = len(matrix) * float(np.finfo(np.float64).eps) * np.abs(matrix).max(initial=0.0)
    raised: Array = matrix + (margin - lowest) * np.eye(len(matrix))
    return raised


def check_refused(
    verb: str, numbers: Mapping[str, Array], covariances: Mapping[str, Array]
) -> None:
    """Raises Error that names what a filter could not take, where it is one of these."""
    for name, values in numbers.items():
        if not np.isfinite(values).all():
            raise _core.Error(f"{verb}: {name} is not a finite number; {UNCHANGED}")
    for name, matrix in covariances.items():
        try:
            to_covariance(name, matrix)
        except _core.Error as error:
            raise _core.Error(f"{verb}: {error}; {UNCHANGED}") from None


def times(name: str, matrix: Array, x: Array) -> Array:
    """Matrix times state."""
    if matrix.shape[1] != len(x):
        raise _core.Error(f"{name} has the shape {matrix.shape}; the filter has {len(x)} states")
    return np.asarray(matrix @ x)
