# SPDX-License-Identifier: BSD-3-Clause
"""Flight paths behind a noisy inertial unit: are their errors honest?

A flight of 40 s at 50 Hz is made here with NumPy: smooth speed, flow and attitude angles, from
which forces and rates follow exactly; then the readings of sensors with biases, scales and noise.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

import sepcal
from sepcal.columns import Array
from studies.study import Finding, Outcome, Progress, Study, seed_range, seeds

GRAVITY = 9.80665
STEP = 0.02  # s
ROWS = 2001
SEEDS = 40
TRUTH = {
    "b_ax": 0.05, "b_ay": -0.03, "b_az": 0.08, "b_p": 0.002, "b_q": -0.001, "b_r": 0.0015,
    "w_n": 3.0, "w_e": -2.0, "w_d": 0.3,
    "lambda_v": 0.02, "lambda_alpha": 0.03, "lambda_beta": -0.05,
    "lambda_phi": 0.0, "lambda_theta": 0.0, "lambda_psi": 0.0,
    "b_beta": 0.004, "b_phi": 0.001, "b_theta": -0.002,
}  # fmt: skip
READS = {
    "airspeed_mps": 0.3, "alpha_rad": 0.004, "beta_rad": 0.004,
    "roll_rad": 0.003, "pitch_rad": 0.003, "yaw_rad": 0.004,
    "vn_mps": 0.1, "ve_mps": 0.1, "vd_mps": 0.1,
}  # fmt: skip
RATES = ("p", "q", "r")


@dataclass(frozen=True)
class Unit:
    """An inertial unit: noise of its readings, and how they are fitted."""

    words: str
    force: float  # m/s^2 a sample
    rate: float  # rad/s a sample
    correlated: float = 0.0  # s
    shoot: float | None = None  # s
    allowed_for: bool = True
    most: float = 1.25  # root mean square of errors over standard errors


UNITS = (
    Unit("no noise", 0.0, 0.0),
    Unit("0.014 m/s^2, 0.0007 rad/s", 0.014, 0.0007),
    Unit("0.05 m/s^2, 0.002 rad/s", 0.05, 0.002),
    Unit("the same, not allowed for", 0.05, 0.002, allowed_for=False, most=np.inf),
    Unit("the same in pieces of 2 s", 0.05, 0.002, shoot=2.0),
    Unit("0.02 m/s^2, 0.001 rad/s, smoothed over 0.1 s, not seen", 0.02, 0.001, 0.1, most=np.inf),
    Unit("the same in pieces of 2 s", 0.02, 0.001, 0.1, shoot=2.0, most=np.inf),
)


class Wave:
    """A sum of sines with its slope."""

    def __init__(
        self, rng: np.random.Generator, sizes: Sequence[float], hertz: Sequence[float], mean: float
    ) -> None:
        self.phases = rng.uniform(0.0, 2 * np.pi, len(sizes))
        self.sizes, self.mean = np.array(sizes), mean
        self.turning = 2 * np.pi * np.array(hertz)

    def __call__(self, time: Array) -> Array:
        """(N,) at times (N,)."""
        waves = np.sin(np.outer(time, self.turning) + self.phases)
        return np.asarray(self.mean + waves @ self.sizes)

    def slope(self, time: Array) -> Array:
        """(N,) [1/s]."""
        waves = np.cos(np.outer(time, self.turning) + self.phases)
        return np.asarray(waves @ (self.sizes * self.turning))


def fly(seed: int, unit: Unit) -> dict[str, Array]:
    """The columns of a log."""
    rng = np.random.default_rng(seed)
    time: Array = np.linspace(0.0, (ROWS - 1) * STEP, ROWS)
    roll = Wave(rng, [0.35, 0.15], [0.06, 0.17], 0.0)
    pitch = Wave(rng, [0.08, 0.05], [0.08, 0.23], 0.05)
    yaw = Wave(rng, [0.6, 0.3], [0.025, 0.09], 0.0)
    speed = Wave(rng, [3.0, 1.5], [0.03, 0.11], 45.0)
    alpha = Wave(rng, [0.03, 0.02], [0.12, 0.31], 0.06)
    beta = Wave(rng, [0.03, 0.02], [0.1, 0.27], 0.0)

    def air(at: Array) -> Array:
        a, b = alpha(at), beta(at)
        flow = np.array([np.cos(a) * np.cos(b), np.sin(b), np.sin(a) * np.cos(b)])
        return np.asarray(speed(at) * flow)

    body = air(time)
    change = (air(time + 1e-5) - air(time - 1e-5)) / 2e-5
    (sr, cr), (sp, cp), (sy, cy) = ((np.sin(x(time)), np.cos(x(time))) for x in (roll, pitch, yaw))
    turn = np.array(
        [
            roll.slope(time) - sp * yaw.slope(time),
            pitch.slope(time) * cr + yaw.slope(time) * cp * sr,
            yaw.slope(time) * cp * cr - pitch.slope(time) * sr,
        ]
    )
    down = np.array([-sp, sr * cp, cr * cp])  # of the earth, in body axes
    force = change + np.cross(turn, body, axis=0) - GRAVITY * down
    u, v, w = body
    ground = np.array(
        [
            cp * cy * u + (sr * sp * cy - cr * sy) * v + (cr * sp * cy + sr * sy) * w,
            cp * sy * u + (sr * sp * sy + cr * cy) * v + (cr * sp * sy - sr * cy) * w,
            np.sum(down * body, axis=0),
        ]
    )
    true = dict(zip(READS, (speed(time), alpha(time), beta(time)), strict=False))
    scaled = {"airspeed_mps": "v", "alpha_rad": "alpha", "beta_rad": "beta"}
    columns = {name: (1 + TRUTH[f"lambda_{scaled[name]}"]) * true[name] for name in true}
    columns["beta_rad"] += TRUTH["b_beta"]
    columns |= {
        "roll_rad": roll(time) + TRUTH["b_phi"],
        "pitch_rad": pitch(time) + TRUTH["b_theta"],
    }
    columns["yaw_rad"] = yaw(time)
    for axis, name in enumerate(("vn", "ve", "vd")):
        columns[f"{name}_mps"] = ground[axis] + TRUTH[f"w_{name[1]}"]
    for name, noise in READS.items():
        columns[name] = columns[name] + noise * rng.standard_normal(ROWS)
    for axis, name in enumerate(("ax", "ay", "az")):
        reading = force[axis] - TRUTH[f"b_{name}"]
        columns[f"{name}_mps2"] = reading + unit.force * draw(rng, unit.correlated)
    for axis, name in enumerate(RATES):
        reading = turn[axis] - TRUTH[f"b_{name}"]
        columns[f"{name}_radps"] = reading + unit.rate * draw(rng, unit.correlated)
    return {"time_s": time, **columns}


def draw(rng: np.random.Generator, correlated: float) -> Array:
    """(ROWS,), white or of first order, standard deviation 1."""
    noise = rng.standard_normal(ROWS)
    if correlated == 0.0:
        return noise
    kept = np.exp(-STEP / correlated)
    for row in range(1, ROWS):
        noise[row] = kept * noise[row - 1] + np.sqrt(1 - kept**2) * noise[row]
    return noise


def scaled_errors(seed: int, unit: Unit) -> Array:
    """(estimate - truth) / standard error, (18,)."""
    model = sepcal.FlightPath() if unit.shoot is None else sepcal.FlightPath(shoot=unit.shoot)
    noise = None if unit.allowed_for else {"ax": 1e-12}
    fit = sepcal.fit(model, sepcal.Flight(fly(seed, unit)), process_noise=noise, threads=1)
    return np.array(
        [(fit[name].value - true) / fit[name].standard_error for name, true in TRUTH.items()]
    )


def run(options: argparse.Namespace, report_progress: Progress) -> Outcome:
    """Every unit, all seeds."""
    findings, figures = [], []
    with ThreadPoolExecutor(options.processes) as pool:
        for done, unit in enumerate(UNITS):
            fits = [pool.submit(scaled_errors, seed, unit) for seed in seed_range(options)]
            off = np.array([fit.result() for fit in fits])
            rms, hold = float(np.sqrt(np.mean(off**2))), float(np.mean(np.abs(off) < 1.96))
            text = f"{rms:.2f} standard errors in the rms, {hold:.0%} of intervals hold"
            figures.append(f"{unit.words}: {text}")
            if np.isfinite(unit.most):
                limits = f"0.8 to {unit.most:g} in the rms"
                findings.append(Finding(unit.words, text, limits, 0.8 < rms < unit.most))
            report_progress((done + 1) / len(UNITS))
    return Outcome("; ".join(figures), findings)


STUDY = Study(
    name="path",
    shows="how far a flight path's parameters are off where the inertial unit is noisy, and how "
    "often their intervals hold",
    run=run,
    options=seeds(SEEDS, "flights of each unit"),
)
