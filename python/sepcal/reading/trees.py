# SPDX-License-Identifier: BSD-3-Clause
"""Tables out of a tree of arrays, as HDF5 groups and MATLAB structs are.

In a group, arrays of one length are a table. An array (N, k) is k columns `name[0]` ..., called
as a list beside it says (`name_label`, as logs of ArduPilot have it). A group without a time
takes one of that length from the group above.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

import numpy as np

from sepcal.reading.clock import PARTS, is_clock
from sepcal.reading.table import Table

Tree: TypeAlias = "Mapping[str, np.ndarray | Tree]"
MOST_WIDE = 64  # columns of an array (N, k)
FEWEST_ROWS = 2
ROOT = "/"  # the name of a table outside of all groups
NAMES_OF = ("_label", "_labels", "_names", "_columns", "_headers")


def tables_in(tree: Tree, path: str = "", above: Table | None = None) -> list[Table]:
    """The tables, from the root down; `path` names a group: "imu/mag"."""
    columns = {name: leaf for name, leaf in tree.items() if isinstance(leaf, np.ndarray)}
    tables = _of_one_group(columns, path)
    for table in tables:
        _take_clock_from(above, table)
    own = next((table for table in tables if table.clock), above)
    found = [table for table in tables if set(table.columns) - {"time_s"}]
    for name, branch in tree.items():
        if isinstance(branch, Mapping):
            found += tables_in(branch, f"{path}/{name}" if path else name, own)
    return found


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
    if called is not None and called.size == values.shape[1]:
        headers = [str(text).strip() for text in called.ravel()]
    else:
        headers = [f"{name}[{index}]" for index in range(values.shape[1])]
    return list(zip(headers, values.T, strict=True))


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
