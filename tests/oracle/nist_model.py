# SPDX-License-Identifier: BSD-3-Clause
"""A model of one response as sepcal takes it, from one formula for its columns and their slopes."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np

from oracle.model import Array

Columns = list[Array]
Formula = Callable[[tuple[Array, ...], Array], tuple[Columns, list[Columns]]]


@dataclass(frozen=True)
class NistModel:
    """A model as sepcal.fit() takes one.

    `formula(u, xi2)` gives the columns of A followed by b, and of each its derivative with respect
    to every nonlinear parameter; all of them broadcast to (N,). The curve stays the same where the
    parameters of two `terms` are exchanged, and where all of one of the `signs` are reversed.
    """

    formula: Formula
    linear_names: str  # "b1 b2"
    nonlinear_names: str
    input_names: str = "x"
    terms: tuple[str, ...] = ()  # "b1 b2", "b3 b4"
    signs: tuple[str, ...] = ()  # "b1 b2"

    @property
    def inputs(self) -> dict[str, str]:
        """The predictors, without units."""
        return dict.fromkeys(self.input_names.split(), "1")

    @property
    def outputs(self) -> dict[str, str]:
        """The response."""
        return {"y": "1"}

    @property
    def linear(self) -> dict[str, str]:
        """xi1, unbounded."""
        return dict.fromkeys(self.linear_names.split(), "1")

    @property
    def nonlinear(self) -> dict[str, str]:
        """xi2, unbounded."""
        return dict.fromkeys(self.nonlinear_names.split(), "1")

    def at(self, u: tuple[Array, ...], xi2: Array) -> tuple[Array, Array]:
        """A (N, 1, n_1) and b (N, 1)."""
        n_1 = len(self.linear)
        table = np.empty((u[0].size, 1, n_1 + 1))
        with np.errstate(all="ignore"):
            columns, _ = self.formula(u, xi2)
        for k, column in enumerate(columns):
            table[:, 0, k] = column
        return table[..., :n_1], table[..., n_1]

    def derivatives(self, u: tuple[Array, ...], xi2: Array) -> tuple[Array, Array]:
        """Exact ones: dA (N, 1, n_1, n_2) and db (N, 1, n_2)."""
        n_1 = len(self.linear)
        table = np.empty((u[0].size, 1, n_1 + 1, xi2.size))
        with np.errstate(all="ignore"):
            _, slopes = self.formula(u, xi2)
        for k, of_column in enumerate(slopes):
            for i, slope in enumerate(of_column):
                table[:, 0, k, i] = slope
        return table[..., :n_1, :], table[..., n_1, :]

    def predict(self, u: tuple[Array, ...], xi: Array) -> Array:
        """The response y at xi = (xi1, xi2), shape (N,)."""
        n_1 = len(self.linear)
        a, b = self.at(u, xi[n_1:])
        with np.errstate(all="ignore"):
            return a[:, 0] @ xi[:n_1] + b[:, 0]

    def jacobian(self, u: tuple[Array, ...], xi: Array) -> Array:
        """Its derivative with respect to xi, shape (N, n)."""
        n_1 = len(self.linear)
        a, _ = self.at(u, xi[n_1:])
        da, db = self.derivatives(u, xi[n_1:])
        with np.errstate(all="ignore"):
            return np.hstack([a[:, 0], np.einsum("kji,j->ki", da[:, 0], xi[:n_1]) + db[:, 0]])

    def list_equivalents(self) -> list[tuple[Array, Array]]:
        """(order, sign), (n,) each: xi[order] * sign has the curve of xi; first xi itself."""
        names = [*self.linear, *self.nonlinear]
        places = [[names.index(name) for name in term.split()] for term in self.terms]
        reversals = [[names.index(name) for name in group.split()] for group in self.signs]
        equivalents = []
        for exchanged in permutations(places):
            order = np.arange(len(names))
            for to, place in zip(places, exchanged, strict=True):
                order[to] = place
            for chosen in product((1.0, -1.0), repeat=len(reversals)):
                sign = np.ones(len(names))
                for group, of_group in zip(reversals, chosen, strict=True):
                    sign[group] = of_group
                equivalents.append((order, sign))
        return equivalents


class ValuesAlone:
    """The same model to sepcal.fit(), without derivatives."""

    def __init__(self, model: NistModel) -> None:
        self.inputs, self.outputs = model.inputs, model.outputs
        self.linear, self.nonlinear = model.linear, model.nonlinear
        self.at = model.at
