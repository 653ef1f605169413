# SPDX-License-Identifier: BSD-3-Clause
"""A record that determines each model that ships: inputs, the truth and the outputs' noise.

The inputs excite every parameter; they need be no flight.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from sepcal._core import Error
from sepcal.columns import Array
from sepcal.models import (
    FiveHoleProbe,
    Magnetometer,
    Model,
    PitotStatic,
    ScalarExample1,
    ScalarExample2,
    VaneBoom,
)
from sepcal.trajectories import FlightPath, ShortPeriod

GRAVITY = 9.80665  # [m/s^2]
DENSITY = 1.15  # [kg/m^3]
FIELD = 53.0  # [uT]


@dataclass(frozen=True, eq=False)
class Design:
    """The inputs, truth and noise for a study of a model."""

    model: Model
    inputs: dict[str, Array]  # (N,) each
    truth: dict[str, float]
    scatter: dict[str, float]  # by output


def make_design(name: str, rows: int) -> Design:
    """That of a model by its name. Raises Error for another name, and for too few rows."""
    if name not in DESIGNS:
        raise Error(f"there is no model '{name}'; known: {', '.join(DESIGNS)}")
    if rows < FEWEST_ROWS:
        raise Error(f"{rows} rows are too few for {name}; give at least {FEWEST_ROWS}")
    return DESIGNS[name](rows)


def _design(
    model: Model, inputs: dict[str, Array], truth: Mapping[str, float], *scatter: float
) -> Design:
    """Makes a design; parameters that aren't named are zero."""
    return Design(
        model,
        inputs,
        dict.fromkeys(model.parameters, 0.0) | dict(truth),
        dict(zip(model.outputs, scatter, strict=True)),
    )


def _scalar_1(rows: int) -> Design:
    inputs = {"eta": np.linspace(1.0, 10.0, rows)}
    return _design(ScalarExample1(), inputs, {"a": 1.0, "c": 1.0, "b": 0.1}, 0.3)


def _scalar_2(rows: int) -> Design:
    inputs = {"eta": np.linspace(1.0, 10.0, rows)}
    return _design(ScalarExample2(), inputs, {"a": 1.0, "d": 1.0, "b": 0.05, "c": 0.1}, 0.3)


def _swings(rows: int, *periods: float) -> Array:
    """A sum of sines of so many periods over the record, of rms one, (N,)."""
    turns = 2.0 * np.pi * np.linspace(0.0, 1.0, rows)
    waves = [np.sin(count * turns + 1.7 * k) for k, count in enumerate(periods)]
    total: Array = np.sum(waves, axis=0) * np.sqrt(2.0 / len(periods))
    return total


def _motion(rows: int) -> dict[str, Array]:
    """Attitude and rates of a probe that reads flow angles."""
    return {
        "roll": 0.4 * _swings(rows, 3.1, 7.7),
        "pitch": 0.1 + 0.15 * _swings(rows, 2.7, 8.3),
        "yaw": np.linspace(0.0, 3.0 * np.pi, rows),
        "p": 0.5 * _swings(rows, 3.1, 9.7),
        "q": 0.3 * _swings(rows, 2.9, 8.3),
        "r": 0.2 + 0.1 * _swings(rows, 1.9, 6.1),
    }


def _flow(rows: int) -> tuple[Array, Array, Array]:
    """Airspeed [m/s] and the two flow angles [rad] as such a probe reads them."""
    return (
        18.0 + 3.0 * _swings(rows, 2.3, 5.1),
        0.08 + 0.06 * _swings(rows, 4.3, 11.9),
        0.06 * _swings(rows, 5.3, 13.1),
    )


FLOW_TRUTH = {
    "lambda_va": 0.05, "b_va": 0.6, "w_n": -3.8, "w_e": 2.4, "w_d": 0.3,
    "lambda_alpha": 0.08, "b_alpha": -0.035, "lambda_beta": -0.06, "b_beta": 0.02,
    "eps_phi": 0.05,
}  # fmt: skip


def _five_hole(rows: int) -> Design:
    model = FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
    speed, alpha, beta = _flow(rows)
    dynamic = 0.5 * DENSITY * speed**2
    static = np.full(rows, 95_000.0)
    inputs = _motion(rows) | {
        "pt": static + dynamic,
        "ps": static,
        "dpa": model.k_alpha * dynamic * alpha,
        "dpb": model.k_beta * dynamic * beta,
        "rho": np.full(rows, DENSITY),
    }
    return _design(model, inputs, FLOW_TRUTH, 0.15, 0.12, 0.2)


def _vane_boom(rows: int) -> Design:
    inputs = _motion(rows) | dict(zip(("airspeed", "alpha", "beta"), _flow(rows), strict=True))
    return _design(VaneBoom(lever_arm=(1.2, 0.0, -0.1)), inputs, FLOW_TRUTH, 0.15, 0.12, 0.2)


def _pitot_static(rows: int) -> Design:
    track = np.linspace(0.0, 4.0 * np.pi, rows)
    speed = 25.0 + 4.0 * _swings(rows, 2.3, 5.7)
    inputs = {
        "vn": speed * np.cos(track) - 3.8,
        "ve": speed * np.sin(track) + 2.4,
        "vd": 0.8 * _swings(rows, 3.1, 7.3),
    }
    return _design(
        PitotStatic(), inputs, {"s_va": 0.95, "c_va": -0.6, "w_n": -3.8, "w_e": 2.4}, 0.25
    )


