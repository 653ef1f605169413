# SPDX-License-Identifier: BSD-3-Clause
"""Whether python-calamine may read a workbook, by a look at all of its parts beforehand.

It is several times as fast as openpyxl, but keeps every cell between the farthest two in memory,
with its text, and believes what an archive says of itself.
"""

from __future__ import annotations

import os
import re
import zipfile
from typing import IO

from sepcal.whole_files import open_scratch_part

CHUNK = 2**20  # [bytes]
MOST_CELLS = 8_000_000  # of a sheet's box, each of 32 bytes
SPARSEST = 4  # cells of the box for each that is there
FEW_CELLS = 10_000  # as sparse as they like
MOST_TEXT = 2**27  # [bytes], as if each cell of text had the longest
# A cell's tag as all common writers have it, and whatever else may be one.
CELL = re.compile(rb'<c r="([A-Z]{1,3})([0-9]{1,7})"(?: [a-z]+="[^"<>&]*")*\s?/?>')
ANY_CELL = re.compile(rb"<(?:[^\s<>/]*:)?c(?=[\s/>])")
SHARED_TEXTS, SHARED_TEXT = "xl/sharedstrings.xml", b' t="s"'
# Errors, which it reads as empty; dates as text, and dates since 1904.
LEFT_TO_OPENPYXL = re.compile(rb""" t="[ed]"|date1904\s*=\s*["'](?:1|true)""")
LEFT_MARKS = (b' t="e"', b' t="d"', b"date1904")
# A format of numbers is a date's by a letter of dates that is no part of these.
FORMAT = re.compile(rb'formatCode="([^"]*)"')
LETTER_OF_DATES = re.compile(rb"[dmyhs]", re.IGNORECASE)
NO_DATES = re.compile(rb"\[[^\[\]]*\]|&quot;.*?&quot;|[\\_*][^dmyhs]", re.IGNORECASE)
DOUBTFUL = re.compile(rb"[\[\]\\_&]")


def copy_if_safe(file: str, folder: str) -> str | None:
    """A copy of the workbook for python-calamine, not packed; None where it may not read it.

    What the copy says of its parts is true: no more is in them than the archive declared, which the
    caller has judged.
    """
    copy = os.path.join(folder, "parts.zip")
    texts = longest = 0
    try:
        with zipfile.ZipFile(file) as packed, zipfile.ZipFile(copy, "w") as plain:
            for name in dict.fromkeys(packed.namelist()):
                look = _Look()
                with packed.open(name) as opened, open_scratch_part(plain, name) as part:
                    if name.lower() == SHARED_TEXTS:
                        longest = max(longest, _copy_texts(opened, part))
                    elif not _copy(opened, part, look):
                        return None
                texts += look.texts
    except (OSError, zipfile.BadZipFile, NotImplementedError, RuntimeError, ValueError):
        return None  # openpyxl says what is wrong
    return copy if texts * longest <= MOST_TEXT else None


class _Look:
    """What a part was seen to hold."""

    def __init__(self) -> None:
        self.cells = self.rows = self.columns = self.texts = 0
        self.is_sheet = False

    def take(self, piece: bytes) -> bool:
        """Looks at whole tags. Returns whether python-calamine reads them as openpyxl does."""
        if any(mark in piece and LEFT_TO_OPENPYXL.search(piece) for mark in LEFT_MARKS):
            return False
        found = CELL.findall(piece)
        is_plain = b":c" not in piece and piece.count(b"<c") == len(found)
        if not is_plain and len(found) != len(ANY_CELL.findall(piece)):
            return False
        if found:
            self.cells += len(found)
            self.rows = max(self.rows, *map(int, {row for _, row in found}))
            self.columns = max(self.columns, *map(_number_of, {column for column, _ in found}))
            self.texts += piece.count(SHARED_TEXT)
        self.is_sheet = self.is_sheet or b"sheetData" in piece
        return not any(map(_is_doubtful, FORMAT.findall(piece)))

    def has_dense_box(self) -> bool:
        """Of a sheet; a chain of formulas names cells too."""
        box = self.rows * self.columns
        is_dense = box <= min(MOST_CELLS, SPARSEST * self.cells + FEW_CELLS)
        return is_dense or not self.is_sheet


def _copy(opened: IO[bytes], part: IO[bytes], look: _Look) -> bool:
    """Returns whether the part may be read."""
    rest = b""
    while piece := opened.read(CHUNK):
        part.write(piece)
        piece = rest + piece
        cut = max(piece.rfind(b"<"), 0)
        rest = piece[cut:]
        if len(rest) > CHUNK or not look.take(piece[:cut]):
            return False
    return look.take(rest) and look.has_dense_box()


def _copy_texts(opened: IO[bytes], part: IO[bytes]) -> int:
    """Returns the length of the longest text, at most."""
    longest = 0
    rest = b""
    while piece := opened.read(CHUNK):
        part.write(piece)
        *texts, rest = (rest + piece).split(b"<si")
        longest = max(longest, len(rest), *map(len, texts))
        if longest > CHUNK:
            break  # far too long: what is left is not read
    return longest


def _is_doubtful(form: bytes) -> bool:
    """Whether a number in this format may be a date for one of the two alone."""
    first, _, others = NO_DATES.sub(b"", form).partition(b";")
    return bool(DOUBTFUL.search(first + others) or LETTER_OF_DATES.search(others))


def _number_of(column: bytes) -> int:
    """1 of A, 27 of AA."""
    number = 0
    for letter in column:
        number = 26 * number + letter - ord("A") + 1
    return number
