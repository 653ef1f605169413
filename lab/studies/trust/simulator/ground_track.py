# SPDX-License-Identifier: BSD-3-Clause
"""Where a vehicle is on the Earth's ellipsoid (WGS 84) that has flown at such velocities."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from studies.trust.noises import Array


def fly_path(velocity: Sequence[Array], time: Array, start: tuple[float, float, float]) -> Array:
    """Latitude and longitude [rad] and altitude [m], shape (3, N), on WGS 84, by trapezoids."""
    north, east, down = velocity
    step = np.diff(time)

    def integrate(rate: Array) -> Array:
        return np.concatenate([[0.0], np.cumsum(step * (rate[1:] + rate[:-1]) / 2)])

    altitude = start[2] - integrate(down)
    latitude = np.full(time.size, start[0])
    for _ in range(3):  # the radius of curvature is of where it is
        w = 1.0 - 6.69437999014e-3 * np.sin(latitude) ** 2
        meridian = 6378137.0 * (1.0 - 6.69437999014e-3) / w**1.5
        latitude = start[0] + integrate(north / (meridian + altitude))
    normal = 6378137.0 / np.sqrt(1.0 - 6.69437999014e-3 * np.sin(latitude) ** 2)
    longitude = start[1] + integrate(east / ((normal + altitude) * np.cos(latitude)))
    return np.array([latitude, longitude, altitude])
