# SPDX-License-Identifier: BSD-3-Clause
"""Least squares over samples: iterated over all of them, or sample by sample."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from numbers import Integral
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from sepcal import _core
from sepcal.arguments import checked
from sepcal.columns import Array
from sepcal.matrices import (
    UNCHANGED,
    check_refused,
    finite,
    to_covariance,
    to_matrix,
    to_number,
    to_numbers,
    to_symmetric,
    to_vector,
    to_whole_number,
)
from sepcal.states_module import states_module

if TYPE_CHECKING:
    from sepcal import _states

Status = Literal["converged", "not_converged", "not_determined"]
Sample = Callable[
    [int, Array], tuple[ArrayLike, ArrayLike] | tuple[ArrayLike, ArrayLike, ArrayLike]
]


@dataclass(frozen=True)
class LeastSquares:
    """The result of iterate_least_squares().

    Attributes:
        status: "not_converged": iterations ended by their cap, or no step made the cost fall.
            "not_determined": the samples leave a parameter open.
        iterations: How many.
        p: (n,), S 4.8.
        covariance: Covariance of p, (n, n), where W is the noise's covariance, S 4.7; NaN where a
            parameter is open.
        root: [R q; 0 rho], (n + 1, n + 1), of all samples about p: R'R is the information.
        count: Numbers that were there in all samples.
        cost: V(p), half the weighted sum of squares, S 4.5.

    Example:
        >>> t = np.array([0.0, 1.0, 2.0, 3.0])
        >>> y = 2.0 * np.exp(-0.5 * t)
        >>> def sample(k, p):
        ...     gain = np.exp(-p[1] * t[k])
        ...     return [y[k] - p[0] * gain], [[gain, -p[0] * t[k] * gain]]
        ...
        >>> found = sepcal.iterate_least_squares(sample, 4, [1.0, 0.1])
        >>> found.status, found.p.round(6).tolist()
        ('converged', [2.0, 0.5])
    """

    status: Status
    iterations: int
    p: Array
    covariance: Array
    root: Array
    count: int
    cost: float


@checked
def iterate_least_squares(
    sample: Sample,
    count: int,
    p: ArrayLike,
    *,
    iterations: int = 50,
    tolerance: float = 1e-8,
    halvings: int = 30,
) -> LeastSquares:
    """Weighted least squares by Gauss and Newton, y(k) = f(k, p) + e(k) (S 4.1 to 4.8).

    The compiled code that flight software takes for a few parameters; fits of whole records, with
    bounds and without a start, are sepcal.fit().

    Args:
        sample: Function of sample k at p: z = y - f(k, p), (m,), NaN where missing; H = df/dp, (m,
            n); and W, the covariance of e, (m, m) [the identity].
        count: Samples, k = 0 ... count - 1.
        p: Where it begins, (n,).
        iterations: At most so many.
        tolerance: The shortest step, in standard deviations of p.
        halvings: At most so many of a step that makes the cost rise.

    Raises:
        Error: Another shape, what is not finite, a W that is not positive definite.
        Exception: Whatever `sample` raises.

    Example:
        >>> t = np.linspace(0.0, 2.0, 20)
        >>> y = 3.0 * np.exp(-0.7 * t)
        >>> def sample(k, p):
        ...     decay = np.exp(-p[1] * t[k])
        ...     return y[k] - p[0] * decay, [decay, -p[0] * t[k] * decay]
        ...
        >>> sepcal.iterate_least_squares(sample, 20, [1.0, 0.5]).p.round(6).tolist()
        [3.0, 0.7]
    """
    last: tuple[int, Array, Array, Array] = (0, np.zeros(0), np.zeros((0, 0)), np.zeros((0, 0)))

    def rows(k: int, at: Array) -> tuple[Array, Array, Array]:
        given = sample(k, at)
        if len(given) not in (2, 3):
            raise _core.Error(f"sample() gave {len(given)} parts; it gives z, H or z, H, W")
        z = to_vector("z", np.atleast_1d(to_numbers("z", given[0])))
        H = to_matrix("H", np.atleast_2d(to_numbers("H", given[1])))
        W = np.eye(len(z)) if len(given) == 2 else np.atleast_2d(to_numbers("W", given[2]))
        nonlocal last
        last = k, z, H, to_symmetric("W", W, z)
        return z, H, last[3]

    for name, number in (("count", count), ("iterations", iterations)):
        if to_whole_number(name, number) < 1:
            raise _core.Error(f"{name} is {number}; it must be above 0")
    if not to_number("tolerance", tolerance) > 0.0:
        raise _core.Error(f"tolerance is {tolerance}; it must be above 0")
    if to_whole_number("halvings", halvings) < 0:
        raise _core.Error(f"halvings is {halvings}; it is 0 or more")
    status, *found = states_module().iterate_least_squares(
        rows, count, finite("p", to_vector("p", p)), iterations, tolerance, halvings
    )
    if status == "refused":
        k, z, H, W = last
        seen = ~np.isnan(z)
        check_refused(f"sample({k})", {"z": z[seen], "H": H[seen]}, {"W": W[np.ix_(seen, seen)]})
        raise _core.Error(f"sample({k}): W is singular; it must be positive definite")
    taken, at, root, covariance, values, cost = found
    if status == "not_determined":
        covariance = np.full_like(covariance, np.nan)
    return LeastSquares(status, taken, at, covariance, root, values, cost)


@checked
class RecursiveLeastSquares:
    """y = H p + e, sample by sample; the answer is that of all samples at once.

    System Identification Summary, S 4.9 to 4.14.

    Args:
        p: The parameters to begin with, (n,); or how many there are, of which nothing is known
            before (with "square_root").
        covariance: Covariance of the first estimate, (n, n).
        form: What the recursion keeps: the root of the information, the information itself (S
            4.13), or its inverse (S 4.14, corrected).

    Example:
        >>> line = sepcal.RecursiveLeastSquares(2)
        >>> for t in (0.0, 1.0, 2.0):
        ...     line.absorb([[1.0, t]], [3.0 + 2.0 * t])
        ...
        >>> line.solution.round(6).tolist()
        [3.0, 2.0]
    """

    def __init__(
        self,
        p: ArrayLike,
        covariance: ArrayLike | None = None,
        form: Literal["square_root", "information", "covariance"] | str = "square_root",
    ) -> None:
        if isinstance(p, Integral):
            if p < 1:
                raise _core.Error(f"p is {p}; give the number of parameters, or where they begin")
            begin = np.zeros(to_whole_number("p", int(p)))
        else:
            begin = finite("p", to_vector("p", p))
            if covariance is None:
                raise _core.Error(
                    "p has no weight without a covariance; give it, or in p's place the number of "
                    "parameters"
                )
        if form not in ("square_root", "information", "covariance"):
            raise _core.Error(
                f"form is {form!r}; it is 'square_root', 'information' or 'covariance'"
            )
        known = None if covariance is None else to_covariance("covariance", covariance)
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

        Example:
            >>> mean = sepcal.RecursiveLeastSquares(1)
            >>> for reading in (1.0, 3.0, np.nan):  # the last is missing
            ...     mean.absorb([1.0], reading)
            ...
            >>> mean.solution.round(9).tolist()
            [2.0]
        """
        values = to_vector("y", np.atleast_1d(to_numbers("y", y)))
        slope = to_matrix("H", np.atleast_2d(to_numbers("H", H)))
        noise = np.eye(len(values)) if W is None else np.atleast_2d(to_numbers("W", W))
        if not self._core.absorb(slope, values, to_symmetric("W", noise, values)):
            seen = ~np.isnan(values)
            given = {"y": values[seen], "H": slope[seen]}
            check_refused("absorb()", given, {"W": noise[np.ix_(seen, seen)]})
            why = (
                "the rows leave the range of numbers"
                if W is None
                else "W is singular; it must be positive definite"
            )
            raise _core.Error(f"absorb(): {why}; {UNCHANGED}")

    @property
    def solution(self) -> Array:
        """p, (n,); zero where nothing determines it."""
        return self._core.solution

    @property
    def covariance(self) -> Array:
        """The covariance of p, (n, n), if W is the noise's; NaN where a parameter is open."""
        found = self._core.covariance
        return found if self.determined else np.full_like(found, np.nan)

    @property
    def determined(self) -> bool:
        """Whether the samples determine every parameter."""
        return self._core.determined

    def __repr__(self) -> str:
        return f"<sepcal.RecursiveLeastSquares of {len(self.solution)} parameters>"
