# SPDX-License-Identifier: BSD-3-Clause
"""Fleets of 60 vehicles with 20 flights each: what is found in them, and what is found in none.

Flights of a tube are simulated one by one, in white noise, in noise that wanders (a Gauss-Markov
process of 60 s in the airspeed and in the velocities, as large as the white noise) or in gusts
(0.25 m/s of 3 s in the velocities), both on a coarse airspeed, and reduced at their true values.
Fleets are drawn from these triangles: each flight keeps its columns and, up to a sign, its own
noise; the vehicle's parameters and the hidden effect join its residual. That this equals flights
simulated with the effect is a finding of its own. The sign takes away what noise in an input pulls
all flights by; pulled() keeps it.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

import sepcal
from sepcal import _core
from sepcal.fleet.store import factor_of
from studies.study import Finding, Outcome, Progress, Study, seed_range, seeds
from studies.trust.noises import gauss_markov

Array = NDArray[np.float64]

FLEETS = 100  # of each kind
VEHICLES, FLIGHTS = 60, 20
POOL = VEHICLES * FLIGHTS  # flights that fleets are drawn from
ROWS = 600  # at 5 Hz
SPREAD = {"s_va": 0.02, "c_va": 0.3}  # of parameters between vehicles
WIND = ["w_n", "w_e", "w_d"]
HIDDEN = (
    "pressure_offset[throttle]",
    "wind[altitude_m]",
    "airspeed_bias[r]",
    "airspeed_scale[flap]",
)
AGE = 365.0  # days, over which a vehicle's flights are spread
SEASON, WEATHER = 10.0, 4.0  # K, of flights about the year's mean
WARM = {  # candidates, and what each is in a flight at one temperature
    "airspeed_scale[temp_k]": "s_va",
    "airspeed_bias[temp_k]": "c_va",
    "pressure_offset[temp_k]": "pressure_offset",
}
DRIFT = 0.01  # of the scale, over the year or the season's amplitude
LEVEL = 0.01
WHITE = 0.15  # m/s, the airspeed's noise in simulate()
NOISES: dict[str, dict[str, tuple[float, float]]] = {  # beside white noise: size [m/s], memory [s]
    "white": {},
    "wandering": {"airspeed_mps": (WHITE, 60.0), "vn_mps": (0.1, 60.0), "ve_mps": (0.1, 60.0)},
    "gusty": {"vn_mps": (0.25, 3.0), "ve_mps": (0.25, 3.0)},  # of air that the wind has not
}


def fly(seed: int, noise: str, hide: dict[str, float] | None = None) -> sepcal.Flight:
    """A flight; what wanders is added to what was simulated."""
    rng = np.random.default_rng([seed, 45])
    wind = {"w_n": float(rng.normal(0.0, 4.0)), "w_e": float(rng.normal(0.0, 4.0))}
    flown = sepcal.simulate("pitot-static", rows=ROWS, seed=seed, parameters=wind, hide=hide)
    columns = {name: np.array(values) for name, values in flown.items()}
    for name, (size, memory) in NOISES[noise].items():
        columns[name] = columns[name] + size * gauss_markov(memory)(rng, columns["time_s"])
    if NOISES[noise]:
        columns["airspeed_mps"] = np.round(columns["airspeed_mps"], 1)
    return sepcal.Flight(columns)


TRUTH = {"s_va": 0.95, "c_va": -0.6}


def reduce_flight(
    seed: int, noise: str, hide: dict[str, float] | None = None
) -> _core.FlightFactor | None:
    """Its triangle at the true parameters; None where it can't be calibrated."""
    flight = fly(seed, noise, hide)
    try:
        core = sepcal.fit(sepcal.PitotStatic(), flight, threads=1).core
        names = _core.list_fleet_candidates(core, flight._core)
        return _core.reduce(core, flight._core, WIND, TRUTH, names, {})
    except sepcal.Error:
        return None


