# SPDX-License-Identifier: BSD-3-Clause
"""What a design would tell: sensitivities by differences of NumPy's flights, and fits of many.

The longitudinal aircraft is integrated here, by Runge-Kutta with four steps a row.
"""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import apps
import sepcal
from refusals import refuse

Array = NDArray[np.float64]
AIRCRAFT = sepcal.Aircraft(
    area=16.2, chord=1.49, span=10.9, mass=1100.0, inertia=(1285.0, 1825.0, 2667.0, 0.0)
)
RHO, STEP, THRUST, G = 1.1, 0.02, 900.0, 9.80665
TRUTH = {
    "b_ax": 0.02, "b_az": -0.03, "b_q": 0.001,
    "CX_0": -0.04, "CX_alpha": 0.3, "CX_q": 0.5, "CX_elevator": 0.05,
    "CZ_0": -0.3, "CZ_alpha": -4.8, "CZ_q": -5.0, "CZ_elevator": -0.4,
    "Cm_0": 0.02, "Cm_alpha": -0.9, "Cm_q": -14.0, "Cm_elevator": -1.2,
    "u_0": 51.0, "w_0": 1.2, "q_0": 0.0, "theta_0": 0.03,
}  # fmt: skip
EQUATIONS = {name: ["1", "alpha", "q_hat", "elevator"] for name in ("CX", "CZ", "Cm")}
NOISE = {"airspeed": 0.1, "alpha": 0.002, "pitch": 0.001, "ax": 0.02, "az": 0.05, "q": 0.001}
MODEL = sepcal.RigidAircraft(AIRCRAFT, "longitudinal", equations=EQUATIONS)


def fly(values: Array, elevator: Array) -> Array:
    """(6, N, K): outputs in NOISE's order of K aircraft, values (19, K) in TRUTH's order.

    An inertial unit reads less by its bias.
    """
    biases, derivatives, x = values[:3], values[3:15].reshape(3, 4, -1), values[15:]

    def forces(x: Array, u: float) -> tuple[Array, Array]:
        V = np.hypot(x[0], x[1])
        regressors = np.stack(
            [np.ones_like(V), np.arctan2(x[1], x[0]), x[2] * 1.49 / (2 * V), np.full_like(V, u)]
        )
        C = np.einsum("cik,ik->ck", derivatives, regressors)
        return C * 0.5 * RHO * V**2 * 16.2, V

    def rate(x: Array, u: float) -> Array:
        (X, Z, M), _ = forces(x, u)
        return np.stack(
            [
                (X + THRUST) / 1100 - x[2] * x[1] - G * np.sin(x[3]),
                Z / 1100 + x[2] * x[0] + G * np.cos(x[3]),
                M * 1.49 / 1825,
                x[2],
            ]
        )

    rows = []
    for k, u in enumerate(elevator):
        (X, Z, _), V = forces(x, u)
        rows.append(
            [
                V,
                np.arctan2(x[1], x[0]),
                x[3],
                (X + THRUST) / 1100 - biases[0],
                Z / 1100 - biases[1],
                x[2] - biases[2],
            ]
        )
        if k + 1 == len(elevator):
            break
        h, slope = STEP / 4, (elevator[k + 1] - u) / 4
        for i in range(4):
            a, m, b = u + i * slope, u + (i + 0.5) * slope, u + (i + 1) * slope
            k1 = rate(x, a)
            k2 = rate(x + h / 2 * k1, m)
            k3 = rate(x + h / 2 * k2, m)
            k4 = rate(x + h * k3, b)
            x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return np.array(rows).transpose(1, 0, 2)


def log_of(
    outputs: Array, elevator: Array, rng: np.random.Generator | None = None
) -> sepcal.Flight:
    """Outputs (6, N), with noise where there is one to draw it."""
    rows = len(elevator)
    read = dict(zip(NOISE, outputs, strict=True))
    if rng is not None:
        read = {name: y + NOISE[name] * rng.standard_normal(rows) for name, y in read.items()}
    zero = np.zeros(rows)
    return sepcal.Flight(
        {
            "time_s": STEP * np.arange(rows),
            "airspeed_mps": read["airspeed"], "alpha_rad": read["alpha"], "beta_rad": zero,
            "pitch_rad": read["pitch"], "roll_rad": zero,
            "p_radps": zero, "q_radps": read["q"], "r_radps": zero,
            "ax_mps2": read["ax"], "ay_mps2": zero, "az_mps2": read["az"],
            "elevator_rad": elevator, "thrust_n": np.full(rows, THRUST),
            "rho_kgpm3": np.full(rows, RHO),
        }
    )  # fmt: skip


