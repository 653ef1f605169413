# SPDX-License-Identifier: BSD-3-Clause
"""Small flights that ship with sepcal, each with its truth, and fleets to try things on."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from datetime import date, timedelta
from importlib import resources
from typing import Literal

import numpy as np

from sepcal import _core
from sepcal.arguments import checked
from sepcal.flight import read_csv
from sepcal.printing import in_line
from sepcal.simulation import SimulatedFlight, simulate

__all__ = ["NAMES", "load", "write_fleet"]

NAMES = ("aircraft", "magnetometer", "pitot")


def __dir__() -> list[str]:
    """The public names, without what they are made of."""
    return __all__


@checked
def load(name: Literal["aircraft", "magnetometer", "pitot"] | str) -> SimulatedFlight:
    """A flight of the simulator, read by instruments that wander, round and are wrong at times.

    What they do is in truth.json, beside the logs in the package.

    Args:
        name: "pitot", a Pitot-static tube beside a satellite receiver, 120 s in a wind that changes
            with altitude; "magnetometer", beside the wires of a motor, 80 s; "aircraft", a light
            one with inertial unit, air data and attitude, 40 s.

    Returns:
        A Flight with its `truth`, the parameters by name, and the `effects` that are hidden in it.

    Raises:
        Error: Another name.

    Example:
        >>> flight = sepcal.datasets.load("magnetometer")
        >>> flight.effects, flight.truth["n_x"]
        (('bias[current_a]',), 12.0)
    """
    if name not in NAMES:
        raise _core.Error(f"there is no data set {name!r}; there are: {', '.join(NAMES)}")
    folder = resources.files(__package__)
    told = json.loads(folder.joinpath("truth.json").read_text(encoding="utf-8"))[name]
    with resources.as_file(folder.joinpath(f"{name}.csv")) as file:
        read = read_csv(file)
    # Called so everywhere, wherever the package is.
    flight = SimulatedFlight(dict(read), read.maneuvers, name=f"{name}.csv")
    flight.truth = told["parameters"]
    flight.effects = tuple(told["effects"])
    return flight


@checked
def write_fleet(
    folder: str | os.PathLike[str],
    *,
    vehicles: int = 4,
    flights: int = 3,
    rows: int = 200,
    hide: Mapping[str, float | Sequence[float]] | None = None,
    in_last: Mapping[str, float | Sequence[float]] | None = None,
    seed: int = 0,
) -> list[str]:
    """Writes simulated logs of Pitot-static tubes: V01_2026-01-01.csv, a month between flights.

    Vehicles differ by 2 % in s_va; each flight has a wind of its own.

    Args:
        folder: That they are written to, made where it is not there.
        vehicles: How many.
        flights: Of each.
        rows: Of each flight.
        hide: Effects of all vehicles, as simulate() takes them.
        in_last: Further effects of the last vehicle.
        seed: The same seed, the same logs.

    Returns:
        The files' names.

    Raises:
        Error: As simulate() does; a folder that can't be written to.

    Example:
        >>> files = sepcal.datasets.write_fleet(folder, vehicles=2, flights=1)
        >>> [file.rpartition("/")[2] for file in files]
        ['V01_2026-01-01.csv', 'V02_2026-01-01.csv']
    """
    rng = np.random.default_rng(seed)
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as error:
        raise _core.Error(f"{in_line(os.fspath(folder))}: {error.strerror}") from None
    files = []
    for vehicle in range(vehicles):
        scale = 0.95 * (1.0 + 0.02 * float(rng.standard_normal()))
        hidden = dict(hide or {}) | (dict(in_last or {}) if vehicle == vehicles - 1 else {})
        for number in range(flights):
            north, east = (float(value) for value in rng.normal(0.0, 4.0, 2))
            flown = simulate(
                "pitot-static",
                parameters={"s_va": scale, "w_n": north, "w_e": east},
                hide=hidden,
                rows=rows,
                seed=1000 * seed + flights * vehicle + number,
            )
            day = date(2026, 1, 1) + timedelta(days=30 * number)
            files.append(os.path.join(os.fspath(folder), f"V{vehicle + 1:02d}_{day}.csv"))
            flown.to_csv(files[-1])
    return files
