# SPDX-License-Identifier: BSD-3-Clause
"""Models with a state in Python: the numbers of C++ and of SciPy, and every way along a record."""

# ruff: noqa: RUF012

import copy
import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.optimize import least_squares

import sepcal
from own_state_models import (
    PERIOD,
    ROLL,
    SWING,
    Pendulum,
    RollMode,
    ShortPeriod,
    fly_short_period,
    integrate,
    swing,
)
from refusals import refuse

NEAR = {name: PERIOD[name] for name in ("Za", "Ma", "Mq")}
FLIGHT = fly_short_period()
SWUNG = swing()


def errors(fit: sepcal.Fit) -> np.ndarray:
    return np.sqrt(np.diag(fit.covariance))


def distance(one: sepcal.Fit, other: sepcal.Fit) -> float:
    """In standard errors, the largest."""
    assert one.names == other.names
    return float(np.abs((one.values - other.values) / errors(other)).max())


# --- the same numbers


@pytest.mark.parametrize(
    "options",
    [{}, {"inputs": "hold"}, {"substeps": 3}, {"shoot": 3.0}, {"outputs": ["q_m", "az_m"]}],
    ids=str,
)
def test_the_short_period_is_that_of_cpp(options: dict) -> None:
    compiled = sepcal.fit(sepcal.ShortPeriod(**options), FLIGHT, start=NEAR)
    own = sepcal.fit(sepcal.Trajectory(ShortPeriod(), **options), FLIGHT, start=NEAR)
    assert own.status == compiled.status == "converged"
    assert distance(own, compiled) < 1e-6
    assert_allclose(errors(own), errors(compiled), rtol=1e-8)
    units = [compiled[name].unit for name in compiled.names]
    assert [own[name].unit for name in own.names] == units


def test_joint_and_separable_are_one_answer() -> None:
    separable = sepcal.fit(ShortPeriod(), FLIGHT, start=NEAR)
    start = PERIOD | {"alpha_0": 0.0, "q_0": 0.0}
    joint = sepcal.fit(sepcal.Trajectory(ShortPeriod(), separable=False), FLIGHT, start=start)
    assert set(joint.names) == set(separable.names)
    for name in joint.names:
        error = separable[name].standard_error
        assert abs(joint[name].value - separable[name].value) < 1e-6 * error


def test_stage_one_samples_as_in_cpp() -> None:
    """Many trajectories side by side give what they give one by one."""
    options = {"samples": 40, "descents": 1}
    compiled = sepcal.fit(sepcal.ShortPeriod(), FLIGHT, **options)
    own = sepcal.fit(ShortPeriod(), FLIGHT, **options)
    assert_array_equal(own.stage_one.samples, compiled.stage_one.samples)
    assert_allclose(own.stage_one.trace_r, compiled.stage_one.trace_r, rtol=1e-8)
    held = {"fix": {"b_q": -0.01, "Mq": -5.0}, **options}
    trace = [sepcal.fit(m, FLIGHT, **held).stage_one.trace_r
             for m in (ShortPeriod(), sepcal.ShortPeriod())]  # fmt: skip
    assert_allclose(trace[0], trace[1], rtol=1e-8)


def test_scipy_finds_the_roll_mode() -> None:
    """least_squares over solve_ivp; a step of 0.1 s with Lp dt = 0.25 asks for substeps."""
    fit = sepcal.fit(sepcal.Trajectory(RollMode(), substeps=20), ROLL, coloured_errors=False)

    def residual(xi: np.ndarray) -> np.ndarray:
        bias, La, p_0, Lp = xi
        (p,) = integrate(RollMode(), ROLL["time"], ROLL, [Lp, La], [p_0])
        return p + bias - ROLL["p_m"]

    found = least_squares(residual, [0.0, 10.0, 0.0, -2.0], jac="3-point", xtol=1e-12)
    white = np.linalg.inv(found.jac.T @ found.jac) * (found.fun @ found.fun) / (21 - 4)
    assert fit.names == ("b_p", "La", "p_0", "Lp")
    assert_allclose(errors(fit), np.sqrt(np.diag(white)), rtol=1e-4)
    assert_allclose(fit.values / errors(fit), found.x / errors(fit), rtol=0, atol=1e-4)


