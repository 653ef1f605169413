# SPDX-License-Identifier: BSD-3-Clause
"""Flights whose pitching moment is known: what regressors and noise make it, to the last digit.

The rates' derivatives are logged, so that nothing is differentiated; regressors need not be those
of an aircraft that flies.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

import sepcal

Column = NDArray[np.float64]

INERTIA = 1285.0, 1825.0, 2667.0, 0.0  # Ix, Iy, Iz, Ixz [kg m^2]
AIRCRAFT = sepcal.Aircraft(area=16.2, chord=1.49, span=10.9, mass=1050.0, inertia=INERTIA)
RATE, QBAR, SPEED = 50.0, 1500.0, 50.0  # Hz, Pa, m/s


def swinging(draws: np.random.Generator, rows: int, size: float, slowest: float) -> Column:
    """Five sines between `slowest` and 1.5 Hz, of random phase; rms `size`."""
    time = np.arange(rows) / RATE
    frequencies = np.geomspace(slowest, 1.5, 5) * draws.uniform(0.9, 1.1, 5)
    phases = draws.uniform(0, 2 * np.pi, 5)
    sines = np.sin(2 * np.pi * np.outer(time, frequencies) + phases)
    swings: Column = size * np.sqrt(2 / 5) * sines.sum(axis=1)
    return swings


def maneuver(seed: int, rows: int) -> dict[str, Column]:
    """What an equation may have, of a maneuver that excites all of it."""
    draws = np.random.default_rng(seed)
    return {
        "alpha": 0.08 + swinging(draws, rows, 0.06, 0.1),
        "q_hat": swinging(draws, rows, 0.002, 0.2),
        "elevator": -0.03 + swinging(draws, rows, 0.05, 0.15),
        "throttle": 0.5 + swinging(draws, rows, 0.15, 0.12),
    }


def regressor(name: str, channels: Mapping[str, Column]) -> Column:
    """The product that a name like "alpha^2*elevator" or "1" means."""
    product = np.ones(next(iter(channels.values())).size)
    for factor in () if name == "1" else name.split("*"):
        channel, _, power = factor.partition("^")
        product = product * channels[channel] ** int(power or 1)
    return product


def pitching(channels: Mapping[str, Column], terms: Mapping[str, float]) -> Column:
    """Cm of these terms."""
    Cm = np.zeros(next(iter(channels.values())).size)
    for name, size in terms.items():
        Cm += size * regressor(name, channels)
    return Cm


def fly(channels: Mapping[str, Column], Cm: Column) -> sepcal.Flight:
    """The log of a flight with this Cm; `channels` as they are read."""
    rows = Cm.size
    zero = np.zeros(rows)
    q = channels["q_hat"] * 2.0 * SPEED / AIRCRAFT.chord
    qdot = Cm * QBAR * AIRCRAFT.area * AIRCRAFT.chord / INERTIA[1]
    return sepcal.Flight(
        {
            "time_s": np.arange(rows) / RATE,
            **{"ax_mps2": zero, "ay_mps2": zero, "az_mps2": zero - 9.81},
            **{"p_radps": zero, "q_radps": q, "r_radps": zero},
            **{"pdot_radps2": zero, "qdot_radps2": qdot, "rdot_radps2": zero},
            **{"airspeed_mps": zero + SPEED, "beta_rad": zero, "qbar_pa": zero + QBAR},
            **{"alpha_rad": channels["alpha"], "elevator_rad": channels["elevator"]},
            "throttle_1": channels["throttle"],
        }
    )
