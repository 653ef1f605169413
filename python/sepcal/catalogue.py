# SPDX-License-Identifier: BSD-3-Clause
"""The physical effects that sepcal knows, probe by probe."""

from sepcal import _core
from sepcal.models import FiveHoleProbe, Magnetometer, PitotStatic

PROBES = ("five-hole", "pitot-static", "magnetometer", "magnetometer-norm")


def effects(
    probe: FiveHoleProbe | PitotStatic | Magnetometer | str,
) -> list[_core.CataloguedEffect]:
    """The catalogue of a probe, or of a probe's name.

    Raises:
        Error: Another name than "five-hole", "pitot-static", "magnetometer" (also with attitude) or
            "magnetometer-norm" (its field's strength alone).
    """
    name = probe if isinstance(probe, str) else probe.name
    if name not in PROBES:
        raise _core.Error(f"there is no probe '{name}'; known: {', '.join(PROBES)}")
    return _core.effects(name)
