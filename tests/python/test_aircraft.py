# SPDX-License-Identifier: BSD-3-Clause
"""Aircraft in Python: the app's numbers, every method on every model, errors in one line."""

import json
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import apps
import sepcal
from refusals import refuse

NOISE = {
    "path": {"ax": 0.01, "ay": 0.01, "az": 0.01, "p": 1e-3, "q": 1e-3, "r": 1e-3},
    "longitudinal": {"u": 0.01, "w": 0.01, "q": 0.002},
    "lateral": {"v": 0.01, "p": 0.002, "r": 0.002},
    "six-dof": {"u": 0.01, "v": 0.01, "w": 0.01, "p": 0.002, "q": 0.002, "r": 0.002},
}
METHODS = ("rls", "ekf", "iekf", "srif")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two flights of an aircraft, a.csv and b.csv, and the aircraft."""
    folder = tmp_path_factory.mktemp("aircraft")
    for seed, name in enumerate(("a", "b"), start=1):
        made = apps.run(
            "sepcal-aircraft", "simulate", "-o", f"{name}.csv", "--geometry", "aircraft.json",
            "--truth", f"{name}.json", "--seed", str(seed), folder=folder,
        )  # fmt: skip
        assert made.code == 0, made.err
    return folder


@pytest.fixture(scope="module")
def aircraft(folder: Path) -> sepcal.Aircraft:
    return sepcal.read_aircraft(folder / "aircraft.json")


@pytest.fixture(scope="module")
def flights(folder: Path) -> list[sepcal.Flight]:
    return [sepcal.read_csv(folder / f"{name}.csv") for name in ("a", "b")]


Fits = Callable[[str], sepcal.AircraftFit]


@pytest.fixture(scope="module")
def fits(aircraft: sepcal.Aircraft, flights: list[sepcal.Flight]) -> Fits:
    """Of the first flight, by the model's name, each fitted once."""
    found: dict[str, sepcal.AircraftFit] = {}

    def fit(model: str) -> sepcal.AircraftFit:
        if model not in found:
            made = {"path": sepcal.FlightPath(), "aero": sepcal.Aero(aircraft)}.get(model)
            chosen = made if made is not None else sepcal.RigidAircraft(aircraft, model)
            found[model] = sepcal.fit(chosen, flights[0])
        return found[model]

    return fit


@pytest.mark.parametrize("model", [*NOISE, "aero"])
def test_the_numbers_are_the_apps(model: str, fits: Fits, folder: Path) -> None:
    done = apps.run(
        "sepcal-aircraft", "fit", "a.csv", "--model", model, "--geometry", "aircraft.json",
        "-o", "app.json", folder=folder,
    )  # fmt: skip
    assert done.code == 0, done.err
    expected = json.loads((folder / "app.json").read_text())["parameters"]
    found = fits(model)
    assert found.model == model
    assert set(found.names) == set(expected)
    for name, entry in expected.items():
        assert found[name].value == pytest.approx(entry["value"], rel=1e-9, abs=1e-12), name
    assert sepcal.load(folder / "app.json").status == found.status


@pytest.mark.slow
def test_every_filter_on_every_model_with_a_state(
    fits: Fits, flights: list[sepcal.Flight], folder: Path
) -> None:
    """From the first flight's calibration the second's estimates stay within their deviations."""
    truth = json.loads((folder / "b.json").read_text())["parameters"]
    for model, noise in NOISE.items():
        fit = fits(model)
        for method in METHODS[1:]:
            found = fit.track(flights[1], method=method, process_noise=noise)
            assert found.refused == 0
            for name in set(truth) & set(found.names):
                sd = found.standard_deviation(name)[-1]
                if sd > 0:
                    assert abs(found[name][-1] - truth[name]) < 6.0 * sd, (model, method, name)
                    assert sd <= found.standard_deviation(name)[0] * 1.01


@pytest.mark.parametrize("method", ["ekf", "iekf", "srif"])
def test_a_log_that_lacks_an_output_takes_the_noise_of_the_others_by_name(
    fits: Fits, flights: list[sepcal.Flight], method: str
) -> None:
    fit = fits("path")
    blind = sepcal.Flight(
        {name: flights[1][name] for name in flights[1].columns if name != "alpha_rad"}
    )
    noise = {name: value for name, value in fit.noise.items() if name != "alpha"}
    found = fit.track(blind, method=method, process_noise=NOISE["path"])
    expected = fit.track(blind, method=method, process_noise=NOISE["path"], noise=noise)
    np.testing.assert_allclose(found.estimates, expected.estimates, rtol=1e-9, atol=1e-12)
    assert "lambda_alpha" not in found.names


