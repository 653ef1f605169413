# SPDX-License-Identifier: BSD-3-Clause
"""The two-stage batch estimator in one call."""

import os
from typing import Unpack, overload

from sepcal import _core
from sepcal.aircraft import Aero, RigidAircraft
from sepcal.aircraft_fits import AircraftFit, fit_flight
from sepcal.arguments import checked
from sepcal.calibration import Calibration
from sepcal.columns import by_name, labels_in, take_columns, take_drivers
from sepcal.fit_options import FitOptions
from sepcal.flight import AnyFlight, Flight, to_columns, to_flight
from sepcal.models import Model
from sepcal.options import log_choices, refuse_log_choice, spelled_out, to_core
from sepcal.own_effect import Effect, given_effects, name_effects, to_core_effects
from sepcal.own_state_model import AnyModel, as_model, own_among
from sepcal.reading.frames import is_frame
from sepcal.results import Fit
from sepcal.trajectories import FlightPath


@overload
def fit(  # type: ignore[overload-overlap]  # a FlightPath is a Model
    model: FlightPath | Aero | RigidAircraft,
    data: Flight | str | os.PathLike[str],
    **options: Unpack[FitOptions],
) -> AircraftFit: ...


@overload
def fit(
    model: Model, data: Flight | str | os.PathLike[str], **options: Unpack[FitOptions]
) -> Calibration: ...


@overload
def fit(model: AnyModel, data: AnyFlight, **options: Unpack[FitOptions]) -> Fit: ...


@spelled_out()
@checked
def fit(
    model: AnyModel | Aero | RigidAircraft, data: AnyFlight, **options: Unpack[FitOptions]
) -> Fit:
    """Fits a model: samples xi2 and solves xi1 linearly, then maximum likelihood within bounds.

    Sun & Gebre-Egziabher, Steps 2-5. It runs without the GIL, on as many threads as asked for.

    Args:
        model: One of sepcal's own, of flights also Aero and RigidAircraft, or one of yours in
            Python: any object with the tables and at() of SeparableModel or, with a state, of
            StateModel. Python lets one thread in at a time, so that threads=0 then means one.
        data: A Flight (columns with units in their headers) or what read() makes one of: a file's
            name, a DataFrame. Or, where all of these are there, the model's own inputs and outputs
            by name in the units of its tables, each of shape (N,): a dict or a DataFrame. There
            "time" [s] and "maneuver" (labels) are optional and cut the record at gaps and changes
            of label; other columns are ignored but by effects. C-contiguous float64 arrays are not
            copied.
        **options: FitOptions.

    Returns:
        Of a flight a Calibration, or the AircraftFit of a path or an aircraft; of the model's own
        columns a Fit.
        Non-convergence and what the data do not determine are its `status` and `message`.

    Raises:
        Error: Bad input or misuse: one line that names the culprit and the way out.
        TypeError: An option that there isn't, or of the wrong kind.
        Exception: Whatever at() of a model in Python raises.

    Example:
        >>> flight = sepcal.datasets.load("pitot")
        >>> base = sepcal.fit(sepcal.PitotStatic(), flight, fix={"w_d": 0.0})
        >>> base.status, round(base["w_e"].value, 1), flight.truth["w_e"]
        ('converged', 2.5, 2.4)
    """
    if isinstance(model, Flight | str | os.PathLike):
        raise _core.Error("the model comes first, then the data: sepcal.fit(model, flight)")
    if isinstance(model, Aero | RigidAircraft) or (
        isinstance(model, FlightPath) and isinstance(data, Flight | str | os.PathLike)
    ):
        return fit_flight(model, to_flight(data, "fit(model, ", "", options), options)
    model = as_model(model)
    is_flight = isinstance(data, Flight) or (is_frame(data) and bool(log_choices(options)))
    columns_of_model = None if is_flight else to_columns(data, model)
    if columns_of_model is None:
        data = to_flight(data, "fit(model, ", model, options)
    if model.runs_in_python:
        options["threads"] = options.get("threads") or 1
    effects = given_effects(options)
    options["effects"] = names = name_effects(effects)
    core_options, own = to_core(options), to_core_effects(effects)
    if isinstance(data, Flight):
        core = _core.calibrate(model._core, data._core, core_options, own)
        made = [effect for effect in effects if isinstance(effect, Effect)]
        return Calibration(core, data, made, own_among(model))
    refuse_log_choice(options)
    if getattr(model, "mounting", None) is not None:
        raise _core.Error("mounting turns the readings of a Flight; turn these yourself")
    if getattr(model, "field_strength", None) == "auto":
        raise _core.Error(
            "field_strength='auto' is found in a Flight; give these the strength in uT"
        )
    data = by_name(columns_of_model or {})
    there = set(data)
    needed = [*model._columns_in(data), *model._measured_in(data), *({"time"} & there)]
    columns = take_columns(model._owner, data, dict.fromkeys(needed))
    if names:
        columns |= take_drivers(model._owner, data, columns, _core.channels(names))
    labels = labels_in(data)
    laid = model._core.along(columns, labels)
    return Fit(_core.fit(laid, columns, labels, core_options, own))
