# SPDX-License-Identifier: BSD-3-Clause
"""The symmetric matrix with which both autopilots correct soft iron."""

from __future__ import annotations

import numpy as np

from sepcal.columns import Array


def symmetric(diagonal: Array, off_diagonal: Array) -> Array:
    """Matrices (n, 3, 3) from xx, yy, zz and xy, xz, yz, each (n, 3)."""
    x, y, z = diagonal.T
    xy, xz, yz = off_diagonal.T
    rows = ((x, xy, xz), (xy, y, yz), (xz, yz, z))
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
