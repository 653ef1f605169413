# SPDX-License-Identifier: BSD-3-Clause
"""A log in forms that have a library, read by sepcal and by a careful user with that library.

Every reader ends with one array of numbers a column. A library that isn't there is left out.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

import sepcal
from benchmarks.race import Competitor, Result, judge, race
from sepcal.columns import Array

NOON = 1_772_366_400  # [s], 1 March 2026, 12:00 UTC
SUMMED = ("airspeed_mps", "p_pa")
Columns = Mapping[str, Array]


def write_parquet(columns: Columns, file: Path) -> None:
    """As pandas does by default, packed by Snappy."""
    pa, parquet = import_module("pyarrow"), import_module("pyarrow.parquet")
    parquet.write_table(pa.table(dict(columns)), file)


def write_feather(columns: Columns, file: Path) -> None:
    """As pandas does by default, packed by LZ4."""
    pa, feather = import_module("pyarrow"), import_module("pyarrow.feather")
    feather.write_feather(pa.table(dict(columns)), file)


def write_hdf5(columns: Columns, file: Path) -> None:
    """A group of datasets, packed by zlib."""
    import h5py

    with h5py.File(file, "w") as opened:
        for header, values in columns.items():
            opened.create_dataset(f"log/{header}", data=values, compression="gzip")


def write_matlab(columns: Columns, file: Path) -> None:
    """A struct, packed, as MATLAB does."""
    from scipy.io import savemat

    savemat(file, {"log": dict(columns)}, do_compression=True, oned_as="column")


def write_excel(columns: Columns, file: Path) -> None:
    """One sheet."""
    book = import_module("openpyxl").Workbook(write_only=True)
    sheet = book.create_sheet("log")
    sheet.append(list(columns))
    for row in zip(*(values.tolist() for values in columns.values()), strict=True):
        sheet.append(row)
    book.save(file)


def write_mcap(columns: Columns, file: Path) -> None:
    """One topic, a message a row in JSON, in chunks packed by Zstandard."""
    headers = [header for header in columns if header != "time_s"]
    with open(file, "wb") as opened:
        writer = import_module("mcap.writer").Writer(opened)
        writer.start()
        schema = writer.register_schema("log", "jsonschema", b"{}")
        channel = writer.register_channel("/log", "json", schema)
        for seconds, *row in zip(*(values.tolist() for values in columns.values()), strict=True):
            at = NOON * 10**9 + round(seconds * 1e9)
            text = json.dumps(dict(zip(headers, row, strict=True)))
            writer.add_message(channel, at, text.encode(), at)
        writer.finish()


def by_pandas(file: Path) -> Any:  # noqa: ANN401
    """The text table."""
    import pandas as pd

    return pd.read_csv(file)


def by_calamine(file: Path) -> Any:  # noqa: ANN401
    """The sheet."""
    import pandas as pd

    return pd.read_excel(file, engine="calamine")


def by_pyarrow(file: Path) -> Any:  # noqa: ANN401
    """Parquet."""
    return import_module("pyarrow.parquet").read_table(file, use_threads=False)


def by_feather(file: Path) -> Any:  # noqa: ANN401
    """Arrow's file."""
    return import_module("pyarrow.feather").read_table(file, use_threads=False)


def by_h5py(file: Path) -> Any:  # noqa: ANN401
    """The group's datasets."""
    import h5py

    with h5py.File(file) as opened:
        return {name: dataset[()] for name, dataset in opened["log"].items()}


def by_scipy(file: Path) -> Any:  # noqa: ANN401
    """The struct's fields."""
    from scipy.io import loadmat

    found = loadmat(file, squeeze_me=True)["log"]
    return {name: found[name].item() for name in found.dtype.names}


def by_mcap(file: Path) -> Any:  # noqa: ANN401
    """The topic's messages."""
    from mcap.reader import make_reader

    columns: dict[str, list[float]] = {}
    with open(file, "rb") as opened:
        for _, _, message in make_reader(opened).iter_messages():
            for header, value in json.loads(message.data).items():
                columns.setdefault(header, []).append(value)
    return {header: np.array(values) for header, values in columns.items()}


Writer = Callable[[Columns, Path], None]
Reader = Callable[[Path], Any]
FORMS: dict[str, tuple[str, tuple[str, ...], Writer, str, Reader]] = {
    "Parquet": ("log.parquet", ("pyarrow",), write_parquet, "pyarrow", by_pyarrow),
    "Feather": ("log.feather", ("pyarrow",), write_feather, "pyarrow", by_feather),
    "HDF5": ("log.h5", ("h5py",), write_hdf5, "h5py", by_h5py),
    "MATLAB": ("log.mat", ("scipy",), write_matlab, "SciPy", by_scipy),
    "Excel": (
        *("log.xlsx", ("openpyxl", "pandas", "python_calamine")),
        *(write_excel, "pandas with calamine", by_calamine),
    ),
    "MCAP": ("log.mcap", ("mcap",), write_mcap, "mcap and json", by_mcap),
}


def race_libraries(folder: Path, plain: Path, columns: Columns, rounds: int) -> Result:
    """All forms of one log beside the same as plain CSV, and each beside its library."""

    def competitor(name: str, file: Path, read: Reader) -> Competitor:
        def run() -> tuple[float, np.ndarray]:
            began = time.process_time()
            flight = read(file)
            spent = time.process_time() - began
            return spent, np.array([np.asarray(flight[header]).sum() for header in SUMMED])

        return Competitor(name, run)

    racing = [competitor("plain CSV, sepcal", plain, sepcal.read)]
    if find_spec("pandas"):
        racing.append(competitor("plain CSV, pandas", plain, by_pandas))
    missing = []
    for form, (name, needed, write, library, read) in FORMS.items():
        if not all(map(find_spec, needed)):
            missing.append(form)
            continue
        write(columns, folder / name)
        racing.append(competitor(f"{form}, sepcal", folder / name, sepcal.read))
        racing.append(competitor(f"{form}, {library}", folder / name, read))
    race(racing, rounds)
    rows = len(columns["time_s"])
    title = f"Reading a log of {len(columns)} columns, {rows:,} rows, by sepcal and by libraries"
    off = "of a sum"
    result = judge("reading", title, racing, lambda d: float(np.max(np.abs(d))), off)
    pairs = zip(result.lines[1:], result.lines[2:], strict=False)
    ratios = {a.name: a.median / b.median for a, b in pairs if a.name.endswith(", sepcal")}
    told = ", ".join(f"{name.partition(',')[0]} {ratio:.2g}" for name, ratio in ratios.items())
    result.notes.append(f"sepcal's time over the library's: {told}.")
    if missing:
        result.notes.append(f"Left out for want of a library: {', '.join(missing)}.")
    return result
