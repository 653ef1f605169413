# SPDX-License-Identifier: BSD-3-Clause
"""A plain Pitot-static tube: z = s_va V_met + c_va, V_met the airspeed that it meets."""

from __future__ import annotations

import numpy as np

from studies.trust.noises import Array
from studies.trust.simulator.instrument import (
    AIR_PORTS,
    VELOCITY,
    Change,
    Columns,
    Instrument,
    Truth,
    density_of,
    driven,
    stack,
    wind_of,
)
from studies.trust.simulator.manoeuvres import Motion


def _draw_truth(rng: np.random.Generator) -> Truth:
    """Of a wind that neither rises nor sinks, as the model holds it."""
    return {
        "s_va": rng.uniform(0.9, 1.1),
        "c_va": rng.uniform(-1.0, 1.0),
        "w_n": rng.uniform(-6.0, 6.0),
        "w_e": rng.uniform(-6.0, 6.0),
    }


def _measure(motion: Motion, truth: Truth, change: Change, gust: Array) -> Columns:
    ground = motion.through_air + wind_of(truth, change, motion.time.size)
    log = {"time_s": motion.time, "rho_kgpm3": density_of(motion)}
    log |= dict(zip(VELOCITY, ground.T, strict=True))
    met = log | dict(zip(VELOCITY, (ground - gust).T, strict=True))
    return log | {"airspeed_mps": _predict(met, truth, change)[:, 0]}


def _predict(log: Columns, truth: Truth, change: Change) -> Array:
    ground = stack(log, VELOCITY)
    speed = np.linalg.norm(ground - wind_of(truth, change, len(ground)), axis=-1)
    speed = (speed - driven(change, "airspeed_bias")) / (1.0 + driven(change, "airspeed_scale"))
    square = speed**2 - 2.0 * driven(change, "pressure_offset") / log["rho_kgpm3"]
    return np.asarray(truth["s_va"] * np.sqrt(square) + truth["c_va"])[:, None]


TUBE = Instrument(
    name="pitot-static",
    lively=False,
    outputs=("airspeed_mps",),
    ports=AIR_PORTS,
    draw_truth=_draw_truth,
    measure=_measure,
    predict=_predict,
)
