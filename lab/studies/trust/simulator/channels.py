# SPDX-License-Identifier: BSD-3-Clause
"""What else a vehicle logs: channels that go with its flight, and drive nothing unless told to."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from studies.trust.noises import Array
from studies.trust.simulator.manoeuvres import GRAVITY, Motion

CHANNELS = ("temp_degc", "altitude_m", "throttle", "current_a", "voltage_v")


def log_channels(rng: np.random.Generator, motion: Motion) -> dict[str, Array]:
    """A throttle that climbs and speeds up, a bay that it warms, and a battery that it drains."""
    time = motion.time
    energy = motion.altitude + motion.airspeed**2 / (2.0 * GRAVITY)
    power = np.gradient(energy, motion.time) + 0.004 * motion.airspeed**2 / np.cos(
        0.8 * motion.attitude[:, 0]
    )
    idle, full = np.quantile(power, [0.05, 0.95])
    effort = np.clip((power - idle) / (full - idle), 0.0, 1.0)
    throttle = np.clip(0.15 + 0.7 * effort + 0.02 * rng.standard_normal(time.size), 0.0, 1.0)

    payload = 3.0 * (np.sin(2.0 * np.pi * time / rng.uniform(20.0, 60.0)) > 0.3)
    current = 2.0 + payload + 18.0 * throttle**1.5 + 0.2 * rng.standard_normal(time.size)
    ambient = rng.uniform(5.0, 25.0) - 0.0065 * (motion.altitude - motion.altitude[0])
    share = 1.0 - np.exp(-(time[1] - time[0]) / rng.uniform(15.0, 120.0))
    heated = ambient + rng.uniform(10.0, 30.0) * throttle**1.5
    cold = rng.uniform(0.0, 1.0) * (heated[0] - ambient[0]) + ambient[0]
    temperature = lfilter([share], [1.0, share - 1.0], heated, zi=[(1.0 - share) * cold])[0]

    drained = np.cumsum(current) / np.sum(current)
    voltage = 16.6 - 1.2 * drained - 0.03 * current + 0.01 * rng.standard_normal(time.size)
    return {
        "temp_degc": np.round(temperature + 0.02 * rng.standard_normal(time.size), 2),
        "altitude_m": np.round(motion.altitude + 0.2 * rng.standard_normal(time.size), 2),
        "throttle": np.round(throttle, 3),
        "current_a": np.round(current, 2),
        "voltage_v": np.round(voltage, 3),
    }