def _directions(rows: int) -> Array:
    """Unit vectors about the whole sphere, (3, N)."""
    height = np.linspace(-1.0, 1.0, rows)
    angle = np.pi * (1.0 + np.sqrt(5.0)) * np.arange(rows)
    flat = np.sqrt(1.0 - height**2)
    return np.stack([flat * np.cos(angle), flat * np.sin(angle), height])


MAGNETIC_TRUTH = {
    "lambda_x": 0.04, "lambda_y": -0.03, "lambda_z": 0.02, "n_x": 12.0, "n_y": -7.0, "n_z": 3.5,
    "alpha_xy": 0.01, "alpha_xz": -0.02, "alpha_yz": 0.015,
}  # fmt: skip


def _magnetometer(rows: int) -> Design:
    inputs = dict(zip(("hx", "hy", "hz"), FIELD * _directions(rows), strict=True))
    truth = MAGNETIC_TRUTH | {"eta_x": 0.02, "eta_y": -0.015, "eta_z": 0.03}
    return _design(Magnetometer(), inputs, truth, 0.3, 0.5, 0.4)


def _field_strength(rows: int) -> Design:
    field = dict(zip(("hx", "hy", "hz"), FIELD * _directions(rows), strict=True))
    sensor = Magnetometer()
    values = dict.fromkeys(sensor.parameters, 0.0) | MAGNETIC_TRUTH
    A, b = sensor.evaluate(field, {name: values[name] for name in sensor.nonlinear})
    readings = A @ np.array([values[name] for name in sensor.linear]) + b
    inputs = dict(zip(("mx", "my", "mz"), readings.T, strict=True))
    return _design(Magnetometer(field_strength=FIELD), inputs, MAGNETIC_TRUTH, 0.4)


def _short_period(rows: int) -> Design:
    inputs = {
        "time": 0.02 * np.arange(rows),
        "elevator": 0.04 * np.sign(_swings(rows, 7.3, 12.7)),
        "airspeed": np.full(rows, 55.0),
    }
    truth = {
        "Za": -1.2, "Ma": -8.0, "Mq": -1.8, "Zd": -0.1, "Md": -10.0,
        "b_alpha": 0.01, "b_q": -0.005, "b_az": 0.2, "alpha_0": 0.02, "q_0": -0.01,
    }  # fmt: skip
    return _design(ShortPeriod(), inputs, truth, 0.003, 0.004, 0.15)


def _flight_path(rows: int) -> Design:
    time = 0.05 * np.arange(rows)
    roll, pitch = 0.5 * _swings(rows, 2.3, 5.1), 0.06 + 0.05 * _swings(rows, 3.7, 6.3)
    yaw = np.linspace(0.0, 2.0 * np.pi, rows) + 0.2 * _swings(rows, 1.9)
    u = 30.0 + 3.0 * _swings(rows, 1.7, 4.1)
    v, w = 0.8 * _swings(rows, 4.9), 1.5 + 0.7 * _swings(rows, 3.3, 7.9)
    roll_rate, pitch_rate, yaw_rate, du, dv, dw = (
        np.gradient(values, time) for values in (roll, pitch, yaw, u, v, w)
    )
    p: Array = roll_rate - yaw_rate * np.sin(pitch)
    q = pitch_rate * np.cos(roll) + yaw_rate * np.sin(roll) * np.cos(pitch)
    r = yaw_rate * np.cos(roll) * np.cos(pitch) - pitch_rate * np.sin(roll)
    inputs: dict[str, Array] = {
        "time": np.asarray(time, dtype=np.float64),
        "ax": du + q * w - r * v + GRAVITY * np.sin(pitch),
        "ay": dv + r * u - p * w - GRAVITY * np.cos(pitch) * np.sin(roll),
        "az": dw + p * v - q * u - GRAVITY * np.cos(pitch) * np.cos(roll),
        "p": p,
        "q": q,
        "r": r,
    }
    truth = {
        "lambda_v": 0.03, "lambda_beta": -0.05, "lambda_alpha": 0.06, "b_beta": 0.01,
        "b_phi": 0.004, "b_theta": -0.003, "w_n": -3.0, "w_e": 2.0, "w_d": 0.2,
        "b_ax": 0.03, "b_ay": -0.02, "b_az": 0.05, "b_p": 0.001, "b_q": -0.0008, "b_r": 0.0006,
        "u_0": u[0], "v_0": v[0], "w_0": w[0],
        "phi_0": roll[0], "theta_0": pitch[0], "psi_0": yaw[0],
    }  # fmt: skip
    angles, velocities = (0.002, 0.002, 0.003), (0.1, 0.1, 0.15)
    return _design(FlightPath(), inputs, truth, 0.2, 0.004, 0.004, *angles, *velocities)


FEWEST_ROWS = 100
DESIGNS: dict[str, Callable[[int], Design]] = {
    "scalar-1": _scalar_1,
    "scalar-2": _scalar_2,
    "five-hole": _five_hole,
    "vane-boom": _vane_boom,
    "pitot-static": _pitot_static,
    "magnetometer": _magnetometer,
    "magnetometer-norm": _field_strength,
    "short-period": _short_period,
    "path": _flight_path,
}
