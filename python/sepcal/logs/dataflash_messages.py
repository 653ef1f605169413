# SPDX-License-Identifier: BSD-3-Clause
"""A DataFlash log's messages, in which channels are looked up, with their times."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.logs.dataflash_binary import read_binary
from sepcal.logs.dataflash_columns import Messages
from sepcal.logs.dataflash_text import looks_like_text, read_text
from sepcal.logs.recording import Channel, make_channel

START = 4096  # bytes in which the format shows


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
        progress(f"reading {file}")
        with open(file, "rb") as opened:
            text = looks_like_text(opened.read(START))
        found = read_text(file) if text else read_binary(file)
        self.by_name, self.torn, self.damaged = found.by_name, found.torn, found.damaged
        if not self.by_name:
            raise _core.Error(f"{file}: cut off or foreign: no whole message is in it")
        self._clock = self._find_clock()
        if self.torn and not cut_off:
            seen = f", {self._clock[1].max():.1f} s" if len(self._clock[1]) else ""
            raise _core.Error(
                f"{file}: the log is cut off inside {self.torn}{seen}; "
                "--cut-off takes what is whole (in Python cut_off=True)"
            )

    def __getitem__(self, name: str) -> Messages | None:
        return self.by_name.get(name)

    def times(self, messages: Messages) -> Array:
        """The time of each message [s]; without a stamp, that of the last stamped one before."""
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


def _stamps(messages: Messages) -> Array | None:
    """Seconds since the start; a GPS of old has a TimeMS of its own, of the week, beside T."""
    if "TimeUS" in messages:
        return messages["TimeUS"] / 1e6
    if messages.name.startswith("GPS"):
        return messages["T"] / 1e3 if "T" in messages else None
    return messages["TimeMS"] / 1e3 if "TimeMS" in messages else None
