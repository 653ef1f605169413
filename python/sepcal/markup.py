# SPDX-License-Identifier: BSD-3-Clause
"""HTML that no name can break: what isn't HTML is escaped wherever it enters."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from typing import LiteralString


class Html(str):
    """Markup. Only html() and join() make it, so any other text is text."""

    __slots__ = ()


def as_html(value: object) -> Html:
    """A value as markup: itself where it is markup, else its escaped text."""
    return value if isinstance(value, Html) else Html(escape(str(value)))


def html(template: LiteralString, *values: object) -> Html:
    """A literal template with its {} filled; values that aren't markup are escaped."""
    return Html(template.format(*(as_html(value) for value in values)))


def join(between: LiteralString, parts: Iterable[object]) -> Html:
    """Parts with a literal between them; parts that aren't markup are escaped."""
    return Html(between.join(as_html(part) for part in parts))
