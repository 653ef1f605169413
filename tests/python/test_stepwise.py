# SPDX-License-Identifier: BSD-3-Clause
"""diagnose --auto and auto=True: steps, promises, why it stops, files, exit codes, refusals."""

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import apps
import sepcal
from studies import moment_flights as aero

MAGNETOMETER = sepcal.Magnetometer(field=(19.7, -1.4, 49.4))
HIDDEN = {"bias[current_a]": 0.06, "scale[temp_degc]": 0.003}
FIELD = ("--field", "19.7,-1.4,49.4")


@pytest.fixture(scope="module")
def bent() -> sepcal.Calibration:
    """Two effects bend the field, and the fit knows neither."""
    flight = sepcal.simulate(MAGNETOMETER, rows=500, seed=3, hide=HIDDEN)
    return sepcal.fit(MAGNETOMETER, flight, samples=100)


@pytest.fixture(scope="module")
def stepped(bent: sepcal.Calibration) -> sepcal.Stepwise[sepcal.Calibration]:
    return bent.diagnose(auto=True)


@pytest.fixture(scope="module")
def moment() -> sepcal.AircraftFit:
    """Cm bends with alpha and elevator, which its equation lacks."""
    channels = aero.maneuver(7, 800)
    truth = {"1": 0.02, "alpha": -0.9, "elevator": -1.2, "alpha^2": -3.0, "alpha*elevator": 4.0}
    noise = 0.004 * np.random.default_rng(7).standard_normal(800)
    flight = aero.fly(channels, aero.pitching(channels, truth) + noise)
    model = sepcal.Aero(aero.AIRCRAFT, equations={"Cm": ["1", "alpha", "elevator"]})
    return sepcal.fit(model, flight)


def test_it_adds_what_is_hidden_and_stops(
    bent: sepcal.Calibration, stepped: sepcal.Stepwise[sepcal.Calibration]
):
    assert len(stepped.steps) == len(HIDDEN)
    assert "bias[current_a]" in stepped.effects
    assert any(name.endswith("scale[temp_degc]") for name in stepped.effects)
    assert stepped.end == "nothing_found"
    assert stepped.diagnosis.verdict == "adequate"
    assert [effect.name for effect in stepped.fitted.effects] == stepped.effects
    assert stepped.fitted.diagnose().verdict == "adequate"
    assert bent.effects == []


def test_a_step_says_what_would_do_as_well(
    bent: sepcal.Calibration, stepped: sepcal.Stepwise[sepcal.Calibration]
):
    """The first step's are the first diagnosis's; the page has them below it, the JSON too."""
    as_good = stepped.steps[0].as_good
    assert [bent.diagnose().effects[0].name, *as_good] == bent.diagnose().explanations
    assert [step["as_good"] for step in stepped.to_dict()["stepwise"]["steps"]] == [
        step.as_good for step in stepped.steps
    ]
    for step in stepped.steps:
        said = f"in its place {' or '.join(step.as_good)} would do as well"
        assert (said in stepped.text) == bool(step.as_good)


def test_steps_are_those_of_diagnose_and_add(
    bent: sepcal.Calibration, stepped: sepcal.Stepwise[sepcal.Calibration]
):
    now = bent
    for step in stepped.steps:
        told = now.diagnose()
        assert told.advice.effect == step.effect
        finding = told[step.effect]
        assert finding.predicted_drop == step.predicted_drop
        assert finding.partial_f == step.partial_f
        before = np.sqrt(np.mean([value**2 for value in now.rmse.values()]))
        now = now.add(step.effect)
        after = np.sqrt(np.mean([value**2 for value in now.rmse.values()]))
        assert_allclose([step.rmse_before, step.rmse_after], [before, after], rtol=1e-9)
        assert step.found_drop == pytest.approx(1 - after / before)
    assert np.array_equal(now.values, stepped.fitted.values)


def test_the_most(bent: sepcal.Calibration, stepped: sepcal.Stepwise[sepcal.Calibration]):
    one = bent.diagnose(auto=True, most=1)
    assert one.effects == stepped.effects[:1]
    assert one.end == "most_added"
    assert stepped.effects[1] in one.reason
    assert one.diagnosis.verdict == "effect_missing"


