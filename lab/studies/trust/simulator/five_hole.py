# SPDX-License-Identifier: BSD-3-Clause
"""A five-hole probe: V = C_b^n [C(eps) V_s - w x r] + W, V_s of its airspeed and flow angles."""

from __future__ import annotations

import numpy as np

from studies.trust.noises import Array
from studies.trust.simulator.instrument import (
    AIR_PORTS,
    ATTITUDE,
    RATES,
    SEA_LEVEL,
    VELOCITY,
    Change,
    Columns,
    Instrument,
    Truth,
    density_of,
    driven,
    stack,
    turn,
    wind_of,
)
from studies.trust.simulator.manoeuvres import Motion, rotation

SENSITIVITY = 4.5  # of the flow-angle ports [1/rad]
LEVER_ARM = (0.35, 0.0, -0.02)  # [m]


def _draw_truth(rng: np.random.Generator) -> Truth:
    return {
        "lambda_va": rng.uniform(-0.08, 0.08),
        "b_va": rng.uniform(-0.5, 0.5),
        "w_n": rng.uniform(-6.0, 6.0),
        "w_e": rng.uniform(-6.0, 6.0),
        "w_d": rng.uniform(-0.2, 0.2),
        "lambda_alpha": rng.uniform(-0.1, 0.1),
        "b_alpha": rng.uniform(-0.03, 0.03),
        "lambda_beta": rng.uniform(-0.1, 0.1),
        "b_beta": rng.uniform(-0.03, 0.03),
        "eps_phi": rng.uniform(-0.05, 0.05),
    }


def _measure(motion: Motion, truth: Truth, change: Change, gust: Array) -> Columns:
    wind = wind_of(truth, change, motion.time.size)
    ground = motion.through_air + wind
    to_body = rotation(motion.attitude).transpose(0, 2, 1)
    met = turn(to_body, ground - wind - gust) + np.cross(motion.rates, LEVER_ARM)
    cosine, sine = np.cos(truth["eps_phi"]), np.sin(truth["eps_phi"])
    along, across, down = met.T
    across, down = cosine * across - sine * down, sine * across + cosine * down
    speed = np.linalg.norm(met, axis=-1)
    alpha = (np.arctan2(down, along) - truth["b_alpha"]) / (1.0 + truth["lambda_alpha"])
    beta = (np.arcsin(across / speed) - truth["b_beta"]) / (1.0 + truth["lambda_beta"])
    read = (speed - truth["b_va"] - driven(change, "airspeed_bias")) / (
        1.0 + truth["lambda_va"] + driven(change, "airspeed_scale")
    )
    density = density_of(motion)
    static = 101325.0 * (density / SEA_LEVEL) ** 1.235
    pressure = 0.5 * density * read**2 - driven(change, "pressure_offset")
    log = {"time_s": motion.time}
    log |= dict(zip(ATTITUDE, motion.attitude.T, strict=True))
    log |= dict(zip(RATES, motion.rates.T, strict=True))
    log |= dict(zip(VELOCITY, ground.T, strict=True))
    return log | {
        "pt_pa": static + pressure,
        "ps_pa": static,
        "dpa_pa": SENSITIVITY * pressure * alpha,
        "dpb_pa": SENSITIVITY * pressure * beta,
        "rho_kgpm3": density,
    }


def _predict(log: Columns, truth: Truth, change: Change) -> Array:
    pressure = log["pt_pa"] - log["ps_pa"]
    held = pressure + driven(change, "pressure_offset")
    read = np.sqrt(2.0 * held / log["rho_kgpm3"])
    speed = (1.0 + truth["lambda_va"] + driven(change, "airspeed_scale")) * read
    speed = speed + truth["b_va"] + driven(change, "airspeed_bias")
    per_radian = SENSITIVITY * pressure
    alpha = (1.0 + truth["lambda_alpha"]) * log["dpa_pa"] / per_radian + truth["b_alpha"]
    beta = (1.0 + truth["lambda_beta"]) * log["dpb_pa"] / per_radian + truth["b_beta"]
    along, across, down = (
        speed * np.cos(alpha) * np.cos(beta),
        speed * np.sin(beta),
        speed * np.sin(alpha) * np.cos(beta),
    )
    cosine, sine = np.cos(truth["eps_phi"]), np.sin(truth["eps_phi"])
    across, down = cosine * across + sine * down, cosine * down - sine * across
    rates = stack(log, RATES)
    met = np.stack([along, across, down], axis=-1) - np.cross(rates, LEVER_ARM)
    attitude = stack(log, ATTITUDE)
    return turn(rotation(attitude), met) + wind_of(truth, change, len(met))


FIVE_HOLE = Instrument(
    name="five-hole",
    lively=False,
    outputs=VELOCITY,
    ports=AIR_PORTS,
    draw_truth=_draw_truth,
    measure=_measure,
    predict=_predict,
)
