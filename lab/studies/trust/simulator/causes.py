# SPDX-License-Identifier: BSD-3-Clause
"""What is hidden in a flight: a port's change along time or a channel, as a line or a curve."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from studies.trust.noises import Array
from studies.trust.simulator.probes import INSTRUMENTS

SHAPES = ("drift", "step", "ramp", "swing")
DRIVERS = ("time", "temp_degc", "altitude_m", "throttle")
UNLIKELY = {("wind", "throttle")}  # a motor blows on the probe and not on the weather
OWN_NAMES = {  # of the catalogue, for what a port and a driver say
    "bias_step": "bias[step(time)]",
    "icing_ramp": "airspeed_scale[ramp(time)]",
    "water_blockage": "airspeed_scale[step(time)]",
    "bias_drift": "bias[time]",
    "wind_drift": "wind[time]",
    "wind_shear": "wind[altitude_m]",
    "propwash": "pressure_offset[throttle]",
}
POWER = re.compile(r"(\w+)\^\w+")
CURVE = re.compile(r"(?:spline|step|ramp|levels)\((\w+)(?:,[-\d.e]+)*\)")


@dataclass(frozen=True)
class Cause:
    """`step of bias along temp_degc`."""

    port: str
    shape: str
    driver: str

    @property
    def label(self) -> str:
        """As the study's keys have it."""
        return f"{self.shape} of {self.port} along {self.driver}"

    @classmethod
    def of(cls, label: str) -> Cause:
        """The reverse of `label`."""
        shape, port, driver = re.fullmatch(r"(\w+) of (\w+) along (\w+)", label).groups()  # type: ignore[union-attr]
        return cls(port, shape, driver)

    @property
    def effect(self) -> str:
        """What `add` takes for it: the shape where there is one, else a spline."""
        if self.shape == "drift":
            return f"{self.port}[{self.driver}]"
        if self.driver == "time" and self.shape != "swing":
            return f"{self.port}[{self.shape}(time)]"
        return f"{self.port}[spline({self.driver},{self.knots})]"

    @property
    def knots(self) -> int:
        """Of the spline that stands for the shape."""
        return 9 if self.shape == "step" else 6

    def is_named_by(self, effect: str) -> bool:
        """Whether the name says this port, this driver and a form that the shape has.

        Curves may stand for each other, a power for a ramp and a swing, and a line for a ramp,
        which is one in part; no curve for a line, and no line for a step or a swing.
        """
        port, _, driver = OWN_NAMES.get(effect, effect).removesuffix("]").partition("[")
        if port != self.port:
            return False
        if driver == self.driver:
            return self.shape in ("drift", "ramp")
        curve = CURVE.fullmatch(driver)
        if curve is None and self.shape in ("ramp", "swing"):
            curve = POWER.fullmatch(driver)
        return self.shape != "drift" and curve is not None and curve[1] == self.driver

    def draw(self, rng: np.random.Generator, driver: Array) -> Array:
        """(N,) of unit size, about its mean; along a throttle, zero where that is closed or least.

        A pressure has no constant in any model: a propeller's is none where it stands still.
        """
        least, most = np.quantile(driver, [0.02, 0.98])
        along = (driver - least) / (most - least)
        if self.shape == "drift":
            phi = driver
        elif self.shape == "step":
            phi = (along > np.quantile(along, rng.uniform(0.25, 0.75))).astype(float)
        elif self.shape == "ramp":
            phi = np.maximum(along - np.quantile(along, rng.uniform(0.2, 0.6)), 0.0)
        else:
            phi = np.sin(2.0 * np.pi * (rng.uniform(0.8, 1.5) * along + rng.uniform()))
        about = phi.mean()
        if self.driver == "throttle":
            about = 0.0 if self.shape == "drift" else phi[np.argmin(driver)]
        return np.asarray((phi - about) / phi.std())

    def columns(self, driver: Array, phi: Array) -> list[Array]:
        """What `effect` multiplies by its coefficients, the shape's time being known."""
        if self.shape == "drift" or (self.driver == "time" and self.shape != "swing"):
            return [phi]
        return natural_spline((driver - driver.min()) / np.ptp(driver), self.knots)


def natural_spline(x: Array, knots: int) -> list[Array]:
    """The basis but for its constant, knots evenly in [0, 1] (Hastie et al., Eq. 5.4 and 5.5)."""
    at = np.linspace(0.0, 1.0, knots)

    def cubic(k: int) -> Array:
        bent = np.maximum(x - at[k], 0.0) ** 3 - np.maximum(x - at[-1], 0.0) ** 3
        return np.asarray(bent / (at[-1] - at[k]))

    return [x, *(cubic(k) - cubic(knots - 2) for k in range(knots - 2))]


def causes_of(probe: str) -> Iterator[Cause]:
    """All that the study hides in a probe's flights."""
    for port in INSTRUMENTS[probe].ports:
        for driver in DRIVERS:
            if (port, driver) not in UNLIKELY:
                for shape in SHAPES:
                    yield Cause(port, shape, driver)
