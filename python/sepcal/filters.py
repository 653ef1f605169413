# SPDX-License-Identifier: BSD-3-Clause
"""The filters and recursions of flight software, in Python."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from sepcal import _core
from sepcal._core import Innovation
from sepcal.columns import Array
from sepcal.states_module import states_module

if TYPE_CHECKING:
    from sepcal import _states

REFUSED = (
    "a number is not finite, or a covariance is not positive semidefinite; nothing was changed"
)


class Filter:
    """A Kalman filter; with linearisations of a nonlinear system the extended one.

        filter = sepcal.Filter(x=[0.0, 0.0], P=np.diag([100.0, 4.0]))
        for y in altitudes:
            filter.update([y], H=[[1.0, 0.0]], R=[[0.25]])
            filter.predict(Phi=[[1.0, 0.1], [0.0, 1.0]], Q=np.diag([0.0, 0.01]))

    System Identification Summary, S 2.3 to 2.13; the compiled code that flight software takes.

    Args:
        x: The state that it begins with, (n_x,).
        P: Its covariance, (n_x, n_x), positive semidefinite.
        form: How the covariance is kept: its root, which holds twice the digits, or multiplied out
            and updated by Joseph's form.

    Attributes:
        log_likelihood: Of all outputs so far, the sum of ln p(e), S 5.4.
    """

    def __init__(
        self,
        x: ArrayLike,
        P: ArrayLike,
        form: Literal["square_root", "joseph"] | str = "square_root",
    ) -> None:
        self._core: _states.Filter = states_module().Filter(
            _finite("x", _vector("x", x)), _covariance("P", P), form
        )
        self.log_likelihood = 0.0

    @property
    def x(self) -> Array:
        """The state, (n_x,)."""
        return self._core.x

    @property
    def covariance(self) -> Array:
        """Its covariance, (n_x, n_x)."""
        return self._core.covariance

    def predict(
        self,
        Phi: ArrayLike,
        Q: ArrayLike,
        *,
        Gamma: ArrayLike | None = None,
        shift: ArrayLike | None = None,
        x: ArrayLike | None = None,
    ) -> None:
        """To the next sample: x <- Phi x + shift, P <- Phi P Phi' + Gamma Q Gamma'.

        Args:
            Phi: (n_x, n_x); of a nonlinear system the derivative of the next state by this one.
            Q: Covariance of the noise between the samples, (n_w, n_w): a density's integral.
            Gamma: Where the noise enters, (n_x, n_w) [the identity].
            shift: What inputs add, (n_x,) [nothing].
            x: The next state of a nonlinear system, (n_x,), in place of Phi x + shift.

        Raises:
            Error: Another shape, what is not finite, a covariance that is not positive
                semidefinite; the filter is as it was.
        """
        transition = _matrix("Phi", Phi)
        if x is None:
            x = _times("Phi", transition, self.x) + _vector(
                "shift", 0.0 if shift is None else shift
            )
        noise = np.eye(len(self.x)) if Gamma is None else _matrix("Gamma", Gamma)
        if not self._core.predict(_vector("x", x), transition, noise, _matrix("Q", Q)):
            raise _core.Error(f"predict(): {REFUSED}")

    def update(
        self, y: ArrayLike, H: ArrayLike, R: ArrayLike, *, expected: ArrayLike | None = None
    ) -> Innovation:
        """By a measurement.

        Args:
            y: (n_z,); NaN where an output is missing, which is left out exactly.
            H: (n_z, n_x); of nonlinear outputs their derivative.
            R: Covariance of the measurement's noise, (n_z, n_z).
            expected: What was expected of y, (n_z,) [H x].

        Returns:
            The innovation: e, w, root, covariance, count, cost.

        Raises:
            Error: As of predict().
        """
        slope = _matrix("H", H)
        value = _times("H", slope, self.x) if expected is None else _vector("expected", expected)
        found = self._core.update(_vector("y", y), value, slope, _matrix("R", R))
        if found is None:
            raise _core.Error(f"update(): {REFUSED}")
        self.log_likelihood -= found.cost + 0.5 * found.count * math.log(2.0 * math.pi)
        return found

    def __repr__(self) -> str:
        return f"<sepcal.Filter of {len(self.x)} states>"


class RecursiveLeastSquares:
    """y = H p + e, sample by sample; the answer is that of all samples at once.

    System Identification Summary, S 4.9 to 4.14.

    Args:
        p: The parameters to begin with, (n,), or how many there are.
        covariance: Theirs, (n, n); None: nothing is known before (with "square_root").
        form: What is kept: the root of the information, the information itself (S 4.13), or its
            inverse (S 4.14, corrected).
    """

    def __init__(
        self,
        p: ArrayLike,
        covariance: ArrayLike | None = None,
        form: Literal["square_root", "information", "covariance"] | str = "square_root",
    ) -> None:
        if isinstance(p, int) and p < 1:
            raise _core.Error(f"p is {p}; give the number of parameters, or where they begin")
        begin = np.zeros(p) if isinstance(p, int) else _finite("p", _vector("p", p))
        known = None if covariance is None else _covariance("covariance", covariance)
        self._core: _states.RecursiveLeastSquares = states_module().RecursiveLeastSquares(
            begin, known, form
        )

    def absorb(self, H: ArrayLike, y: ArrayLike, W: ArrayLike | None = None) -> None:
        """One sample.

        Args:
            H: (m, n), or (n,) of one output.
            y: (m,), or a number; NaN where missing.
            W: Covariance of e, (m, m) [the identity].

        Raises:
            Error: Another shape, what is not finite, a covariance that is not positive definite;
                nothing was changed.
        """
        values = np.atleast_1d(np.asarray(y, dtype=np.float64))
        weights = np.eye(len(values)) if W is None else np.atleast_2d(np.asarray(W))
        if not self._core.absorb(
            _matrix("H", np.atleast_2d(H)), _vector("y", values), _matrix("W", weights)
        ):
            raise _core.Error(f"absorb(): {REFUSED}")

    @property
    def solution(self) -> Array:
        """p, (n,); zero where nothing determines it."""
        return self._core.solution

    @property
    def covariance(self) -> Array:
        """Of p, (n, n), where W is the noise's covariance."""
        return self._core.covariance

    @property
    def determined(self) -> bool:
        """Whether the samples determine every parameter."""
        return self._core.determined

    def __repr__(self) -> str:
        return f"<sepcal.RecursiveLeastSquares of {len(self.solution)} parameters>"


