# SPDX-License-Identifier: BSD-3-Clause
"""Several flights of one probe, calibrated together."""

from collections.abc import Sequence
from typing import Unpack, overload

from sepcal import _core
from sepcal.aircraft import Aero, RigidAircraft
from sepcal.aircraft_fits import AircraftFit, fit_flights
from sepcal.arguments import checked
from sepcal.calibration import Calibration
from sepcal.fit_options import FitOptions
from sepcal.flight import AnyFlight, Flight, to_flight
from sepcal.options import spelled_out, to_core, to_names
from sepcal.own_effect import Effect, given_effects, name_effects, to_core_effects
from sepcal.own_state_model import AnyModel, as_model, own_among
from sepcal.trajectories import FlightPath


@overload
def fit_jointly(  # type: ignore[overload-overlap]
    model: Aero | RigidAircraft | FlightPath,
    flights: Sequence[AnyFlight],
    *,
    own: Sequence[str] = (),
    **options: Unpack[FitOptions],
) -> AircraftFit: ...


@overload
def fit_jointly(
    model: AnyModel,
    flights: Sequence[AnyFlight],
    *,
    own: Sequence[str] = (),
    **options: Unpack[FitOptions],
) -> Calibration: ...


@spelled_out()
@checked
def fit_jointly(
    model: AnyModel | Aero | RigidAircraft,
    flights: Sequence[AnyFlight],
    *,
    own: Sequence[str] = (),
    **options: Unpack[FitOptions],
) -> Calibration | AircraftFit:
    """Calibrates a probe on several flights together, a wind a flight, or fits an aircraft to them.

        fit = sepcal.fit_jointly(probe, [monday, tuesday], own=["wind"])
        fit["w_n@monday"], fit.departed()

    The result is a Calibration or an AircraftFit like another, of the flights joined: it is
    compared, diagnosed, added to, saved and loaded. An effect is centred over all flights, so that
    its coefficient means the same in each. For many flights, on many machines, there is fit_many().

    Args:
        model: A probe, a FlightPath, Aero or RigidAircraft, or a model of your own; one with a
            state shares all but its initial states.
        flights: Two or more, of different names. They need the same columns; what is not in all of
            them is left out. A flight is called by its file's name without folder and ending.
        own: Parameters estimated per flight, "wind" for w_n, w_e, w_d; the others are
            shared.
        **options: Those of fit(). Bounds, a start and a prior of an own parameter hold for each
            flight's.

    Raises:
        Error: Bad input, as in fit(); one flight, two of one name, an own parameter that there
            isn't.
        TypeError: An option that there isn't, or of the wrong kind.

    Example:
        >>> def fly(seed):
        ...     flown = sepcal.simulate("pitot-static", rows=200, seed=seed)
        ...     return sepcal.Flight(flown, name=f"day {seed}")
        ...
        >>> flights = [fly(1), fly(2), fly(3)]
        >>> both = sepcal.fit_jointly(sepcal.PitotStatic(), flights)
        >>> both.names, both.flights
        (('s_va', 'c_va', 'w_n', 'w_e', 'w_d'), ['day 1', 'day 2', 'day 3'])
    """
    if isinstance(flights, Flight | str):
        raise _core.Error("flights is one flight; give several in a list, or fit() the one")
    if isinstance(model, Aero | RigidAircraft | FlightPath):
        if own:
            raise _core.Error("own: the flights of an aircraft share all but their initial states")
        return fit_flights(model, flights, options)
    effects = given_effects(options)
    options["effects"] = name_effects(effects)
    subject = as_model(model)
    if subject.runs_in_python:
        options["threads"] = options.get("threads") or 1
    core, joined = _core.calibrate_jointly(
        subject._core,
        [to_flight(flight, "fit_jointly(model, [", subject, options)._core for flight in flights],
        to_names("own", own),
        to_core(options),
        to_core_effects(effects),
    )
    made = [effect for effect in effects if isinstance(effect, Effect)]
    return Calibration(core, Flight._of(joined), made, own_among(subject))
