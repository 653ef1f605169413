# SPDX-License-Identifier: BSD-3-Clause
"""A file of any form as a flight: its form is found, and the form's reader asked."""

from __future__ import annotations

import gzip
import hashlib
import importlib
import os
import tempfile
import zlib
from collections.abc import Callable

from sepcal import _core
from sepcal.reading.excel import read_workbook
from sepcal.reading.forms import TABLE, find_form
from sepcal.reading.limits import Budget
from sepcal.reading.table import Table, to_core
from sepcal.whole_files import name_of, open_scratch

READERS = {
    "parquet": ("arrow", "read_parquet"),
    "arrow": ("arrow", "read_arrow"),
    "hdf5": ("hdf5", "read"),
    "matlab": ("matlab", "read"),
    "mcap": ("mcap_log", "read"),
    "igc": ("igc", "read"),
    "nmea": ("nmea", "read"),
    "autopilot": ("autopilot", "read"),
}
HAS_TABLES = ("hdf5", "matlab", "mcap", "autopilot", "excel")
CHUNK = 2**20


def is_text(file: str) -> bool:
    """Whether a file is a table as text, also one that isn't there."""
    place, _ = _part(file)
    return not os.path.isfile(place) or find_form(place) == TABLE


def read(file: str, table: str | None, delimiter: str, decimal: str) -> _core.Flight:
    """sepcal.reading.read_file()."""
    place, chosen = _part(file)
    if is_text(file):
        if table is not None or chosen is not None:
            raise _core.Error(f"{place}: it is one table as text; leave '{table or chosen}' out")
        return _core.read_csv(place, delimiter, decimal)
    if delimiter or decimal:
        raise _core.Error(f"{place}: it is no table as text; leave delimiter and decimal out")
    return _read(file, place, find_form(place), table if table is not None else chosen)


def read_other(file: str, form: str) -> _core.Flight:
    """sepcal.reading.read_foreign()."""
    place, chosen = _part(file)
    found = find_form(place)
    if found == TABLE and chosen is not None:
        raise _core.Error(f"{place}: it is one table as text; leave '{chosen}' out")
    if found == TABLE:
        what = f"{form}, which" if form else "its form"
        raise _core.Error(
            f"{file}: {what} sepcal does not read; write the table as CSV, Parquet or .xlsx"
        )
    return _read(file, place, found, chosen)


def _part(file: str) -> tuple[str, str | None]:
    """The file and what is behind "::", where no file has the whole name."""
    name = name_of(file)
    place, mark, chosen = name.rpartition("::")
    if mark and chosen and not os.path.exists(name) and os.path.exists(place):
        return place, chosen
    return name, None


def _read(file: str, place: str, form: str, chosen: str | None) -> _core.Flight:
    sha256 = _sha256(place)
    if form != "gzip":
        return _read_as(file, place, form, chosen, sha256)
    with tempfile.TemporaryDirectory() as folder:
        unpacked = os.path.join(folder, "log")
        _unpack(place, unpacked)
        try:
            return _read_as(file, unpacked, find_form(unpacked), chosen, sha256)
        except _core.Error as error:
            raise _core.Error(str(error).replace(unpacked, file)) from error


def _read_as(file: str, place: str, form: str, chosen: str | None, sha256: str) -> _core.Flight:
    if chosen is not None and form not in HAS_TABLES:
        raise _core.Error(f"{place}: it is one table; leave '{chosen}' out")
    try:
        if form == "excel":
            return read_workbook(file, place, sha256, chosen)
        module, function = READERS[form]
        reader: Callable[[str, str | None], Table] = getattr(
            importlib.import_module(f"sepcal.reading.{module}"), function
        )
        table = reader(place, chosen)
        table.settle()
        table.notes = [note.replace(place, file) for note in table.notes]
        return to_core(file, sha256, table)
    except OSError as error:
        raise _core.Error(f"{place}: can't be read: {error.strerror or error}") from error
    except MemoryError as error:
        raise _core.Error(f"{place}: memory ran out; write fewer columns or rows to it") from error


def _unpack(file: str, target: str) -> None:
    budget = Budget(file)
    try:
        with gzip.open(file) as opened, open_scratch(target) as unpacked:
            while piece := opened.read(CHUNK):
                budget.take(len(piece), "it")
                unpacked.write(piece)
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise _core.Error(f"{file}: the packed file is damaged or cut off: {error}") from error


def _sha256(file: str) -> str:
    try:
        with open(file, "rb") as opened:
            return hashlib.file_digest(opened, "sha256").hexdigest()
    except OSError as error:
        raise _core.Error(f"{file}: can't be read: {error.strerror}") from error
