# SPDX-License-Identifier: BSD-3-Clause
"""A motor whose current bends the field at a magnetometer, and an effect of one's own for it."""

from collections.abc import Mapping

import numpy as np

import sepcal

MAGNETOMETER = sepcal.Magnetometer(field=(19.7, -1.4, 49.4))
HIDDEN = {"bias[current_a]": (0.05, -0.04, 0.06)}
Columns = Mapping[str, np.ndarray]


def current(log: Columns) -> np.ndarray:
    """Pickled by its name, as a lambda can't be."""
    return log["current_a"]


MOTOR = sepcal.Effect("motor", current, port="bias", unit="uT/A")


def simulate_motor(rows: int, seed: int) -> sepcal.SimulatedFlight:
    """A flight with the motor's current hidden in it."""
    return sepcal.simulate(MAGNETOMETER, rows=rows, seed=seed, hide=HIDDEN)
