# SPDX-License-Identifier: BSD-3-Clause
"""The Python front as it is used: models, flights, and fits of the model's own columns."""

import copy
import pickle
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import sepcal
from oracle.cases import CASE_NAMES, state_case
from own_models import BUILT_IN

PROBE = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
PUBLIC_MODULES = {"datasets", "rivals", "triads"}


@pytest.fixture
def record() -> dict[str, np.ndarray]:
    """Scalar example 1 with a = 1, c = 1, b = 0.1 and noise of 0.3, as the paper has it."""
    return dict(state_case("scalar_1").record)


# --- models


def test_a_model_tells_its_tables() -> None:
    assert PROBE.outputs == ("vn", "ve", "vd")
    assert PROBE.parameters == PROBE.linear + PROBE.nonlinear
    assert PROBE.units["lambda_va"] == "1"
    assert PROBE.units["b_va"] == "m/s"
    assert PROBE.units["rho"] == "kg/m^3"
    assert PROBE.bounds["w_n"] == (-np.inf, np.inf)
    assert PROBE.bounds["b_alpha"] == pytest.approx((np.radians(-10), np.radians(10)), rel=1e-15)
    assert repr(PROBE) == "FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))"
    assert repr(sepcal.Magnetometer()) == "Magnetometer()"
    assert isinstance(PROBE, sepcal.Model)


@pytest.mark.parametrize("name", CASE_NAMES)
def test_evaluate_gives_the_oracles_numbers(name: str) -> None:
    """A, b and D against the closed forms and hand-written derivatives of the oracle."""
    case = state_case(name)
    model = BUILT_IN[name]
    n_1 = len(model.linear)
    xi1, xi2 = case.truth[:n_1], case.truth[n_1:]
    expected_A, expected_b = case.model.affine(case.record, xi2)
    expected_D = case.model.jacobian(case.record, case.truth)[..., n_1:]
    A, b, D = model.evaluate(case.record, xi2, xi1)
    assert_allclose(A, np.swapaxes(expected_A, 0, 1), rtol=1e-11, atol=1e-11)
    assert_allclose(b, expected_b.T, rtol=1e-11, atol=1e-11)
    assert_allclose(D, np.swapaxes(expected_D, 0, 1), rtol=1e-10, atol=1e-10)
    alone = model.evaluate(case.record, xi2)
    assert len(alone) == 2
    assert_allclose(alone[0], A, rtol=1e-13, atol=1e-13)  # dual numbers round otherwise
    assert_allclose(alone[1], b, rtol=1e-13, atol=1e-13)


def test_a_point_goes_in_by_name_or_in_order() -> None:
    model, record = sepcal.ScalarExample2(), {"eta": [0.0, 1.0]}
    by_name = model.evaluate(record, {"c": 0.2, "b": 0.1})
    for expected, actual in zip(model.evaluate(record, [0.1, 0.2]), by_name, strict=True):
        assert_array_equal(actual, expected)


# --- flights


def test_a_flight_is_a_mapping_of_its_columns() -> None:
    flight = sepcal.Flight({"time_s": [0, 1], "pt_pa": [5, 6]}, maneuver=["a", "b"], name="log")
    assert (flight.name, flight.rows, flight.sha256) == ("log", 2, "")
    assert flight.columns == tuple(flight) == ("time_s", "pt_pa")
    assert flight.maneuvers == ["a", "b"]
    assert "pt_pa" in flight
    assert "ps_pa" not in flight
    assert flight.get("ps_pa") is None
    assert repr(flight) == "<Flight 'log': 2 rows of time_s, pt_pa>"


def test_a_column_of_labels_is_taken_as_a_file_would() -> None:
    flight = sepcal.Flight({"time_s": [0, 1], "maneuver": np.array(["a", "b"])})
    assert flight.columns == ("time_s",)
    assert flight.maneuvers == ["a", "b"]


def test_a_file_reads_as_it_stands(tmp_path: Path) -> None:
    file = tmp_path / "flight.csv"
    file.write_text("time_s,alt_ft,maneuver\n0.1,1e3,climb\n0.2,word,cruise\n")
    flight = sepcal.read_csv(file)
    assert flight.name == str(file)
    assert len(flight.sha256) == 64
    assert_array_equal(flight["time_s"], [0.1, 0.2])
    assert_array_equal(flight["alt_ft"], [1000.0, np.nan])
    assert flight.maneuvers == ["climb", "cruise"]


# --- fits


def test_a_fit_holds_together(record: dict[str, np.ndarray]) -> None:
    fit = sepcal.fit(sepcal.ScalarExample1(), record, samples=64, seed=2)
    assert not isinstance(fit, sepcal.Calibration)
    assert fit.names == ("a", "c", "b")
    assert fit["b"] == fit.parameters["b"]
    assert fit.rows == 100
    assert set(fit.noise) == set(fit.rmse) == {"z"}
    errors = np.array([fit[name].standard_error for name in fit.names])
    assert_allclose(np.diag(fit.covariance), errors**2, rtol=1e-14)
    assert_allclose(fit.correlation, fit.covariance / np.outer(errors, errors), rtol=1e-14)
    assert (fit["b"].lower, fit["b"].upper) == (-0.5, 0.5)
    assert fit.stage_one.samples.shape == (64, 1)
    assert fit.stage_one.trace_r.shape == (64,)
    lowest = np.argmin(fit.stage_one.trace_r)
    assert fit.stage_one.best == {"b": fit.stage_one.samples[lowest, 0]}
    assert fit.stage_one.best_trace_r == fit.stage_one.trace_r[lowest]
    assert fit.iterations > 0
    assert fit.noise_iterations > 0


