# SPDX-License-Identifier: BSD-3-Clause
"""How a sensor is mounted: the rotations that MAVLink, PX4 and ArduPilot number alike."""

from __future__ import annotations

import numpy as np

from sepcal.columns import Array

# Roll, pitch, yaw [deg] by number (MAVLink's MAV_SENSOR_ORIENTATION).
_ANGLES = (
    *((0, 0, yaw) for yaw in range(0, 360, 45)),
    *((180, 0, 0), (180, 0, 45), (180, 0, 90), (180, 0, 135)),
    *((0, 180, 0), (180, 0, 225), (180, 0, 270), (180, 0, 315)),
    *((90, 0, 0), (90, 0, 45), (90, 0, 90), (90, 0, 135)),
    *((270, 0, 0), (270, 0, 45), (270, 0, 90), (270, 0, 135)),
    *((0, 90, 0), (0, 270, 0), (0, 180, 90), (0, 180, 270)),
    *((90, 90, 0), (180, 90, 0), (270, 90, 0), (90, 180, 0), (270, 180, 0)),
    *((90, 270, 0), (180, 270, 0), (270, 270, 0), (90, 180, 90), (90, 0, 270)),
    *((90, 68, 293), (0, 315, 0), (90, 315, 0)),
    *((270, 0, 180), (270, 0, 270), (0, 90, 180), (0, 9, 180), (0, 45, 0)),
    *((270, 0, 225), (270, 0, 315)),
)
CUSTOM = 100  # by angles of its own


def rotation_of(number: int) -> Array | None:
    """The matrix that turns the sensor's axes into the body's; None for a number not known here."""
    return turn(*_ANGLES[number]) if 0 <= number < len(_ANGLES) else None


def turn(roll: float, pitch: float, yaw: float) -> Array:
    """The matrix of 3-2-1 Euler angles [deg]."""
    (cr, cp, cy), (sr, sp, sy) = (f(np.radians((roll, pitch, yaw))) for f in (np.cos, np.sin))
    return np.array(
        (
            (cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy),
            (cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy),
            (-sp, sr * cp, cr * cp),
        )
    )
