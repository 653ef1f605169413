# SPDX-License-Identifier: BSD-3-Clause
"""Filter error from Python: the likelihood beside statsmodels', models of one's own, refusals."""

from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm

import sepcal
from own_state_models import ShortPeriod
from refusals import refuse
from stirred_flights import READS, SIZES, TRUTH, fly

LOG = fly(11)


@pytest.fixture(scope="module")
def fit() -> sepcal.Fit:
    return sepcal.fit(sepcal.ShortPeriod(), LOG, method="filter-error")


def test_it_finds_what_was_flown(fit: sepcal.Fit) -> None:
    assert fit.status == "converged", fit.message
    assert fit.method == "filter-error"
    for name, true in TRUTH.items():
        assert abs(fit[name].value - true) < 4 * fit[name].standard_error
    assert list(fit.noise_sizes) == list(SIZES)
    for size in fit.noise_sizes.values():
        assert abs(np.log(size.value / SIZES[size.name])) < 4 * size.standard_error / size.value
    assert 2 * (fit.log_likelihood - fit.log_likelihood_without) > 100


def test_the_likelihood_is_a_kalman_filters(fit: sepcal.Fit) -> None:
    """Of the exact discrete system at the fit's parameters; Runge and Kutta's is near it."""
    at = {name: fit[name].value for name in fit.names}
    sizes = {size.name: size.value for size in fit.noise_sizes.values()}
    F = np.array([[at["Za"], 1.0], [at["Ma"], at["Mq"]]])
    block = np.zeros((4, 4))
    block[:2, :2], block[:2, 2], block[2, 3] = F, [at["Zd"], at["Md"]], 1.0
    step = expm(0.02 * block)
    density = np.diag([sizes["q_alpha"] ** 2, sizes["q_q"] ** 2])
    van_loan = expm(0.02 * np.block([[-F, density], [np.zeros((2, 2)), F.T]]))
    Q = van_loan[2:, 2:].T @ van_loan[:2, 2:]
    H = np.array([[1, 0], [0, 1], [25 * at["Za"], 0]])
    R = np.diag([sizes[f"r_{name}"] ** 2 for name in ("alpha_m", "q_m", "az_m")])
    y = np.stack([LOG["alpha_m"], LOG["q_m"], LOG["az_m"]], axis=1)
    x, P, total = np.array([at["alpha_0"], at["q_0"]]), np.zeros((2, 2)), 0.0
    u = LOG["elevator"]
    for k in range(len(u)):
        expected = H @ x + [at["b_alpha"], at["b_q"], at["b_az"] + 25 * at["Zd"] * u[k]]
        e, S = y[k] - expected, H @ P @ H.T + R
        total -= 0.5 * (e @ np.linalg.solve(S, e) + np.log(np.linalg.det(2 * np.pi * S)))
        K = P @ H.T @ np.linalg.inv(S)
        x, P = x + K @ e, (np.eye(2) - K @ H) @ P
        if k + 1 < len(u):
            x = (step @ [*x, u[k], (u[k + 1] - u[k]) / 0.02])[:2]
            P = step[:2, :2] @ P @ step[:2, :2].T + Q
    assert fit.log_likelihood == pytest.approx(total, abs=2e-3)


@pytest.mark.slow
def test_a_model_of_ones_own_is_the_same(fit: sepcal.Fit) -> None:
    """Its derivatives are differences of differences."""
    short = {name: values[:250] for name, values in LOG.items()}
    ours = sepcal.fit(sepcal.ShortPeriod(), short, method="filter-error")
    own = sepcal.fit(ShortPeriod(), short, method="filter-error")
    for name in ours.names:
        off = abs(own[name].value - ours[name].value) / ours[name].standard_error_white
        assert off < 1e-3
        assert own[name].standard_error_white == pytest.approx(
            ours[name].standard_error_white, rel=1e-4
        )
    assert own.log_likelihood == pytest.approx(ours.log_likelihood, abs=1e-6)


