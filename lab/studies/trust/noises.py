# SPDX-License-Identifier: BSD-3-Clause
"""Noise as instruments have it, of unit size. It shares no code with the engine."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array: TypeAlias = NDArray[np.float64]
Draw: TypeAlias = Callable[[np.random.Generator, Array], Array]  # of the rows' times [s]


def _white(rng: np.random.Generator, time: Array) -> Array:
    return rng.standard_normal(time.size)


def first_order(phi: float) -> Draw:
    """Autoregressive, of this correlation from row to row."""

    def draw(rng: np.random.Generator, time: Array) -> Array:
        innovations = rng.standard_normal(time.size) * np.sqrt(1.0 - phi * phi)
        innovations[0] = rng.standard_normal()
        return np.asarray(lfilter([1.0], [1.0, -phi], innovations))

    return draw


def _power_law(exponent: float) -> Draw:
    """1/f^exponent, shaped in the frequencies of a record eight times as long."""

    def draw(rng: np.random.Generator, time: Array) -> Array:
        long = 8 * time.size
        spectrum = np.fft.rfft(rng.standard_normal(long))
        frequency = np.fft.rfftfreq(long)
        frequency[0] = frequency[1]
        whole = np.fft.irfft(spectrum * frequency ** (-0.5 * exponent), long)
        first = int(rng.integers(long - time.size))
        part = whole[first : first + time.size]
        return np.asarray((part - part.mean()) / part.std())

    return draw


def _bursts(rng: np.random.Generator, time: Array) -> Array:
    """What multiplies the noise: five times as much in some stretches of the record."""
    size = np.ones(time.size)
    for _ in range(3):
        first = int(rng.integers(time.size))
        size[first : first + time.size // 20] = 5.0
    return size


def _bursty(of: Draw) -> Draw:
    return lambda rng, time: of(rng, time) * _bursts(rng, time) / 1.9


def gauss_markov(seconds: float) -> Draw:
    """White noise beside a drift of its own size, as the velocity of a satellite receiver."""

    def draw(rng: np.random.Generator, time: Array) -> Array:
        phi = float(np.exp(-np.median(np.diff(time)) / seconds))
        return _white(rng, time) + first_order(phi)(rng, time)

    return draw


def _filtered(rng: np.random.Generator, time: Array) -> Array:
    """Noise of a third of the usual size that a filter of one second has smoothed."""
    phi = float(np.exp(-np.median(np.diff(time)) / 1.0))
    return first_order(phi)(rng, time) / 3.0


def _random_walk(rng: np.random.Generator, time: Array) -> Array:
    walk = np.cumsum(rng.standard_normal(time.size))
    return np.asarray(_white(rng, time) + (walk - walk.mean()) / walk.std() / 3.0)


def _outliers(rng: np.random.Generator, time: Array) -> Array:
    noise = _white(rng, time)
    hit = rng.random(time.size) < 0.01
    noise[hit] += 10.0 * rng.standard_normal(int(hit.sum()))
    return noise


def _heteroscedastic(rng: np.random.Generator, time: Array) -> Array:
    size = np.exp(np.sin(2.0 * np.pi * (time - time[0]) / np.ptp(time) * 1.5 + rng.uniform(0, 6)))
    return np.asarray(_white(rng, time) * size)


def _resonance(rng: np.random.Generator, time: Array) -> Array:
    """Of 0.3 Hz, lightly damped, beside white noise."""
    step = float(np.median(np.diff(time)))
    radius = np.exp(-0.1 * 2.0 * np.pi * 0.3 * step)
    line = lfilter(
        [1.0],
        [1.0, -2.0 * radius * np.cos(2.0 * np.pi * 0.3 * step), radius**2],
        rng.standard_normal(time.size + 500),
    )[500:]
    return np.asarray(line / line.std() + 0.5 * _white(rng, time))


def _held(rng: np.random.Generator, time: Array) -> Array:
    """A sensor that is read five times as often as it answers."""
    answers = rng.standard_normal(time.size // 5 + 1)
    return np.repeat(answers, 5)[: time.size]


def _interpolated(rng: np.random.Generator, time: Array) -> Array:
    """A sensor that answers at every tenth row, and straight lines between its answers."""
    knots = np.arange(time.size // 10 + 2) * 10.0 - float(rng.integers(10))
    return np.asarray(np.interp(np.arange(time.size), knots, rng.standard_normal(knots.size)))


INTERPOLATED = "interpolated tenfold"
OUTPUT_NOISES: dict[str, Draw] = {
    "white": _white,
    "AR(0.9)": first_order(0.9),
    "AR(0.99)": first_order(0.99),
    "pink": _power_law(1.0),
    "1/f^1.5": _power_law(1.5),
    "bursty": _bursty(_white),
    "bursty AR": _bursty(first_order(0.9)),
    "white + GM 10 s": gauss_markov(10.0),
    "white + GM 60 s": gauss_markov(60.0),
    "white + GM 300 s": gauss_markov(300.0),
    "white + random walk": _random_walk,
    "outliers": _outliers,
    "heteroscedastic": _heteroscedastic,
    "resonance 0.3 Hz": _resonance,
    "held fivefold": _held,
    "filtered": _filtered,
}
FURTHER_NOISES: dict[str, Draw] = {INTERPOLATED: _interpolated}
