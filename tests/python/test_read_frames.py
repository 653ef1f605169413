# SPDX-License-Identifier: BSD-3-Clause
"""Tables in memory wherever a flight is taken, and a flight as a table."""

from pathlib import Path

import numpy as np
import pytest

import sepcal
from refusals import refuse

pandas = pytest.importorskip("pandas")

TUBE = sepcal.PitotStatic()


@pytest.fixture(scope="module")
def columns():
    flight = sepcal.simulate(TUBE, rows=300, seed=2)
    return {h: np.asarray(flight[h]) for h in flight if h not in ("dp_pa", "maneuver")}


@pytest.fixture(scope="module")
def expected(columns):
    return sepcal.fit(TUBE, sepcal.Flight(columns))


def frames(columns):
    frame = pandas.DataFrame(columns)
    yield "pandas", frame
    yield "pandas by time", frame.set_index("time_s")
    yield "pandas' own numbers", frame.convert_dtypes()
    yield "in Fortran's order", pandas.DataFrame(np.asfortranarray(frame), columns=list(frame))
    yield "a dict", columns
    if polars := _module("polars"):
        yield "polars", polars.DataFrame(columns)
        yield "polars, lazy", polars.LazyFrame(columns)
    if arrow := _module("pyarrow"):
        yield "arrow", arrow.table(columns)
        yield "arrow, a batch", arrow.RecordBatch.from_pydict(columns)
    if xarray := _module("xarray"):
        others = {h: ("time_s", v) for h, v in columns.items() if h != "time_s"}
        yield "xarray", xarray.Dataset(others, coords={"time_s": columns["time_s"]})


def _module(name):
    try:
        return __import__(name)
    except ImportError:
        return None


def test_each_gives_the_same_digits(columns, expected):
    for name, data in frames(columns):
        fitted = sepcal.fit(TUBE, data)
        assert isinstance(fitted, sepcal.Calibration), name
        assert fitted.values.tolist() == expected.values.tolist(), name
        assert sepcal.read(data).rows == 300
        checked = sepcal.check(TUBE, data)
        assert {one.header for one in checked.columns} >= {"time_s", "airspeed_mps"}, name
        corrected = expected.apply(data)["airspeed_cal_mps"]
        assert corrected.tolist() == expected.apply(expected.flight)["airspeed_cal_mps"].tolist()
        assert expected.compare(data).residuals.tolist() == expected.compare().residuals.tolist()


def test_an_index_of_dates_is_the_time(columns):
    dates = pandas.Timestamp("2026-03-01 12:00", tz="UTC") + pandas.to_timedelta(
        columns["time_s"], unit="s"
    )
    frame = pandas.DataFrame(columns).drop(columns="time_s").set_index(dates)
    flight = sepcal.Flight(frame, name="monday")
    np.testing.assert_allclose(flight["time_s"], 43200 + columns["time_s"], atol=1e-6)
    assert flight.notes == [
        "monday: time_s is seconds since 2026-03-01 00:00 UTC, of the dates in 'index'"
    ]
    spans = pandas.DataFrame(columns).drop(columns="time_s")
    spans.index = pandas.to_timedelta(columns["time_s"], unit="s")
    np.testing.assert_allclose(sepcal.Flight(spans)["time_s"], columns["time_s"], atol=1e-9)


def test_a_model_takes_its_own_columns_as_before(columns):
    own = {name: columns[f"{name}_mps"] for name in ("vn", "ve", "vd", "airspeed")}
    fitted = sepcal.fit(TUBE, {"time": columns["time_s"], **own})
    assert type(fitted) is sepcal.Fit
    by_frame = sepcal.fit(TUBE, pandas.DataFrame({"time": columns["time_s"], **own}))
    assert by_frame.values.tolist() == fitted.values.tolist()


def test_a_frame_is_a_flight_where_columns_are_chosen(columns, expected):
    frame = pandas.DataFrame(columns).rename(columns={"airspeed_mps": "TAS"})
    found = sepcal.fit(TUBE, frame, map={"airspeed_mps": "TAS"})
    assert found["s_va"].value == expected["s_va"].value


