# SPDX-License-Identifier: BSD-3-Clause
"""Which sensor a file is read for: a verb knows its subject, where a file has several."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

MAGNETIC, AIR = "magnetometer", "air data"
_kind: ContextVar[str] = ContextVar("kind", default="")


def wanted() -> str:
    """MAGNETIC, AIR, or nothing where nobody said."""
    return _kind.get()


@contextmanager
def reading_for(kind: str) -> Iterator[None]:
    """Files that are read inside are read for this kind: MAGNETIC, AIR or "" (unknown).

    Example:
        >>> from sepcal.reading import MAGNETIC, read_file, reading_for
        >>> with reading_for(MAGNETIC):
        ...     flight = read_file(str(folder / "flight.ulg"))
        ...
        >>> "mx_ut" in flight.headers
        True
    """
    token = _kind.set(kind)
    try:
        yield
    finally:
        _kind.reset(token)
