# SPDX-License-Identifier: BSD-3-Clause
"""A magnetometer: m = C h + n, h the field in body axes, nine entries of C of nine parameters."""

from __future__ import annotations

import numpy as np

from studies.trust.noises import Array
from studies.trust.simulator.instrument import (
    ATTITUDE,
    RATES,
    READINGS,
    Change,
    Columns,
    Instrument,
    Truth,
    stack,
    turn,
)
from studies.trust.simulator.manoeuvres import Motion, rotation

FIELD = (19.7, -1.4, 49.4)  # of the Earth: north, east and down [uT]


def _draw_truth(rng: np.random.Generator) -> Truth:
    return {
        **{f"lambda_{axis}": rng.uniform(-0.1, 0.1) for axis in "xyz"},
        **{f"n_{axis}": rng.uniform(-12.0, 12.0) for axis in "xyz"},
        **{f"eta_{axis}": rng.uniform(-0.03, 0.03) for axis in "xyz"},
        **{f"alpha_{axes}": rng.uniform(-0.03, 0.03) for axes in ("xy", "xz", "yz")},
    }


def _measure(motion: Motion, truth: Truth, change: Change, _: Array) -> Columns:
    log = {"time_s": motion.time}
    log |= dict(zip(ATTITUDE, motion.attitude.T, strict=True))
    log |= dict(zip(RATES, motion.rates.T, strict=True))
    return log | dict(zip(READINGS, _predict(log, truth, change).T, strict=True))


def _predict(log: Columns, truth: Truth, change: Change) -> Array:
    attitude = stack(log, ATTITUDE)
    field = np.broadcast_to(FIELD, attitude.shape)
    in_body = turn(rotation(attitude).transpose(0, 2, 1), field)
    xy, xz, yz = (truth[f"alpha_{axes}"] for axes in ("xy", "xz", "yz"))
    x, y, z = (truth[f"eta_{axis}"] for axis in "xyz")
    soft_iron = np.array([[1.0, xy, xz], [xy, 1.0, yz], [xz, yz, 1.0]])
    turned = np.array([[1.0, -z, y], [z, 1.0, -x], [-y, x, 1.0]])
    scale = np.diag([1.0 + truth[f"lambda_{axis}"] for axis in "xyz"])
    read = in_body @ (soft_iron @ turned @ scale).T + [truth[f"n_{axis}"] for axis in "xyz"]
    return np.asarray(read + change.get("bias", np.zeros((3, 1))).T)


COMPASS = Instrument(
    name="magnetometer",
    lively=True,
    outputs=READINGS,
    ports={"bias": ("x", "y", "z")},
    draw_truth=_draw_truth,
    measure=_measure,
    predict=_predict,
)
