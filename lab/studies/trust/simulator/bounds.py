# SPDX-License-Identifier: BSD-3-Clause
"""What instruments do: how loud they are from row to row, and how far they are taken to wander.

An effect of twice the stated wander is to be told from it; one within it can't be.
"""

from __future__ import annotations

import numpy as np

from studies.trust.simulator.compass import FIELD as EARTH
from studies.trust.simulator.manoeuvres import Motion

WHITE = {"pitot-static": 0.1, "five-hole": 0.1, "magnetometer": 0.2}  # m/s, m/s, uT

AIRSPEED = 0.2  # [m/s], of a transducer
VELOCITY = 0.15  # [m/s], of each component, of a satellite receiver with inertial sensors
GUST = 0.35  # [m/s], of each component of the wind
LONGEST_GUST = 30.0  # [s]
TILT = np.radians(0.3)  # of roll and pitch
HEADING = np.radians(1.0)
FIELD = 0.3  # [uT], of each reading
OF_OUTPUTS = {"pitot-static": AIRSPEED, "five-hole": VELOCITY, "magnetometer": FIELD}


def of_attitude(probe: str, motion: Motion) -> float:
    """What the wander of an attitude does to an output, in its unit: the heading's, mostly.

    A turn of the heading moves the two horizontal outputs, each by its share of the flight.
    """
    if probe == "magnetometer":
        north, east, down = EARTH
        level = np.hypot(north, east)
        return float(np.hypot(HEADING * level, TILT * abs(down)) / np.sqrt(2.0))
    return float(HEADING * np.mean(motion.airspeed) / np.sqrt(2.0))
