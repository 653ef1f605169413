# SPDX-License-Identifier: BSD-3-Clause
"""The physical effects that sepcal knows, probe by probe."""

from dataclasses import dataclass

from sepcal import _core
from sepcal.models import FiveHoleProbe, Magnetometer, PitotStatic

PROBES = ("five-hole", "pitot-static", "magnetometer", "magnetometer-norm")


@dataclass(frozen=True)
class CataloguedEffect:
    """An effect that fit(..., effects=[name]) adds to a probe's model."""

    name: str  # `port[driver]`, or a name of its own; DRIVER stands for any
    equation: str  # what joins the model
    drivers: str  # the columns that it needs
    unit: str  # of its coefficient


def effects(probe: FiveHoleProbe | PitotStatic | Magnetometer | str) -> list[CataloguedEffect]:
    """The catalogue of a probe, or of a probe's name.

    Raises:
        Error: Another name than "five-hole", "pitot-static", "magnetometer" (also with attitude) or
            "magnetometer-norm" (its field's strength alone).
    """
    name = probe if isinstance(probe, str) else probe.name
    if name not in PROBES:
        raise _core.Error(f"there is no probe '{name}'; known: {', '.join(PROBES)}")
    return [CataloguedEffect(**entry) for entry in _core.effects(name)]
