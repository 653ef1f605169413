# SPDX-License-Identifier: BSD-3-Clause
"""Excel's .xlsx: the sheet with the table is written as text, and read as a CSV is.

By python-calamine where it is there and may, and by openpyxl, to the same text.
"""

from __future__ import annotations

import csv
import datetime
import importlib
import os
import re
import tempfile
import warnings
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from sepcal import _core
from sepcal.reading.extras import load
from sepcal.reading.limits import Budget
from sepcal.reading.rates import kinds_of
from sepcal.reading.table import Table, listed
from sepcal.reading.wanted import wanted
from sepcal.reading.workbook_parts import copy_if_safe
from sepcal.whole_files import open_scratch_text

WORKBOOK = "xl/workbook.xml"
MOST_CELLS = 50_000_000
FEWEST_NUMBERS = 2  # of a row of numbers, times among them
NUMBERS = {bool, int, float, datetime.datetime, datetime.time}
AS_WRITTEN = {str, int, float, type(None)}  # by csv as by _text()
TYPED_NUMBER = re.compile(r"\s*[-+]?\d[\d.,' ]*(?:[eE][-+]?\d+)?\s*")
COUNTS, FLOATS = {int, float}, {float}
ROWS_OF_A_LOG = 10
LARGEST_COUNT = 1e15  # that a float holds without doubt


@dataclass
class Sheet:
    """A sheet as text.

    Attributes:
        name: As the workbook has it.
        text: The file.
        rows: Those of two numbers or more.
        typed: Those of two numbers or more that were typed as text.
        words: The longest row of words.
    """

    name: str
    text: str
    rows: int = 0
    typed: int = 0
    words: list[str] = field(default_factory=list)


def read_workbook(name: str, file: str, sha256: str, chosen: str | None) -> _core.Flight:
    """The flight, called `name`, of the file's one sheet with a table, or of the chosen one.

    Raises:
        Error: No such sheet, none or several with a table, what is damaged or too large.
    """
    openpyxl = load("openpyxl", file, "Excel's .xlsx")
    budget = Budget(file)
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of styles and extensions that nobody asks for
        try:
            with zipfile.ZipFile(file) as parts:
                budget.take(sum(part.file_size for part in parts.infolist()), "the workbook")
            sheets = _read_fast(file, chosen, folder, budget)
            if sheets is None:
                with open(file, "rb") as opened:  # by its name openpyxl looks at the ending
                    book = openpyxl.load_workbook(
                        opened, read_only=True, data_only=True, keep_links=False
                    )
                    sheets = _write_sheets(file, _sheets_of(book), chosen, folder, budget)
        except (_core.Error, MemoryError):
            raise
        except Exception as error:  # what openpyxl raises of damage is of any kind
            what = " ".join(str(error).split())[:200] or type(error).__name__
            raise _core.Error(f"{file}: the workbook is damaged or cut off: {what}") from error
        sheet = _choose(file, sheets, chosen)
        others = [s.name for s in sheets if s is not sheet]
        return _read_text(name, sha256, sheet, others)


def _read_fast(file: str, chosen: str | None, folder: str, budget: Budget) -> list[Sheet] | None:
    """By python-calamine; None where openpyxl has to, or to say what is wrong."""
    try:
        calamine = importlib.import_module("python_calamine")
    except ImportError:
        return None
    copy = copy_if_safe(file, folder)
    if copy is None:
        return None
    try:
        book = calamine.CalamineWorkbook.from_path(copy)
        names = [
            sheet.name
            for sheet in book.sheets_metadata
            if sheet.typ == calamine.SheetTypeEnum.WorkSheet
        ]
        return _write_sheets(
            file, {name: _rows_of(book, name) for name in names}, chosen, folder, budget
        )
    except calamine.CalamineError:
        return None


def _rows_of(book: Any, name: str) -> Iterator[Sequence[Any]]:  # noqa: ANN401
    """A sheet's rows as openpyxl gives them: no cell is None, and a date has a time."""
    sheet = book.get_sheet_by_name(name)
    before = [None] * (sheet.start[1] if sheet.start else 0)
    for row in sheet.iter_rows():
        if FLOATS.issuperset(map(type, row)):  # nearly always, and without a call a cell
            yield before + [cell if not cell.is_integer() else _as_openpyxl(cell) for cell in row]
        else:
            yield before + list(map(_as_openpyxl, row))


def _as_openpyxl(cell: object) -> object:
    if isinstance(cell, float):
        return int(cell) if abs(cell) < LARGEST_COUNT and cell.is_integer() else cell
    if isinstance(cell, datetime.date) and not isinstance(cell, datetime.datetime):
        return datetime.datetime.combine(cell, datetime.time())
    return None if cell == "" else cell


