# SPDX-License-Identifier: BSD-3-Clause
"""What can go wrong in a model with a state in Python."""

# ruff: noqa: RUF012

from collections.abc import Callable

import numpy as np
import pytest

import sepcal
from own_models import WindBox
from own_state_models import ROLL, Pendulum, RollMode, ShortPeriod, swing
from refusals import refuse

SWUNG = swing(rows=60)


def refuse_fit(model: object, *words: str, data: dict = ROLL, **options: object) -> None:
    refuse(lambda: sepcal.fit(model, data, samples=5, **options), *words)


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"states": {}}, ("Spoiled", "no states", "SeparableModel")),
        ({"outputs": {}}, ("Spoiled", "no outputs")),
        ({"states": {"p": 1}}, ("Spoiled.states", "'p'", "unit")),
        ({"inputs": {"aileron": ("rad", 0, 1)}}, ("Spoiled", "'aileron'", "bounds")),
        ({"linear_dynamic": ["Lx"]}, ("Spoiled.linear_dynamic", "'Lx'", "nonlinear", "Lp, La")),
        ({"linear_dynamic": "La"}, ("Spoiled.linear_dynamic", "'La'", "list of names")),
        ({"acts_on": {"b_p": ["q_m"]}}, ("Spoiled.acts_on", "'q_m'", "outputs", "p_m")),
        ({"acts_on": {"b": ["p_m"]}}, ("Spoiled.acts_on", "'b'", "linear", "b_p")),
        ({"scales": ["k"]}, ("Spoiled.scales", "'k'", "linear")),
        ({"noise": {"w": "1"}}, ("Spoiled.noise", "'w'", "states", "p")),
        ({"nonlinear": {"p_0": ("1/s", -1, 1), "La": "1"}}, ("'p_0'", "two parameters")),
    ],
)
def test_tables_that_are_none(parts: dict[str, object], words: tuple[str, ...]) -> None:
    refuse_fit(type("Spoiled", (RollMode,), parts)(), *words)


def test_what_is_no_model() -> None:
    refuse(
        lambda: sepcal.Trajectory(WindBox()), "WindBox", "states, rate", "help(sepcal.StateModel)"
    )
    refuse(lambda: sepcal.Trajectory(RollMode), "RollMode", "RollMode()")
    refuse_fit(RollMode, "RollMode()")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"inputs": "held"}, ("'held'", "'linear'", "'hold'")),
        ({"substeps": 0}, ("substeps", "at least 1")),
        ({"shoot": -1.0}, ("shoot",)),
        ({"measured": ["q"]}, ("state 'q'", "it has p")),
        ({"measured": ["p"]}, ("all states are measured",)),
        ({"measured": "p"}, ("measured is 'p'", "['p']")),
        ({"outputs": ["q_m"]}, ("output 'q_m'", "p_m")),
    ],
)
def test_options_that_fit_no_model(options: dict[str, object], words: tuple[str, ...]) -> None:
    refuse(lambda: sepcal.fit(sepcal.Trajectory(RollMode(), **options), ROLL), *words)


def test_an_option_that_there_is_not() -> None:
    with pytest.raises(TypeError, match="no option 'step'; it has: inputs, substeps"):
        sepcal.Trajectory(RollMode(), step=2)


def test_data_that_fit_no_trajectory() -> None:
    refuse_fit(
        RollMode(), "RollMode", "'time'", data={k: v for k, v in ROLL.items() if k != "time"}
    )
    refuse_fit(RollMode(), "time", "row", data={**ROLL, "time": ROLL["time"][::-1]})
    refuse(lambda: sepcal.fit_many(sepcal.Trajectory(RollMode(), shoot=1.0), [ROLL, ROLL]), "shoot")


@pytest.mark.parametrize(
    ("rate", "words"),
    [
        (lambda x, u, p: [], ("rate()", "(1, ", "0 in place of 1")),
        (lambda x, u, p: [x[0], x[0]], ("rate()", "2 in place of 1")),
        (lambda x, u, p: [x[0][:-1]], ("rate()", "an entry has the shape")),
        (lambda x, u, p: None, ("rate()", "NoneType")),
        (lambda x, u, p: [x[0] + 0j], ("rate()", "complex128", "real")),
        (lambda x, u, p: ["a"], ("rate()", "<U1", "real")),
    ],
)
def test_rates_of_another_form(rate: Callable[..., object], words: tuple[str, ...]) -> None:
    spoiled = type("Spoiled", (RollMode,), {"rate": staticmethod(rate)})
    refuse_fit(spoiled(), "Spoiled", *words)


@pytest.mark.parametrize(
    ("at", "words"),
    [
        (lambda x, u, p: [x[0]], ("at()", "list", "tuple of A and b")),
        (lambda x, u, p: ([[1.0, 1.0]], [x[0]]), ("A of at()", "(n_z, n_1, N)", "2 in place of 1")),
        (lambda x, u, p: ([1.0], [x[0]]), ("A of at()", "float")),
        (lambda x, u, p: ([[1.0]], x[0]), ("b of at()", "(n_z, N)")),
    ],
)
def test_outputs_of_another_form(at: Callable[..., object], words: tuple[str, ...]) -> None:
    spoiled = type("Spoiled", (RollMode,), {"at": staticmethod(at)})
    refuse_fit(spoiled(), "Spoiled", *words)


def test_a_start_of_another_form() -> None:
    spoiled = type("Spoiled", (Pendulum,), {"start": lambda self, u, z: [z.x_m]})
    refuse_fit(spoiled(), "Spoiled: start()", "(2,)", data=SWUNG)


