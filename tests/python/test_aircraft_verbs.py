# SPDX-License-Identifier: BSD-3-Clause
"""Verbs that an aircraft shares with a probe: check, several flights, intervals, an injection."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats

import apps
import sepcal
from cases import but_first_slow
from refusals import refuse

EQUATION = {"Cm": ["1", "alpha", "q_hat", "elevator"]}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two flights of an aircraft, a.csv and b.csv, and the aircraft."""
    folder = tmp_path_factory.mktemp("aircraft")
    for seed, name in enumerate(("a", "b"), start=1):
        made = apps.run(
            "sepcal-aircraft", "simulate", "-o", f"{name}.csv", "--geometry", "aircraft.json",
            "--seed", str(seed), "--rows", "1200", folder=folder,
        )  # fmt: skip
        assert made.code == 0, made.err
    return folder


@pytest.fixture(scope="module")
def aircraft(folder: Path) -> sepcal.Aircraft:
    return sepcal.read_aircraft(folder / "aircraft.json")


@pytest.fixture(scope="module")
def flights(folder: Path) -> list[sepcal.Flight]:
    return [sepcal.read_csv(folder / f"{name}.csv") for name in ("a", "b")]


@pytest.fixture(scope="module")
def moment(aircraft: sepcal.Aircraft) -> sepcal.Aero:
    return sepcal.Aero(aircraft, equations=EQUATION)


# --- several flights


def normal_matrix(fit: sepcal.AircraftFit) -> np.ndarray:
    """A'A of one output's linear least squares."""
    return fit.rmse["Cm"] ** 2 * np.linalg.inv(fit.covariance_white)


def test_equation_error_of_two_flights_is_their_least_squares(
    moment: sepcal.Aero, flights: list[sepcal.Flight]
) -> None:
    """(A1'A1 + A2'A2)^-1 (A1'A1 x1 + A2'A2 x2), from the fits of each."""
    parts = [sepcal.fit(moment, flight) for flight in flights]
    matrices = [normal_matrix(part) for part in parts]
    expected = np.linalg.solve(
        sum(matrices),
        sum(
            matrix @ [one.value for one in part.parameters.values()]
            for matrix, part in zip(matrices, parts, strict=True)
        ),
    )
    joint = sepcal.fit_jointly(moment, flights)
    assert_allclose([one.value for one in joint.parameters.values()], expected, rtol=1e-9)


@pytest.mark.parametrize("axes", but_first_slow(["longitudinal", "lateral"]))
def test_output_error_of_two_flights_lies_between(
    aircraft: sepcal.Aircraft, flights: list[sepcal.Flight], axes: str
) -> None:
    """Each flight's initial states are its own; what they share is surer, and agrees with each."""
    model = sepcal.RigidAircraft(aircraft, axes)
    parts = [sepcal.fit(model, flight) for flight in flights]
    joint = sepcal.fit_jointly(model, flights)
    assert joint.status == "converged"
    assert len(joint.initial_states) == sum(len(part.initial_states) for part in parts)
    for name in {"longitudinal": ("Cm_alpha", "CZ_alpha"), "lateral": ("Cl_p", "Cn_beta")}[axes]:
        assert joint[name].standard_error_white < min(
            part[name].standard_error_white for part in parts
        )
        for part in parts:
            off = (part[name].value - joint[name].value) / part[name].standard_error
            assert abs(off) < 4.0  # 6e-5 a comparison, of eight


def test_the_command_takes_the_flights_in_any_order(folder: Path) -> None:
    fitted = apps.run(
        "sepcal-aircraft", "fit", "a.csv", "b.csv", "--model", "aero", "--geometry",
        "aircraft.json", "-o", "two.json", folder=folder,
    )  # fmt: skip
    assert fitted.code == 0
    pages = {
        apps.run("sepcal-aircraft", "compare", *order, "two.json", folder=folder).out
        for order in (("a.csv", "b.csv"), ("b.csv", "a.csv"))
    }
    assert len(pages) == 1
    assert "a.csv + b.csv" in pages.pop()
    added = apps.run(
        "sepcal-aircraft", "add", "b.csv", "a.csv", "two.json", "Cm[alpha^2]", folder=folder
    )
    assert "Cm_alpha^2" in added.out
    assert "not the flight of the fit" not in added.err


def test_own_parameters_are_refused(moment: sepcal.Aero, flights: list[sepcal.Flight]) -> None:
    refuse(
        lambda: sepcal.fit_jointly(moment, flights, own=["Cm_0"]),
        "own: the flights of an aircraft share all but their initial states",
    )


