# SPDX-License-Identifier: BSD-3-Clause
"""How the time of a whole default fit of the five-hole probe grows: with rows, samples, threads."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.five_hole import FiveHoleFlight
from benchmarks.race import Competitor, Result, ask, judge, lengths_within, program, race

ROWS = (1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000)
ALWAYS_ROWS = 1_000_000  # longer ones only where there is memory for them
SAMPLES = (100, 200, 500, 1_000, 2_000, 5_000)
BYTES_A_ROW = 700  # of the simulation, the file and the fit together


def available_bytes() -> int:
    """Memory that nobody uses."""
    return os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def measure(title: str, competitors: list[Competitor], rounds: int, counts: list[int]) -> Result:
    """The times by what is counted, as facts too."""
    race(competitors, rounds)
    result = judge("growth", title, competitors, lambda off: 0.0, "")
    result.facts |= {
        str(count): line.median for count, line in zip(counts, result.lines, strict=True)
    }
    return result


def with_rows(folder: Path, rounds: int, lengths: list[int]) -> Result:
    """500 samples each."""
    competitors = []
    for rows in lengths:
        file = FiveHoleFlight(folder, rows).bare
        competitors.append(Competitor(f"{rows:,} rows", program("five-hole", "fit", file, 1)))
    return measure("Growth with rows, 500 samples", competitors, rounds, lengths)


def with_samples(folder: Path, rounds: int, rows: int) -> Result:
    """One flight."""
    flight = FiveHoleFlight(folder, rows)
    competitors = []
    for count in SAMPLES:
        file = flight.write(np.zeros(16), np.zeros(5 * count))
        competitors.append(Competitor(f"{count:,} samples", program("five-hole", "fit", file, 1)))
    title = f"Growth with samples, {rows:,} rows"
    return measure(title, competitors, rounds, list(SAMPLES))


def with_threads(folder: Path, rounds: int, rows: int) -> Result:
    """Wall time, of the cores that there are."""
    file = FiveHoleFlight(folder, rows).bare
    cores = set(range(os.cpu_count() or 1))
    counts = [count for count in (1, 2, 4, 8, 16) if count <= len(cores)]
    pinned = os.sched_getaffinity(0)
    competitors = [
        Competitor(
            f"{count} thread{'s' if count > 1 else ''}",
            lambda count=count: ask("sepcal", "five-hole", f"wall-{count}", file, 1),  # type: ignore[misc]
        )
        for count in counts
    ]
    os.sched_setaffinity(0, cores)
    try:
        result = measure(f"Wall time by threads, {rows:,} rows", competitors, rounds, counts)
    finally:
        os.sched_setaffinity(0, pinned)
    return replace(result, notes=["Of the clock on the wall, so that other load counts too."])


def run(folder: Path, rounds: int, longest: int) -> Iterator[Result]:
    """Three tables."""
    lengths = [
        rows
        for rows in lengths_within(longest, ROWS)
        if rows <= ALWAYS_ROWS or available_bytes() > rows * BYTES_A_ROW
    ]
    yield with_rows(folder, rounds, lengths)
    yield with_samples(folder, rounds, lengths_within(longest, (5_000,))[0])
    if hasattr(os, "sched_setaffinity"):
        yield with_threads(folder, rounds, lengths_within(longest, (100_000,))[0])
