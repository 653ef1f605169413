# SPDX-License-Identifier: BSD-3-Clause
"""Tables in memory: of pandas, polars, Arrow and xarray, known by their types, none imported."""

from __future__ import annotations

from typing import Any

import numpy as np

from sepcal import _core
from sepcal.columns import NUMBERS
from sepcal.reading import arrow
from sepcal.reading.extras import load
from sepcal.reading.table import MANEUVER, Table
from sepcal.reading.units import with_unit


def is_frame(data: object) -> bool:
    """Whether it is such a table."""
    return _library_of(data) in READERS


def of_frame(data: object) -> Table:
    """The table, settled: its time is time_s. Raises Error for a shape that is no table."""
    table = READERS[_library_of(data)](data)
    table.settle()
    return table


def _library_of(data: object) -> str:
    for kind in type(data).__mro__:
        library = kind.__module__.partition(".")[0]
        if library in READERS and kind.__name__ in TYPES:
            return library
    return ""


def _of_pandas(frame: Any) -> Table:  # noqa: ANN401
    if type(frame).__name__ == "Series":
        raise _core.Error("a Series is one column; give a DataFrame")
    found = Table()
    index = frame.index
    if index.dtype.kind in "Mm" or hasattr(index.dtype, "tz"):
        found.add("time" if index.dtype.kind == "m" else str(index.name or "index"), _array(index))
        if index.dtype.kind == "m":
            found.columns["time_s"] = found.columns.pop("time")
    elif isinstance(index.name, str) and index.name not in frame.columns:
        found.add(index.name, _array(index))
    for place, header in enumerate(frame.columns):
        if not isinstance(header, str):
            raise _core.Error(
                f"a column is called {header!r}, and a name is one text: of a header of several "
                "rows df.columns = df.columns.get_level_values(-1) keeps the last"
                if isinstance(header, tuple)
                else f"a column is called {header!r}; its name must be a text"
            )
        if header in found.columns:
            raise _core.Error(f"column '{header}' is there twice")
        _add(found, header, frame.iloc[:, place])
    return found


def _add(found: Table, header: str, series: Any) -> None:  # noqa: ANN401
    """A column; one of plain numbers is not copied."""
    values = series.to_numpy() if isinstance(series.dtype, np.dtype) else _array(series)
    if values.dtype == np.float64 and header != MANEUVER:
        found.columns[header] = values
    else:
        found.add(header, values)


def _array(values: Any) -> np.ndarray:  # noqa: ANN401
    """NumPy's of pandas' own types: NaN for a missing number, UTC for dates."""
    kind = values.dtype
    if getattr(kind, "tz", None) is not None:
        accessor = getattr(values, "dt", values)
        values = accessor.tz_convert("UTC")
        values = getattr(values, "dt", values).tz_localize(None)
    if getattr(kind, "kind", "O") in NUMBERS:
        return np.asarray(values.to_numpy(dtype=np.float64, na_value=np.nan))
    return np.asarray(values.to_numpy())


def _of_polars(frame: Any) -> Table:  # noqa: ANN401
    if type(frame).__name__ == "LazyFrame":
        frame = frame.collect()
    found = Table()
    for series in frame.get_columns():
        kind = series.dtype
        if kind.is_decimal():
            series = series.cast(load("polars", "flight", "this table").Float64)
        elif getattr(kind, "time_zone", None) is not None:
            series = series.dt.convert_time_zone("UTC").dt.replace_time_zone(None)
        if kind.is_nested():
            found.left_out.append(series.name)
            continue
        found.add(series.name, np.asarray(series.to_numpy()))
    return found


def _of_xarray(data: Any) -> Table:  # noqa: ANN401
    """A Dataset's variables along its one dimension; a DataArray's as one."""
    if type(data).__name__ == "DataArray":
        data = data.to_dataset(name=data.name or "values")
    lengths = [v.dims[0] for v in data.variables.values() if v.ndim == 1]
    if not lengths:
        raise _core.Error("the Dataset has no variable of one dimension; a flight's has its time")
    dimension = max(set(lengths), key=lambda name: (lengths.count(name), name == "time"))
    found = Table()
    for name in (*data.coords, *data.data_vars):
        variable = data[name]
        if variable.dims != (dimension,):
            if variable.ndim:
                found.left_out.append(str(name))
            continue
        found.add(
            with_unit(str(name), variable.attrs.get("units", "")), np.asarray(variable.values)
        )
    return found


READERS = {
    "pandas": _of_pandas,
    "polars": _of_polars,
    "pyarrow": arrow.of_table,
    "xarray": _of_xarray,
}
TYPES = {"DataFrame", "Series", "LazyFrame", "Table", "RecordBatch", "Dataset", "DataArray"}
