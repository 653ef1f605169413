# SPDX-License-Identifier: BSD-3-Clause
"""Competitors that solve one problem in turns, on one core, and the results of a race."""

from __future__ import annotations

import os
import statistics
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

PROGRAMS = {
    "sepcal": "sepcal_benchmark",
    "plain": "sepcal_benchmark_peers_plain",
    "native": "sepcal_benchmark_peers_native",
}
BUILD = Path(__file__).parents[2] / "build" / "benchmarks"
QUICK = 500  # rows, with which everything is over in a minute
Run = Callable[[], tuple[float, np.ndarray]]


def lengths_within(longest: int, lengths: tuple[int, ...]) -> list[int]:
    """Those that are not too long; where all are, one that is short enough to be quick."""
    return [one for one in lengths if one <= longest] or [QUICK]


@dataclass
class Competitor:
    """A way to solve the problem: `run` returns seconds of CPU and the answer."""

    name: str
    run: Run
    seconds: list[float] = field(default_factory=list)
    answer: np.ndarray = field(default_factory=lambda: np.empty(0))


def timed(solve: Callable[[], np.ndarray], repeats: int = 1) -> Run:
    """A competitor's `run` that measures a Python function: the fastest of repeats.

    All threads of the process count, since some libraries compute on threads of their own.
    """

    def run() -> tuple[float, np.ndarray]:
        fastest = float("inf")
        for _ in range(repeats):
            begin = time.process_time()
            answer = solve()
            fastest = min(fastest, time.process_time() - begin)
        return fastest, answer

    return run


def ask(program: str, *arguments: object, isa: str = "") -> tuple[float, np.ndarray]:
    """Seconds and answer of one of the benchmark's programs, which measure themselves.

    isa: the instruction set that sepcal is to use instead of the widest.
    """
    command = [str(BUILD / PROGRAMS[program]), *map(str, arguments)]
    environment = os.environ | ({"SEPCAL_ISA": isa} if isa else {})
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, env=environment)
    numbers = np.array(done.stdout.split(), dtype=float)
    return float(numbers[0]), numbers[1:]


def program(problem: str, method: str, file: Path, repeats: int = 10, isa: str = "") -> Run:
    """A competitor's `run` by sepcal_benchmark: the fastest of repeats."""
    return lambda: ask("sepcal", problem, method, file, repeats, isa=isa)


def peer(flags: str, problem: str, method: str, file: Path, repeats: int = 3) -> Run:
    """A competitor's `run` by the peers' program for `flags`, plain or native."""
    return lambda: ask(flags, problem, method, file, repeats)


def race(competitors: list[Competitor], rounds: int, budget: float = 20.0) -> None:
    """Runs all in turns, so that a load of the machine falls on each alike.

    Who has used `budget` seconds of CPU rests from then on: one turn of the slowest is enough.
    """
    spent = dict.fromkeys(range(len(competitors)), 0.0)
    for _ in range(rounds):
        for k, competitor in enumerate(competitors):
            if competitor.seconds and spent[k] > budget:
                continue
            begin = sum(os.times()[:4])  # children's too
            seconds, competitor.answer = competitor.run()
            competitor.seconds.append(seconds)
            spent[k] += sum(os.times()[:4]) - begin


@dataclass
class Line:
    """What is kept of a competitor. `ratio`: median time over the first competitor's."""

    name: str
    fastest: float  # s
    median: float  # s
    turns: int
    ratio: float
    off: float  # the answer's largest difference from the first's


@dataclass
class Result:
    """A race that was run; the first competitor is what ratios are of."""

    race: str
    title: str
    unit: str  # of Line.off; empty where answers are not compared
    lines: list[Line]
    notes: list[str] = field(default_factory=list)  # sentences below the table
    facts: dict[str, float] = field(default_factory=dict)  # numbers that they are made of

    def table(self) -> str:
        """Markdown."""
        if not self.lines:
            return "\n\n".join([f"**{self.title}**", *self.notes])
        titles = ["", "fastest", "median", "turns", "times the first"]
        if self.unit:
            titles.append(f"answer differs by, {self.unit}")
        rows = [f"**{self.title}**", "", f"| {' | '.join(titles)} |", "|---" * len(titles) + "|"]
        for one in self.lines:
            cells = [one.name, show_time(one.fastest), show_time(one.median), str(one.turns)]
            cells += [f"{one.ratio:.3g}", f"{one.off:.1g}"]
            rows.append(f"| {' | '.join(cells[: len(titles)])} |")
        return "\n".join([*rows, *(f"\n{note}" for note in self.notes)])

    def to_json(self) -> dict[str, Any]:
        """Of plain values."""
        return {
            "race": self.race,
            "title": self.title,
            "unit": self.unit,
            "competitors": [vars(one) for one in self.lines],
            "notes": self.notes,
            "facts": self.facts,
        }


def show_time(seconds: float) -> str:
    """Three digits and a unit."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def judge(
    name: str,
    title: str,
    competitors: list[Competitor],
    agreement: Callable[[np.ndarray], float],
    unit: str,
) -> Result:
    """The race's result. The first competitor is what the others are held against."""
    first = competitors[0]
    lines = []
    for one in competitors:
        together = zip(one.seconds, first.seconds, strict=False)  # within a turn
        ratio = statistics.median(seconds / ours for seconds, ours in together)
        off = agreement(one.answer - first.answer)
        middle = statistics.median(one.seconds)
        lines.append(Line(one.name, min(one.seconds), middle, len(one.seconds), ratio, off))
    return Result(name, title, unit, lines)
