# SPDX-License-Identifier: BSD-3-Clause
"""One flight in every form, written by the form's own library: the same digits as from the CSV."""

import gzip
import hashlib
import subprocess
import sys

import numpy as np
import pytest

import sepcal
from form_writers import WRITERS, write_excel, write_hdf5, write_parquet
from refusals import refuse

pytest.importorskip("pyarrow")
pytest.importorskip("h5py")
pytest.importorskip("openpyxl")
pytest.importorskip("mcap")
pandas = pytest.importorskip("pandas")

FIELD = (20.1, 1.2, 43.5)
PROBES = {"tube": sepcal.PitotStatic(), "compass": sepcal.Magnetometer(field=FIELD)}
HEADERS = {
    "tube": ["time_s", "vn_mps", "ve_mps", "vd_mps", "airspeed_mps", "altitude_m"],
    "compass": [
        "time_s",
        "mx_ut",
        "my_ut",
        "mz_ut",
        "roll_rad",
        "pitch_rad",
        "yaw_rad",
        "current_a",
    ],
}


@pytest.fixture(scope="module", params=list(PROBES))
def flown(request):
    """A flight's columns, and its probe."""
    flight = sepcal.simulate(PROBES[request.param], rows=200, seed=4)
    return {h: np.asarray(flight[h]) for h in HEADERS[request.param]}, PROBES[request.param]


@pytest.mark.parametrize("name", list(WRITERS))
def test_the_same_digits_as_from_the_csv(name, flown, tmp_path):
    columns, probe = flown
    sepcal.Flight(columns).to_csv(tmp_path / "a.csv")
    expected = sepcal.fit(probe, str(tmp_path / "a.csv"))
    file = tmp_path / name
    WRITERS[name](columns, file)
    flight = sepcal.read(file)
    assert flight.name == str(file)
    assert flight.sha256 == hashlib.sha256(file.read_bytes()).hexdigest()
    assert set(columns) == set(flight)
    shift = 43200.0 if name == "a.mcap" else 0.0
    for header, values in columns.items():
        if name == "a.mcap" and header == "time_s":
            np.testing.assert_allclose(flight[header] - shift, values, rtol=0, atol=1e-9)
        elif name == "a.xlsx":  # openpyxl writes 16 digits
            np.testing.assert_allclose(flight[header], values, rtol=1e-15)
        else:
            np.testing.assert_array_equal(flight[header], values)
    fitted = sepcal.fit(probe, file)
    tolerance = 1e-9 if name in ("a.mcap", "a.xlsx") else 0
    np.testing.assert_allclose(fitted.values, expected.values, rtol=tolerance)
    assert sepcal.fit(probe, sepcal.read(flight)).values.tolist() == fitted.values.tolist()


@pytest.mark.parametrize("name", list(WRITERS))
def test_a_name_says_nothing_of_the_form(name, flown, tmp_path):
    file = tmp_path / "log.dat"
    WRITERS[name](flown[0], file)
    assert sepcal.read(file).rows == 200


@pytest.mark.parametrize("name", list(WRITERS))
def test_what_reads_csv_reads_it(name, flown, tmp_path):
    """The library asks for such files by itself, so that every program in Python does."""
    file = tmp_path / name
    WRITERS[name](flown[0], file)
    flight, expected = sepcal.read_csv(file), sepcal.read(file)
    assert (flight.sha256, flight.notes) == (expected.sha256, expected.notes)
    for header in expected:
        np.testing.assert_array_equal(flight[header], expected[header])


def test_later_verbs_know_the_flight(flown, tmp_path):
    columns, probe = flown
    write_parquet(columns, tmp_path / "a.parquet")
    fitted = sepcal.fit(probe, tmp_path / "a.parquet")
    fitted.save(tmp_path / "base.json")
    loaded = sepcal.load(tmp_path / "base.json")
    file = str(tmp_path / "a.parquet")
    assert loaded.compare(file).to_dict() == fitted.compare().to_dict()
    assert loaded.intervals(file).to_dict() == fitted.intervals().to_dict()
    assert {h: v.tolist() for h, v in loaded.apply(file).items()} == {
        h: v.tolist() for h, v in fitted.apply(fitted.flight).items()
    }
    assert sepcal.check(probe, file).file == file


def test_notes_travel_into_the_fit(flown, tmp_path):
    columns, probe = flown
    write_excel(columns, tmp_path / "a.xlsx")
    fitted = sepcal.fit(probe, tmp_path / "a.xlsx")
    assert any("sheet 'log' is read" in note for note in fitted.notes)


