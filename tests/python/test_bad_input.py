# SPDX-License-Identifier: BSD-3-Clause
"""Bad input and misuse from Python: each one line that names the culprit and the way out."""

from pathlib import Path

import numpy as np
import pytest

import sepcal
from refusals import refuse

PROBE = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5)
SCALAR = sepcal.ScalarExample1()
ETA = np.linspace(1.0, 10.0, 100)
RECORD = {"eta": ETA, "z": np.cos(ETA)}


@pytest.fixture
def columns() -> dict[str, np.ndarray]:
    """The columns of a short flight, to be spoiled."""
    return {header: values.copy() for header, values in sepcal.simulate(PROBE, rows=300).items()}


def test_error_is_a_value_error_of_this_package() -> None:
    assert issubclass(sepcal.Error, ValueError)
    assert f"{sepcal.Error.__module__}.{sepcal.Error.__qualname__}" == "sepcal.Error"
    assert sepcal.Error.__doc__


# --- flights


def test_columns_of_unequal_length() -> None:
    refuse(lambda: sepcal.Flight({"time_s": [0, 1], "pt_pa": [1]}), "'pt_pa'", "1", "2")
    refuse(lambda: sepcal.Flight({"time_s": [0, 1]}, maneuver=["a"]), "'maneuver'", "1", "2")


def test_columns_that_are_none() -> None:
    refuse(lambda: sepcal.Flight({"pt_pa": [[1.0, 2.0]]}), "flight", "'pt_pa'", "(1, 2)")
    refuse(lambda: sepcal.Flight({"pt_pa": 3.0}), "'pt_pa'", "()")
    refuse(lambda: sepcal.Flight({"pt_pa": ["one", "two"]}), "'pt_pa'", "not numbers")
    refuse(lambda: sepcal.Flight({"pt_pa": [1.0, None]}), "'pt_pa'", "object")
    refuse(lambda: sepcal.Flight({"pt_pa": [1j]}, name="log"), "log", "complex128")
    refuse(lambda: sepcal.Flight({"": [1.0]}), "no name")
    refuse(lambda: sepcal.Flight({"maneuver": ["a"]}, maneuver=["a"]), "'maneuver'", "twice")


def test_the_name_of_a_file_and_an_array_without_names() -> None:
    refuse(lambda: sepcal.fit(SCALAR, "log.csv"), "log.csv: no such file")
    refuse(lambda: sepcal.fit("log.csv", SCALAR), "the model comes first")
    refuse(lambda: sepcal.report("base.json", "report.html"), "sepcal.load(")
    refuse(lambda: sepcal.Flight(Path("log.csv")), "'log.csv'", "sepcal.read(file)")
    refuse(lambda: sepcal.Flight(np.ones((3, 2))), "(3, 2)", "names no columns", "dict")
    refuse(lambda: sepcal.fit(SCALAR, np.ones(3)), "(3,)", "names no columns", "dict")


def test_a_structured_array_is_columns_by_name() -> None:
    table = np.zeros(100, dtype=[("eta", float), ("z", float)])
    table["eta"], table["z"] = RECORD["eta"], RECORD["z"]
    assert list(sepcal.Flight(table)) == ["eta", "z"]
    assert sepcal.fit(SCALAR, table).values.tolist() == sepcal.fit(SCALAR, RECORD).values.tolist()


def test_the_strength_of_a_field_is_not_the_field() -> None:
    refuse(lambda: sepcal.Magnetometer(field=47.9), "1 number", "field_strength")
    refuse(lambda: sepcal.Magnetometer(field=(20.0, 43.0)), "2 numbers", "north, east, down")


def test_what_follows_from_a_tubes_parameters_is_none_of_them() -> None:
    tube = sepcal.PitotStatic()
    calibration = sepcal.fit(tube, sepcal.Flight(sepcal.simulate(tube, rows=300)))
    with pytest.raises(KeyError, match=r"derived\['lambda_va'\]"):
        calibration["lambda_va"]
    with pytest.raises(KeyError, match="there is no parameter 'lambda'"):
        calibration["lambda"]


def test_a_missing_column_is_named_with_those_that_are_there() -> None:
    flight = sepcal.Flight({"pt_pa": [1.0]})
    with pytest.raises(KeyError, match=r"'ps_pa' is missing; the flight has: pt_pa"):
        flight["ps_pa"]
    refuse(lambda: sepcal.fit(PROBE, flight), "flight", "is missing", "pt_pa")


def test_an_unknown_unit(columns: dict[str, np.ndarray]) -> None:
    columns["pt_at"] = columns.pop("pt_pa")
    refuse(lambda: sepcal.fit(PROBE, sepcal.Flight(columns)), "pt_at", "hpa", "map pt_pa=pt_at")


