# SPDX-License-Identifier: BSD-3-Clause
"""Equation error over a band: NumPy's sums, a truth in drift that time-domain fits take for signal.

The oracle writes transform and normal equations anew; numpy.fft gives the transform where the
frequencies are its own.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import apps
import sepcal
from refusals import refuse

AIRCRAFT = sepcal.Aircraft(
    area=16.2, chord=1.49, span=10.9, mass=1050.0, inertia=(1285.0, 1825.0, 2667.0, 60.0)
)
REGRESSORS = ["1", "alpha", "q_hat", "elevator"]
NAMES = ["Cm_0", "Cm_alpha", "Cm_q", "Cm_elevator"]
COLUMNS = ["time_s", "ax_mps2", "ay_mps2", "az_mps2", "p_radps", "q_radps", "r_radps"]
COLUMNS += ["airspeed_mps", "alpha_rad", "beta_rad", "rho_kgpm3", "elevator_rad"]
Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def maneuvers() -> sepcal.SimulatedFlight:
    return sepcal.simulate(AIRCRAFT, rows=1500, seed=4)


@pytest.fixture(scope="module")
def flight(maneuvers: sepcal.SimulatedFlight) -> sepcal.Flight:
    """The same in one segment."""
    return sepcal.Flight({name: maneuvers[name] for name in COLUMNS})


def columns_of(flight: sepcal.Flight) -> tuple[Array, Array, Array]:
    """Time, Cm and its regressors row by row, as they are without a band."""
    data = {name.rsplit("_", 1)[0]: np.asarray(flight[name]) for name in COLUMNS}
    found = sepcal.aero_coefficients(data, AIRCRAFT, ["Cm"]).columns
    X = np.column_stack([np.ones_like(data["time"]), *(found[name] for name in REGRESSORS[1:])])
    return data["time"], found["Cm"], X


def transform(columns: Array, time: Array, frequencies: Array) -> NDArray[np.complex128]:
    """Of columns, without what is the transform of a straight line."""
    turn = np.exp(-2j * np.pi * np.outer(frequencies, time - (time[0] + time[-1]) / 2))
    line = np.column_stack([np.ones_like(time), time - time.mean()])
    ends, X = (np.sqrt(2 / len(time)) * turn @ of for of in (line, columns))
    both = np.vstack([ends.real, ends.imag])
    factors = np.linalg.lstsq(both, np.vstack([X.real, X.imag]), rcond=1e-9)[0]
    return np.asarray(X - ends @ factors)


@pytest.mark.parametrize("spacing", [0.0, 0.01])
def test_it_is_complex_least_squares(flight: sepcal.Flight, spacing: float) -> None:
    model = sepcal.Aero(AIRCRAFT, equations={"Cm": REGRESSORS}, band=(0.15, 1.5), spacing=spacing)
    fit = sepcal.fit(model, flight)
    assert fit.method == "frequency-equation-error"
    time, Cm, X = columns_of(flight)
    T = time[-1] - time[0] + np.median(np.diff(time))
    step = spacing or 1 / T
    frequencies = np.arange(0.15, 1.5 + 1e-9, step)
    if not spacing:
        frequencies = np.arange(np.ceil(0.15 * T - 1e-9), np.floor(1.5 * T + 1e-9) + 1) / T
    Z = transform(Cm[:, None], time, frequencies)[:, 0]
    A = transform(X[:, 1:], time, frequencies)
    normal = (A.conj().T @ A).real
    slopes = np.linalg.solve(normal, (A.conj().T @ Z).real)
    expected = [Cm.mean() - X[:, 1:].mean(axis=0) @ slopes, *slopes]
    assert_allclose([fit[name].value for name in NAMES], expected, rtol=1e-8)

    # The score's covariance with the residual's spectrum, frequency by frequency.
    e = Z - A @ slopes
    close = max(1.0, 1 / (step * T))
    h = np.array([(a.conj() @ np.linalg.solve(normal, a)).real / 2 * close for a in A])
    squares = np.abs(e) ** 2 / 2 / (1 - h)
    reach = np.abs(frequencies[:, None] - frequencies) <= 4.5 / T
    spectrum = (reach * squares).sum(axis=1) / reach.sum(axis=1)
    share = np.sinc((frequencies[:, None] - frequencies) * T)
    share[np.abs(frequencies[:, None] - frequencies) * T > 30] = 0
    root = np.diag(np.sqrt(spectrum)) @ share @ np.diag(np.sqrt(spectrum))
    bread = np.linalg.inv(normal)
    covariance = bread @ (A.conj().T @ root @ A).real @ bread
    white = bread @ (A.conj().T @ (squares.mean() * share) @ A).real @ bread
    for k, name in enumerate(NAMES[1:]):
        assert fit[name].standard_error == pytest.approx(np.sqrt(covariance[k, k]), rel=1e-5)
        assert fit[name].standard_error_white == pytest.approx(np.sqrt(white[k, k]), rel=1e-5)


def test_maneuvers_are_transformed_one_by_one(maneuvers: sepcal.SimulatedFlight) -> None:
    fit = sepcal.fit(sepcal.Aero(AIRCRAFT, "Cm", band=(0.3, 2.0)), maneuvers)
    assert fit.rows == 1500
    for name in NAMES[1:]:
        assert abs(fit[name].value - maneuvers.truth[name]) < 4 * fit[name].standard_error


def test_all_verbs_in_time_bear_it(flight: sepcal.Flight) -> None:
    base = sepcal.fit(sepcal.Aero(AIRCRAFT, "Cm", band=(0.1, 2.0)), flight)
    _, Cm, X = columns_of(flight)
    left = Cm - X @ [base[name].value for name in NAMES]
    assert base.rmse["Cm"] == pytest.approx(np.sqrt(np.mean(left**2)), rel=1e-9)
    assert base.compare().overall[0].rmse == pytest.approx(base.rmse["Cm"], rel=1e-9)
    assert base.residuals()["Cm_residual"][7] == pytest.approx(left[7], rel=1e-9)
    more = base.add("Cm[alpha^2]")
    assert more.method == "frequency-equation-error"
    assert "Cm_alpha^2" in more.parameters
    refuse(base.diagnose, "a fit over a band has no rows for a diagnosis", "in time")
    refuse(base.intervals, "a fit over a band is not profiled")


def test_it_is_saved_and_loaded(flight: sepcal.Flight, tmp_path: Path) -> None:
    fit = sepcal.fit(sepcal.Aero(AIRCRAFT, "Cm", band=(0.2, 1.5), spacing=0.03), flight)
    fit.save(tmp_path / "fit.json")
    again = sepcal.load(tmp_path / "fit.json")
    assert again.method == fit.method
    assert str(again) == str(fit)
    band = json.loads((tmp_path / "fit.json").read_text())["aircraft"]["band"]
    assert band == {"low": 0.2, "high": 1.5, "spacing": 0.03}


def test_the_program_has_it_too(tmp_path: Path) -> None:
    def run(*arguments: str) -> apps.Outcome:
        return apps.run("sepcal-aircraft", *arguments, folder=tmp_path)

    assert run("simulate", "-o", "f.csv", "--geometry", "a.json", "--seed", "3").code == 0
    fit = ("fit", "f.csv", "--model", "aero", "--geometry", "a.json", "--method", "frequency")
    done = run(*fit, "--band", "0.2:1.5", "-o", "fit.json")
    assert done.code == 0, done.err
    assert "frequency-equation-error, 0.2 to 1.5 Hz" in done.out
    found = json.loads((tmp_path / "fit.json").read_text())["parameters"]
    model = sepcal.Aero(sepcal.read_aircraft(tmp_path / "a.json"), band=(0.2, 1.5))
    same = sepcal.fit(model, sepcal.read_csv(tmp_path / "f.csv"))
    assert {name: entry["value"] for name, entry in found.items()} == pytest.approx(
        {name: entry.value for name, entry in same.parameters.items()}
    )
    assert run("compare", "f.csv", "fit.json").code == 0

    for wrong, word in (
        (("--band", "2:0.1"), "a band from 2 to 0.1 Hz is none"),
        (("--band", "0.1"), "write LOW:HIGH in Hz"),
        (("--band", "0.1:0.11"), "holds less than two frequencies"),
        (("--band", "0.1:2", "--spacing", "-1"), "can't be -1 Hz apart"),
        (("--loss", "huber"), "leave the loss out"),
    ):
        refused = run(*fit, *wrong)
        assert refused.code == 2
        assert word in refused.err
        assert refused.err.count("\n") == 1
    in_time = run("fit", "f.csv", "--model", "aero", "--geometry", "a.json", "--band", "0.1:2")
    assert in_time.code == 2
    assert "give --method frequency" in in_time.err
    path = run("fit", "f.csv", "--model", "path", "--method", "frequency")
    assert path.code == 2
    assert "a flight path is fitted in time" in path.err


def test_what_is_no_band_is_refused() -> None:
    refuse(lambda: sepcal.Aero(AIRCRAFT, "Cm", spacing=0.1), "give band=(0.1, 2)")
    refuse(lambda: sepcal.Aero(AIRCRAFT, "Cm", band=(0.1, 1.0, 2.0)), "give (low, high)")