def test_a_flight_whose_segments_tell_nothing_of_each_other(tmp_path: Path) -> None:
    """All but initial states is held, so that a block of rows has all of a state or nothing."""
    for seed, name in ((3, "f.csv"), (4, "g.csv")):
        apps.run(
            "sepcal-aircraft", "simulate", "-o", name, "--seed", f"{seed}", "--rows", "700",
            folder=tmp_path,
        )  # fmt: skip
    apps.run("sepcal-aircraft", "fit", "f.csv", "--model", "path", "-o", "p.json", folder=tmp_path)
    compared = apps.run("sepcal-aircraft", "compare", "g.csv", "p.json", folder=tmp_path)
    assert compared.code == 0
    assert "g.csv is not the flight of the fit" in compared.err


def test_flights_of_different_rates_are_refused(
    moment: sepcal.Aero, flights: list[sepcal.Flight]
) -> None:
    thin = {name: np.array(flights[1][name])[::3] for name in flights[1].columns}
    slow = sepcal.Flight(thin, name="slow")
    refuse(
        lambda: sepcal.fit_jointly(moment, [flights[0], slow]),
        "slow has", "rows a second", "thin the faster log out",
    )  # fmt: skip


# --- intervals


def test_intervals_end_where_the_cost_has_risen(
    aircraft: sepcal.Aircraft, flights: list[sepcal.Flight]
) -> None:
    """2 (J_p - J) = M ln(1 + c t^2 / (M - n)) at both ends, each fitted again with that held."""
    model = sepcal.RigidAircraft(aircraft, "longitudinal")
    base = sepcal.fit(model, flights[0])
    interval = base.intervals(names=["Cm_alpha"])["Cm_alpha"]
    free = sum(not one.fixed for one in base.parameters.values())
    readings = base.rows * len(base.rmse)
    colour = (base["Cm_alpha"].standard_error / base["Cm_alpha"].standard_error_white) ** 2
    quantile = stats.t.ppf(0.975, readings - free)
    expected = readings * math.log1p(colour * quantile**2 / (readings - free))
    start = {
        one.name: one.value
        for one in list(base.parameters.values())[base.n_1 :]
        if not one.fixed and one.name != "Cm_alpha"
    }
    for end in interval.profile:
        held = sepcal.fit(model, flights[0], fix={"Cm_alpha": end}, start=start)
        # J of Eq. 6 with R estimated: N ln|R| / 2 is what a likelihood rises by.
        rise = base.rows * sum(
            2 * math.log(held.rmse[output] / base.rmse[output]) for output in base.rmse
        )
        assert_allclose(rise, expected, rtol=0.02)


def test_a_linear_models_intervals_are_alike(
    moment: sepcal.Aero, flights: list[sepcal.Flight]
) -> None:
    """Of one output, exactly: the F test's and Student's."""
    for one in sepcal.fit_jointly(moment, flights).intervals().parameters.values():
        width = one.gaussian[1] - one.gaussian[0]
        assert_allclose(one.profile, one.gaussian, atol=1e-4 * width, rtol=0)


def test_the_command_prints_what_python_does(folder: Path, flights: list[sepcal.Flight]) -> None:
    apps.run(
        "sepcal-aircraft", "fit", "a.csv", "--model", "aero", "--geometry", "aircraft.json",
        "-o", "one.json", folder=folder,
    )  # fmt: skip
    told = apps.run(
        "sepcal-aircraft", "intervals", "a.csv", "one.json", "--parameter", "Cm_alpha", "--json",
        folder=folder,
    )  # fmt: skip
    found = sepcal.load(folder / "one.json").intervals(flights[0], names=["Cm_alpha"])
    assert found.to_dict()["parameters"] == json.loads(told.out)["parameters"]


def test_what_intervals_refuse(
    aircraft: sepcal.Aircraft, moment: sepcal.Aero, flights: list[sepcal.Flight]
) -> None:
    base = sepcal.fit(moment, flights[0])
    refuse(lambda: base.intervals(flights[1]), "b.csv is not the flight of the fit")
    refuse(lambda: base.intervals(names=["Cm_beta"]), "there is no parameter 'Cm_beta'")
    noisy = sepcal.fit(sepcal.RigidAircraft(aircraft, "lateral"), flights[0], method="filter-error")
    refuse(lambda: noisy.intervals(names=["Cn_beta"]), "a fit by filter error is not profiled")


# --- an injection


def test_what_is_put_into_coefficients_is_found(
    moment: sepcal.Aero, flights: list[sepcal.Flight]
) -> None:
    base = sepcal.fit(moment, flights[0])
    found = base.diagnose(inject={"Cm[alpha^2]": 12.0})
    assert found.injected is not None
    assert (found.injected.found, found.injected.rank) == (True, 1)
    effect = next(one for one in found.effects if one.name == "Cm[alpha^2]")
    error = effect.standard_error["Cm[alpha^2].s"]
    assert abs(found.injected.estimate["Cm[alpha^2].s"] - 12.0) < 4.0 * error
    assert "with Cm[alpha^2] injected" in found.sentence
    assert base.diagnose(only=["Cm[alpha^2]"]).verdict == "adequate"  # the fit is as it was


