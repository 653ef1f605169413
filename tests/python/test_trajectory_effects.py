# SPDX-License-Identifier: BSD-3-Clause
"""Effects along trajectories: found, added, and the error falls as promised.

They are hidden by a simulator that knows nothing of the models.
"""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal
from cases import but_first_slow
from oracle import kinematic_flight

LIGHT = sepcal.Aircraft(
    area=16.2, chord=1.49, span=10.9, mass=1050.0, inertia=(1285.0, 1825.0, 2667.0, 60.0)
)
DRIFT = 4e-4  # rad/s per degC
CURVE = -4.0  # of Cm[alpha^2]
PROMISE = 0.05  # of the error


def fly(hide: Mapping[str, float | list[float]], seed: int = 1) -> sepcal.Flight:
    """40 s at 25 Hz as one segment."""
    flown = sepcal.simulate("aircraft", hide=hide, rate=25.0, seed=seed)
    return sepcal.Flight({name: flown[name] for name in flown.columns})


@pytest.fixture(scope="module")
def drifting() -> sepcal.Flight:
    return fly({"gyro_bias[imu_temp_degc]": DRIFT})


@pytest.fixture(scope="module")
def path(drifting: sepcal.Flight) -> sepcal.AircraftFit:
    return sepcal.fit(sepcal.FlightPath(), drifting)


@pytest.fixture(scope="module")
def corrected(path: sepcal.AircraftFit) -> sepcal.AircraftFit:
    return path.add("gyro_bias[imu_temp_degc]")


@pytest.mark.slow
def test_a_drifting_gyro_is_named(path: sepcal.AircraftFit) -> None:
    diagnosis = path.diagnose()
    assert diagnosis.verdict == "effect_missing"
    assert diagnosis.effects[0].name == "gyro_bias[imu_temp_degc]"
    assert diagnosis.advice.effect == "gyro_bias[imu_temp_degc]"
    assert diagnosis.effects[0].sentence == "the gyros' bias changes with imu_temp_degc"


@pytest.mark.slow
def test_a_wind_comes_before_a_bias_that_takes_half_of_what_it_takes() -> None:
    """Both take little of the error: what one coefficient leaves is then about as little."""
    size = 10.0
    flight = fly({"wind[time]": [size * 6.5e-4, size * 1.2e-3, size * 1.1e-3]}, seed=2)
    diagnosis = sepcal.fit(sepcal.FlightPath(), flight).diagnose()
    own = next(effect for effect in diagnosis.effects if effect.name == "wind[time]")
    bias = next(effect for effect in diagnosis.effects if effect.name == "alpha_bias[time]")
    assert own.predicted_drop > 2.0 * bias.predicted_drop
    assert own is diagnosis.effects[0] or own.beside == "equivalent"


def test_the_error_falls_as_promised(corrected: sepcal.AircraftFit) -> None:
    added = corrected.history[-1]
    assert added.predicted_drop == pytest.approx(added.drop, abs=PROMISE)
    ratios = [added.rmse_after[name] / added.rmse_before[name] for name in added.rmse_after]
    assert added.drop == pytest.approx(1 - np.sqrt(np.mean(np.square(ratios))))
    assert added.drop > 0.2
    for axis in "xyz":  # true = reading + s x, and the simulator adds to the reading
        slope = corrected[f"gyro_bias[imu_temp_degc].{axis}"]
        assert abs(slope.value + DRIFT) < 4 * slope.standard_error


def test_a_fit_with_effects_is_itself_again_from_disc(
    corrected: sepcal.AircraftFit, drifting: sepcal.Flight, tmp_path: Path
) -> None:
    corrected.save(tmp_path / "fit.json")
    again = sepcal.load(tmp_path / "fit.json")
    assert again.compare(drifting).text == corrected.compare(drifting).text
    applied = again.apply(drifting)
    drift = -np.mean([corrected[f"gyro_bias[imu_temp_degc].{axis}"].value for axis in "xyz"]) * (
        drifting["imu_temp_degc"] - drifting["imu_temp_degc"].mean()
    )
    left = applied["q_cal_radps"] - drifting["q_radps"]
    assert np.corrcoef(left, -drift)[0, 1] > 0.999  # what is corrected is that drift


def test_smoothed_with_effects(corrected: sepcal.AircraftFit) -> None:
    smoothed = corrected.smooth(process_noise={"q": 4e-4, "az": 0.01})
    assert np.isfinite(smoothed.x).all()


