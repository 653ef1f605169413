# SPDX-License-Identifier: BSD-3-Clause
"""To what the compressed buffers of an Arrow file unpack, found before any is unpacked.

An IPC message is a FlatBuffer with a body; a record batch lists its buffers, and a compressed one
begins with its size as eight bytes. pyarrow unpacks whatever that says.
"""

from __future__ import annotations

import struct
from typing import Any

from sepcal import _core
from sepcal.reading.extras import load
from sepcal.reading.limits import Budget

MAGIC = b"ARROW1\0\0"
RECORD_BATCH, DICTIONARY_BATCH = 3, 2


def check_buffers(file: str, budget: Budget) -> None:
    """Spends what the buffers unpack to. Raises Error where that is too much."""
    pa = load("pyarrow", file, "Arrow")
    with pa.OSFile(file) as opened:
        if opened.read(len(MAGIC)) != MAGIC:
            opened.seek(0)
        reader = pa.ipc.MessageReader.open_stream(opened)
        while True:
            try:
                message = reader.read_next_message()
            except StopIteration:
                return
            _check_message(file, message, budget)


def _check_message(file: str, message: Any, budget: Budget) -> None:  # noqa: ANN401
    data, body = message.metadata.to_pybytes(), message.body
    try:
        root = _u32(data, 0)
        kind = data[at] if (at := _field(data, root, 1)) else 0
        batch = _table(data, root, 2)
        if kind == DICTIONARY_BATCH and batch:
            batch = _table(data, batch, 1)
        elif kind != RECORD_BATCH:
            return
        if not batch or not _field(data, batch, 3):  # no compression
            return
        buffers = _table(data, batch, 2)
        for index in range(_u32(data, buffers) if buffers else 0):
            start, length = struct.unpack_from("<qq", data, buffers + 4 + 16 * index)
            if body is not None and length >= 8:
                (size,) = struct.unpack("<q", body.slice(start, 8).to_pybytes())
                budget.take(size if size != -1 else length, "a column")
    except (struct.error, IndexError) as error:
        raise _core.Error(f"{file}: the Arrow file is damaged: {error}") from error


def _u32(data: bytes, at: int) -> int:
    return int(struct.unpack_from("<I", data, at)[0])


def _field(data: bytes, table: int, index: int) -> int:
    """Where a table's field stands; 0: it is not there."""
    vtable = table - struct.unpack_from("<i", data, table)[0]
    (size,) = struct.unpack_from("<H", data, vtable)
    place = 4 + 2 * index
    offset = struct.unpack_from("<H", data, vtable + place)[0] if place < size else 0
    return table + int(offset) if offset else 0


def _table(data: bytes, table: int, index: int) -> int:
    """Where what a field points to stands; 0: nowhere."""
    at = _field(data, table, index)
    return at + _u32(data, at) if at else 0