@dataclass(frozen=True)
class Pool:
    """Flights that fleets are drawn from."""

    factors: list[_core.FlightFactor]

    def columns(self, effect: str) -> list[int]:
        """Places of the effect's coefficients among a triangle's columns."""
        first = self.factors[0]
        p = len(first.parameters)
        return [p + k for k, (name, *_) in enumerate(first.columns) if name == effect]

    def flight_error(self, effect: str) -> float:
        """What flights scatter by in the effect's first coefficient, of a typical flight."""
        estimates = []
        weights = []
        for factor in self.factors:
            T = np.asarray(factor.triangle)
            p = len(factor.parameters)
            G = T[:, [*range(p), *self.columns(effect)]]
            information = G.T @ G
            solution = np.linalg.lstsq(G, T[:, -1], rcond=None)[0]
            estimates.append(solution[p])
            weights.append(1.0 / np.linalg.pinv(information)[p, p])
        pulls = np.array(estimates) * np.sqrt(weights)
        scatter = 1.4826 * np.median(np.abs(pulls - np.median(pulls)))
        return float(max(1.0, scatter) / np.sqrt(np.median(weights)))


def make_pool(noise: str, processes: int | None, count: int = POOL) -> Pool:
    """Flights with all candidates alike."""
    with ProcessPoolExecutor(processes) as workers:
        found = list(workers.map(partial(reduce_flight, noise=noise), range(count), chunksize=8))
    factors = [factor for factor in found if factor is not None]
    typical = max((tuple(f.columns) for f in factors[:20]), key=len)
    return Pool([factor for factor in factors if tuple(factor.columns) == typical])


def draw(
    pool: Pool,
    rng: np.random.Generator,
    *,
    everywhere: dict[str, float] | None = None,
    in_vehicles: tuple[str, float, Sequence[int]] | None = None,
    ages: dict[str, float] | None = None,
    seasons: bool = False,
    thetas: list[Array] | None = None,
) -> list[tuple[str, str, _core.FlightFactor, dict[str, float]]]:
    """A fleet: what is hidden in all, in some vehicles, or grows with a flight's age.

    With `seasons` flights are as warm as the time of the year has it, and as the weather has it.
    `thetas` takes each vehicle's parameters, less those that the pool was reduced at.
    """
    p = len(pool.factors[0].parameters)
    names = list(pool.factors[0].parameters)
    fleet = []
    for vehicle in range(VEHICLES):
        moved = np.array([SPREAD[name] * rng.standard_normal() for name in names])
        if thetas is not None:
            thetas.append(moved)
        for number in range(FLIGHTS):
            factor = pool.factors[int(rng.integers(len(pool.factors)))]
            T = np.array(factor.triangle)
            age = float(rng.uniform(0.0, AGE))
            theta = moved + np.array([(ages or {}).get(name, 0.0) * age for name in names])
            T[:, -1] = rng.choice([-1.0, 1.0]) * T[:, -1] + T[:, :p] @ theta
            if seasons:
                warmer = SEASON * np.sin(2.0 * np.pi * age / AGE) + WEATHER * rng.standard_normal()
                for effect, name in WARM.items():  # about the mean of the fleet
                    constant = names.index(name) if name in names else pool.columns(name)[0]
                    T[:, pool.columns(effect)[0]] += warmer * T[:, constant]
            hidden = dict(everywhere or {})
            if in_vehicles and vehicle in in_vehicles[2]:
                hidden[in_vehicles[0]] = in_vehicles[1]
            for effect, size in hidden.items():
                T[:, -1] += size * T[:, pool.columns(effect)[0]]
            made = factor_of(dict(factor._asdict()) | {"triangle": T})
            name = f"{vehicle}-{number}"
            fleet.append((name, f"v{vehicle:02d}", made, {"age_days": age}))
    return fleet


def what_shows(error: float, tests: float) -> float:
    """The size that a test of this error finds 19 times in 20, at the level and so many tests."""
    return float(error * (norm.isf(LEVEL / (2.0 * tests)) + norm.isf(0.05)))