def test_a_missing_regressor_is_named_and_keeps_its_promise() -> None:
    fit = sepcal.fit(sepcal.RigidAircraft(LIGHT, "longitudinal"), fly({"Cm[alpha^2]": CURVE}))
    diagnosis = fit.diagnose()
    assert diagnosis.effects[0].name == "Cm[alpha^2]"
    assert diagnosis.advice.effect == "Cm[alpha^2]"
    added = fit.add("Cm[alpha^2]")
    assert added["Cm_alpha^2"].value == pytest.approx(CURVE, rel=0.1)
    assert added.history[-1].predicted_drop == pytest.approx(added.history[-1].drop, abs=PROMISE)


def test_a_spline_of_the_state_bends_as_the_moment_does(tmp_path: Path) -> None:
    interpolate = pytest.importorskip("scipy.interpolate")
    flight = fly({"Cm[alpha^2]": CURVE / 2})
    fit = sepcal.fit(sepcal.RigidAircraft(LIGHT, "longitudinal"), flight)
    diagnosis = fit.diagnose(only=["Cm[spline(alpha,5)]"])
    assert diagnosis.advice.effect == "Cm[spline(alpha,5)]"
    added = fit.add("Cm[spline(alpha,5)]")
    step = added.history[-1]
    assert step.predicted_drop == pytest.approx(step.drop, abs=PROMISE)
    heights = [0.0, *(added[f"Cm[spline(alpha,5)].s_{j}"].value for j in (2, 3, 4)), 0.0]
    knots = np.linspace(flight["alpha_rad"].min(), flight["alpha_rad"].max(), 5)
    alpha = np.linspace(*np.quantile(flight["alpha_rad"], [0.02, 0.98]), 50)
    curve = interpolate.CubicSpline(knots, heights, bc_type="natural")(alpha)
    bend = curve - np.polyval(np.polyfit(alpha, curve, 1), alpha)
    truth = CURVE / 2 * alpha**2
    truth -= np.polyval(np.polyfit(alpha, truth, 1), alpha)
    assert np.abs(bend - truth).max() < 0.25 * np.ptp(truth)  # a natural spline ends straight
    added.save(tmp_path / "fit.json")
    assert sepcal.load(tmp_path / "fit.json").compare(flight).text == added.compare(flight).text


def test_a_spline_of_a_coefficient_that_the_model_has_not() -> None:
    fit = sepcal.fit(sepcal.RigidAircraft(LIGHT, "longitudinal"), fly({}))
    with pytest.raises(sepcal.Error, match="has no Cl here; it has CX, CZ, Cm"):
        fit.add("Cl[spline(beta,5)]")
    with pytest.raises(sepcal.Error, match="no column 'p_hat' whose range"):
        fit.add("Cm[spline(p_hat,5)]")


@pytest.mark.parametrize("seed", but_first_slow(range(3)))
def test_nothing_is_named_where_nothing_is_hidden(seed: int) -> None:
    verdict = sepcal.fit(sepcal.FlightPath(), fly({}, seed=100 + seed)).diagnose().verdict
    assert verdict == "adequate"


def test_one_candidate_of_ones_own(path: sepcal.AircraftFit) -> None:
    diagnosis = path.diagnose(only=["imu_late"])
    assert [effect.name for effect in diagnosis.effects] == ["imu_late"]


def test_a_late_unit_has_its_time() -> None:
    late = 0.03  # s
    fit = sepcal.fit(sepcal.FlightPath(), fly({"imu_late": late}, seed=3))
    tau = fit.add("imu_late")["imu_late.tau"]
    assert_allclose(tau.value, late, atol=4 * tau.standard_error)


@pytest.mark.parametrize(
    ("model", "hidden", "effect"),
    but_first_slow(
        [
            ("path", "airdata_late", "airdata_late"),
            ("path", "attitude_late", "attitude_late"),
            ("path", "velocity_late", "velocity_late"),
            ("path", "alpha_lag", "alpha_late"),
            ("longitudinal", "attitude_late", "attitude_late"),
            ("longitudinal", "alpha_lag", "alpha_late"),
        ]
    ),
)
def test_a_group_of_sensors_that_is_late_is_named(model: str, hidden: str, effect: str) -> None:
    late = 0.06  # s
    kind = sepcal.FlightPath() if model == "path" else sepcal.RigidAircraft(LIGHT, model)
    fit = sepcal.fit(kind, fly({hidden: late}, seed=1))
    assert fit.diagnose().advice.effect == effect
    added = fit.add(effect)
    assert_allclose(added[f"{effect}.tau"].value, late, atol=0.15 * late)
    assert added.history[-1].predicted_drop == pytest.approx(added.history[-1].drop, abs=PROMISE)


