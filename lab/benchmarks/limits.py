# SPDX-License-Identifier: BSD-3-Clause
"""What one core of this machine can do, measured beside the races."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from benchmarks.race import Result, ask

NAMES = ("baseline", "avx2", "avx512")  # as SEPCAL_ISA has them


@dataclass
class Limits:
    """Of one core."""

    operations: dict[str, float]  # a second, additions and multiplications, by instruction set
    reading: float  # bytes/s, a sum over a long array
    triad: float  # bytes/s, a[i] = b[i] + c d[i]


@cache
def measure() -> Limits:
    """Takes a second or two, once a process."""
    *peaks, reading, triad = ask("sepcal", "limits", "core", "-", 1)[1]
    there = {name: peak for name, peak in zip(NAMES, peaks, strict=True) if peak > 0}
    return Limits(there, reading, triad)


def instruction_sets() -> list[str]:
    """Those that the processor takes, the widest first."""
    return list(reversed(measure().operations))


def run(folder: Path, rounds: int, longest: int) -> Iterator[Result]:
    """No race: numbers alone."""
    limits = measure()
    gigas = {name: peak / 1e9 for name, peak in limits.operations.items()}
    peaks = ", ".join(f"{giga:.0f} by {name}" for name, giga in gigas.items())
    yield Result(
        "limits",
        "What one core can do",
        "",
        [],
        [
            f"Billions of additions and multiplications a second: {peaks}. Memory: "
            f"{limits.reading / 1e9:.1f} GB/s read, {limits.triad / 1e9:.1f} GB/s in "
            "a[i] = b[i] + c d[i]."
        ],
        {f"operations.{name}": peak for name, peak in limits.operations.items()}
        | {"reading": limits.reading, "triad": limits.triad},
    )
