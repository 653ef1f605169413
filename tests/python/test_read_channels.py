# SPDX-License-Identifier: BSD-3-Clause
"""Logs that keep each channel apart, or say names and times in a way of their own."""

import json

import numpy as np
import pytest

import sepcal

ROWS = 60
SECONDS = np.round(0.2 * np.arange(ROWS), 1)
SPEED = 15 + np.sin(SECONDS)
NORTH = 12 + 0.3 * SECONDS


@pytest.fixture
def savemat():
    return pytest.importorskip("scipy.io").savemat


@pytest.fixture
def h5py():
    return pytest.importorskip("h5py")


def channel(values, unit="", time=SECONDS):
    return {"Time": time[:, None], "Data": values[:, None], "Units": unit}


def test_a_struct_a_channel(savemat, tmp_path):
    """They share a time: one table, and each its unit."""
    file = tmp_path / "log.mat"
    savemat(file, {"TAS": channel(SPEED, "kt"), "VN": channel(NORTH, "m/s")})
    flight = sepcal.read(file)
    assert set(flight) == {"time_s", "TAS_kt", "VN_mps"}
    np.testing.assert_array_equal(flight["TAS_kt"], SPEED)
    np.testing.assert_array_equal(flight["VN_mps"], NORTH)
    np.testing.assert_array_equal(flight["time_s"], SECONDS)


def test_channels_of_different_rates(savemat, tmp_path):
    """Rows are those of the airspeed; the velocity, a straight line, is between its samples."""
    file = tmp_path / "log.mat"
    slow = np.arange(0.0, 13.0, 1.0)
    savemat(file, {"TAS": channel(SPEED, "m/s"), "VN": channel(12 + 0.3 * slow, "m/s", slow)})
    flight = sepcal.read(file)
    assert flight.rows == ROWS
    np.testing.assert_allclose(flight["VN_mps"], NORTH, atol=1e-9)


def test_channels_of_version_7_3(h5py, tmp_path):
    """Units are texts, which HDF5 has as numbers."""
    file = tmp_path / "log.mat"
    with h5py.File(file, "w", userblock_size=512) as opened:
        for name, values in {"TAS": SPEED, "VN": NORTH}.items():
            group = opened.create_group(f"flight/{name}")
            group["Time"], group["Data"] = SECONDS[None, :], values[None, :]
            group["Units"] = np.array([[ord(letter)] for letter in "m/s"], dtype="u2")
            group["Units"].attrs["MATLAB_class"] = np.bytes_("char")
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\0\2IM"
    data = file.read_bytes()
    file.write_bytes(head + data[len(head) :])
    flight = sepcal.read(file)
    np.testing.assert_array_equal(flight["TAS_mps"], SPEED)
    np.testing.assert_array_equal(flight["VN_mps"], NORTH)


def test_groups_of_one_dataset(h5py, tmp_path):
    """Units are attributes, and the vector's components are numbered."""
    file = tmp_path / "log.h5"
    with h5py.File(file, "w") as opened:
        for name, values in {"tas": SPEED, "field": np.stack([SPEED, NORTH, SPEED], 1)}.items():
            opened[f"run/{name}/timestamp"] = SECONDS
            opened[f"run/{name}/value"] = values
        opened["run/tas/value"].attrs["units"] = "m s-1"
    flight = sepcal.read(file)
    np.testing.assert_array_equal(flight["tas_mps"], SPEED)
    np.testing.assert_array_equal(flight["field[1]"], NORTH)


def test_simulinks_structure_with_time(savemat, tmp_path):
    file = tmp_path / "log.mat"
    signals = np.zeros(2, dtype=[("values", "O"), ("dimensions", "O"), ("label", "O")])
    signals[0] = (SPEED[:, None], 1.0, "airspeed_mps")
    signals[1] = (NORTH[:, None], 1.0, "vn_mps")
    savemat(file, {"log": {"time": SECONDS[:, None], "signals": signals, "blockName": "Scope"}})
    flight = sepcal.read(file)
    assert set(flight) == {"time_s", "airspeed_mps", "vn_mps"}
    np.testing.assert_array_equal(flight["vn_mps"], NORTH)
    np.testing.assert_array_equal(flight["time_s"], SECONDS)


