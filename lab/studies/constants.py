# SPDX-License-Identifier: BSD-3-Clause
"""How well is a constant known beside coloured residuals?

Klein and Morelli's errors take the residual's own autocorrelation, over N at all lags (Klein &
Morelli, 2006, 5.2; SIDPAC). A residual beside a constant sums to zero, and so does that
autocorrelation: of a constant alone, in noise that forgets, a third of the variance is left. Both
errors are held against estimates of pitching moments whose truth is known.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import matmul_toeplitz

import sepcal
from studies import moment_flights as flights
from studies.study import Finding, Outcome, Progress, Study, seed_range, seeds

Column = NDArray[np.float64]

ROWS = 1000  # 20 s
NOISE = 0.002  # sigma of Cm
TERMS = ("1", "alpha", "q_hat", "elevator")
NAMES = ("Cm_0", "Cm_alpha", "Cm_q", "Cm_elevator")
TRUTH = {"1": 0.03, "alpha": -0.9, "q_hat": -14.0, "elevator": -1.2}
WITHIN = 1.96  # standard errors, that hold 95 %
SEEDS = 100
FEWEST_HELD = 0.85  # of constants, or said to be a lower bound


def gauss_markov(rows: float) -> Callable[[np.random.Generator], Column]:
    """Noise of unit variance that forgets in so many rows."""

    def draw(draws: np.random.Generator) -> Column:
        a = np.exp(-1.0 / rows)
        noise = draws.standard_normal(ROWS)
        noise[1:] *= np.sqrt(1 - a**2)
        for row in range(1, ROWS):
            noise[row] += a * noise[row - 1]
        return noise

    return draw


def white(draws: np.random.Generator) -> Column:
    """Of unit variance."""
    return draws.standard_normal(ROWS)


def pink(draws: np.random.Generator) -> Column:
    """1/f down to an eighth of the record's frequency; about unit variance."""
    count = 8 * ROWS
    frequencies = np.fft.rfftfreq(count)
    parts = draws.standard_normal((2, frequencies.size))
    spectrum = (parts[0] + 1j * parts[1]) / np.sqrt(np.maximum(frequencies, frequencies[1]))
    spectrum[0] = 0.0
    noise = np.fft.irfft(spectrum, count)
    return (noise / np.std(noise))[:ROWS]


def drifting(draws: np.random.Generator) -> Column:
    """White noise beside a drift of 5 s that is twice as large."""
    return 0.5 * white(draws) + gauss_markov(5.0 * flights.RATE)(draws)


class Kind(NamedTuple):
    """Of noise."""

    name: str
    draw: Callable[[np.random.Generator], Column]


KINDS = (
    Kind("white", white),
    Kind("AR(0.9)", gauss_markov(-1.0 / np.log(0.9))),
    Kind("AR(0.99)", gauss_markov(-1.0 / np.log(0.99))),
    Kind("pink", pink),
    Kind("white beside a drift of 5 s", drifting),
)


def by_autocorrelation(X: Column, residual: Column) -> Column:
    """Klein and Morelli's standard errors of least squares with regressors X (rows x terms)."""
    rows = residual.size
    lags = np.correlate(residual, residual, "full")[rows - 1 :] / rows
    inverse = np.linalg.inv(X.T @ X)
    filling = X.T @ matmul_toeplitz((lags, lags), X)
    return np.sqrt(np.diag(inverse @ filling @ inverse))


class Record(NamedTuple):
    """Errors of the estimates over either standard error, and what the fit says."""

    ours: Column
    theirs: Column
    is_lower_bound: bool


def measure(kind: Kind, seed: int) -> Record:
    """One maneuver."""
    draws = np.random.default_rng([KINDS.index(kind), seed])
    flown = flights.maneuver(int(draws.integers(2**31)), ROWS)
    Cm = flights.pitching(flown, TRUTH) + NOISE * kind.draw(draws)
    model = sepcal.Aero(flights.AIRCRAFT, equations={"Cm": list(TERMS)})
    fit = sepcal.fit(model, flights.fly(flown, Cm), threads=1)
    X = np.column_stack([flights.regressor(name, flown) for name in TERMS])
    estimate = np.array([fit[name].value for name in NAMES])
    error = estimate - np.array([TRUTH[term] for term in TERMS])
    ours = np.array([fit[name].standard_error for name in NAMES])
    theirs = by_autocorrelation(X, Cm - X @ estimate)
    return Record(error / ours, error / theirs, "lower bound" in fit.message)


def share(held: NDArray[np.bool_]) -> str:
    """In percent."""
    return f"{100 * float(np.mean(held)):.0f} %"


def _run(options: argparse.Namespace, report_progress: Progress) -> Outcome:
    figures: list[str] = []
    findings: list[Finding] = []
    for done, kind in enumerate(KINDS):
        with ThreadPoolExecutor(options.processes) as pool:
            records = list(pool.map(lambda seed, at=kind: measure(at, seed), seed_range(options)))
        ours = np.abs([record.ours for record in records]) < WITHIN
        theirs = np.abs([record.theirs for record in records]) < WITHIN
        ratio = np.median([record.theirs[0] / record.ours[0] for record in records])
        said = np.array([record.is_lower_bound for record in records])
        figures.append(
            f"{kind.name}: Cm_0 {share(ours[:, 0])} and {share(theirs[:, 0])}, the others"
            f" {share(ours[:, 1:])} and {share(theirs[:, 1:])}, errors of Cm_0 {ratio:.2f} times as"
            f" large, a lower bound in {np.sum(said)} of {said.size}"
        )
        honest = ours[:, 0] | said
        findings.append(
            Finding(
                f"{kind.name}: intervals of Cm_0 that hold, or are said to be a lower bound",
                share(honest),
                f"at least {100 * FEWEST_HELD:.0f} %",
                bool(np.mean(honest) >= FEWEST_HELD),
            )
        )
        report_progress((done + 1) / len(KINDS))
    text = "95 % intervals that hold, sepcal's and by the residual's autocorrelation: "
    return Outcome(text + "; ".join(figures), findings)


STUDY = Study(
    "constants",
    "how often intervals of a constant hold beside coloured residuals, sepcal's and those by the"
    " residual's autocorrelation (Klein & Morelli)",
    _run,
    seeds(SEEDS, "maneuvers of each kind of noise"),
)
