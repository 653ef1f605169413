# SPDX-License-Identifier: BSD-3-Clause
"""Text for people: names and messages, each in one line."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Sequence

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
