# SPDX-License-Identifier: BSD-3-Clause
"""Several tables of a file as one: rows of the measured sensor, all else brought there.

A table measures what its headers say: three axes of a magnetometer, or an airspeed or pressures.
What is slower is interpolated between its samples, what is twice as fast is averaged, and neither
crosses a gap (sepcal.logs.time_base), as in the logs of autopilots. Angles go the short way round.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.logs.recording import make_channel
from sepcal.logs.time_base import bring, label_at
from sepcal.reading.clock import TIME, is_clock
from sepcal.reading.table import Table, listed
from sepcal.reading.units import SECONDS, quantity_of
from sepcal.reading.wanted import AIR, MAGNETIC, wanted

AIR_WORDS = {
    "airspeed",
    "true_airspeed",
    "tas",
    "dp",
    "dpa",
    "pt",
    "alpha",
    "differential_pressure",
}
TURNS = {"deg": 360.0, "rad": 2 * np.pi}


def kinds_of(table: Table) -> set[str]:
    """The kinds of reading that the table has: MAGNETIC, AIR, both or nothing."""
    quantities = {quantity_of(header)[0] for header in table.columns}
    words = {re.sub(r"[^a-z]", "", quantity) for quantity in quantities}
    kinds = set()
    if any(all(start + axis in words for axis in "xyz") for start in ("m", "mag", "magnet")):
        kinds.add(MAGNETIC)
    if quantities & AIR_WORDS:
        kinds.add(AIR)
    return kinds


def join_tables(file: str, tables: Sequence[Table], chosen: str | None = None) -> Table:
    """One table of several.

    Args:
        file: Opens messages.
        tables: Settled, each with a time, or of as many rows as the one that is chosen.
        chosen: The name of the table whose rows are taken; None: of the one that measures.

    Raises:
        Error: No table, none of that name, or several that it could be.
    """
    if not tables:
        raise _core.Error(
            f"{file}: no table of numbers is in it: columns of one length, two rows or more"
        )
    bases = _choose(file, tables, chosen)
    others = [table for table in tables if not any(table is base for base in bases)]
    if len(bases) == 1:
        return _around(bases[0], tables)
    return one_below_the_other([_around(base, [base, *others]) for base in bases])


def _choose(file: str, tables: Sequence[Table], chosen: str | None) -> list[Table]:
    """The table whose rows are taken, or one of each kind where nobody said which is measured."""
    if chosen is not None:
        named = [table for table in tables if table.name.strip("/") == chosen.strip("/")]
        if not named:
            raise _core.Error(
                f"{file}: there is no table '{chosen}'; it has {listed(t.name for t in tables)}"
            )
        return named[:1]
    if len(tables) == 1:
        return list(tables)
    kinds = [wanted()] if wanted() else [MAGNETIC, AIR]
    found: list[Table] = []
    for kind in kinds:
        able = [table for table in tables if kind in kinds_of(table)]
        if len(able) > 1:
            raise _ambiguous(file, able)
        found += [table for table in able if table not in found]
    if found:
        return found
    with_time = [table for table in tables if table.clock]
    if len(with_time) != 1:
        raise _ambiguous(file, with_time or tables)
    return with_time


def _ambiguous(file: str, tables: Sequence[Table]) -> _core.Error:
    names = listed(f"'{table.name}'" for table in tables)
    return _core.Error(
        f"{file}: which of the tables {names} is measured? Name one behind the file: "
        f"'{file}::{tables[0].name}'"
    )


def _around(base: Table, tables: Sequence[Table]) -> Table:
    """The base with the columns of all others at its rows."""
    joined = Table(
        dict(base.columns), {}, list(base.labels), list(base.notes), base.name, day=base.day
    )
    others = [table for table in tables if table is not base]
    if others:
        joined.notes.insert(0, f"rows are those of table '{base.name}'")
    left_out = [table.name for table in others if not _bring_table(table, joined, base)]
    if left_out:
        joined.notes.append(f"tables without a time at these rows are left out: {listed(left_out)}")
    return joined


def _bring_table(table: Table, joined: Table, base: Table) -> bool:
    """Whether the table has something to bring, which then stands in `joined`."""
    mine, theirs = base.clock, table.clock
    values = {header: v for header, v in table.columns.items() if not is_clock(header)}
    if theirs is None or mine is None:
        if table.rows != base.rows:
            return False
        _put(joined, table, values)
        joined.notes.append(f"table '{table.name}' joins row by row")
        return True
    stamps, times = _in_seconds(base, mine), _in_seconds(table, theirs, base.day)
    unwrapped = np.stack([_unwrap(header, column) for header, column in values.items()], axis=1)
    how, brought = "", {}
    for index, header in enumerate(values):
        channel = make_channel(header, times, unwrapped[:, index])
        if channel is None:
            continue
        column, how = bring(channel, stamps, hold=False)
        if np.isfinite(column).any():
            brought[header] = _wrap(header, column[:, 0], values[header])
    if not brought:
        return False
    _put(joined, table, brought)
    if table.labels and not joined.labels:
        joined.labels = label_at(times, tuple(table.labels), stamps)
    joined.notes.append(f"table '{table.name}' comes to these rows {how}")
    return True


def _put(joined: Table, table: Table, columns: dict[str, Array]) -> None:
    group = table.name.strip("/") or "root"
    for header, values in columns.items():
        free = header if header not in joined.columns else f"{group}.{header}"
        joined.columns[free] = values


def _in_seconds(table: Table, clock: str, day: str = "") -> Array:
    """The table's time [s], from the midnight of `day` where both have dates."""
    factor = SECONDS.get(quantity_of(clock)[1], 1.0)
    seconds = table.columns[clock] * factor if factor != 1.0 else table.columns[clock]
    if day and table.day and day != table.day:
        seconds = seconds + (np.datetime64(table.day, "s") - np.datetime64(day, "s")).astype(float)
    return seconds


