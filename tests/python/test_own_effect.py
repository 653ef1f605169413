# SPDX-License-Identifier: BSD-3-Clause
"""Effects of one's own: against the built-in ones, on every flight, kept."""

import copy
import gc
import pickle
import weakref
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import sepcal
from motor_effect import MAGNETOMETER, MOTOR, Columns, current, simulate_motor
from own_models import WindBox, simulate_wind_box
from refusals import refuse


@pytest.fixture(scope="module")
def flight() -> sepcal.Flight:
    """A motor's current bends the field."""
    return simulate_motor(rows=500, seed=1)


@pytest.fixture(scope="module")
def other() -> sepcal.Flight:
    """Another flight of the same sensor."""
    return simulate_motor(rows=300, seed=2)


@pytest.fixture(scope="module")
def built_in(flight: sepcal.Flight) -> sepcal.Calibration:
    """With sepcal's own effect."""
    return sepcal.fit(MAGNETOMETER, flight, effects=["bias[current_a]"])


@pytest.fixture(scope="module")
def own(flight: sepcal.Flight) -> sepcal.Calibration:
    """With the same effect made here."""
    return sepcal.fit(MAGNETOMETER, flight, effects=[MOTOR])


def assert_same_fit(own: sepcal.Fit, built_in: sepcal.Fit, tolerance: float) -> None:
    """Estimates to a tolerance in standard errors, which agree themselves."""
    free = ~np.isnan(np.diag(built_in.covariance))
    errors = np.sqrt(np.diag(built_in.covariance))[free]
    assert own.status == built_in.status
    difference = (own.values[free] - built_in.values[free]) / errors
    assert_allclose(difference, 0.0, atol=tolerance)
    assert_allclose(np.sqrt(np.diag(own.covariance))[free], errors, rtol=1e-8)


def assert_same_columns(own: Columns, built_in: Columns) -> None:
    """Corrected readings, NaN in the same rows."""
    assert list(own) == list(built_in)
    for header, values in built_in.items():
        assert np.isfinite(values).any()
        assert_allclose(own[header], values, rtol=1e-9, atol=1e-9)


# --- on a port: one value a row drives it


@pytest.mark.parametrize(
    ("probe", "port", "column", "components"),
    [
        (MAGNETOMETER, "bias", "current_a", "xyz"),
        (MAGNETOMETER, "scale", "current_a", "s"),
        (sepcal.Magnetometer(field_strength=53.2), "bias", "current_a", "xyz"),
        (sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5), "wind", "throttle", "ne"),
        (sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5), "pressure_offset", "throttle", "s"),
        (sepcal.PitotStatic(), "airspeed_bias", "throttle", "s"),
        (sepcal.PitotStatic(), "wind", "throttle", "ne"),
    ],
    ids=lambda value: value if isinstance(value, str) else getattr(value, "name", ""),
)
def test_on_a_port_it_is_the_built_in_effect(
    probe: sepcal.Magnetometer, port: str, column: str, components: str
) -> None:
    """The same numbers: one driver comes from the log, the other from a function of it."""
    log = sepcal.simulate(probe, rows=500, seed=3)
    mine = sepcal.Effect("mine", lambda record: record[column], port=port, unit="furlong")
    name = f"{port}[{column}]"
    built_in = sepcal.fit(probe, log, effects=[name])
    own = sepcal.fit(probe, log, effects=[mine])
    assert [one.replace("mine", name) for one in own.names] == list(built_in.names)
    assert {f"mine.{component}" for component in components} <= set(own.names)
    assert all(own[f"mine.{component}"].unit == "furlong" for component in components)
    assert_same_fit(own, built_in, 1e-12)
    assert own.cost == pytest.approx(built_in.cost, rel=1e-12)
    assert_same_columns(own.apply(log), built_in.apply(log))
    assert_array_equal(own.compare().residuals, built_in.compare().residuals)


@pytest.mark.parametrize(
    ("model", "port", "bounds"),
    [
        (WindBox(), "w_n", {}),
        (WindBox(), "v", {}),
        (sepcal.ScalarExample2(), "d", {"b": (-0.3, 0.3), "c": (-1.0, 1.0)}),
        (sepcal.ScalarExample2(), "eta", {"b": (-0.3, 0.3), "c": (-1.0, 1.0)}),
    ],
)
def test_on_a_port_of_any_model(
    model: sepcal.Model, port: str, bounds: dict[str, tuple[float, float]]
) -> None:
    """A linear parameter and an input, of a model in Python and of one in C++."""
    eta = np.linspace(0.0, 6.0, 600)
    z = 1.1 * np.cos(1.05 * eta + 0.2) + 0.4 + 0.02 * np.random.default_rng(0).normal(size=600)
    heat = np.sin(np.arange(600.0) / 40)
    data = {**simulate_wind_box(600, seed=5), "eta": eta, "z": z, "heat": heat}
    drift = sepcal.Effect("drift", lambda record: record["heat"], port=port)
    own = sepcal.fit(model, data, effects=[drift], bounds=bounds)
    built_in = sepcal.fit(model, data, effects=[f"{port}[heat]"], bounds=bounds)
    assert "drift.s" in own.names
    assert_same_fit(own, built_in, 1e-12)