def trimmed() -> tuple[Array, float]:
    """TRUTH as (19, 1) from a trimmed start on, and the elevator there."""
    values = np.array(list(TRUTH.values()))[:, None]
    V, alpha, elevator = 55.0, 0.0, 0.0
    for _ in range(50):  # CZ carries the weight, Cm is nothing, CX and thrust hold the speed
        elevator = (0.02 - 0.9 * alpha) / 1.2
        lift = 1100 * G * np.cos(alpha) / (0.5 * RHO * V**2 * 16.2)
        alpha = (lift - 0.3 - 0.4 * elevator) / 4.8
    drag = 0.5 * RHO * V**2 * 16.2 * (-0.04 + 0.3 * alpha + 0.05 * elevator)
    values[3] += (1100 * G * np.sin(alpha) - THRUST - drag) / (0.5 * RHO * V**2 * 16.2)
    values[15:, 0] = V * np.cos(alpha), V * np.sin(alpha), 0.0, alpha
    return values, elevator


VALUES, TRIM = trimmed()
DESIGN = sepcal.multisines({"elevator_rad": 0.03}, duration=10.0)
FLOWN = TRIM + DESIGN.signals["elevator_rad"]


@pytest.fixture(scope="module")
def fitted() -> sepcal.AircraftFit:
    """A first flight, by small steps."""
    steps = sepcal.three_two_one_one({"u": 0.02}).signals["u"]
    elevator = TRIM + np.concatenate([steps, -steps])
    outputs = fly(VALUES, elevator)[..., 0]
    return sepcal.fit(MODEL, log_of(outputs, elevator, np.random.default_rng(1)), noise=NOISE)


def test_errors_are_those_of_differences(fitted: sepcal.AircraftFit) -> None:
    expected = fitted.expect(DESIGN)
    values = np.array([fitted[name].value for name in TRUTH])
    steps = np.array([0.01 * expected[name].standard_error for name in TRUTH])
    around = np.concatenate([np.diag(steps), -np.diag(steps)], axis=1) + values[:, None]
    start = float(fitted.flight["elevator_rad"][0])
    y = fly(around, start + DESIGN.signals["elevator_rad"])
    S = (y[..., : len(steps)] - y[..., len(steps) :]) / (2 * steps)
    whitened = np.concatenate([s / NOISE[name] for name, s in zip(NOISE, S, strict=True)])
    covariance = np.linalg.inv(whitened.T @ whitened)
    errors = np.sqrt(np.diag(covariance))
    for i, name in enumerate(TRUTH):
        assert expected[name].value == pytest.approx(values[i], abs=1e-3 * errors[i]), name
        assert expected[name].standard_error == pytest.approx(errors[i], rel=1e-4), name
    order = [expected.names.index(name) for name in TRUTH]
    assert_allclose(
        expected.correlation[np.ix_(order, order)],
        covariance / np.outer(errors, errors),
        atol=1e-4,
    )


@pytest.mark.slow
def test_errors_are_the_scatter_of_fits(fitted: sepcal.AircraftFit) -> None:
    """100 flights: a scatter is known to 7 %, all 19 together to less.

    Each within 28 % fails by chance in one run of a thousand.
    """
    expected = fitted.expect(DESIGN)
    errors = np.array([expected[name].standard_error for name in TRUTH])
    outputs = fly(VALUES, FLOWN)[..., 0]
    start = {name: fitted[name].value for name in TRUTH if not name.startswith("b_")}
    found = []
    for seed in range(100):
        flight = log_of(outputs, FLOWN, np.random.default_rng(100 + seed))
        fit = sepcal.fit(MODEL, flight, noise=NOISE, start=start, coloured_errors=False, threads=1)
        assert fit.status == "converged"
        found.append([fit[name].value for name in TRUTH])
    scatter = np.std(found, axis=0, ddof=1) / errors
    assert_allclose(scatter, 1.0, atol=0.28)
    assert np.sqrt(np.mean(scatter**2)) == pytest.approx(1.0, abs=0.1)
    off = (np.mean(found, axis=0) - VALUES[:, 0]) / errors
    assert np.abs(off).max() < 0.4  # of a mean of 100


def test_a_trial_of_any_model_expects_its_scatter() -> None:
    """400 trials: each within 15 %, which fails by chance in three of ten thousand."""
    time = np.arange(0.0, 12.0, 0.02)
    design = {
        "time": time,
        "elevator": sepcal.three_two_one_one({"u": 0.05}, after=20.0).signals["u"][: len(time)],
        "airspeed": np.full(len(time), 50.0),
    }
    truth = {"Za": -1.0, "Ma": -6.0, "Mq": -2.0, "Zd": -0.1, "Md": -9.0}
    start = {"b_alpha": 0.0, "b_q": 0.0, "b_az": 0.0, "alpha_0": 0.0, "q_0": 0.0}
    noise = {"alpha_m": 0.004, "q_m": 0.005, "az_m": 0.3}
    trial = sepcal.DesignTrial(
        sepcal.ShortPeriod(), design, {**truth, **start}, noise,
        noise=noise, start={"Za": -1.2, "Ma": -5.0, "Mq": -1.5}, coloured_errors=False,
    )  # fmt: skip
    expected = trial.expect()
    for name, value in truth.items():
        assert expected[name].value == pytest.approx(value, rel=1e-6)
    study = sepcal.monte_carlo(trial, 400, seed=1, progress=False)
    scatter = study.estimates.std(axis=0, ddof=1)
    errors = [expected[name].standard_error for name in study.names]
    assert_allclose(scatter / errors, 1.0, atol=0.15)


