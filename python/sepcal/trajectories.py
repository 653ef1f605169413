# SPDX-License-Identifier: BSD-3-Clause
"""Models with a state, laid along a record: output error, flight path reconstruction."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, TypedDict, Unpack, get_type_hints

from sepcal import _core
from sepcal.arguments import Misuse, checked, fits, shown, words
from sepcal.geometry import Aircraft
from sepcal.models import Model, Vector, _to_vector
from sepcal.states_module import states_module

if TYPE_CHECKING:
    from sepcal import _states

STATE_OPTIONS: dict[str, Any] = {
    "inputs": "linear",
    "substeps": 1,
    "shoot": None,
    "measured": (),
    "outputs": (),
    "separable": True,
    "scales_about_start": False,
}


class TrajectoryOptions(TypedDict, total=False):
    """How a model with a state is laid along a record; docs/states.md says more.

    Attributes:
        inputs: How inputs change from row to row: straight lines, or "hold", the former row's value
            ["linear"].
        substeps: Runge-Kutta steps from row to row [1].
        shoot: Segments are cut every so many seconds, and each piece has initial states of its own
            (multiple shooting), for what runs away over a long one [None].
        measured: States that are read from columns of their names and not integrated [none].
        outputs: Those that are measured; what acts on none of them leaves [all].
        separable: Where the dynamics are linear, control derivatives and initial states are linear
            parameters [True].
        scales_about_start: A scale multiplies the change of its output since the start, as SIDPAC
            has it [False].

    Example:
        >>> laid: sepcal.TrajectoryOptions = {"inputs": "hold", "substeps": 2}
        >>> sepcal.ShortPeriod(**laid).options["substeps"]
        2
    """

    inputs: Literal["linear", "hold"] | str
    substeps: int
    shoot: float | None
    measured: Sequence[str]
    outputs: Sequence[str]
    separable: bool
    scales_about_start: bool


KINDS = get_type_hints(TrajectoryOptions)


class TrajectoryModel(Model):
    """A model with a state along a record; use FlightPath, ShortPeriod, or Trajectory for your own.

    A fit has the model's parameters and the initial state of every segment: `alpha_0`, or
    `alpha_0[label]`, `alpha_0[2]` where there are several. The data have a column `time` [s]; only
    differences count, and rows may lie unevenly.

    Attributes:
        states: Names of x.
        options: TrajectoryOptions, complete.

    Example:
        >>> mode = sepcal.ShortPeriod()
        >>> isinstance(mode, sepcal.TrajectoryModel), mode.states
        (True, ('alpha', 'q'))
    """

    states: tuple[str, ...]

    def __init__(self, core: _core.Model, options: dict[str, Any]) -> None:
        self.options = options
        super().__init__(core)

    def _settings(self) -> dict[str, Any]:
        return {name: value for name, value in self.options.items() if value != STATE_OPTIONS[name]}


def complete(options: TrajectoryOptions) -> dict[str, Any]:
    """With the defaults. Raises TypeError for an option that there isn't, Error for one name."""
    for name in options:
        if name not in STATE_OPTIONS:
            known = ", ".join(STATE_OPTIONS)
            raise Misuse(f"a trajectory has no option '{name}'; it has: {known}")
        is_one_name = name in ("measured", "outputs") and isinstance(options[name], str)  # type: ignore[literal-required]
        if not is_one_name and not fits(options[name], KINDS[name]):  # type: ignore[literal-required]
            value = shown(options[name])  # type: ignore[literal-required]
            raise Misuse(f"{name} is {value}; give {words(KINDS[name])}")
    whole: dict[str, Any] = {**STATE_OPTIONS, **options}
    for name in ("measured", "outputs"):
        if isinstance(whole[name], str):
            raise _core.Error(f"{name} is '{whole[name]}'; give a list of names, ['{whole[name]}']")
        whole[name] = tuple(whole[name])
    return whole


def to_core_options(options: dict[str, Any]) -> _states.TrajectoryOptions:
    """As C++ takes them."""
    shoot = math.inf if options["shoot"] is None else options["shoot"]
    core: _states.TrajectoryOptions = states_module().TrajectoryOptions(
        **{**options, "shoot": shoot}
    )
    return core


