# SPDX-License-Identifier: BSD-3-Clause
"""A DataFlash log as text (.log), as ground stations wrote it: a line a message."""

from __future__ import annotations

import numpy as np

from sepcal.logs.dataflash_columns import Found, Messages

TEXT = "nNZaM"  # letters of what may be words; of modes too


def looks_like_text(start: bytes) -> bool:
    """By the file's first bytes: lines FMT that describe the others come first."""
    return b"FMT," in start and b"\0" not in start


def read_text(file: str) -> Found:
    """The messages; lines that don't fit their format are counted as damaged."""
    with open(file, encoding="utf-8", errors="replace") as opened:
        text = opened.read()
    forms: dict[str, dict[str, str]] = {}
    found: dict[str, tuple[list[int], list[tuple[float | str, ...]]]] = {}
    damaged = 0
    for number, line in enumerate(text.splitlines()):
        name, *cells = (cell.strip() for cell in line.split(","))
        if name == "FMT":
            _, _, described, letters, *columns = (*cells, "", "", "", "")
            columns = [column for column in columns if column]
            if len(columns) == len(letters):
                forms[described] = dict(zip(columns, letters, strict=True))
        elif name in forms:
            row = _read_row(cells, forms[name])
            if row is None:
                damaged += len(line)
                continue
            lines, rows = found.setdefault(name, ([], []))
            lines.append(number)
            rows.append(row)
    by_name = {}
    for name, (lines, rows) in found.items():
        table = [(c, "S64" if letter in TEXT else "f8") for c, letter in forms[name].items()]
        data = np.array([row for row in rows if len(row) == len(table)], dtype=table)
        if len(data) == len(lines):
            by_name[name] = Messages(name, np.array(lines), data, forms[name], scaled=True)
    torn = "" if not text or text.endswith("\n") else f"line {text.count(chr(10)) + 1}, the last"
    return Found(by_name, torn, damaged)


def _read_row(cells: list[str], form: dict[str, str]) -> tuple[float | str, ...] | None:
    """A line's cells, numbers as such; None where they don't fit."""
    letters = list(form.values())
    if len(cells) > len(letters) and letters[-1:] == ["Z"]:  # commas in a message
        cells = [*cells[: len(letters) - 1], ", ".join(cells[len(letters) - 1 :])]
    if len(cells) != len(letters):
        return None
    try:
        return tuple(
            cell.encode("ascii", "replace")[:64] if letter in TEXT else float(cell)  # type: ignore[misc]
            for cell, letter in zip(cells, letters, strict=True)
        )
    except ValueError:
        return None
