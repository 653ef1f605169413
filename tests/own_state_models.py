# SPDX-License-Identifier: BSD-3-Clause
"""Models with a state in Python as their authors write them, and records of them by SciPy."""

# ruff: noqa: RUF012  A model's tables are constants.

from typing import Any

import numpy as np
from scipy.integrate import solve_ivp


class RollMode:
    """Roll damping and aileron effectiveness; linear in its state."""

    inputs = {"aileron": "rad"}
    states = {"p": "rad/s"}
    outputs = {"p_m": "rad/s"}
    linear = {"b_p": "rad/s"}
    nonlinear = {"Lp": ("1/s", -20, 0), "La": "1/s^2"}
    linear_dynamic = ["La"]
    noise = {"p": "rad/s/sqrt(s)"}

    def rate(self, x: Any, u: Any, p: Any) -> Any:
        """P' = Lp p + La aileron."""
        Lp, La = p
        return [Lp * x[0] + La * u.aileron]

    def at(self, x: Any, u: Any, p: Any) -> Any:
        """P with a bias."""
        return [[1.0]], [x[0]]


class ShortPeriod:
    """sepcal.ShortPeriod, written again."""

    inputs = {"elevator": "rad", "airspeed": "m/s"}
    states = {"alpha": "rad", "q": "rad/s"}
    outputs = {"alpha_m": "rad", "q_m": "rad/s", "az_m": "m/s^2"}
    linear = {"b_alpha": "rad", "b_q": "rad/s", "b_az": "m/s^2"}
    nonlinear = {
        "Za": ("1/s", -20, 0),
        "Ma": ("1/s^2", -200, 20),
        "Mq": ("1/s", -20, 0),
        "Zd": "1/s",
        "Md": "1/s^2",
    }
    linear_dynamic = ["Zd", "Md"]
    acts_on = {"b_alpha": ["alpha_m"], "b_q": ["q_m"], "b_az": ["az_m"]}
    noise = {"alpha": "rad/sqrt(s)", "q": "rad/s/sqrt(s)"}

    def rate(self, x: Any, u: Any, p: Any) -> Any:
        """Of alpha and q."""
        alpha, q = x
        Za, Ma, Mq, Zd, Md = p
        return Za * alpha + q + Zd * u.elevator, Ma * alpha + Mq * q + Md * u.elevator

    def at(self, x: Any, u: Any, p: Any) -> Any:
        """Readings with a bias each."""
        alpha, q = x
        Za, _, _, Zd, _ = p
        return np.eye(3).tolist(), [alpha, q, u.airspeed * (Za * alpha + Zd * u.elevator)]


class Pendulum:
    """x'' = -w^2 sin x - d x' + g u; reads (1 + s) x + b and x', and starts there."""

    inputs = {"u": "1"}
    states = {"x": "rad", "v": "rad/s"}
    outputs = {"x_m": "rad", "v_m": "rad/s"}
    linear = {"s": "1", "b": "rad"}
    nonlinear = {"w": ("rad/s", 0.5, 6), "d": ("1/s", 0, 2), "g": ("rad/s^2", -10, 10)}
    acts_on = {"s": ["x_m"], "b": ["x_m"]}
    scales = ["s"]
    noise = {"v": "rad/s/sqrt(s)"}

    def rate(self, x: Any, u: Any, p: Any) -> Any:
        """Of angle and rate."""
        w, d, g = p
        return x[1], -(w**2) * np.sin(x[0]) - d * x[1] + g * u.u

    def at(self, x: Any, u: Any, p: Any) -> Any:
        """The scale multiplies the angle; the rate is read as it is."""
        return [[x[0], 1.0], [0.0, 0.0]], x

    def start(self, u: Any, z: Any) -> Any:
        """As read."""
        return z.x_m, z.v_m


