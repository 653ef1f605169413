# SPDX-License-Identifier: BSD-3-Clause
"""The filters and smoothers of flight software, in Python."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from sepcal import _core
from sepcal._core import Innovation
from sepcal.arguments import checked
from sepcal.columns import Array
from sepcal.matrices import (
    UNCHANGED,
    check_refused,
    finite,
    times,
    to_covariance,
    to_matrix,
    to_number,
    to_symmetric,
    to_vector,
    to_whole_number,
    without_rounding,
)
from sepcal.plots import Backend, Theme
from sepcal.states_module import states_module

if TYPE_CHECKING:
    from sepcal import _states


@dataclass(frozen=True)
class SmoothedPass:
    """States and noises of a filter's pass of N samples, given all measurements.

    Attributes:
        x: (N, n_x).
        covariance: Covariance of x, (N, n_x, n_x).
        noise: Process noise of the steps between samples, (N - 1, n_w): where it is large the model
            fails.
        noise_covariance: (N - 1, n_w, n_w).

    Example:
        >>> level = sepcal.Filter(x=[0.0], P=[[100.0]], keep_pass=True)
        >>> for reading in (1.0, 1.0, 1.0):
        ...     _ = level.update([reading], H=[[1.0]], R=[[0.01]])
        ...     level.predict(Phi=[[1.0]], Q=[[0.0]])
        ...
        >>> level.smooth().x.round(2).ravel().tolist()
        [1.0, 1.0, 1.0, 1.0]
    """

    x: Array
    covariance: Array
    noise: Array
    noise_covariance: Array

    def plot(self, *, backend: Backend = "plotly", theme: Theme = "light") -> Any:  # noqa: ANN401
        """Draws every state over the samples with 2 standard deviations to either side.

        Args:
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; the library is not installed.

        Example:
            >>> level = sepcal.Filter(x=[0.0], P=[[100.0]], keep_pass=True)
            >>> for reading in (1.1, 0.9, 1.0):
            ...     _ = level.update([reading], H=[[1.0]], R=[[0.01]])
            ...     level.predict(Phi=[[1.0]], Q=[[0.01]])
            ...
            >>> drawn = level.smooth().plot(backend="matplotlib")
        """
        from sepcal.plotting import as_figure
        from sepcal.plotting.of_records import picture_pass

        return as_figure(picture_pass(self), backend, theme)


@checked
class Filter:
    """A Kalman filter; with linearisations of a nonlinear system the extended one.

        filter = sepcal.Filter(x=[0.0, 0.0], P=np.diag([100.0, 4.0]))
        for y in altitudes:
            filter.update([y], H=[[1.0, 0.0]], R=[[0.25]])
            filter.predict(Phi=[[1.0, 0.1], [0.0, 1.0]], Q=np.diag([0.0, 0.01]))

    System Identification Summary, S 2.3 to 2.13; the compiled code that flight software takes.

    Args:
        x: The state that it begins with, (n_x,).
        P: Its covariance, (n_x, n_x), positive semidefinite; with "information" definite.
        form: How the covariance is kept: its root, which holds twice the digits; multiplied out
            and updated by Joseph's form; or the root of its inverse.
        information_root: In place of P, with "information": R, upper triangular, R'R = P^-1, as
            the leading part of a batch's factor is.
        keep_pass: Remember every step, n_x^2 numbers each, for smooth().

    Attributes:
        log_likelihood: Log likelihood of all outputs so far, the sum of ln p(e), S 5.4.

    Example:
        >>> level = sepcal.Filter(x=[0.0], P=[[100.0]])
        >>> for reading in (1.1, 0.9, 1.0):
        ...     _ = level.update([reading], H=[[1.0]], R=[[0.01]])
        ...
        >>> level.x.round(2).tolist()
        [1.0]
    """

    def __init__(
        self,
        x: ArrayLike,
        P: ArrayLike | None = None,
        form: Literal["square_root", "joseph", "information"] | str = "square_root",
        *,
        information_root: ArrayLike | None = None,
        keep_pass: bool = False,
    ) -> None:
        begin = finite("x", to_vector("x", x))
        if not isinstance(form, str):
            raise _core.Error(f"form is {form!r}; it is 'square_root', 'joseph' or 'information'")
        self._core: _states.Filter
        if P is not None and information_root is None:
            self._core = states_module().Filter(begin, to_covariance("P", P), form)
        elif information_root is not None and P is None:
            if form != "information":
                raise _core.Error('information_root is for form="information"; give P otherwise')
            self._core = states_module().Filter.of_information_root(
                begin, _regular_triangle("information_root", information_root)
            )
        else:
            raise _core.Error("a filter begins at P or at information_root; give one of them")
        if keep_pass:
            self._core.keep_pass()
        self.log_likelihood = 0.0

    @property
    def x(self) -> Array:
        """The state, (n_x,)."""
        return self._core.x

    @property
    def covariance(self) -> Array:
        """Its covariance, (n_x, n_x)."""
        return self._core.covariance

    @property
    def information_root(self) -> Array:
        """R, (n_x, n_x), R'R the covariance's inverse. Raises Error but with "information"."""
        root = self._core.information_root
        if root is None:
            raise _core.Error('the filter keeps no information; make it with form="information"')
        return root

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
            shift: The share of the inputs, (n_x,) [zero].
            x: The next state of a nonlinear system, (n_x,), in place of Phi x + shift.

        Raises:
            Error: Another shape, what is not finite, a covariance that is not positive
                semidefinite; the filter is as it was.

        Example:
            >>> fall = sepcal.Filter(x=[100.0, -2.0], P=np.eye(2))  # a height and its rate
            >>> fall.predict(Phi=[[1.0, 0.5], [0.0, 1.0]], Q=np.zeros((2, 2)))
            >>> fall.x.tolist()
            [99.0, -2.0]
        """
        transition = to_matrix("Phi", Phi)
        if x is not None:
            if shift is not None:
                raise _core.Error("predict() was given x, which has no need of shift; give one")
            end = to_vector("x", x)
        else:
            end = times("Phi", transition, self.x)
            if shift is not None:
                added = finite("shift", to_vector("shift", shift))
                if added.shape != end.shape:
                    raise _core.Error(f"shift has {len(added)} entries; here it takes {len(end)}")
                end = end + added
        entry = np.eye(len(self.x)) if Gamma is None else to_matrix("Gamma", Gamma)
        noise = to_symmetric("Q", Q)
        if self._core.predict(end, transition, entry, noise):
            return
        given = {"Phi": transition, "Gamma": entry, "Phi x + shift" if x is None else "x": end}
        check_refused("predict()", given, {"Q": noise})
        if not self._core.predict(end, transition, entry, without_rounding(noise)):
            raise _core.Error(f"predict(): {self._why_not_predicted(transition)}; {UNCHANGED}")

    def update(
        self, y: ArrayLike, H: ArrayLike, R: ArrayLike, *, expected: ArrayLike | None = None
    ) -> Innovation:
        """By a measurement.

        Args:
            y: (n_z,); NaN where an output is missing, which is left out exactly.
            H: (n_z, n_x); of nonlinear outputs their derivative.
            R: Covariance of the measurement's noise, (n_z, n_z).
            expected: The prediction of y, (n_z,) [H x].

        Returns:
            The innovation: e, w, root, covariance, count, cost.

        Raises:
            Error: As in predict().

        Example:
            >>> level = sepcal.Filter(x=[0.0], P=[[1.0]])
            >>> innovation = level.update([4.0], H=[[1.0]], R=[[1.0]])  # as sure as what was known
            >>> innovation.e.tolist(), level.x.round(9).tolist()
            ([4.0], [2.0])
        """
        slope = to_matrix("H", H)
        value = times("H", slope, self.x) if expected is None else to_vector("expected", expected)
        measured = to_vector("y", y)
        noise = to_symmetric("R", R, measured)
        found = self._core.update(measured, value, slope, noise)
        if found is None:
            self._check_refused("update()", measured, noise, H=slope, expected=value)
            seen = np.ix_(~np.isnan(measured), ~np.isnan(measured))
            noise[seen] = without_rounding(noise[seen])
            found = self._core.update(measured, value, slope, noise)
        if found is None:
            raise _core.Error(f"update(): {self._why_not_updated}; {UNCHANGED}")
        self._count(found)
        return found

    def iterated_update(
        self,
        y: ArrayLike,
        outputs: Callable[[Array], tuple[ArrayLike, ArrayLike]],
        R: ArrayLike,
        *,
        iterations: int = 20,
        tolerance: float = 1e-8,
    ) -> Innovation:
        """By a measurement of nonlinear outputs, linearised anew until the state stays.

        Gauss-Newton for the state of highest probability given y, S 3.15 to 3.18.

        Args:
            y: (n_z,); NaN where missing.
            outputs: Function of a state: the prediction of y, (n_z,), and its slope, (n_z, n_x).
            R: Covariance of the measurement's noise, (n_z, n_z).
            iterations: At most so many.
            tolerance: The shortest step, in standard deviations of the state.

        Returns:
            The last iteration's innovation.

        Raises:
            Error: As in predict(); and where the iterations ended by their cap: the filter then
                holds the last one's state.
            Exception: Whatever `outputs` raises; the filter is as it was.

        Example:
            >>> place = sepcal.Filter(x=[3.0], P=[[100.0]])
            >>> _ = place.iterated_update([16.0], lambda x: (x**2, [[2.0 * x[0]]]), R=[[1e-6]])
            >>> place.x.round(4).tolist()
            [4.0]
        """
        most, step = to_whole_number("iterations", iterations), to_number("tolerance", tolerance)
        if most < 1 or not step > 0.0:
            raise _core.Error(
                f"iterations and tolerance must be above 0; they are {iterations} and {tolerance}"
            )

        last: tuple[Array, Array] = (np.zeros(0), np.zeros((0, 0)))

        def linearise(at: Array) -> tuple[Array, Array]:
            nonlocal last
            expected, H = outputs(at)
            last = to_vector("expected", expected), to_matrix("H", H)
            return last

        measured = to_vector("y", y)
        noise = to_symmetric("R", R, measured)
        answer = self._core.iterated_update(
            measured,
            linearise,
            noise,
            _core.IterationOptions(iterations=most, tolerance=step),
        )
        if answer is None:
            expected, slope = last
            self._check_refused("iterated_update()", measured, noise, H=slope, expected=expected)
            raise _core.Error(f"iterated_update(): {self._why_not_updated}; {UNCHANGED}")
        found, converged = answer
        self._count(found)
        if not converged:
            raise _core.Error(
                f"iterated_update() did not converge within {iterations} iterations; give more, or "
                "a prior that is nearer"
            )
        return found

    def smooth(self) -> SmoothedPass:
        """The states and noises of the pass, given all its measurements (S 2.20 to 2.23).

        A sample is what lies between two calls of predict(). The filter may go on afterwards.

        Raises:
            Error: The pass was not kept, or its steps have noises of different number.

        Example:
            >>> level = sepcal.Filter(x=[0.0], P=[[1e6]], keep_pass=True)
            >>> for reading in (1.0, 3.0):
            ...     _ = level.update([reading], H=[[1.0]], R=[[1.0]])
            ...     level.predict(Phi=[[1.0]], Q=[[0.0]])
            ...
            >>> level.smooth().x[0].round(3).tolist()  # the mean of both
            [2.0]
        """
        if not self._core.keeps_pass:
            raise _core.Error("the pass was not kept; make the filter with keep_pass=True")
        x, P, w, Q = self._core.smooth()
        if len({len(noise) for noise in w}) > 1:
            raise _core.Error(
                "the steps have noises of different number; give each step all of them"
            )
        n_w = len(w[0]) if w else 0
        return SmoothedPass(
            np.array(x),
            np.array(P),
            np.array(w).reshape((len(w), n_w)),
            np.array(Q).reshape((len(w), n_w, n_w)),
        )

    def _why_not_predicted(self, Phi: Array) -> str:
        if self._core.information_root is None or np.linalg.matrix_rank(Phi) == len(Phi):
            return "the state or its covariance leaves the range of numbers"
        return "Phi is singular, and form 'information' divides by it; take 'square_root'"

    def _check_refused(self, verb: str, y: Array, R: Array, *, H: Array, expected: Array) -> None:
        seen = ~np.isnan(y)
        given = {"y": y[seen], "H": H[seen], "expected": expected[seen]}
        check_refused(verb, given, {"R": R[np.ix_(seen, seen)]})

    @property
    def _why_not_updated(self) -> str:
        if self._core.information_root is None:
            return "H P H' + R is singular: outputs agree without any noise; give R above 0"
        return "R is singular, and form 'information' divides by it; take 'square_root'"

    def _count(self, found: Innovation) -> None:
        self.log_likelihood -= found.cost + 0.5 * found.count * math.log(2.0 * math.pi)

    def __repr__(self) -> str:
        return f"<sepcal.Filter of {len(self.x)} states>"


def _regular_triangle(name: str, values: ArrayLike) -> Array:
    root = finite(name, to_matrix(name, values))
    if np.tril(root, -1).any() or not np.diagonal(root).all():
        raise _core.Error(f"{name} is upper triangular, without a zero on its diagonal")
    return root
