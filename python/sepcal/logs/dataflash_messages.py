# SPDX-License-Identifier: BSD-3-Clause
"""Messages of a DataFlash log as whole columns: pymavlink finds them, NumPy reads them at once."""

from __future__ import annotations

import contextlib
import io
import os
import struct
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.logs.recording import Channel, make_channel
from sepcal.logs.words import one_line

HEAD = b"\xa3\x95"
# By the letter of a format: NumPy's type and the factor to the unit that is meant.
_LETTERS: dict[str, tuple[str, float]] = {
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
    "c": ("<i2", 0.01),
    "C": ("<u2", 0.01),
    "e": ("<i4", 0.01),
    "E": ("<u4", 0.01),
    "L": ("<i4", 1e-7),
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
    """

    def __init__(
        self, name: str, offsets: np.ndarray, data: np.ndarray, letters: dict[str, str]
    ) -> None:
        self.name, self.offsets, self.letters = name, offsets, letters
        self._data = data

    def __len__(self) -> int:
        return len(self.offsets)

    def __contains__(self, column: str) -> bool:
        return column in self.letters

    def __getitem__(self, column: str) -> Array:
        factor = _LETTERS[self.letters[column]][1]
        return self._data[column].astype(float) * factor

    def texts(self, column: str) -> list[str]:
        """A column of text."""
        return [text.decode("utf-8", "replace") for text in self._data[column]]

    def first(self, *columns: str) -> str | None:
        """The first of these columns that is there."""
        return next((column for column in columns if column in self.letters), None)

    def where(self, kept: np.ndarray) -> Messages:
        """Those of a mask."""
        return Messages(self.name, self.offsets[kept], self._data[kept], self.letters)


class DataFlash:
    """A DataFlash log's messages by name, and their times.

    Attributes:
        damaged: Bytes between the messages that are none.
    """

    def __init__(self, file: str, cut_off: bool, progress: Callable[[str], None]) -> None:
        """Reads the file.

        Raises:
            Error: No pymavlink, or a file that ends inside a message, unless `cut_off` allows it.
        """
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

        size = os.path.getsize(file)
        progress(f"reading {file}")
        try:
            with _silence():
                reader = Reader.__new__(Reader)  # so that it can be closed where reading fails
                try:
                    Reader.__init__(reader, file)  # type: ignore[call-arg]
                    self._read(file, size, reader, cut_off)
                finally:
                    for opened in ("filehandle", "data_map"):
                        with contextlib.suppress(AttributeError, BufferError):
                            getattr(reader, opened).close()
        except _core.Error:
            raise
        except Exception as error:  # of a damaged file pymavlink raises what it meets
            raise _core.Error(
                f"{file}: pymavlink can't read it as a DataFlash log: {one_line(error)}"
            ) from error

    def _read(self, file: str, size: int, reader: Any, cut_off: bool) -> None:  # noqa: ANN401
        whole = np.frombuffer(reader.data_map[:], dtype=np.uint8)
        self.by_name: dict[str, Messages] = {}
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
                table = np.dtype([(c, _LETTERS[letter][0]) for c, letter in letters.items()])
                if table.itemsize == form.len - 3:
                    rows = whole[at[:, None] + np.arange(3, form.len)]
                    data = np.ascontiguousarray(rows).view(table)[:, 0]
                    self.by_name[form.name] = Messages(form.name, at, data, letters)
        tail = bytes(whole[end:size])
        if torn is None and HEAD[:1] in tail[:1]:
            torn = ""
        if not tail.strip(b"\0\xff"):
            torn = None
        self.torn = " ".join(f"a message {torn} at byte {end}".split()) if torn is not None else ""
        if not self.by_name:
            raise _core.Error(f"{file}: cut off or foreign: no whole message is in it")
        self._clock = self._find_clock()
        if self.torn and not cut_off:
            seen = f", {self._clock[1].max():.1f} s" if len(self._clock[1]) else ""
            raise _core.Error(
                f"{file}: the log is cut off inside {self.torn}{seen}; "
                "--cut-off takes what is whole (in Python cut_off=True)"
            )
        self.damaged = end - covered

    def __getitem__(self, name: str) -> Messages | None:
        return self.by_name.get(name)

    def times(self, messages: Messages) -> Array:
        """Of each message [s]; of messages without a stamp that of the last stamped one before."""
        stamps = _stamps(messages)
        if stamps is not None:
            return stamps
        offsets, times = self._clock
        if not len(times):
            return np.zeros(len(messages))
        at = np.searchsorted(offsets, messages.offsets) - 1
        return np.asarray(times[np.clip(at, 0, None)])

    def instances(self, *names: str) -> list[Messages]:
        """Those of one kind, one by one: MAG by its column I, and MAG2, MAG3."""
        found = []
        for name in names:
            messages = self[name]
            if messages is None:
                continue
            column = messages.first("I", "Inst", "Instance", "C")
            if column is None or messages.letters[column] not in "BbM":
                found.append(messages)
                continue
            numbers = messages[column]
            found += [messages.where(numbers == number) for number in np.unique(numbers)]
        return found

    def first_of(
        self, names: tuple[str, ...], *columns: str, factor: float = 1.0, done: str = ""
    ) -> Channel | None:
        """Columns of the first of these messages that has them all, not all of them zero."""
        for messages in self.instances(*names):
            if not all(column in messages for column in columns):
                continue
            values = np.stack([messages[column] for column in columns], axis=-1) * factor
            if values.any():
                source = f"{messages.name}.{', '.join(columns)}"
                said = (done,) if done else ()
                channel = make_channel(source, self.times(messages), values, said)
                if channel is not None:
                    return channel
        return None

    def _find_clock(self) -> tuple[Array, Array]:
        """Offsets and times of a steady message, by which those without a stamp are placed."""
        for name in ("IMU", "ATT", "MAG", "BARO", "GPS", "CTUN"):
            messages = self[name]
            stamps = _stamps(messages) if messages is not None else None
            if messages is not None and stamps is not None:
                return messages.offsets, stamps
        return np.empty(0), np.empty(0)


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


def _stamps(messages: Messages) -> Array | None:
    """Seconds since the start; a GPS of old has a TimeMS of its own, of the week, beside T."""
    if "TimeUS" in messages:
        return messages["TimeUS"] / 1e6
    if messages.name.startswith("GPS"):
        return messages["T"] / 1e3 if "T" in messages else None
    return messages["TimeMS"] / 1e3 if "TimeMS" in messages else None


def looks_like_dataflash(start: bytes) -> bool:
    """By the file's first bytes: a message FMT that describes itself comes first."""
    return struct.pack("<BBB", 0xA3, 0x95, 0x80) in start
