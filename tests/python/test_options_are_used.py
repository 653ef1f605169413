# SPDX-License-Identifier: BSD-3-Clause
"""Every option that a fit takes changes what it says, or is refused by its name.

Each kind of subject is fitted with each option of the schema, at a value that is not its default.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest

import sepcal
from sepcal.fit_options import FitOptions
from sepcal.options import LOG_CHOICE

Given = Mapping[str, Any]

# Options whose result is the same by their nature, and why.
NATURE = {
    "threads": "the result does not depend on it",
    "seed": "where nothing is drawn there is nothing to seed",
    "drop_invalid": "the log has no bad cell",
    "jacobian": "another way to the same minimum",
    "iterations": "the fit ends before",
    "noise_iterations": "the same",
    "noise_tolerance": "R of one output settles at once",
    "second_stage": "auto may have chosen it",
    "descents": "there is one minimum",
    "map": "of a column that this fit does not take",
    "ignore": "the same",
    "drop_repeats": "no reading repeats",
    "delimiter": "the flight is not of a file",
    "decimal": "the same",
    "join": "all readings stand in one row",
}
# What is taken and not looked at, and why it is not refused.
KNOWN = {
    ("path", "coloured_errors"): "its standard errors allow for the noise of its readings instead",
}


@cache
def _tube() -> sepcal.Flight:
    return sepcal.simulate(sepcal.PitotStatic(), rows=300, seed=2, noise="ar")


@cache
def _compass() -> sepcal.Flight:
    straight = {f"eta_{axis}": 0.0 for axis in "xyz"}
    return sepcal.simulate("magnetometer", parameters=straight, rows=300, seed=2, noise="ar")


@cache
def _aircraft() -> tuple[sepcal.Aircraft, sepcal.Flight]:
    aircraft = sepcal.Aircraft(
        area=16.2, chord=1.49, span=10.9, mass=1000.0, inertia=(1285.0, 1825.0, 2667.0, 0.0)
    )
    return aircraft, sepcal.simulate(aircraft, seed=1)


def _tube_fit(**options: Any) -> sepcal.Fit:
    return sepcal.fit(sepcal.PitotStatic(), _tube(), **options)


def _strength_fit(**options: Any) -> sepcal.Fit:
    return sepcal.fit(sepcal.Magnetometer(field_strength=53.2), _compass(), **options)


def _columns_fit(**options: Any) -> sepcal.Fit:
    eta = np.linspace(1.0, 10.0, 120)
    noise = np.convolve(np.random.default_rng(1).standard_normal(124), 0.05 * np.ones(5), "valid")
    data = {"eta": eta, "time": eta, "z": 1.3 * np.cos(eta + 0.2) + 1.0 + noise}
    return sepcal.fit(sepcal.ScalarExample1(), data, **options)


def _aero_fit(**options: Any) -> sepcal.Fit:
    aircraft, flight = _aircraft()
    return sepcal.fit(sepcal.Aero(aircraft, "Cm"), flight, **options)


def _path_fit(**options: Any) -> sepcal.Fit:
    return sepcal.fit(sepcal.FlightPath(), _aircraft()[1], **{"to_time": 20.0, **options})


def _motion_fit(**options: Any) -> sepcal.Fit:
    aircraft, flight = _aircraft()
    model = sepcal.RigidAircraft(aircraft, "longitudinal")
    return sepcal.fit(model, flight, **{"to_time": 12.6, **options})


SUBJECTS: dict[str, tuple[Callable[..., sepcal.Fit], str, str, str]] = {
    # a parameter, an output and an effect of each
    "pitot-static": (_tube_fit, "w_n", "airspeed", "bias[time]"),
    "magnetometer-norm": (_strength_fit, "n_x", "field", "bias[time]"),
    "columns": (_columns_fit, "b", "z", "c[time]"),
    "aero": (_aero_fit, "Cm_alpha", "Cm", "Cm[alpha^2]"),
    "path": (_path_fit, "b_ax", "airspeed", "accel_bias[time]"),
}


def _given(parameter: str, output: str, effect: str, fit: sepcal.Fit) -> dict[str, Any]:
    """A value of every option that is not its default, as far as the subject has such a thing."""
    value = fit[parameter].value
    near = abs(value) * 0.01 + 1e-4
    noises = {name: 2.0 * one for name, one in fit.noise.items()}
    return {
        "effects": [effect],
        "bounds": {parameter: (value + near, value + 2.0 * near)},
        "fix": {parameter: value + near},
        "noise": noises,
        "prior": {parameter: (value + near, 0.1 * near)},
        "search": "global",
        "sampling_distribution": {parameter: (value, near)},
        "screens": {"t_1": 1e-9},
        "stage_one_segments": "2:6",
        "stage_two_segments": "2:6",
        "samples": 24,
        "sampling": "low_discrepancy",
        "start": {parameter: value + near},
        "seed": 7,
        "second_stage": "joint",
        "jacobian": "golub_pereyra",
        "method": "filter-error",
        "hessian": "observed",
        "loss": "huber",
        "loss_width": 0.5,
        "noise_tolerance": 0.5,
        "noise_iterations": 99,
        "iterations": 199,
        "descents": 1,
        "coloured_errors": False,
        "process_noise": {"ax": 0.05},
        "threads": 2,
        "free": ["b_v"],
        "map": {"altitude_ft": "altitude_m"},
        "ignore": ["altitude_m"],
        "drop_invalid": True,
        "drop_repeats": ["temp_degc"],
        "where": "time_s > 3",
        "from_time": 3.0,
        "to_time": 7.5,
        "delimiter": ";",
        "decimal": ",",
        "join": "linear",
        "smooth_inputs": True,
    }


def _said(fit: sepcal.Fit) -> tuple[Any, ...]:
    """All that may change."""
    stage_one = fit.stage_one
    return (
        fit.status,
        fit.message,
        fit.text,
        fit.rows,
        fit.values.tobytes(),
        np.array([one.standard_error for one in fit.parameters.values()]).tobytes(),
        np.asarray(stage_one.samples).tobytes(),
        len(stage_one.minima),
    )


@pytest.mark.parametrize("option", FitOptions.__annotations__)
@pytest.mark.parametrize("subject", SUBJECTS)
def test_an_option_is_used_or_refused(subject: str, option: str) -> None:
    """By a fit of each subject."""
    run, *names = SUBJECTS[subject]
    if option in LOG_CHOICE and subject == "columns":
        pytest.skip("chooses of a log")
    base = _base(subject)
    given = {option: _given(*names, base)[option]}
    try:
        fit = run(**given)
    except sepcal.Error as error:
        spelled = {"fix": "fix", "effects": "effect", "method": "filter error"}
        spelled |= {"stage_one_segments": "segment", "stage_two_segments": "segment"}
        words = spelled.get(option, option)
        said = str(error)
        assert words in said or any(str(name) in said for name in _names_in(given[option])), said
        return
    is_known = option in NATURE or (subject, option) in KNOWN
    assert _said(fit) != _said(base) or is_known


def _names_in(value: Any) -> list[str]:
    """What of a value its message may name."""
    if isinstance(value, Mapping | list):
        return [str(one) for one in value]
    return [str(value)]


@cache
def _base(subject: str) -> sepcal.Fit:
    return SUBJECTS[subject][0]()


def test_samples_are_refused_where_nothing_is_sampled() -> None:
    """The line says why, and the way out is to leave it out."""
    with pytest.raises(
        sepcal.Error, match=r"samples has no part here: .* ellipsoid .*; leave it out"
    ):
        _strength_fit(samples=20)
    for run in (_aero_fit, _path_fit, _motion_fit):
        with pytest.raises(sepcal.Error, match="search has no part here"):
            run(search="global")
        assert run(samples=0).status == run().status


@pytest.mark.parametrize(
    ("option", "value"),
    [("every", 5), ("row_iterations", 3), ("tolerance", 1e-3)],
)
def test_a_track_refuses_what_is_of_another_method(option: str, value: float) -> None:
    """By name, with the method that it is of."""
    eta = np.linspace(1.0, 10.0, 120)
    data = {"eta": eta, "time": eta, "z": 1.3 * np.cos(eta + 0.2) + 1.0}
    owner = "rml" if option == "every" else "iekf"
    for method in ("rls", "ekf", "srif"):
        with pytest.raises(sepcal.Error, match=f"{option} is of {owner} alone"):
            sepcal.track(
                sepcal.ScalarExample1(), data, start_rows=60, method=method, **{option: value}
            )
