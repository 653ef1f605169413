# SPDX-License-Identifier: BSD-3-Clause
"""Which of twelve regressors make a pitching moment? Three do, in four kinds of noise.

Stepwise regression by partial F and by the predicted square error (Klein & Morelli, 5.4) beside
diagnose, which adds until nothing passes; all three end in the same least squares.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import sepcal
from studies import moment_flights as flights
from studies.study import Finding, Outcome, Progress, Study, seed_range, seeds

Column = NDArray[np.float64]

POOL = (
    *("alpha", "q_hat", "elevator", "throttle"),
    *("alpha^2", "alpha^3", "elevator^2", "throttle^2"),
    *("alpha*q_hat", "alpha*elevator", "alpha*throttle", "elevator*throttle"),
)
TRUE_TERMS = 3
ROWS = 1000  # 20 s
NOISE = 0.004  # sigma of Cm
SIZES = 0.2, 1.0  # of a term, its rms about its mean in sigmas; evenly in the logarithm
READING_NOISE = 0.05  # of a regressor's reading, in its own rms about its mean
SEEDS = 25
ENTERS = 20.0  # the F of SIDPAC's swr


def white(draws: np.random.Generator, rows: int) -> Column:
    """Of unit variance."""
    return draws.standard_normal(rows)


def gauss_markov(seconds: float) -> Callable[[np.random.Generator, int], Column]:
    """The same with a correlation time."""

    def draw(draws: np.random.Generator, rows: int) -> Column:
        a = np.exp(-1.0 / (flights.RATE * seconds))
        noise = draws.standard_normal(rows)
        noise[1:] *= np.sqrt(1 - a**2)
        for row in range(1, rows):
            noise[row] += a * noise[row - 1]
        return noise

    return draw


class Kind(NamedTuple):
    """Of noise."""

    name: str
    draw: Callable[[np.random.Generator, int], Column]
    in_readings: bool = False


KINDS = (
    Kind("white noise", white),
    Kind("Gauss-Markov, 0.5 s", gauss_markov(0.5)),
    Kind("Gauss-Markov, 3 s", gauss_markov(3.0)),
    Kind("noisy readings", white, in_readings=True),
)


@dataclass(frozen=True)
class Case:
    """A maneuver as it was read, what made its moment, and another maneuver."""

    channels: dict[str, Column]
    Cm: Column
    truth: dict[str, float]
    another: dict[str, Column]


def maneuver(draws: np.random.Generator) -> dict[str, Column]:
    """Channels about their trim, as regressors are: else a square is nearly a straight line."""
    flown = flights.maneuver(int(draws.integers(2**31)), ROWS)
    return {name: values - values.mean() for name, values in flown.items()}


def make_case(kind: Kind, seed: int) -> Case:
    """Terms, sizes, maneuvers and noise are drawn from the seed."""
    draws = np.random.default_rng([KINDS.index(kind), seed])
    flown = maneuver(draws)
    truth = {"1": 0.03}
    for name in draws.choice(POOL, TRUE_TERMS, replace=False):
        size = NOISE * np.exp(draws.uniform(*np.log(SIZES))) * draws.choice([-1.0, 1.0])
        truth[str(name)] = float(size / np.std(flights.regressor(str(name), flown)))
    Cm = flights.pitching(flown, truth) + NOISE * kind.draw(draws, ROWS)
    read = {
        name: values + READING_NOISE * np.std(values) * draws.standard_normal(ROWS)
        if kind.in_readings
        else values
        for name, values in flown.items()
    }
    return Case(read, Cm, truth, maneuver(draws))


def columns_of(terms: Sequence[str], channels: dict[str, Column]) -> Column:
    """(rows, 1 + terms): the constant first."""
    return np.column_stack([flights.regressor(name, channels) for name in ("1", *terms)])


def fit_terms(terms: Sequence[str], case: Case) -> tuple[Column, float]:
    """Least squares, and the sum of squares that it leaves."""
    X = columns_of(terms, case.channels)
    estimate: Column = np.linalg.lstsq(X, case.Cm, rcond=None)[0].astype(np.float64)
    return estimate, float(np.sum((case.Cm - X @ estimate) ** 2))


def partial_f(without: float, left: float, parameters: int) -> float:
    """Of one term; `parameters`: with it and the constant."""
    return (without - left) / (left / (ROWS - parameters))


def choose_by_f(case: Case) -> list[str]:
    """Stepwise regression: the largest F enters above ENTERS, what has fallen below it leaves."""
    chosen: list[str] = []
    for _ in range(2 * len(POOL)):
        left = fit_terms(chosen, case)[1]
        offered = {
            name: partial_f(left, fit_terms([*chosen, name], case)[1], len(chosen) + 2)
            for name in POOL
            if name not in chosen
        }
        best = max(offered, key=lambda name: offered[name], default=None)
        if best is None or offered[best] < ENTERS:
            break
        chosen.append(best)
        left = fit_terms(chosen, case)[1]
        chosen = [
            name
            for name in chosen
            if partial_f(
                fit_terms([one for one in chosen if one != name], case)[1], left, len(chosen) + 1
            )
            >= ENTERS
        ]
    return chosen


def choose_by_pse(case: Case) -> list[str]:
    """The term that lowers it most, until none does; s2max is half the variance, as SIDPAC's."""
    s2max = float(np.var(case.Cm, ddof=1)) / 2
    chosen: list[str] = []

    def pse(terms: Sequence[str]) -> float:
        return (fit_terms(terms, case)[1] + 2 * s2max * (len(terms) + 1)) / ROWS

    while len(chosen) < len(POOL):
        best = min((name for name in POOL if name not in chosen), key=lambda n: pse([*chosen, n]))
        if pse([*chosen, best]) >= pse(chosen):
            break
        chosen.append(best)
    return chosen


