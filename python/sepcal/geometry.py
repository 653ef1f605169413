# SPDX-License-Identifier: BSD-3-Clause
"""An aircraft's geometry and mass, as its equations of motion need them."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Literal

from sepcal.arguments import checked
from sepcal.models import Vector, _to_vector
from sepcal.states_module import states_module
from sepcal.whole_files import name_of


@checked
@dataclass(frozen=True, kw_only=True)
class Aircraft:
    """An aircraft's geometry and mass, as its equations of motion need them.

    Positions are in body axes, forward, right, down, from any one point of the aircraft.

    Attributes:
        area: Wing area [m^2].
        chord: Mean aerodynamic [m].
        span: [m].
        mass: [kg].
        inertia: Ix, Iy, Iz, Ixz about the centre of gravity [kg m^2], Ixz the integral of x z dm;
            None where only forces are asked for.
        cg: Centre of gravity [m].
        imu: Inertial unit [m].
        vane: Where airspeed, alpha and beta are read [m].
        rate_reference: How the pitch rate becomes a number, q_hat: q c/V or q c/2V. CX_q, CZ_q and
            Cm_q of the first are half those of the second. Every result says which.

    Example:
        >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
        >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
        >>> aircraft = sepcal.Aircraft(**size, **mass)
        >>> aircraft.span
        10.9
    """

    area: float
    chord: float
    span: float
    mass: float
    inertia: tuple[float, float, float, float] | None = None
    cg: Vector = (0.0, 0.0, 0.0)
    imu: Vector = (0.0, 0.0, 0.0)
    vane: Vector = (0.0, 0.0, 0.0)
    rate_reference: Literal["c/V", "c/2V"] | str = "c/2V"

    def to_json(self) -> str:
        """As the app takes it with --geometry.

        Example:
            >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
            >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
            >>> aircraft = sepcal.Aircraft(**size, **mass)
            >>> _ = (folder / "aircraft.json").write_text(aircraft.to_json())  # for --geometry
        """
        entries: dict[str, Any] = {
            "area_m2": float(self.area),
            "chord_m": float(self.chord),
            "span_m": float(self.span),
            "mass_kg": float(self.mass),
            "cg_m": _to_vector("cg", self.cg),
            "imu_m": _to_vector("imu", self.imu),
            "vane_m": _to_vector("vane", self.vane),
            "rate_reference": self.rate_reference,
        }
        if self.inertia is not None:
            entries["inertia_kgm2"] = [float(part) for part in self.inertia]
        return json.dumps(entries)


@checked
def read_aircraft(file: str | os.PathLike[str]) -> Aircraft:
    """Reads an aircraft as the app takes it with --geometry.

    Raises:
        Error: The file can't be read or is no aircraft: the entry that is wrong.

    Example:
        >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
        >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
        >>> aircraft = sepcal.Aircraft(**size, **mass)
        >>> _ = (folder / "aircraft.json").write_text(aircraft.to_json())
        >>> sepcal.read_aircraft(folder / "aircraft.json") == aircraft
        True
    """
    entries = json.loads(states_module().read_aircraft(name_of(file)))
    inertia = entries.get("inertia_kgm2")
    return Aircraft(
        area=entries["area_m2"],
        chord=entries["chord_m"],
        span=entries["span_m"],
        mass=entries["mass_kg"],
        inertia=tuple(inertia) if inertia else None,
        cg=tuple(entries["cg_m"]),
        imu=tuple(entries["imu_m"]),
        vane=tuple(entries["vane_m"]),
        rate_reference=entries["rate_reference"],
    )