def test_filter_error_expects_the_air_too(fitted: sepcal.AircraftFit) -> None:
    still = fitted.expect(DESIGN)
    rough = sepcal.fit(
        MODEL,
        fitted.flight,
        noise=NOISE,
        method="filter-error",
        process_noise={"w": 0.3, "q": 0.02},
    ).expect(DESIGN)
    assert rough.method == "filter-error"
    assert rough.noise_sizes
    for name in ("CZ_alpha", "Cm_alpha", "Cm_q"):
        assert rough[name].standard_error > 1.5 * still[name].standard_error, name


@pytest.mark.slow
def test_it_begins_at_another_flight(fitted: sepcal.AircraftFit, tmp_path: Path) -> None:
    fitted.save(tmp_path / "fit.json")
    loaded = sepcal.load(tmp_path / "fit.json")
    refuse(lambda: loaded.expect(DESIGN), "give one: expect(..., sepcal.read(")
    same = loaded.expect(DESIGN, fitted.flight)
    outputs = fly(VALUES, FLOWN)[..., 0]
    other = loaded.expect(DESIGN, log_of(outputs, FLOWN, np.random.default_rng(3)))
    for name in TRUTH:
        error = fitted.expect(DESIGN)[name].standard_error
        assert same[name].standard_error == pytest.approx(error, rel=1e-9)
        assert other[name].standard_error == pytest.approx(error, rel=0.05)


@pytest.mark.slow
def test_a_table_of_inputs_is_in_its_own_units(fitted: sepcal.AircraftFit) -> None:
    degrees = {"time_s": DESIGN.time, "elevator_deg": np.rad2deg(DESIGN.signals["elevator_rad"])}
    told = fitted.expect(degrees)
    for name in TRUTH:
        error = fitted.expect(DESIGN)[name].standard_error
        assert told[name].standard_error == pytest.approx(error, rel=1e-9)


def test_what_a_design_does_not_move_is_not_told(fitted: sepcal.AircraftFit) -> None:
    still = {"time_s": DESIGN.time, "elevator_rad": np.zeros(len(DESIGN.time))}
    told = fitted.expect(still)
    assert told.status == "not_identifiable"
    assert "Cm_elevator" in told.message


def test_the_program_says_what_to_expect(fitted: sepcal.AircraftFit, tmp_path: Path) -> None:
    fitted.save(tmp_path / "fit.json")
    fitted.flight.to_csv(tmp_path / "f.csv")
    asked = ("--input", "elevator_rad=0.03", "--duration", "10", "--for", "fit.json")
    on = (*asked, "--flight", "f.csv", "-o", "u.csv")
    done = apps.run("sepcal-aircraft", "design", *on, folder=tmp_path)
    assert done.code == 0, done.err
    assert "relative peak factor" in done.out
    assert "to be expected of 501 rows" in done.out
    assert "correlation above 0.9: CZ_0 and Cm_0" in done.out
    told = apps.run("sepcal-aircraft", "design", *on, "--json", folder=tmp_path)
    expected = fitted.expect(DESIGN)
    for name, one in told.result["expected"]["parameters"].items():
        assert one["standard_error"] == pytest.approx(expected[name].standard_error, rel=1e-4)
        assert one["standard_error_of_fit"] == pytest.approx(fitted[name].standard_error, rel=1e-6)
    assert told.result["expected"]["correlated"][0]["first"] == "CZ_0"
    assert told.result["expected"]["outputs"]["q"]["to"] < 0.2
    alone = apps.run("sepcal-aircraft", "design", *asked, "-o", "no.csv", folder=tmp_path)
    assert alone.code == 2
    assert "go together" in alone.err
    assert not (tmp_path / "no.csv").exists()
    over = apps.run(
        "sepcal-aircraft", "design", *asked, "--flight", "f.csv", "-o", "f.csv", folder=tmp_path
    )
    assert over.code == 2  # the log stays


def test_what_flies_nothing_is_refused(fitted: sepcal.AircraftFit) -> None:
    rows = np.zeros(len(DESIGN.time))
    refuse(
        lambda: fitted.expect({"time_s": DESIGN.time, "flap_rad": rows}),
        "'flap_rad' is no input that the model reads",
    )
    refuse(
        lambda: fitted.expect({"time_s": DESIGN.time, "alpha_rad": rows}),
        "'alpha_rad' is no input that the model reads",
    )
    refuse(lambda: fitted.expect({"elevator_rad": rows}), "'time_s' is missing")
    refuse(
        lambda: fitted.expect({"time_s": DESIGN.time, "elevator_rad": rows + np.nan}), "no number"
    )
    later = np.where(np.arange(len(rows)) > 200, DESIGN.time + 5.0, DESIGN.time)
    refuse(lambda: fitted.expect({"time_s": later, "elevator_rad": rows}), "time has a gap")
    flight = fitted.flight
    assert flight is not None
    aero = sepcal.fit(sepcal.Aero(AIRCRAFT, "Cm", equations={"Cm": EQUATIONS["Cm"]}), flight)
    refuse(lambda: aero.expect(DESIGN), "'aero' flies no inputs")
