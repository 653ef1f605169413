# SPDX-License-Identifier: BSD-3-Clause
"""HDF5: groups of datasets, also as netCDF-4, MATLAB (v7.3) and pandas write them.

What a file links to outside of itself is not read.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from sepcal import _core
from sepcal.reading.extras import load
from sepcal.reading.limits import Budget
from sepcal.reading.pandas_hdf import pandas_frame, pandas_table
from sepcal.reading.rates import join_tables
from sepcal.reading.table import Table, listed
from sepcal.reading.trees import Tree, tables_in
from sepcal.reading.units import with_unit

MAGIC = b"\x89HDF\r\n\x1a\n"
DEEPEST = 16
MOST_NODES = 20_000
INDEX_OF_PYTABLES = "_i_"
STEPS = {"nanosecond": 1, "microsecond": 1_000, "millisecond": 1_000_000, "second": 1_000_000_000}
STEPS |= {"minute": 60 * STEPS["second"], "hour": 3600 * STEPS["second"]}
STEPS |= {"day": 86_400 * STEPS["second"]}
START = re.compile(  # year, month, day, hour, minute, second, the zone's sign, hours, minutes
    r"(\d{4})-(\d{1,2})-(\d{1,2})(?:[T ]\s*(\d{1,2}):(\d{1,2})(?::(\d{1,2}(?:\.\d*)?))?)?"
    r"\s*(?:Z|UTC|GMT|([+-])(\d{1,2}):?(\d{2})?)?"
)
UNITS = ("units", "unit", "Units", "Unit", "UNITS")


def read(file: str, chosen: str | None) -> Table:
    """The table. Raises Error for what is damaged, too large or holds no table."""
    h5py = load("h5py", file, "HDF5")
    try:
        with h5py.File(file, "r") as opened:
            reader = Reader(file, h5py)
            tables = tables_in(reader.tree_of(opened))
    except _core.Error:
        raise
    except Exception as error:  # what h5py raises of damage is of any kind
        raise _core.Error(f"{file}: the HDF5 file is damaged or cut off: {error}") from error
    left_out = f"left out, for h5py can't read their type: {listed(reader.unread)}"
    if reader.unread and not tables:
        raise _core.Error(
            f"{file}: no table is in it that can be read; {left_out}; write numbers and times as "
            "float64"
        )
    table = join_tables(file, tables, chosen)
    if reader.unread:
        table.notes.append(left_out)
    return table


class Reader:
    """The numbers, texts and groups of an open file as a tree."""

    def __init__(self, file: str, h5py: Any) -> None:  # noqa: ANN401
        self.h5py = h5py
        self.unread: list[str] = []  # datasets of a type that h5py doesn't know
        self._file, self._budget, self._left = file, Budget(file), MOST_NODES

    def tree_of(self, group: Any, depth: int = 0) -> Tree:  # noqa: ANN401
        """A group's."""
        if depth > DEEPEST:
            raise _core.Error(f"{self._file}: its groups are more than {DEEPEST} deep")
        if {"axis0", "axis1", "block0_items", "block0_values"} <= set(group):
            return pandas_frame(self, group)
        if "table" in group and "index_kind" in group["table"].attrs:
            return pandas_table(self, group["table"])
        found: dict[str, np.ndarray | Tree] = {}
        for name, node in self.nodes_of(group):
            if isinstance(node, self.h5py.Group):
                found[name] = self.tree_of(node, depth + 1)
            elif (values := self.values_of(node)) is not None:
                found[with_unit(name, _unit_of(node))] = _in_dates(node, values)
        return found

    def nodes_of(self, group: Any) -> list[tuple[str, Any]]:  # noqa: ANN401
        """The members of a group by links of its own; none outside the file."""
        found = []
        for name in group:
            self._left -= 1
            if self._left < 0:
                raise _core.Error(
                    f"{self._file}: it has more than {MOST_NODES} groups and datasets"
                )
            if name.startswith(INDEX_OF_PYTABLES):
                continue
            if isinstance(group.get(name, getlink=True), self.h5py.HardLink):
                found.append((name, group[name]))
        return found

    def values_of(self, dataset: Any) -> np.ndarray | None:  # noqa: ANN401
        """A dataset's; None of what is neither numbers nor texts, or lies in other files."""
        if not isinstance(dataset, self.h5py.Dataset) or dataset.shape is None:
            return None
        if dataset.is_virtual or dataset.external or dataset.ndim > 2:
            return None
        try:
            kind = dataset.dtype
        except (TypeError, ValueError):  # HDF5's own time, numbers longer than 8 bytes
            self.unread.append(dataset.name)
            return None
        self._check_packing(dataset)
        size = int(np.prod(dataset.shape, dtype=object)) * max(kind.itemsize, 8)
        self._budget.take(size, f"'{dataset.name}'")
        if kind.kind == "O":
            if self.h5py.check_string_dtype(kind) is None:
                return None
            return np.asarray(dataset.asstr(errors="replace")[()], dtype=object)
        return _as_numbers(dataset, np.asarray(dataset[()])) if kind.kind in "fiubSV" else None

    def _check_packing(self, dataset: Any) -> None:  # noqa: ANN401
        """Raises Error for a filter that h5py doesn't bring, as Blosc of PyTables."""
        made = dataset.id.get_create_plist()
        for at in range(made.get_nfilters()):
            code, _, _, name = made.get_filter(at)
            if not self.h5py.h5z.filter_avail(code):
                called = name.decode("utf-8", "replace") or str(code)
                raise _core.Error(
                    f"{self._file}: '{dataset.name}' is packed by '{called}', which h5py can't "
                    "unpack; pack it by zlib: ptrepack --complib=zlib --complevel=1 OLD.h5 NEW.h5"
                )


