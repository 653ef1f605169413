# SPDX-License-Identifier: BSD-3-Clause
"""Models of your own: four tables and at(), and sepcal compares, diagnoses, adds and applies.

python -m sepcal fit --model own_models.py:HotWire tunnel.csv -o base.json
python -m sepcal diagnose --model own_models.py:HotWire tunnel.csv base.json
python -m sepcal add --model own_models.py:HotWire tunnel.csv base.json EFFECT -o better.json
"""

import numpy as np

GRAVITY = 9.80665  # [m/s^2]


def stack(*columns):
    """A (N, 1, n_1) of a model with one output."""
    return np.stack(np.broadcast_arrays(*columns), axis=-1)[:, np.newaxis, :]


class HotWire:
    """King's law: E^2 = A + B U^n."""

    inputs = {"u": "m/s"}
    outputs = {"e2": "V^2"}
    linear = {"A": "V^2", "B": "1"}
    nonlinear = {"n": ("1", 0.3, 0.7)}

    def at(self, u, xi2):
        power = np.maximum(u.u, 1e-6) ** xi2[0]
        return stack(np.ones_like(power), power), np.zeros((power.size, 1))


class Potentiometer:
    """The voltage of a wiper over the angle."""

    inputs = {"angle": "rad"}
    outputs = {"wiper": "V"}
    linear = {"v0": "V", "k": "V/rad"}
    nonlinear = {}

    def at(self, u, xi2):
        return stack(np.ones_like(u.angle), u.angle), np.zeros((u.angle.size, 1))


class Thermistor:
    """R = R_25 exp(beta (1/T - 1/298.15 K))."""

    inputs = {"T": "K"}
    outputs = {"R": "kohm"}
    linear = {"R_25": "kohm"}
    nonlinear = {"beta": ("K", 2000.0, 5000.0)}

    def at(self, u, xi2):
        return stack(np.exp(xi2[0] * (1.0 / u.T - 1.0 / 298.15))), np.zeros((u.T.size, 1))


class RadarAltimeter:
    """The range to flat ground, straight down."""

    inputs = {"height": "m"}
    outputs = {"range": "m"}
    linear = {"b": "m", "s": "1"}
    nonlinear = {}

    def at(self, u, xi2):
        return stack(np.ones_like(u.height), u.height), np.zeros((u.height.size, 1))


class TurntableAccelerometer:
    """One axis on a tilted turntable: a = b + k g sin(angle + mounting)."""

    inputs = {"angle": "rad"}
    outputs = {"a": "m/s^2"}
    linear = {"b": "m/s^2", "k": "1"}
    nonlinear = {"mounting": ("rad", -0.3, 0.3)}

    def at(self, u, xi2):
        pull = GRAVITY * np.sin(u.angle + xi2[0])
        return stack(np.ones_like(pull), pull), np.zeros((pull.size, 1))


class Pendulum:
    """A rod that a motor drives: theta'' = -w2 sin(theta) - d theta' + k torque."""

    inputs = {"torque": "N m"}
    states = {"theta": "rad", "rate": "rad/s"}
    outputs = {"angle": "rad"}
    linear = {"zero": "rad"}
    nonlinear = {
        "w2": ("1/s^2", 8.0, 16.0),
        "d": ("1/s", 0.0, 1.0),
        "k": ("1/(kg m^2)", 0.5, 5.0),
    }

    def rate(self, x, u, p):
        w2, d, k = p
        return [x[1], -w2 * np.sin(x[0]) - d * x[1] + k * u.torque]

    def at(self, x, u, p):
        return [[1.0]], [x[0]]

    def start(self, u, z):
        return [z[0], 0.0]
