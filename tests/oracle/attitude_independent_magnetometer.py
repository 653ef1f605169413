# SPDX-License-Identifier: BSD-3-Clause
"""The magnetometer of which only the field's strength F is known: 0 = residual + noise.

residual = (|y| - F - mu) / |C^-T u|, y = C^-1 (m - n), u = y / |y|, M = C^-1 C^-T and
mu = sigma^2 (tr M - u' M u) / 2F, with sigma the noise of m, held at a given value.
"""

from typing import ClassVar, NamedTuple

import numpy as np

from oracle.magnetometer import soft_iron
from oracle.model import Array, Model, Record

SOFT_IRON_AXES = ((0, 1), (0, 2), (1, 2))  # of alpha_xy, alpha_xz, alpha_yz


class Ellipsoid(NamedTuple):
    """Readings brought back to the sphere, row by row."""

    inverse: Array  # G = C^-1, shape (N, 3, 3)
    field: Array  # y [uT], shape (N, 3)
    direction: Array  # u, shape (N, 3)
    strength: Array  # |y| [uT], shape (N,)
    gain: Array  # q = u' M u, shape (N,)
    mean_error: Array  # mu [uT], shape (N,)


class AttitudeIndependentMagnetometer(Model):
    """xi = (| lambda_x..z, alpha_xy, alpha_xz, alpha_yz, n_x..z): nothing is linear.

    Columns scale, axis_scale_x..z [1] add to the diagonal of C, field_change [uT] to the field's
    strength; zero if absent.
    """

    outputs: ClassVar = ("field",)
    linear: ClassVar = ()
    nonlinear: ClassVar = (
        *("lambda_x", "lambda_y", "lambda_z"),
        *("alpha_xy", "alpha_xz", "alpha_yz"),
        *("n_x", "n_y", "n_z"),
    )

    def __init__(self, field_strength: float, noise: float) -> None:
        """Both in uT; a noise of zero leaves mu out."""
        self.field_strength = field_strength
        self.noise = noise

    def measured(self, record: Record) -> Array:
        """The output is zero in every row, shape (1, N)."""
        return np.zeros((1, record["mx"].size))

    def predict(self, record: Record, xi: Array) -> Array:
        """-residual [uT], so that measured - predict is the residual; shape (1, N)."""
        at = self._find_ellipsoid(record, xi)
        misfit = at.strength - self._strength_of(record) - at.mean_error
        return -(misfit / np.sqrt(at.gain))[np.newaxis]

    def jacobian(self, record: Record, xi: Array) -> Array:
        """Its derivative, shape (1, N, 9), by dG = -G dC G and du = (dy - u u'dy) / |y|."""
        at = self._find_ellipsoid(record, xi)
        square = at.inverse @ at.inverse.transpose(0, 2, 1)  # M
        misfit = at.strength - self._strength_of(record) - at.mean_error
        columns = []
        for by_matrix, by_bias in zip(*_derivatives(xi), strict=True):
            by_inverse = -at.inverse @ by_matrix @ at.inverse
            by_field = -_times(at.inverse @ by_matrix, at.field) - at.inverse @ by_bias
            by_strength = np.sum(at.direction * by_field, axis=-1)
            by_direction = by_field - at.direction * by_strength[:, np.newaxis]
            by_direction = by_direction / at.strength[:, np.newaxis]
            by_square = 2 * by_inverse @ at.inverse.transpose(0, 2, 1)  # its symmetric part is dM
            by_gain = _form(at.direction, by_square, at.direction)
            by_gain = by_gain + 2 * _form(by_direction, square, at.direction)
            by_trace = np.trace(by_square, axis1=1, axis2=2)
            by_mean_error = self._error_of(by_trace - by_gain, self._strength_of(record))
            columns.append(
                (by_strength - by_mean_error) / np.sqrt(at.gain)
                - misfit * by_gain / (2 * at.gain**1.5)
            )
        return -np.stack(columns, axis=-1)[np.newaxis]

    def _find_ellipsoid(self, record: Record, xi: Array) -> Ellipsoid:
        matrix = soft_iron(xi[3:6]) @ np.diag(1 + xi[:3])
        zero = np.zeros(record["mx"].size)
        driven = [
            record.get("scale", 0.0) + record.get(f"axis_scale_{axis}", zero) for axis in "xyz"
        ]
        inverse = np.linalg.inv(matrix + np.stack(driven, axis=-1)[:, np.newaxis, :] * np.eye(3))
        reading = np.stack([record[name] for name in ("mx", "my", "mz")], axis=-1)
        field = _times(inverse, reading - xi[6:])
        strength = np.sqrt(np.sum(field**2, axis=-1))
        direction = field / strength[:, np.newaxis]
        gain = np.sum(_times(inverse.transpose(0, 2, 1), direction) ** 2, axis=-1)
        trace = np.sum(inverse**2, axis=(1, 2))
        error = self._error_of(trace - gain, self._strength_of(record))
        return Ellipsoid(inverse, field, direction, strength, gain, error)

    def _strength_of(self, record: Record) -> Array:
        """Of each row's field [uT], shape (N,)."""
        return self.field_strength + record.get("field_change", np.zeros(record["mx"].size))

    def _error_of(self, spread: Array, strength: Array) -> Array:
        """The mean error mu of tr M - u' M u."""
        return self.noise**2 * spread / (2 * strength)


def _derivatives(xi: Array) -> tuple[Array, Array]:
    """The slopes of C (9, 3, 3) and n (9, 3) by each parameter."""
    by_matrix = np.zeros((9, 3, 3), dtype=xi.dtype)
    by_bias = np.zeros((9, 3))
    for axis in range(3):
        by_matrix[axis, :, axis] = soft_iron(xi[3:6])[:, axis]
        by_bias[6 + axis, axis] = 1.0
    for k, (i, j) in enumerate(SOFT_IRON_AXES):
        by_matrix[3 + k, i, j] = 1 + xi[j]
        by_matrix[3 + k, j, i] = 1 + xi[i]
    return by_matrix, by_bias


def _times(matrices: Array, vectors: Array) -> Array:
    """Each (N, 3, 3) matrix times its own row of (N, 3)."""
    return np.einsum("kij,kj->ki", matrices, vectors)


def _form(left: Array, matrices: Array, right: Array) -> Array:
    """A bilinear form left' matrix right, row by row, shape (N,)."""
    return np.einsum("ki,kij,kj->k", left, matrices, right)