@checked
class ShortPeriod(TrajectoryModel):
    """The short period of an aircraft, for small changes about a trimmed flight.

    alpha' = Za alpha + q + Zd elevator, q' = Ma alpha + Mq q + Md elevator; alpha_m and q_m with
    biases, az_m = airspeed (Za alpha + Zd elevator) + b_az. Of ten parameters three are nonlinear,
    Za, Ma and Mq, and all have bounds: output error needs no start.

    Args:
        **options: TrajectoryOptions.

    Example:
        >>> sepcal.ShortPeriod().nonlinear
        ('Za', 'Ma', 'Mq')
    """

    states = ("alpha", "q")

    def __init__(self, **options: Unpack[TrajectoryOptions]) -> None:
        whole = complete(options)
        super().__init__(states_module().short_period(to_core_options(whole)), whole)


@checked
class FlightPath(TrajectoryModel):
    """Flight path reconstruction, or data compatibility (Eqs. B4-B9).

    From specific forces ax ay az [m/s^2] (forward, right, down: level flight reads az = -9.81) and
    rates p q r [rad/s] follow the velocity and the attitude; airspeed, beta, alpha, roll, pitch,
    yaw (SI, rad), each with a scale and a bias, and the velocity over the ground vn, ve, vd, with
    the wind, say with which biases of the inertial unit they agree. b_v, b_alpha and b_psi are held
    at zero unless fit(..., free=["b_v"]) frees them: few records tell them from scales, and b_psi
    is exchanged for psi_0 exactly. Initial states start at the first readings.

    Args:
        position: x y z are states, and north, east, down outputs; the wind is nonlinear then. Of a
            Flight these are logged in metres, or made of lat, lon and altitude; a velocity that
            comes from the same fixes is then no output.
        gravity: At the place of the flight [m/s^2].
        vane: Where the flow is measured, from the inertial unit, body axes [m].
        aircraft: In place of `vane`, where both are; with it apply() gives the coefficients too.
        **options: TrajectoryOptions; `outputs` are those that the data have; of a Flight by default
            all that it has.

    Raises:
        Error: An output that there isn't; when fitted, data in degrees, az of the other sign, or a
            pitch beyond 85 deg.

    Example:
        >>> flight = sepcal.datasets.load("aircraft")
        >>> path = sepcal.fit(sepcal.FlightPath(), flight)
        >>> path.status, path.model
        ('converged', 'path')
    """

    def __init__(
        self,
        *,
        position: bool = False,
        gravity: float = 9.80665,
        vane: Vector = (0.0, 0.0, 0.0),
        aircraft: Aircraft | None = None,
        **options: Unpack[TrajectoryOptions],
    ) -> None:
        self.position, self.gravity = bool(position), float(gravity)
        self.aircraft = aircraft
        if aircraft is not None:
            vane = tuple(a - b for a, b in zip(aircraft.vane, aircraft.imu, strict=True))
        self.vane = _to_vector("vane", vane)
        self.states = ("u", "v", "w", "phi", "theta", "psi", *(("x", "y", "z") if position else ()))
        whole = complete(options)
        core = states_module().flight_path(
            self.position, self.gravity, self.vane, to_core_options(whole)
        )
        super().__init__(core, whole)

    def _aircraft_options(self) -> dict[str, Any]:
        """As sepcal._states lays it along a Flight. Raises Error for what a Flight can't have."""
        if self.aircraft is None and any(self.vane):
            raise _core.Error("of a flight the vane's place is the aircraft's: give aircraft=...")
        return {
            "model": "path",
            "geometry": self.aircraft.to_json() if self.aircraft else None,
            "equations": {},
            "trajectory": to_core_options(self.options),
            "position": self.position,
            "gravity": self.gravity,
            "window": 0.0,
            "band": None,
        }

    def _settings(self) -> dict[str, Any]:
        own = {
            "position": self.position,
            "gravity": self.gravity,
            "vane": () if self.aircraft else self.vane,
            "aircraft": self.aircraft,
        }
        defaults = {
            "position": False,
            "gravity": 9.80665,
            "vane": () if self.aircraft else (0.0, 0.0, 0.0),
            "aircraft": None,
        }
        return super()._settings() | {
            name: value for name, value in own.items() if value != defaults[name]
        }
