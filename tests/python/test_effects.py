# SPDX-License-Identifier: BSD-3-Clause
"""Effects by name from Python: on flights, on any model's data, added one after the other."""

import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares

import sepcal
from own_models import WindBox, simulate_wind_box
from refusals import refuse

PROBE = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
MAGNETOMETER = sepcal.Magnetometer(field=(19.7, -1.4, 49.4))
HIDDEN = {"wind[altitude_m]": 0.02, "pressure_offset[throttle]": 8.0}
TIGHT = {"ftol": 1e-15, "xtol": 1e-15, "gtol": 1e-15}


@pytest.fixture(scope="module")
def flight() -> sepcal.Flight:
    """Wind shear and propwash."""
    return sepcal.simulate(PROBE, rows=600, seed=1, hide=HIDDEN)


@pytest.fixture(scope="module")
def base(flight: sepcal.Flight) -> sepcal.Calibration:
    """Fitted without them."""
    return sepcal.fit(PROBE, flight)


@pytest.fixture(scope="module")
def better(base: sepcal.Calibration) -> sepcal.Calibration:
    """Both of them added, one by its alias."""
    return base.add("wind_shear").add("propwash")


def total_rmse(calibration: sepcal.Calibration) -> float:
    """Over all outputs together."""
    return float(np.sqrt(np.mean(calibration.compare().residuals ** 2)))


# --- flights


def test_hidden_effects_are_estimated(flight: sepcal.SimulatedFlight) -> None:
    """Within five standard errors of the truth: a false alarm in a million."""
    fit = sepcal.fit(PROBE, flight, effects=list(HIDDEN))
    assert fit.status == "converged", fit.message
    assert [effect.name for effect in fit.effects] == list(HIDDEN)
    for name in fit.names:
        assert abs(fit[name].value - flight.truth[name]) < 5 * fit[name].standard_error, name
    assert set(fit.names) - set(PROBE.parameters) == {
        "wind[altitude_m].n",
        "wind[altitude_m].e",
        "pressure_offset[throttle].s",
    }


def test_what_effects_took_from_the_record(flight: sepcal.Flight) -> None:
    names = ["wind[altitude_m]", "wind[spline(time,5)]", "airspeed_scale[alpha^2]"]
    shear, smooth, loss = sepcal.fit(PROBE, flight, effects=names).effects
    time, altitude = flight["time_s"], flight["altitude_m"]
    assert shear.centre == pytest.approx(altitude.mean(), rel=1e-12)
    assert (shear.knots, shear.labels, shear.span, shear.t0) == ((), (), None, None)
    assert_allclose(smooth.knots, np.linspace(time[0], time[-1], 5), rtol=1e-12)
    assert smooth.centre is None
    assert loss.centre == 0.0


def test_the_time_of_a_step() -> None:
    hide = {"bias_step": (3.0, -2.0, 4.0, 20.0)}
    flight = sepcal.simulate(MAGNETOMETER, rows=600, seed=2, hide=hide)
    (step,) = sepcal.fit(MAGNETOMETER, flight, effects=["bias_step"]).effects
    time = flight["time_s"]
    assert step.span == (time[0], time[-1])
    assert step.t0 is not None
    assert abs(step.t0 - 20.0) < 2 * np.diff(time).max()


def test_labels_in_order(flight: sepcal.Flight) -> None:
    (by_label,) = sepcal.fit(PROBE, flight, effects=["wind[maneuver]"]).effects
    assert by_label.labels == tuple(dict.fromkeys(flight.maneuvers))


def test_several_in_one_name(flight: sepcal.Flight) -> None:
    one = sepcal.fit(PROBE, flight, effects=["wind_shear+propwash"])
    two = sepcal.fit(PROBE, flight, effects=["wind[altitude_m]", "pressure_offset[throttle]"])
    assert one.to_json() == two.to_json()


def test_no_effects_are_no_effects(flight: sepcal.Flight, base: sepcal.Calibration) -> None:
    assert base.effects == base.history == base.own_effects == []
    assert sepcal.fit(PROBE, flight, effects=[]).to_json() == base.to_json()
    assert sepcal.fit(PROBE, flight, effects=None).to_json() == base.to_json()


# --- adding