def test_a_pendulum_comes_back() -> None:
    """Nonlinear, rows that lie unevenly, started where it is read."""
    fit = sepcal.fit(Pendulum(), SWUNG, samples=40, coloured_errors=False)
    assert fit.status == "converged"
    for name, truth in SWING.items():
        assert abs(fit[name].value - truth) < 4 * fit[name].standard_error, name


def test_values_and_derivatives_are_those_of_an_adaptive_method() -> None:
    data = swing(rows=300, sigma=0.0)
    xi2, xi1 = np.array([3.0, 0.4, 2.0, 0.8, -0.3]), [0.05, 0.02]
    A, b, D = sepcal.Trajectory(Pendulum(), substeps=8).evaluate(data, xi2, xi1)

    def outputs(point: np.ndarray) -> np.ndarray:
        x, v = integrate(Pendulum(), data["time"], data, point[:3], point[3:])
        return np.stack([1.05 * x + 0.02, v], axis=-1)

    assert_allclose(A @ xi1 + b, outputs(xi2), rtol=0, atol=1e-7)
    for k in range(5):
        step = 1e-4 * np.eye(5)[k]
        expected = (outputs(xi2 + step) - outputs(xi2 - step)) / 2e-4
        assert_allclose(D[..., k], expected, rtol=0, atol=1e-6 * np.abs(expected).max())


# --- along a record


def test_segments_have_initial_states_of_their_own() -> None:
    labels = ["pull"] * 150 + ["push"] * 150
    fit = sepcal.fit(ShortPeriod(), {**FLIGHT, "maneuver": labels}, start=NEAR)
    own = [name for name in fit.names if "_0" in name]
    assert own == ["alpha_0[pull]", "q_0[pull]", "alpha_0[push]", "q_0[push]"]
    compiled = sepcal.fit(sepcal.ShortPeriod(), {**FLIGHT, "maneuver": labels}, start=NEAR)
    assert distance(fit, compiled) < 1e-6
    parts = [{name: column[part] for name, column in FLIGHT.items()}
             for part in (slice(0, 150), slice(150, 300))]  # fmt: skip
    many = sepcal.fit_many(
        ShortPeriod(), {"pull": parts[0], "push": parts[1]}, own=["alpha_0", "q_0"], start=NEAR
    )
    assert abs(many["Ma"].value - fit["Ma"].value) < 1e-6 * fit["Ma"].standard_error


def test_a_measured_state_is_read() -> None:
    """Where q is read in place of integrated, alpha follows from it alone."""
    data = {**FLIGHT, "q": FLIGHT["q_m"] + 0.01}
    options = {"measured": ["q"], "outputs": ["alpha_m", "az_m"]}
    kept = {"Ma": -40.0, "Mq": -5.0, "Md": -45.0}
    compiled = sepcal.fit(sepcal.ShortPeriod(**options), data, fix=kept)
    own = sepcal.fit(sepcal.Trajectory(ShortPeriod(), **options), data, fix=kept)
    assert [name for name in own.names if name.endswith("_0")] == ["alpha_0"]
    free = [name for name in own.names if name not in kept]
    for name in free:
        error = compiled[name].standard_error
        assert abs(own[name].value - compiled[name].value) < 1e-6 * error


def test_scales_about_the_start_are_the_same_fit() -> None:
    """S (x - x(0)) in place of s x: the bias takes s x(0) over, nothing else moves."""
    plain = sepcal.fit(Pendulum(), SWUNG, samples=20)
    about = sepcal.fit(sepcal.Trajectory(Pendulum(), scales_about_start=True), SWUNG, samples=20)
    for name in ("s", "w", "d", "g", "x_0", "v_0"):
        error = plain[name].standard_error
        assert abs(about[name].value - plain[name].value) < 1e-4 * error, name
    moved = plain["b"].value + plain["s"].value * plain["x_0"].value
    assert about["b"].value == pytest.approx(moved, abs=1e-4 * plain["b"].standard_error)