def test_a_log_packed_by_gzip(flown, tmp_path):
    columns, _ = flown
    write_hdf5(columns, tmp_path / "a.h5")
    with gzip.open(tmp_path / "a.h5.gz", "wb") as packed:
        packed.write((tmp_path / "a.h5").read_bytes())
    flight = sepcal.read(tmp_path / "a.h5.gz")
    assert flight.name.endswith("a.h5.gz")
    np.testing.assert_array_equal(flight["time_s"], columns["time_s"])


def test_dates_become_seconds_of_the_day(tmp_path):
    dates = pandas.to_datetime(["2026-03-01 23:59:59.5", "2026-03-02 00:00:00.25"], utc=True)
    frame = pandas.DataFrame({"airspeed_mps": [1.0, 2.0], "maneuver": ["a", "b"]}, index=dates)
    berlin = frame.tz_convert("Europe/Berlin")
    berlin.to_parquet(tmp_path / "a.parquet")
    for data in (frame, berlin, tmp_path / "a.parquet"):
        flight = sepcal.read(data)
        assert flight["time_s"].tolist() == [86399.5, 86400.25]
        assert flight.maneuvers == ["a", "b"]
        assert any("seconds since 2026-03-01 00:00 UTC" in note for note in flight.notes)


@pytest.mark.parametrize(
    ("clock", "values", "seconds"),
    [
        ("timestamp", [1772366400000000, 1772366400100000], [43200.0, 43200.1]),
        ("timestamp", [1772366400000, 1772366400100], [43200.0, 43200.1]),
        ("TimeUS", [5_000_000, 5_100_000], [5.0, 5.1]),
        ("t", [0.5, 0.75], [0.5, 0.75]),
        ("time_ns", [500_000_000, 750_000_000], [0.5, 0.75]),
    ],
)
def test_clocks_without_a_unit(clock, values, seconds, tmp_path):
    frame = pandas.DataFrame({clock: values, "airspeed_mps": [1.0, 2.0]})
    frame.to_parquet(tmp_path / "a.parquet")
    flight = sepcal.read(tmp_path / "a.parquet")
    np.testing.assert_allclose(flight["time_s"], seconds, rtol=0, atol=1e-6)
    assert any("time_s is" in note for note in flight.notes)


def test_a_clock_that_could_be_two_stays(tmp_path):
    """Steps of 100 are 0.1 s in ms or 0.1 ms in us: it keeps its name, for --map."""
    pandas.DataFrame({"t": [0, 100, 200], "airspeed_mps": [1.0, 2.0, 3.0]}).to_parquet(
        tmp_path / "a.parquet"
    )
    assert list(sepcal.read(tmp_path / "a.parquet")) == ["t", "airspeed_mps"]


def test_a_column_of_words_is_left_out_and_named(tmp_path):
    frame = pandas.DataFrame({"time_s": [0.0, 1.0], "pilot": ["A", "B"], "text_pa": ["1.5", "2"]})
    frame.to_parquet(tmp_path / "a.parquet")
    flight = sepcal.read(tmp_path / "a.parquet")
    assert flight["text_pa"].tolist() == [1.5, 2.0]
    assert list(flight) == ["time_s", "text_pa"]
    assert any("no numbers: pilot" in note for note in flight.notes)


def test_netcdf_says_units_dates_and_packing(tmp_path):
    import h5py

    with h5py.File(tmp_path / "a.nc", "w") as opened:
        opened["time"] = np.array([0, 500, 1000], dtype="i4")
        opened["time"].attrs["units"] = "milliseconds since 2026-03-01 12:00:00"
        opened["airspeed"] = np.array([100, -1, 120], dtype="i2")
        opened["airspeed"].attrs.update(units="m s-1", scale_factor=0.1, _FillValue=np.int16(-1))
    flight = sepcal.read(tmp_path / "a.nc")
    assert flight["time_s"].tolist() == [43200.0, 43200.5, 43201.0]
    np.testing.assert_allclose(flight["airspeed_mps"], [10.0, np.nan, 12.0])


def test_matlabs_array_of_structs_and_cells(tmp_path):
    from scipy.io import savemat

    rows = np.array([(0.0, 10.5, "up"), (0.5, 11.5, "down")], dtype=[*[(n, object) for n in "tvw"]])
    savemat(tmp_path / "a.mat", {"log": rows})
    flight = sepcal.read(tmp_path / "a.mat")
    assert flight["v"].tolist() == [10.5, 11.5]


