# SPDX-License-Identifier: BSD-3-Clause
"""Calibrations of a short simulated flight with hostile names, for what is exported of them."""

from __future__ import annotations

import functools
import json
from pathlib import Path

import numpy as np

import sepcal

ROWS = 200
FIELD = (19.7, -1.4, 49.4)


@functools.cache
def flown(kind: str) -> sepcal.SimulatedFlight:
    model = sepcal.PitotStatic() if kind == "tube" else sepcal.Magnetometer()
    return sepcal.simulate(model, rows=ROWS, seed=3)


def with_columns(kind: str, names: list[str], name: str = "flight") -> sepcal.Flight:
    """The flight with so many columns more, which wander. Raises sepcal.Error for a bad name."""
    noise = np.random.default_rng(1)
    columns = {header: flown(kind)[header] for header in flown(kind)}
    columns |= {column: np.cumsum(noise.normal(size=ROWS)) * 0.05 for column in names}
    return sepcal.Flight(columns, name=name)


@functools.cache
def as_json(kind: str) -> str:
    """Of a tube, or of a magnetometer by the field's strength."""
    model = sepcal.PitotStatic() if kind == "tube" else sepcal.Magnetometer(field_strength=53.2)
    sepcal.fit(model, flown(kind)).save("base.json")
    return Path("base.json").read_text()


def spoilt(kind: str, message: str, file: str) -> sepcal.Calibration:
    """Raises sepcal.Error for what no calibration says."""
    told = json.loads(as_json(kind))
    told["message"], told["inputs"]["file"] = message, file
    Path("spoilt.json").write_text(json.dumps(told))
    return sepcal.load("spoilt.json")