def test_recursive_least_squares_of_equation_error_is_the_batch(
    aircraft: sepcal.Aircraft, flights: list[sepcal.Flight]
) -> None:
    quiet = {"coloured_errors": False}
    fit = sepcal.fit(sepcal.Aero(aircraft, "Cm", "CZ"), flights[0], **quiet)
    noise = dict(fit.noise)
    ends = [
        fit.track(start_rows=400, method=method, noise=noise).estimates[-1] for method in METHODS
    ]
    errors = np.array([parameter.standard_error_white for parameter in fit.parameters.values()])
    for end in ends:
        assert np.all(np.abs(end - fit.values) < 1e-6 * errors)


@pytest.mark.parametrize("model", NOISE)
def test_smoothed_states_are_near_the_models(
    model: str, fits: Fits, flights: list[sepcal.Flight]
) -> None:
    """Noise that is not there is estimated as none, and states stay at the trajectory."""
    smoothed = fits(model).smooth(NOISE[model])
    assert smoothed.x.shape == (flights[0].rows, len(smoothed.states))
    given = [smoothed.noises.index(name) for name in NOISE[model]]
    w = np.sqrt(np.nanmean(smoothed.w**2, axis=0))
    expected = np.sqrt(np.nanmean(smoothed.w_standard_error**2, axis=0))
    assert np.all(w[given] < expected[given])
    innovations = smoothed.innovations / smoothed.innovation_sd
    assert 0.8 < np.nanstd(innovations) < 1.2


@pytest.mark.parametrize("model", NOISE)
def test_smoothed_states_are_columns_of_apply(model: str, fits: Fits) -> None:
    fit = fits(model)
    smoothed = fit.smooth(NOISE[model])
    columns = fit.apply(process_noise=NOISE[model])
    for state in smoothed.states:
        header = next(name for name in columns if name.startswith(f"{state}_smooth"))
        assert_allclose(columns[header], smoothed[state])
        sd = columns[header.replace("_smooth", "_sd")]
        assert np.all(sd[np.isfinite(sd)] > 0)
    for noise in NOISE[model]:
        assert any(name.startswith(f"w_{noise}_") for name in columns)


@pytest.mark.slow
def test_intervals_of_a_path_hold(aircraft: sepcal.Aircraft) -> None:
    """Integrated noise of the inertial unit adds up along segments, less along pieces of 2 s.

    24 errors over their standard errors: the sum of squares stays within 9 to 48 but once in 200.
    Without what the readings say of their noise it leaves that.
    """
    biases = ("b_ax", "b_ay", "b_az", "b_p", "b_q", "b_r")  # truth 0
    flights = [sepcal.simulate(aircraft, seed=seed, rows=1000) for seed in range(10, 14)]

    def squares(shoot: float | None, **options: Any) -> float:
        model = sepcal.FlightPath() if shoot is None else sepcal.FlightPath(shoot=shoot)
        fits = [sepcal.fit(model, flight, **options) for flight in flights]
        assert all("not for its drift" in fit.warning for fit in fits)
        off = [fit[name].value / fit[name].standard_error for fit in fits for name in biases]
        print(f"shoot {shoot} {options}: {np.sqrt(np.mean(np.square(off))):.2f} SE in the rms")
        return float(np.sum(np.square(off)))

    assert 9.0 < squares(None) < 48.0
    assert 9.0 < squares(2.0) < 48.0
    assert squares(None, process_noise={"ax": 1e-12}) > 60.0


