# SPDX-License-Identifier: BSD-3-Clause
"""Tables out of a tree of arrays, as HDF5 groups and MATLAB structs are.

In a group, arrays of one length are a table. An array (N, k) is k columns `name[0]` ..., called
as a list beside it says (`name_label`, as logs of ArduPilot have it). A group without a time
takes one of that length from the group above. A group of nothing but a time and its data is a
channel: a column, called as the group is; channels that share a time are a table.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from sepcal.reading.clock import PARTS, is_clock
from sepcal.reading.table import Table
from sepcal.reading.units import quantity_of, with_unit

Tree: TypeAlias = "Mapping[str, np.ndarray | Tree]"
MOST_WIDE = 64  # columns of an array (N, k)
FEWEST_ROWS = 2
ROOT = "/"  # the name of a table outside of all groups
NAMES_OF = ("_label", "_labels", "_names", "_columns", "_headers")
DATA = {"data", "value", "values", "samples", "signal"}  # a channel's own column
UNITS_OF = ("units", "unit")  # a text in a channel
ABOUT = ("info", "properties")  # ends of groups that say something of a channel


class Channel(NamedTuple):
    """A group that is one column, or one a component.

    Attributes:
        name: The group's, with its unit.
        clock: The header of its time, or nothing: that of the group above.
        times: (N,), or nothing.
        values: (N,) or (N, k).
    """

    name: str
    clock: str
    times: np.ndarray
    values: np.ndarray


def tables_in(tree: Tree, path: str = "", above: Table | None = None) -> list[Table]:
    """The tables, from the root down; `path` names a group: "imu/mag"."""
    columns = {name: leaf for name, leaf in tree.items() if isinstance(leaf, np.ndarray)}
    tables = _of_one_group(columns, path)
    for table in tables:
        _take_clock_from(above, table)
    own = next((table for table in tables if table.clock), above)
    found = [table for table in tables if set(table.columns) - {"time_s"}]
    channels = []
    for name, branch in tree.items():
        if not isinstance(branch, Mapping):
            continue
        if (channel := _as_channel(name, branch)) is not None:
            channels.append(channel)
        else:
            found += tables_in(branch, f"{path}/{name}" if path else name, own)
    return found + _of_channels(channels, path, own)


def _as_channel(name: str, group: Tree) -> Channel | None:
    """The one column that a group is; None of any other group."""
    arrays = {n: np.squeeze(leaf) for n, leaf in group.items() if isinstance(leaf, np.ndarray)}
    if any(
        isinstance(leaf, Mapping) and not n.lower().endswith(ABOUT) for n, leaf in group.items()
    ):
        return None
    long = {n: a for n, a in arrays.items() if a.ndim and len(a) >= FEWEST_ROWS}
    clocks = [n for n in long if is_clock(n) and long[n].ndim == 1]
    data = [n for n in long if n not in clocks]
    if len(clocks) > 1 or len(data) != 1 or quantity_of(data[0])[0] not in DATA:
        return None
    values = long[data[0]]
    if clocks and len(long[clocks[0]]) != len(values):
        return None
    told = next((str(a) for n, a in arrays.items() if n.lower() in UNITS_OF and a.size == 1), "")
    unit = quantity_of(data[0])[1] or told
    clock = clocks[0] if clocks else ""
    return Channel(with_unit(name, unit), clock, long[clock] if clock else np.empty(0), values)


def _shares_time(one: Channel, other: Channel) -> bool:
    is_same = one.clock == other.clock and np.array_equal(one.times, other.times)
    return is_same and len(one.values) == len(other.values)


def _of_channels(channels: Sequence[Channel], path: str, above: Table | None) -> list[Table]:
    """A table of each time that channels share."""
    tables: list[tuple[Channel, Table]] = []
    for channel in channels:
        columns = _columns_of(channel.name, channel.values, {})
        table = next((t for first, t in tables if _shares_time(first, channel)), None)
        if table is None:
            table = Table(name=f"{path}/{channel.name}" if path else channel.name)
            tables.append((channel, table))
            if channel.clock:
                table.add(channel.clock, channel.times)
        for header, column in columns:
            table.add(header, column)
    if len(tables) == 1:
        tables[0][1].name = path or ROOT
    for _, table in tables:
        table.settle()
        _take_clock_from(above, table)
    return [table for _, table in tables if set(table.columns) - {"time_s"}]


def _of_one_group(columns: Mapping[str, np.ndarray], path: str) -> list[Table]:
    names = {name for name in columns if name.lower().endswith(NAMES_OF)}
    by_rows: dict[int, Table] = {}
    for name, values in columns.items():
        if name in names:
            continue
        for header, column in _columns_of(name, values, columns):
            if len(column) >= FEWEST_ROWS:
                by_rows.setdefault(len(column), Table(name=path or ROOT)).add(header, column)
    tables = [table for table in by_rows.values() if table.rows]
    if len(tables) > 1:
        for table in tables:
            headers = [*table.columns, *table.dates]
            first = next((h for h in headers if not is_clock(h)), headers[0])
            table.name = f"{path}/{first}" if path else first
    for table in tables:
        _name_clock(table)
        table.settle()
    return tables


def _columns_of(
    name: str, values: np.ndarray, beside: Mapping[str, np.ndarray]
) -> list[tuple[str, np.ndarray]]:
    values = np.squeeze(values) if values.ndim > 1 else values
    if values.dtype.names is not None and values.ndim == 1:
        return [
            found
            for part in values.dtype.names
            for found in _columns_of(part, values[part], beside)
        ]
    if values.ndim == 1:
        return [(name, values)]
    if values.ndim == 2 and values.shape[0] <= MOST_WIDE < values.shape[1]:
        values = values.T  # a row a channel
    if values.ndim != 2 or values.shape[1] > MOST_WIDE:
        return []
    called = next((beside[name + end] for end in NAMES_OF if name + end in beside), None)
    if called is None:
        called = _only_names_of(values.shape[1], beside)
    if called is not None and called.size == values.shape[1]:
        headers = [str(text).strip() for text in called.ravel()]
    else:
        headers = [f"{name}[{index}]" for index in range(values.shape[1])]
    return list(zip(headers, values.T, strict=True))


def _only_names_of(count: int, beside: Mapping[str, np.ndarray]) -> np.ndarray | None:
    """The group's one list of so many texts, where it has one array of several columns alone."""
    lists = [
        values
        for values in beside.values()
        if values.dtype.kind in "OU" and values.size == count > 1
        if all(isinstance(text, str) for text in values.ravel())
    ]
    tables = [values for values in beside.values() if np.squeeze(values).ndim == 2]
    return lists[0] if len(lists) == 1 and len(tables) == 1 else None


def _name_clock(table: Table) -> None:
    """A time under a name of its own, t_mag or mag_time_s, is the table's where there is one."""
    every = [*table.columns, *table.dates]
    if any(is_clock(header) for header in every):
        return
    named = [h for h in every if any(part in h.lower() for part in PARTS) or h[:2] == "t_"]
    if len(named) == 1 and named[0] in table.columns:
        unit = named[0].lower().rpartition("_")[2]
        header = f"time_{unit}" if unit in ("s", "ms", "us", "ns") else "time"
        values = table.columns.pop(named[0])
        table.columns = {header: values, **table.columns}
        table.notes.append(f"the time of its rows is '{named[0]}'")


def _take_clock_from(above: Table | None, table: Table) -> None:
    if above is None or table.clock or above.clock is None or above.rows != table.rows:
        return
    table.columns = {above.clock: above.columns[above.clock], **table.columns}
