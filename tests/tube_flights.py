# SPDX-License-Identifier: BSD-3-Clause
"""Flights with a tube that reads the inverse of an autopilot's formula: the scale is known."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from oracle import autopilots
from oracle.model import Array

SEA_LEVEL = (101325.0, 288.15)  # static pressure [Pa], temperature [K]
HIGH_AND_HOT = (84000.0, 303.0)


@dataclass
class Air:
    """Of a flight: true airspeed (n,), static pressure [Pa] and temperature [K]."""

    speed: Array
    static: Array
    kelvin: Array

    @property
    def density(self) -> Array:
        """Of the air [kg/m^3]."""
        return self.static / (287.05287 * self.kelvin)

    @property
    def equivalent(self) -> Array:
        """The equivalent airspeed [m/s]."""
        return self.speed * np.sqrt(self.density / 1.225)


def fly(air: tuple[float, float], seed: int = 3, rows: int = 1200) -> tuple[dict[str, Array], Air]:
    """Turns at 13 to 25 m/s in a wind: the columns without the tube's, and the air."""
    draw = np.random.default_rng(seed)
    time = np.arange(rows) * 0.1
    speed = 19 + 6 * np.sin(time / 17)
    course = time / 9
    climb = 40 * np.sin(time / 30)
    static = air[0] - 11.5 * climb
    kelvin = air[1] - 0.0065 * climb
    wind = np.array([4.0, -2.5, 0.0])
    velocity = np.column_stack([speed * np.cos(course), speed * np.sin(course), np.zeros(rows)])
    measured = velocity + wind + draw.normal(0, 0.05, velocity.shape)
    columns = {"time_s": time}
    for axis, column in zip("ned", measured.T, strict=True):
        columns[f"v{axis}_mps"] = column
    columns |= {"ps_pa": static, "temp_degc": kelvin - 273.15}
    return columns, Air(speed, static, kelvin)


def solve(read: Callable[[float, int], float], wanted: Array) -> Array:
    """Pressures that are read as wanted, row by row."""

    def at(row: int) -> float:
        return float(brentq(lambda p: read(p, row) - wanted[row], 1e-6, 5000, xtol=1e-9))

    return np.array([at(row) for row in range(len(wanted))])


def px4_pressure(at: Air, scale: float, **settings: float) -> Array:
    """What an SDP3x shows [Pa] where an ASPD_SCALE_n of `scale` is right."""

    def read(pressure: float, row: int) -> float:
        air = at.static[row], at.kelvin[row]
        return float(autopilots.px4_sdp3x(np.array(pressure), *air, **settings))  # type: ignore[arg-type]

    return solve(read, at.equivalent / scale)


def ardupilot_pressure(at: Air, ratio: float) -> Array:
    """The same where an ARSPD_RATIO is right."""

    def read(pressure: float, row: int) -> float:
        air = at.static[row], at.kelvin[row]
        return float(np.sqrt(ratio * autopilots.ardupilot_sdp3x(np.array(pressure), *air, ratio)))

    return solve(read, at.equivalent)
