# SPDX-License-Identifier: BSD-3-Clause
"""Results are C++'s structs: immutable, documented, whole after pickling."""

import copy
import pickle

import numpy as np
import pytest

import sepcal

TUBE = sepcal.PitotStatic()
ROWS = 300


@pytest.fixture(scope="module")
def results() -> dict[str, object]:
    """One of every kind, some with undefined numbers and with effects."""
    flight = sepcal.simulate(TUBE, rows=ROWS, seed=3, hide={"wind[time]": (0.01, 0.0)})
    other = sepcal.simulate(TUBE, rows=ROWS, seed=4)
    base = sepcal.fit(TUBE, flight, samples=20, fix={"w_n": 0.0})
    added = base.add("wind[maneuver]")
    many = sepcal.fit_many(TUBE, {"a": flight, "b": other}, own=["w_n", "w_e"], samples=20)
    rows = {"u": np.linspace(0.0, 1.0, 50), "z": np.linspace(0.0, 1.0, 50) ** 2}
    model = sepcal.ScalarExample1()
    columns = dict.fromkeys(model.inputs, rows["u"]) | {"z": np.sin(rows["u"])}
    screened = sepcal.fit(model, columns, samples=16, screens={"t_1": 10.0})
    found = {
        "fit": added.fit,
        "stage_one": screened.stage_one,
        "screens": screened.stage_one.screens,
        "setting": added.effects[0],
        "parameter": added["w_n"],
        "derived": added.derived["lambda_va"],
        "history": added.history[-1],
        "comparison": added.compare(),
        "diagnosis": base.diagnose(inject={"wind[altitude_m]": 0.05}),
        "step": base.diagnose(auto=True).steps[0],
        "check": sepcal.check(TUBE, flight),
        "intervals": base.intervals(names=["c_va"]),
        "prediction": base.predict(),
        "many": many,
        "one": many.flights["b"],
        "departure": many.flights["a"].departure,
        "effect": sepcal.effects(TUBE)[0],
    }
    assert all(value is not None for value in found.values())
    return found


def same(one: object, two: object) -> bool:
    """Of all fields, whatever they are; NaN is NaN."""
    if hasattr(one, "_asdict"):
        return type(one) is type(two) and same(one._asdict(), two._asdict())  # type: ignore[attr-defined]
    if isinstance(one, dict):
        return one.keys() == two.keys() and all(same(one[key], two[key]) for key in one)  # type: ignore[attr-defined,index]
    if isinstance(one, list | tuple):
        return len(one) == len(two) and all(map(same, one, two))  # type: ignore[arg-type]
    if isinstance(one, float | np.ndarray):
        return np.array_equal(one, two, equal_nan=True)  # type: ignore[arg-type]
    return bool(one == two)


def test_pickles_and_copies_are_the_same(results):
    for name, result in results.items():
        for twin in (pickle.loads(pickle.dumps(result)), copy.deepcopy(result)):
            assert type(twin) is type(result), name
            assert same(twin, result), name


def test_a_diagnosis_has_the_numbers_of_its_json(results):
    """Undefined ones are NaN here and null there; what has a name is keyed by it."""

    def plain(one: object) -> object:
        if hasattr(one, "_asdict"):
            return plain(one._asdict())
        if isinstance(one, dict):
            return {key: plain(value) for key, value in one.items()}
        if isinstance(one, list | tuple):
            return [plain(value) for value in one]
        if isinstance(one, np.ndarray):
            return one.tolist()
        return None if isinstance(one, float) and not np.isfinite(one) else one

    diagnosis = results["diagnosis"]
    written, read = diagnosis.to_dict(), plain(diagnosis)
    assert written["effects"] == read["effects"]
    for name in ("advice", "work", "injected", "pairs", "verdict", "sentence"):
        assert written[name] == read[name], name
    for name in ("rmse", "noise_floor", "correlation_time", "left_undone", "missing_channels"):
        assert written[name] == read[name], name
    assert [{**one, "unit": "m/s"} for one in written["where"]] == read["where"]
    assert written["unexplained"].keys() == read["unexplained"].keys()
    for port, limit in written["limits"].items():
        assert read["limits"][port] == {"port": port, **limit}
    for output, told in written["residual"].items():
        known = read["residual"][output]
        assert {key: known[key] for key in told if key != "noise"} == {
            key: told[key] for key in told if key != "noise"
        }
        assert told["noise"].items() <= known["noise"].items()


def test_what_differs_is_told_apart(results):
    """So that `same` above can fail."""
    assert not same(results["comparison"], results["fit"])
    assert not same(results["one"], results["many"].flights["a"])


@pytest.mark.parametrize(
    "name", ["fit", "parameter", "history", "comparison", "diagnosis", "step", "many", "effect"]
)
def test_nobody_changes_a_result(results, name):
    result = results[name]
    for field in result._fields:
        with pytest.raises(AttributeError):
            setattr(result, field, getattr(result, field))


def test_arrays_are_read_only_and_outlive_the_result(results):
    flight = sepcal.simulate(TUBE, rows=ROWS, seed=3)
    covariance = sepcal.fit(TUBE, flight, samples=20).covariance  # the fit itself is gone
    expected = sepcal.fit(TUBE, flight, samples=20).covariance.copy()
    np.testing.assert_array_equal(covariance, expected)
    for array in (covariance, results["comparison"].residuals, results["comparison"].time):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0


def test_small_results_compare_and_show_themselves():
    first, second, *_ = sepcal.effects(TUBE)
    assert first == sepcal.effects(TUBE)[0]
    assert first != second
    assert first != "another kind"
    assert hash(first) == hash(sepcal.effects(TUBE)[0])
    assert repr(first).startswith(f"CataloguedEffect(name={first.name!r}, equation=")


def test_every_field_is_typed_and_most_are_documented(results):
    """A class that says of no field what its number means would be of no use."""
    for result in results.values():
        kind = next(base for base in type(result).__mro__ if base.__module__ == "sepcal._core")
        documents = [getattr(kind, field).__doc__ for field in result._fields]
        assert kind.__doc__
        assert sum(map(bool, documents)) >= 2, kind
