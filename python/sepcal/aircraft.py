# SPDX-License-Identifier: BSD-3-Clause
"""Models of an aircraft that are fitted to flights: equation error and output error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, Protocol, Unpack

from sepcal import _core
from sepcal.arguments import checked
from sepcal.bands import to_band
from sepcal.geometry import Aircraft
from sepcal.states_module import states_module
from sepcal.trajectories import TrajectoryOptions, complete, to_core_options

Equations = Mapping[str, Sequence[str]]


class AircraftModel(Protocol):
    """A model that fit() and two_step() take: Aero, RigidAircraft, FlightPath."""

    def _aircraft_options(self) -> dict[str, Any]:
        """The fields of sepcal._states.Options but those of the fit."""


@checked
class Aero:
    """Aerodynamic coefficients by equation error: computed row by row, one linear least squares.

    A flight has columns with units in their headers: ax ay az (specific force: level flight reads
    az = -9.81 m/s^2), p q r, airspeed, alpha, beta, surfaces, rho or qbar; thrust and mass where
    they are logged.

    Args:
        aircraft: Its dimensions, mass and inertia.
        *coefficients: Which of CX CY CZ Cl Cm Cn to fit, each on its standard regressors [all].
        equations: {coefficient: [regressors]} in their place: {"Cm": ["1", "alpha", "q_hat",
            "elevator", "alpha^2"]}.
        window: Window of the local cubic that differentiates p, q and r [s]; 0: seven rows.
        band: (low, high) of the frequencies over which it is fitted [Hz], (0.1, 2) for what a
            rigid aircraft does [row by row in time].
        spacing: Step between these frequencies [Hz]; 0: one over the length of a segment.

    Example:
        >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
        >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
        >>> aircraft = sepcal.Aircraft(**size, **mass)
        >>> flight = sepcal.simulate(aircraft, rows=400)
        >>> fit = sepcal.fit(sepcal.Aero(aircraft, "CY"), flight)
        >>> abs(fit["CY_beta"].value / flight.truth["CY_beta"] - 1) < 0.1
        True
    """

    def __init__(
        self,
        aircraft: Aircraft,
        *coefficients: str,
        equations: Equations | None = None,
        window: float = 0.0,
        band: tuple[float, float] | None = None,
        spacing: float = 0.0,
    ) -> None:
        self.aircraft, self.window = _to_aircraft(aircraft), float(window)
        self.band = _to_band(band, spacing)
        self.equations = _to_equations(equations)
        for coefficient in coefficients:
            if not isinstance(coefficient, str):
                raise _core.Error(
                    f"{coefficient!r} is no coefficient; write Aero(aircraft, 'CZ', 'Cm')"
                )
            self.equations.setdefault(coefficient, standard_regressors(coefficient))

    def _aircraft_options(self) -> dict[str, Any]:
        return {
            "model": "aero",
            "geometry": self.aircraft.to_json(),
            "equations": self.equations,
            "trajectory": to_core_options(complete({})),
            "gravity": 9.80665,
            "window": self.window,
            "band": self.band,
        }

    def __repr__(self) -> str:
        over = "" if self.band is None else f", band={self.band[:2]}, spacing={self.band[2]}"
        return (
            f"Aero({self.aircraft!r}, equations={self.equations!r}, window={self.window!r}{over})"
        )


@checked
class RigidAircraft:
    """An aircraft by output error: integrated from its initial states, it gives the readings.

    Args:
        aircraft: Its dimensions, mass and inertia.
        axes: Which states are integrated, the others being read from the flight: "longitudinal",
            u w q theta; "lateral", v p r phi; "six-dof", these and, where yaw is an output, psi.
        equations: {coefficient: [regressors]} [the standard ones of the axes; these also of
            coefficients that are not named].
        gravity: At the place of the flight [m/s^2].
        window: Window of the local cubic that differentiates rates for the start [s]; 0: seven
            rows.
        band: (low, high) of the frequencies over which it is fitted [Hz], linear about the flight's
            means, without biases or initial states [in time].
        **options: TrajectoryOptions; `measured` and `outputs` are the axes' own where left out.

    Example:
        >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
        >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
        >>> aircraft = sepcal.Aircraft(**size, **mass)
        >>> flight = sepcal.simulate(aircraft, rows=400)
        >>> fit = sepcal.fit(sepcal.RigidAircraft(aircraft, "longitudinal"), flight)
        >>> abs(fit["Cm_q"].value / flight.truth["Cm_q"] - 1) < 0.1
        True
    """

    def __init__(
        self,
        aircraft: Aircraft,
        axes: Literal["longitudinal", "lateral", "six-dof"] | str = "six-dof",
        *,
        equations: Equations | None = None,
        gravity: float = 9.80665,
        window: float = 0.0,
        band: tuple[float, float] | None = None,
        **options: Unpack[TrajectoryOptions],
    ) -> None:
        if axes not in ("longitudinal", "lateral", "six-dof"):
            raise _core.Error(f"there are no axes '{axes}'; choose longitudinal, lateral, six-dof")
        self.aircraft, self.axes = _to_aircraft(aircraft), axes
        self.equations = _to_equations(equations)
        self.gravity, self.window = float(gravity), float(window)
        self.band = _to_band(band, 0.0)
        self.options = complete(options)

    def _aircraft_options(self) -> dict[str, Any]:
        return {
            "model": self.axes,
            "geometry": self.aircraft.to_json(),
            "equations": self.equations,
            "trajectory": to_core_options(self.options),
            "gravity": self.gravity,
            "window": self.window,
            "band": self.band,
        }

    def __repr__(self) -> str:
        over = "" if self.band is None else f", band={self.band[:2]}"
        return f"RigidAircraft({self.aircraft!r}, {self.axes!r}{over})"


def standard_regressors(coefficient: str) -> list[str]:
    """The regressors of CX, CY, CZ, Cl, Cm or Cn, S 6.8 to 6.13. Raises Error for another name."""
    return list(states_module().standard_regressors(coefficient))


def _to_aircraft(aircraft: object) -> Aircraft:
    if isinstance(aircraft, Aircraft):
        return aircraft
    raise _core.Error(
        f"a {type(aircraft).__name__} is no aircraft; give sepcal.Aircraft(area=..., chord=..., "
        "span=..., mass=..., inertia=(Ix, Iy, Iz, Ixz)) or sepcal.read_aircraft(FILE)"
    )


def _to_band(band: object, spacing: float) -> tuple[float, float, float] | None:
    if band is None:
        if spacing:
            raise _core.Error("spacing is of the frequencies of a band; give band=(0.1, 2) with it")
        return None
    return to_band(band, spacing)


def _to_equations(equations: Equations | None) -> dict[str, list[str]]:
    for coefficient, regressors in (equations or {}).items():
        if isinstance(regressors, str):
            raise _core.Error(
                f"equations['{coefficient}'] is '{regressors}'; give a list of regressors, "
                "['1', 'alpha', 'q_hat']"
            )
    return {name: list(regressors) for name, regressors in (equations or {}).items()}
