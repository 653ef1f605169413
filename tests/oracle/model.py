# SPDX-License-Identifier: BSD-3-Clause
"""What the oracle calls a model: a prediction in closed form, its derivative worked out by hand.

z = f(u, xi) + v with xi = (xi1, xi2). As f is affine in xi1, the A and b of Eq. 4 are read off f
and its derivative at xi1 = 0; they are not written down a second time.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[Any]  # float64; complex128 while a derivative is checked by a complex step
Record = Mapping[str, Array]  # columns of length N: inputs and outputs by name


class Model(ABC):
    """Names, prediction and derivative of z = A(u, xi2) xi1 + b(u, xi2) + v."""

    outputs: ClassVar[tuple[str, ...]]
    linear: ClassVar[tuple[str, ...]]
    nonlinear: ClassVar[tuple[str, ...]]

    @property
    def parameters(self) -> tuple[str, ...]:
        """The n names, linear before nonlinear: the order of xi."""
        return self.linear + self.nonlinear

    @abstractmethod
    def predict(self, record: Record, xi: Array) -> Array:
        """The outputs without noise, shape (n_z, N), for xi of shape (n,)."""

    @abstractmethod
    def jacobian(self, record: Record, xi: Array) -> Array:
        """Their derivative with respect to xi, shape (n_z, N, n)."""

    def affine(self, record: Record, xi2: ArrayLike) -> tuple[Array, Array]:
        """A of shape (n_z, N, n_1) and b of shape (n_z, N) at xi2 of shape (n_2,)."""
        at_zero = np.concatenate([np.zeros(len(self.linear)), np.asarray(xi2)])
        a = self.jacobian(record, at_zero)[..., : len(self.linear)]
        return a, self.predict(record, at_zero)

    def measured(self, record: Record) -> Array:
        """The outputs z as measured, shape (n_z, N)."""
        return np.stack([record[name] for name in self.outputs])


class Held(Model):
    """A model with some of its parameters held at a value; the others keep their order."""

    def __init__(self, model: Model, values: Mapping[str, float]) -> None:
        """`values` by name."""
        self.model = model
        self._free = np.array([name not in values for name in model.parameters])
        self._held = np.array([values.get(name, 0.0) for name in model.parameters])

    @property
    def outputs(self) -> tuple[str, ...]:  # type: ignore[override]
        """Those of the model."""
        return self.model.outputs

    @property
    def parameters(self) -> tuple[str, ...]:
        """Those that are not held."""
        return tuple(np.array(self.model.parameters)[self._free])

    def predict(self, record: Record, xi: Array) -> Array:
        """As the model's."""
        return self.model.predict(record, self._whole(xi))

    def jacobian(self, record: Record, xi: Array) -> Array:
        """As the model's, without the columns of what is held."""
        return self.model.jacobian(record, self._whole(xi))[..., self._free]

    def measured(self, record: Record) -> Array:
        """As the model's."""
        return self.model.measured(record)

    def _whole(self, xi: Array) -> Array:
        whole = self._held.astype(xi.dtype)
        whole[self._free] = xi
        return whole
