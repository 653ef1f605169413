# SPDX-License-Identifier: BSD-3-Clause
"""Triangles of flights, made without sepcal's flights."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sepcal import _core
from sepcal.fleet.store import factor_of

Array = NDArray[np.float64]
Asked = tuple[str, str, _core.FlightFactor, dict[str, float]]


def make_factor(
    J: Array, G: Array, residual: Array, values: Array, effects: Sequence[str] = ()
) -> _core.FlightFactor:
    """Of rows `residual` = J (theta - values) + G gamma + noise of unit size."""
    side = J.shape[1] + G.shape[1] + 1
    upper = np.linalg.qr(np.column_stack([J, G, residual]), mode="r")
    triangle = np.zeros((side, side))
    triangle[: len(upper)] = upper
    names = list(effects) or [f"e{k}" for k in range(G.shape[1])]
    return factor_of(
        {
            "parameters": [f"p{k}" for k in range(J.shape[1])],
            "units": ["m"] * J.shape[1],
            "values": values,
            "columns": [(name, name, "m", False) for name in names],
            "triangle": triangle,
            "whitened": np.zeros((0, 0)),
            "inflation": np.ones(J.shape[1]),
            "readings": float(len(residual)),
            "own": {},
            "centres": {},
            "rmse": 1.0,
        }
    )


def draw_fleet(
    rng: np.random.Generator,
    *,
    vehicles: int = 12,
    flights: int = 6,
    rows: int = 40,
    p: int = 3,
    c: int = 4,
    spread: float | Array = 1.0,
    gamma: Mapping[int, float] | None = None,
    of_vehicles: Mapping[int, Mapping[int, float]] | None = None,
    ages: Mapping[int, float] | None = None,
    wander: float = 0.0,
) -> tuple[list[Asked], list[Array], list[tuple[Array, Array, Array]]]:
    """A fleet, its vehicles' parameters, and the rows of each flight: J, G, z.

    `gamma` by column for all, `of_vehicles` by vehicle, `ages` by parameter per day; `wander` is
    the size of an error that stays the same over a flight's rows along a direction of its own.
    """
    asked, thetas, all_rows = [], [], []
    size = np.broadcast_to(spread, p)
    for v in range(vehicles):
        theta = size * rng.standard_normal(p)
        thetas.append(theta)
        for f in range(flights):
            J, G = rng.standard_normal((rows, p)), rng.standard_normal((rows, c))
            age = float(rng.uniform(0.0, 100.0))
            moved = theta + np.array([(ages or {}).get(k, 0.0) * age for k in range(p)])
            effect = np.array([(gamma or {}).get(k, 0.0) for k in range(c)])
            for k, value in (of_vehicles or {}).get(v, {}).items():
                effect[k] += value
            z = J @ moved + G @ effect + rng.standard_normal(rows)
            if wander:
                z += wander * (G @ rng.standard_normal(c) + J @ rng.standard_normal(p))
            at = theta + 0.1 * rng.standard_normal(p)
            factor = make_factor(J, G, z - J @ at, at)
            asked.append((f"f{v}-{f}", f"v{v}", factor, {"age_days": age}))
            all_rows.append((J, G, z))
    return asked, thetas, all_rows
