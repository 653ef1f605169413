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

import numpy as np

from sepcal.whole_files import open_scratch_part

CHUNK = 2**20  # [bytes]
MOST_CELLS = 8_000_000  # of a sheet's box, each of 32 bytes
SPARSEST = 4  # cells of the box for each that is there
FEW_CELLS = 10_000  # as sparse as they like
MOST_TEXT = 2**27  # [bytes], as if each cell of text had the longest
# A cell's tag as all common writers have it: this, a column and a row, and what is left of it.
CELL = b'<c r="'
REST_OF_CELL = re.compile(rb'"(?: [a-z]+="[^"<>&]*")*\s?/?>')
ENDS_A_NAME = np.isin(np.arange(256), list(b" \t\n\r\v\f/>"))  # of a tag, by the code behind it
MOST_LETTERS, MOST_DIGITS, MOST_RESTS = 3, 7, 200  # of a column, a row, and of rests in a piece
ANY_CELL = re.compile(rb"<(?:[^\s<>/]*:)?c(?=[\s/>])")
SHARED_TEXTS, SHARED_TEXT = "xl/sharedstrings.xml", b' t="s"'
# Errors, which it reads as empty; dates as text, and dates since 1904.
LEFT_CELLS = (b' t="e"', b' t="d"')
SINCE_1904 = re.compile(rb"""date1904\s*=\s*["'](?:1|true)""")
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
    """The contents that were seen in a part."""

    def __init__(self) -> None:
        self.cells = self.rows = self.columns = self.texts = 0
        self.is_sheet = False

    def take(self, piece: bytes) -> bool:
        """Looks at whole tags. Returns whether python-calamine reads them as openpyxl does."""
        if b"date1904" in piece and SINCE_1904.search(piece):
            return False
        found = _cells_in(piece)
        if found is None:
            return False
        columns, rows = found
        if rows.size:
            self.cells += rows.size
            self.rows = max(self.rows, int(rows.max()))
            self.columns = max(self.columns, int(columns.max()))
            self.texts += piece.count(SHARED_TEXT)
        self.is_sheet = self.is_sheet or b"sheetData" in piece
        return not any(map(_is_doubtful, FORMAT.findall(piece)))

    def has_dense_box(self) -> bool:
        """Whether a sheet's cells fill its box densely; a chain of formulas names cells too."""
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


def _cells_in(piece: bytes) -> tuple[np.ndarray, np.ndarray] | None:
    """Columns and rows of all cells, from 1; None where a tag is not as common writers have it.

    Digit by digit over all cells at once, which is several times as fast as an expression.
    """
    padded = piece + bytes(64)
    codes = np.frombuffer(padded, np.uint8)
    eights = np.ndarray(len(padded) - 7, "<u8", padded, strides=(1,))  # bytes from each one on
    tags = np.flatnonzero(codes == ord("<"))
    tags = tags[codes[tags + 1] == ord("c")]
    tags = tags[ENDS_A_NAME[codes[tags + 2]]]
    if b":c" in piece and len(ANY_CELL.findall(piece)) != tags.size:
        return None
    if (eights[tags] << 16 != int.from_bytes(CELL, "little") << 16).any():
        return None
    letters = _count_up(codes, tags + len(CELL), MOST_LETTERS, b"AZ", 1)
    digits = _count_up(codes, letters[1], MOST_DIGITS, b"09", 0)
    if not letters[2] or not digits[2] or not _end_as_usual(piece, codes, digits[1]):
        return None
    return letters[0], digits[0]


def _count_up(
    codes: np.ndarray, at: np.ndarray, most: int, span: bytes, first: int
) -> tuple[np.ndarray, np.ndarray, bool]:
    """Numbers of digits in a span of letters, where each ends, and whether each has a digit."""
    base = span[1] - span[0] + 1
    values = np.zeros(at.size, np.int64)
    end = at
    goes_on = np.ones(at.size, dtype=bool)
    for _ in range(most):
        digit = codes[end] - np.uint8(span[0])  # below the span it wraps round to a large one
        goes_on &= digit < base
        if not goes_on.any():
            break
        values = np.where(goes_on, values * base + digit + first, values)
        end = end + goes_on
    return values, end, bool((end > at).all())


def _end_as_usual(piece: bytes, codes: np.ndarray, at: np.ndarray) -> bool:
    """Whether what is left of each tag, from `at`, is such; few of them differ."""
    for _ in range(MOST_RESTS):
        if not at.size:
            return True
        rest = piece[at[0] : piece.find(b">", at[0]) + 1]
        if REST_OF_CELL.fullmatch(rest) is None or any(mark in rest for mark in LEFT_CELLS):
            return False
        differs = np.zeros(at.size, dtype=bool)
        for offset, byte in enumerate(rest):
            differs |= codes[np.minimum(at + offset, codes.size - 1)] != byte
        at = at[differs]
    return False