# --- on the outputs: columns by component


def columns_of_bias(log: Columns) -> dict[str, np.ndarray]:
    """Current times the unit vector of each axis: (N, 3) by component."""
    axes = dict(zip("xyz", np.eye(3), strict=True))
    return {axis: np.outer(log["current_a"], row) for axis, row in axes.items()}


def test_on_the_outputs_it_is_the_built_in_effect(
    flight: sepcal.Flight, other: sepcal.Flight, built_in: sepcal.Calibration
) -> None:
    columns = sepcal.Effect("columns", columns_of_bias, unit="uT/A")
    own = sepcal.fit(MAGNETOMETER, flight, effects=[columns])
    assert [one.replace("columns", "bias[current_a]") for one in own.names] == [*built_in.names]
    assert own["columns.x"].unit == "uT/A"
    assert_same_fit(own, built_in, 1e-9)
    assert_same_columns(own.apply(other), built_in.apply(other))
    assert_allclose(own.compare(other).residuals, built_in.compare(other).residuals, atol=1e-9)


def test_one_output_takes_one_value_a_row() -> None:
    """(N,) is as good as (N, 1)."""
    eta = np.linspace(0.0, 6.0, 300)
    z = np.cos(eta) + 0.3 * np.sqrt(eta) + 0.01 * np.random.default_rng(1).normal(size=300)
    fits = [
        sepcal.fit(
            sepcal.ScalarExample1(),
            {"eta": eta, "z": z},
            effects=[sepcal.Effect("root", lambda u, axes=axes: {"s": np.sqrt(u["eta"])[axes]})],
        )
        for axes in (..., (..., np.newaxis))
    ]
    assert_array_equal(fits[0].values, fits[1].values)
    assert abs(fits[0]["root.s"].value - 0.3) < 5 * fits[0]["root.s"].standard_error


# --- what the function sees


def test_the_record_is_the_flight_in_si_units() -> None:
    probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5)
    log = sepcal.simulate(probe, rows=300)
    seen = {}

    def look(record: Columns) -> np.ndarray:
        seen.update(record)
        return record["throttle"]

    flight = sepcal.Flight(
        {
            "roll_deg" if header == "roll_rad" else header: np.rad2deg(values)
            if header == "roll_rad"
            else values
            for header, values in log.items()
        }
    )
    sepcal.fit(probe, flight, effects=[sepcal.Effect("look", look, port="wind")])
    gc.collect()
    assert_allclose(seen["roll"], log["roll_rad"], rtol=1e-12)
    assert_array_equal(seen["time"], log["time_s"])
    assert_array_equal(seen["pt"], log["pt_pa"])
    assert_array_equal(seen["altitude_m"], log["altitude_m"])
    assert all(values.shape == (300,) for values in seen.values())


def test_the_record_cannot_be_written_to(flight: sepcal.Flight) -> None:
    def spoil(record: Columns) -> np.ndarray:
        with pytest.raises(TypeError, match="item assignment"):
            record["current_a"] = np.zeros(500)
        with pytest.raises(ValueError, match="read-only"):
            record["current_a"][:] = 0.0
        with pytest.raises(KeyError, match=r"'amps' is missing; the record has: .*current_a"):
            record["amps"]
        assert "current_a" in record
        assert "amps" not in record
        assert len(record) == len(list(record)) > 5
        return record["current_a"]

    effect = sepcal.Effect("motor", spoil, port="bias")
    assert sepcal.fit(MAGNETOMETER, flight, effects=[effect]).status == "converged"


# --- every flight anew


def test_it_is_evaluated_on_every_flight(
    flight: sepcal.Flight,
    other: sepcal.Flight,
    built_in: sepcal.Calibration,
    own: sepcal.Calibration,
) -> None:
    """And corrects the readings: the field's strength is steadier than without it."""
    assert_array_equal(own.compare(other).residuals, built_in.compare(other).residuals)
    assert_same_columns(own.apply(other), built_in.apply(other))
    without = sepcal.fit(MAGNETOMETER, flight)
    strength = np.linalg.norm([other[name] for name in ("bn_ut", "be_ut", "bd_ut")], axis=0)
    with_motor, without_motor = (
        np.std(np.linalg.norm(list(one.apply(other).values()), axis=0) - strength)
        for one in (own, without)
    )
    assert with_motor < 0.9 * without_motor


