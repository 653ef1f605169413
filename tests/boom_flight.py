# SPDX-License-Identifier: BSD-3-Clause
"""A small aircraft with a boom: legs, turns and doublets in turbulence, of which a log is written.

The air is a vector that moves past the boom; what vanes and tube read of it is geometry. Nothing
here knows a calibration's equations.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.signal import lfilter
from scipy.spatial.transform import Rotation

Array = npt.NDArray[np.float64]

STEP = 0.1  # [s]
WIND = np.array([4.0, -2.5, 0.0])  # north, east, down [m/s]
ARM = (1.5, 0.0, -0.1)  # from the antenna to the boom's head, body axes [m]
GAS_CONSTANT = 287.05287  # of air [J/(kg K)]


@dataclass(frozen=True)
class Boom:
    """How the boom is not ideal: the air's angles are (1 + scale) reading + zero."""

    speed_scale: float = 0.04
    alpha_scale: float = -0.08  # the wing's upwash: the vane reads more than there is
    alpha_zero: float = 0.02  # [rad]
    beta_scale: float = -0.05
    beta_zero: float = -0.015  # [rad]
    per_flap: float = 0.0  # what alpha is more than that, per degree of flap [rad]
    heading: float = 0.0  # the logged yaw less the true one [rad]
    lag: float = 0.0  # time constant of the vanes [s]
    gusts: float = 0.1  # [m/s]: a calm morning
    noise: bool = True  # of all that is logged, and steps of the vanes


def fly(boom: Boom = Boom(), seed: int = 1, rows: int = 2400) -> dict[str, Array]:
    """Columns of a log, each of shape (rows,)."""
    draw = np.random.default_rng(seed)
    time = STEP * np.arange(rows)
    roll, pitch, yaw, speed, alpha, beta = _manoeuvre(time)
    to_navigation = Rotation.from_euler("ZYX", np.stack([yaw, pitch, roll], axis=-1))
    rates = _body_rates(roll, pitch, yaw)
    through_air = to_navigation.apply(
        speed[:, None]
        * np.stack(
            [np.cos(alpha) * np.cos(beta), np.sin(beta), np.sin(alpha) * np.cos(beta)], axis=-1
        )
    )
    over_ground = through_air + WIND
    gust = boom.gusts * np.stack([_wander(draw, rows, scale) for scale in (4.0, 4.0, 2.0)], axis=-1)
    at_head = to_navigation.apply(through_air - gust, inverse=True) + np.cross(rates, ARM)

    flap = _follow(np.select([time % 39 < 13, time % 39 < 26], [0.0, 10.0], 25.0), 1.0)
    altitude = 400.0 + np.cumsum(-over_ground[:, 2]) * STEP
    temperature = 288.15 - 0.0065 * altitude
    pressure = 101_325.0 * (temperature / 288.15) ** 5.2559
    density = pressure / (GAS_CONSTANT * temperature)
    tube = np.linalg.norm(at_head, axis=1) / (1 + boom.speed_scale)
    zero = boom.alpha_zero + boom.per_flap * flap
    vanes = [
        (np.arctan2(at_head[:, 2], at_head[:, 0]) - zero) / (1 + boom.alpha_scale),
        (np.arctan2(at_head[:, 1], at_head[:, 0]) - boom.beta_zero) / (1 + boom.beta_scale),
    ]
    if boom.lag > 0:
        vanes = [_lag(vane, boom.lag) for vane in vanes]
    dp = 0.5 * density * tube**2
    errors = np.zeros((rows, 3))
    if boom.noise:
        turn = np.deg2rad(0.1)  # a step of the vanes' encoders
        vanes = [turn * np.round((vane + draw.normal(0, turn, rows)) / turn) for vane in vanes]
        dp = dp + draw.normal(0, 1.0, rows)
        errors = 0.04 * np.stack([_wander(draw, rows, 8.0) for _ in range(3)], axis=-1)
        errors = errors + draw.normal(0, 0.03, (rows, 3))
    north, east, down = (over_ground + errors).T
    logged_yaw = yaw + boom.heading
    return {
        "time_s": time,
        "roll_rad": roll,
        "pitch_rad": pitch,
        "yaw_rad": np.arctan2(np.sin(logged_yaw), np.cos(logged_yaw)),
        "p_radps": rates[:, 0],
        "q_radps": rates[:, 1],
        "r_radps": rates[:, 2],
        "vn_mps": north,
        "ve_mps": east,
        "vd_mps": down,
        "alpha_rad": vanes[0],
        "beta_rad": vanes[1],
        "dp_pa": dp,
        "ps_pa": pressure,
        "temp_k": temperature,
        "altitude_m": altitude,
        "flap_deg": flap,
        "throttle": 0.5 + 0.02 * (speed - 21.0) + 0.1 * np.sin(time / 17.0),
    }