@pytest.mark.slow
def test_smoothed_states_of_a_path_are_as_sure_as_they_say(aircraft: sepcal.Aircraft) -> None:
    """Against the flight itself, six seeds: what the path leaves open widens the bands."""
    sensors = ("ax", "ay", "az", "p", "q", "r")
    others = ("airspeed", "alpha", "beta", "pitch", "roll", "yaw", "vn", "ve", "vd")
    quiet = sepcal.simulate(aircraft, noise=dict.fromkeys((*sensors, *others), 1e-9))
    exact = sepcal.fit(sepcal.FlightPath(), quiet).apply()
    true = {name: exact[f"{name}_mps"] for name in ("u", "v", "w")}
    true |= {"phi": quiet["roll_rad"], "theta": quiet["pitch_rad"], "psi": quiet["yaw_rad"]}
    density = {name: (0.05 if name.startswith("a") else 0.002) * 0.02**0.5 for name in sensors}
    off = []
    for seed in range(2, 8):
        smoothed = sepcal.fit(sepcal.FlightPath(), sepcal.simulate(aircraft, seed=seed)).smooth(
            density
        )
        rows = np.isfinite(smoothed.x[:, 0]).nonzero()[0][50::100]
        for i, state in enumerate(smoothed.states):
            error = smoothed[state][rows] - np.asarray(true[state])[rows]
            off.append(error / smoothed.standard_error[rows, i])
    rms, inside = np.sqrt(np.mean(np.square(off))), np.mean(np.abs(off) < 1.96)
    print(f"errors are {rms:.2f} SE in the rms, {inside:.0%} below 1.96")
    assert rms < 1.25
    assert inside > 0.9


def test_two_steps(aircraft: sepcal.Aircraft, flights: list[sepcal.Flight]) -> None:
    found = sepcal.two_step(flights[0], aircraft, fix={"lambda_v": 0.0})
    assert found.path["lambda_v"].fixed
    assert found.aero["Cm_q"].value == pytest.approx(-14.0, rel=0.06)
    assert "errors of the regressors" in found.aero.warning
    assert "step one, the flight path" in str(found)
    assert json.loads(found.to_json())["method"] == "two-step"


def test_a_regressor_is_added(fits: Fits) -> None:
    base = fits("longitudinal")
    more = base.add("Cm[alpha^2]")
    assert more.equations["Cm"] == [*base.equations["Cm"], "alpha^2"]
    assert [entry.effect for entry in more.history] == ["Cm[alpha^2]"]
    assert more.history[0].rmse_after["q"] == more.rmse["q"]
    entry = more["Cm_alpha^2"]
    assert abs(entry.value) < 4.0 * entry.standard_error  # there is none


def test_the_error_before_is_that_of_the_flight_it_is_added_on(
    fits: Fits, flights: list[sepcal.Flight]
) -> None:
    base = fits("longitudinal")
    (entry,) = base.add("Cm[alpha^2]", flights[1]).history
    overall = base.compare(flights[1]).overall
    assert entry.rmse_before == {misfit.output: misfit.rmse for misfit in overall}
    assert entry.rmse_before != base.rmse


def test_it_is_saved_and_pickled(fits: Fits, flights: list[sepcal.Flight], tmp_path: Path) -> None:
    fit = fits("longitudinal")
    fit.save(tmp_path / "saved.json")
    for again in (sepcal.load(tmp_path / "saved.json"), pickle.loads(pickle.dumps(fit))):
        assert again.to_json() == fit.to_json()
        assert again.compare(flights[0]).text == fit.compare().text
    other = fit.compare(flights[1])
    assert any("estimated anew" in note for note in other.notes)


def test_process_noise_is_kept_and_acts_again(
    aircraft: sepcal.Aircraft, flights: list[sepcal.Flight], tmp_path: Path
) -> None:
    fit = sepcal.fit(sepcal.FlightPath(), flights[0], process_noise={"ax": 0.1, "q": 0.01})
    fit.save(tmp_path / "path.json")
    again = sepcal.load(tmp_path / "path.json")
    assert json.loads((tmp_path / "path.json").read_text())["options"]["process_noise"] == {
        "ax": 0.1, "q": 0.01,
    }  # fmt: skip
    assert again["b_ax"].standard_error == fit["b_ax"].standard_error
    assert "the process noise that was given" in again.warning
    told = sepcal.fit(sepcal.FlightPath(), flights[0])
    assert fit["b_ax"].standard_error > 2 * told["b_ax"].standard_error
    assert fit["b_ax"].value == told["b_ax"].value
    refuse(
        lambda: sepcal.fit(sepcal.FlightPath(), flights[0], process_noise={"wind": 1.0}),
        "the model has no process noise 'wind'; it has ax, ay, az, p, q, r",
    )
    refuse(
        lambda: sepcal.fit(
            sepcal.RigidAircraft(aircraft, "longitudinal"), flights[0], process_noise={"ax": 1.0}
        ),
        "the model has no process noise 'ax'",
    )


