# SPDX-License-Identifier: BSD-3-Clause
"""Equation and output error over a band and in time, in turbulence: are their errors honest?

A longitudinal flight of 40 s at 50 Hz is made here with NumPy: coefficients linear in angle of
attack, pitch rate and elevator, gusts that the aircraft and its vane feel, and readings with noise
(of vane and gyro so little that regressors are known) and, of one case, with drift. Output error is
of short_period_over_a_band.py's flights, beside a maximum likelihood in NumPy.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache

import numpy as np

import sepcal
from sepcal.columns import Array
from studies import short_period_over_a_band as short_period
from studies.study import Finding, Outcome, Progress, Study, seed_range, seeds

STEP = 0.02  # s
ROWS = 2000
SEEDS = 200
INNER = 10  # steps of integration a row
SPEED, RHO = 50.0, 1.1  # m/s, kg/m^3
AIRCRAFT = sepcal.Aircraft(
    area=16.2, chord=1.49, span=10.9, mass=1100.0, inertia=(1285.0, 1825.0, 2667.0, 0.0)
)
TRUTH = {
    "CZ_0": -0.3, "CZ_alpha": -4.8, "CZ_q": -5.0, "CZ_elevator": -0.4,
    "Cm_0": 0.03, "Cm_alpha": -0.9, "Cm_q": -14.0, "Cm_elevator": -1.2,
}  # fmt: skip
JUDGED = [name for name in TRUTH if not name.endswith("_0")]
BAND = (0.1, 2.0)  # Hz
OUTPUT_ERROR_GUSTS = (0.0, 0.0087)  # rad


@dataclass(frozen=True)
class Case:
    """A flight's air and readings; standard deviations."""

    words: str
    gusts: float  # rad, of the angle of attack
    drift: float = 0.0  # m/s^2 and 0.1 rad/s of the inertial unit, after 40 s


CASES = (
    Case("still air", 0.0),
    Case("gusts of 0.5 deg", 0.0087),
    Case("gusts of 1 deg", 0.0175),
    Case("gusts of 0.5 deg, an inertial unit that drifts", 0.0087, 0.3),
)


def coefficients(alpha: float, q: float, elevator: float) -> tuple[float, float]:
    """CZ and Cm."""
    q_hat = q * 1.49 / (2 * SPEED)
    return (
        -0.3 - 4.8 * alpha - 5.0 * q_hat - 0.4 * elevator,
        0.03 - 0.9 * alpha - 14.0 * q_hat - 1.2 * elevator,
    )


@cache
def excitation() -> Array:
    """(ROWS,) [rad]."""
    return sepcal.multisines({"u": 0.04}, duration=ROWS * STEP).signals["u"][:ROWS]


def fly(seed: int, case: Case) -> dict[str, Array]:
    """The columns of a log."""
    rng = np.random.default_rng(seed)
    elevator = excitation() - 0.02
    pressure = 0.5 * RHO * SPEED**2 * 16.2
    alpha, q, gust = 0.06, 0.0, 0.0
    kept = float(np.exp(-STEP / INNER / 0.6))
    shakes = (case.gusts * np.sqrt(1 - kept**2) * rng.standard_normal(ROWS * INNER)).tolist()
    rows = []
    for row, deflection in enumerate(elevator.tolist()):
        CZ, Cm = coefficients(alpha + gust, q, deflection)
        rows.append((alpha + gust, q, pressure * CZ / 1100.0, pressure * 1.49 * Cm / 1825.0))
        for inner in range(INNER):
            CZ, Cm = coefficients(alpha + gust, q, deflection)
            lift = (pressure * CZ / 1100.0 + 9.81) / SPEED
            alpha += STEP / INNER * (q + lift)
            q += STEP / INNER * pressure * 1.49 * Cm / 1825.0
            gust = kept * gust + shakes[row * INNER + inner]
    flown = np.array(rows).T

    def noise(size: float, walks: float = 0.0) -> Array:
        walk = np.cumsum(rng.standard_normal(ROWS)) / np.sqrt(ROWS)
        return np.asarray(size * rng.standard_normal(ROWS) + walks * walk)

    zero = np.zeros(ROWS)
    return {
        "time_s": STEP * np.arange(ROWS),
        "ax_mps2": zero, "ay_mps2": zero,
        "az_mps2": flown[2] + noise(0.05, case.drift),
        "p_radps": zero, "r_radps": zero,
        "q_radps": flown[1] + noise(0.0001, 0.1 * case.drift),
        "qdot_radps2": flown[3] + noise(0.02, 0.3 * case.drift),
        "pdot_radps2": zero, "rdot_radps2": zero,
        "airspeed_mps": np.full(ROWS, SPEED), "beta_rad": zero,
        "alpha_rad": flown[0] + noise(0.0001),
        "elevator_rad": elevator, "rho_kgpm3": np.full(ROWS, RHO),
    }  # fmt: skip