def run_one(seed: int, pool: Pool, kind: str, errors: dict[str, float]) -> tuple[bool, int]:
    """Whether what is hidden was found where it is, and how much else was."""
    rng = np.random.default_rng([seed, 4545])
    effect = HIDDEN[seed % len(HIDDEN)]
    tests = len({name for name, *_ in pool.factors[0].columns})
    one_flight = what_shows(errors[effect], tests)
    one_vehicle = what_shows(errors[effect] / math.sqrt(FLIGHTS), tests)
    sign = float(rng.choice([-1.0, 1.0]))
    if kind == "nothing":
        found = _core.diagnose_fleet(draw(pool, rng), LEVEL, 8).found
        return not found, len(found)
    if kind == "everywhere":
        size = sign * one_flight / 5.0
        found = _core.diagnose_fleet(draw(pool, rng, everywhere={effect: size}), LEVEL, 8).found
        hits = [one for one in found if effect in (one.effect, *one.as_good)]
        return bool(hits), len(found) - len(hits)
    if kind == "vehicles":
        chosen = sorted(rng.choice(VEHICLES, 3, replace=False).tolist())
        hidden = (effect, sign * 2.0 * one_vehicle, chosen)
        found = _core.diagnose_fleet(draw(pool, rng, in_vehicles=hidden), LEVEL, 8).found
        named = {one.vehicle for one in found if one.vehicle}
        wanted = {f"v{vehicle:02d}" for vehicle in chosen}
        return named == wanted, sum(one.effect != effect for one in found)
    # A scale that ages, or one that follows the temperature, where both go with the season.
    by_age, by_warmth = "s_va[age_days]", "airspeed_scale[temp_k]"
    if kind == "ages":
        fleet = draw(pool, rng, ages={"s_va": sign * DRIFT / AGE}, seasons=True)
    else:
        fleet = draw(pool, rng, everywhere={by_warmth: sign * DRIFT / SEASON}, seasons=True)
    cause, other = (by_age, by_warmth) if kind == "ages" else (by_warmth, by_age)
    found = _core.diagnose_fleet(fleet, LEVEL, 8).found
    effects = [one.effect for one in found]
    return cause in effects[:1] and other not in effects, len(found) - 1


def apart(seed: int, noise: str, effect: str, size: float) -> float:
    """How far a flight simulated with the effect is from one drawn with it, in standard errors."""
    estimates = []
    for hide in (None, {effect: size}):
        factor = reduce_flight(seed, noise, hide)
        assert factor is not None
        T = np.array(factor.triangle)
        p = len(factor.parameters)
        columns = [p + k for k, (name, *_) in enumerate(factor.columns) if name == effect]
        if hide is None:
            T[:, -1] += size * T[:, columns].sum(axis=1)  # simulate() gives all components the size
        X = T[:, [*range(p), *columns]]
        estimates.append(np.linalg.lstsq(X, T[:, -1], rcond=None)[0][p])
        error = float(np.sqrt(np.linalg.pinv(X.T @ X)[p, p]))
    return float((estimates[1] - estimates[0]) / error)


def cover(seed: int, pool: Pool) -> dict[str, tuple[int, int]]:
    """Of 95 % intervals how many hold: of means, vehicles, and one whose prior is the fleet."""
    rng = np.random.default_rng([seed, 4546])
    truth: list[Array] = []
    fleet = draw(pool, rng, thetas=truth)
    found = _core.fit_population(fleet, False, np.zeros(0))
    centre = np.asarray(pool.factors[0].values)
    mean, of_mean = np.asarray(found.mean), np.asarray(found.mean_covariance)
    means = np.abs(mean - centre) < 1.96 * np.sqrt(np.diag(of_mean))
    off = np.abs(np.asarray(found.shrunken).T - (centre + np.array(truth)))
    vehicles = off < 1.96 * np.asarray(found.shrunken_errors).T
    new = np.array([SPREAD[name] * rng.standard_normal() for name in found.parameters])
    factor = pool.factors[int(rng.integers(len(pool.factors)))]
    T = np.array(factor.triangle)
    p = len(new)
    z = rng.choice([-1.0, 1.0]) * T[:, -1] + T[:, :p] @ new
    known = np.diag(1.0 / np.diag(np.asarray(found.spread) + of_mean))
    alone = np.linalg.lstsq(T[:, :p], z, rcond=None)[0]
    scale = np.diag(1.0 / np.sqrt(found.inflation))
    flown = scale @ T[:, :p].T @ T[:, :p] @ scale
    covariance = np.linalg.inv(flown + known)
    estimate = covariance @ (flown @ alone + known @ (mean - centre))
    one = np.abs(estimate - new) < 1.96 * np.sqrt(np.diag(covariance))
    return {
        "means": (int(means.sum()), means.size),
        "vehicles": (int(vehicles.sum()), vehicles.size),
        "a new vehicle": (int(one.sum()), one.size),
    }


