# SPDX-License-Identifier: BSD-3-Clause
"""Small flights that ship with sepcal, each with its truth: sepcal.datasets.load("pitot")."""

from __future__ import annotations

import json
from importlib import resources
from typing import Literal

from sepcal import _core
from sepcal.arguments import checked
from sepcal.flight import read_csv
from sepcal.simulation import SimulatedFlight

__all__ = ["NAMES", "load"]

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
