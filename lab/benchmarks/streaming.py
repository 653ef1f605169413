# SPDX-License-Identifier: BSD-3-Clause
"""Logs longer than memory: `sepcal-pitot fit` with --stream beside one that holds the log."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.baseline import NOW, PROBE, spend
from benchmarks.race import Competitor, Result, judge, lengths_within, race

ROWS = (100_000, 1_000_000, 10_000_000)
LONGEST_HELD = 1_000_000  # rows of a log that is also fitted in memory


def race_length(folder: Path, rounds: int, rows: int, peaks: dict[str, dict[int, float]]) -> Result:
    """One log; `peaks` gets the megabytes by way and rows."""
    log, out = str(folder / "long.csv"), folder / "long.json"
    spend([str(NOW / "sepcal-pitot"), "simulate", "-o", log, "--rows", str(rows), "--seed", "1"])
    errors = np.empty(0)

    def competitor(name: str, *options: str) -> Competitor:
        def run() -> tuple[float, np.ndarray]:
            nonlocal errors
            command = ["fit", log, *PROBE, "--threads", "1", "-o", str(out), *options]
            spent = spend([str(NOW / "sepcal-pitot"), *command])
            peaks.setdefault(name, {})[rows] = spent.kilobytes / 1024
            entries = json.loads(out.read_text())["parameters"].values()
            errors = np.array([one["standard_error"] for one in entries])
            return spent.seconds, np.array([one["value"] for one in entries])

        return Competitor(name, run)

    racing = [competitor("with --stream", "--stream")]
    if rows <= LONGEST_HELD:
        racing.append(competitor("in memory"))
    race(racing, rounds if rows <= LONGEST_HELD else 1)
    title = f"sepcal-pitot fit of a log, {rows:,} rows"
    Path(log).unlink()
    return judge(
        "stream", title, racing, lambda off: float(np.max(np.abs(off / errors))), "standard errors"
    )


def run(folder: Path, rounds: int, longest: int) -> Iterator[Result]:
    """A table for each length, and how much memory each took."""
    peaks: dict[str, dict[int, float]] = {}
    lengths = lengths_within(longest, ROWS)
    for rows in lengths:
        yield race_length(folder, rounds, rows, peaks)
    memory = Result("stream", "Memory of a fit, at most", "", [])
    for name, by_rows in peaks.items():
        told = ", ".join(f"{size:,.0f} MB ({rows:,} rows)" for rows, size in by_rows.items())
        memory.notes.append(f"{name.capitalize()}: {told}.")
        memory.facts |= {f"{name}, {rows} rows": size for rows, size in by_rows.items()}
    yield memory
