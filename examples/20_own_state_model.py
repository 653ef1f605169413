# SPDX-License-Identifier: BSD-3-Clause
"""A model with a state of your own: roll damping and aileron effectiveness; what disturbed it."""

# ruff: noqa: ANN001, ANN201, D101, D102, RUF012

import numpy as np

import sepcal

roll = {  # two seconds at 10 Hz
    "time": np.arange(21) / 10,
    "aileron": np.repeat([0.0, 0.1, -0.1, 0.05], [1, 8, 7, 5]),
    "p_m": [
        0.051, 0.1, 0.188, 0.254, 0.312, 0.353, 0.384, 0.412, 0.431, 0.336, 0.159,
        0.023, -0.086, -0.168, -0.233, -0.281, -0.239, -0.129, -0.044, 0.024, 0.076,
    ],
}  # fmt: skip


class RollMode:
    inputs = {"aileron": "rad"}
    states = {"p": "rad/s"}
    outputs = {"p_m": "rad/s"}
    linear = {"b_p": "rad/s"}
    nonlinear = {"Lp": ("1/s", -20, 0), "La": "1/s^2"}
    linear_dynamic = ["La"]  # linear in p and La
    noise = {"p": "rad/s/sqrt(s)"}

    def rate(self, x, u, p):
        Lp, La = p
        return [Lp * x[0] + La * u.aileron]

    def at(self, x, u, p):
        return [[1.0]], [x[0]]


fit = sepcal.fit(RollMode(), roll)
for name, parameter in fit.parameters.items():
    print(f"{name:4} {parameter.value:8.4f} +- {parameter.standard_error:.4f}")

smoothed = sepcal.smooth(RollMode(), roll, fit, process_noise={"p": 0.01})
error = smoothed.standard_error[10, 0]
print(f"p after a second: {smoothed['p'][10]:.4f} +- {error:.4f} rad/s")
