# SPDX-License-Identifier: BSD-3-Clause
"""The five-hole probe, Eqs. 36-42: V = C_b^n [C(eps) V_s - w x r] + W.

V_s = V_a (cos alpha cos beta, sin beta, sin alpha cos beta); pressures become V_a, alpha, beta by
Eq. 36. Entry (1, 2) of the attitude matrix is sin phi sin theta cos psi - cos phi sin psi: Eq. 39
prints sin psi in its place, which is no rotation.
"""

from typing import ClassVar, NamedTuple

import numpy as np

from oracle.model import Array, Model, Record


def rotate_to_navigation(record: Record) -> Array:
    """C_b^n from body to north-east-down, the 3-2-1 Euler sequence, shape (N, 3, 3)."""
    sin_roll, cos_roll = np.sin(record["roll"]), np.cos(record["roll"])
    sin_pitch, cos_pitch = np.sin(record["pitch"]), np.cos(record["pitch"])
    sin_yaw, cos_yaw = np.sin(record["yaw"]), np.cos(record["yaw"])
    rows = [
        [
            cos_pitch * cos_yaw,
            sin_roll * sin_pitch * cos_yaw - cos_roll * sin_yaw,
            cos_roll * sin_pitch * cos_yaw + sin_roll * sin_yaw,
        ],
        [
            cos_pitch * sin_yaw,
            sin_roll * sin_pitch * sin_yaw + cos_roll * cos_yaw,
            cos_roll * sin_pitch * sin_yaw - sin_roll * cos_yaw,
        ],
        [-sin_pitch, sin_roll * cos_pitch, cos_roll * cos_pitch],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


class Reading(NamedTuple):
    """The probe's reading before calibration, each of shape (N,)."""

    speed: Array  # sqrt(2 (pt - ps) / rho) [m/s]
    alpha: Array  # dpa / (K_alpha (pt - ps)) [rad]
    beta: Array  # dpb / (K_beta (pt - ps)) [rad]


class FiveHoleProbe(Model):
    """xi = (lambda_va, b_va, w_n..d | lambda_alpha, b_alpha, lambda_beta, b_beta, eps_phi)."""

    outputs: ClassVar = ("vn", "ve", "vd")
    linear: ClassVar = ("lambda_va", "b_va", "w_n", "w_e", "w_d")
    nonlinear: ClassVar = ("lambda_alpha", "b_alpha", "lambda_beta", "b_beta", "eps_phi")

    def __init__(
        self, k_alpha: float, k_beta: float, lever_arm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ) -> None:
        """k_alpha and k_beta in 1/rad; the lever arm in metres, body axes."""
        self.k_alpha = k_alpha
        self.k_beta = k_beta
        self.lever_arm = lever_arm

    def read(self, record: Record) -> Reading:
        """The reading behind the pressures, Eq. 36 without its corrections."""
        dynamic = record["pt"] - record["ps"]
        return Reading(
            speed=np.sqrt(2 * dynamic / record["rho"]),
            alpha=record["dpa"] / (self.k_alpha * dynamic),
            beta=record["dpb"] / (self.k_beta * dynamic),
        )

    def predict(self, record: Record, xi: Array) -> Array:
        """vn, ve, vd without noise [m/s], shape (3, N)."""
        lambda_va, b_va, *_, lambda_alpha, b_alpha, lambda_beta, b_beta, eps = xi
        reading = self.read(record)
        speed = (1 + lambda_va) * reading.speed + b_va
        alpha = (1 + lambda_alpha) * reading.alpha + b_alpha
        beta = (1 + lambda_beta) * reading.beta + b_beta

        at_probe = speed * direction(alpha, beta)
        body_rates = np.stack([record[name] for name in "pqr"])
        swing = np.cross(body_rates, self.lever_arm, axisa=0).T
        in_body = misalign(eps) @ at_probe - swing
        return turn(rotate_to_navigation(record), in_body) + xi[2:5, np.newaxis]

    def jacobian(self, record: Record, xi: Array) -> Array:
        """Their derivative, shape (3, N, 10)."""
        lambda_va, b_va, *_, lambda_alpha, b_alpha, lambda_beta, b_beta, eps = xi
        reading = self.read(record)
        speed = (1 + lambda_va) * reading.speed + b_va
        alpha = (1 + lambda_alpha) * reading.alpha + b_alpha
        beta = (1 + lambda_beta) * reading.beta + b_beta

        zero = np.zeros_like(alpha)
        by_alpha = np.stack([-np.sin(alpha) * np.cos(beta), zero, np.cos(alpha) * np.cos(beta)])
        by_beta = np.stack(
            [-np.cos(alpha) * np.sin(beta), np.cos(beta), -np.sin(alpha) * np.sin(beta)]
        )
        along = direction(alpha, beta)
        to_navigation = rotate_to_navigation(record)
        misaligned = misalign(eps)
        by_eps = np.array(
            [[0, 0, 0], [0, -np.sin(eps), np.cos(eps)], [0, -np.cos(eps), -np.sin(eps)]]
        )
        wind = np.broadcast_to(np.eye(3)[:, np.newaxis], (3, alpha.size, 3))
        columns = [
            turn(to_navigation, misaligned @ along * reading.speed),
            turn(to_navigation, misaligned @ along),
            *np.moveaxis(wind, -1, 0),
            turn(to_navigation, misaligned @ by_alpha * speed * reading.alpha),
            turn(to_navigation, misaligned @ by_alpha * speed),
            turn(to_navigation, misaligned @ by_beta * speed * reading.beta),
            turn(to_navigation, misaligned @ by_beta * speed),
            turn(to_navigation, by_eps @ along * speed),
        ]
        return np.stack(columns, axis=-1)


def direction(alpha: Array, beta: Array) -> Array:
    """Where the air comes from in probe axes, Eq. 41, shape (3, N)."""
    return np.stack([np.cos(alpha) * np.cos(beta), np.sin(beta), np.sin(alpha) * np.cos(beta)])


def misalign(eps: float) -> Array:
    """C(eps_phi) of Eq. 38, shape (3, 3)."""
    sin, cos = np.sin(eps), np.cos(eps)
    return np.array([[1, 0, 0], [0, cos, sin], [0, -sin, cos]])


def turn(matrices: Array, vectors: Array) -> Array:
    """Each (N, 3, 3) matrix times its own column of (3, N)."""
    return np.einsum("kij,jk->ik", matrices, vectors)