def test_a_matrix_and_one_list_of_names(savemat, tmp_path):
    file = tmp_path / "log.mat"
    names = np.array(["time_s", "airspeed_mps"], dtype=object)
    savemat(file, {"data": np.column_stack([SECONDS, SPEED]), "header": names})
    np.testing.assert_array_equal(sepcal.read(file)["airspeed_mps"], SPEED)


def test_two_matrices_of_which_the_names_may_be(savemat, tmp_path):
    """Nobody can tell: both are numbered."""
    file = tmp_path / "log.mat"
    names = np.array(["a", "b"], dtype=object)
    pair = np.column_stack([SPEED, NORTH])
    savemat(file, {"time_s": SECONDS, "x": pair, "y": pair, "header": names})
    assert set(sepcal.read(file)) == {"time_s", "x[0]", "x[1]", "y[0]", "y[1]"}


def test_matlabs_count_of_days(savemat, tmp_path):
    """datenum('2024-05-03 10:14:30') is 739375 + 36870 / 86400; a double holds it to 10 us."""
    file = tmp_path / "log.mat"
    days = 739375 + (36870 + SECONDS) / 86400
    savemat(file, {"t": days, "airspeed_mps": SPEED})
    flight = sepcal.read(file)
    np.testing.assert_allclose(flight["time_s"], 36870 + SECONDS, atol=2e-5)
    assert any("2024-05-03" in note and "datenum" in note for note in flight.notes)


@pytest.mark.parametrize(
    ("unit", "values"),
    [
        ("days since 2024-05-03", (36870 + SECONDS) / 86400),
        ("hours since 2024-05-03T10:00:00Z", (870 + SECONDS) / 3600),
        ("minutes since 2024-5-3 10:00", (870 + SECONDS) / 60),
        ("seconds since 2024-05-03 12:14:30 +02:00", SECONDS),
        ("seconds since 1970-01-01 00:00:00 UTC", 1714731270 + SECONDS),
        ("milliseconds since 2024-05-03 10:14:30.000", np.round(1000 * SECONDS).astype("i4")),
    ],
)
def test_dates_of_netcdf(unit, values, h5py, tmp_path):
    """10:14:30 of 3 May 2024, UTC."""
    with h5py.File(tmp_path / "log.nc", "w") as opened:
        opened["time"], opened["airspeed"] = values, SPEED
        opened["time"].attrs["units"] = unit
    flight = sepcal.read(tmp_path / "log.nc")
    np.testing.assert_allclose(flight["time_s"], 36870 + SECONDS, atol=1e-5)
    assert any("since 2024-05-03 00:00 UTC" in note for note in flight.notes)


def test_numbers_typed_as_text(tmp_path):
    """Cells of a sheet that was pasted: texts, with decimal commas."""
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.append(["time_s", "airspeed_mps"])
    for time, speed in zip(SECONDS, SPEED, strict=True):
        book.active.append([f"{time:.1f}".replace(".", ","), f"{speed:.6f}".replace(".", ",")])
    book.save(tmp_path / "log.xlsx")
    flight = sepcal.read(tmp_path / "log.xlsx")
    np.testing.assert_allclose(flight["airspeed_mps"], SPEED, atol=1e-6)


def test_messages_of_changing_fields(tmp_path):
    """In more than one block, in a chunk and outside of any; what a message lacks is missing."""
    writer_of = pytest.importorskip("mcap.writer").Writer
    rows = 5000
    for name, chunks in {"chunks.mcap": True, "plain.mcap": False}.items():
        with open(tmp_path / name, "wb") as opened:
            writer = writer_of(opened, use_chunking=chunks)
            writer.start()
            schema = writer.register_schema("any", "jsonschema", b"{}")
            air = writer.register_channel("/air", "json", schema)
            for row in range(rows):
                message = {"airspeed_mps": row * 0.5} if row % 7 else {"b": row, "a_m": {"x": 1.5}}
                text = ("\ufeff" if row == 3 else "") + json.dumps(message)
                writer.add_message(air, row * 10_000_000, text.encode(), 0)
            writer.finish()
        flight = sepcal.read(tmp_path / name)
        row = np.arange(rows)
        np.testing.assert_array_equal(flight["airspeed_mps"], np.where(row % 7, row * 0.5, np.nan))
        np.testing.assert_array_equal(flight["b"], np.where(row % 7, np.nan, row))
        np.testing.assert_array_equal(flight["a_m.x"], np.where(row % 7, np.nan, 1.5))
