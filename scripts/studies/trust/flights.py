# SPDX-License-Identifier: BSD-3-Clause
"""Flights whose measurements are disturbed as recorded ones are."""

from __future__ import annotations

import numpy as np

from sepcal.flight import Flight
from sepcal.simulation import SimulatedFlight, simulate
from studies.hidden_effects.cases import NOISE, OUTPUTS
from studies.trust.noises import OUTPUT_NOISES, Array

HEADERS = {
    "five-hole": ("vn_mps", "ve_mps", "vd_mps"),
    "pitot-static": ("airspeed_mps",),
    "magnetometer": ("mx_ut", "my_ut", "mz_ut"),
}
FIELD = ("bn_ut", "be_ut", "bd_ut")  # from a model, not from a sensor
ATTITUDE = "attitude AR(0.99)"  # of the columns that the model believes
COARSE = "quantised"  # inputs and outputs in coarse steps
NOISES = (*OUTPUT_NOISES, ATTITUDE, COARSE)
STEPS = {"_mps": 0.5, "_rad": 0.01, "_pa": 5.0, "_ut": 0.3}  # of a coarse column, by its unit


def fly(
    probe: str,
    noise: str,
    seed: int,
    rows: int,
    hide: dict[str, list[float]] | None = None,
    decoys: int = 0,
) -> tuple[Flight, SimulatedFlight]:
    """A condensed flight with a noise of the probe's usual size, and the quiet flight behind it."""
    silence = dict.fromkeys(OUTPUTS[probe], 1e-9)
    quiet = simulate(probe, hide=hide, noise=silence, decoys=decoys, rows=rows, seed=seed)
    columns: dict[str, Array] = {name: np.array(quiet[name]) for name in quiet}
    rng = np.random.default_rng([seed, NOISES.index(noise), rows])
    time = columns["time_s"]
    output = OUTPUT_NOISES.get(noise, OUTPUT_NOISES["white"])
    for header in HEADERS[probe]:
        columns[header] += NOISE[probe] * output(rng, time)
    if noise == ATTITUDE:
        for name in ("roll_rad", "pitch_rad", "yaw_rad"):
            columns[name] += 0.01 * OUTPUT_NOISES["AR(0.99)"](rng, time)
    if noise == COARSE:
        for name, values in columns.items():
            step = next((s for unit, s in STEPS.items() if name.endswith(unit)), None)
            if step is not None and name not in FIELD:
                columns[name] = np.round(values / step) * step
    return Flight(columns, maneuver=quiet.maneuvers), quiet
