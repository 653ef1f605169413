# SPDX-License-Identifier: BSD-3-Clause
"""Calibrations of every probe with three effects, and what flight programs are told of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import sepcal
from target_checks.machines import Array
from target_checks.probe_rows import K


@dataclass(frozen=True)
class Applied:
    """A calibration with three effects on its flight: what a program is told, and apply()'s answer.

    rows: (rows, inputs). answer: (rows, outputs).
    """

    name: str
    calibration: sepcal.Calibration
    numbers: Array
    answer: Array


def centre_of(calibration: sepcal.Calibration, effect: str) -> float:
    """What a driver's first power is counted from."""
    settings = calibration.to_dict()["options"]["effects"]
    found = next(one for one in settings if one["name"] == effect)
    return float(found["centre"] + found.get("mean", 0.0))  # of a first power


def told(
    centres: Sequence[float], calibration: sepcal.Calibration, names: Sequence[str], rows: Array
) -> Array:
    """What a program is told of a probe: centres, parameters, rows."""
    values = [calibration[name].value for name in names]
    return np.concatenate([centres, values, [rows.shape[0]], rows.ravel()])


def apply(
    name: str, calibration: sepcal.Calibration, flight: sepcal.Flight, numbers: Array
) -> Applied:
    """With what the calibration makes of the flight."""
    answer = np.column_stack(list(calibration.apply(flight).values()))
    return Applied(name, calibration, numbers, answer)


def apply_compass() -> Applied:
    """A current, a temperature, a curved response."""
    effects = ["bias[current_a]", "axis_scale[temp_degc]", "cubic_nonlinearity"]
    hidden: dict[str, float | Sequence[float]] = {
        "bias[current_a]": 0.3,
        "cubic_nonlinearity": [2e-6, 2e-6, 2e-6, 1e-5, 1e-5, 1e-5],
    }
    model = sepcal.Magnetometer(field=(19.7, -1.4, 49.4))
    flight = sepcal.simulate(model, hide=hidden, rows=400, seed=1)
    calibration = sepcal.fit(model, flight, effects=effects)
    names = [
        *("lambda_x", "lambda_y", "lambda_z", "n_x", "n_y", "n_z"),
        *(f"bias[current_a].{axis}" for axis in "xyz"),
        *(f"axis_scale[temp_degc].{axis}" for axis in "xyz"),
        *(f"cubic_nonlinearity.{term}_{axis}" for term in "dc" for axis in "xyz"),
        *("eta_x", "eta_y", "eta_z", "alpha_xy", "alpha_xz", "alpha_yz"),
    ]
    columns = ("mx_ut", "my_ut", "mz_ut", "current_a", "temp_degc")
    centres = [centre_of(calibration, effect) for effect in effects[:2]]
    rows = np.column_stack([flight[column] for column in columns])
    return apply("magnetometer", calibration, flight, told(centres, calibration, names, rows))


def apply_by_strength() -> Applied:
    """A current, a temperature, a supply."""
    effects = ["bias[current_a]", "scale[temp_degc]", "axis_scale[voltage_v]"]
    flight = sepcal.simulate("magnetometer", hide={"bias[current_a]": 0.3}, rows=400, seed=2)
    strength = 53.2
    model = sepcal.Magnetometer(field_strength=strength)
    calibration = sepcal.fit(model, flight, effects=effects)
    names = [
        *("lambda_x", "lambda_y", "lambda_z", "alpha_xy", "alpha_xz", "alpha_yz"),
        *("n_x", "n_y", "n_z"),
        *(f"bias[current_a].{axis}" for axis in "xyz"),
        "scale[temp_degc].s",
        *(f"axis_scale[voltage_v].{axis}" for axis in "xyz"),
    ]
    columns = ("mx_ut", "my_ut", "mz_ut", "current_a", "temp_degc", "voltage_v")
    centres = [strength, *(centre_of(calibration, effect) for effect in effects)]
    rows = np.column_stack([flight[column] for column in columns])
    return apply(
        "magnetometer by strength", calibration, flight, told(centres, calibration, names, rows)
    )


def apply_probe() -> Applied:
    """A throttle, a height, a current."""
    effects = ["airspeed_scale[throttle]", "wind[altitude_m]", "pressure_offset[current_a]"]
    model = sepcal.FiveHoleProbe(k_alpha=K, k_beta=K)
    flight = sepcal.simulate(model, hide={"airspeed_scale[throttle]": 0.05}, rows=400, seed=3)
    calibration = sepcal.fit(model, flight, effects=effects)
    names = [
        *("lambda_va", "b_va", "w_n", "w_e", "w_d", "airspeed_scale[throttle].s"),
        *("wind[altitude_m].n", "wind[altitude_m].e"),
        *("lambda_alpha", "b_alpha", "lambda_beta", "b_beta", "eps_phi"),
        "pressure_offset[current_a].s",
    ]
    columns = ("dpa_pa", "dpb_pa", "rho_kgpm3", "throttle", "altitude_m", "current_a")
    # current, throttle, altitude
    centres = [
        *(K, K),
        centre_of(calibration, effects[2]),
        centre_of(calibration, effects[0]),
        centre_of(calibration, effects[1]),
    ]
    difference = flight["pt_pa"] - flight["ps_pa"]
    rows = np.column_stack([difference, *(flight[column] for column in columns)])
    return apply("five-hole probe", calibration, flight, told(centres, calibration, names, rows))


def apply_tube() -> Applied:
    """The same of a tube."""
    effects = [
        "airspeed_scale[throttle]",
        "airspeed_bias[altitude_m]",
        "pressure_offset[current_a]",
    ]
    model = sepcal.PitotStatic()
    flight = sepcal.simulate(model, hide={"airspeed_scale[throttle]": 0.05}, rows=400, seed=4)
    calibration = sepcal.fit(model, flight, effects=effects)
    names = ["s_va", "c_va", "w_n", "w_e", "w_d", *(f"{effect}.s" for effect in effects)]
    columns = ("airspeed_mps", "rho_kgpm3", "throttle", "altitude_m", "current_a")
    centres = [centre_of(calibration, effect) for effect in effects]
    rows = np.column_stack([flight[column] for column in columns])
    return apply("Pitot-static tube", calibration, flight, told(centres, calibration, names, rows))


def apply_all() -> list[Applied]:
    """In the order in which the program takes them."""
    return [apply_compass(), apply_by_strength(), apply_probe(), apply_tube()]
