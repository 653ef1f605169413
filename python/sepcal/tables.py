# SPDX-License-Identifier: BSD-3-Clause
"""Small tables for notebooks, all that comes from a log or a user escaped."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from sepcal.markup import Html, html, join


def table_of(
    caption: object,
    columns: Sequence[str],
    rows: Iterable[Mapping[str, object]],
    *,
    as_they_are: bool = False,
) -> Html:
    """Rows by column; a number has six digits, and what is undefined a dash.

    Headings are the columns' names, `as_they_are` or with spaces.
    """
    headings = columns if as_they_are else [name.replace("_", " ") for name in columns]
    head = join("", (html("<th>{}</th>", heading) for heading in headings))
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
