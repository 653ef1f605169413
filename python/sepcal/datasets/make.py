# SPDX-License-Identifier: BSD-3-Clause
"""Makes the flights that ship, and their truth: python -m sepcal.datasets.make FOLDER.

Each is flown by sepcal.simulate(), and then read by instruments that are not perfect: zeros wander,
readings lie on steps, a few are wrong altogether.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.random import Generator, default_rng

from sepcal.columns import Array
from sepcal.simulation import simulate
from sepcal.whole_files import write_whole

COMMAND = "python -m sepcal.datasets.make FOLDER"


@dataclass(frozen=True)
class Recipe:
    """A flight, and the instruments that it is read with.

    Attributes:
        model: As in simulate().
        about: A sentence.
        seed: Seed of the flight and of the instruments' errors.
        rows: Number of rows of the flight.
        hide: As in simulate().
        steps: By column of the log, in order, the step that its readings lie on, in its unit.
        wander: By column, how far its zero has wandered after the flight, one standard deviation of
            a random walk, in its unit.
        outliers: By column, the size of readings that are wrong, in its unit.
        wrong: So many rows have one, in all these columns.
    """

    model: str
    about: str
    seed: int
    rows: int
    hide: Mapping[str, Sequence[float]]
    steps: Mapping[str, float]
    wander: Mapping[str, float]
    outliers: Mapping[str, float]
    wrong: int
    parameters: Mapping[str, float] = field(default_factory=dict)


ANGLES = {"roll_rad": 1e-3, "pitch_rad": 1e-3, "yaw_rad": 1e-3}
RECIPES = {
    "pitot": Recipe(
        model="pitot-static",
        about="A small aircraft's Pitot-static tube beside its satellite receiver, 120 s.",
        seed=11,
        rows=480,
        hide={"wind[altitude_m]": (0.08, -0.05)},
        steps={"time_s": 1e-3, "dp_pa": 0.25, "ps_pa": 1.0, "temp_k": 0.1, **ANGLES,
               "vn_mps": 0.01, "ve_mps": 0.01, "vd_mps": 0.01, "altitude_m": 0.1, "throttle": 0.01,
               "current_a": 0.1},
        wander={"dp_pa": 0.4, "temp_k": 0.1},
        outliers={"vn_mps": 1.0, "ve_mps": -1.0},
        wrong=3,
    ),
    "magnetometer": Recipe(
        model="magnetometer",
        about="A magnetometer near the wires of a motor, turned in all directions, 80 s.",
        seed=12,
        rows=400,
        hide={"bias[current_a]": (0.25, -0.15, 0.1)},
        steps={"time_s": 1e-3, "mx_ut": 0.05, "my_ut": 0.05, "mz_ut": 0.05, **ANGLES,
               "bn_ut": 0.1, "be_ut": 0.1, "bd_ut": 0.1, "temp_degc": 0.1, "current_a": 0.1,
               "throttle": 0.01},
        wander={"mx_ut": 0.05, "my_ut": 0.05, "mz_ut": 0.05},
        outliers={"mx_ut": 3.0, "mz_ut": -2.0},
        wrong=3,
    ),
    "aircraft": Recipe(
        model="aircraft",
        about="A light aircraft's inertial unit, air data and attitude in five manoeuvres, 40 s.",
        seed=13,
        rows=400,
        hide={},
        steps={"time_s": 1e-3, "ax_mps2": 2e-3, "ay_mps2": 2e-3, "az_mps2": 2e-3,
               "p_radps": 1e-4, "q_radps": 1e-4, "r_radps": 1e-4, "airspeed_mps": 0.05,
               "alpha_rad": 5e-4, "beta_rad": 5e-4, "roll_rad": 1e-4, "pitch_rad": 1e-4,
               "yaw_rad": 1e-4, "vn_mps": 0.01, "ve_mps": 0.01, "vd_mps": 0.01,
               "elevator_rad": 1e-4, "aileron_rad": 1e-4, "rudder_rad": 1e-4, "thrust_n": 1.0,
               "rho_kgpm3": 1e-4},
        wander={"p_radps": 1e-4, "q_radps": 1e-4, "r_radps": 1e-4},
        outliers={"alpha_rad": 0.02},
        wrong=2,
        parameters={"lambda_v": 0.03, "b_alpha": 0.01, "b_ax": 0.05, "b_q": 0.002},
    ),
}  # fmt: skip


def make(name: str) -> tuple[str, dict[str, Any]]:
    """A flight's CSV, and what truth.json says of it."""
    recipe = RECIPES[name]
    flown = simulate(
        recipe.model,
        rows=recipe.rows,
        seed=recipe.seed,
        hide=recipe.hide,
        parameters=recipe.parameters,
    )
    rng = default_rng(recipe.seed)
    wrong = np.sort(rng.choice(np.arange(20, flown.rows - 20), recipe.wrong, replace=False))
    columns = {
        header: _read(flown[header], step, recipe.wander.get(header, 0.0), rng)
        for header, step in recipe.steps.items()
    }
    for header, size in recipe.outliers.items():
        columns[header][wrong] = np.round((columns[header][wrong] + size) / recipe.steps[header])
        columns[header][wrong] *= recipe.steps[header]
    lines = [",".join([*columns, "maneuver"])]
    cells = [
        [f"{value:.{_places(recipe.steps[header])}f}" for value in values]
        for header, values in columns.items()
    ]
    lines += [",".join(row) for row in zip(*cells, flown.maneuvers, strict=True)]
    told = {
        "about": recipe.about,
        "made_by": COMMAND,
        "model": recipe.model,
        "seed": recipe.seed,
        "parameters": flown.truth,
        "effects": list(flown.effects),
        "steps": dict(recipe.steps),
        "wander": dict(recipe.wander),
        "outliers": {"rows": wrong.tolist(), "sizes": dict(recipe.outliers)},
    }
    return "\n".join(lines) + "\n", told


def _read(true: Array, step: float, wander: float, rng: Generator) -> Array:
    """The readings of an instrument whose zero drifts and that has a resolution."""
    walk = np.cumsum(rng.standard_normal(true.size)) / np.sqrt(true.size)
    read: Array = np.round((true + wander * walk) / step) * step
    return read


def _places(step: float) -> int:
    """Decimals that show a step."""
    return max(0, len(f"{step:.6f}".rstrip("0").partition(".")[2]))


def main(folder: str) -> None:
    """Writes all of them."""
    made = {name: make(name) for name in RECIPES}
    texts = {os.path.join(folder, f"{name}.csv"): csv for name, (csv, _) in made.items()}
    truth = json.dumps({name: told for name, (_, told) in made.items()}, indent=1) + "\n"
    write_whole({**texts, os.path.join(folder, "truth.json"): truth})


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else ".")
