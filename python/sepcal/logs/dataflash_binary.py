# SPDX-License-Identifier: BSD-3-Clause
"""A DataFlash log as the vehicle wrote it: pymavlink finds messages, NumPy reads them at once."""

from __future__ import annotations

import contextlib
import io
import os
import struct
import sys
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np

from sepcal import _core
from sepcal.logs.dataflash_columns import LETTERS, Found, Messages
from sepcal.logs.words import one_line

HEAD = b"\xa3"  # of every message


def looks_like_binary(start: bytes) -> bool:
    """By the file's first bytes: a message FMT that describes itself comes first."""
    return struct.pack("<BBB", 0xA3, 0x95, 0x80) in start


def read_binary(file: str) -> Found:
    """The messages. Raises Error where there is no pymavlink, or it can't read the file."""
    try:
        from pymavlink import DFReader
    except ImportError as error:
        raise _core.Error(
            f"{file}: a DataFlash log needs pymavlink, which is not installed: "
            "pip install sepcal[logs]"
        ) from error

    class Reader(DFReader.DFReader_binary):  # type: ignore[misc]
        """The messages' times are read here: a clock of the GPS isn't needed."""

        def init_clock(self) -> None:
            pass

    try:
        with _silence():
            reader = Reader.__new__(Reader)  # so that it can be closed where reading fails
            try:
                Reader.__init__(reader, file)  # type: ignore[call-arg]
                return _gather(reader, os.path.getsize(file))
            finally:
                for opened in ("filehandle", "data_map"):
                    with contextlib.suppress(AttributeError, BufferError):
                        getattr(reader, opened).close()
    except Exception as error:  # of a damaged file pymavlink raises what it meets
        raise _core.Error(
            f"{file}: pymavlink can't read it as a DataFlash log: {one_line(error)}"
        ) from error


def _gather(reader: Any, size: int) -> Found:  # noqa: ANN401, pymavlink has no types
    whole = np.frombuffer(reader.data_map[:], dtype=np.uint8)
    by_name: dict[str, Messages] = {}
    end = covered = 0
    torn: str | None = None
    for number, offsets in enumerate(reader.offsets):
        if not len(offsets) or number not in reader.formats:
            continue
        form = reader.formats[number]
        at = np.array(offsets, dtype=np.int64)
        inside = at + form.len <= size
        if not inside.all():
            torn = form.name
        at = at[inside]
        if not len(at):
            continue
        end = max(end, int(at[-1]) + form.len)
        covered += len(at) * form.len
        letters = dict(zip(form.columns, form.format, strict=False))
        if len(letters) == len(form.columns) == len(form.format):
            table = np.dtype([(c, LETTERS[letter][0]) for c, letter in letters.items()])
            if table.itemsize == form.len - 3:
                rows = whole[at[:, None] + np.arange(3, form.len)]
                data = np.ascontiguousarray(rows).view(table)[:, 0]
                by_name[form.name] = Messages(form.name, at, data, letters)
    tail = bytes(whole[end:size])
    if torn is None and tail.startswith(HEAD):
        torn = ""
    if not tail.strip(b"\0\xff"):  # what a card or a chip holds beyond the log
        torn = None
    where = " ".join(f"a message {torn} at byte {end}".split()) if torn is not None else ""
    return Found(by_name, where, end - covered)


_SILENCE = threading.Lock()  # standard error is the whole process'


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Nothing goes to standard output and error, of compiled code neither: pymavlink chatters."""
    talk = io.StringIO()
    with _SILENCE:
        sys.stderr.flush()
        kept = os.dup(2)
        try:
            with open(os.devnull, "wb") as nothing:
                os.dup2(nothing.fileno(), 2)
            with contextlib.redirect_stdout(talk), contextlib.redirect_stderr(talk):
                yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)
