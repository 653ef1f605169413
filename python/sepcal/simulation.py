# SPDX-License-Identifier: BSD-3-Clause
"""Flights from physics, to try a calibration on."""

import json
import math
from collections.abc import Mapping

from sepcal import _core
from sepcal.flight import Flight
from sepcal.models import FiveHoleProbe, Magnetometer


class SimulatedFlight(Flight):
    """A flight with the truth behind it.

    Attributes:
        truth: The parameters' true values by name.
    """

    truth: dict[str, float]


def simulate(
    model: FiveHoleProbe | Magnetometer | str,
    *,
    parameters: Mapping[str, float] | None = None,
    noise: Mapping[str, float] | None = None,
    rows: int = 0,
    rate: float = 50.0,
    seed: int = 0,
) -> SimulatedFlight:
    """Flies a calibration's manoeuvres; nothing in it runs an estimation model backwards.

    Args:
        model: The probe flown, or "five-hole" or "magnetometer" with the simulation's own settings
            (k_alpha and k_beta 4.5, lever arm (0.35, 0, -0.02) m; field (19.7, -1.4, 49.4) uT).
        parameters: True values by name, in the parameters' units; the others keep the simulation's.
        noise: Standard deviation of outputs by name; the others keep the simulation's.
        rows: 0: the full flight; else a condensed one of so many rows.
        rate: Sampling rate of the full flight [Hz].
        seed: The same seed, the same flight to the last bit.

    Raises:
        Error: A parameter, output or probe that there isn't, or a value out of range.
    """
    if isinstance(model, str):
        name, settings = model, {}
    else:
        name, settings = model.name, model._settings()
    values = {"parameters": dict(parameters or {}), "noise": dict(noise or {})}
    for key, value in (item for given in values.values() for item in given.items()):
        if not math.isfinite(value):
            raise _core.Error(f"simulate: '{key}' is {value}; give a finite number")
    if rows < 0 or seed < 0:
        raise _core.Error(f"simulate: rows={rows} and seed={seed} must not be negative")
    truth = json.dumps({**values, "options": settings})
    core, true_parameters = _core.simulate(name, truth, rate, rows, seed)
    flight = SimulatedFlight._of(core)
    flight.truth = true_parameters
    return flight