def test_a_parameter_leaves_with_its_output() -> None:
    model = sepcal.Trajectory(Pendulum(), outputs=["v_m"])
    assert model.linear == ()
    assert model.outputs == ("v_m",)


def test_time_may_be_discrete() -> None:
    """x(k+1) = a x(k) + g u(k), in closed form."""

    class Difference(RollMode):
        nonlinear = {"Lp": ("1", -0.99, 0.99), "La": "1"}
        discrete = True
        next = RollMode.rate
        rate = None

    rng = np.random.default_rng(5)
    aileron, x = rng.standard_normal(80), [0.4]
    for u in aileron[:-1]:
        x.append(0.8 * x[-1] + 1.5 * u)
    data = {"time": np.arange(80.0), "aileron": aileron, "p_m": np.array(x) + 0.1}
    fit = sepcal.fit(Difference(), data, samples=30)
    for name, truth in {"b_p": 0.1, "La": 1.5, "p_0": 0.4, "Lp": 0.8}.items():
        assert fit[name].value == pytest.approx(truth, abs=1e-8)


def test_time_goes_on_where_inputs_are_held() -> None:
    class Ramp:
        inputs = {"time": "s"}
        states = {"x": "1"}
        outputs = {"z": "1"}
        linear = {}
        nonlinear = {"a": ("1/s^2", -5, 5)}

        def rate(self, x, u, p):
            return [p[0] * u.time]

        def at(self, x, u, p):
            return np.zeros((1, 0, x.shape[1])), x

    time = np.linspace(0, 2, 30)
    data = {"time": time, "z": 0.5 * 1.5 * time**2}
    model = sepcal.Trajectory(Ramp(), inputs="hold")
    assert model.inputs == ("time",)
    _, b = model.evaluate(data, [1.5, 0.0])
    assert_allclose(b[:, 0], data["z"], atol=1e-14)


def test_the_whole_is_that_of_its_blocks() -> None:
    """More rows than a block has, and derivatives by its last row."""
    data = fly_short_period(rows=700)
    xi2, xi1 = [-4.0, -40.0, -5.0], [0.0, 0.0, 0.0, -0.35, -45.0, 0.01, -0.05]
    own = sepcal.Trajectory(ShortPeriod()).evaluate(data, xi2, xi1)
    compiled = sepcal.ShortPeriod().evaluate(data, xi2, xi1)
    for one, other in zip(own, compiled, strict=True):
        assert_allclose(one, other, rtol=0, atol=1e-10)


# --- what it is


def test_it_says_what_it_is_and_travels() -> None:
    model = sepcal.Trajectory(Pendulum(), substeps=2)
    assert model.states == ("x", "v")
    assert model.inputs == ("u", "time")
    assert model.nonlinear == ("w", "d", "g", "x_0", "v_0")
    assert repr(model).startswith("Trajectory(<")
    assert "substeps=2" in repr(model)
    for other in (copy.copy(model), pickle.loads(pickle.dumps(model))):
        assert repr(other).endswith("substeps=2)")
        assert_array_equal(
            other.evaluate(SWUNG, [3, 0.4, 2, 0.8, -0.3])[1],
            model.evaluate(SWUNG, [3, 0.4, 2, 0.8, -0.3])[1],
        )


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, ("substeps = 2", "the one given has 1")),
        ({"substeps": 2, "inputs": "hold"}, ('inputs = "linear"', '"hold"')),
        ({"substeps": 2, "shoot": 3.0}, ("shoot = none", "3.0")),
    ],
    ids=str,
)
def test_a_file_is_read_by_the_model_as_it_was_laid(
    options: dict[str, Any], words: tuple[str, ...], tmp_path: Path
) -> None:
    """Laid otherwise, its parameters would make other readings of the same inputs."""
    model = sepcal.Trajectory(RollMode(), substeps=2)
    flight = sepcal.Flight({"time_s": ROLL["time"], "aileron": ROLL["aileron"], "p_m": ROLL["p_m"]})
    fitted = sepcal.fit(model, flight)
    file = tmp_path / "roll.json"
    fitted.save(file)
    again = sepcal.load(file, model=model).apply(flight)
    assert_array_equal(again["p_m_fit_radps"], fitted.apply(flight)["p_m_fit_radps"])
    other = sepcal.Trajectory(RollMode(), **options)
    refuse(lambda: sepcal.load(file, model=other), "roll.json", *words)
    before = json.loads(file.read_text())  # files of before don't tell
    del before["trajectory"]
    file.write_text(json.dumps(before))
    assert sepcal.load(file, model=other).status == fitted.status