def test_flights_of_arrays_are_told_apart_by_their_values(aircraft: sepcal.Aircraft) -> None:
    """Else another flight would be compared from the fitted one's initial states."""
    model = sepcal.RigidAircraft(aircraft, "longitudinal")
    mine, another, again = (sepcal.simulate(aircraft, seed=seed) for seed in (4, 5, 4))
    fit = sepcal.fit(model, mine)
    assert not any("estimated anew" in note for note in fit.compare(again).notes)
    assert any("initial states are estimated anew" in note for note in fit.compare(another).notes)
    refuse(lambda: fit.track(again), "whose rows must not count twice")
    assert len(fit.track(another).rows) > 0


def test_a_geometry_comes_back(aircraft: sepcal.Aircraft, tmp_path: Path) -> None:
    (tmp_path / "again.json").write_text(aircraft.to_json())
    assert sepcal.read_aircraft(tmp_path / "again.json") == aircraft


def test_the_vane_of_a_path_is_the_aircrafts(
    folder: Path, aircraft: sepcal.Aircraft, flights: list[sepcal.Flight]
) -> None:
    path = sepcal.FlightPath(aircraft=aircraft)
    assert path.vane == tuple(np.subtract(aircraft.vane, aircraft.imu))
    fit = sepcal.fit(path, flights[0])
    assert {"CX", "CY", "CZ", "Cl", "Cm", "Cn"} <= set(fit.apply())


def test_bad_input_is_one_line(
    aircraft: sepcal.Aircraft, fits: Fits, flights: list[sepcal.Flight]
) -> None:
    flight = flights[0]
    refuse(lambda: fits("path").track(), "whose rows must not count twice")
    refuse(lambda: fits("aero").smooth({"u": 1.0}), "the model 'aero' has no state to smooth")
    refuse(lambda: fits("path").add("Cm[alpha]"), "there is no effect 'Cm[alpha]'")
    refuse(lambda: fits("path").smooth({}), "no process noise is given", "ax, ay, az, p, q, r")
    refuse(lambda: sepcal.Aero("c172"), "a str is no aircraft", "sepcal.Aircraft(area=")
    refuse(lambda: sepcal.Aero(aircraft, "Cq"), "there is no coefficient 'Cq'")
    several: Any = ["Cm"]
    refuse(lambda: sepcal.Aero(aircraft, several), "['Cm'] is no coefficient; write Aero")
    refuse(lambda: sepcal.Aero(aircraft, equations={"Cm": "alpha"}), "give a list of regressors")
    refuse(lambda: sepcal.RigidAircraft(aircraft, "yaw"), "there are no axes 'yaw'")
    refuse(
        lambda: sepcal.fit(sepcal.Aero(aircraft), {"ax": [1.0]}),
        "flight: column 'time_s' is missing",
    )
    refuse(
        lambda: sepcal.fit(sepcal.FlightPath(position=True), flight),
        "a path with its position needs north_m, east_m and down_m, or lat_deg, lon_deg and",
    )
    refuse(lambda: sepcal.fit(sepcal.FlightPath(vane=(1, 0, 0)), flight), "give aircraft=...")
    light = sepcal.Aircraft(area=16.2, chord=1.49, span=10.9, mass=-1.0)
    refuse(lambda: sepcal.fit(sepcal.Aero(light, "CZ"), flight), "mass")
    loaded = pickle.loads(pickle.dumps(fits("path")))
    refuse(loaded.compare, "a loaded fit has no flight", "compare(sepcal.read(")


def test_headings_that_wrap_go_on(flights: list[sepcal.Flight]) -> None:
    """The same flight towards the south, its heading logged within half a turn."""
    columns = {name: np.array(flights[0][name]) for name in flights[0].columns}
    turned = columns["yaw_rad"] - columns["yaw_rad"].mean() + np.pi
    turned -= 2 * np.pi * np.round(turned[0] / (2 * np.pi))
    model = sepcal.FlightPath(outputs=["airspeed", "alpha", "beta", "roll", "pitch", "yaw"])
    fits = []
    for yaw in (turned, np.angle(np.exp(1j * turned))):
        fits.append(sepcal.fit(model, sepcal.Flight({**columns, "yaw_rad": yaw})))
    assert np.ptp(np.angle(np.exp(1j * turned))) > 6.0
    for one, other in zip(fits[0].parameters.values(), fits[1].parameters.values(), strict=True):
        assert other.value == pytest.approx(one.value, abs=1e-6 * (one.standard_error or 1.0))


