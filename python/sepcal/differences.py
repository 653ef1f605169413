# SPDX-License-Identifier: BSD-3-Clause
"""Differences of many quantities at once: the points that are asked for, and their weights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sepcal.columns import Array

STEP = 2.0**-11  # of differences, in sizes of a quantity: balances h^4 against rounding / h
# Offsets in steps, and weights, the first of the middle: of fourth order, and of what is linear.
CENTRAL = np.array([1.0, -1.0, 2.0, -2.0]), np.array([0.0, 8.0, -8.0, -1.0, 1.0]) / 12.0
FORWARD = np.array([1.0, 2.0, 3.0, 4.0]), np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / 12.0
BACKWARD = -FORWARD[0], -FORWARD[1]
LINEAR = np.array([1.0]), np.array([-1.0, 1.0])


class Fan:
    """Points about one, in units of steps: differences of several quantities at once.

    Attributes:
        offsets: (w, K); point 0 is the middle.
        weights: (K, w).
    """

    def __init__(self, stencils: Sequence[tuple[Array, Array]]) -> None:
        """A stencil a quantity."""
        w, K = len(stencils), 1 + sum(len(offsets) for offsets, _ in stencils)
        self.offsets, self.weights = np.zeros((w, K)), np.zeros((K, w))
        first = 1
        for j, (offsets, weights) in enumerate(stencils):
            points = slice(first, first + len(offsets))
            self.offsets[j, points] = offsets
            self.weights[points, j], self.weights[0, j] = weights[1:], weights[0]
            first = points.stop


@dataclass(frozen=True)
class Seeds:
    """The variables of the derivatives: the states, then some of p; or none, with K = 1."""

    fan: Fan
    states: int  # of the fan's quantities
    p: Array  # (n_p, P, K)
    steps: Array  # (w - states, P), of p


def step_sizes(values: Array) -> Array:
    """Steps of differences: powers of two, so that a number moved by one is exact."""
    return np.ldexp(STEP, np.frexp(np.maximum(1.0, np.abs(values)))[1])