def test_matlabs_own_objects_are_named(tmp_path):
    """An element of class 17, by the format's document, as MATLAB writes a timetable."""
    flags = np.array([6, 8, 17, 0], dtype="<u4").tobytes()
    body = flags + b"".join(
        np.array([1, len(text)], dtype="<u4").tobytes()
        + text.ljust(16, b"\0")[: -(-len(text) // 8) * 8]
        for text in (b"T", b"MCOS", b"timetable")
    )
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\0\1IM"
    tag = np.array([14, len(body)], dtype="<u4").tobytes()
    (tmp_path / "a.mat").write_bytes(head + tag + body)
    refuse(lambda: sepcal.read(tmp_path / "a.mat"), "a.mat", "timetable", "table2struct(")


def test_the_sheet_can_be_chosen(tmp_path):
    import openpyxl

    book = openpyxl.Workbook()
    for name, speed in (("first", 10.0), ("second", 20.0)):
        sheet = book.create_sheet(name)
        sheet.append(["time_s", "airspeed_mps"])
        for row in range(12):
            sheet.append([row / 2, speed + row])
    book.save(tmp_path / "a.xlsx")
    file = str(tmp_path / "a.xlsx")
    refuse(lambda: sepcal.read(file), "'first', 'second'", f"'{file}::first'")
    assert sepcal.read(f"{file}::first")["airspeed_mps"][0] == 10.0
    assert sepcal.read(file, "second")["airspeed_mps"][0] == 20.0
    refuse(lambda: sepcal.read(file, "third"), "no sheet 'third'", "first, second")


def test_a_sheet_that_measures_is_the_one(tmp_path):
    import openpyxl

    book = openpyxl.Workbook()
    for name, header in (("fuel", "fuel_kg"), ("air", "airspeed_mps")):
        sheet = book.create_sheet(name)
        sheet.append(["time_s", header])
        for row in range(12):
            sheet.append([row / 2, 10.0 + row])
    book.save(tmp_path / "a.xlsx")
    flight = sepcal.read(tmp_path / "a.xlsx")
    assert "airspeed_mps" in flight
    assert "sheet 'air' is read; Sheet, fuel not" in flight.notes[0]


def test_a_workbook_of_people(tmp_path):
    """A title, an empty row, times of day, an empty cell at a row's end, a word in a cell."""
    import openpyxl

    book = openpyxl.Workbook()
    sheet = book.active
    sheet.append(["Flight of March 1"])
    sheet.append([])
    sheet.append(["time_s", "airspeed_mps", "temp_degc"])
    sheet.append([0.0, 10.5, 20.25])
    sheet.append([0.5, "n/a", 20.5])
    sheet.append([])
    sheet.append([1.0, 11.5])
    book.save(tmp_path / "a.xlsx")
    flight = sepcal.read(tmp_path / "a.xlsx")
    assert flight["time_s"].tolist() == [0.0, 0.5, 1.0]
    np.testing.assert_array_equal(flight["airspeed_mps"], [10.5, np.nan, 11.5])
    np.testing.assert_array_equal(flight["temp_degc"], [20.25, 20.5, np.nan])


def test_a_workbook_with_dates(tmp_path):
    import datetime

    import openpyxl

    book = openpyxl.Workbook()
    book.active.append(["time", "airspeed_mps"])
    for row in range(12):
        moment = datetime.datetime(2026, 3, 1, 23, 59, 58) + datetime.timedelta(seconds=row / 4)
        book.active.append([moment, 10.0 + row])
    book.save(tmp_path / "a.xlsx")
    flight = sepcal.read(tmp_path / "a.xlsx")
    np.testing.assert_allclose(flight["time_s"], 86398 + np.arange(12) / 4, atol=1e-3)


def test_how_a_text_is_read_is_for_texts(tmp_path):
    (tmp_path / "a.csv").write_text("time_s;x_m\n0,5;1,25\n1,5;2,5\n")
    flight = sepcal.read(tmp_path / "a.csv", delimiter=";", decimal=",")
    assert flight["x_m"].tolist() == [1.25, 2.5]
    pandas.DataFrame({"x_m": [1.0]}).to_parquet(tmp_path / "a.parquet")
    refuse(
        lambda: sepcal.read(tmp_path / "a.parquet", delimiter=";"), "a.parquet", "no table as text"
    )
    refuse(lambda: sepcal.read({"x_m": [1.0]}, decimal=","), "decimal=','", "for files")


def test_importing_sepcal_loads_no_library():
    heavy = [
        "pandas",
        "pyarrow",
        "h5py",
        "openpyxl",
        "mcap",
        "scipy",
        "polars",
        "xarray",
        "pyulog",
        "pymavlink",
    ]
    code = f"import sys, sepcal; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