@pytest.mark.parametrize(
    "model",
    [
        sepcal.FlightPath(),
        sepcal.ShortPeriod(separable=False),
        sepcal.Trajectory(RollMode(), separable=False),
        Pendulum(),
    ],
)
def test_a_record_without_rows(model: object) -> None:
    names = "time ax ay az p q r airspeed roll pitch yaw vn ve vd aileron p_m elevator "
    names += "alpha beta alpha_m q_m az_m u x_m v_m"
    refuse_fit(model, "no rows", data={name: np.zeros(0) for name in names.split()})


def test_a_rate_that_is_not_set() -> None:
    class Half(ShortPeriod):
        def rate(self, x, u, p):
            answer = np.full_like(x, np.nan)
            answer[0] = x[1]
            return answer

    refuse_fit(Half(), "every state's rate", data=short_period_at_rest())


def test_what_is_called_linear_and_is_not() -> None:
    class Bent(RollMode):
        def rate(self, x, u, p):
            return [p[0] * x[0] + p[1] ** 2 * u.aileron]

    class Square(RollMode):
        def at(self, x, u, p):
            return [[1.0]], [x[0] ** 2]

    refuse_fit(Bent(), "'La'", "linear")
    refuse_fit(Square(), "linear")


def test_what_is_not_the_same_twice() -> None:
    class Drifting(RollMode):
        calls = 0

        def rate(self, x, u, p):
            self.calls += 1
            return [p[0] * x[0] + p[1] * u.aileron + 1e-3 * self.calls]

    refuse_fit(Drifting(), "differs between two evaluations")


def test_exceptions_of_a_model_pass_as_they_are() -> None:
    class Broken(RollMode):
        def rate(self, x, u, p):
            raise ZeroDivisionError("of the model")

    with pytest.raises(ZeroDivisionError, match="of the model"):
        sepcal.fit(Broken(), ROLL)


def test_what_runs_away_is_said() -> None:
    class Unstable(RollMode):
        nonlinear = {"Lp": ("1/s", 200, 300), "La": "1/s^2"}

    time = np.linspace(0, 30, 301)
    data = {"time": time, "aileron": np.ones(301), "p_m": np.zeros(301)}
    refuse_fit(Unstable(), "shoot", "runs away", data=data)


def test_parameters_are_not_the_models_to_change() -> None:
    class Careless(RollMode):
        def rate(self, x, u, p):
            answer = super().rate(x, u, p)
            x[:] = 0.0
            return answer

    found = sepcal.fit(Careless(), ROLL, samples=10)
    assert np.array_equal(found.values, sepcal.fit(RollMode(), ROLL, samples=10).values)

    class Worse(RollMode):
        def rate(self, x, u, p):
            p[:] = 0.0

    with pytest.raises(ValueError, match="read-only"):
        sepcal.fit(Worse(), ROLL)


def short_period_at_rest() -> dict:
    time = np.linspace(0, 1, 30)
    zero = np.zeros(30)
    names = (*ShortPeriod.inputs, *ShortPeriod.outputs)
    return {"time": time, **dict.fromkeys(names, zero)}


def fly_unstable(seconds: float, interval: float = 0.02) -> dict[str, np.ndarray]:
    """A short period with Ma = 40, held by feedback: its errors grow by e^4.6 a second."""
    rng = np.random.default_rng(0)
    time = np.arange(round(seconds / interval)) * interval
    F, B = np.array([[-1.5, 1.0], [40.0, -2.0]]), np.array([-0.1, -20.0])
    x, states, elevator = np.array([0.02, 0.0]), [], []
    for t in time:
        command = 0.03 * np.sign(np.sin(2.0 * np.pi * t / 3.0)) + 0.02 * np.sin(4.0 * t)
        elevator.append(3.0 * x[0] + x[1] + command)
        states.append(x)
        for _ in range(10):  # of Euler with half a step ahead, the elevator held
            half = x + 0.05 * interval * (F @ x + B * elevator[-1])
            x = x + 0.1 * interval * (F @ half + B * elevator[-1])
    alpha, q = np.array(states).T
    noise = rng.standard_normal((3, len(time)))
    return {
        "time": time,
        "elevator": np.array(elevator),
        "airspeed": np.full(len(time), 50.0),
        "alpha_m": alpha + 0.002 * noise[0],
        "q_m": q + 0.004 * noise[1],
        "az_m": 50.0 * (-1.5 * alpha - 0.1 * np.array(elevator)) + 0.1 * noise[2],
    }


@pytest.mark.parametrize("seconds", [30.0, 40.0, 60.0])
def test_an_unstable_aircraft_over_a_long_segment(seconds: float) -> None:
    """Wherever the fit ends, unstable or at a bound: it says so, and what to do."""
    data = fly_unstable(seconds)
    bounds = {"Ma": (-200.0, 100.0)}
    fit = sepcal.fit(sepcal.ShortPeriod(inputs="hold"), data, bounds=bounds, threads=1)
    assert fit.status != "converged"
    assert "shoot" in fit.message.split(";")[0]


def test_an_unstable_aircraft_in_pieces() -> None:
    model = sepcal.ShortPeriod(inputs="hold", shoot=1.0)
    fit = sepcal.fit(model, fly_unstable(10.0), bounds={"Ma": (-200.0, 100.0)}, threads=1)
    assert fit.status == "converged"
    for name, truth in {"Ma": 40.0, "Md": -20.0, "Mq": -2.0}.items():
        assert abs(fit[name].value - truth) < 4.0 * fit[name].standard_error
