# SPDX-License-Identifier: BSD-3-Clause
"""Output error over a band: a small maneuver of a linear aircraft that NumPy flies.

tests/cpp/frequency/output_error_in_band_test.cpp has its precision and coverage.
"""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import apps
import sepcal
from refusals import refuse

AIRCRAFT = sepcal.Aircraft(
    area=16.2, chord=1.49, span=10.9, mass=1100.0, inertia=(1285.0, 1825.0, 2667.0, 0.0)
)
TRUTH = {
    "CZ_alpha": -4.8, "CZ_q": -5.0, "CZ_elevator": -0.4,
    "Cm_alpha": -0.9, "Cm_q": -14.0, "Cm_elevator": -1.2,
}  # fmt: skip
RHO, STEP, ROWS = 1.1, 0.02, 2000
FORCE = 0.5 * RHO * 16.2  # N per (m/s)^2
G = 9.80665


def elevator_at(t: float) -> float:
    return 0.006 * np.sin(1.0 * t + 0.09 * t**2) + 0.004 * np.sin(1.7 * t) - 0.03


def coefficients(x: NDArray[np.float64], u: float) -> tuple[float, float, float, float]:
    V = np.hypot(x[0], x[1])
    alpha, q_hat = np.arctan2(x[1], x[0]), x[2] * 1.49 / (2 * V)
    return (
        -0.05 + 0.3 * alpha,
        -0.3 - 4.8 * (alpha - 0.06) - 5.0 * q_hat - 0.4 * (u + 0.03),
        -0.9 * (alpha - 0.06) - 14.0 * q_hat - 1.2 * (u + 0.03),
        FORCE * V**2,
    )


@pytest.fixture(scope="module")
def flight() -> sepcal.Flight:
    """u, w, q, theta by SciPy's Runge-Kutta, from trim and back to near it; a gyro with a bias."""
    thrust = 0.0

    def rate(t: float, x: NDArray[np.float64]) -> list[float]:
        CX, CZ, Cm, force = coefficients(x, elevator_at(t))
        u, w, q, theta = x
        return [
            (force * CX + thrust) / 1100 - q * w - G * np.sin(theta),
            force * CZ / 1100 + q * u + G * np.cos(theta),
            force * 1.49 * Cm / 1825,
            q,
        ]

    V = np.sqrt(1100 * G / (0.3 * FORCE))
    thrust = -FORCE * V**2 * (-0.05 + 0.3 * 0.06) + 1100 * G * np.sin(0.06)
    t = STEP * np.arange(ROWS)
    start = [V * np.cos(0.06), V * np.sin(0.06), 0.0, 0.06]
    x = solve_ivp(rate, (0, t[-1]), start, t_eval=t, rtol=1e-9, atol=1e-10).y
    rng = np.random.default_rng(1)
    forces = np.array([coefficients(x[:, k], elevator_at(t[k])) for k in range(ROWS)])
    zero = np.zeros(ROWS)
    speed = np.hypot(x[0], x[1])

    def read(values: NDArray[np.float64], noise: float) -> NDArray[np.float64]:
        return np.asarray(values + noise * rng.standard_normal(ROWS))

    return sepcal.Flight(
        {
            "time_s": t,
            "airspeed_mps": read(speed, 0.1),
            "alpha_rad": read(np.arctan2(x[1], x[0]), 0.001),
            "beta_rad": zero,
            "pitch_rad": read(x[3], 0.001),
            "roll_rad": zero,
            "q_radps": read(x[2], 0.001) + 0.01,
            "p_radps": zero,
            "r_radps": zero,
            "ax_mps2": read((forces[:, 3] * forces[:, 0] + thrust) / 1100, 0.02),
            "ay_mps2": zero,
            "az_mps2": read(forces[:, 3] * forces[:, 1] / 1100, 0.05),
            "elevator_rad": np.array([elevator_at(at) for at in t]),
            "thrust_n": np.full(ROWS, thrust),
            "rho_kgpm3": np.full(ROWS, RHO),
        }
    )


@pytest.fixture(scope="module")
def fitted(flight: sepcal.Flight) -> sepcal.AircraftFit:
    return sepcal.fit(sepcal.RigidAircraft(AIRCRAFT, "longitudinal", band=(0.1, 2.0)), flight)


def test_the_truth_comes_back(fitted: sepcal.AircraftFit) -> None:
    assert fitted.status == "converged"
    assert fitted.method == "frequency-output-error"
    for name, truth in TRUTH.items():
        assert abs(fitted[name].value - truth) < 4 * fitted[name].standard_error, name
        assert abs(fitted[name].value - truth) < 0.1 * abs(truth) + 0.6 * (name == "CZ_q"), name
    for name in ("CX_0", "CX_alpha^2", "CZ_0", "Cm_0"):  # which a band does not tell
        assert fitted[name].fixed
    assert "b_q" not in fitted.parameters
    assert set(fitted.initial_states) == {"u_end", "w_end", "q_end", "theta_end"}
    assert any("Cm_0" in note and "held" in note for note in fitted.notes)


def test_a_comparison_finds_the_rest_in_time(
    fitted: sepcal.AircraftFit, flight: sepcal.Flight
) -> None:
    compared = {misfit.output: misfit.rmse for misfit in fitted.compare().overall}
    assert compared["q"] < 0.003
    assert compared["alpha"] < 0.003
    assert len(fitted.apply()["q_model_radps"]) == ROWS
    refuse(fitted.diagnose, "in time")
    refuse(fitted.intervals, "in time")
    refuse(lambda: fitted.track(flight), "a fit over a band has no states")


def test_it_is_saved_and_loaded(fitted: sepcal.AircraftFit, tmp_path: Path) -> None:
    fitted.save(tmp_path / "fit.json")
    again = sepcal.load(tmp_path / "fit.json")
    assert str(again) == str(fitted)


def test_the_program_fits_the_same(
    fitted: sepcal.AircraftFit, flight: sepcal.Flight, tmp_path: Path
) -> None:
    flight.to_csv(tmp_path / "f.csv")
    (tmp_path / "a.json").write_text(AIRCRAFT.to_json())
    typed = ("f.csv", "--model", "longitudinal", "--geometry", "a.json", "--method", "frequency")
    done = apps.run("sepcal-aircraft", "fit", *typed, "--json", folder=tmp_path)
    assert done.code == 0, done.err
    for name in TRUTH:
        value = done.result["parameters"][name]["value"]
        assert value == pytest.approx(fitted[name].value, rel=1e-6)


def test_what_a_band_has_not_is_refused(flight: sepcal.Flight) -> None:
    model = sepcal.RigidAircraft(AIRCRAFT, "longitudinal", band=(0.1, 2.0))
    refuse(lambda: sepcal.fit(model, flight, method="filter-error"), "filter error", "in time")
    refuse(lambda: sepcal.fit(model, flight, effects=["alpha_late"]), "'alpha_late'", "in time")
    refuse(lambda: sepcal.fit(model, flight, loss="huber"), "leave the loss out")
