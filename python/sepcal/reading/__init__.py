# SPDX-License-Identifier: BSD-3-Clause
"""Flights from files of any form. `read_foreign` is what C++ calls for a file that is no CSV.

A form is a room of its own, whose libraries are loaded when such a file is read.
"""

from __future__ import annotations

from sepcal import _core
from sepcal.reading.wanted import AIR, MAGNETIC, reading_for

__all__ = ["AIR", "MAGNETIC", "is_text", "read_file", "read_foreign", "reading_for"]


def read_file(
    file: str, table: str | None = None, delimiter: str = "", decimal: str = ""
) -> _core.Flight:
    """The flight of a file of any form, CSV included.

    Args:
        file: The file, or FILE::TABLE, where a sheet, a group, a topic or a sensor is meant.
        table: The same apart from the name.
        delimiter: A text table's column separator; empty: as the file shows.
        decimal: A text table's decimal mark; empty: as the file shows.

    Raises:
        Error: No such file, no table, one that is damaged or too large, a missing library.

    Example:
        >>> sepcal.Flight({"time_s": [0.0, 0.1], "dp_pa": [1.0, 2.0]}).to_csv(folder / "log.csv")
        >>> sepcal.reading.read_file(str(folder / "log.csv")).rows
        2
    """
    from sepcal.reading.files import read

    return read(file, table, delimiter, decimal)


def is_text(file: str) -> bool:
    """Whether a file is a table as text, of which delimiter and decimal mark can be said.

    Example:
        >>> sepcal.Flight({"time_s": [0.0, 0.1], "dp_pa": [1.0, 2.0]}).to_csv(folder / "log.csv")
        >>> sepcal.reading.is_text(str(folder / "log.csv"))
        True
    """
    from sepcal.reading import files

    return files.is_text(file)


def read_foreign(file: str, form: str) -> _core.Flight:
    """The flight of a file that C++ found to be no table as text. Raises Error as read_file()."""
    from sepcal.reading.files import read_other

    return read_other(file, form)