def _unwrap(header: str, values: Array) -> Array:
    """Angles without jumps of half a turn; other columns as they are."""
    turn = TURNS.get(quantity_of(header)[1])
    known = np.isfinite(values)
    if turn is None or not known.any():
        return values
    whole = values.copy()
    whole[known] = np.unwrap(values[known], period=turn)
    return whole


def _wrap(header: str, column: Array, logged: Array) -> Array:
    """Angles within the turn in which they were logged."""
    turn = TURNS.get(quantity_of(header)[1])
    if turn is None:
        return column
    low = -turn / 2 if np.nanmin(logged) < 0 else 0.0
    over = np.nanmax(np.abs(np.diff(logged))) > turn / 2 if logged.size > 1 else False
    return low + np.mod(column - low, turn) if over else column


def one_below_the_other(tables: Sequence[Table]) -> Table:
    """The rows of each table, by time; what another measures is empty there."""
    if len(tables) == 1:
        return tables[0]
    stamps = np.concatenate([_in_seconds(t, t.clock or "", tables[0].day) for t in tables])
    order = np.argsort(stamps, kind="stable")
    headers = dict.fromkeys(h for table in tables for h in table.columns if not is_clock(h))
    columns = {TIME: stamps[order]}
    for header in headers:
        parts = [table.columns.get(header, np.full(table.rows, np.nan)) for table in tables]
        columns[header] = np.concatenate(parts)[order]
    labels = [label for table in tables for label in table.labels]
    names = [table.name for table in tables]
    notes = [
        f"rows of {' and of '.join(names)} stand in one table; --join linear takes those of the "
        f"one that is fitted, '::{names[0]}' behind the file those of {names[0]} alone"
    ]
    notes += dict.fromkeys(note for table in tables for note in table.notes)
    return Table(
        columns,
        labels=[labels[row] for row in order] if len(labels) == len(order) else [],
        notes=notes,
    )
