# SPDX-License-Identifier: BSD-3-Clause
"""Messages of one name of a DataFlash log as whole columns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sepcal.columns import Array

# By the letter of a format: NumPy's type and how many of them are one of the unit that is meant.
LETTERS: dict[str, tuple[str, float]] = {
    "a": ("V64", 1.0),
    "b": ("i1", 1.0),
    "B": ("u1", 1.0),
    "g": ("<f2", 1.0),
    "h": ("<i2", 1.0),
    "H": ("<u2", 1.0),
    "i": ("<i4", 1.0),
    "I": ("<u4", 1.0),
    "f": ("<f4", 1.0),
    "n": ("S4", 1.0),
    "N": ("S16", 1.0),
    "Z": ("S64", 1.0),
    "c": ("<i2", 100.0),
    "C": ("<u2", 100.0),
    "e": ("<i4", 100.0),
    "E": ("<u4", 100.0),
    "L": ("<i4", 1e7),
    "d": ("<f8", 1.0),
    "M": ("u1", 1.0),
    "q": ("<i8", 1.0),
    "Q": ("<u8", 1.0),
}


class Messages:
    """All messages of one name: `messages["MagX"]` is a column in the unit that its format says.

    Attributes:
        name: "MAG".
        offsets: Where in the file each begins, increasing; their order is the log's.
        letters: {column: letter of its format}.
        scaled: Whether numbers are in the units that are meant already, as in a log of text.
    """

    def __init__(
        self,
        name: str,
        offsets: np.ndarray,
        data: np.ndarray,
        letters: dict[str, str],
        scaled: bool = False,
    ) -> None:
        self.name, self.offsets, self.letters = name, offsets, letters
        self._data, self._scaled = data, scaled

    def __len__(self) -> int:
        return len(self.offsets)

    def __contains__(self, column: str) -> bool:
        return column in self.letters

    def __getitem__(self, column: str) -> Array:
        values = self._data[column].astype(float)
        return values if self._scaled else values / LETTERS[self.letters[column]][1]

    def texts(self, column: str) -> list[str]:
        """A column of text."""
        return [text.decode("utf-8", "replace") for text in self._data[column]]

    def is_text(self, column: str) -> bool:
        """Whether the column holds words."""
        return bool(self._data[column].dtype.kind == "S")

    def first(self, *columns: str) -> str | None:
        """The first of these columns that is there."""
        return next((column for column in columns if column in self.letters), None)

    def where(self, kept: np.ndarray) -> Messages:
        """Those of a mask."""
        data = self._data[kept]
        return Messages(self.name, self.offsets[kept], data, self.letters, self._scaled)


@dataclass(frozen=True)
class Found:
    """The contents of a file: messages by name, where it ends inside one, bytes that are none."""

    by_name: dict[str, Messages]
    torn: str
    damaged: int
