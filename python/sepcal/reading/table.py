# SPDX-License-Identifier: BSD-3-Clause
"""A reader's result: columns of one length by header, and what it decided about them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from sepcal import _core
from sepcal.columns import NUMBERS, Array, to_labels
from sepcal.printing import as_utf8
from sepcal.reading.clock import is_clock, seconds_of, settle_clock

MANEUVER = "maneuver"
SHOWN = 6  # names in a note


@dataclass
class Table:
    """Columns of N rows.

    Attributes:
        columns: Numbers (N,) by header, NaN where a cell holds none.
        dates: Columns of dates (N,), datetime64 in UTC, until settle() makes time_s of one.
        labels: Column "maneuver", a text a row, or empty.
        notes: Decisions, one line each.
        name: The table's name in the file: a group, a topic, a sheet.
        left_out: Columns that hold no numbers, until settle() notes them.
        day: From whose midnight, UTC, its time counts; nothing where it has no dates.
    """

    columns: dict[str, Array] = field(default_factory=dict)
    dates: dict[str, np.ndarray] = field(default_factory=dict)
    labels: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    name: str = ""
    left_out: list[str] = field(default_factory=list)
    day: str = ""

    @property
    def rows(self) -> int:
        """N."""
        columns = (*self.columns.values(), *self.dates.values())
        return len(columns[0]) if columns else len(self.labels)

    @property
    def clock(self) -> str | None:
        """The header of its time, once settled."""
        return next((header for header in self.columns if is_clock(header)), None)

    def add(self, header: str, values: np.ndarray) -> None:
        """A column of anything (N,): numbers, dates, or texts of either; others are left out."""
        if header == MANEUVER and not self.labels:
            self.labels = [text_of(value) for value in values]
            return
        if values.dtype.kind == "M":
            self.dates[header] = values
            return
        if values.dtype.kind == "m":
            self.columns[header] = seconds_of(values)
            return
        numbers = to_numbers(values)
        if numbers is not None:
            self.columns[header] = numbers
        elif (dates := to_dates(header, values)) is not None:
            self.dates[header] = dates
        else:
            self.left_out.append(header)

    def settle(self) -> None:
        """Makes time_s of the dates or of a clock without a unit, and notes what was left out."""
        self.day = settle_clock(self.columns, self.dates, self.notes) or self.day
        self.dates = {}
        if self.left_out:
            self.notes.append(f"left out, for they hold no numbers: {listed(self.left_out)}")
            self.left_out = []


def to_core(file: str, sha256: str, table: Table) -> _core.Flight:
    """The flight. Raises Error for a table without rows, or names that no UTF-8 is of."""
    table.settle()
    if table.rows == 0:
        raise _core.Error(f"{file}: no column of numbers is in it")
    flight = _core.Flight(file, sha256)
    for header, values in table.columns.items():
        as_utf8(f"{file}: the column's name", header)
        flight.view(
            header, np.require(values, dtype=np.float64, requirements=["C_CONTIGUOUS", "ALIGNED"])
        )
    if table.labels:
        flight.label(to_labels(table.labels))
    for note in table.notes:
        flight.note(f"{file}: {note}")
    return flight


def listed(names: Iterable[str]) -> str:
    """Names in a note, not all of many."""
    every = list(names)
    more = f" and {len(every) - SHOWN} more" if len(every) > SHOWN else ""
    return ", ".join(every[:SHOWN]) + more


def text_of(value: object) -> str:
    """A label: nothing for a missing one."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    missing = value is None or value != value
    return "" if missing else str(value)


def to_numbers(values: np.ndarray) -> Array | None:
    """Numbers of numbers, or of texts that are such; None where a text is none."""
    if values.dtype.kind in NUMBERS:
        return np.asarray(values, dtype=np.float64)
    if values.dtype.kind not in "OSUT":
        return None
    numbers = np.full(len(values), np.nan)
    for row, value in enumerate(values):
        try:
            if value is not None and (text := text_of(value).strip()):
                numbers[row] = float(text)
        except (TypeError, ValueError):
            return None
    return numbers if np.isfinite(numbers).any() else None


def to_dates(header: str, values: np.ndarray) -> np.ndarray | None:
    """Dates of texts by ISO 8601, of date objects, in UTC; None where they are none."""
    if values.dtype.kind not in "OSUT":
        return None
    dates = np.full(len(values), np.datetime64("NaT"), dtype="datetime64[ns]")
    try:
        for row, value in enumerate(values):
            if text := text_of(value).strip():
                dates[row] = _date_of(text)
    except (TypeError, ValueError, OverflowError):
        return None
    return None if np.isnat(dates).all() else dates


def _date_of(text: str) -> np.datetime64:
    """By ISO 8601, with an offset or Z or neither. Raises ValueError for no such text."""
    zone = 0
    if text[-1] in "zZ":
        text = text[:-1]
    elif len(text) > 16 and text[-6] in "+-" and text[-3] == ":":
        zone = int(text[-6] + "1") * (60 * int(text[-5:-3]) + int(text[-2:]))
        text = text[:-6]
    if len(text) < 10 or text[4] != "-" or text[7] != "-":
        raise ValueError(text)
    return np.datetime64(text, "ns") - np.timedelta64(zone, "m")
