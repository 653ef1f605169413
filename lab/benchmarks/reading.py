# SPDX-License-Identifier: BSD-3-Clause
"""Logs in other forms beside the same log as plain CSV: reading alone, one core."""

from __future__ import annotations

import gzip
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

import sepcal
from benchmarks.race import Competitor, Result, judge, lengths_within, race
from benchmarks.reading_libraries import race_libraries

ROWS = (300_000,)
ROWS_OF_LIBRARIES = (100_000,)  # half a minute of a workbook's writer
HEADERS = (
    "time_s",
    "vn_mps",
    "ve_mps",
    "vd_mps",
    "airspeed_mps",
    "altitude_m",
    "temp_degc",
    "p_pa",
)


def clock(seconds: float) -> str:
    """Time of day."""
    minutes, second = divmod(seconds, 60.0)
    return f"{int(minutes) // 60:02d}:{int(minutes) % 60:02d}:{second:06.3f}"


def draw_numbers(rows: int) -> np.ndarray:
    """All but the time, (N, 7)."""
    rng = np.random.default_rng(1)
    return np.round(rng.normal(20.0, 5.0, (rows, len(HEADERS) - 1)), 4)


def write_forms(folder: Path, rows: int) -> dict[str, Path]:
    """The log, form by form."""
    numbers = draw_numbers(rows)
    cells = [[f"{0.01 * i:.2f}", *(f"{x:.4f}" for x in row)] for i, row in enumerate(numbers)]

    def lines(delimiter: str = ",", first: Callable[[int], str] | None = None) -> list[str]:
        stamps = (cell[0] if first is None else first(i) for i, cell in enumerate(cells))
        body = (delimiter.join((s, *c[1:])) for s, c in zip(stamps, cells, strict=True))
        return [delimiter.join(HEADERS), *body]

    plain = "\n".join(lines()) + "\n"
    semicolons = "\n".join(lines(";")) + "\n"
    quoted = [",".join(f'"{cell}"' for cell in row) for row in cells]
    forms = {
        "plain CSV": plain.encode(),
        "semicolons": semicolons.encode(),
        "semicolons, decimal commas": semicolons.replace(".", ",").encode(),
        "every cell quoted": "\n".join([",".join(HEADERS), *quoted, ""]).encode(),
        "blanks": "\n".join([*lines(" "), ""]).encode(),
        "time of day": "\n".join([*lines(first=lambda i: clock(36000 + 0.01 * i)), ""]).encode(),
        "date and time": "\n".join(
            [*lines(first=lambda i: "2024-05-03T" + clock(36000 + 0.01 * i) + "Z"), ""]
        ).encode(),
        "UTF-16": plain.encode("utf-16"),
        "gzip": gzip.compress(plain.encode(), 6),
    }
    files = {}
    for number, (name, data) in enumerate(forms.items()):
        files[name] = folder / f"form_{number}.csv"
        files[name].write_bytes(data)
    return files


def race_length(folder: Path, rounds: int, rows: int) -> Result:
    """All forms of one log."""
    files = write_forms(folder, rows)

    def competitor(name: str, file: Path) -> Competitor:
        def run() -> tuple[float, np.ndarray]:
            began = time.process_time()
            flight = sepcal.read_csv(file)
            spent = time.process_time() - began
            return spent, np.array([flight["airspeed_mps"].sum(), flight["p_pa"].sum()])

        return Competitor(name, run)

    racing = [competitor(name, file) for name, file in files.items()]
    race(racing, rounds)
    for file in files.values():
        file.unlink()
    title = f"Reading a log of {len(HEADERS)} columns, {rows:,} rows"
    return judge("reading", title, racing, lambda off: float(np.max(np.abs(off))), "of a sum")


def run(folder: Path, rounds: int, longest: int) -> Iterator[Result]:
    """Text tables, then forms that have a library."""
    for rows in lengths_within(longest, ROWS):
        yield race_length(folder, rounds, rows)
    for rows in lengths_within(longest, ROWS_OF_LIBRARIES):
        values = [np.round(0.01 * np.arange(rows), 2), *draw_numbers(rows).T.copy()]
        plain = write_forms(folder, rows)["plain CSV"]
        yield race_libraries(folder, plain, dict(zip(HEADERS, values, strict=True)), rounds)