def choose_by_diagnosis(case: Case) -> list[str]:
    """What diagnose adds."""
    flight = flights.fly(case.channels, case.Cm)
    model = sepcal.Aero(flights.AIRCRAFT, equations={"Cm": ["1"]})
    fit = sepcal.fit(model, flight, threads=1)
    stepped = fit.diagnose(auto=True, only=[f"Cm[{name}]" for name in POOL])
    added = [name for effect in stepped.effects for name in effect.split("+")]
    return [name.removeprefix("Cm[").removesuffix("]") for name in added]


WAYS: dict[str, Callable[[Case], list[str]]] = {
    "partial F": choose_by_f,
    "PSE": choose_by_pse,
    "diagnose": choose_by_diagnosis,
}


@dataclass
class Score:
    """Of one way in one kind of noise, over its data sets."""

    found: int = 0
    false: int = 0
    square: float = 0.0  # of the prediction's error, in the predicted moment's rms about its mean
    cases: int = 0

    def count(self, chosen: Sequence[str], case: Case) -> None:
        """Adds a data set."""
        self.cases += 1
        self.found += sum(name in case.truth for name in chosen)
        self.false += sum(name not in case.truth for name in chosen)
        moment = flights.pitching(case.another, case.truth)
        estimate = fit_terms(chosen, case)[0]
        error = columns_of(chosen, case.another) @ estimate - moment
        self.square += float(np.mean(error**2) / np.var(moment))

    @property
    def error(self) -> float:
        """Rms over the data sets."""
        return float(np.sqrt(self.square / self.cases))

    def in_words(self) -> str:
        """Of so many."""
        of = TRUE_TERMS * self.cases
        return f"{self.found} of {of}, {self.false} false, {100 * self.error:.0f} % off"


def _try(kind: Kind, seed: int) -> tuple[Case, dict[str, list[str]]]:
    case = make_case(kind, seed)
    return case, {name: choose(case) for name, choose in WAYS.items()}


def _run(arguments: argparse.Namespace, report_progress: Progress) -> Outcome:
    figures: list[str] = []
    findings: list[Finding] = []
    of = len(KINDS) * arguments.seeds
    done = 0
    for kind in KINDS:
        scores = {name: Score() for name in WAYS}
        with ThreadPoolExecutor(arguments.processes) as pool:
            for case, chosen in pool.map(
                lambda seed, at=kind: _try(at, seed), seed_range(arguments)
            ):
                for name, terms in chosen.items():
                    scores[name].count(terms, case)
                done += 1
                report_progress(done / of)
        told = "; ".join(f"{name} {score.in_words()}" for name, score in scores.items())
        figures.append(f"{kind.name}: {told}")
        findings += _limits(kind, scores["diagnose"])
    return Outcome(". ".join(figures), findings)


def _limits(kind: Kind, score: Score) -> list[Finding]:
    """Of diagnose: a false term in ten data sets and two more, half of the terms."""
    most, least = 2 + score.cases // 10, TRUE_TERMS * score.cases // 2
    return [
        Finding(
            f"{kind.name}: diagnose adds false terms",
            f"{score.false}",
            f"at most {most}",
            score.false <= most,
        ),
        Finding(
            f"{kind.name}: diagnose finds terms",
            f"{score.found} of {TRUE_TERMS * score.cases}",
            f"at least {least}",
            score.found >= least,
        ),
    ]


STUDY = Study(
    "model-structure",
    "whether stepwise regression by partial F or PSE, and diagnose --auto, find the three of twelve"
    " regressors that make a pitching moment, and how well the model predicts another maneuver",
    _run,
    seeds(SEEDS, "data sets of each kind of noise"),
)
