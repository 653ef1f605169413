# SPDX-License-Identifier: BSD-3-Clause
"""Flights whose measurements are disturbed as recorded ones are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sepcal.flight import Flight
from sepcal.simulation import SimulatedFlight, simulate
from studies.hidden_effects.cases import NOISE, OUTPUTS
from studies.trust.noises import FURTHER_NOISES, OUTPUT_NOISES, Array

HEADERS = {
    "five-hole": ("vn_mps", "ve_mps", "vd_mps"),
    "pitot-static": ("airspeed_mps",),
    "magnetometer": ("mx_ut", "my_ut", "mz_ut"),
}
FIELD = ("bn_ut", "be_ut", "bd_ut")  # from a model, not from a sensor
ATTITUDE = "attitude AR(0.99)"  # of the columns that the model believes
COARSE = "quantised"  # inputs and outputs in coarse steps
NOISES = (*OUTPUT_NOISES, ATTITUDE, COARSE)
JITTERY = "AR(0.9), stamps in bursts"
COLUMNS_INTERPOLATED = "columns interpolated tenfold"  # a slow sensor's, its noise with it
SAMPLES_ALONE = "columns interpolated tenfold, their samples alone"
INTERPOLATED = (COLUMNS_INTERPOLATED, SAMPLES_ALONE)
FURTHER = (*FURTHER_NOISES, JITTERY, *INTERPOLATED)  # of standard errors alone
DRAWS = {**OUTPUT_NOISES, **FURTHER_NOISES, JITTERY: OUTPUT_NOISES["AR(0.9)"]}
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
    rng = np.random.default_rng([seed, (*NOISES, *FURTHER).index(noise), rows])
    kept = _rows_in_bursts(rng, rows) if noise == JITTERY else np.arange(rows)
    quiet = simulate(
        probe,
        hide=hide,
        noise=dict.fromkeys(OUTPUTS[probe], 1e-9),
        decoys=decoys,
        rows=int(kept[-1]) + 1,
        seed=seed,
    )
    columns: dict[str, Array] = {name: np.array(quiet[name])[kept] for name in quiet}
    time = columns["time_s"]
    output = DRAWS.get(noise, OUTPUT_NOISES["white"])
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
    if noise in INTERPOLATED:
        for header in HEADERS[probe]:
            columns[header] = np.interp(time, time[::10], columns[header][::10])
    maneuvers = quiet.maneuvers
    return Flight(columns, maneuver=[maneuvers[row] for row in kept] if maneuvers else None), quiet


def _rows_in_bursts(rng: np.random.Generator, rows: int) -> NDArray[np.intp]:
    """About one row of three: some that follow each other, then up to twelve that are missed."""
    steps = np.where(rng.random(rows) < 0.25, rng.integers(3, 14, rows), 1)
    return np.asarray(np.cumsum(steps) - 1, dtype=np.intp)
