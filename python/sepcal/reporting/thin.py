# SPDX-License-Identifier: BSD-3-Clause
"""Long flights in a few thousand points, without losing a spike."""

from __future__ import annotations

import itertools
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sepcal.columns import Array

Rows: TypeAlias = NDArray[np.intp]  # indices

POINTS = 3000  # of a curve over time
SCATTERED = 700  # of a cloud of points


def keep_extremes(values: Array, points: int = POINTS) -> Rows:
    """Rows (ascending) of the least and the greatest value of each of points / 2 even bins.

    All rows where there are no more than `points`.
    """
    if values.size <= points:
        return np.arange(values.size)
    edges = np.linspace(0, values.size, points // 2 + 1).astype(int)
    kept: list[int] = []
    for first, last in itertools.pairwise(edges):
        part = np.nan_to_num(values[first:last])
        kept += [first + int(np.argmin(part)), first + int(np.argmax(part))]
    return np.unique(kept)


def keep_even(size: int, points: int = SCATTERED) -> Rows:
    """Rows at even distances, `points` of them at most."""
    return np.unique(np.linspace(0, size - 1, min(size, points)).astype(int))


def say_thinned(rows: int, points: int = POINTS) -> str:
    """Tells the reader what was left out of a curve; empty if nothing was."""
    if rows <= points:
        return ""
    return (
        f"Drawn from {rows:,} rows: each of {points // 2:,} even stretches shows its smallest and "
        "its largest residual, so that no peak is lost. All numbers are of every row."
    )