def test_options_arrive(record: dict[str, np.ndarray]) -> None:
    """Each where only it can have done it."""
    model = sepcal.ScalarExample1()

    def fit(**options: object) -> sepcal.Fit:
        return sepcal.fit(model, record, **{"samples": 32, **options})

    assert np.all(np.abs(fit(bounds={"b": (-0.05, 0.05)}).stage_one.samples) <= 0.05)
    assert fit(bounds={"a": (None, 0.5)})["a"].lower == -np.inf
    assert fit(bounds={"a": (None, 0.5)})["a"].value == 0.5
    assert fit(noise={"z": 0.25}).noise == {"z": 0.25}
    assert fit(seed=1).stage_one.samples[0, 0] != fit(seed=2).stage_one.samples[0, 0]
    assert_array_equal(fit(seed=1).stage_one.samples, fit(seed=1, threads=1).stage_one.samples)
    assert fit(second_stage="joint").second_stage == "joint"
    assert fit(second_stage="projected").second_stage == "projected"
    assert fit(samples=0).stage_one.samples.shape[0] == 0
    assert fit(noise_iterations=1).noise_iterations == 1
    narrow = fit(sampling_distribution={"b": (0.2, 1e-3)}).stage_one.samples
    assert np.all(np.abs(narrow - 0.2) < 0.01)
    even = np.sort(fit(sampling="low_discrepancy").stage_one.samples[:, 0])
    assert np.all(np.diff(even) < 2.5 / 32)  # a Halton sequence leaves no wide gap in a width of 1
    assert fit(bounds=None, fix=None).values.tolist() == fit().values.tolist()


def test_a_fixed_parameter_is_held(record: dict[str, np.ndarray]) -> None:
    fit = sepcal.fit(sepcal.ScalarExample2(), record_of_example_2(), fix={"b": 0.05})
    assert fit["b"].fixed
    assert fit["b"].value == 0.05
    assert np.isnan(fit["b"].standard_error)
    assert fit.stage_one.samples.shape == (500, 1)
    assert list(fit.stage_one.best) == ["c"]
    assert "fixed" in str(fit)


def record_of_example_2() -> dict[str, np.ndarray]:
    """Scalar example 2 with its parameters within the model's bounds."""
    return dict(state_case("scalar_2").record)


def test_an_active_bound_is_told(record: dict[str, np.ndarray]) -> None:
    fit = sepcal.fit(sepcal.ScalarExample1(), record, bounds={"a": (0.0, 0.5)})
    assert fit["a"].at_bound
    assert fit["a"].remark == "at its upper bound"
    assert np.isnan(fit["a"].standard_error)
    assert "status: converged, 1 parameter at its bound: a" in str(fit).splitlines()
    assert "[0, 0.5]  AT ITS BOUND" in str(fit)


def test_what_the_record_leaves_open_is_told() -> None:
    """A constant input: amplitude, phase and offset are one number."""
    eta = np.full(50, 0.3)
    z = 1.0 + 0.1 * np.random.default_rng(0).standard_normal(50)
    fit = sepcal.fit(sepcal.ScalarExample1(), {"eta": eta, "z": z})
    assert fit.status == "not_identifiable"
    assert len(fit.unobservable) == 2
    assert {name for one in fit.unobservable for name in one.parameters} <= {"a", "b", "c"}
    assert all(one.text in fit.message for one in fit.unobservable)
    assert "status: not_identifiable" in str(fit).splitlines()
    assert not fit.success


def test_time_and_labels_cut_a_record(record: dict[str, np.ndarray]) -> None:
    model = sepcal.ScalarExample1()
    half = {name: values[:50] for name, values in record.items()}
    expected = sepcal.fit(model, half)
    time = 0.1 * np.arange(100)
    labels = ["first"] * 50 + ["second"] * 50
    by_time = sepcal.fit(
        model, {**record, "time": time}, stage_one_segments="0:4.95", stage_two_segments="0:4.95"
    )
    by_label = sepcal.fit(
        model,
        {**record, "maneuver": labels},
        stage_one_segments="first",
        stage_two_segments="first",
    )
    for fit in (by_time, by_label):
        assert fit.rows == 50
        assert_array_equal(fit.values, expected.values)


def test_other_columns_are_left_alone(record: dict[str, np.ndarray]) -> None:
    fit = sepcal.fit(sepcal.ScalarExample1(), {**record, "pilot": ["Ada"] * 100})
    assert_array_equal(fit.values, sepcal.fit(sepcal.ScalarExample1(), record).values)


def test_results_pickle(record: dict[str, np.ndarray]) -> None:
    fit = sepcal.fit(sepcal.ScalarExample1(), record)
    for twin in (pickle.loads(pickle.dumps(fit)), copy.deepcopy(fit)):
        assert twin.parameters == fit.parameters
        assert str(twin) == str(fit)
        assert_array_equal(twin.covariance, fit.covariance)
        assert_array_equal(twin.stage_one.samples, fit.stage_one.samples)


def test_version_is_that_of_the_project() -> None:
    numbers = sepcal.__version__.split(".")
    assert len(numbers) == 3
    assert all(number.isdigit() for number in numbers)


def test_dir_shows_what_is_public_and_no_internals() -> None:
    """No modules but the two of __all__, no imported helpers."""
    assert dir(sepcal) == sorted(sepcal.__all__)
    shown = {name: getattr(sepcal, name) for name in dir(sepcal) if name != "__version__"}
    assert {name for name, one in shown.items() if isinstance(one, ModuleType)} == PUBLIC_MODULES
    assert not [name for name in shown if name.startswith("_")]
    others = {name: one for name, one in shown.items() if name not in PUBLIC_MODULES}
    assert not [name for name, one in others.items() if not one.__module__.startswith("sepcal")]
