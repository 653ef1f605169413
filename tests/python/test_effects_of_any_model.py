# SPDX-License-Identifier: BSD-3-Clause
"""Effects by name on any model's data: the same minimum as SciPy's, what is left out or refused."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares

import sepcal
from own_models import WindBox, simulate_wind_box
from refusals import refuse

TIGHT = {"ftol": 1e-15, "xtol": 1e-15, "gtol": 1e-15}


def box_with(size: float, of: str) -> dict[str, np.ndarray]:
    """A flight along a box in which something drifts with temperature or time."""
    box = simulate_wind_box(800, seed=4)
    time = np.linspace(0.0, 80.0, 800)
    temperature = 15.0 + 10.0 * np.sin(time / 9.0) + time / 20.0
    extra = {"k": size * (temperature - temperature.mean()), "w_n": size * np.sin(time / 12.0)}
    if of == "k":
        box["vn"] = box["vn"] + extra["k"] * box["v"] * np.cos(box["psi"] + 0.06)
        box["ve"] = box["ve"] + extra["k"] * box["v"] * np.sin(box["psi"] + 0.06)
    else:
        box["vn"] = box["vn"] + extra["w_n"]
    return {**box, "time": time, "temp_degc": temperature}


def solve(
    predict: Callable[[np.ndarray], np.ndarray], measured: np.ndarray, start: list[float]
) -> tuple[np.ndarray, np.ndarray]:
    """What SciPy finds, and its standard errors at a noise of 0.3 m/s."""
    found = least_squares(
        lambda xi: (measured - predict(xi)) / 0.3, start, jac="3-point", x_scale="jac", **TIGHT
    )
    return found.x, np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac)))


def test_effects_on_linear_parameters_of_any_model() -> None:
    """Scale follows the temperature, w_n a spline of time: the same minimum as SciPy's."""
    box = box_with(0.002, "k")
    fit = sepcal.fit(
        WindBox(),
        box,
        effects=["k[temp_degc]", "w_n[spline(time,6)]"],
        noise={"vn": 0.3, "ve": 0.3},
    )
    knots = np.linspace(0.0, 80.0, 6)
    cardinal = CubicSpline(knots, np.eye(6), bc_type="natural")(box["time"])[:, 1:]
    cardinal -= cardinal.mean(axis=0)  # the model's own w_n is that of the flight
    warmer = box["temp_degc"] - box["temp_degc"].mean()

    def predict(xi: np.ndarray) -> np.ndarray:
        k, w_n, w_e, by_temperature, *smooth, delta = xi
        speed = (k + by_temperature * warmer) * box["v"]
        north = speed * np.cos(box["psi"] + delta) + w_n + cardinal @ smooth
        return np.concatenate([north, speed * np.sin(box["psi"] + delta) + w_e])

    measured = np.concatenate([box["vn"], box["ve"]])
    expected, errors = solve(predict, measured, [1.0] + [0.0] * 9)
    assert fit.status == "converged"
    assert fit.names == (
        *("k", "w_n", "w_e", "k[temp_degc].s"),
        *(f"w_n[spline(time,6)].s_{k}" for k in range(2, 7)),
        "delta",
    )
    assert_allclose(fit.values / errors, expected / errors, rtol=0, atol=1e-5)
    white = [fit[name].standard_error_white for name in fit.names]
    assert_allclose(white, errors, rtol=1e-5)
    assert [effect.centre for effect in fit.effects] == [
        pytest.approx(box["temp_degc"].mean(), rel=1e-12),
        None,
    ]


def test_an_effect_on_an_input_of_any_model() -> None:
    """The airspeed as read is off by s (T - T0): the coefficient is nonlinear."""
    box = box_with(0.003, "k")
    fit = sepcal.fit(WindBox(), box, effects=["v[temp_degc]"], noise={"vn": 0.3, "ve": 0.3})
    warmer = box["temp_degc"] - box["temp_degc"].mean()

    def predict(xi: np.ndarray) -> np.ndarray:
        k, w_n, w_e, delta, by_temperature = xi
        speed = k * (box["v"] + by_temperature * warmer)
        return np.concatenate(
            [
                speed * np.cos(box["psi"] + delta) + w_n,
                speed * np.sin(box["psi"] + delta) + w_e,
            ]
        )

    measured = np.concatenate([box["vn"], box["ve"]])
    expected, errors = solve(predict, measured, [1.0, 0.0, 0.0, 0.0, 0.0])
    assert fit.status == "converged"
    assert fit.names[-1] == "v[temp_degc].s"
    assert_allclose(fit.values / errors, expected / errors, rtol=0, atol=1e-5)


