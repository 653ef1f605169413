# SPDX-License-Identifier: BSD-3-Clause
"""Filter error of a recorded flight: NASA's F/A-18 HARV, whose answers SIDPAC publishes.

14 s at 50 Hz; the record isn't sepcal's to ship, and tests are skipped where it is absent.
"""

import numpy as np
import pytest

import sepcal
from cases import but_first_slow
from recorded import find_fixture

FOOT = 0.3048  # m
FREE = ("lambda_alpha", "lambda_theta", "b_ax", "b_az", "b_q")
FIXED = dict.fromkeys(("lambda_v", "b_theta", "b_ay", "b_p", "b_r"), 0.0)
# Of the accelerometers; rates p and r and the side are read, and shake nothing that is looked at.
UNIT = {"ax": 0.1, "az": 0.1, "ay": 0.0, "p": 0.0, "r": 0.0}
PUBLISHED = {  # SIDPAC, output error
    "b_ax": -0.16654 * FOOT,
    "b_az": -0.13388 * FOOT,
    "b_q": 0.0017840,
    "lambda_alpha": 0.076171,
    "lambda_theta": 0.038720,
}
INTERVAL = 0.02  # s


def path(inputs: str = "linear") -> sepcal.FlightPath:
    return sepcal.FlightPath(
        measured=["v", "phi", "psi"],
        outputs=["airspeed", "alpha", "pitch"],
        gravity=32.174 * FOOT,
        inputs=inputs,
    )


@pytest.fixture(scope="module")
def flight() -> sepcal.Flight:
    return sepcal.read_csv(find_fixture("harv_longitudinal.csv"))


def fit(flight: sepcal.Flight, inputs: str = "linear", **options: object) -> sepcal.Fit:
    asked = {"fix": FIXED, "process_noise": UNIT} | options
    found = sepcal.fit(path(inputs), flight, method="filter-error", **asked)
    assert found.status == "converged", found.message
    return found


@pytest.fixture(scope="module")
def whole(flight: sepcal.Flight) -> sepcal.Fit:
    return fit(flight)


def test_it_is_as_published(whole: sepcal.Fit) -> None:
    """Where the unit's noise is that of accelerometers, whatever its size."""
    for name, value in PUBLISHED.items():
        assert abs(whole[name].value - value) < 3 * whole[name].standard_error, name
    assert 2 * (whole.log_likelihood - whole.log_likelihood_without) > 1000
    for size in ("q_ax", "q_ay"):
        assert whole.noise_sizes[size].value == pytest.approx(UNIT[size[2:]])


@pytest.mark.parametrize("size", [0.05, 0.4])
def test_the_unit_may_be_eight_times_as_noisy(
    flight: sepcal.Flight, whole: sepcal.Fit, size: float
) -> None:
    other = fit(flight, process_noise=UNIT | {"ax": size, "az": size})
    for name in FREE:
        apart = abs(other[name].value - whole[name].value)
        assert apart < max(other[name].standard_error, whole[name].standard_error), name


def test_inputs_that_are_held_are_half_an_interval_late(flight: sepcal.Flight) -> None:
    """Which the unit's own lateness must make up for: the same but for that half."""
    late = {how: fit(flight, how, effects=["imu_late"]) for how in ("linear", "hold")}
    tau = {how: found["imu_late.tau"] for how, found in late.items()}
    assert tau["hold"].value - tau["linear"].value == pytest.approx(INTERVAL / 2, abs=1e-3)
    assert tau["linear"].value > 10 * tau["linear"].standard_error
    for name in FREE:
        apart = abs(late["hold"][name].value - late["linear"][name].value)
        assert apart < 0.2 * late["linear"][name].standard_error, name


def test_halves_agree_and_predict_each_other(flight: sepcal.Flight) -> None:
    halves = [{"to_time": 7.0}, {"from_time": 7.0}]
    fits = [fit(flight, effects=["imu_late"], **half) for half in halves]
    for name in (*FREE, "imu_late.tau"):
        one, other = (found[name] for found in fits)
        error = np.hypot(one.standard_error, other.standard_error)
        assert abs(one.value - other.value) < 3 * error, name
    for half, own, other in zip(halves, fits, reversed(fits), strict=True):
        known = {name: other[name].value for name in (*FREE, "imu_late.tau")}
        noise: dict[str, dict[str, float]] = {"q": {}, "r": {}}
        for size in other.noise_sizes.values():
            kind, name = size.name.split("_", 1)
            noise[kind][name] = size.value
        told = fit(
            flight,
            effects=["imu_late"],
            fix=FIXED | known,
            process_noise=noise["q"],
            noise=noise["r"],
            **half,
        )
        for output, rms in own.rmse.items():
            assert told.rmse[output] < 1.1 * rms, output


def test_the_units_lateness_is_named_and_keeps_its_promise(whole: sepcal.Fit) -> None:
    diagnosis = whole.diagnose(only=["imu_late", "vane_position", "gyro_bias[time]"])
    assert diagnosis.advice.effect == "imu_late"
    added = whole.add("imu_late")
    (step,) = added.history
    assert step.drop == pytest.approx(step.predicted_drop, abs=0.01)
    assert 2 * (added.log_likelihood - whole.log_likelihood) > 50
    assert added["b_q"].standard_error < 0.8 * whole["b_q"].standard_error


START = {"u_0": 313.0304 * FOOT, "w_0": 114.0908 * FOOT, "theta_0": 0.239107}  # the file's
LAGS = ("imu_late", "attitude_late")
ASKED = (*LAGS, "airdata_late", "alpha_late", "gyro_bias[time]", "wind[time]", "vane_position")


@pytest.mark.parametrize("inputs", ["linear", "hold"])
@pytest.mark.parametrize("start", but_first_slow(["free", "fixed"]))
@pytest.mark.parametrize("method", ["output-error", "filter-error"])
def test_a_lag_is_named_from_every_start(
    flight: sepcal.Flight, method: str, start: str, inputs: str
) -> None:
    """By either method, though the residual of output error drifts: 0.97 from row to row."""
    fix = FIXED | (START if start == "fixed" else {})
    fitted = sepcal.fit(path(inputs), flight, method=method, fix=fix)
    diagnosis = fitted.diagnose(only=ASKED)
    assert diagnosis.verdict == "effect_missing"
    assert diagnosis.advice.effect in LAGS
    told = {effect.name: effect for effect in diagnosis.effects}
    (other,) = set(LAGS) - {diagnosis.advice.effect}
    assert told[other].beside == "equivalent"
    assert "one lag that this flight can't place" in diagnosis.sentence
    late = [told[name].estimate[f"{name}.tau"] for name in LAGS]
    expected = 0.0135 + (INTERVAL / 2 if inputs == "hold" else 0.0)
    assert np.array([late[0], -late[1]]) == pytest.approx(expected, abs=0.0055)
