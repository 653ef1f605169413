# SPDX-License-Identifier: BSD-3-Clause
"""Limits for unpacking: at most LEAST, or RATIO times the file's own size if that is more."""

from __future__ import annotations

import os

from sepcal import _core

LEAST = 2**29  # [bytes]: 512 MiB
RATIO = 32


class Budget:
    """Bytes that a file may still unpack to."""

    def __init__(self, file: str) -> None:
        size = os.stat(file).st_size
        self._file, self._size = file, size
        self.left = max(LEAST, RATIO * size)

    def take(self, count: int, what: str) -> None:
        """Spends them before they are unpacked. Raises Error where there are too few.

        Args:
            count: Bytes, as declared or counted.
            what: What they are, for the message.
        """
        if count < 0 or count > self.left:
            raise _core.Error(
                f"{self._file}: {what} unpacks to {_say(count)} or more, of a file of "
                f"{_say(self._size)}; sepcal unpacks at most {_say(LEAST)} or {RATIO} times the "
                "file: leave out columns or rows, or write it without compression"
            )
        self.left -= count


def _say(count: float) -> str:
    for unit in ("bytes", "KiB", "MiB", "GiB"):
        if abs(count) < 1024:
            return f"{count:.0f} {unit}"
        count /= 1024
    return f"{count:.0f} TiB"
