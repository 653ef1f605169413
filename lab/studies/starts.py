# SPDX-License-Identifier: BSD-3-Clause
"""Filters that start from the first rows of a flight: how often their intervals hold the truth.

A short period flies 120 s at 50 Hz, driven by its elevator and by white noise of 0 to 3 times the
gyro's. The first rows are fitted, and a recursive estimator goes on from there; 95 % intervals of
the five derivatives are counted at the start and 1, 10 and 60 s after it. RLS, which knows of no
noise in the states, is shown beside the others, and nothing is asked of it.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm, solve_continuous_lyapunov

import sepcal
from studies.study import Finding, Outcome, Progress, Study, seed_range, seeds

Array = NDArray[np.float64]

SEEDS = 200  # flights of each size of process noise
RATE, SPAN = 50, 120.0  # Hz, s
SIZES = (0.0, 0.3, 1.0, 3.0)  # rms of the pitch rate that process noise makes, in the gyro's noise
ROWS = (100, 300, 1000)  # of the start
METHODS = ("ekf", "iekf", "srif", "rml", "rls")
AFTER = (0.0, 1.0, 10.0, 60.0)  # s
LEAST, MOST = 0.90, 0.98

TRUTH = {"Za": -1.2, "Ma": -6.0, "Mq": -1.8, "Zd": -0.12, "Md": -9.0}
NOISE = {"alpha_m": 0.005, "q_m": 0.01, "az_m": 0.15}
AIRSPEED = 60.0  # m/s
A = np.array([[TRUTH["Za"], 1.0], [TRUTH["Ma"], TRUTH["Mq"]]])
B = np.array([TRUTH["Zd"], TRUTH["Md"]])
SHAPE = np.array([0.1, 1.0])  # of the noise in alpha' and q'
_RMS = np.sqrt(solve_continuous_lyapunov(A, -np.diag(SHAPE**2))[1, 1])
DENSITY = SHAPE * NOISE["q_m"] / _RMS  # roots, at size 1


def deflect(rng: np.random.Generator, time: Array) -> Array:
    """The elevator [rad]: a 3-2-1-1 of its own pace every 6 s, on a slow drift."""
    elevator = 1e-4 * np.cumsum(rng.standard_normal(time.size))
    for start in np.arange(0.5, SPAN, 6.0):
        step = rng.uniform(0.25, 0.4)
        sign = rng.choice([-1.0, 1.0])
        for k, (begin, length) in enumerate(((0, 3), (3, 2), (5, 1), (6, 1))):
            during = (time >= start + begin * step) & (time < start + (begin + length) * step)
            elevator[during] = sign * (-1) ** k * 0.04
    return elevator


def fly(seed: int, size: float) -> dict[str, Array]:
    """The columns of a flight; the states go on by four exact steps a row."""
    rng = np.random.default_rng([seed, round(100 * size)])
    time = np.arange(int(SPAN * RATE)) / RATE
    elevator = deflect(rng, time)
    parts = 4
    step = 1.0 / RATE / parts
    Phi = expm(A * step)
    Gamma = np.linalg.solve(A, Phi - np.eye(2)) @ B
    states = np.zeros((time.size, 2))
    x = rng.standard_normal(2) * [0.01, 0.02]
    for k in range(time.size):
        states[k] = x
        slope = elevator[min(k + 1, time.size - 1)] - elevator[k]
        for part in range(parts):
            driven = Gamma * (elevator[k] + slope * (part + 0.5) / parts)
            x = Phi @ x + driven + size * DENSITY * np.sqrt(step) * rng.standard_normal(2)
    alpha, q = states.T
    force = AIRSPEED * (TRUTH["Za"] * alpha + TRUTH["Zd"] * elevator)
    read = {"alpha_m": alpha + 0.003, "q_m": q - 0.004, "az_m": force + 0.1}
    noisy = {name: z + NOISE[name] * rng.standard_normal(z.size) for name, z in read.items()}
    airspeed = np.full(time.size, AIRSPEED)
    return {"time": time, "elevator": elevator, "airspeed": airspeed, **noisy}


@dataclass
class Tally:
    """Of one size, number of rows and method."""

    refused: int = 0
    errors: list[Array] = field(default_factory=list)  # in standard errors, (times, parameters)


def track(data: Mapping[str, Array], size: float, rows: int, method: str) -> Array | None:
    """Errors in their standard errors, (times, parameters); None where the start is refused."""
    given: dict[str, Mapping[str, float]] = {} if method == "rml" else {"noise": NOISE}
    if size > 0.0 and method not in ("rls", "rml"):
        given["process_noise"] = dict(zip(("alpha", "q"), size * DENSITY, strict=True))
    try:
        found = sepcal.track(sepcal.ShortPeriod(), data, start_rows=rows, method=method, **given)  # type: ignore[arg-type]
    except sepcal.Error:
        return None
    places = [min(int(after * RATE), len(found.rows) - 1) for after in AFTER]
    off = [(found[name] - true)[places] for name, true in TRUTH.items()]
    sd = [found.standard_deviation(name)[places] for name in TRUTH]
    return np.asarray(np.array(off).T / np.array(sd).T)


def run(options: argparse.Namespace, report_progress: Progress) -> Outcome:
    """Every size, number of rows and method, on the same flights."""
    kinds = [kind for kind in product(SIZES, ROWS, METHODS) if kind[0] > 0.0 or kind[2] != "rml"]
    tallies = {kind: Tally() for kind in kinds}

    def fly_one(seed: int) -> None:
        for size in SIZES:
            data = fly(seed, size)
            for kind in kinds:
                if kind[0] != size:
                    continue
                errors = track(data, *kind)
                if errors is None:
                    tallies[kind].refused += 1
                else:
                    tallies[kind].errors.append(errors)

    with ThreadPoolExecutor(options.processes) as pool:
        for done, _ in enumerate(pool.map(fly_one, seed_range(options))):
            report_progress((done + 1) / options.seeds)
    findings = []
    for (size, rows, method), tally in tallies.items():
        what = f"{method}, process noise {size:g}, {rows} rows"
        if not tally.errors:
            findings.append(Finding(what, f"all {tally.refused} starts refused", "shown", True))
            continue
        holds = np.mean(np.abs(np.array(tally.errors)) < 1.96, axis=(0, 2))
        words = ", ".join(f"{100 * share:.1f}" for share in holds)
        chance = 2.0 * np.sqrt(0.05 * 0.95 / len(tally.errors))
        asked = method != "rls"
        right = not asked or bool(np.all((holds >= LEAST - chance) & (holds <= MOST + chance)))
        refused = f"; {tally.refused} starts refused" if tally.refused else ""
        limits = "90 to 98 %, and chance" if asked else "shown"
        findings.append(Finding(what, f"{words} % hold{refused}", limits, right))
    worst = min(
        float(np.min(np.mean(np.abs(np.array(tally.errors)) < 1.96, axis=(0, 2))))
        for (_, _, method), tally in tallies.items()
        if method != "rls" and tally.errors
    )
    figures = (
        f"{options.seeds} flights each, {len(kinds)} kinds; the least that hold of all but RLS's: "
        f"{100 * worst:.1f} %"
    )
    return Outcome(figures, findings)


STUDY = Study(
    name="starts",
    shows="how often intervals hold of filters that start from a flight's first rows, with noise "
    "that drives the states",
    run=run,
    options=seeds(SEEDS, "flights of each size of process noise"),
)
