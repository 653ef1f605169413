# SPDX-License-Identifier: BSD-3-Clause
"""Attitudes as unit quaternions between which lines may be drawn, and as 3-2-1 Euler angles.

A quaternion is (w, x, y, z), Hamilton's product, and turns body axes into north-east-down.
"""

from __future__ import annotations

import numpy as np

from sepcal.columns import Array


def from_euler(angles: Array) -> Array:
    """Quaternions (n, 4) from roll, pitch, yaw [rad], shape (n, 3)."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(angles.T / 2), np.sin(angles.T / 2)
    return np.stack(
        (
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ),
        axis=-1,
    )


def to_euler(q: Array) -> Array:
    """Roll, pitch, yaw [rad], (n, 3), from quaternions (n, 4) of any length."""
    w, x, y, z = (q / np.linalg.norm(q, axis=-1, keepdims=True)).T
    return np.stack(
        (
            np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
            np.arcsin(np.clip(2 * (w * y - z * x), -1, 1)),
            np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
        ),
        axis=-1,
    )


def smooth_signs(q: Array) -> Array:
    """The same attitudes with q or -q chosen so that neighbours are near."""
    turned = np.sum(q[1:] * q[:-1], axis=1) < 0
    signs = np.where(np.append(0, np.cumsum(turned)) % 2 == 0, 1.0, -1.0)
    return q * signs[:, None]