def _manoeuvre(time: Array) -> tuple[Array, ...]:
    """Roll, pitch, yaw, airspeed, angle of attack and of sideslip, all smooth."""
    legs = np.select([time % 60 < 15, time % 60 < 30], [0.0, 0.55], 0.0)
    from_bank_to_bank = np.where(time % 60 < 30, 0.0, 0.6 * np.sign(np.sin(2 * np.pi * time / 8)))
    bank = _follow(legs + from_bank_to_bank, 0.9)
    speed = 21.0 + _follow(4.0 * np.sign(np.sin(2 * np.pi * time / 47.0)), 3.0)
    yaw = 0.3 + np.cumsum(9.81 * np.tan(bank) / speed) * STEP
    alpha = 0.03 + 0.05 * (21.0 / speed) ** 2 / np.cos(bank)
    alpha = alpha + _follow(0.04 * np.sign(np.sin(2 * np.pi * time / 7.3)), 0.8)
    beta = _follow(0.06 * np.sign(np.sin(2 * np.pi * time / 10.9)), 1.0)
    climb = _follow(0.05 * np.sign(np.sin(2 * np.pi * time / 83.0)), 4.0)
    return bank, alpha + climb, yaw, speed, alpha, beta


def _body_rates(roll: Array, pitch: Array, yaw: Array) -> Array:
    """p, q, r [rad/s], shape (N, 3)."""
    roll_rate, pitch_rate, yaw_rate = (np.gradient(angle, STEP) for angle in (roll, pitch, yaw))
    return np.stack(
        [
            roll_rate - yaw_rate * np.sin(pitch),
            pitch_rate * np.cos(roll) + yaw_rate * np.sin(roll) * np.cos(pitch),
            yaw_rate * np.cos(roll) * np.cos(pitch) - pitch_rate * np.sin(roll),
        ],
        axis=-1,
    )


def _follow(wanted: Array, seconds: float) -> Array:
    """What follows with a time constant, from where it begins."""
    keep = np.exp(-STEP / seconds)
    first = np.array([keep * wanted[0]])
    return np.asarray(lfilter([1 - keep], [1.0, -keep], wanted, zi=first)[0])


def _lag(true: Array, tau: float) -> Array:
    """First order, tau dx/dt + x = true, of straight lines between the rows."""
    share = STEP / (2 * tau + STEP)
    keep = (2 * tau - STEP) / (2 * tau + STEP)
    first = np.array([(keep + share) * true[0]])
    return np.asarray(lfilter([share, share], [1.0, -keep], true, zi=first)[0])


def _wander(draw: np.random.Generator, rows: int, seconds: float) -> Array:
    """A Gauss-Markov process of variance one."""
    keep = np.exp(-STEP / seconds)
    pushes = draw.normal(0, np.sqrt(1 - keep**2), rows)
    first = np.array([keep * draw.normal()])
    return np.asarray(lfilter([1.0], [1.0, -keep], pushes, zi=first)[0])