def test_candidates_of_ones_own_choice(bent: sepcal.Calibration):
    told = bent.diagnose(only=["bias[temp_degc]", "bias[current_a*temp_degc]"])
    assert {effect.name for effect in told.effects} >= {
        "bias[temp_degc]",
        "bias[current_a*temp_degc]",
    }
    with pytest.raises(sepcal.Error, match="no channel 'lift'"):
        bent.diagnose(only=["bias[lift]"])
    with pytest.raises(sepcal.Error, match="give a list of names"):
        bent.diagnose(only="bias[temp_degc]")


def test_where_nothing_is_missing_nothing_is_added():
    flight = sepcal.simulate(MAGNETOMETER, rows=300, seed=5)
    fit = sepcal.fit(MAGNETOMETER, flight, samples=100)
    found = fit.diagnose(auto=True)
    assert (found.steps, found.end) == ([], "nothing_found")
    assert np.array_equal(found.fitted.values, fit.values)
    assert "nothing added; stopped as nothing more passes" in str(found)


def test_pages(stepped: sepcal.Stepwise[sepcal.Calibration]):
    page = str(stepped)
    for step in stepped.steps:
        assert f"+ {step.effect}" in page
        assert f"{-100 * step.found_drop:+.1f} %" in page
    assert "2 effects added; stopped as nothing more passes" in page
    assert stepped.effects[0] in repr(stepped)
    assert stepped.to_dict()["stepwise"]["end"] == "nothing_found"
    assert "rmse_after" in stepped.to_frame().columns


def test_regressors_of_a_moment(moment: sepcal.AircraftFit):
    pool = ["alpha^2", "alpha^3", "alpha*elevator", "elevator^2", "q_hat", "throttle"]
    found = moment.diagnose(auto=True, only=[f"Cm[{name}]" for name in pool])
    assert set(found.effects) == {"Cm[alpha^2]", "Cm[alpha*elevator]"}
    assert found.end == "nothing_found"
    assert found.fitted["Cm_alpha^2"].value == pytest.approx(-3.0, abs=0.2)
    assert found.fitted.history[0].effect == found.effects[0]
    again = found.fitted.diagnose(only=["Cm[alpha^2]", "Cm[q_hat]"])
    assert [effect.name for effect in again.effects] == ["Cm[q_hat]"]


@pytest.mark.parametrize(
    ("choices", "why"),
    [
        ({"auto": True, "most": 0}, "most 0 lets nothing be added; give at least 1"),
        ({"auto": True, "most": -1}, "most -1 is negative"),
        ({"most": 2}, "most is of auto=True"),
        ({"auto": True, "inject": {"bias[current_a]": 1.0}}, "exclude each other"),
        ({"auto": True, "simulations": 1}, "simulations must be at least 2"),
    ],
)
def test_what_is_refused(bent: sepcal.Calibration, choices: dict[str, object], why: str):
    with pytest.raises(sepcal.Error, match=why):
        bent.diagnose(**choices)


def test_of_an_aircraft_only_equation_error(moment: sepcal.AircraftFit):
    with pytest.raises(sepcal.Error, match=r"effect CZ\[alpha\]: the model 'aero' has no CZ here"):
        moment.diagnose(only=["CZ[alpha]"])
    with pytest.raises(sepcal.Error, match="write it as COEFFICIENT"):
        moment.diagnose(only=["lift"])


# --- the programs


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """mag.csv and mag.json; flight.csv, path.json and aero.json."""
    folder = tmp_path_factory.mktemp("stepwise")

    def run(*words: str) -> None:
        done = apps.run(*words, folder=folder)
        assert done.code == 0, done.err

    hidden = [word for name, size in HIDDEN.items() for word in ("--hide", f"{name}={size}")]
    run("sepcal-mag", "simulate", "-o", "mag.csv", "--rows", "500", "--seed", "3", *hidden)
    run("sepcal-mag", "simulate", "-o", "other.csv", "--rows", "500", "--seed", "8", *hidden)
    run("sepcal-mag", "fit", "mag.csv", *FIELD, "--samples", "100", "-o", "mag.json")
    aircraft = ("--geometry", "aircraft.json")
    run(
        "sepcal-aircraft",
        "simulate",
        "-o",
        "flight.csv",
        *aircraft,
        "--hide",
        "Cm[alpha^2]=-3",
        "--seed",
        "2",
    )
    run("sepcal-aircraft", "fit", "flight.csv", "--model", "path", "-o", "path.json")
    only_m = ("--equation", "Cm=1,alpha,q_hat,elevator")
    run(
        *("sepcal-aircraft", "fit", "flight.csv", "--model", "aero", *aircraft, *only_m),
        *("-o", "aero.json"),
    )
    return folder


