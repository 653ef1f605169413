# SPDX-License-Identifier: BSD-3-Clause
"""Effects hidden along trajectories: are they found, and is nothing found where nothing is?

The simulated aircraft flies 40 s at 25 Hz; its flight is fitted by output error without the effect,
diagnosed, and fitted again with it.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

import sepcal
from studies.study import Finding, Outcome, Progress, Study, seed_range, seeds

SEEDS = 15  # at each size
NULL_SEEDS = 25
RATE = 25.0  # Hz
SIZES = (5, 10, 30)  # standard errors, each coefficient
NEAR = 0.05  # of the error, how far it may fall from the promise
MOST_FALSE = 0.05  # of the flights with nothing hidden
NOISES = {"white": "white", "Gauss-Markov": "ar", "pink": "pink", "turbulence": "white"}
GUSTS = 1.0  # m/s, of turbulence


@dataclass(frozen=True)
class Hidden:
    """An effect, by the model that lacks it."""

    name: str
    model: str  # "path" or "longitudinal"
    sign: float = 1.0  # of the simulator's coefficient beside the model's


LIGHT = sepcal.Aircraft(
    area=16.2, chord=1.49, span=10.9, mass=1050.0, inertia=(1285.0, 1825.0, 2667.0, 60.0)
)
EFFECTS = (
    Hidden("imu_late", "path"),
    Hidden("gyro_bias[time]", "path", -1.0),
    Hidden("airspeed_scale[imu_temp_degc]", "path"),
    Hidden("wind[time]", "path"),
    Hidden("Cm[alpha^2]", "longitudinal"),
)


@dataclass(frozen=True)
class Told:
    """What became of one flight."""

    first: bool  # the effect, or what explains it as well, stands first and is advised
    found: bool
    promised: float  # of the error
    fell: float


def model_of(kind: str) -> sepcal.FlightPath | sepcal.RigidAircraft:
    """Not fitted yet."""
    if kind == "path":
        return sepcal.FlightPath()
    return sepcal.RigidAircraft(LIGHT, kind)


def fly(seed: int, hide: Mapping[str, list[float]], kind: str = "white") -> sepcal.Flight:
    """One flight as one segment."""
    truth = {"options": {"turbulence": GUSTS if kind == "turbulence" else 0.0}}
    flown = sepcal.simulate(
        "aircraft", rate=RATE, seed=seed, hide=hide, noise=NOISES[kind], truth=truth
    )
    return sepcal.Flight({name: flown[name] for name in flown.columns})


def standard_errors(hidden: Hidden) -> list[float]:
    """Of the effect's coefficients, where there is nothing of it."""
    fit = sepcal.fit(model_of(hidden.model), fly(0, {}), threads=1)
    added = fit.add(hidden.name)
    new = [name for name in added.parameters if name not in fit.parameters]
    return [float(added[name].standard_error) for name in new]


def tell(hidden: Hidden, sizes: list[float], seed: int) -> Told:
    """One flight with the effect."""
    flight = fly(seed, {hidden.name: [hidden.sign * size for size in sizes]})
    fit = sepcal.fit(model_of(hidden.model), flight, threads=1)
    diagnosis = fit.diagnose()
    own = next((e for e in diagnosis.effects if e.name == hidden.name), None)
    if own is None:
        return Told(False, False, np.nan, np.nan)
    advised = diagnosis.advice.effect is not None
    first = advised and (own is diagnosis.effects[0] or own.beside == "equivalent")
    step = fit.add(hidden.name).history[-1]
    return Told(first, own.status == "found", step.predicted_drop, step.drop)


def is_alarm(kind: str, model: str, seed: int) -> str:
    """The verdict on a flight with nothing hidden."""
    flight = fly(seed, {}, kind)
    return str(sepcal.fit(model_of(model), flight, threads=1).diagnose().verdict)


def run(options: argparse.Namespace, report_progress: Progress) -> Outcome:
    """Every effect at every size, then nothing."""
    findings, figures = [], []
    flights = seed_range(options)
    quiet = range(options.first_seed, options.first_seed + options.null_seeds)
    kinds = [(kind, model) for kind in NOISES for model in ("path", "longitudinal")]
    steps, done = len(EFFECTS) * len(SIZES) + len(kinds), 0
    with ThreadPoolExecutor(options.processes) as pool:
        for hidden in EFFECTS:
            errors = standard_errors(hidden)
            for size in SIZES:
                sizes = [size * error for error in errors]
                told = list(pool.map(lambda seed: tell(hidden, sizes, seed), flights))  # noqa: B023
                first = sum(one.first for one in told)
                found = [one for one in told if one.found]
                kept = sum(abs(one.promised - one.fell) < NEAR for one in found)
                text = (
                    f"first in {first} of {len(told)}, found in {len(found)}, "
                    f"promise kept in {kept} of {len(found)}"
                )
                what = f"{hidden.name} at {size} standard errors"
                figures.append(f"{what}: {text}")
                limits = f"the promise within {NEAR:.0%} of the error"
                findings.append(Finding(what, text, limits, kept == len(found)))
                report_progress((done := done + 1) / steps)
        alarms = 0
        for kind, model in kinds:
            verdicts = list(pool.map(lambda seed: is_alarm(kind, model, seed), quiet))  # noqa: B023
            named = verdicts.count("effect_missing")
            alarms += named
            text = (
                f"{named} of {len(verdicts)} name an effect, "
                f"{verdicts.count('unexplained')} something that none explains"
            )
            figures.append(f"nothing hidden, {model}, {kind}: {text}")
            report_progress((done := done + 1) / steps)
        total = len(kinds) * len(quiet)
        text = f"{alarms} of {total}"
        limits = f"at most {MOST_FALSE:.0%}"
        findings.append(
            Finding("effects named where nothing is hidden", text, limits,
                    alarms <= MOST_FALSE * total)
        )  # fmt: skip
    return Outcome("; ".join(figures), findings)


def add_options(parser: argparse.ArgumentParser) -> None:
    """How many flights."""
    seeds(SEEDS, "flights of each effect and size")(parser)
    text = f"flights with nothing hidden of each noise and model (default: {NULL_SEEDS})"
    parser.add_argument("--null-seeds", type=int, default=NULL_SEEDS, help=text)


STUDY = Study(
    name="trajectories",
    shows="whether effects hidden along trajectories are found, keep what they promise, and are "
    "not found where nothing is hidden",
    run=run,
    options=add_options,
)
