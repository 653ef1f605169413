# SPDX-License-Identifier: BSD-3-Clause
"""Contenders that solve one problem in turns, on one core."""

from __future__ import annotations

import statistics
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

PROGRAM = Path(__file__).parents[2] / "build" / "benchmarks" / "sepcal_benchmark"


@dataclass
class Contender:
    """A way to solve the problem: `run` returns seconds and the answer."""

    name: str
    run: Callable[[], tuple[float, np.ndarray]]
    seconds: list[float] = field(default_factory=list)
    answer: np.ndarray = field(default_factory=lambda: np.empty(0))


def timed(solve: Callable[[], np.ndarray]) -> Callable[[], tuple[float, np.ndarray]]:
    """A contender's `run` that measures a Python function."""

    def run() -> tuple[float, np.ndarray]:
        begin = time.perf_counter()
        answer = solve()
        return time.perf_counter() - begin, answer

    return run


def program(
    problem: str, method: str, file: Path, repeats: int = 10
) -> Callable[[], tuple[float, np.ndarray]]:
    """A contender's `run` by sepcal_benchmark, which measures itself: the fastest of repeats."""

    def run() -> tuple[float, np.ndarray]:
        command = [str(PROGRAM), problem, method, str(file), str(repeats)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        numbers = np.array(done.stdout.split(), dtype=float)
        return float(numbers[0]), numbers[1:]

    return run


def race(contenders: list[Contender], rounds: int) -> None:
    """Runs all in turns, so that a load of the machine falls on each alike."""
    for _ in range(rounds):
        for contender in contenders:
            seconds, contender.answer = contender.run()
            contender.seconds.append(seconds)


def table(
    title: str, contenders: list[Contender], agreement: Callable[[np.ndarray], float], unit: str
) -> str:
    """Markdown. The first contender is what ratios are of, and what answers are held against."""
    first = contenders[0]
    lines = [
        f"**{title}**",
        "",
        f"| | fastest | median | times the first: fastest | median | answer differs by, {unit} |",
        "|---|---|---|---|---|---|",
    ]
    for one in contenders:
        ratios = [s / f for s, f in zip(one.seconds, first.seconds, strict=True)]
        best, middle = min(one.seconds), statistics.median(one.seconds)
        off = agreement(one.answer - first.answer)
        lines.append(
            f"| {one.name} | {1e3 * best:.3g} ms | {1e3 * middle:.3g} ms "
            f"| {best / min(first.seconds):.2g} | {statistics.median(ratios):.2g} | {off:.1g} |"
        )
    return "\n".join(lines)