def scaled_errors(seed: int, case: Case) -> Array:
    """(2, 6): (estimate - truth) / standard error, over the band and row by row; (2, 6) sizes."""
    flight = sepcal.Flight(fly(seed, case))
    found = []
    for band in (BAND, None):
        fit = sepcal.fit(sepcal.Aero(AIRCRAFT, "CZ", "Cm", band=band), flight, threads=1)
        off = np.array([fit[name].value - TRUTH[name] for name in JUDGED])
        found.append([off / [fit[name].standard_error for name in JUDGED], off])
    return np.array(found)


def output_errors(seed: int, gusts: float) -> tuple[Array, Array]:
    """(3, 6) scaled errors over the band, by NumPy and in time; (6,) from NumPy's to the band's."""
    read = short_period.fly(seed, gusts)
    band = short_period.by_sepcal(read, short_period.BAND)
    numpy = short_period.by_numpy(read)
    in_time = short_period.by_sepcal(read, None)
    apart = np.abs(band.values - numpy.values) / band.errors
    return np.array([band.scaled(), numpy.scaled(), in_time.scaled()]), apart


def judge_output_error(found: list[tuple[Array, Array]], gusts: float) -> tuple[str, list[Finding]]:
    """Of all seeds; how often intervals hold in gusts is told, and has no limit."""
    scaled, apart = np.array([one for one, _ in found]), np.array([far for _, far in found])
    words = "output error in still air" if gusts == 0.0 else "output error in gusts of 0.5 deg"
    furthest = float(np.max(apart))
    findings = [
        Finding(f"{words}, from NumPy's", f"{furthest:.2f} standard errors", "0.3", furthest < 0.3)
    ]
    ways = []
    for i, way in enumerate(("band", "NumPy", "time")):
        hold = np.mean(np.abs(scaled[:, i]) < 1.96)
        each = " ".join(f"{rms:.2f}" for rms in np.sqrt(np.mean(scaled[:, i] ** 2, axis=0)))
        mean = " ".join(f"{off:+.2f}" for off in np.mean(scaled[:, i], axis=0))
        ways.append(f"{way} {hold:.1%} hold, {each} standard errors rms, {mean} mean")
        if gusts == 0.0:
            kept = 0.92 < hold < 0.98
            findings.append(Finding(f"{words}, {way}", f"{hold:.1%} hold", "92 to 98 %", kept))
    middle = float(np.median(apart))
    return (
        f"{words} of {' '.join(short_period.TRUTH)}: {'; '.join(ways)}; band and NumPy "
        f"{middle:.3f} standard errors apart in the middle, {furthest:.2f} at most",
        findings,
    )


def run(options: argparse.Namespace, report_progress: Progress) -> Outcome:
    """Every case, all seeds."""
    findings, figures = [], []
    steps = len(CASES) + len(OUTPUT_ERROR_GUSTS)
    sizes = np.array([abs(TRUTH[name]) for name in JUDGED])
    with ThreadPoolExecutor(options.processes) as pool:
        for done, case in enumerate(CASES):
            fits = [pool.submit(scaled_errors, seed, case) for seed in seed_range(options)]
            found = np.array([fit.result() for fit in fits])
            words = []
            for i, way in enumerate(("band", "rows")):
                scaled, off = found[:, i, 0], found[:, i, 1]
                rms, hold = np.sqrt(np.mean(scaled**2)), np.mean(np.abs(scaled) < 1.96)
                far = 100 * np.sqrt(np.mean((off / sizes) ** 2, axis=0))
                each = " ".join(f"{size:.2g}" for size in far)
                words.append(
                    f"{way} {hold:.1%} hold, {rms:.2f} standard errors rms, {each} % rms of "
                    f"{' '.join(JUDGED)}"
                )
                if way == "band":
                    kept = 0.92 < hold < 0.98
                    findings.append(Finding(case.words, f"{hold:.1%} hold", "92 to 98 %", kept))
            figures.append(f"{case.words}: {'; '.join(words)}")
            report_progress((done + 1) / steps)
        for done, gusts in enumerate(OUTPUT_ERROR_GUSTS):
            runs = [pool.submit(output_errors, seed, gusts) for seed in seed_range(options)]
            told, judged = judge_output_error([one.result() for one in runs], gusts)
            figures.append(told)
            findings.extend(judged)
            report_progress((len(CASES) + done + 1) / steps)
    return Outcome(". ".join(figures), findings)


STUDY = Study(
    name="frequency-domain",
    shows="how far equation and output error over a band and in time are off in turbulence, how "
    "often their intervals hold, and output error beside NumPy's",
    run=run,
    options=seeds(SEEDS, "flights of each case"),
)
