# SPDX-License-Identifier: BSD-3-Clause
"""A flight that was never integrated.

Attitude and air velocity are smooth functions of time; what an inertial unit reads follows from the
derivatives of their splines.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

Array = NDArray[np.float64]

GRAVITY = 9.80665  # m/s^2
WIND = (4.0, -3.0, 0.2)  # m/s, north east down
GYRO_BIAS = (0.002, -0.001, 0.0015)  # rad/s, of the reading
ACCEL_BIAS = (0.05, -0.03, 0.08)  # m/s^2, of the reading


def to_ned(phi: Array, theta: Array, psi: Array) -> Array:
    """C_b^n of each row (rows x 3 x 3)."""
    sin_phi, cos_phi = np.sin(phi), np.cos(phi)
    sin_theta, cos_theta = np.sin(theta), np.cos(theta)
    sin_psi, cos_psi = np.sin(psi), np.cos(psi)
    return np.moveaxis(
        np.array(
            [
                [
                    cos_theta * cos_psi,
                    sin_phi * sin_theta * cos_psi - cos_phi * sin_psi,
                    cos_phi * sin_theta * cos_psi + sin_phi * sin_psi,
                ],
                [
                    cos_theta * sin_psi,
                    sin_phi * sin_theta * sin_psi + cos_phi * cos_psi,
                    cos_phi * sin_theta * sin_psi - sin_phi * cos_psi,
                ],
                [-sin_theta, sin_phi * cos_theta, cos_phi * cos_theta],
            ]
        ),
        -1,
        0,
    )


def fly(
    seed: int,
    *,
    duration: float = 60.0,
    rate: float = 10.0,
    gyro_drift: Sequence[float] = (0.0, 0.0, 0.0),
    late: float = 0.0,
) -> dict[str, Array]:
    """By header. `gyro_drift`: of the readings, rad/s^2; `late`: the inertial unit, s."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, duration, 1.0 / rate)
    lag = round(late * rate)
    phases = rng.uniform(0.0, 2.0 * np.pi, (6, 3))

    def swing(row: int, sizes: Sequence[float], periods: Sequence[float]) -> Array:
        waves = [
            size * np.sin(2.0 * np.pi * t / period + phase)
            for size, period, phase in zip(sizes, periods, phases[row], strict=False)
        ]
        return np.sum(waves, axis=0)

    def rate_of(values: Array) -> Array:
        return CubicSpline(t, values)(t, 1)

    def noise(size: float) -> Array:
        return size * rng.standard_normal(t.size)

    phi = swing(0, (0.35, 0.15, 0.05), (17, 7, 3))
    theta = 0.05 + swing(1, (0.10, 0.05, 0.02), (21, 6, 2.5))
    psi = 0.8 + swing(2, (0.6, 0.1), (40, 9))
    speed = 55.0 + swing(3, (4, 2), (25, 8))
    alpha = 0.06 + swing(4, (0.03, 0.02), (6, 2.5))
    beta = swing(5, (0.03, 0.015), (7, 3))
    air = speed * np.array(
        [np.cos(alpha) * np.cos(beta), np.sin(beta), np.sin(alpha) * np.cos(beta)]
    )
    roll_rate, pitch_rate, yaw_rate = rate_of(phi), rate_of(theta), rate_of(psi)
    turn = np.array(
        [
            roll_rate - yaw_rate * np.sin(theta),
            pitch_rate * np.cos(phi) + yaw_rate * np.cos(theta) * np.sin(phi),
            -pitch_rate * np.sin(phi) + yaw_rate * np.cos(theta) * np.cos(phi),
        ]
    )
    attitude = to_ned(phi, theta, psi)
    weight = GRAVITY * attitude[:, 2, :].T
    force = np.array([rate_of(component) for component in air]) + np.cross(turn.T, air.T).T - weight
    ground = np.einsum("kij,jk->ik", attitude, air)

    def delayed(values: Array) -> Array:
        return np.concatenate([np.full(lag, values[0]), values[: t.size - lag]])

    log = {"time_s": t}
    for i, name in enumerate("xyz"):
        log[f"a{name}_mps2"] = delayed(force[i] + ACCEL_BIAS[i] + noise(0.02))
    for i, name in enumerate("pqr"):
        bias = GYRO_BIAS[i] + gyro_drift[i] * t
        log[f"{name}_radps"] = delayed(turn[i] + bias + noise(5e-4))
    log |= {
        "airspeed_mps": 1.01 * speed + noise(0.15),
        "alpha_rad": 1.03 * alpha + noise(0.002),
        "beta_rad": 0.97 * beta + noise(0.002),
        "roll_rad": phi + noise(0.003),
        "pitch_rad": theta + noise(0.003),
        "yaw_rad": psi + noise(0.004),
    }
    for i, name in enumerate(("vn", "ve", "vd")):
        log[f"{name}_mps"] = ground[i] + WIND[i] + noise(0.05)
    log["imu_temp_degc"] = 20.0 + 10.0 * (1.0 - np.exp(-t / 30.0)) + noise(0.02)
    return log