def test_effects_on_a_compiled_model() -> None:
    """Of the scalar example z = (1 + a) cos(eta (1 + b) + c) + d, the offset drifts."""
    rng = np.random.default_rng(5)
    time = np.linspace(0.0, 10.0, 400)
    eta = rng.uniform(0.0, 6.0, 400)
    z = 1.1 * np.cos(1.05 * eta + 0.2) + 0.4 + 0.03 * (time - 5.0)
    z = z + 0.01 * rng.standard_normal(400)
    fit = sepcal.fit(
        sepcal.ScalarExample2(),
        {"eta": eta, "z": z, "time": time},
        effects=["d[time]"],
        bounds={"b": (-0.3, 0.3), "c": (-1.0, 1.0)},
    )
    found = least_squares(
        lambda xi: (
            z
            - (1 + xi[0]) * np.cos(eta * (1 + xi[3]) + xi[4])
            - xi[1]
            - xi[2] * (time - time.mean())
        ),
        [0.0, 0.0, 0.0, 0.0, 0.0],
        jac="3-point",
        **TIGHT,
    )
    assert fit.names == ("a", "d", "d[time].s", "b", "c")
    assert_allclose(fit.values, found.x, rtol=0, atol=1e-7)


def test_a_step_in_any_model() -> None:
    """Found where it was put, between two rows."""
    box = box_with(0.0, "k")
    box["vn"] = box["vn"] + 1.5 * (box["time"] >= 47.0)
    fit = sepcal.fit(WindBox(), box, effects=["w_n[step(time)]"])
    assert fit["w_n[step(time)].t0"].fixed
    assert abs(fit["w_n[step(time)].t0"].value - 47.0) < 0.1
    assert fit.effects[0].t0 == fit["w_n[step(time)].t0"].value


def test_a_step_on_an_input_of_any_model() -> None:
    """The indicator jumps: at zero size the cost doesn't know when, its slopes do."""
    box = box_with(0.0, "k")
    jump = 1.05 * 0.8 * (box["time"] >= 47.0)
    box["vn"] = box["vn"] + jump * np.cos(box["psi"] + 0.06)
    box["ve"] = box["ve"] + jump * np.sin(box["psi"] + 0.06)
    fit = sepcal.fit(WindBox(), box, effects=["v[step(time)]"])
    size = fit["v[step(time)].s"]
    assert abs(fit["v[step(time)].t0"].value - 47.0) < 0.5
    assert abs(size.value - 0.8) < 5 * size.standard_error


def test_rows_at_the_edges_are_left_out_where_a_driver_is_late() -> None:
    box = box_with(0.002, "k")
    fit = sepcal.fit(WindBox(), box, effects=["k[delay(temp_degc)]"])
    time = box["time"]
    assert fit.rows == np.count_nonzero((time >= time[0] + 0.2) & (time <= time[-1] - 0.2))


def test_columns_that_drive_nothing_are_ignored() -> None:
    box = box_with(0.002, "k")
    plain = sepcal.fit(WindBox(), box, effects=["k[temp_degc]"])
    more = {**box, "note": ["x"] * 800, "table": np.zeros((800, 2)), "count": np.arange(800)}
    assert_array_equal(sepcal.fit(WindBox(), more, effects=["k[temp_degc]"]).values, plain.values)
    whole = {**box, "temp_degc": np.round(box["temp_degc"]).astype(int)}
    real = {**box, "temp_degc": np.round(box["temp_degc"])}
    assert_array_equal(
        sepcal.fit(WindBox(), whole, effects=["k[temp_degc]"]).values,
        sepcal.fit(WindBox(), real, effects=["k[temp_degc]"]).values,
    )


# --- what is refused


@pytest.mark.parametrize(
    ("effect", "words"),
    [
        ("k[temp_k]", ("k[temp_k]", "'temp_k'", "temp_degc")),
        ("lift[time]", ("'lift[time]'", "k[driver]", "v[driver]")),
        ("k[note]", ("WindBox", "'note'", "not numbers")),
        ("k[flat]", ("'flat'", "constant")),
        ("k[gap]", ("'gap'", "finite")),
        ("k[time^0]", ("k[time^0]", "1 to 9")),
        ("k[short]", ("'short'", "7", "800")),
        ("k", ("'k'", "needs a driver", "k[time]")),
    ],
)
def test_effects_that_are_refused(effect: str, words: tuple[str, ...]) -> None:
    box = {**box_with(0.0, "k"), "note": ["x"] * 800, "flat": np.ones(800)}
    box["gap"] = np.where(np.arange(800) == 3, np.nan, box["time"])
    if "short" in effect:
        box["short"] = np.arange(7)
    refuse(lambda: sepcal.fit(WindBox(), box, effects=[effect]), *words)


def test_an_effect_twice() -> None:
    box = box_with(0.0, "k")
    refuse(lambda: sepcal.fit(WindBox(), box, effects=["k[time]", "k[time]"]), "k[time].s")


@pytest.mark.parametrize("effects", ["k[time]", [3], ["k[time]", None]])
def test_effects_of_another_kind(effects: object) -> None:
    with pytest.raises(TypeError, match=r"effects=.*list of names"):
        sepcal.fit(WindBox(), box_with(0.0, "k"), effects=effects)