def test_a_header_of_several_rows_says_the_way_out(columns):
    frame = pandas.DataFrame(columns)
    frame.columns = pandas.MultiIndex.from_tuples([("log", name) for name in columns])
    refuse(lambda: sepcal.fit(TUBE, frame), "df.columns = df.columns.get_level_values(-1)")
    frame.columns = frame.columns.get_level_values(-1)
    assert sepcal.fit(TUBE, frame).status == "converged"


def test_units_of_xarray(columns):
    xarray = pytest.importorskip("xarray")
    data = xarray.Dataset(
        {"airspeed": ("time", columns["airspeed_mps"], {"units": "m s-1"})},
        coords={"time": ("time", columns["time_s"], {"units": "s"})},
    )
    flight = sepcal.read(data)
    assert list(flight) == ["time_s", "airspeed_mps"]


def test_missing_numbers_and_labels(columns):
    frame = pandas.DataFrame(columns).convert_dtypes()
    frame.loc[3, "altitude_m"] = pandas.NA
    frame["maneuver"] = pandas.Categorical(["a"] * 200 + ["b"] * 100)
    flight = sepcal.Flight(frame)
    assert np.flatnonzero(np.isnan(flight["altitude_m"])).tolist() == [3]
    assert flight.maneuvers == ["a"] * 200 + ["b"] * 100


def test_what_is_no_table(columns):
    frame = pandas.DataFrame(columns)
    refuse(lambda: sepcal.read(frame["time_s"]), "a Series is one column", "DataFrame")
    refuse(lambda: sepcal.Flight(frame.rename(columns={"vn_mps": 3})), "called 3")
    refuse(lambda: sepcal.Flight(pandas.concat([frame, frame], axis=1)), "twice")
    refuse(lambda: sepcal.fit(TUBE, 3.0), "a float is no flight", "sepcal.read(")
    refuse(lambda: sepcal.read(frame, table="x"), "one table")
    refuse(lambda: sepcal.check(TUBE, frame["time_s"]), "a Series")


def test_a_flight_as_a_table(columns, tmp_path):
    labels = ["turn, left", 'the "b"', "c"] * 100
    flight = sepcal.Flight(columns, labels, name="<b>a&b</b>")
    frame = flight.to_frame()
    assert list(frame)[:2] == ["time_s", "maneuver"]
    np.testing.assert_array_equal(frame["airspeed_mps"], columns["airspeed_mps"])
    frame.loc[0, "airspeed_mps"] = 0.0  # a copy
    assert flight["airspeed_mps"][0] == columns["airspeed_mps"][0] != 0.0
    again = sepcal.Flight(flight.to_frame())
    assert (list(again), again.maneuvers) == (list(flight), labels)
    first = flight.head(3)
    assert (first.rows, first.maneuvers, first.name) == (3, labels[:3], flight.name)
    refuse(lambda: flight.head(0), "one row or more")
    flight.to_csv(tmp_path / "a.csv")
    back = sepcal.read_csv(tmp_path / "a.csv")
    assert back.maneuvers == labels
    for header in flight:
        np.testing.assert_array_equal(back[header], flight[header])
    refuse(lambda: flight.to_csv(tmp_path / "none" / "a.csv"), "none")


def test_a_notebooks_view_is_escaped(columns):
    hostile = "<script>alert(1)</script>"
    flight = sepcal.Flight({**columns, hostile: columns["time_s"]}, [hostile] * 300, hostile)
    flight._core.note(f"a note {hostile}")
    page = flight._repr_html_()
    assert "<script>" not in page
    assert page.count("&lt;script&gt;") == 1 + 1 + 5 + 1
    assert page.count("<tr>") == 1 + 5
    assert "300 rows" in page


def test_a_path_in_a_list_and_alone(columns, tmp_path):
    sepcal.Flight(columns).to_csv(tmp_path / "monday.csv")
    sepcal.Flight(columns).head(250).to_csv(tmp_path / "tuesday.csv")
    files = [str(tmp_path / "monday.csv"), Path(tmp_path / "tuesday.csv")]
    joint = sepcal.fit_jointly(TUBE, files, own=["wind"])
    assert joint.compare(files).to_dict() == joint.compare().to_dict()
    refuse(lambda: sepcal.fit(TUBE, str(tmp_path / "none.csv")), "none.csv", "no such file")
    refuse(lambda: sepcal.fit(files[0], TUBE), "the model comes first")
