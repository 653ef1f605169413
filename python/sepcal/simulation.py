# SPDX-License-Identifier: BSD-3-Clause
"""Flights from physics, to try a calibration on."""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from sepcal import _core
from sepcal.arguments import checked, shown
from sepcal.flight import Flight
from sepcal.geometry import Aircraft
from sepcal.states_module import states_module


class SimulatedFlight(Flight):
    """A flight with the truth behind it.

    Attributes:
        truth: The parameters' true values by name, those of hidden effects among them
            ("wind[altitude_m].n"). It may be given as the parameters of another simulation.
        effects: Names of the hidden effects, aliases resolved.

    Example:
        >>> sepcal.simulate("pitot-static", rows=100).truth["w_n"]
        -3.8
    """

    truth: dict[str, float]
    effects: tuple[str, ...]


class SimulatedProbe(Protocol):
    """A probe that can be flown: FiveHoleProbe, PitotStatic, Magnetometer."""

    name: str

    def _settings(self) -> dict[str, float | tuple[float, ...]]: ...


@checked
def simulate(
    model: SimulatedProbe | Aircraft | str,
    *,
    truth: Mapping[str, Any] | None = None,
    parameters: Mapping[str, float] | None = None,
    hide: Mapping[str, float | Sequence[float]] | None = None,
    excitation: str = "rich",
    noise: Mapping[str, float] | str = "white",
    decoys: int = 0,
    rows: int = 0,
    rate: float = 50.0,
    seed: int = 0,
) -> SimulatedFlight:
    """Flies a calibration's manoeuvres; nothing in it runs an estimation model backwards.

    Args:
        model: The probe flown, or "five-hole", "pitot-static" or "magnetometer" with the
            simulation's own settings (k_alpha and k_beta 4.5, lever arm (0.35, 0, -0.02) m; field
            (19.7, -1.4, 49.4) uT); or an Aircraft, or "aircraft", a light one.
        truth: The contents of a truth file: {"parameters": {name: value}, "options": ..., "noise":
            {output: standard deviation}}; what it leaves out keeps the simulation's value.
        parameters: True values by name, in the parameters' units; they come before `truth`.
        hide: Physical effects at work, each with its size: one for every component, or one a
            component, followed by the shape (t0, tau, exponent) where there is one.
        excitation: "rich"; "poor", with little motion; "third", where the field's directions
            cover a third of the sphere (magnetometer alone).
        noise: How the noise runs: "white", "ar" (first order, 0.9), "pink" (1/f) or "bursty"; or
            standard deviations of white noise by output, which come before those of `truth`.
        decoys: So many columns decoy_1, ... that drive nothing.
        rows: 0: the full flight; else a condensed one of so many rows.
        rate: Sampling rate of the full flight [Hz].
        seed: The same seed, the same flight to the last bit.

    Raises:
        Error: A parameter, output, effect, driver or probe that there isn't, sizes of another
            number than the effect's components, or a value out of range.

    Example:
        >>> flight = sepcal.simulate("magnetometer", rows=300, hide={"bias[current_a]": 0.2})
        >>> flight.rows, flight.effects, flight.truth["bias[current_a].x"]
        (300, ('bias[current_a]',), 0.2)
    """
    kind, deviations = (noise, {}) if isinstance(noise, str) else ("white", dict(noise))
    given = dict(parameters or {})
    for key, value in {**given, **deviations}.items():
        if not math.isfinite(value):
            raise _core.Error(f"simulate: '{key}' is {value}; give a finite number")
    for name, count in (("rows", rows), ("seed", seed), ("decoys", decoys)):
        if count < 0:
            raise _core.Error(f"simulate: {name}={count} must not be negative")
    whole = dict(truth or {})
    whole["parameters"] = {**whole.get("parameters", {}), **given}
    whole["noise"] = {**whole.get("noise", {}), **deviations}
    if isinstance(model, Aircraft):
        whole["aircraft"] = json.loads(model.to_json())
    elif not isinstance(model, str):
        if not hasattr(model, "_settings"):
            raise _core.Error(f"{shown(model)} can't be flown; give a probe, or the name of one")
        whole["options"] = {**whole.get("options", {}), **model._settings()}
    try:
        text = json.dumps(whole, allow_nan=False)
    except ValueError as error:
        raise _core.Error("simulate: a number in the truth is not finite") from error
    hidden = [(name, np.ravel(sizes).tolist()) for name, sizes in (hide or {}).items()]
    rest = (text, hidden, excitation, kind, decoys, rate, rows, seed)
    if isinstance(model, Aircraft) or model == "aircraft":
        core, parameters_flown, effects = states_module().simulate(*rest)
    else:
        name = model if isinstance(model, str) else model.name
        core, parameters_flown, effects = _core.simulate(name, *rest)
    flight = SimulatedFlight._of(core)
    flight.truth = parameters_flown
    flight.effects = tuple(effects)
    return flight