def test_manoeuvres_merged_are_one_record_of_segments() -> None:
    """On threads, on processes, and as one fit of a log with three labels."""
    flights = {
        label: {name: values[: 300 + 50 * k] for name, values in fly(20 + k).items()}
        for k, label in enumerate(("climb", "cruise", "descent"))
    }
    options = {"own": ["alpha_0", "q_0"], "method": "filter-error"}
    many = sepcal.fit_many(sepcal.ShortPeriod(), flights, **options)
    assert many.status == "converged", many.message
    assert many.method == "filter-error"
    log = {
        name: np.concatenate([flight[name] for flight in flights.values()])
        for name in flights["climb"]
    }
    rows = [len(flight["time"]) for flight in flights.values()]
    log["time"] += 100.0 * np.repeat(np.arange(3), rows)
    log["maneuver"] = np.repeat(list(flights), rows)
    one = sepcal.fit(sepcal.ShortPeriod(), log, method="filter-error")
    assert many.log_likelihood == pytest.approx(one.log_likelihood, abs=1e-6)
    for name, shared in many.shared.items():
        assert abs(shared.value - one[name].value) < 1e-6 * one[name].standard_error
        assert shared.standard_error_white == pytest.approx(
            one[name].standard_error_white, rel=1e-6
        )
    for label, flight in many.flights.items():
        for start in ("alpha_0", "q_0"):
            expected = one[f"{start}[{label}]"]
            assert abs(flight[start].value - expected.value) < 1e-6 * expected.standard_error
    for name, size in many.noise_sizes.items():
        assert size.value == pytest.approx(one.noise_sizes[name].value, rel=1e-6)
    assert "q_q" in str(many)
    elsewhere = sepcal.fit_many(
        sepcal.ShortPeriod(), flights, **options, executor=ProcessPoolExecutor
    )
    assert [p.value for p in elsewhere.shared.values()] == [p.value for p in many.shared.values()]


def test_a_short_flight_of_many_can_be_left_out() -> None:
    flights = {"whole": LOG, "short": {name: values[:3] for name, values in LOG.items()}}
    options = {"own": ["alpha_0", "q_0"], "method": "filter-error"}
    refuse(
        lambda: sepcal.fit_many(sepcal.ShortPeriod(), flights, **options), "flight 'short'", "leave"
    )
    many = sepcal.fit_many(sepcal.ShortPeriod(), flights, **options, leave_out=True)
    assert list(many.left_out) == ["short"]
    assert many.status == "converged", many.message


def test_what_is_given_is_held() -> None:
    held = sepcal.fit(
        sepcal.ShortPeriod(),
        LOG,
        method="filter-error",
        process_noise={"q": 0.09},
        fix={"Za": -4.0},
    )
    size = held.noise_sizes["q_q"]
    assert size.value == pytest.approx(0.09)
    assert np.isnan(size.standard_error)
    assert held["Za"].fixed


def test_missing_readings_are_left_out(fit: sepcal.Fit) -> None:
    gaps = {name: values.copy() for name, values in LOG.items()}
    gaps["alpha_m"][200:400:2] = np.nan
    found = sepcal.fit(sepcal.ShortPeriod(), gaps, method="filter-error")
    assert found.status == "converged", found.message
    for name in TRUTH:
        assert abs(found.parameters[name].value - fit[name].value) < 2 * fit[name].standard_error


