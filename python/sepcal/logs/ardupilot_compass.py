# SPDX-License-Identifier: BSD-3-Clause
"""Undoes what ArduPilot did to a compass before logging it: the raw sensor in body axes.

ArduPilot computes m = M s (raw + OFS) + MOT x in mG, with M = [[DIA_X, ODI_X, ODI_Y],
[ODI_X, DIA_Y, ODI_Z], [ODI_Y, ODI_Z, DIA_Z]], the scale s and the motors' field MOT x. Before it
knew a compensation motor by motor (COMPASS_PMOT) it took m = M (raw + OFS + MOT x). The board's and
the compass' orientation are applied first and stay.
"""

from __future__ import annotations

import numpy as np

from sepcal.columns import Array
from sepcal.logs.parameters import Parameters
from sepcal.logs.soft_iron import symmetric

AXES = "XYZ"
SCALES = (1 / 1.5, 1.5)  # a COMPASS_SCALE outside is not applied


def find_set(parameters: Parameters, instance: int, offsets: Array) -> str:
    """Which set of parameters is a logged compass': "", "2" or "3".

    The one whose device comes at this place in the order of priorities; without such an order, and
    where its offsets are not those that were logged, the one at this place itself.
    """
    suffixes = ("", "2", "3")
    by_place = suffixes[instance] if instance < len(suffixes) else ""
    device = parameters.first(f"COMPASS_PRIO{instance + 1}_ID")
    by_device = next(
        (s for s in suffixes if device and parameters.first(f"COMPASS_DEV_ID{s}") == device),
        by_place,
    )
    candidates = dict.fromkeys((by_device, by_place, *suffixes))
    for suffix in candidates:
        names = [f"COMPASS_OFS{suffix}_{axis}" for axis in AXES]
        known = all(name in parameters for name in names)
        if known and np.all(np.abs([parameters.first(n) for n in names] - offsets[0]) < 1.01):
            return suffix
    return by_device


def undo(
    field: Array, offsets: Array, motors: Array, times: Array, parameters: Parameters, suffix: str
) -> tuple[Array, tuple[str, ...]]:
    """The raw readings.

    Args:
        field: As logged, shape (n, 3) [mG].
        offsets: OFS as logged, likewise.
        motors: MOT x as logged, likewise.
        times: Shape (n,) [s].
        parameters: The log's parameters.
        suffix: Suffix of the compass' parameters: "", "2", "3".

    Returns:
        The raw readings, (n, 3) [mG], and what was undone, in sentences.
    """
    done = []
    diagonal = parameters.stack([f"COMPASS_DIA{suffix}_{a}" for a in AXES], times)
    off = parameters.stack([f"COMPASS_ODI{suffix}_{a}" for a in AXES], times)
    scale = parameters.at(f"COMPASS_SCALE{suffix}", times)
    scale = np.where((scale < SCALES[0]) | (scale > SCALES[1]), 1.0, scale)
    corrected = diagonal.any(axis=1, keepdims=True)
    matrix = symmetric(np.where(corrected, diagonal, 1.0), np.where(corrected, off, 0.0))
    bent = not np.allclose(matrix, np.eye(3))
    matrix *= scale[:, None, None]

    last = "COMPASS_PMOT_EN" in parameters or f"COMPASS_SCALE{suffix}" in parameters
    solved = np.linalg.solve(matrix, (field - motors if last else field)[..., None])[..., 0]
    before_matrix = np.zeros(3) if last else motors
    exact = parameters.stack([f"COMPASS_OFS{suffix}_{a}" for a in AXES], times, np.nan)
    known = np.abs(exact - offsets) < 1.01  # what is logged is cut to whole mG
    used = np.where(known, exact, offsets)
    raw: Array = np.asarray(solved - before_matrix - used, dtype=float)

    if motors.any():
        order = "after" if last else "before"
        done.append(f"COMPASS_MOT{suffix}, the motors' field as logged, applied {order} the matrix")
    if bent:
        matrix_text = ", ".join(f"{v:g}" for v in (*diagonal[0], *off[0]))
        done.append(f"COMPASS_DIA{suffix} and COMPASS_ODI{suffix}, {matrix_text}")
    if not np.allclose(scale, 1):
        done.append(f"COMPASS_SCALE{suffix}, {scale[0]:g}")
    if used.any():
        origin = f"COMPASS_OFS{suffix}" if known.all() else "the offsets as logged"
        learned = ", which changed on the way" if np.ptp(used, axis=0).any() else ""
        done.append(f"{origin}, {', '.join(f'{v:g}' for v in used[0])} mG{learned}")
    return raw, tuple(f"undone: {text}" for text in done)
