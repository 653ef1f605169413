# SPDX-License-Identifier: BSD-3-Clause
"""The Earth's field by spherical harmonics from a file of Gauss coefficients, written anew.

V = a sum (a/r)^(n+1) (g cos m lon + h sin m lon) P_nm(cos colat), Schmidt's half normalisation by
scipy's Legendre functions; the field is -grad V by central differences, turned from the sphere to
the ellipsoid of WGS 84. Slow and short on purpose.
"""

import math

import numpy as np
from scipy.special import lpmv

EARTH = 6371.2  # km, of the coefficients
EQUATOR, FLATTENING = 6378.137, 1 / 298.257223563


def read_coefficients(text):
    """Epoch and [(n, m, g, h, dg, dh)] of a .COF file."""
    header, *lines = text.splitlines()
    rows = [tuple(map(float, line.split())) for line in lines if not line.startswith("9999")]
    return float(header.split()[0]), [(int(r[0]), int(r[1]), *r[2:]) for r in rows if len(r) == 6]


def potential(rows, years, radius, colatitude, longitude):
    """V in nT km."""
    total = 0.0
    for n, m, g, h, dg, dh in rows:
        schmidt = (2 * math.factorial(n - m) / math.factorial(n + m)) ** 0.5 if m else 1.0
        legendre = (-1) ** m * lpmv(m, n, math.cos(colatitude)) * schmidt
        wave = (g + dg * years) * math.cos(m * longitude) + (h + dh * years) * math.sin(
            m * longitude
        )
        total += EARTH * (EARTH / radius) ** (n + 1) * wave * legendre
    return total


def evaluate(text, year, latitude, longitude, height):
    """North, east, down [nT] at degrees and km above the ellipsoid."""
    epoch, rows = read_coefficients(text)
    phi, lam = math.radians(latitude), math.radians(longitude)
    squared = FLATTENING * (2 - FLATTENING)
    curvature = EQUATOR / math.sqrt(1 - squared * math.sin(phi) ** 2)
    across = (curvature + height) * math.cos(phi)
    along = (curvature * (1 - squared) + height) * math.sin(phi)
    radius, colatitude = math.hypot(across, along), math.atan2(across, along)

    def slope(step_radius, step_colatitude, step_longitude):
        ends = [
            potential(
                rows,
                year - epoch,
                radius + sign * step_radius,
                colatitude + sign * step_colatitude,
                lam + sign * step_longitude,
            )
            for sign in (1, -1)
        ]
        return (ends[0] - ends[1]) / 2

    step, angle = 0.01, 1e-5
    outward = -slope(step, 0, 0) / step
    south = -slope(0, angle, 0) / angle / radius
    east = -slope(0, 0, angle) / angle / (radius * math.sin(colatitude))
    turn = math.pi / 2 - colatitude - phi  # geocentric latitude less geodetic
    north_sphere, down_sphere = -south, -outward
    north = north_sphere * math.cos(turn) - down_sphere * math.sin(turn)
    down = north_sphere * math.sin(turn) + down_sphere * math.cos(turn)
    return np.array([north, east, down])