def test_an_unstable_aircraft_is_fitted() -> None:
    """Its trajectory can't be integrated: it starts from samples, and ends where flights do."""
    rng = np.random.default_rng(4)
    F = np.array([[-1.0, 1.0], [6.0, -1.5]])  # a pole at +1.2 1/s
    rows, step = 1500, 0.02
    x, u, columns = np.zeros(2), 0.0, []
    for k in range(rows):
        columns.append([u, *x])
        u = (
            0.3 * x[0]
            + 0.25 * x[1]
            + 0.03 * np.sign(np.sin(0.7 * k * step) + np.sin(2.2 * k * step))
        )
        for _ in range(10):
            kick = np.sqrt(step / 10) * rng.standard_normal(2) * [0.002, 0.05]
            x = x + step / 10 * (F @ x + np.array([-0.1, -20.0]) * u) + kick
    flown = np.array(columns)
    log = {"time": step * np.arange(rows), "elevator": flown[:, 0], "airspeed": np.full(rows, 25.0)}
    log["alpha_m"] = flown[:, 1] + 0.003 * rng.standard_normal(rows)
    log["q_m"] = flown[:, 2] + 0.005 * rng.standard_normal(rows)
    log["az_m"] = 25 * (-1.0 * flown[:, 1] - 0.1 * flown[:, 0]) + 0.1 * rng.standard_normal(rows)
    found = sepcal.fit(
        sepcal.ShortPeriod(inputs="hold"),
        log,
        method="filter-error",
        samples=100,
        bounds={"Ma": (-50, 20)},
    )
    assert found.status == "converged", found.message
    for name, true in {"Za": -1.0, "Ma": 6.0, "Mq": -1.5, "Md": -20.0}.items():
        assert (
            abs(found.parameters[name].value - true) < 4 * found.parameters[name].standard_error
        ), name


def test_profiles_are_near_the_gaussian(fit: sepcal.Fit) -> None:
    found = sepcal.profile_intervals(
        sepcal.ShortPeriod(), LOG, fit, names=["Za", "Mq"], method="filter-error"
    )
    for name in ("Za", "Mq"):
        gaussian, profile = (
            np.array(found.parameters[name].gaussian),
            np.array(found.parameters[name].profile),
        )
        assert found.parameters[name].ends == ("crossed", "crossed")
        assert_allclose(profile, gaussian, rtol=0, atol=0.1 * np.ptp(gaussian))
    # Where the profile ends the others' best is as much less likely as it says.
    held = sepcal.fit(
        sepcal.ShortPeriod(),
        LOG,
        method="filter-error",
        fix={"Mq": float(found.parameters["Mq"].profile[1])},
    )
    stretch = fit["Mq"].standard_error / fit["Mq"].standard_error_white
    rise = 2 * (fit.log_likelihood - held.log_likelihood)
    assert rise == pytest.approx((1.959964 * stretch) ** 2, rel=2e-3)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"loss": "huber"}, "filter error takes squares alone"),
        (
            {"method": "maximum"},
            "method 'maximum' is unknown; known: 'output-error', 'filter-error'",
        ),
        ({"process_noise": {"r": 0.1}}, "no process noise 'r'"),
    ],
)
def test_refusals(options: dict, message: str) -> None:
    asked = {"method": "filter-error"} | options
    refuse(lambda: sepcal.fit(sepcal.ShortPeriod(), LOG, **asked), message)


def test_a_model_without_a_state_is_refused() -> None:
    data = {"eta": np.linspace(0, 1, 50), "z": np.ones(50)}
    refuse(
        lambda: sepcal.fit(sepcal.ScalarExample1(), data, method="filter-error"),
        "filter error needs a model with a state",
    )


def changed(column: str, values: np.ndarray | float) -> dict[str, np.ndarray]:
    return LOG | {column: np.broadcast_to(values, LOG[column].shape).copy()}


def test_a_slow_sensor_is_no_noiseless_one() -> None:
    """Read in every third row, so that no two of its readings are neighbours."""
    rows = np.arange(len(LOG["time"]))
    slow = changed("alpha_m", np.where(rows % 3 == 0, LOG["alpha_m"], np.nan))
    found = sepcal.fit(sepcal.ShortPeriod(), slow, method="filter-error")
    assert found.status == "converged", found.message
    for name, true in TRUTH.items():
        assert abs(found[name].value - true) < 4 * found[name].standard_error
    size = found.noise_sizes["r_alpha_m"]
    assert abs(size.value - SIZES["r_alpha_m"]) < 4 * size.standard_error


