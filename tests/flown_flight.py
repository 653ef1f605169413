# SPDX-License-Identifier: BSD-3-Clause
"""One tumbling flight with a magnetometer, of which logs are written.

All is a formula of time, so that what a column should hold is known at any stamp.
"""

import numpy as np

from oracle.five_hole_probe import rotate_to_navigation

START, LENGTH = 20.0, 60.0  # [s]
FIELD = np.array([21.5, 1.3, 43.2])  # north, east, down [uT]
PLACE = (47.4, 8.5, 500.0)  # degrees, metres
MATRIX = np.array([[1.05, 0.02, -0.01], [0.02, 0.96, 0.03], [-0.01, 0.03, 1.01]])
BIAS = np.array([12.0, -7.0, 20.0])  # [uT]


def at_rate(rate, late=0.0, length=LENGTH):
    return START + late + np.arange(int(length * rate)) / rate


def attitude(t):
    """Roll, pitch, yaw [rad], shape (n, 3)."""
    t = np.asarray(t) - START
    return np.stack((0.9 * np.sin(0.7 * t), 0.8 * np.sin(0.43 * t + 1), 0.5 * t), axis=-1)


def velocity(t):
    return np.stack((20 * np.cos(0.5 * t), 20 * np.sin(0.5 * t), -0.1 * np.ones_like(t)), axis=-1)


def throttle(t):
    return 0.5 + 0.3 * np.sin(0.9 * np.asarray(t))


def current(t):
    return 20 * throttle(t)


def altitude(t):
    return 100 + 5 * np.sin(0.2 * np.asarray(t))


def differential_pressure(t):
    return 250 + 40 * np.sin(0.5 * np.asarray(t))


def true_field(t):
    """In body axes [uT], (n, 3)."""
    angles = dict(zip(("roll", "pitch", "yaw"), attitude(t).T, strict=True))
    return np.einsum("kji,j->ki", rotate_to_navigation(angles), FIELD)


def raw(t):
    """What the raw sensor reads in body axes [uT], (n, 3)."""
    return true_field(t) @ MATRIX.T + BIAS


def quaternion(t):
    """W first, by turning about z, y and x one after another."""
    half = attitude(t) / 2
    (cr, cp, cy), (sr, sp, sy) = np.cos(half).T, np.sin(half).T
    product = np.stack((cy * cp, -sy * sp, cy * sp, sy * cp), axis=-1)
    w, x, y, z = product.T
    return np.stack((w * cr - x * sr, w * sr + x * cr, y * cr + z * sr, z * cr - y * sr), axis=-1)