def test_the_fit_is_written_and_goes_on(folder: Path):
    done = apps.run(
        "sepcal-mag", "diagnose", "mag.csv", "mag.json", "--auto", "-o", "next.json", folder=folder
    )
    assert done.code == 0, done.err
    written = json.loads((folder / "next.json").read_text())
    steps = written["stepwise"]["steps"]
    assert [entry["effect"] for entry in written["history"]] == [step["effect"] for step in steps]
    compared = apps.run("sepcal-mag", "compare", "mag.csv", "next.json", folder=folder)
    assert compared.code == 0, compared.err


def test_another_flight_is_fitted_first(folder: Path):
    """A calibration is not praised for what another flight's fit brings."""
    other = sepcal.read_csv(folder / "other.csv")
    found = sepcal.load(folder / "mag.json").diagnose(other, auto=True, most=1)
    here = sepcal.fit(MAGNETOMETER, other, samples=100)
    before = np.sqrt(np.mean([value**2 for value in here.rmse.values()]))
    assert found.steps[0].rmse_before == pytest.approx(before, rel=1e-6)


def test_a_missing_effect_that_is_left_is_3(folder: Path):
    done = apps.run(
        *("sepcal-mag", "diagnose", "mag.csv", "mag.json", "--auto", "--most", "1", "--json"),
        folder=folder,
    )
    assert done.code == 3
    assert json.loads(done.out)["stepwise"]["end"] == "most_added"


def test_an_aircraft(folder: Path):
    told = apps.run("sepcal-aircraft", "diagnose", "flight.csv", "aero.json", folder=folder)
    assert told.code == 3, told.err
    assert "next: sepcal-aircraft add flight.csv aero.json 'Cm[" in told.out
    done = apps.run(
        *("sepcal-aircraft", "diagnose", "flight.csv", "aero.json", "--auto", "-o", "more.json"),
        folder=folder,
    )
    assert done.code in (0, 3, 6), done.err
    fitted = sepcal.load(folder / "more.json")
    assert fitted.history[0].effect.startswith("Cm[")


@pytest.mark.parametrize(
    ("app", "words", "why"),
    [
        ("sepcal-mag", "mag.csv mag.json --auto --most 0", "--most 0 lets nothing be added"),
        ("sepcal-mag", "mag.csv mag.json --auto --most -1", "--most must not be negative"),
        ("sepcal-mag", "mag.csv mag.json --most 2", "--most is of --auto"),
        ("sepcal-mag", "mag.csv mag.json --pse aic", "--pse 'aic' is unknown"),
        ("sepcal-mag", "mag.csv mag.json --only bias[lift]", "there is no channel 'lift'"),
        ("sepcal-mag", "mag.csv mag.json --auto --inject bias[time]=1", "exclude each other"),
        ("sepcal-aircraft", "flight.csv aero.json --auto --most 0", "--most 0 lets nothing"),
        (
            "sepcal-aircraft",
            "flight.csv path.json --only Cm[beta]",
            "there is no effect 'Cm[beta]'",
        ),
        ("sepcal-aircraft", "flight.csv aero.json --only CZ[alpha]", "has no CZ here; it has Cm"),
        ("sepcal-aircraft", "flight.csv aero.json -o aero.json", "aero.json"),
    ],
)
def test_bad_usage_is_one_line(folder: Path, app: str, words: str, why: str):
    done = apps.run(app, "diagnose", *words.split(), folder=folder)
    assert done.code == 2
    assert why in done.err
    notes = [line for line in done.err.splitlines() if not line.startswith("note: ")]
    assert len(notes) == 1
    assert done.out == ""
