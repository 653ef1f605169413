# SPDX-License-Identifier: BSD-3-Clause
"""A longitudinal model asks for longitudinal columns alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import apps
import sepcal
from refusals import refuse

ACROSS = ("ay_mps2", "p_radps", "r_radps", "beta_rad", "roll_rad")
OTHER = ("yaw_rad", "vn_mps", "ve_mps", "vd_mps", "aileron_rad", "rudder_rad")
CM = {"Cm": ["1", "alpha", "q_hat", "elevator"]}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("aircraft")
    made = apps.run(
        "sepcal-aircraft", "simulate", "-o", "all.csv", "--geometry", "aircraft.json", "--rows",
        "800", folder=folder,
    )  # fmt: skip
    assert made.code == 0, made.err
    return folder


@pytest.fixture(scope="module")
def flight(folder: Path) -> sepcal.Flight:
    return sepcal.read_csv(folder / "all.csv")


def without(flight: sepcal.Flight, *names: str, **more: np.ndarray) -> sepcal.Flight:
    columns = {name: values for name, values in flight.items() if name not in names}
    return sepcal.Flight({**columns, **more})


@pytest.mark.parametrize("subject", ["output error", "equation error", "band"])
def test_fit_is_that_of_zeros(folder: Path, flight: sepcal.Flight, subject: str) -> None:
    """In the plane of symmetry these columns are zero, and a log need not say so."""
    aircraft = sepcal.read_aircraft(folder / "aircraft.json")
    model = {
        "output error": sepcal.RigidAircraft(aircraft, "longitudinal"),
        "equation error": sepcal.Aero(aircraft, equations=CM),
        "band": sepcal.Aero(aircraft, equations=CM, band=(0.2, 2)),
    }[subject]
    less = without(flight, *ACROSS, *OTHER)
    zeros = {name: np.zeros(flight.rows) for name in ACROSS}
    fit = sepcal.fit(model, less)
    expected = sepcal.fit(model, without(flight, *ACROSS, *OTHER, **zeros))
    assert_allclose(fit.values, expected.values, rtol=1e-9, atol=1e-12)
    assert any("no column for ay, p, r, beta, roll, taken as zero" in note for note in fit.notes)
    assert [one.output for one in fit.compare().overall] == list(fit.rmse)


def test_moment_alone_is_about_the_truth(folder: Path, flight: sepcal.Flight) -> None:
    aircraft = sepcal.read_aircraft(folder / "aircraft.json")
    less = without(flight, *ACROSS, *OTHER)
    fit = sepcal.fit(sepcal.RigidAircraft(aircraft, "longitudinal"), less)
    truth = sepcal.simulate("aircraft", rows=10).truth
    assert_allclose(fit["Cm_elevator"].value, truth["Cm_elevator"], rtol=0.1)


def test_models_that_look_across_still_ask(folder: Path, flight: sepcal.Flight) -> None:
    aircraft = sepcal.read_aircraft(folder / "aircraft.json")
    less = without(flight, *ACROSS, *OTHER)
    for model in (
        sepcal.FlightPath(),
        sepcal.RigidAircraft(aircraft, "lateral"),
        sepcal.Aero(aircraft, "Cl"),
    ):
        refuse(lambda model=model: sepcal.fit(model, less), "column 'ay_mps2' is missing")


def test_app_fits_and_checks(folder: Path, flight: sepcal.Flight) -> None:
    less = without(flight, *ACROSS, *OTHER)
    rows = zip(*(values.tolist() for _, values in less.items()), strict=True)
    text = ",".join(name for name, _ in less.items()) + "\n"
    text += "".join(",".join(map(repr, row)) + "\n" for row in rows)
    (folder / "less.csv").write_text(text)
    model = ("--model", "longitudinal")
    fitted = apps.run(
        "sepcal-aircraft", "fit", "less.csv", *model, "--geometry", "aircraft.json", "-o",
        "base.json", folder=folder,
    )  # fmt: skip
    assert fitted.code == 0, fitted.err
    assert "no column for ay, p, r, beta, roll" in fitted.err
    checked = apps.run("sepcal-aircraft", "check", "less.csv", *model, folder=folder)
    assert "a fit would take all rows" in checked.out
    compared = apps.run("sepcal-aircraft", "compare", "less.csv", "base.json", folder=folder)
    assert compared.code == 0, compared.err
