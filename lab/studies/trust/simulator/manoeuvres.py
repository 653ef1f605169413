# SPDX-License-Identifier: BSD-3-Clause
"""An aircraft's way through the air: legs, turns, climbs and changes of speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from studies.trust.noises import Array

GRAVITY = 9.80665  # [m/s^2]
ROLLS_IN = 2.0  # [s], how long a command takes to be flown
SPEEDS_UP = 5.0  # [s]


@dataclass(frozen=True)
class Motion:
    """Rows of a flight. Angles in rad, the rest in SI units."""

    time: Array  # (N,)
    through_air: Array  # (N, 3), the velocity through the air, north, east and down
    attitude: Array  # (N, 3), roll, pitch and yaw
    rates: Array  # (N, 3), of the body
    altitude: Array  # (N,)
    airspeed: Array  # (N,)


def rotation(attitude: Array) -> Array:
    """C_b^n (N, 3, 3), from body axes to north, east and down, of roll, pitch and yaw (N, 3)."""
    roll, pitch, yaw = attitude.T
    return _about(2, yaw) @ _about(1, pitch) @ _about(0, roll)


def fly(rng: np.random.Generator, rows: int, rate: float, lively: bool) -> Motion:
    """So many rows at a rate [Hz]. A lively flight rocks and nods as far as a compass needs."""
    time = np.round(np.arange(rows) / rate, 6)
    usual = rng.uniform(18.0, 28.0)
    speed = _flown(time, SPEEDS_UP, 15.0, 40.0, rng, lambda: usual * rng.uniform(0.75, 1.35))
    bank = _banks(rng, time, usual, 60.0 if lively else 40.0)
    climb_rate = _climbs(rng, time, 5.0 if lively else 3.0)
    sideslip = _flown(
        time, ROLLS_IN, 3.0, 8.0, rng, lambda: np.radians(rng.choice([0, 0, -5, -3, 3, 5]))
    )
    nod = np.zeros(rows)
    if lively:
        still = np.abs(bank) < np.radians(10.0)
        calm = _smooth(still.astype(float), time, ROLLS_IN)
        bank = bank + calm * np.radians(35.0) * np.sin(2.0 * np.pi * 0.12 * time)
        nod = calm * np.radians(25.0) * np.sin(2.0 * np.pi * 0.05 * time + rng.uniform(0.0, 6.0))

    climb = np.arcsin(climb_rate / speed)
    turning = GRAVITY * np.tan(bank) / speed
    course = rng.uniform(-np.pi, np.pi) + _sum(turning, time)
    load = 1.0 / np.cos(np.clip(bank, -1.0, 1.0))
    incidence = np.radians(3.0) + np.radians(4.0) * ((usual / speed) ** 2 * load - 1.0) + nod
    of_air = _about(2, course) @ _about(1, climb) @ _about(0, bank)
    body = of_air @ _wind_axes(incidence, sideslip).transpose(0, 2, 1)
    attitude = _angles(body)
    return Motion(
        time=time,
        through_air=of_air[:, :, 0] * speed[:, None],
        attitude=attitude,
        rates=_rates(attitude, time),
        altitude=200.0 + rng.uniform(0.0, 300.0) + _sum(climb_rate, time),
        airspeed=speed,
    )


def _about(axis: int, angle: Array) -> Array:
    """Rotations (N, 3, 3) about an axis of the frame."""
    turned = np.zeros((angle.size, 3, 3))
    first, second = [i for i in range(3) if i != axis]
    sign = -1.0 if axis == 1 else 1.0
    turned[:, axis, axis] = 1.0
    turned[:, first, first] = turned[:, second, second] = np.cos(angle)
    turned[:, second, first] = sign * np.sin(angle)
    turned[:, first, second] = -sign * np.sin(angle)
    return turned


def _wind_axes(alpha: Array, beta: Array) -> Array:
    """From the axes of the air's velocity to those of the body (N, 3, 3)."""
    return _about(1, -alpha) @ _about(2, beta)


def _angles(body: Array) -> Array:
    """Roll, pitch and yaw (N, 3)."""
    return np.stack(
        [
            np.arctan2(body[:, 2, 1], body[:, 2, 2]),
            -np.arcsin(np.clip(body[:, 2, 0], -1.0, 1.0)),
            np.arctan2(body[:, 1, 0], body[:, 0, 0]),
        ],
        axis=-1,
    )


def _rates(attitude: Array, time: Array) -> Array:
    roll, pitch, _ = attitude.T
    by_time = np.gradient(np.unwrap(attitude, axis=0), time, axis=0)
    roll_rate, pitch_rate, yaw_rate = by_time.T
    return np.stack(
        [
            roll_rate - yaw_rate * np.sin(pitch),
            pitch_rate * np.cos(roll) + yaw_rate * np.sin(roll) * np.cos(pitch),
            -pitch_rate * np.sin(roll) + yaw_rate * np.cos(roll) * np.cos(pitch),
        ],
        axis=-1,
    )


def _sum(slope: Array, time: Array) -> Array:
    """The integral, zero at first."""
    steps = 0.5 * (slope[1:] + slope[:-1]) * np.diff(time)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _smooth(values: Array, time: Array, seconds: float) -> Array:
    """By a raised cosine of this length, the ends as they are."""
    half = max(1, round(0.5 * seconds / (time[1] - time[0])))
    window = np.hanning(2 * half + 3)[1:-1]
    padded = np.pad(values, half, mode="edge")
    return np.convolve(padded, window / window.sum(), mode="valid")


def _flown(
    time: Array,
    seconds: float,
    shortest: float,
    longest: float,
    rng: np.random.Generator,
    draw: Callable[[], float],
) -> Array:
    """Commands that are held from `shortest` to `longest` seconds, and flown smoothly."""
    commands = np.empty(time.size)
    begins = 0.0
    while begins <= time[-1]:
        commands[time >= begins] = draw()
        begins += rng.uniform(shortest, longest)
    return _smooth(commands, time, seconds)


def _banks(rng: np.random.Generator, time: Array, speed: float, steepest: float) -> Array:
    """Legs, and turns of 90 to 360 degrees between them."""
    commands = np.zeros(time.size)
    begins = rng.uniform(0.0, 10.0)
    while begins <= time[-1]:
        bank = np.radians(rng.uniform(15.0, steepest)) * rng.choice([-1.0, 1.0])
        turn = np.radians(rng.uniform(90.0, 360.0)) * speed / (GRAVITY * abs(np.tan(bank)))
        commands[(time >= begins) & (time < begins + turn)] = bank
        begins += turn + rng.uniform(8.0, 25.0)
    return _smooth(commands, time, ROLLS_IN)


def _climbs(rng: np.random.Generator, time: Array, fastest: float) -> Array:
    """Climb rates [m/s] that come back to where they began."""
    height = 0.0
    commands = np.empty(time.size)
    begins = 0.0
    while begins <= time[-1]:
        held = rng.uniform(10.0, 40.0)
        upwards = rng.random() < 0.5 - height / 300.0
        climb = rng.uniform(0.0, fastest) * (1.0 if upwards else -1.0)
        commands[time >= begins] = climb
        height += climb * held
        begins += held
    return _smooth(commands, time, SPEEDS_UP)
