# SPDX-License-Identifier: BSD-3-Clause
"""The magnetometer in a known field, Eq. B1: m = C_alpha C_eta C_lambda h + n + v.

C_alpha is symmetric with a unit diagonal, C_eta = I + [eta x] (Eq. A2 with +eta_x in entry (3, 2)),
C_lambda = I + diag(lambda). Nine numbers make up C = C_alpha C_eta C_lambda, so none is redundant.
"""

from typing import ClassVar

import numpy as np

from oracle.model import Array, Model, Record


class Magnetometer(Model):
    """xi = (lambda_x..z, n_x..z | eta_x..z, alpha_xy, alpha_xz, alpha_yz)."""

    outputs: ClassVar = ("mx", "my", "mz")
    linear: ClassVar = ("lambda_x", "lambda_y", "lambda_z", "n_x", "n_y", "n_z")
    nonlinear: ClassVar = ("eta_x", "eta_y", "eta_z", "alpha_xy", "alpha_xz", "alpha_yz")

    def predict(self, record: Record, xi: Array) -> Array:
        """mx, my, mz without noise [uT], shape (3, N)."""
        return compose(xi) @ _field(record) + xi[3:6, np.newaxis]

    def jacobian(self, record: Record, xi: Array) -> Array:
        """Their derivative, shape (3, N, 12)."""
        field = _field(record)
        bias = np.broadcast_to(np.eye(3)[:, np.newaxis], (3, field.shape[1], 3))
        by_matrix = np.einsum("pij,jk->ikp", compose_derivative(xi), field)
        return np.concatenate([by_matrix[..., :3], bias, by_matrix[..., 3:]], axis=-1)


def compose(xi: Array) -> Array:
    """C = C_alpha C_eta C_lambda, shape (3, 3)."""
    return soft_iron(xi[9:]) @ _misalignment(xi[6:9]) @ np.diag(1 + xi[:3])


def compose_derivative(xi: Array) -> Array:
    """The slopes of C: by lambda_x..z, eta_x..z, alpha_xy, alpha_xz, alpha_yz; shape (9, 3, 3)."""
    soft, misalignment, scale = soft_iron(xi[9:]), _misalignment(xi[6:9]), np.diag(1 + xi[:3])
    identity = np.eye(3)
    by_scale = [soft @ misalignment @ np.outer(axis, axis) for axis in identity]
    by_misalignment = [soft @ _skew(axis) @ scale for axis in identity]
    by_soft_iron = [
        (np.outer(identity[i], identity[j]) + np.outer(identity[j], identity[i]))
        @ misalignment
        @ scale
        for i, j in ((0, 1), (0, 2), (1, 2))
    ]
    return np.stack(by_scale + by_misalignment + by_soft_iron)


def _field(record: Record) -> Array:
    """The true field in body axes [uT], shape (3, N)."""
    return np.stack([record[name] for name in ("hx", "hy", "hz")])


def soft_iron(alpha: Array) -> Array:
    """C_alpha of (alpha_xy, alpha_xz, alpha_yz), shape (3, 3)."""
    xy, xz, yz = alpha
    return np.array([[1, xy, xz], [xy, 1, yz], [xz, yz, 1]])


def _misalignment(eta: Array) -> Array:
    return np.eye(3) + _skew(eta)


def _skew(vector: Array) -> Array:
    """[v x], so that [v x] u is the cross product of v and u."""
    x, y, z = vector
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
