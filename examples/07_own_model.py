# SPDX-License-Identifier: BSD-3-Clause
"""A model of your own: an airspeed indicator's scale, a compass's error and the wind from a box."""

# ruff: noqa: ANN001, ANN201, D101, D102, RUF012

import numpy as np

import sepcal

box = {  # six legs: airspeed as read, heading, and the ground velocity that GPS saw
    "v": [21, 20.4, 19.7, 20.2, 20.9, 19.5],
    "psi": [0, 1.1, 2.1, 3.1, 4.2, 5.2],
    "vn": [18.2, 4.9, -15.4, -24.9, -13.4, 6.8],
    "ve": [3.9, 22.1, 19.6, 2.1, -17.2, -15.1],
}


class WindBox:
    inputs = {"v": "m/s", "psi": "rad"}
    outputs = {"vn": "m/s", "ve": "m/s"}
    linear = {"k": "1", "w_n": "m/s", "w_e": "m/s"}
    nonlinear = {"delta": ("rad", -0.5, 0.5)}

    def at(self, u, xi2):
        A = np.zeros((len(u.v), 2, 3))
        A[:, 0, 0] = u.v * np.cos(u.psi + xi2[0])
        A[:, 1, 0] = u.v * np.sin(u.psi + xi2[0])
        A[:, 0, 1] = A[:, 1, 2] = 1.0
        return A, np.zeros((len(u.v), 2))


print(sepcal.fit(WindBox(), box))
