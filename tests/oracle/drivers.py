# SPDX-License-Identifier: BSD-3-Clause
"""What drives an effect: functions phi_j(d) of a column d, by NumPy and SciPy.

A shape parameter may be complex (a complex step); columns are real.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline, PPoly

from oracle.model import Array, Record

Function = Callable[[Record, Array], Array]  # (record, shape parameters) to phi, shape (k, N)


@dataclass(frozen=True)
class Driver:
    """k functions of a record, and the shape parameters that they have."""

    function: Function
    suffixes: tuple[str, ...] = ("",)  # one a function, joined to a coefficient's name
    shape: tuple[str, ...] = ()  # "exponent", "tau"


def constant() -> Driver:
    """The function phi = 1."""
    return Driver(lambda record, _: np.ones((1, record["time"].size)))


def power(column: str, exponent: int = 1, centre: float = 0.0) -> Driver:
    """The function phi = (d - centre)^k."""
    return Driver(lambda record, _: ((record[column] - centre) ** exponent)[np.newaxis])


def fitted_power(column: str) -> Driver:
    """The function phi = max(d, 0)^n with n a parameter."""

    def function(record: Record, shape: Array) -> Array:
        positive = record[column] > 0
        safe = np.where(positive, record[column], 1.0)
        return np.where(positive, safe ** shape[0], 0.0)[np.newaxis]

    return Driver(function, shape=("exponent",))


def spline(column: str, knots: Array) -> Driver:
    """Cardinal natural splines of the knots but the first; straight lines beyond the last."""
    cardinal = CubicSpline(knots, np.eye(knots.size)[:, 1:], bc_type="natural")

    def function(record: Record, _: Array) -> Array:
        inside = np.clip(record[column], knots[0], knots[-1])
        beyond = (record[column] - inside)[:, np.newaxis]
        return (cardinal(inside) + beyond * cardinal(inside, 1)).T

    return Driver(function, suffixes=tuple(f"_{k + 1}" for k in range(1, knots.size)))


def about_mean(driver: Driver, record: Record) -> Driver:
    """A driver without shape whose functions are zero in the mean over a record."""
    means = driver.function(record, np.empty(0)).mean(axis=1, keepdims=True)

    def function(record: Record, shape: Array) -> Array:
        return driver.function(record, shape) - means

    return Driver(function, suffixes=driver.suffixes)


def categories(labels: Array, names: Sequence[str]) -> Driver:
    """phi_j = 1 in the rows of a label; `names` are all labels but the first that appears."""
    indicators = np.stack([labels == name for name in names]).astype(float)
    return Driver(lambda *_: indicators, suffixes=tuple(f"_{name}" for name in names))


def step(start: float) -> Driver:
    """A function that is 1 from a held time on [s]."""
    return Driver(lambda record, _: (record["time"] >= start).astype(float)[np.newaxis])


def ramp() -> Driver:
    """The function phi = max(t - t0, 0), its corner rounded over 0.5 % of the record either way."""

    def function(record: Record, shape: Array) -> Array:
        since = record["time"] - shape[0]
        width = 0.005 * (record["time"][-1] - record["time"][0])
        corner = (since + width) ** 2 / (4 * width)
        rounded = np.where(since.real < width, corner, since)
        return np.where(since.real > -width, rounded, 0.0)[np.newaxis]

    return Driver(function, shape=("t0",))


def decay() -> Driver:
    """The function phi = exp(-(t - t_first) / tau)."""

    def function(record: Record, shape: Array) -> Array:
        return np.exp(-(record["time"] - record["time"][0]) / shape[0])[np.newaxis]

    return Driver(function, shape=("tau",))


def delayed(column: str) -> Driver:
    """The function phi = d(t - tau), by the natural spline through the whole record."""

    def function(record: Record, shape: Array) -> Array:
        return interpolate(record["time"], record[column], -shape[0])[np.newaxis]

    return Driver(function, shape=("tau",))


def interpolate(time: Array, values: Array, shift: complex, derivative: int = 0) -> Array:
    """The natural spline through (time, values) at time + shift, its end pieces continued.

    The piece is found by the real part, so that a complex step differentiates by the shift.
    """
    pieces: PPoly = CubicSpline(time, values, bc_type="natural")
    if derivative:
        pieces = pieces.derivative(derivative)
    at = time + shift
    piece = np.clip(np.searchsorted(time, at.real, side="right") - 1, 0, time.size - 2)
    result = np.zeros(time.size, dtype=np.result_type(at, values))
    for coefficients in pieces.c:
        result = result * (at - time[piece]) + coefficients[piece]
    return result


def lag(time: Array, values: Array, tau: complex) -> Array:
    """Solves tau dz/dt + z = z0, z0 the natural spline through `values`, settled at the start.

    On a piece p of the spline, p - tau p' + tau^2 p'' - tau^3 p''' solves the equation, and what
    is left of the start decays as exp(-t / tau).
    """
    settled, settled_at_end = (
        sum((-tau) ** order * at_knots for order, at_knots in enumerate(side))
        for side in _derivatives_at_knots(time, values)
    )
    result = np.empty(time.size, dtype=np.result_type(settled, tau))
    result[0] = settled[0]
    for k, interval in enumerate(np.diff(time)):
        left = result[k] - settled[k]
        result[k + 1] = settled_at_end[k] + left * np.exp(-interval / tau)
    return result


def _derivatives_at_knots(time: Array, values: Array) -> tuple[list[Array], list[Array]]:
    """Orders 0 to 3 of each piece, shape (N - 1,): at its start and at its end."""
    pieces: PPoly = CubicSpline(time, values, bc_type="natural")
    interval = np.diff(time)
    starts, ends = [], []
    for order in range(4):
        derivative = pieces.derivative(order).c if order else pieces.c
        starts.append(derivative[-1])
        ends.append(sum(c * interval**k for k, c in enumerate(derivative[::-1])))
    return starts, ends