def agreement(noise: str, errors: dict[str, float], tests: float) -> Finding:
    """Of 40 flights with each effect as large as fleets have it in all vehicles."""
    found = [
        apart(seed, noise, effect, what_shows(errors[effect], tests) / 5.0)
        for effect in HIDDEN
        for seed in range(10)
    ]
    rms = float(np.sqrt(np.mean(np.square(found))))
    return Finding(
        f"{noise}: flights drawn and simulated differ, rms",
        f"{rms:.3f} errors",
        "at most 0.15",  # a coarse airspeed rounds otherwise with the effect in it
        rms <= 0.15,
    )


def pulled(noise: str, pool: Pool) -> Finding:
    """All flights as they are, one fleet: what is found, and whether weights are told to matter."""
    rng = np.random.default_rng(45)
    fleet = [
        (f"f{k}", f"v{k % VEHICLES}", factor, {"age_days": float(rng.uniform(0.0, AGE))})
        for k, factor in enumerate(pool.factors)
    ]
    told = _core.diagnose_fleet(fleet, LEVEL, 8)
    share = 1.0 - told.misfit_after / told.misfit_before
    return Finding(
        f"{noise}: of {len(fleet)} flights as they are, found with nothing hidden",
        f"{len(told.found)}, {100 * share:.2g} % of the misfit, "
        f"{'told' if told.notes else 'not told'} of weights",
        "told where any is",
        bool(told.notes) or not told.found,
    )


def run(arguments: argparse.Namespace, progress: Progress) -> Outcome:
    """Draws all kinds in each noise."""
    numbers = seed_range(arguments)
    findings = []
    words = []
    kinds = ("nothing", "everywhere", "vehicles", "ages", "warmth")
    for place, noise in enumerate(NOISES):
        pool = make_pool(noise, arguments.processes)
        errors = {effect: pool.flight_error(effect) for effect in HIDDEN}
        tests = len({name for name, *_ in pool.factors[0].columns})
        findings += [agreement(noise, errors, tests), pulled(noise, pool)]
        with ProcessPoolExecutor(arguments.processes) as workers:
            twice = [*numbers, *(number + 100_000 for number in numbers)]
            covered = list(workers.map(partial(cover, pool=pool), twice, chunksize=5))
        for what in covered[0]:
            hits, count = (sum(one[what][k] for one in covered) for k in (0, 1))
            share = hits / count
            findings.append(
                Finding(
                    f"{noise}: 95 % intervals of {what} hold",
                    f"{100 * share:.1f} % of {count}",
                    "92 to 97 %",
                    0.92 <= share <= 0.97,
                )
            )
            words.append(f"{noise}, {what}: {100 * share:.1f} %")
        for step, kind in enumerate(kinds):
            with ProcessPoolExecutor(arguments.processes) as workers:
                work = partial(run_one, pool=pool, kind=kind, errors=errors)
                told = list(workers.map(work, numbers, chunksize=5))
            right = sum(hit for hit, _ in told)
            others = sum(count > 0 for _, count in told)
            n = len(told)
            what = {
                "nothing": "nothing hidden, nothing found",
                "everywhere": "a fifth of what a flight shows, found",
                "vehicles": "three vehicles named, and no other",
                "ages": "a scale that ages, told from the temperature",
                "warmth": "a scale that follows the temperature, told from age",
            }[kind]
            least = math.ceil((0.98 if kind == "nothing" else 0.95) * n)
            findings.append(
                Finding(f"{noise}: {what}", f"{right} of {n}", f"at least {least}", right >= least)
            )
            if kind in ("everywhere", "ages"):
                findings.append(
                    Finding(
                        f"{noise}: {kind}, something else found too",
                        f"{others} of {n}",
                        f"at most {math.floor(0.1 * n)}",
                        others <= 0.1 * n,
                    )
                )
            words.append(f"{noise}, {kind}: {right} of {n}")
            progress((place * len(kinds) + step + 1) / (len(NOISES) * len(kinds)))
    return Outcome("; ".join(words), findings)


STUDY = Study(
    "fleets",
    "What 60 vehicles of 20 flights show together, and how often something that is not there.",
    run,
    seeds(FLEETS, "fleets of each kind"),
)