@pytest.mark.parametrize(
    ("effect", "words"),
    [
        ("foo", "there is no effect 'foo'; known: gyro_bias"),
        ("gyro_bais[time]", "'gyro_bais[time]'; did you mean 'gyro_bias[time]'? Known: "),
        ("gyro_bias[no_such]", "no channel 'no_such'"),
        ("gyro_bias[alpha]", "'alpha' is what is measured"),
    ],
)
def test_what_a_path_can_not_have_is_refused(
    path: sepcal.AircraftFit, effect: str, words: str
) -> None:
    with pytest.raises(sepcal.Error, match=re.escape(words)):
        path.add(effect)


def test_what_is_tracked_has_no_effects(
    corrected: sepcal.AircraftFit, drifting: sepcal.Flight
) -> None:
    with pytest.raises(sepcal.Error, match="track takes no effects along a trajectory"):
        corrected.track(drifting, method="ekf", start_rows=200)


class RollMode:
    """An aircraft that does nothing but roll."""

    inputs: ClassVar = {"aileron": "rad"}
    states: ClassVar = {"p": "rad/s"}
    outputs: ClassVar = {"p_m": "rad/s"}
    linear: ClassVar = {"b_p": "rad/s"}
    nonlinear: ClassVar = {"Lp": ("1/s", -20, 0), "La": "1/s^2"}
    noise: ClassVar = {"p": "rad/s/sqrt(s)"}

    def rate(self, x, u, p):  # type: ignore[no-untyped-def]
        """The roll acceleration."""
        Lp, La = p
        return [Lp * x[0] + La * u.aileron]

    def at(self, x, u, p):  # type: ignore[no-untyped-def]
        """What is read: A and b."""
        return [[1.0]], [x[0]]


@pytest.mark.parametrize("method", ["output-error", "filter-error"])
def test_an_own_model_takes_effects_on_its_inputs(method: str) -> None:
    rows, step, slope = 400, 0.02, 0.004
    time = step * np.arange(rows)
    aileron = 0.1 * np.sign(np.sin(2 * time)) + 0.05 * np.sin(5 * time)
    temperature = 20 + 3 * np.sin(0.7 * time) + time
    true = aileron + slope * (temperature - temperature.mean())
    p = np.zeros(rows)
    decay, grown = np.exp(-2.5 * step), (1 - np.exp(-2.5 * step)) / 2.5
    for k in range(rows - 1):  # exact, of an input that is a line between rows
        rise = (true[k + 1] - true[k]) / step
        p[k + 1] = decay * p[k] + 12 * (grown * true[k] + rise * (step - grown) / 2.5)
    noise = 0.01 * np.random.default_rng(1).standard_normal(rows)
    record = {"time": time, "aileron": aileron, "temp_degc": temperature, "p_m": p + 0.02 + noise}
    fit = sepcal.fit(
        RollMode(),
        record,
        effects=["aileron[temp_degc]"],
        start={"Lp": -2.0, "La": 10.0},
        method=method,
    )
    found = fit["aileron[temp_degc].s"]
    assert abs(found.value - slope) < 4 * found.standard_error < slope
    assert fit.rmse["p_m"] == pytest.approx(0.01, rel=0.15)


@pytest.mark.slow
def test_what_a_path_has_bent_to_is_found_from_its_own_fit() -> None:
    """lambda_beta takes the drift for its own, and from there one step sees nothing of it."""
    flown = kinematic_flight.fly(3, gyro_drift=[8e-5, -16e-5, 12e-5])
    fit = sepcal.fit(sepcal.FlightPath(), sepcal.Flight(flown))
    diagnosis = fit.diagnose()
    assert diagnosis.verdict == "effect_missing"
    assert diagnosis.advice.effect == "gyro_bias[time]"
    added = fit.add("gyro_bias[time]")
    assert added.history[-1].drop > 0.6
    assert diagnosis.effects[0].predicted_drop == pytest.approx(added.history[-1].drop, abs=0.02)
    assert not [note for note in added.notes if "would not advise" in note]
    for axis, drift in zip("xyz", [8e-5, -16e-5, 12e-5], strict=True):
        slope = added[f"gyro_bias[time].{axis}"]
        assert abs(slope.value + drift) < 4 * slope.standard_error


