# SPDX-License-Identifier: BSD-3-Clause
"""The tutorial examples, Eqs. 21 and 33: z = (1 + a) cos(eta + b) + c, and with a second slope.

Eq. 34 of the paper drops a factor; the phase of the second example is that of Eq. 33.
"""

from typing import ClassVar

import numpy as np

from oracle.model import Array, Model, Record


class ScalarExample1(Model):
    """z = (1 + a) cos(eta + b) + c, Eq. 21; xi = (a, c | b)."""

    outputs: ClassVar = ("z",)
    linear: ClassVar = ("a", "c")
    nonlinear: ClassVar = ("b",)

    def predict(self, record: Record, xi: Array) -> Array:
        """The output without noise, shape (1, N)."""
        a, c, b = xi
        return ((1 + a) * np.cos(record["eta"] + b) + c)[np.newaxis]

    def jacobian(self, record: Record, xi: Array) -> Array:
        """Its derivative, shape (1, N, 3)."""
        a, _, b = xi
        phase = record["eta"] + b
        columns = [np.cos(phase), np.ones_like(phase), -(1 + a) * np.sin(phase)]
        return np.stack(columns, axis=-1)[np.newaxis]


class ScalarExample2(Model):
    """z = (1 + a) cos(eta (1 + b) + c) + d, Eq. 33; xi = (a, d | b, c)."""

    outputs: ClassVar = ("z",)
    linear: ClassVar = ("a", "d")
    nonlinear: ClassVar = ("b", "c")

    def predict(self, record: Record, xi: Array) -> Array:
        """The output without noise, shape (1, N)."""
        a, d, b, c = xi
        return ((1 + a) * np.cos(record["eta"] * (1 + b) + c) + d)[np.newaxis]

    def jacobian(self, record: Record, xi: Array) -> Array:
        """Its derivative, shape (1, N, 4)."""
        a, _, b, c = xi
        phase = record["eta"] * (1 + b) + c
        by_phase = -(1 + a) * np.sin(phase)
        columns = [np.cos(phase), np.ones_like(phase), by_phase * record["eta"], by_phase]
        return np.stack(columns, axis=-1)[np.newaxis]