def _vector(name: str, values: ArrayLike) -> Array:
    vector = np.asarray(values, dtype=np.float64)
    if vector.ndim > 1:
        raise _core.Error(f"{name} has the shape {vector.shape}; it is a vector, (n,)")
    return vector


def _matrix(name: str, values: ArrayLike) -> Array:
    matrix = np.asarray(values, dtype=np.float64)
    if matrix.ndim != 2:
        raise _core.Error(f"{name} has the shape {matrix.shape}; it is a matrix, (n, m)")
    return matrix


def _finite(name: str, values: Array) -> Array:
    if not np.isfinite(values).all():
        raise _core.Error(f"{name} is not a finite number at {np.argmin(np.isfinite(values))}")
    return values


def _covariance(name: str, values: ArrayLike) -> Array:
    matrix = _finite(name, _matrix(name, values))
    if matrix.shape[0] != matrix.shape[1]:
        raise _core.Error(f"{name} has the shape {matrix.shape}; it is a covariance, (n, n)")
    size = np.abs(matrix).max(initial=0.0)
    if np.abs(matrix - matrix.T).max(initial=0.0) > 1e-9 * size:
        raise _core.Error(f"{name} is no covariance: it isn't symmetric")
    lowest = np.linalg.eigvalsh(matrix).min(initial=0.0)
    if lowest < -1e-9 * size:
        raise _core.Error(f"{name} is no covariance: it has the eigenvalue {lowest:.3g}, below 0")
    return matrix


def _times(name: str, matrix: Array, x: Array) -> Array:
    if matrix.shape[1] != len(x):
        raise _core.Error(f"{name} has the shape {matrix.shape}; the filter has {len(x)} states")
    return np.asarray(matrix @ x)
