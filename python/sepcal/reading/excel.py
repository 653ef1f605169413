# SPDX-License-Identifier: BSD-3-Clause
"""Excel's .xlsx by openpyxl: the sheet with the table is written as text, and read as a CSV is."""

from __future__ import annotations

import csv
import datetime
import os
import tempfile
import warnings
import zipfile
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from sepcal import _core
from sepcal.reading.extras import load
from sepcal.reading.limits import Budget
from sepcal.reading.rates import kinds_of
from sepcal.reading.table import Table, listed
from sepcal.reading.wanted import wanted
from sepcal.whole_files import open_scratch_text

WORKBOOK = "xl/workbook.xml"
MOST_CELLS = 50_000_000
FEWEST_NUMBERS = 2  # of a row of numbers, times among them
NUMBERS = (int, float, datetime.datetime, datetime.time)
ROWS_OF_A_LOG = 10


@dataclass
class Sheet:
    """A sheet as text: its name, file, rows of two numbers or more, and longest row of words."""

    name: str
    text: str
    rows: int = 0
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
            with open(file, "rb") as opened:  # by its name openpyxl looks at the ending
                book = openpyxl.load_workbook(
                    opened, read_only=True, data_only=True, keep_links=False
                )
                sheets = _write_sheets(file, book, chosen, folder, budget)
        except (_core.Error, MemoryError):
            raise
        except Exception as error:  # what openpyxl raises of damage is of any kind
            what = " ".join(str(error).split())[:200] or type(error).__name__
            raise _core.Error(f"{file}: the workbook is damaged or cut off: {what}") from error
        sheet = _choose(file, sheets, chosen)
        others = [s.name for s in sheets if s is not sheet]
        return _read_text(name, sha256, sheet, others)


def _write_sheets(
    file: str,
    book: Any,  # noqa: ANN401
    chosen: str | None,
    folder: str,
    budget: Budget,
) -> list[Sheet]:
    names = [sheet.title for sheet in book.worksheets]
    if chosen is not None and chosen not in names:
        raise _core.Error(f"{file}: there is no sheet '{chosen}'; it has {listed(names)}")
    sheets = []
    for number, worksheet in enumerate(book.worksheets):
        if chosen is not None and worksheet.title != chosen:
            continue
        worksheet.reset_dimensions()
        sheet = Sheet(worksheet.title, os.path.join(folder, f"{number}.csv"))
        _write(file, worksheet.iter_rows(values_only=True), sheet, budget)
        sheets.append(sheet)
    return sheets


def _write(file: str, rows: Iterable[tuple[Any, ...]], sheet: Sheet, budget: Budget) -> None:
    """Writes the sheet as text without its empty rows; shorter rows end in empty cells."""
    cells = width = 0
    with open_scratch_text(sheet.text) as opened:
        writer = csv.writer(opened, lineterminator="\n")
        for row in rows:
            end = len(row)
            while end and row[end - 1] is None:
                end -= 1
            cells += max(len(row), 1)
            if cells > MOST_CELLS:
                raise _core.Error(
                    f"{file}: sheet '{sheet.name}' has more than {MOST_CELLS:,} cells; "
                    "write it as CSV"
                )
            if not end:
                continue
            texts = [_text(cell) for cell in row[:end]]
            budget.take(sum(map(len, texts)) + end, f"sheet '{sheet.name}'")
            if sum(isinstance(cell, NUMBERS) for cell in row[:end]) >= FEWEST_NUMBERS:
                sheet.rows += 1
            elif sheet.rows == 0 and len(texts) >= len(sheet.words):
                sheet.words = texts
            width = max(width, end) if sheet.rows else width
            writer.writerow(
                texts + [""] * (max(width, len(sheet.words)) - end if sheet.rows else 0)
            )


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