def _sheets_of(book: Any) -> dict[str, Iterable[Sequence[Any]]]:  # noqa: ANN401
    for worksheet in book.worksheets:
        worksheet.reset_dimensions()
    return {sheet.title: sheet.iter_rows(values_only=True) for sheet in book.worksheets}


def _write_sheets(
    file: str,
    sheets: Mapping[str, Iterable[Sequence[Any]]],
    chosen: str | None,
    folder: str,
    budget: Budget,
) -> list[Sheet]:
    if chosen is not None and chosen not in sheets:
        raise _core.Error(f"{file}: there is no sheet '{chosen}'; it has {listed(list(sheets))}")
    written = []
    for number, (name, rows) in enumerate(sheets.items()):
        if chosen is not None and name != chosen:
            continue
        sheet = Sheet(name, os.path.join(folder, f"{number}.csv"))
        _write(file, rows, sheet, budget)
        written.append(sheet)
    return written


def _write(file: str, rows: Iterable[Sequence[Any]], sheet: Sheet, budget: Budget) -> None:
    """Writes the sheet as text without its empty rows; shorter rows end in empty cells."""
    cells = width = 0
    with open_scratch_text(sheet.text) as opened:
        writer = csv.writer(opened, lineterminator="\n")
        for row in rows:
            cells += max(len(row), 1)
            if cells > MOST_CELLS:
                raise _core.Error(
                    f"{file}: sheet '{sheet.name}' has more than {MOST_CELLS:,} cells; "
                    "write it as CSV"
                )
            if (
                width
                and len(row) == width >= len(sheet.words)
                and COUNTS.issuperset(map(type, row))
            ):
                sheet.rows += 1  # as below, in one go
                text = ",".join(map(repr, row))
                budget.take(opened.write(text + "\n"), f"sheet '{sheet.name}'")
                continue
            end = len(row)
            while end and row[end - 1] is None:
                end -= 1
            if not end:
                continue
            written = [cell if type(cell) in AS_WRITTEN else _text(cell) for cell in row[:end]]
            if sum(type(cell) in NUMBERS for cell in row[:end]) >= FEWEST_NUMBERS:
                sheet.rows += 1
            elif sum(map(_is_typed_number, row[:end])) >= FEWEST_NUMBERS:
                sheet.typed += 1
            elif sheet.rows == 0 and end >= len(sheet.words):
                sheet.words = list(map(_text, written))
            width = max(width, end) if sheet.rows else width
            if sheet.rows:
                written += [""] * (max(width, len(sheet.words)) - end)
            budget.take(writer.writerow(written), f"sheet '{sheet.name}'")


def _is_typed_number(cell: object) -> bool:
    return isinstance(cell, str) and TYPED_NUMBER.fullmatch(cell) is not None


def _text(cell: object) -> str:
    if cell is None:
        return ""
    if isinstance(cell, bool):
        return str(int(cell))
    if isinstance(cell, float):
        return repr(cell)
    if isinstance(cell, datetime.datetime | datetime.time):
        return cell.isoformat()
    if isinstance(cell, datetime.timedelta):
        return repr(cell.total_seconds())
    return str(cell)


def _choose(file: str, sheets: list[Sheet], chosen: str | None) -> Sheet:
    if chosen is not None:
        return sheets[0]
    able = [s for s in sheets if s.rows >= ROWS_OF_A_LOG] or [s for s in sheets if s.rows]
    able = able or [s for s in sheets if s.typed >= ROWS_OF_A_LOG]
    if not able:
        raise _core.Error(f"{file}: no sheet holds a table of numbers")
    if len(able) > 1:
        measuring = [s for s in able if _measures(s)]
        if len(measuring) != 1:
            names = listed(f"'{s.name}'" for s in measuring or able)
            raise _core.Error(
                f"{file}: which of the sheets {names} is meant? Name one behind the file: "
                f"'{file}::{(measuring or able)[0].name}'"
            )
        able = measuring
    return able[0]


def _measures(sheet: Sheet) -> bool:
    import numpy as np

    kinds = kinds_of(Table({word: np.empty(0) for word in sheet.words}))
    return wanted() in kinds if wanted() else bool(kinds)


def _read_text(file: str, sha256: str, sheet: Sheet, others: list[str]) -> _core.Flight:
    try:
        read = _core.read_csv(sheet.text)
    except _core.Error as error:
        message = str(error).replace(sheet.text, f"{file} sheet '{sheet.name}'")
        raise _core.Error(message) from error
    _, _, columns, labels, notes = read.__getstate__()
    flight = _core.Flight.__new__(_core.Flight)
    more = f"; {listed(others)} not" if others else ""
    told = [f"{file}: sheet '{sheet.name}' is read{more}"]
    told += [note.replace(sheet.text, file) for note in notes]
    flight.__setstate__((file, sha256, columns, labels, told))
    return flight