def test_adding_one_after_the_other(
    flight: sepcal.Flight, base: sepcal.Calibration, better: sepcal.Calibration
) -> None:
    """As both at once; the history tells each step's errors, as the residuals have them."""
    at_once = sepcal.fit(PROBE, flight, effects=list(HIDDEN))
    errors = np.sqrt(np.diag(at_once.covariance))
    assert better.names == at_once.names
    assert_allclose(better.values / errors, at_once.values / errors, rtol=0, atol=1e-5)
    first, second = better.history
    assert [first.effect, second.effect] == list(HIDDEN)
    assert first.rmse_before == pytest.approx(total_rmse(base), rel=1e-12)
    assert first.rmse_after == pytest.approx(total_rmse(base.add("wind_shear")), rel=1e-12)
    assert second.rmse_before == first.rmse_after
    assert second.rmse_after == pytest.approx(total_rmse(better), rel=1e-12)
    assert second.rmse_after < second.rmse_before < first.rmse_before
    for entry in (first, second):
        assert entry.rmse_before
        assert entry.rmse_after
        assert entry.held_out_before
        assert entry.predicted_drop == pytest.approx(1 - entry.rmse_after / entry.rmse_before, 0.05)
        assert entry.held_out_after is not None
        assert entry.held_out_after < entry.held_out_before
    assert base.history == []


def test_adding_two_at_once_is_one_step(base: sepcal.Calibration) -> None:
    pair = base.add("wind_shear + propwash")
    (step,) = pair.history
    assert step.effect == "wind[altitude_m]+pressure_offset[throttle]"
    assert [effect.name for effect in pair.effects] == list(HIDDEN)


def test_adding_to_a_loaded_calibration(
    flight: sepcal.Flight, base: sepcal.Calibration, better: sepcal.Calibration, tmp_path: Path
) -> None:
    base.add("wind_shear").save(tmp_path / "base.json")
    loaded = sepcal.load(tmp_path / "base.json")
    assert loaded.add("propwash", flight).to_json() == better.to_json()
    refuse(lambda: loaded.add("propwash"), "no flight", "add(..., sepcal.read_csv('")


def test_effects_that_cannot_be_added(base: sepcal.Calibration) -> None:
    refuse(lambda: base.add("wind_shear").add("wind[altitude_m]"), "wind[altitude_m]", "already")
    refuse(lambda: base.add("gremlins"), "'gremlins'", "wind[driver]", "heading_bias")
    refuse(lambda: base.add(""), "name is missing")


# --- kept


def test_a_calibration_with_effects_is_kept(
    flight: sepcal.Flight, better: sepcal.Calibration, tmp_path: Path
) -> None:
    better.save(tmp_path / "better.json")
    for kept in (sepcal.load(tmp_path / "better.json"), pickle.loads(pickle.dumps(better))):
        assert kept.to_json() == better.to_json()
        assert (kept.effects, kept.history) == (better.effects, better.history)
        assert_array_equal(kept.compare(flight).residuals, better.compare().residuals)
        for header, values in better.apply(flight).items():
            assert_array_equal(kept.apply(flight)[header], values)


# --- any model's data


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


def test_the_record_of_a_flight(flight: sepcal.Flight) -> None:
    """A probe's effects on plain columns are those on a flight."""
    own = {*PROBE.inputs, *PROBE.outputs, "time"}
    bare = {header: header.rpartition("_")[0] for header in flight}
    record = {
        name if (name := bare[header]) in own else header: values
        for header, values in flight.items()
    }
    as_flight = sepcal.fit(PROBE, flight, effects=list(HIDDEN))
    as_record = sepcal.fit(PROBE, {**record, "maneuver": flight.maneuvers}, effects=list(HIDDEN))
    assert as_record.effects == as_flight.effects
    assert_array_equal(as_record.values, as_flight.values)


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
        ("k", ("'k'", "k[driver]")),
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


# --- the catalogue


@pytest.mark.parametrize(
    ("probe", "some"),
    [
        (PROBE, {"wind[altitude_m]", "heading_bias", "time_offset"}),
        (sepcal.PitotStatic(), {"wind[time]", "pneumatic_lag"}),
        (MAGNETOMETER, {"bias[current_a]", "cubic_nonlinearity"}),
        (sepcal.Magnetometer(field_strength=50.0), {"bias_step"}),
    ],
)
def test_the_catalogue(probe: sepcal.FiveHoleProbe, some: set[str]) -> None:
    listed = sepcal.effects(probe)
    assert listed == sepcal.effects(probe.name)
    names = [effect.name for effect in listed]
    assert some <= set(names)
    assert len(set(names)) == len(names)
    assert all(effect.equation and effect.drivers and effect.unit for effect in listed)


def test_the_catalogue_of_nothing() -> None:
    refuse(lambda: sepcal.effects("pendulum"), "'pendulum'", "five-hole", "magnetometer-norm")
