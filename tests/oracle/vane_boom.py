# SPDX-License-Identifier: BSD-3-Clause
"""A boom with two vanes and a Pitot tube: V = C_b^n [R(eps) V_s - w x r] + W.

Each vane swings in a plane of the boom: the air that moves along (u, v, w) turns the one to
atan(w / u), the other to atan(v / u). The tube reads |(u, v, w)|.
"""

from typing import ClassVar

import numpy as np

from oracle.five_hole_probe import misalign, rotate_to_navigation, turn
from oracle.model import Array, Model, Record


class VaneBoom(Model):
    """xi = (lambda_va, b_va, w_n..d | lambda_alpha, b_alpha, lambda_beta, b_beta, eps_phi)."""

    outputs: ClassVar = ("vn", "ve", "vd")
    linear: ClassVar = ("lambda_va", "b_va", "w_n", "w_e", "w_d")
    nonlinear: ClassVar = ("lambda_alpha", "b_alpha", "lambda_beta", "b_beta", "eps_phi")

    def __init__(self, lever_arm: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
        """The lever arm in metres, body axes."""
        self.lever_arm = lever_arm

    def predict(self, record: Record, xi: Array) -> Array:
        """vn, ve, vd without noise [m/s], shape (3, N)."""
        lambda_va, b_va, *_, lambda_alpha, b_alpha, lambda_beta, b_beta, eps = xi
        speed = (1 + lambda_va) * record["airspeed"] + b_va
        along = flank_direction(
            (1 + lambda_alpha) * record["alpha"] + b_alpha,
            (1 + lambda_beta) * record["beta"] + b_beta,
        )
        in_body = misalign(eps) @ (speed * along) - self._swing(record)
        return turn(rotate_to_navigation(record), in_body) + xi[2:5, np.newaxis]

    def jacobian(self, record: Record, xi: Array) -> Array:
        """Their derivative, shape (3, N, 10): of a unit vector g / |g|, what of g' is across it."""
        lambda_va, b_va, *_, lambda_alpha, b_alpha, lambda_beta, b_beta, eps = xi
        alpha = (1 + lambda_alpha) * record["alpha"] + b_alpha
        beta = (1 + lambda_beta) * record["beta"] + b_beta
        speed = (1 + lambda_va) * record["airspeed"] + b_va
        along = flank_direction(alpha, beta)
        length = np.sqrt(1 + np.tan(alpha) ** 2 + np.tan(beta) ** 2)
        zero = np.zeros_like(length)

        def across(slope: Array) -> Array:
            return (slope - along * np.sum(along * slope, axis=0)) / length

        by_alpha = across(np.stack([zero, zero, np.cos(alpha) ** -2.0]))
        by_beta = across(np.stack([zero, np.cos(beta) ** -2.0, zero]))
        by_eps = np.array(
            [[0, 0, 0], [0, -np.sin(eps), np.cos(eps)], [0, -np.cos(eps), -np.sin(eps)]]
        )
        to_navigation, misaligned = rotate_to_navigation(record), misalign(eps)
        columns = [
            turn(to_navigation, misaligned @ along * record["airspeed"]),
            turn(to_navigation, misaligned @ along),
            *np.moveaxis(np.broadcast_to(np.eye(3)[:, np.newaxis], (3, length.size, 3)), -1, 0),
            turn(to_navigation, misaligned @ by_alpha * speed * record["alpha"]),
            turn(to_navigation, misaligned @ by_alpha * speed),
            turn(to_navigation, misaligned @ by_beta * speed * record["beta"]),
            turn(to_navigation, misaligned @ by_beta * speed),
            turn(to_navigation, by_eps @ along * speed),
        ]
        return np.stack(columns, axis=-1)

    def _swing(self, record: Record) -> Array:
        """How the boom's head moves as the vehicle turns, w x r, shape (3, N)."""
        p, q, r = (record[name] for name in "pqr")
        x, y, z = self.lever_arm
        return np.stack([q * z - r * y, r * x - p * z, p * y - q * x])


def flank_direction(alpha: Array, beta: Array) -> Array:
    """Where the air comes from, vanes at these angles, shape (3, N): (1, tan b, tan a) made one."""
    along = np.stack([np.ones_like(alpha), np.tan(beta), np.tan(alpha)])
    return along / np.sqrt(np.sum(along**2, axis=0))