@pytest.mark.parametrize("effect", but_first_slow(["Cm[alpha^2]", "gyro_bias[imu_temp_degc]"]))
def test_what_is_put_along_a_trajectory_is_found(
    aircraft: sepcal.Aircraft, flights: list[sepcal.Flight], effect: str
) -> None:
    base = sepcal.fit(sepcal.RigidAircraft(aircraft, "longitudinal"), flights[0])
    size = {"Cm[alpha^2]": 3.0, "gyro_bias[imu_temp_degc]": 0.004}[effect]
    found = base.diagnose(inject={effect: size}, only=[effect, "controls_late"])
    assert found.injected is not None
    assert (found.injected.found, found.injected.rank) == (True, 1)
    for estimate in found.injected.estimate.values():
        assert_allclose(estimate, size, rtol=0.2)


def test_what_is_put_into_another_flight_is_found(
    aircraft: sepcal.Aircraft, flights: list[sepcal.Flight]
) -> None:
    """Its initial states are estimated anew before anything is put in."""
    base = sepcal.fit(sepcal.RigidAircraft(aircraft, "longitudinal"), flights[0])
    found = base.diagnose(flights[1], inject={"Cm[alpha^2]": 3.0}, only=["Cm[alpha^2]"])
    assert found.injected is not None
    assert (found.injected.found, found.injected.rank) == (True, 1)
    (estimate,) = found.injected.estimate.values()
    assert_allclose(estimate, 3.0, rtol=0.2)


def test_what_an_injection_refuses(moment: sepcal.Aero, flights: list[sepcal.Flight]) -> None:
    base = sepcal.fit(moment, flights[0], effects=["Cm[alpha^2]"])
    refuse(lambda: base.diagnose(inject={"Cm[alpha^2]": 1.0}), "stands twice")
    refuse(
        lambda: base.diagnose(inject={"Cm[alpha^3]": [1.0, 2.0]}), "2 sizes for the 1 parameters"
    )
    refuse(
        lambda: base.diagnose(inject={"Cm[alpha^3]": 1.0}, auto=True),
        "inject and auto exclude each other",
    )


# --- a log before it is fitted


def test_check_reads_what_the_model_reads(flights: list[sepcal.Flight]) -> None:
    checked = sepcal.check(sepcal.FlightPath(), flights[0])
    assert checked.model == "path"
    assert checked.refused == ""
    quantities = {column.header: column.quantity for column in checked.columns}
    assert quantities["az_mps2"] == "az"
    assert quantities["imu_temp_degc"] == ""


@pytest.mark.parametrize(
    ("change", "refused"),
    [
        ({"az_mps2": None}, "az_mps2"),
        ({"az_mps2": None, "an_g": "az_mps2"}, "an_g"),
        ({"q_radps": None, "q_degpm": "q_radps"}, "q_degpm"),
    ],
)
def test_check_says_what_a_fit_would(
    flights: list[sepcal.Flight], change: dict[str, str | None], refused: str, tmp_path: Path
) -> None:
    columns = {name: np.array(flights[0][name]) for name in flights[0].columns}
    for header, source in change.items():
        if source is None:
            columns.pop(header)
        else:
            columns[header] = np.array(flights[0][source])
    flight = sepcal.Flight(columns)
    checked = sepcal.check(sepcal.FlightPath(), flight)
    assert refused in checked.refused
    with pytest.raises(sepcal.Error) as error:
        sepcal.fit(sepcal.FlightPath(), flight)
    assert str(error.value) == checked.refused


def test_check_refuses_a_unit_that_is_wrong_as_a_fit_does(flights: list[sepcal.Flight]) -> None:
    """An angle of attack in degrees under a header in radians."""
    columns = {name: np.array(flights[0][name]) for name in flights[0].columns}
    columns["alpha_rad"] = np.degrees(columns["alpha_rad"])
    flight = sepcal.Flight(columns)
    refuse(lambda: sepcal.fit(sepcal.FlightPath(), flight), "'alpha' reaches", "degrees")
    assert "'alpha' reaches" in sepcal.check(sepcal.FlightPath(), flight).refused


def test_turns_are_asked_for_where_a_wind_is_found(
    aircraft: sepcal.Aircraft, flights: list[sepcal.Flight]
) -> None:
    def kinds(model: object) -> set[str]:
        return {note.kind for note in sepcal.check(model, flights[0]).notes}

    assert "headings" in kinds(sepcal.FlightPath())
    assert "headings" not in kinds(sepcal.RigidAircraft(aircraft, "longitudinal"))


def test_the_command_checks(folder: Path) -> None:
    checked = apps.run("sepcal-aircraft", "check", "a.csv", "--model", "lateral", folder=folder)
    assert checked.code == 0
    assert "lateral: 1200 rows of a.csv" in checked.out
    wrong = apps.run("sepcal-aircraft", "check", "a.csv", "--model", "vertical", folder=folder)
    assert wrong.code == 2
    assert "there is no model 'vertical'" in wrong.err
