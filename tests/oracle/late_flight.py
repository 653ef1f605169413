# SPDX-License-Identifier: BSD-3-Clause
"""A jet's pitch maneuver of 14 s at 50 Hz, read by sensors whose clocks may differ.

Attitude and velocity are smooth functions of time; what an inertial unit reads follows from the
derivatives of their splines, at the time when it is read. Noise is that of flights: gusts, errors
that drift, quantisation, and stamps that jitter.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

Array = NDArray[np.float64]

GRAVITY = 9.80665  # m/s^2
DURATION, RATE = 14.0, 50.0  # s, Hz
STEP = 0.005  # s, of the motion
GUST_TIME = 1.5  # s
QUANTA = {  # of the readings; their white noise is about twice as large, drift half
    **dict.fromkeys(("ax_mps2", "ay_mps2", "az_mps2"), 0.02),
    **dict.fromkeys(("p_radps", "q_radps", "r_radps"), 0.0006),
    **dict.fromkeys(("roll_rad", "pitch_rad", "yaw_rad"), 0.0005),
    **dict.fromkeys(("alpha_rad", "beta_rad"), 0.0006),
    "airspeed_mps": 0.03,
}
BIAS = {"ax_mps2": -0.05, "az_mps2": -0.04, "q_radps": 0.0018}  # of the readings


def gauss_markov(draws: np.random.Generator, rows: int, step: float, time: float) -> Array:
    """Of unit variance, with a correlation time."""
    a = np.exp(-step / time)
    noise = draws.standard_normal(rows)
    noise[1:] *= np.sqrt(1 - a**2)
    for row in range(1, rows):
        noise[row] += a * noise[row - 1]
    return noise


def follow(command: Array, frequency: float, damping: float) -> Array:
    """What an oscillator [rad/s] makes of a command."""
    x, v = np.zeros_like(command), 0.0
    for row in range(1, command.size):
        pull = frequency**2 * (command[row - 1] - x[row - 1]) - 2 * damping * frequency * v
        v += STEP * pull
        x[row] = x[row - 1] + STEP * v
    return x


def doublets(draws: np.random.Generator, t: Array, size: float, width: float, count: int) -> Array:
    """One after another, of random sizes, lengths and signs."""
    command = np.zeros_like(t)
    begin = draws.uniform(0.5, 2.0)
    for _ in range(count):
        long = width * draws.uniform(0.7, 1.4)
        height = draws.choice([-1.0, 1.0]) * size * draws.uniform(0.6, 1.2)
        command[(t > begin) & (t < begin + long)] += height
        command[(t > begin + long) & (t < begin + 2 * long)] -= height
        begin += 2 * long + draws.uniform(0.8, 2.5)
    return command


class Motion:
    """Attitude and velocity through still air, as splines of time."""

    def __init__(self, draws: np.random.Generator, size: float) -> None:
        t = np.arange(-1.0, DURATION + 1.0, STEP)
        rate = follow(follow(doublets(draws, t, 0.25 * size, 0.9, 4), 3.0, 0.6), 12.0, 0.8)
        climb = np.cumsum(rate) * STEP
        theta = 0.2 + climb - climb.mean()
        alpha = 0.25 + 0.6 * follow(climb - climb.mean(), 1.5, 0.5)
        speed = 95.0 - 6.0 * (theta - theta.mean())
        speed += 3.0 * np.sin(2 * np.pi * t / draws.uniform(15, 30) + draws.uniform(0, 6))
        phi = np.cumsum(follow(doublets(draws, t, 0.08 * size, 0.8, 1), 2.0, 0.6)) * STEP
        beta = follow(follow(doublets(draws, t, 0.02 * size, 0.7, 3), 2.0, 0.4), 10.0, 0.8)
        psi = 0.5 + np.cumsum(0.1 * np.sin(phi)) * STEP
        psi += follow(doublets(draws, t, 0.05 * size, 0.8, 2), 1.5, 0.5)
        self.attitude = CubicSpline(t, np.column_stack([phi, theta, psi]))
        flow = [np.cos(alpha) * np.cos(beta), np.sin(beta), np.sin(alpha) * np.cos(beta)]
        self.velocity = CubicSpline(t, np.column_stack([speed * part for part in flow]))
        gusts = [gauss_markov(draws, t.size, STEP, GUST_TIME) for _ in range(3)]
        self.gust = CubicSpline(t, np.column_stack(gusts))

    def unit(self, t: Array) -> Array:
        """What it reads: specific forces, rates; shape (6, N)."""
        phi, theta, _ = self.attitude(t).T
        dphi, dtheta, dpsi = self.attitude(t, 1).T
        turn = np.array(
            [
                dphi - dpsi * np.sin(theta),
                dtheta * np.cos(phi) + dpsi * np.cos(theta) * np.sin(phi),
                dpsi * np.cos(theta) * np.cos(phi) - dtheta * np.sin(phi),
            ]
        )
        down = [-np.sin(theta), np.cos(theta) * np.sin(phi), np.cos(theta) * np.cos(phi)]
        speeding = self.velocity(t, 1).T + np.cross(turn, self.velocity(t).T, axis=0)
        return np.concatenate([speeding - GRAVITY * np.array(down), turn])


def fly(
    seed: int,
    *,
    late: float = 0.0,
    attitude_late: float = 0.0,
    size: float = 1.0,
    gust: float = 0.3,
    drift: float = 1.0,
    jitter: float = 0.002,
) -> dict[str, Array]:
    """By header. The inertial unit and the attitude are late by so much [s].

    `size`: of the maneuver; `gust`: m/s, each component; `drift`: of slow errors beside usual ones;
    `jitter`: of the times when sensors are read [s]. Alpha reads 8 %, pitch 4 % too much.
    """
    draws = np.random.default_rng(seed)
    motion = Motion(draws, size)
    t = np.arange(0.0, DURATION, 1.0 / RATE)

    def read_at(delay: float = 0.0) -> Array:
        return t - delay + jitter * draws.uniform(-1, 1, t.size)

    true = dict(zip(list(QUANTA)[:6], motion.unit(read_at(late)), strict=True))
    phi, theta, psi = motion.attitude(read_at(attitude_late)).T
    true |= {"roll_rad": phi, "pitch_rad": 1.04 * theta, "yaw_rad": psi}
    at = read_at()
    u, v, w = (motion.velocity(at) - gust * motion.gust(at)).T
    speed = np.sqrt(u**2 + v**2 + w**2)
    true |= {"airspeed_mps": speed, "alpha_rad": 1.08 * np.arctan2(w, u)}
    true |= {"beta_rad": np.arcsin(v / speed)}
    log = {"time_s": t}
    for name, values in true.items():
        quantum = QUANTA[name]
        error = 2.0 * draws.standard_normal(t.size)
        error += (0.5 if name in BIAS else 2.0) * drift * gauss_markov(draws, t.size, 1 / RATE, 7.0)
        read = values + BIAS.get(name, 0.0) + quantum * error
        log[name] = np.round(read / quantum) * quantum
    return log