ROLL = {  # of examples/18_own_state_model.cpp and 20_own_state_model.py
    "time": np.arange(21) / 10,
    "aileron": np.repeat([0.0, 0.1, -0.1, 0.05], [1, 8, 7, 5]),
    "p_m": np.array([
        0.051, 0.1, 0.188, 0.254, 0.312, 0.353, 0.384, 0.412, 0.431, 0.336, 0.159,
        0.023, -0.086, -0.168, -0.233, -0.281, -0.239, -0.129, -0.044, 0.024, 0.076,
    ]),
}  # fmt: skip
PERIOD = {"Za": -4.0, "Ma": -40.0, "Mq": -5.0, "Zd": -0.35, "Md": -45.0}
SWING = {"w": 3.0, "d": 0.4, "g": 2.0, "s": 0.05, "b": 0.02, "x_0": 0.8, "v_0": -0.3}


def excite(time: np.ndarray, size: float) -> np.ndarray:
    """Steps of either sign, then a sweep."""
    steps = np.sign(np.sin(4.0 * time) + 0.3) * (time < 0.4 * time[-1])
    return size * (steps + np.sin(0.6 * time**2) * (time >= 0.4 * time[-1]))


def integrate(
    model: Any, time: np.ndarray, inputs: dict, p: Any, x0: Any, hold=False
) -> np.ndarray:
    """X at every row, (n_x, rows), by an adaptive method from row to row."""
    p = np.asarray(p, dtype=float)[:, np.newaxis]
    columns = {name: inputs[name] for name in model.inputs}
    states = [np.asarray(x0, dtype=float)]
    for k in range(len(time) - 1):

        def slope(t: float, x: np.ndarray, k: int = k) -> np.ndarray:
            share = 0.0 if hold else (t - time[k]) / (time[k + 1] - time[k])
            at = {name: c[k] + share * (c[k + 1] - c[k]) for name, c in columns.items()}
            u = type("U", (), {name: np.array([value]) for name, value in at.items()})
            return np.array([np.ravel(r)[0] for r in model.rate(x[:, np.newaxis], u, p)])

        span = (time[k], time[k + 1])
        found = solve_ivp(slope, span, states[-1], method="DOP853", rtol=1e-12, atol=1e-13)
        states.append(found.y[:, -1])
    return np.array(states).T


def fly_short_period(rows: int = 300, seed: int = 1, x0: Any = (0.01, -0.05)) -> dict:
    """Biases 0.02, -0.01, 0.5; noise of 0.005 rad, 0.01 rad/s, 0.15 m/s^2, alpha in steps."""
    rng = np.random.default_rng(seed)
    time = 0.02 * np.arange(rows)
    data = {"time": time, "elevator": excite(time, 0.05), "airspeed": np.full(rows, 25.0)}
    alpha, q = integrate(ShortPeriod(), time, data, list(PERIOD.values()), x0)
    az = 25.0 * (PERIOD["Za"] * alpha + PERIOD["Zd"] * data["elevator"])
    noise = rng.standard_normal((3, rows)) * np.array([[0.005], [0.01], [0.15]])
    data["alpha_m"] = 0.001 * np.round((alpha + 0.02 + noise[0]) / 0.001)
    data["q_m"], data["az_m"] = q - 0.01 + noise[1], az + 0.5 + noise[2]
    return data


def swing(rows: int = 400, seed: int = 3, sigma: float = 0.01) -> dict:
    """A pendulum at rows that lie unevenly, SWING its truth."""
    rng = np.random.default_rng(seed)
    time = np.cumsum(rng.uniform(0.02, 0.06, rows))
    data = {"time": time, "u": excite(time - time[0], 1.0)}
    x, v = integrate(Pendulum(), time, data, [3.0, 0.4, 2.0], [0.8, -0.3])
    data["x_m"] = 1.05 * x + 0.02 + sigma * rng.standard_normal(rows)
    data["v_m"] = v + sigma * rng.standard_normal(rows)
    return data