def test_a_comparison_by_filter_error_says_when(
    aircraft: sepcal.Aircraft, flights: list[sepcal.Flight], tmp_path: Path
) -> None:
    """Of a flight whose log lacks an elevator pulse, from 20 to 20.6 s: by its pitching moment."""
    model = sepcal.RigidAircraft(aircraft, "longitudinal")
    held = {"u": 1e-4, "w": 0.003, "q": 0.01}
    columns = {name: np.array(flights[0][name])[:1251] for name in flights[0].columns}
    fit = sepcal.fit(model, sepcal.Flight(columns), method="filter-error", process_noise=held)
    time = columns["time_s"]
    columns["elevator_rad"] = columns["elevator_rad"].copy()
    columns["elevator_rad"][(time > 20) & (time < 20.6)] -= 0.03
    pulsed = sepcal.Flight(columns)
    found = fit.compare(pulsed)
    by_name = {one.noise.name: one for one in found.disturbances}
    assert by_name["q_q"].noise.value == pytest.approx(0.01)
    assert by_name["q_q"].rows > 15
    assert 19.95 < by_name["q_q"].first_s < 20.1
    assert 20.4 < by_name["q_q"].last_s < 20.65
    assert np.isnan(by_name["q_p"].share_beyond)  # a measured state's
    calm = fit.compare()
    assert max(one.rows for one in calm.disturbances) < 6
    measured = found.modelled + found.residuals
    alpha = [misfit.output for misfit in found.overall].index("alpha")
    assert measured[:, alpha] == pytest.approx(columns["alpha_rad"], abs=1e-12)
    assert found.to_dict()["disturbances"][4]["name"] == "q_q"
    assert found.to_dict()["innovation"]["q"]["sigma"] > calm.sigma["q"]
    text = str(found)
    assert "readings minus their predictions" in text
    assert f"{by_name['q_q'].first_s:.2f} to {by_name['q_q'].last_s:.2f} s" in text
    page = tmp_path / "report.html"
    sepcal.report([fit], str(page), pulsed)
    shown = page.read_text()
    assert f"{by_name['q_q'].first_s:.2f} to {by_name['q_q'].last_s:.2f} s" in shown
    assert "the filter foretold from the rows before" in shown


def test_filter_error_of_an_aircraft(
    aircraft: sepcal.Aircraft, flights: list[sepcal.Flight], fits: Fits, tmp_path: Path
) -> None:
    """Calm air: output error's numbers, and noises of measured states are none."""
    model = sepcal.RigidAircraft(aircraft, "longitudinal")
    fit = sepcal.fit(model, flights[0], method="filter-error")
    assert fit.status == "converged", fit.message
    sizes = fit.noise_sizes
    assert {name for name in sizes if sizes[name].value == 0} == {"q_v", "q_p", "q_r"}
    plain = fits("longitudinal")
    for name in ("CZ_alpha", "Cm_alpha", "Cm_q", "Cm_elevator"):
        off = fit[name].value - plain[name].value
        assert abs(off) < 0.5 * plain[name].standard_error_white
    assert -0.1 < 2 * (fit.log_likelihood - fit.log_likelihood_without) < 12
    fit.save(tmp_path / "fit.json")
    again = sepcal.load(tmp_path / "fit.json")
    assert again.noise_sizes["r_q"].value == pytest.approx(sizes["r_q"].value)
    assert again.method == "filter-error"
    assert "by filter-error" in str(fit)
    assert "2 ln L by -" not in str(fit)
    smoothed = fit.smooth()
    assert np.isfinite(smoothed["w"]).any()
    track = fit.track(flights[1], method="rml")
    place = track.names.index("Cm_q")
    off = track.estimates[-1, place] - fit["Cm_q"].value
    assert abs(off) < 4 * np.hypot(track.standard_deviations[-1, place], fit["Cm_q"].standard_error)


def test_noises_that_are_held_are_told_from_those_that_no_output_shows(
    aircraft: sepcal.Aircraft, flights: list[sepcal.Flight]
) -> None:
    fit = sepcal.fit(
        sepcal.RigidAircraft(aircraft, "longitudinal"),
        flights[0],
        method="filter-error",
        process_noise={"u": 0.0, "p": 0.01},
        iterations=2,
    )
    remarks = {line.split()[0]: line.split("  ")[-1] for line in str(fit).splitlines() if line}
    assert remarks["q_u"] == "held"
    assert remarks["q_p"] == "held"
    assert remarks["q_v"] == "shown by no output"
