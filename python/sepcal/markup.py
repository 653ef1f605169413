# SPDX-License-Identifier: BSD-3-Clause
"""HTML that no name can break: what isn't HTML is escaped wherever it enters, and in figures."""

from __future__ import annotations

import re
from collections.abc import Iterable
from html import escape, unescape
from typing import LiteralString

from sepcal.printing import in_line


class Html(str):
    """Markup. Only html() and join() make it, so any other text is text."""

    __slots__ = ()


def as_html(value: object) -> Html:
    """A value as markup: itself where it is markup, else its escaped text, printable line by line.

    A name that turned the direction of writing would change how its neighbours read.
    """
    if isinstance(value, Html):
        return value
    return Html(escape("\n".join(map(in_line, str(value).split("\n")))))


def in_figure(text: object) -> str:
    """A name in one of Plotly's texts, which take some elements of HTML."""
    return escape(in_line(text))


def as_read(text: str) -> str:
    """A figure's text without its elements; <br> is a line's end."""
    return unescape(re.sub(r"<[^<>]*>", "", text.replace("<br>", "\n")))


def html(template: LiteralString, *values: object) -> Html:
    """A literal template with its {} filled; values that aren't markup are escaped."""
    return Html(template.format(*(as_html(value) for value in values)))


def join(between: LiteralString, parts: Iterable[object]) -> Html:
    """Parts with a literal between them; parts that aren't markup are escaped."""
    return Html(between.join(as_html(part) for part in parts))