def test_effects_predictions_and_intervals_work_on_it() -> None:
    drift = sepcal.Effect("drift", lambda log: {"s": log["time"]})
    fit = sepcal.fit(RollMode(), ROLL, effects=[drift], samples=20)
    assert "drift.s" in fit.names
    refuse(lambda: sepcal.smooth(RollMode(), ROLL, fit, {"p": 0.01}), "effects")
    fit = sepcal.fit(RollMode(), ROLL, samples=20)
    value = sepcal.predict(RollMode(), ROLL, fit).value
    assert np.sqrt(np.mean((value[:, 0] - ROLL["p_m"]) ** 2)) == pytest.approx(fit.rmse["p_m"])
    intervals = sepcal.profile_intervals(RollMode(), ROLL, fit, names=["Lp"])
    lower, upper = intervals["Lp"].profile
    assert lower < fit["Lp"].value < upper


class Decay:
    """Nothing but its initial state is unknown."""

    inputs = {}
    states = {"x": "m"}
    outputs = {"x_m": "m"}
    linear = {}
    nonlinear = {}
    noise = {"x": "m/sqrt(s)"}

    def rate(self, x: Any, u: Any, p: Any) -> Any:
        """It decays."""
        return [-0.5 * x[0]]

    def at(self, x: Any, u: Any, p: Any) -> Any:
        """The state itself."""
        return np.empty((1, 0)), [x[0]]


def test_a_model_of_no_parameters_has_its_initial_state() -> None:
    time = np.arange(50) / 10
    data = {"time": time, "x_m": 2.0 * np.exp(-0.5 * time)}
    fit = sepcal.fit(Decay(), data, start={"x_0": 1.0})
    assert fit["x_0"].value == pytest.approx(2.0, rel=1e-6)
    found = sepcal.track(Decay(), data, start_rows=20, noise={"x_m": 0.01}, start={"x_0": 1.0})
    assert found["x"][-1] == pytest.approx(data["x_m"][-1], rel=1e-5)


@pytest.mark.slow
def test_steps_too_long_for_the_dynamics_are_said() -> None:
    """Of a held input RK4 with steps of 0.05 s can't tell -54.4 1/s from -2: both give 0.9048."""
    time = 0.05 * np.arange(200)
    aileron = 0.1 * np.sign(np.sin(1.3 * time) + 0.1)
    decay = np.exp(-2.0 * 0.05)
    p = np.zeros(200)
    for k in range(199):
        p[k + 1] = decay * p[k] + 12.0 * aileron[k] * (1 - decay) / 2.0
    noise = 0.001 * np.random.default_rng(1).standard_normal(200)
    data = {"time": time, "aileron": aileron, "p_m": p + noise}
    held = sepcal.Trajectory(RollMode(), inputs="hold")
    wrong = sepcal.fit(held, data, bounds={"Lp": (-60.0, -40.0)})
    assert wrong["Lp"].value < -40
    assert not wrong.success
    assert wrong.message.startswith(
        "steps of integration are too long for the fastest rate of the dynamics; take 6 times as "
        "many (substeps)"
    )
    right = sepcal.fit(held, data)
    assert right.success
    assert right["Lp"].value == pytest.approx(-2.0, abs=0.01)
    assert "substeps" not in right.message