def _unit_of(dataset: Any) -> object:  # noqa: ANN401
    return next((dataset.attrs[name] for name in UNITS if name in dataset.attrs), "")


def _as_numbers(dataset: Any, values: np.ndarray) -> np.ndarray:  # noqa: ANN401
    """As netCDF packs them: a fill value is no number, then scale_factor and add_offset."""
    if values.dtype.kind not in "fiu":
        return values
    fill = dataset.attrs.get("_FillValue")
    scale, offset = (dataset.attrs.get(n, d) for n, d in (("scale_factor", 1), ("add_offset", 0)))
    if fill is None and "scale_factor" not in dataset.attrs and "add_offset" not in dataset.attrs:
        return values
    numbers = values.astype(np.float64)
    if fill is not None:
        numbers[values == np.ravel(fill)[0]] = np.nan
    return np.asarray(numbers * float(np.ravel(scale)[0]) + float(np.ravel(offset)[0]))


def _in_dates(dataset: Any, values: np.ndarray) -> np.ndarray:  # noqa: ANN401
    """Dates of netCDF's "seconds since 2026-03-01 12:00"; other values as they are."""
    unit = _unit_of(dataset)
    text = unit.decode("utf-8", "replace") if isinstance(unit, bytes) else str(unit)
    step, since, start = text.partition(" since ")
    size = STEPS.get(step.strip().lower().rstrip("s"))
    zero = _start_of(start) if since and size else None
    if size is None or zero is None or values.dtype.kind not in "fiu" or values.ndim != 1:
        return values
    is_float = values.dtype.kind == "f"
    spans = np.round(values * float(size)) if is_float else values.astype(np.int64) * size
    return np.asarray(zero + spans.astype("timedelta64[ns]"))


def _start_of(text: str) -> np.datetime64 | None:
    """The date from which netCDF counts, in UTC: "1970-1-1 0:00:00 +01:00"; None of no such."""
    found = START.fullmatch(text.strip())
    if found is None:
        return None
    year, month, day, hour, minute, second, sign, hours, minutes = found.groups()
    try:
        zero = np.datetime64(f"{int(year):04d}-{int(month):02d}-{int(day):02d}", "ns")
    except ValueError:
        return None
    zone = int(f"{sign}1") * (60 * int(hours) + int(minutes or 0)) if sign else 0
    seconds = 3600 * int(hour or 0) + 60 * (int(minute or 0) - zone)
    parts = round(float(second or 0) * 1e9)
    return zero + np.timedelta64(seconds * 1_000_000_000 + parts, "ns")