def test_ten_rows_say_that_they_are_few() -> None:
    few = {name: values[60:70] for name, values in LOG.items()}
    found = sepcal.fit(sepcal.ShortPeriod(), few, method="filter-error")
    assert found.status == "not_identifiable"
    assert "not determined" in found.message
    assert "10 rows hardly tell noise of the states from the outputs'" in found.message
    assert np.isnan([parameter.standard_error for parameter in found.parameters.values()]).all()


def test_a_channel_that_never_changes_is_named() -> None:
    found = sepcal.fit(sepcal.ShortPeriod(), changed("alpha_m", 0.02), method="filter-error")
    assert "alpha_m reads the same in every row" in found.message


def test_readings_without_noise_end_at_their_resolution() -> None:
    found = sepcal.fit(
        sepcal.ShortPeriod(), fly(5, reads=dict.fromkeys(READS, 0.0)), method="filter-error"
    )
    assert found.status == "converged", found.message
    assert "r_alpha_m (" in found.message
    assert "there is none in the readings" in found.message
    assert all(found.noise_sizes[f"r_{name}"].at_floor for name in READS)
    # The states are as good as read: differences over a row tell their noise to 1 / sqrt(2 N).
    for name in ("q_alpha", "q_q"):
        size = found.noise_sizes[name]
        assert size.standard_error / size.value == pytest.approx(1 / np.sqrt(2000), rel=0.1)
        assert abs(size.value - SIZES[name]) < 4 * size.standard_error


def test_calm_air_ends_at_the_floor() -> None:
    """And there it is output error: estimates, sizes and likelihood."""
    calm = fly(6, noises={"alpha": 1e-9, "q": 1e-9})
    found = sepcal.fit(sepcal.ShortPeriod(), calm, method="filter-error", process_noise={"q": 0.0})
    assert found.status == "converged", found.message
    assert found.noise_sizes["q_alpha"].at_floor
    assert "the record shows no process noise 'alpha'" in found.message
    plain = sepcal.fit(sepcal.ShortPeriod(), calm, coloured_errors=False)
    for name in plain.names:
        assert abs(found[name].value - plain[name].value) < 1e-2 * plain[name].standard_error
    assert found.log_likelihood == pytest.approx(found.log_likelihood_without, abs=1e-2)


@pytest.mark.parametrize(
    ("log", "words"),
    [
        ({name: values[:3] for name, values in LOG.items()}, "9 readings, fewer than the 10"),
        (changed("alpha_m", np.nan), "output 'alpha_m' has no reading; leave it out"),
        (
            changed("alpha_m", np.where(np.arange(1000) == 30, np.inf, LOG["alpha_m"])),
            "column 'alpha_m' is infinite in row 30",
        ),
    ],
)
def test_records_that_are_none(log: dict[str, np.ndarray], words: str) -> None:
    refuse(lambda: sepcal.fit(sepcal.ShortPeriod(), log, method="filter-error"), words)


def van_loan(interval: float) -> tuple[np.ndarray, np.ndarray]:
    """Transition and covariance of the true short period's noise over an interval [s]."""
    F = np.array([[TRUTH["Za"], 1.0], [TRUTH["Ma"], TRUTH["Mq"]]])
    density = np.diag(np.square([SIZES["q_alpha"], SIZES["q_q"]]))
    both = expm(interval * np.block([[-F, density], [np.zeros((2, 2)), F.T]]))
    return both[2:, 2:].T, both[2:, 2:].T @ both[:2, 2:]


def spread_of_outputs(rows: int) -> np.ndarray:
    """(rows, 3): standard deviation that the true process noise brings to each output."""
    Phi, Q = van_loan(0.02)
    H = np.array([[1, 0], [0, 1], [25 * TRUTH["Za"], 0]])
    P, spread = np.zeros((2, 2)), []
    for _ in range(rows):
        spread.append(np.sqrt(np.diag(H @ P @ H.T)))
        P = Phi @ P @ Phi.T + Q
    return np.array(spread)


