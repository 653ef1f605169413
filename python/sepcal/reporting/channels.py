# SPDX-License-Identifier: BSD-3-Clause
"""A flight's columns as the report draws them: in the units used inside, on the rows of a fit."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sepcal.columns import Array
from sepcal.flight import Flight

Rows: TypeAlias = NDArray[np.intp]  # indices

GAS_CONSTANT = 287.05287  # of dry air [J/(kg K)]
GAP = 5.0  # median intervals: a longer one starts a new segment

# Headers' units: factor to the unit used inside, and that unit. degc has its offset below.
UNITS = {
    "s": (1.0, "s"), "ms": (1e-3, "s"), "us": (1e-6, "s"),
    "rad": (1.0, "rad"), "deg": (np.pi / 180, "rad"),
    "radps": (1.0, "rad/s"), "degps": (np.pi / 180, "rad/s"),
    "mps": (1.0, "m/s"), "kt": (1852 / 3600, "m/s"), "kmh": (1 / 3.6, "m/s"),
    "pa": (1.0, "Pa"), "hpa": (100.0, "Pa"), "kpa": (1000.0, "Pa"),
    "psi": (6894.757293168361, "Pa"), "torr": (101325 / 760, "Pa"),
    "ut": (1.0, "uT"), "nt": (1e-3, "uT"), "gauss": (100.0, "uT"), "mgauss": (0.1, "uT"),
    "k": (1.0, "K"), "degc": (1.0, "K"), "kgpm3": (1.0, "kg/m^3"),
}  # fmt: skip
HEADERS = {"temperature": "temp"}  # quantities whose header has another name


def quantity(flight: Flight, name: str) -> Array | None:
    """The column `<name>_<unit>` in the unit used inside, (rows,); None where there is none."""
    for header in flight:
        stem, _, unit = header.rpartition("_")
        if stem == name and unit in UNITS:
            return flight[header] * UNITS[unit][0] + (273.15 if unit == "degc" else 0.0)
    return None


def density(flight: Flight) -> Array | None:
    """As logged, or ps / (R T) [kg/m^3]."""
    logged = quantity(flight, "rho")
    pressure, temperature = quantity(flight, "ps"), quantity(flight, "temp")
    if logged is not None or pressure is None or temperature is None:
        return logged
    return pressure / (GAS_CONSTANT * temperature)


def airspeed(flight: Flight) -> Array | None:
    """As read: the column, or from the pressures [m/s]; NaN where total is below static."""
    logged = quantity(flight, "airspeed")
    pressure, rho = impact_pressure(flight), density(flight)
    if logged is not None or pressure is None or rho is None:
        return logged
    speed: Array = np.sqrt(2 * np.where(pressure >= 0, pressure, np.nan) / rho)
    return speed


def impact_pressure(flight: Flight) -> Array | None:
    """Total minus static [Pa]."""
    total, static = quantity(flight, "pt"), quantity(flight, "ps")
    if total is None or static is None:
        return quantity(flight, "dp")
    return total - static


def flow_angle(flight: Flight, name: str, options: Mapping[str, Any]) -> Array | None:
    """Alpha or beta as read [rad]; NaN where total is not above static."""
    sensitivity: float | None = options.get(f"k_{name}")
    ports = quantity(flight, {"alpha": "dpa", "beta": "dpb"}[name])
    pressure = impact_pressure(flight)
    if ports is None or pressure is None or sensitivity is None:
        return None
    return ports / (sensitivity * np.where(pressure > 0, pressure, np.nan))


def heading(flight: Flight) -> tuple[Array, str] | None:
    """Where the nose points, or else where the track goes [deg, 0 to 360], and which it is."""
    yaw = quantity(flight, "yaw")
    if yaw is not None:
        return np.degrees(yaw) % 360, "heading"
    north, east = quantity(flight, "vn"), quantity(flight, "ve")
    if north is None or east is None:
        return None
    return np.degrees(np.arctan2(east, north)) % 360, "track over ground"


def driver(flight: Flight, name: str, options: Mapping[str, Any]) -> Array | None:
    """The values of what compare() calls a channel; None where they aren't in the flight."""
    if name in flight:
        return flight[name]
    if name in ("alpha", "beta"):
        return flow_angle(flight, name, options)
    if name == "rho":
        return density(flight)
    return quantity(flight, HEADERS.get(name, name))


def find_rows(flight: Flight, time: Array) -> Rows:
    """Row of each time [s] of a comparison, shape (N,)."""
    logged = quantity(flight, "time")
    if logged is None:
        return np.arange(time.size)
    valid = np.flatnonzero(np.isfinite(logged))
    after = np.clip(np.searchsorted(logged[valid], time), 0, valid.size - 1)
    before = np.maximum(after - 1, 0)
    nearer = np.abs(logged[valid[before]] - time) < np.abs(logged[valid[after]] - time)
    rows: Rows = valid[np.where(nearer, before, after)]
    return rows


def find_segments(time: Array, labels: list[str]) -> list[slice]:
    """Stretches without a gap or a change of label, in order."""
    if time.size < 2:
        return [slice(0, time.size)]
    steps = np.diff(time)
    cut = steps > GAP * np.median(steps)
    if labels:
        names = np.array(labels)
        cut |= names[1:] != names[:-1]
    edges = [0, *(np.flatnonzero(cut) + 1).tolist(), time.size]
    return [slice(first, last) for first, last in itertools.pairwise(edges)]