def test_it_is_added_as_others_are(flight: sepcal.Flight, other: sepcal.Flight) -> None:
    base = sepcal.fit(MAGNETOMETER, flight)
    added, named = base.add(MOTOR), base.add("bias[current_a]")
    assert_same_fit(added, named, 1e-12)
    (step,), (expected,) = added.history, named.history
    assert step.effect == "motor"
    assert (step.rmse_before, step.rmse_after) == (expected.rmse_before, expected.rmse_after)
    assert base.own_effects == []
    assert added.own_effects == [MOTOR]
    longer = added.add("scale[temp_degc]", other)
    assert longer.own_effects == [MOTOR]
    assert [effect.name for effect in longer.effects] == ["motor", "scale[temp_degc]"]
    assert len(longer.history) == 2
    refuse(lambda: added.add(MOTOR), "motor", "already")


def test_rows_without_the_channel_are_left_empty(
    other: sepcal.Flight, own: sepcal.Calibration
) -> None:
    columns = {header: values.copy() for header, values in other.items()}
    columns["current_a"][7] = np.nan
    corrected = own.apply(sepcal.Flight(columns))
    for header, values in own.apply(other).items():
        empty = np.isnan(corrected[header])
        assert_array_equal(np.flatnonzero(empty), [7])
        assert_array_equal(corrected[header][~empty], values[~empty])


def test_apply_to_a_file(other: sepcal.Flight, own: sepcal.Calibration, tmp_path: Path) -> None:
    rows = zip(*(map(repr, map(float, other[header])) for header in other), strict=True)
    lines = [",".join(other), *(",".join(row) for row in rows)]
    (tmp_path / "flight.csv").write_text("\n".join(lines) + "\n")
    own.apply_to_file(tmp_path / "flight.csv", tmp_path / "corrected.csv")
    corrected = sepcal.read_csv(tmp_path / "corrected.csv")
    for header, values in own.apply(other).items():
        assert_array_equal(corrected[header], values)


# --- kept


def test_a_file_needs_the_effect_again(
    other: sepcal.Flight, own: sepcal.Calibration, tmp_path: Path
) -> None:
    file = tmp_path / "own.json"
    own.save(file)
    bare = sepcal.load(file)
    assert_array_equal(bare.values, own.values)
    assert [effect.name for effect in bare.effects] == ["motor"]
    for work in (
        lambda: bare.compare(other),
        lambda: bare.apply(other),
        lambda: bare.add("bias[time]", other),
        lambda: bare.apply_to_file(file, tmp_path / "corrected.csv"),
    ):
        refuse(work, "motor", "own", 'sepcal.load(file, effects=[sepcal.Effect("motor", ...)])')
    whole = sepcal.load(file, effects=[MOTOR])
    assert whole.own_effects == [MOTOR]
    assert whole.to_json() == own.to_json()
    assert_array_equal(whole.compare(other).residuals, own.compare(other).residuals)
    assert_same_columns(whole.apply(other), own.apply(other))
    assert whole.add("bias[time]", other).own_effects == [MOTOR]
    refuse(
        lambda: sepcal.load(file, effects=[MOTOR, sepcal.Effect("engine", current, "bias")]),
        "no effect engine",
        "motor",
    )


def test_it_is_pickled_with_its_effect(other: sepcal.Flight, own: sepcal.Calibration) -> None:
    for again in (pickle.loads(pickle.dumps(own)), copy.deepcopy(own)):
        assert again.own_effects == [MOTOR]
        assert_array_equal(again.compare(other).residuals, own.compare(other).residuals)


def test_a_function_that_cannot_be_pickled(flight: sepcal.Flight) -> None:
    motor = sepcal.Effect("motor", lambda log: log["current_a"], port="bias")
    calibration = sepcal.fit(MAGNETOMETER, flight, effects=[motor])
    refuse(lambda: pickle.dumps(calibration), "motor", "pickled", "def")
    assert_array_equal(copy.deepcopy(calibration).values, calibration.values)


def test_a_calibration_lets_its_effect_go(flight: sepcal.Flight) -> None:
    class Function:
        def __call__(self, log: Columns) -> np.ndarray:
            return log["current_a"]

    function = Function()
    alive = weakref.ref(function)
    effect = sepcal.Effect("motor", function, port="bias")
    calibration = sepcal.fit(MAGNETOMETER, flight, effects=[effect])
    del function, effect
    gc.collect()
    assert alive() is not None
    del calibration
    gc.collect()
    assert alive() is None
