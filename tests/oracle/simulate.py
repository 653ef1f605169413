# SPDX-License-Identifier: BSD-3-Clause
"""Records with a known truth: random smooth inputs, a model's own outputs, white Gaussian noise.

The inputs excite every parameter; they are no flight mechanics. Noise is on the outputs alone.
"""

import numpy as np
from numpy.random import Generator

from oracle.five_hole_probe import FiveHoleProbe
from oracle.magnetometer import Magnetometer
from oracle.model import Array, Model
from oracle.scalar_examples import ScalarExample1, ScalarExample2
from oracle.vane_boom import VaneBoom

SCALAR_1_TRUTH = np.array([1.0, 1.0, 0.1])
SCALAR_2_TRUTH = np.array([1.0, 1.0, 0.05, 0.1])
FIVE_HOLE_TRUTH = np.array([0.05, 0.6, -3.8, 2.4, 0.3, 0.08, -0.035, -0.06, 0.02, 0.05])
MAGNETOMETER_TRUTH = np.array(
    [0.04, -0.03, 0.02, 12.0, -7.0, 3.5, 0.02, -0.015, 0.03, 0.01, -0.02, 0.015]
)

SCALAR_NOISE = np.array([0.3])
FIVE_HOLE_NOISE = np.array([0.15, 0.12, 0.2])  # [m/s]; unequal, so that R matters
MAGNETOMETER_NOISE = np.array([0.3, 0.5, 0.4])  # [uT]

Columns = dict[str, Array]


def simulate_scalar(
    model: ScalarExample1 | ScalarExample2, truth: Array, seed: int, rows: int = 100
) -> Columns:
    """The paper's record: eta from 1 to 10 rad in equal steps, noise of 0.3."""
    rng = np.random.default_rng(seed)
    return measure(rng, model, {"eta": np.linspace(1.0, 10.0, rows)}, truth, SCALAR_NOISE)


def simulate_five_hole(
    model: FiveHoleProbe,
    seed: int,
    rows: int = 200,
    truth: Array = FIVE_HOLE_TRUTH,
    airspeed: float = 15.0,
) -> Columns:
    """A circle in the wind with doublets in every axis, at 10 Hz; the airspeed [m/s] varies."""
    rng = np.random.default_rng(seed)
    motion, speed, alpha, beta = _circle(rng, rows, airspeed)
    rho = np.full(rows, 1.15)
    ps = np.full(rows, 95_000.0)
    dynamic = 0.5 * rho * speed**2
    inputs = motion | {
        "pt": ps + dynamic,
        "ps": ps,
        "dpa": model.k_alpha * dynamic * alpha,
        "dpb": model.k_beta * dynamic * beta,
        "rho": rho,
    }
    return measure(rng, model, inputs, truth, FIVE_HOLE_NOISE)


def simulate_vane_boom(
    model: VaneBoom,
    seed: int,
    rows: int = 200,
    truth: Array = FIVE_HOLE_TRUTH,
    airspeed: float = 15.0,
) -> Columns:
    """The same flight with vanes."""
    rng = np.random.default_rng(seed)
    motion, speed, alpha, beta = _circle(rng, rows, airspeed)
    inputs = motion | {"airspeed": speed, "alpha": alpha, "beta": beta}
    return measure(rng, model, inputs, truth, FIVE_HOLE_NOISE)


def _circle(rng: Generator, rows: int, airspeed: float) -> tuple[Columns, Array, Array, Array]:
    """Attitude and rates, the airspeed and the flow angles."""
    time = 0.1 * np.arange(rows)
    roll, roll_rate = draw_smooth(rng, time, 0.5)
    pitch, pitch_rate = draw_smooth(rng, time, 0.25)
    wander, wander_rate = draw_smooth(rng, time, 0.4)
    turns = 1.5 * 2 * np.pi / (0.1 * rows)
    yaw, yaw_rate = turns * time + wander, turns + wander_rate
    speed = airspeed + draw_smooth(rng, time, 0.2 * airspeed)[0]
    alpha = 0.08 + draw_smooth(rng, time, 0.08)[0]
    beta = draw_smooth(rng, time, 0.08)[0]
    motion = {
        "roll": roll,
        "pitch": pitch,
        "yaw": np.arctan2(np.sin(yaw), np.cos(yaw)),
        "p": roll_rate - yaw_rate * np.sin(pitch),
        "q": pitch_rate * np.cos(roll) + yaw_rate * np.sin(roll) * np.cos(pitch),
        "r": yaw_rate * np.cos(roll) * np.cos(pitch) - pitch_rate * np.sin(roll),
    }
    return motion, speed, alpha, beta


def simulate_magnetometer(
    model: Magnetometer,
    seed: int,
    rows: int = 200,
    truth: Array = MAGNETOMETER_TRUTH,
    pace: float = 1.0,
) -> Columns:
    """A field of 53 uT whose direction in body axes wanders over the whole sphere, at that pace."""
    rng = np.random.default_rng(seed)
    time = 0.1 * np.arange(rows)
    wander = np.stack([draw_smooth(rng, pace * time, 1.0)[0] for _ in range(3)])
    field = 53.0 * wander / np.linalg.norm(wander, axis=0)
    inputs = dict(zip(("hx", "hy", "hz"), field, strict=True))
    return measure(rng, model, inputs, truth, MAGNETOMETER_NOISE)


def draw_smooth(rng: Generator, time: Array, deviation: float) -> tuple[Array, Array]:
    """A sum of five sinusoids of random phase, of the given rms, and its rate, each (N,)."""
    frequency = 2 * np.pi * rng.uniform(0.05, 0.8, size=5)  # [rad/s]
    phase = np.multiply.outer(time, frequency) + rng.uniform(0, 2 * np.pi, size=5)
    amplitude = deviation * np.sqrt(2 / 5)
    return amplitude * np.sin(phase).sum(axis=1), amplitude * (np.cos(phase) @ frequency)


def measure(rng: Generator, model: Model, inputs: Columns, truth: Array, noise: Array) -> Columns:
    """The inputs with the model's outputs beside them, white noise added."""
    exact = model.predict(inputs, truth)
    noisy = exact + noise[:, np.newaxis] * rng.standard_normal(exact.shape)
    return inputs | dict(zip(model.outputs, noisy, strict=True))
