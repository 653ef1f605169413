# SPDX-License-Identifier: BSD-3-Clause
"""Small tables for notebooks, all that comes from a log or a user escaped."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from sepcal.markup import Html, html, join


def table_of(caption: object, columns: Sequence[str], rows: Iterable[Mapping[str, object]]) -> Html:
    """Rows by column; a number has six digits, and what is undefined a dash."""
    head = join("", (html("<th>{}</th>", name.replace("_", " ")) for name in columns))
    body = (
        html("<tr>{}</tr>\n", join("", (html("<td>{}</td>", cell(row[at])) for at in columns)))
        for row in rows
    )
    return html(
        "<table><caption>{}</caption>\n<thead><tr>{}</tr></thead>\n<tbody>\n{}</tbody></table>",
        caption,
        head,
        join("", body),
    )


def cell(value: object) -> str:
    """A value as the table shows it."""
    if value is None or value != value:
        return "-"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
