# SPDX-License-Identifier: BSD-3-Clause
"""MATLAB's MAT-files of level 5 (versions 5 to 7), by MathWorks' "MAT-File Format".

A file is elements: a type, a length and data, some packed by zlib. An array is an element of
elements: its class, its sizes, its name, its values. Objects of MATLAB's own are left out.
"""

from __future__ import annotations

import itertools
import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np

from sepcal import _core
from sepcal.reading.limits import Budget

HEADER = 128
NUMBERS = {
    1: "i1",
    2: "u1",
    3: "i2",
    4: "u2",
    5: "i4",
    6: "u4",
    7: "f4",
    9: "f8",
    12: "i8",
    13: "u8",
}
MATRIX, COMPRESSED = 14, 15
TEXTS = {1: "latin-1", 2: "utf-8", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
CELL, STRUCT, OBJECT, CHAR, SPARSE, FIRST_NUMBER, LAST_NUMBER, OPAQUE = 1, 2, 3, 4, 5, 6, 15, 17
COMPLEX = 0x0800
DEEPEST = 16
CHUNK = 2**20


class Damaged(Exception):
    """The file is not what it says."""


def read_variables(file: str) -> tuple[dict[str, Any], bool]:
    """Arrays, texts and structs by name.

    A struct is a dict, an array of structs one with a column a field, or of structs where they
    hold arrays.

    Returns:
        The variables, and whether there are objects, which are left out.

    Raises:
        Error: Damaged, cut off, or larger unpacked than sepcal takes.
    """
    reader = _Reader(Budget(file))
    found: dict[str, Any] = {}
    try:
        with open(file, "rb") as opened:
            head = opened.read(HEADER)
            reader.order = ">" if head[126:128] == b"MI" else "<"
            while tag := opened.read(8):
                kind, size = reader.tag_of(tag)
                data = opened.read(size)
                if len(data) < size:
                    raise Damaged("it is cut off")
                if kind == COMPRESSED:
                    kind, data = reader.unpack(data)
                else:
                    reader.budget.take(size, "a variable")
                if kind == MATRIX:
                    name, value = reader.array(memoryview(data), 0)
                    if name and value is not None:
                        found[name] = value
    except (Damaged, zlib.error, ValueError, OverflowError) as error:
        raise _core.Error(f"{file}: the .mat file is damaged or cut off: {error}") from error
    return found, reader.has_objects


class _Reader:
    def __init__(self, budget: Budget) -> None:
        self.budget = budget
        self.order = "<"
        self.has_objects = False

    def tag_of(self, tag: bytes) -> tuple[int, int]:
        if len(tag) < 8:
            raise Damaged("it ends inside a tag")
        kind, size = np.frombuffer(tag, f"{self.order}u4", 2)
        return int(kind), int(size)

    def unpack(self, data: bytes) -> tuple[int, bytes]:
        """The one element that is packed, without its tag."""
        unpacker, parts = zlib.decompressobj(), []
        while not unpacker.eof:
            part = unpacker.decompress(data, CHUNK)
            self.budget.take(len(part), "a variable")
            parts.append(part)
            data = unpacker.unconsumed_tail
            if not part and not data:
                raise Damaged("a packed variable has no end")
        whole = b"".join(parts)
        kind, size = self.tag_of(whole[:8])
        if len(whole) < 8 + size:
            raise Damaged("a variable is cut off")
        return kind, whole[8 : 8 + size]

    def elements(self, data: memoryview) -> Iterator[tuple[int, memoryview]]:
        """Those of an array, each with its type."""
        at = 0
        while at + 8 <= len(data):
            kind, size = self.tag_of(bytes(data[at : at + 8]))
            if kind >> 16:  # a small one: both in four bytes, the data behind
                kind, size, start, at = kind & 0xFFFF, kind >> 16, at + 4, at + 8
            else:
                start, at = at + 8, at + 8 + size + (-size) % 8
            if start + size > len(data):
                raise Damaged("an array is cut off")
            yield kind, data[start : start + size]

    def array(self, data: memoryview, depth: int) -> tuple[str, Any]:
        """Its name, and its values; None of what has none that can be read."""
        if depth > DEEPEST:
            raise Damaged(f"its structs are more than {DEEPEST} deep")
        parts = self.elements(data)
        flags = self._numbers(parts)
        if flags.size == 0:
            return "", None
        of_class, is_complex = int(flags[0]) & 0xFF, bool(int(flags[0]) & COMPLEX)
        if of_class in (OPAQUE, OBJECT):
            self.has_objects = True
            return "", None
        sizes = [int(size) for size in self._numbers(parts)]
        name = self._next(parts)[1].tobytes().decode("latin-1")
        count = int(np.prod(sizes, dtype=object)) if sizes else 0
        if count < 0:
            raise Damaged("an array has no such size")
        if of_class == STRUCT:
            return name, self._struct(parts, count, depth)
        if of_class == CELL:
            cells = [_of_one(self.array(part, depth + 1)[1]) for _, part in parts]
            return name, _of_objects(cells)
        if of_class == CHAR:
            return name, self._text(parts, sizes)
        if is_complex or not FIRST_NUMBER <= of_class <= LAST_NUMBER:
            return name, None
        values = self._numbers(parts)
        if values.size != count:
            raise Damaged(f"'{name}' has {values.size} values and not {count}")
        self.budget.take(8 * count, f"'{name}'")
        return name, values.astype(np.float64).reshape(sizes, order="F")

    def _next(self, parts: Iterator[tuple[int, memoryview]]) -> tuple[int, memoryview]:
        try:
            return next(parts)
        except StopIteration:
            raise Damaged("an array is cut off") from None

    def _numbers(self, parts: Iterator[tuple[int, memoryview]]) -> np.ndarray:
        kind, data = self._next(parts)
        if kind not in NUMBERS:
            raise Damaged(f"numbers are of type {kind}")
        form = np.dtype(self.order + NUMBERS[kind])
        return np.frombuffer(data[: len(data) - len(data) % form.itemsize], form)

    def _text(self, parts: Iterator[tuple[int, memoryview]], sizes: list[int]) -> Any:  # noqa: ANN401
        """A text, or one a row."""
        kind, data = self._next(parts)
        order = {"utf-16": "-le", "utf-32": "-le"} if self.order == "<" else {"utf-16": "-be"}
        code = TEXTS.get(kind, "latin-1")
        text = data.tobytes().decode(code + order.get(code, ""), "replace")
        if len(sizes) == 2 and sizes[0] > 1 and len(text) == sizes[0] * sizes[1]:
            return np.array([text[row :: sizes[0]].rstrip() for row in range(sizes[0])])
        return text

    def _struct(
        self, parts: Iterator[tuple[int, memoryview]], count: int, depth: int
    ) -> dict[str, Any]:
        length = self._numbers(parts)
        names = self._next(parts)[1].tobytes()
        width = int(length[0]) if length.size else 0
        if width < 1:
            return {}
        fields = [
            names[at : at + width].split(b"\0")[0].decode("latin-1")
            for at in range(0, len(names), width)
        ]
        columns: dict[str, list[Any]] = {field: [] for field in fields}
        for (_, part), field in zip(parts, itertools.cycle(fields), strict=False):
            columns[field].append(self.array(part, depth + 1)[1])
        if count == 1:
            return {field: values[0] for field, values in columns.items() if values}
        rows = {field: [_of_one(value) for value in values] for field, values in columns.items()}
        if any(
            isinstance(v, np.ndarray) and v.size > 1 for values in rows.values() for v in values
        ):
            return _by_name(columns)
        return {
            field: _of_objects(values)
            for field, values in rows.items()
            if all(np.ndim(value) == 0 for value in values)
        }


def _by_name(columns: dict[str, list[Any]]) -> dict[str, Any]:
    """Structs of arrays by the texts in a field that names them (Simulink's label), or numbered."""
    count = max(map(len, columns.values()))
    whole = {field: values for field, values in columns.items() if len(values) == count}
    named = [whole[f] for f in ("label", "name", "Name") if f in whole]
    names = next((n for n in named if all(n) and len(set(map(str, n))) == count), None)
    return {
        str(names[row]) if names else str(row + 1): {f: values[row] for f, values in whole.items()}
        for row in range(count)
    }


def _of_objects(values: list[Any]) -> np.ndarray:
    """One a row, whatever they are."""
    array = np.empty(len(values), dtype=object)
    for row, value in enumerate(values):
        array[row] = value
    return array


def _of_one(value: Any) -> Any:  # noqa: ANN401
    """The one number of an array; else as it is."""
    return value.ravel()[0] if isinstance(value, np.ndarray) and value.size == 1 else value