def test_a_prediction_has_the_gathered_process_noise() -> None:
    """At the truth, everything held: bands are those of the exact discrete system."""
    held = TRUTH | {"b_alpha": 0.02, "b_q": -0.01, "b_az": 0.5, "alpha_0": 0.0}
    options = {
        "method": "filter-error",
        "fix": held,
        "process_noise": {"alpha": SIZES["q_alpha"], "q": SIZES["q_q"]},
        "noise": READS,
    }
    fitted = sepcal.fit(sepcal.ShortPeriod(), LOG, **options)
    bands = sepcal.predict(sepcal.ShortPeriod(), LOG, fitted, **options)
    found = np.sqrt(
        np.square(bands.measurement_error)
        - np.square(bands.standard_error)
        - np.square(list(READS.values()))
    )
    expected = spread_of_outputs(1000)
    assert_allclose(found[1:], expected[1:], rtol=5e-3)
    assert expected[-1, 1] > 2 * READS["q_m"]  # it is no small part
    log = np.stack([LOG[name] for name in READS], axis=1)
    inside = np.abs(log - bands.value) < bands.quantile * bands.measurement_error
    assert 0.9 < inside.mean() < 0.99


DESIGN = {name: LOG[name] for name in ("time", "elevator", "airspeed")}
FLOWN = TRUTH | {"b_alpha": 0.02, "b_q": -0.01, "b_az": 0.5, "alpha_0": 0.0, "q_0": 0.0}
STIRRED = {"alpha": SIZES["q_alpha"], "q": SIZES["q_q"]}


def test_trials_draw_process_noise() -> None:
    """Their spread over 400 draws is the exact discrete system's."""
    trial = sepcal.DesignTrial(sepcal.ShortPeriod(), DESIGN, FLOWN, READS, stirred=STIRRED)
    rng = np.random.default_rng(5)
    drawn = np.array([list(trial.draw(rng).values()) for _ in range(400)])  # trials, outputs, rows
    expected = np.sqrt(spread_of_outputs(1000).T ** 2 + np.square(list(READS.values()))[:, None])
    ratio = drawn.std(axis=0) / expected
    assert np.abs(ratio - 1).max() < 5.5 / np.sqrt(800)
    assert np.abs(ratio.mean(axis=1) - 1).max() < 0.02


@pytest.mark.slow
def test_a_study_by_filter_error_holds_what_it_says() -> None:
    trial = sepcal.DesignTrial(
        sepcal.ShortPeriod(), DESIGN, FLOWN, READS, stirred=STIRRED,
        method="filter-error", coloured_errors=False,
    )  # fmt: skip
    study = sepcal.monte_carlo(trial, 24, seed=3)
    assert not study.failed
    off = (study.estimates - [FLOWN[name] for name in study.names]) / study.standard_errors
    places = [study.names.index(name) for name in TRUTH]
    assert 0.75 < np.sqrt(np.mean(np.square(off[:, places]))) < 1.25


def test_a_noise_that_the_model_has_not_is_refused() -> None:
    refuse(
        lambda: sepcal.DesignTrial(sepcal.ShortPeriod(), DESIGN, FLOWN, READS, stirred={"r": 1.0}),
        "there is no process noise r; the model has: alpha, q",
    )


def test_smoothed_disturbances_over_their_deviation_are_standard_normal() -> None:
    """w(k|N) / sqrt(q^2 / dt - Q(k|N)), what compare() looks for stretches in."""
    fitted = sepcal.fit(
        sepcal.ShortPeriod(),
        LOG,
        method="filter-error",
        fix=TRUTH | {"b_alpha": 0.02, "b_q": -0.01, "b_az": 0.5},
        process_noise=STIRRED,
        noise=READS,
    )
    smoothed = sepcal.smooth(sepcal.ShortPeriod(), LOG, fitted, process_noise=STIRRED)
    for k, size in enumerate(STIRRED.values()):
        variance = size**2 / 0.02 - smoothed.w_standard_error[:-1, k] ** 2
        scaled = smoothed.w[:-1, k] / np.sqrt(variance)
        assert scaled.std() == pytest.approx(1.0, abs=0.15)
        assert (np.abs(scaled) > 3).mean() < 0.01
