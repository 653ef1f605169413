# SPDX-License-Identifier: BSD-3-Clause
"""Models in Python as their authors write them, their data, and twins of sepcal's own."""

# ruff: noqa: RUF012  A model's tables are constants.

from typing import Any

import numpy as np

import sepcal
from oracle.cases import K_ALPHA, K_BETA, LEVER_ARM, Case

BUILT_IN = {
    "scalar_1": sepcal.ScalarExample1(),
    "scalar_2": sepcal.ScalarExample2(),
    "five_hole": sepcal.FiveHoleProbe(k_alpha=K_ALPHA, k_beta=K_BETA, lever_arm=LEVER_ARM),
    "vane_boom": sepcal.VaneBoom(lever_arm=LEVER_ARM),
    "magnetometer": sepcal.Magnetometer(),
}


class WindBox:
    """Ground velocity from an airspeed indicator and a compass, in a steady wind."""

    inputs = {"v": "m/s", "psi": "rad"}
    outputs = {"vn": "m/s", "ve": "m/s"}
    linear = {"k": "1", "w_n": "m/s", "w_e": "m/s"}
    nonlinear = {"delta": ("rad", -0.5, 0.5)}

    def at(self, u: Any, xi2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A (N, 2, 3) and b (N, 2)."""
        A = np.zeros((len(u.v), 2, 3))
        A[:, 0, 0] = u.v * np.cos(u.psi + xi2[0])
        A[:, 1, 0] = u.v * np.sin(u.psi + xi2[0])
        A[:, 0, 1] = A[:, 1, 2] = 1.0
        return A, np.zeros((len(u.v), 2))


class WithDerivatives(WindBox):
    """The same, with derivatives by hand."""

    def derivatives(self, u: Any, xi2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Those of A (N, 2, 3, 1) and of b (N, 2, 1)."""
        dA = np.zeros((len(u.v), 2, 3, 1))
        dA[:, 0, 0, 0] = -u.v * np.sin(u.psi + xi2[0])
        dA[:, 1, 0, 0] = u.v * np.cos(u.psi + xi2[0])
        return dA, np.zeros((len(u.v), 2, 1))


def simulate_wind_box(rows: int, seed: int = 0) -> dict[str, np.ndarray]:
    """With k = 1.05, w_n = -3.8, w_e = 2.4 m/s, delta = 0.06 rad, noise of 0.3 m/s."""
    rng = np.random.default_rng(seed)
    v, psi = rng.uniform(18, 22, rows), rng.uniform(0, 2 * np.pi, rows)
    vn, ve = 1.05 * v * np.cos(psi + 0.06) - 3.8, 1.05 * v * np.sin(psi + 0.06) + 2.4
    noise = 0.3 * rng.standard_normal((2, rows))
    return {"v": v, "psi": psi, "vn": vn + noise[0], "ve": ve + noise[1]}


BOX = simulate_wind_box(600)


class Twin:
    """A built-in model's tables around the oracle's NumPy."""

    def __init__(self, case: Case) -> None:
        built_in = BUILT_IN[case.name]
        self.oracle = case.model
        self.inputs = {name: built_in.units[name] for name in built_in.inputs}
        self.outputs = {name: built_in.units[name] for name in case.model.outputs}
        self.linear = {name: built_in.units[name] for name in case.model.linear}
        self.nonlinear = {
            name: (built_in.units[name], *built_in.bounds[name]) for name in case.model.nonlinear
        }

    def at(self, u: Any, xi2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A and b of the oracle, its axes put in sepcal's order."""
        A, b = self.oracle.affine(dict(zip(self.inputs, u, strict=True)), xi2)
        return np.swapaxes(A, 0, 1), b.T