def test_nan_in_a_needed_column(columns: dict[str, np.ndarray]) -> None:
    columns["vn_mps"][17] = np.nan
    flight = sepcal.Flight(columns)
    refuse(lambda: sepcal.fit(PROBE, flight), "flight row 17", "vn_mps", "drop_invalid")
    calibration = sepcal.fit(PROBE, flight, drop_invalid=True)
    assert calibration.rows == 299
    assert any("1" in note for note in calibration.notes)


def test_nan_in_another_column_only_makes_a_note(columns: dict[str, np.ndarray]) -> None:
    columns["altitude_m"][17] = np.nan
    calibration = sepcal.fit(PROBE, sepcal.Flight(columns))
    assert calibration.rows == 300
    assert any("altitude_m" in note for note in calibration.notes)


def test_nan_in_a_column_that_an_effect_needs(columns: dict[str, np.ndarray]) -> None:
    """A cell or two are filled from their neighbours, one in ten is refused."""
    columns["throttle"][3::10] = np.nan
    flight = sepcal.Flight(columns, name="log")
    refuse(
        lambda: sepcal.fit(PROBE, flight, effects=["pressure_offset[throttle]"]),
        "log",
        "pressure_offset[throttle]",
        "'throttle' holds no number at",
        "row 3",
    )


def test_time_that_runs_back(columns: dict[str, np.ndarray]) -> None:
    columns["time_s"][20] = columns["time_s"][18]
    refuse(lambda: sepcal.fit(PROBE, sepcal.Flight(columns)), "time", "row 20")


def test_fewer_rows_than_parameters(columns: dict[str, np.ndarray]) -> None:
    flight = sepcal.Flight({header: values[:9] for header, values in columns.items()})
    refuse(lambda: sepcal.fit(PROBE, flight), "9", "10 parameters")


def test_a_flight_without_the_models_columns(columns: dict[str, np.ndarray]) -> None:
    refuse(lambda: sepcal.fit(SCALAR, sepcal.Flight(columns)), "time", "missing")


def test_files_that_are_no_logs(tmp_path: Path) -> None:
    refuse(lambda: sepcal.read_csv(tmp_path / "none.csv"), "none.csv", "no such file")
    refuse(lambda: sepcal.read_csv(tmp_path), str(tmp_path))
    broken = tmp_path / "broken.csv"
    broken.write_text('time_s,pt_pa\n1,2\n"3,4\n5,6\n')
    refuse(lambda: sepcal.read_csv(broken), "broken.csv line 3")


# --- records


def test_a_record_without_a_column() -> None:
    refuse(lambda: sepcal.fit(SCALAR, {"eta": ETA}), "ScalarExample1", "'z'", "eta")
    refuse(lambda: sepcal.fit(PROBE, {"pt": ETA}), "'roll'", "pt", "sepcal.Flight")
    refuse(lambda: sepcal.fit(PROBE, {"pt_pa": ETA}), "flight: column", "is missing", "pt_pa")


def test_a_record_that_is_not_finite() -> None:
    z = RECORD["z"].copy()
    z[3] = np.inf
    refuse(lambda: sepcal.fit(SCALAR, {"eta": ETA, "z": z}), "'z'", "3")


def test_a_record_of_unequal_lengths() -> None:
    refuse(lambda: sepcal.fit(SCALAR, {"eta": ETA, "z": ETA[:50]}), "'z'", "50", "100")
    refuse(lambda: sepcal.fit(SCALAR, {**RECORD, "time": ETA[:7]}), "'time'", "7", "100")
    refuse(lambda: sepcal.fit(SCALAR, {**RECORD, "maneuver": ["a"]}), "1 labels", "100 rows")


def test_options_out_of_place_for_records() -> None:
    refuse(lambda: sepcal.fit(SCALAR, RECORD, drop_invalid=True), "drop_invalid", "sepcal.Flight")
    refuse(lambda: sepcal.fit(SCALAR, RECORD, free=["a"]), "free", "probes", "holds no parameter")


# --- options


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"bounds": {"x": (0, 1)}}, ["'x'", "a, c, b"]),
        ({"bounds": {"b": (1, 0)}}, ["'b'"]),
        ({"fix": {"x": 0.0}}, ["'x'"]),
        ({"noise": {"z": -1.0}}, ["'z'"]),
        ({"sampling_distribution": {"x": (0.0, 1.0)}}, ["'x'"]),
        ({"stage_two_segments": "popu"}, ["'popu'"]),
        ({"samples": -1}, ["samples"]),
        ({"sampling": "even"}, ["sampling 'even'", "'low_discrepancy'"]),
        ({"second_stage": "third"}, ["second_stage 'third'", "'projected'"]),
    ],
)
def test_options_out_of_place(options: dict[str, object], words: list[str]) -> None:
    refuse(lambda: sepcal.fit(SCALAR, RECORD, **options), *words)


