# SPDX-License-Identifier: BSD-3-Clause
"""What the package writes for people: names and messages, each in one line, and the terminal."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager

from sepcal import _core


def in_line(text: object) -> str:
    r"""One printable line: what ends a line or steers a terminal is written as \n or \x1b."""
    return _core.in_line(str(text))


def as_utf8(what: str, text: str) -> str:
    """The text, which C++ takes as it is. Raises Error for one that no UTF-8 is of."""
    if not isinstance(text, str):
        raise _core.Error(f"{what} is {in_line(repr(text))}; give a text")
    try:
        text.encode()
    except UnicodeEncodeError:
        raise _core.Error(f"{what} '{in_line(text)}' is no UTF-8; call it otherwise") from None
    return text


def in_shell(words: Iterable[str | os.PathLike[str]]) -> str:
    """Words as a POSIX shell takes them."""
    return " ".join(_core.in_shell(os.fspath(word)) for word in words)


def page_of(lines: Iterable[object]) -> str:
    """Lines as a page: none of them forges another."""
    return "\n".join(in_line(line) for line in lines)


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """A table's lines, its first column to the left and the others to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]) for row in rows
    ]


def show(page: str) -> None:
    """Prints a page or JSON to standard output."""
    sys.stdout.write(page if page.endswith("\n") else page + "\n")


def tell(text: object) -> None:
    """Says something on standard error, if there is one."""
    if sys.stderr is not None:
        print(in_line(text), file=sys.stderr)


@contextmanager
def told_work(command: str, every: float = 10.0) -> Iterator[None]:
    """Shows what the engine is doing and for how long, on standard error.

    On a terminal in one line that is written anew each second, elsewhere a line every so many.
    """
    live = sys.stderr is not None and sys.stderr.isatty()
    task, begun, fraction = "", time.monotonic(), 0.0
    ended = threading.Event()

    def hear(named: str, done: float) -> None:
        nonlocal task, begun, fraction
        if named != task:
            task, begun = named, time.monotonic()
        fraction = done

    def show_on() -> None:
        while not ended.wait(1.0 if live else every):
            line = f"{command}: {in_line(task or 'at work')}, {time.monotonic() - begun:.0f} s"
            if 0.0 < fraction < 1.0:
                line += f", {100.0 * fraction:.0f} %"
            print(f"\r\033[K{line}" if live else line, end="" if live else "\n", file=sys.stderr)
            sys.stderr.flush()

    teller = threading.Thread(target=show_on, daemon=True)
    if sys.stderr is not None:
        teller.start()
        _core.hear_progress(hear)
    try:
        yield
    finally:
        _core.hear_progress(None)
        ended.set()
        if live:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


@contextmanager
def told_progress(command: str) -> Iterator[Callable[[str], None]]:
    """Gives a function that shows what is being done where standard error is a terminal."""
    live = sys.stderr is not None and sys.stderr.isatty()

    def report_progress(what: str) -> None:
        if live:
            print(
                f"\r\033[Ksepcal {command}: {in_line(what)} ...",
                end="",
                file=sys.stderr,
                flush=True,
            )

    try:
        yield report_progress
    finally:
        if live:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
