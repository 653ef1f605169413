# SPDX-License-Identifier: BSD-3-Clause
"""sepcal's own models with a state, from Python: FlightPath and ShortPeriod."""

import pickle

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import sepcal
from refusals import refuse

ANGLES = ["airspeed", "beta", "alpha", "roll", "pitch", "yaw"]
ERRORS = {
    "b_ax": 0.15, "b_ay": -0.1, "b_az": 0.2, "b_p": 2e-3, "b_q": -3e-3, "b_r": 1.5e-3,
    "lambda_v": 0.03, "b_beta": 3e-3, "lambda_beta": 0.05, "lambda_alpha": -0.08,
}  # fmt: skip
WIND = (3.0, -2.0, 0.3)


def fly(rows: int = 1200, seed: int = 0) -> dict[str, np.ndarray]:
    """A motion that is written down: what the unit reads follows from its derivatives by hand."""
    rng, t = np.random.default_rng(seed), 0.02 * np.arange(rows)

    def waves(offset: float, *parts: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
        value = offset + sum(a * np.sin(w * t + c) for a, w, c in parts)
        return value, sum(a * w * np.cos(w * t + c) for a, w, c in parts)

    (u, du), (v, dv) = waves(50, (4, 0.5, 0.3), (1, 1.9, 1)), waves(0.5, (2, 0.8, 0.1), (1, 2.7, 2))
    w, dw = waves(3, (2, 1.1, 0.7), (1, 3.1, 0.2))
    roll, droll = waves(0.05, (0.5, 0.6, 0.2), (0.2, 2.1, 1.1))
    pitch, dpitch = waves(0.06, (0.15, 0.9, 0.4), (0.06, 2.3, 0.8))
    yaw, dyaw = waves(0.4, (0.8, 0.4, 0.6), (0.05, 1.7, 0.1))
    p = droll - dyaw * np.sin(pitch)
    q = dpitch * np.cos(roll) + dyaw * np.cos(pitch) * np.sin(roll)
    r = -dpitch * np.sin(roll) + dyaw * np.cos(pitch) * np.cos(roll)
    g = 9.80665
    force = {
        "ax": du + q * w - r * v + g * np.sin(pitch),
        "ay": dv + r * u - p * w - g * np.sin(roll) * np.cos(pitch),
        "az": dw + p * v - q * u - g * np.cos(roll) * np.cos(pitch),
    }
    data = {name: value - ERRORS["b_" + name] for name, value in force.items()}
    data |= {n: value - ERRORS["b_" + n] for n, value in (("p", p), ("q", q), ("r", r))}
    airspeed = np.sqrt(u**2 + v**2 + w**2)
    true = (airspeed, np.arcsin(v / airspeed), np.arctan2(w, u), roll, pitch, yaw)
    for name, of, value, sigma in zip(
        ANGLES,
        ("v", "beta", "alpha", "phi", "theta", "psi"),
        true,
        (0.2, *[0.002] * 5),
        strict=True,
    ):
        read = (1 + ERRORS.get("lambda_" + of, 0)) * value + ERRORS.get("b_" + of, 0)
        data[name] = read + sigma * rng.standard_normal(rows)
    return {"time": t, **data}


FLIGHT = fly()


@pytest.fixture(scope="module")
def path() -> sepcal.Fit:
    return sepcal.fit(sepcal.FlightPath(outputs=ANGLES), FLIGHT, samples=20)


def test_a_flight_path_comes_back_without_a_start(path: sepcal.Fit) -> None:
    """Initial states begin at the first readings; b_v, b_alpha, b_psi are held: it says so."""
    assert path.status == "converged"
    for name in (n for n in path.names if not n.endswith("_0") and not path[n].fixed):
        error = path[name].standard_error
        assert abs(path[name].value - ERRORS.get(name, 0.0)) < 4 * error, name
    held = [name for name in path.names if path[name].fixed]
    assert held == ["b_v", "b_alpha", "b_psi"]
    assert "b_v, b_alpha, b_psi" in path.message
    assert "held at zero" in path.message


def test_what_is_held_can_be_freed() -> None:
    model = sepcal.FlightPath(outputs=ANGLES)
    fit = sepcal.fit(model, FLIGHT, samples=10, free=["b_v", "b_alpha", "b_psi"])
    assert fit.status == "not_identifiable"
    assert set(fit.unobservable[0].parameters) == {"b_psi", "psi_0"}
    refuse(lambda: sepcal.fit(model, FLIGHT, free=["b_x"]), "b_x", "no such parameter")
    given = sepcal.fit(model, FLIGHT, samples=10, fix={"b_v": 0.1})
    assert given["b_v"].value == 0.1
    assert "b_v" not in given.message.replace("b_alpha, b_psi", "")


def test_what_is_not_measured_leaves() -> None:
    few = sepcal.FlightPath(outputs=["airspeed", "alpha", "pitch"], measured=["v", "phi", "psi"])
    assert few.outputs == ("airspeed", "alpha", "pitch")
    assert few.linear == (
        "lambda_v", "lambda_alpha", "lambda_theta", "b_v", "b_alpha", "b_theta"
    )  # fmt: skip
    assert few.inputs == ("ax", "ay", "az", "p", "q", "r", "v", "phi", "psi", "time")
    with_position = sepcal.FlightPath(outputs=["north", "east", "down"], position=True)
    assert with_position.states[-3:] == ("x", "y", "z")
    assert with_position.nonlinear[6:9] == ("w_n", "w_e", "w_d")


def test_intervals_and_predictions(path: sepcal.Fit) -> None:
    model = sepcal.FlightPath(outputs=ANGLES)
    value = sepcal.predict(model, FLIGHT, path).value
    rms = np.sqrt(np.mean((value[:, 0] - FLIGHT["airspeed"]) ** 2))
    assert rms == pytest.approx(path.rmse["airspeed"], rel=1e-9)
    A, b = model.evaluate(FLIGHT, path.values[path.n_1 :])
    assert_allclose(A @ path.values[: path.n_1] + b, value, rtol=0, atol=1e-9)


def test_several_flights_each_with_its_start() -> None:
    flights = {"one": fly(500, 1), "two": fly(600, 2)}
    states = [f"{name}_0" for name in ("u", "v", "w", "phi", "theta", "psi")]
    many = sepcal.fit_many(sepcal.FlightPath(outputs=ANGLES), flights, own=states, samples=10)
    assert many.status == "converged"
    for name in ("b_ax", "b_q"):
        assert abs(many[name].value - ERRORS[name]) < 4 * many[name].standard_error


@pytest.mark.parametrize(
    ("column", "change", "words"),
    [
        ("az", lambda x: -x, ("az", "-9.81")),
        ("pitch", np.degrees, ("degrees", "pitch")),
        ("q", lambda x: 1e3 * x, ("'q'", "degrees")),
        ("time", lambda x: x[::-1], ("time",)),
    ],
)
def test_flights_that_are_none(column: str, change: object, words: tuple[str, ...]) -> None:
    data = {**FLIGHT, column: np.ascontiguousarray(change(FLIGHT[column]))}  # type: ignore[operator]
    refuse(lambda: sepcal.fit(sepcal.FlightPath(outputs=ANGLES), data), *words)


def test_a_missing_channel_is_named() -> None:
    data = {name: column for name, column in FLIGHT.items() if name != "az"}
    refuse(lambda: sepcal.fit(sepcal.FlightPath(outputs=ANGLES), data), "FlightPath", "'az'")
    refuse(lambda: sepcal.FlightPath(outputs=["speed"]), "'speed'", "airspeed, beta")
    refuse(lambda: sepcal.FlightPath(outputs="airspeed"), "outputs is 'airspeed'", "['airspeed']")
    refuse(lambda: sepcal.FlightPath(vane=(1.0, 2.0)), "vane has 2 numbers")


@pytest.mark.parametrize(
    ("model", "text"),
    [
        (sepcal.ShortPeriod(), "ShortPeriod()"),
        (sepcal.ShortPeriod(inputs="hold", shoot=2.0), "ShortPeriod(inputs='hold', shoot=2.0)"),
        (
            sepcal.FlightPath(outputs=["alpha"], gravity=9.8, vane=(1, 0, 0)),
            "FlightPath(outputs=('alpha',), gravity=9.8, vane=(1.0, 0.0, 0.0))",
        ),
        (sepcal.FlightPath(position=True), "FlightPath(position=True)"),
    ],
)
def test_a_model_says_what_it_is_and_travels(model: sepcal.TrajectoryModel, text: str) -> None:
    assert repr(model) == text
    other = pickle.loads(pickle.dumps(model))
    assert repr(other) == text
    assert other.parameters == model.parameters
    assert_array_equal(list(other.bounds.values()), list(model.bounds.values()))