@pytest.mark.parametrize(
    "options",
    [
        {"samples": "many"},
        {"samples": 1.5},
        {"seed": -1},
        {"bounds": {"b": 1.0}},
        {"bounds": [("b", 0, 1)]},
        {"stage_one_segments": 3},
        {"free": "w_d"},
    ],
)
def test_options_of_another_kind(options: dict[str, object]) -> None:
    (name,) = options
    with pytest.raises(TypeError, match=name) as caught:
        sepcal.fit(SCALAR, RECORD, **options)
    assert "\n" not in str(caught.value)


def test_an_unknown_option_is_named() -> None:
    with pytest.raises(TypeError, match=r"no option 'sample'; it has: effects, .*samples"):
        sepcal.fit(SCALAR, RECORD, sample=3)


def test_an_option_of_the_apps_is_translated() -> None:
    with pytest.raises(TypeError, match=r"no option 'effect'; --effect of the apps is effects; it"):
        sepcal.fit(SCALAR, RECORD, effect="wind_drift")


@pytest.mark.parametrize("option", ["prior", "sampling_distribution"])
def test_a_number_in_place_of_mean_and_deviation(option: str) -> None:
    words = rf"{option}=.*'b': 0.01.; give .name: \(mean, standard deviation\).;"
    with pytest.raises(TypeError, match=words):
        sepcal.fit(SCALAR, RECORD, **{option: {"b": 0.01}})


# --- models, calibrations, simulation


def test_probes_of_impossible_make() -> None:
    refuse(lambda: sepcal.FiveHoleProbe(k_alpha=0.0, k_beta=4.5), "alpha", "0")
    refuse(lambda: sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(1.0,)), "lever_arm")
    refuse(lambda: sepcal.Magnetometer(field=(1.0, 2.0)), "field", "2")


def test_points_that_the_model_does_not_have() -> None:
    refuse(lambda: SCALAR.evaluate(RECORD, {"c": 0.1}), "xi2", "b", "c")
    refuse(lambda: SCALAR.evaluate(RECORD, [0.1, 0.2]), "xi2", "(2,)")
    refuse(lambda: SCALAR.evaluate(RECORD, [0.1], [1.0]), "xi1", "a, c", "(1,)")
    refuse(lambda: SCALAR.evaluate({"z": ETA}, [0.1]), "'eta'", "z")


def test_a_parameter_that_there_is_not() -> None:
    fit = sepcal.fit(SCALAR, RECORD, samples=8)
    with pytest.raises(KeyError, match=r"'w_n'; the fit has: a, c, b"):
        fit["w_n"]


def test_calibrations_that_are_none(tmp_path: Path) -> None:
    file = tmp_path / "base.json"
    refuse(lambda: sepcal.load(file), "base.json")
    file.write_text("{}")
    refuse(lambda: sepcal.load(file), "base.json", "not a calibration")
    file.write_text('{"schema_version": 99, "model": "five-hole"}')
    refuse(lambda: sepcal.load(file), "base.json", "99")


def test_a_loaded_calibration_asks_for_a_flight(tmp_path: Path) -> None:
    sepcal.fit(PROBE, sepcal.simulate(PROBE, rows=300), samples=8).save(tmp_path / "base.json")
    loaded = sepcal.load(tmp_path / "base.json")
    refuse(loaded.compare, "no flight", "sepcal.read(")


def test_output_that_cannot_be_written(tmp_path: Path) -> None:
    calibration = sepcal.fit(PROBE, sepcal.simulate(PROBE, rows=300), samples=8)
    refuse(lambda: calibration.save(tmp_path / "nowhere" / "base.json"), "nowhere")
    refuse(lambda: calibration.save(tmp_path), str(tmp_path))
    assert list(tmp_path.iterdir()) == []


def test_simulations_of_nothing() -> None:
    refuse(lambda: sepcal.simulate("pendulum"), "'pendulum'", "five-hole")
    refuse(lambda: sepcal.simulate("five-hole", parameters={"k": 1.0}), "'k'", "lambda_va")
    refuse(lambda: sepcal.simulate("five-hole", parameters={"w_n": np.nan}), "'w_n'", "nan")
    refuse(lambda: sepcal.simulate("five-hole", noise={"mx": 1.0}), "'mx'")
    refuse(lambda: sepcal.simulate("five-hole", rows=-1), "rows=-1")