@pytest.mark.slow
def test_a_curve_that_holds_the_line_does_not_speak_against_it() -> None:
    flown = kinematic_flight.fly(1, rate=20.0, gyro_drift=[4e-5, -8e-5, 6e-5])
    diagnosis = sepcal.fit(sepcal.FlightPath(), sepcal.Flight(flown)).diagnose()
    # The unit warms steadily: its temperature would do as well.
    assert diagnosis.advice.effect in ("gyro_bias[time]", "gyro_bias[imu_temp_degc]")


@pytest.mark.slow
def test_filter_error_promises_what_it_keeps() -> None:
    """Its noises are found anew beside the effect: one step in the old ones can't foretell them."""
    flown = kinematic_flight.fly(6, duration=30.0, rate=25.0, late=0.08)
    fit = sepcal.fit(sepcal.FlightPath(), sepcal.Flight(flown), method="filter-error")
    diagnosis = fit.diagnose()
    assert diagnosis.advice.effect == "imu_late"
    added = fit.add("imu_late")
    assert added.history[-1].drop > 0.05
    assert diagnosis.effects[0].predicted_drop == pytest.approx(added.history[-1].drop, abs=0.01)


def test_no_state_made_of_a_reading_is_seen_to_follow_its_noise() -> None:
    flown = kinematic_flight.fly(21, duration=30.0, rate=25.0)
    fit = sepcal.fit(sepcal.FlightPath(), sepcal.Flight(flown), method="filter-error")
    channels = fit.compare().channels
    share = {(one.driver, one.output): one.share_smooth for one in channels}
    made_of = {"theta": "pitch", "phi": "roll", "psi": "yaw", "u": "airspeed", "w": "alpha"}
    for state, output in made_of.items():
        assert share[state, output] < 0.02, state
    assert {one.unit for one in channels if one.driver == "w"} >= {"rad per m/s"}


@pytest.mark.parametrize("header", ["temp_degc", "imu_temp_degc", "gyro_t_degc"])
def test_a_temperature_is_taken_about_its_mean_whatever_it_is_called(header: str) -> None:
    """A scale that is right at the mean is none that is right at zero degrees."""
    flown = kinematic_flight.fly(4, duration=30.0, rate=25.0)
    warmth = flown.pop("imu_temp_degc")
    for rate in ("p_radps", "q_radps", "r_radps"):
        flown[rate] = flown[rate] * (1.0 + 0.02 * (warmth - warmth.mean()))
    flown[header] = warmth
    fit = sepcal.fit(sepcal.FlightPath(), sepcal.Flight(flown))
    added = fit.add(f"gyro_scale[{header}]")
    assert abs(added[f"gyro_scale[{header}].x"].value + 0.02) < 0.004
    assert added.history[-1].drop > 0.02


def test_a_bend_is_seen_close_about_the_trim() -> None:
    """Alpha's square lies within 0.05 of what the aircraft has, and is told all the same."""
    flown = sepcal.simulate(
        "aircraft", hide={"Cm[alpha^2]": -6.0}, rate=25.0, seed=3,
    )  # fmt: skip
    fit = sepcal.fit(
        sepcal.RigidAircraft(LIGHT, "longitudinal"),
        sepcal.Flight({name: flown[name] for name in flown.columns}),
    )
    asked = fit.diagnose(only=["Cm[alpha^2]"]).effects[0]
    assert asked.status == "found"
    assert asked.visibility > 0.01


@pytest.mark.slow
def test_each_step_of_a_course_falls_as_its_history_says() -> None:
    flown = kinematic_flight.fly(6, duration=30.0, rate=25.0, late=0.08)
    fit = sepcal.fit(sepcal.FlightPath(), sepcal.Flight(flown))
    course = fit.diagnose(auto=True, most=1)
    (step,) = course.steps
    assert step.effect == "imu_late"
    drop = course.fitted.history[-1].drop
    assert step.found_drop == pytest.approx(drop, abs=1e-9)
    assert step.predicted_drop == pytest.approx(drop, abs=0.02)


def test_a_scale_about_the_start_is_not_followed() -> None:
    flown = kinematic_flight.fly(6, duration=20.0, rate=10.0)
    model = sepcal.FlightPath(scales_about_start=True)
    fit = sepcal.fit(model, sepcal.Flight(flown))
    with pytest.raises(sepcal.Error, match="fit without --scale-about-start"):
        fit.diagnose()
