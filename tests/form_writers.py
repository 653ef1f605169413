# SPDX-License-Identifier: BSD-3-Clause
"""Columns of a flight as a file of each form, by the form's own library."""

import json

import numpy as np
import pytest

NOON = np.datetime64("2026-03-01T12:00:00", "ns")
UNITS = {"time_s": "s", "vn_mps": "m/s", "ve_mps": "m s-1", "airspeed_mps": "m/s"}
UNITS |= {"mx_ut": "uT", "my_ut": "microtesla", "roll_rad": "radians", "altitude_m": "m"}


def bare(columns):
    """Names without the units that UNITS tells apart."""
    return {h.rpartition("_")[0] if h in UNITS else h: (h, v) for h, v in columns.items()}


def frame_of(columns):
    return pytest.importorskip("pandas").DataFrame(columns)


def write_parquet(columns, file):
    frame_of(columns).to_parquet(file)


def write_parquet_units(columns, file):
    import pyarrow as pa
    import pyarrow.parquet as pq

    fields, arrays = [], []
    for name, (header, values) in bare(columns).items():
        fields.append(pa.field(name, pa.float64(), metadata={"unit": UNITS.get(header, "")}))
        arrays.append(pa.array(values))
    pq.write_table(pa.Table.from_arrays(arrays, schema=pa.schema(fields)), file)


def write_feather(columns, file):
    frame_of(columns).to_feather(file, compression="zstd")


def write_arrow_stream(columns, file):
    import pyarrow as pa

    table = pa.table(columns)
    with pa.ipc.new_stream(file, table.schema) as stream:
        stream.write_table(table, max_chunksize=64)


def write_hdf5(columns, file):
    import h5py

    with h5py.File(file, "w") as opened:
        for name, (header, values) in bare(columns).items():
            opened.create_dataset(f"log/{name}", data=values, compression="gzip")
            opened[f"log/{name}"].attrs["units"] = UNITS.get(header, "")


def write_compound(columns, file):
    import h5py

    table = np.zeros(len(columns["time_s"]), dtype=[(h, "f8") for h in columns])
    for header, values in columns.items():
        table[header] = values
    with h5py.File(file, "w") as opened:
        opened["log"] = table


def write_pandas_fixed(columns, file):
    pytest.importorskip("tables")
    frame_of(columns).to_hdf(file, key="log", format="fixed")


def write_pandas_table(columns, file):
    pytest.importorskip("tables")
    frame_of(columns).to_hdf(file, key="log", format="table")


def write_matlab(columns, file):
    from scipy.io import savemat

    savemat(file, {**columns, "note": "a flight", "rate": 10.0}, oned_as="column")


def write_matlab_struct(columns, file):
    from scipy.io import savemat

    savemat(file, {"log": {"data": columns}, "names": "x"}, do_compression=True)


def write_matlab_matrix(columns, file):
    """As Mission Planner writes a DataFlash log: a matrix, and its columns' names beside it."""
    from scipy.io import savemat

    labels = np.array(list(columns), dtype=object)[:, None]
    savemat(file, {"LOG": np.column_stack(list(columns.values())), "LOG_label": labels})


def write_matlab_73(columns, file):
    """As MATLAB writes with -v7.3: HDF5 behind a block of 512 bytes, columns as rows."""
    import h5py

    with h5py.File(file, "w", userblock_size=512) as opened:
        for header, values in columns.items():
            opened[f"log/{header}"] = values[None, :]
            opened[f"log/{header}"].attrs["MATLAB_class"] = np.bytes_("double")
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\0\2IM"
    data = file.read_bytes()
    file.write_bytes(head + data[len(head) :])


def write_excel(columns, file):
    """Numbers with all their digits: Excel itself keeps 15."""
    import openpyxl

    book = openpyxl.Workbook()
    book.active.title = "about"
    book.active.append(["a flight of", "March"])
    sheet = book.create_sheet("log")
    sheet.append(list(columns))
    for row in zip(*(values.tolist() for values in columns.values()), strict=True):
        sheet.append(row)
    book.save(file)


def write_mcap(columns, file):
    from mcap.writer import Writer

    with open(file, "wb") as opened:
        writer = Writer(opened)
        writer.start()
        schema = writer.register_schema("log", "jsonschema", b"{}")
        channel = writer.register_channel("/log", "json", schema)
        for row in range(len(columns["time_s"])):
            message = {h: float(v[row]) for h, v in columns.items() if h != "time_s"}
            at = int(NOON.astype(np.int64)) + round(columns["time_s"][row] * 1e9)
            writer.add_message(channel, at, json.dumps(message).encode(), at)
        writer.finish()


WRITERS = {
    "a.parquet": write_parquet,
    "units.parquet": write_parquet_units,
    "a.feather": write_feather,
    "a.arrows": write_arrow_stream,
    "a.h5": write_hdf5,
    "compound.h5": write_compound,
    "fixed.h5": write_pandas_fixed,
    "table.h5": write_pandas_table,
    "a.mat": write_matlab,
    "struct.mat": write_matlab_struct,
    "matrix.mat": write_matlab_matrix,
    "new.mat": write_matlab_73,
    "a.xlsx": write_excel,
    "a.mcap": write_mcap,
}
