# SPDX-License-Identifier: BSD-3-Clause
"""Is an inertial unit that is 10 to 20 ms late found along a path, and none where none is?

14 s of a jet's pitch maneuver in gusts, with errors that drift, quantisation and stamps that
jitter (tests/oracle/late_flight.py). The inertial unit and an attitude are told as one family.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import sepcal
from oracle import late_flight
from studies.study import Finding, Outcome, Progress, Study, seed_range, seeds

SEEDS = 30
LATE = 0.010, 0.020  # s, drawn evenly
CONDITIONS = {
    "light gusts": {"gust": 0.3},
    "gusts of 1 m/s and twice the drift": {"gust": 1.0, "drift": 2.0},
    "half the maneuver": {"size": 0.5, "gust": 0.3},
}
LAGS = ("imu_late", "attitude_late")
POOL = (
    *LAGS,
    *("airdata_late", "alpha_late", "gyro_bias[time]", "accel_bias[time]", "wind[time]"),
    *("alpha_bias[time]", "attitude_bias[time]", "gyro_scale", "accel_scale"),
)
HELD = dict.fromkeys(("lambda_v", "b_theta", "b_ay", "b_p", "b_r"), 0.0)
MOST_FALSE = 0.03
LEAST_FOUND = 0.6


def fit_path(flight: sepcal.Flight) -> sepcal.AircraftFit:
    """The longitudinal path by output error."""
    model = sepcal.FlightPath(measured=["v", "phi", "psi"], outputs=["airspeed", "alpha", "pitch"])
    return sepcal.fit(model, flight, fix=HELD, threads=1)


def find_lags(flight: sepcal.Flight) -> list[str]:
    """Which of the two are found."""
    found = fit_path(flight).diagnose(only=POOL).effects
    return [effect.name for effect in found if effect.status == "found" and effect.name in LAGS]


def _run(options: argparse.Namespace, report_progress: Progress) -> Outcome:
    figures: list[str] = []
    findings: list[Finding] = []
    false, flown, done = 0, 0, 0

    def is_found(seed: int, late: bool, condition: str) -> bool:
        lag = np.random.default_rng([seed, 1]).uniform(*LATE) if late else 0.0
        log = late_flight.fly(seed, late=lag, **CONDITIONS[condition])
        return bool(find_lags(sepcal.Flight(log)))

    for condition in CONDITIONS:
        counts = []
        for late in (True, False):
            with ThreadPoolExecutor(options.processes) as pool:
                told = list(
                    pool.map(
                        lambda seed, at=late, how=condition: is_found(seed, at, how),
                        seed_range(options),
                    )
                )
            counts.append(sum(told))
            report_progress((done := done + 1) / (2 * len(CONDITIONS)))
        found, wrong = counts
        false, flown = false + wrong, flown + options.seeds
        text = f"found in {found} of {options.seeds}, where none is in {wrong}"
        figures.append(f"{condition}: {text}")
        if condition == "light gusts":  # the others ask how much less a flight tells
            findings.append(
                Finding(
                    condition,
                    f"{found} of {options.seeds} found",
                    f"at least {LEAST_FOUND:.0%}",
                    found >= LEAST_FOUND * options.seeds,
                )
            )
    findings.append(
        Finding("lags found where none is", f"{false} of {flown}", f"at most {MOST_FALSE:.0%}",
                false <= MOST_FALSE * flown)
    )  # fmt: skip
    return Outcome("; ".join(figures), findings)


STUDY = Study(
    "late-units",
    "whether an inertial unit that is 10 to 20 ms late is found along a path of 14 s, or the"
    " attitude that is early in its place, and none where none is",
    _run,
    seeds(SEEDS, "flights of each condition, with a lag and without"),
)
