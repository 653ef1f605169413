# SPDX-License-Identifier: BSD-3-Clause
"""What a part of the study is, and what comes of one: tables, figures, numbers, findings."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.random import Generator

import sepcal
from sepcal.columns import Array
from sepcal.quantiles import binomial_limits
from studies.study import Finding, Progress

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Item = TypeVar("Item")
Found = TypeVar("Found")


@dataclass(frozen=True)
class Options:
    """How much of a part is run."""

    runs: int
    seed: int
    workers: int


@dataclass(frozen=True)
class Table:
    """Cells are as they are read."""

    title: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ""

    def markdown(self) -> str:
        """As a page has it."""
        lines = [
            f"**{self.title}**",
            "",
            f"| {' | '.join(self.head)} |",
            f"|{'---|' * len(self.head)}",
            *(f"| {' | '.join(row)} |" for row in self.rows),
        ]
        return "\n".join([*lines, *(["", self.note] if self.note else [])])

    def text(self) -> str:
        """As a terminal has it."""
        cells = [list(self.head), *map(list, self.rows)]
        widths = [max(len(row[i]) for row in cells) for i in range(len(self.head))]
        lines = ["  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) for row in cells]
        return "\n".join([self.title, *(line.rstrip() for line in lines), self.note]).rstrip()


@dataclass(frozen=True)
class Result:
    """What a part found."""

    tables: Sequence[Table]
    numbers: Mapping[str, Any]
    figures: Mapping[str, Callable[[Figure], None]] = field(default_factory=dict)
    findings: Sequence[Finding] = ()


@dataclass(frozen=True)
class Part:
    """`scripts/study paper --part NAME`."""

    name: str
    shows: str
    run: Callable[[Options, Progress], Result]


def over(
    items: Iterable[Item],
    work: Callable[[Item], Found],
    options: Options,
    report_progress: Progress,
) -> list[Found]:
    """What `work` makes of each item, side by side, in their order."""
    listed = list(items)
    found = []
    with ThreadPoolExecutor(options.workers) as pool:
        for one in pool.map(work, listed):
            found.append(one)
            report_progress(len(found) / len(listed))
    return found


def share_of(report_progress: Progress, part: int, parts: int) -> Progress:
    """Of one part among several that take about as long."""
    return lambda done: report_progress((part + done) / parts)


ETA = np.linspace(1.0, 10.0, 100)  # of the scalar examples [rad]
SIGMA = 0.3  # of their noise


def measure_wave(
    model: sepcal.Model, xi: Sequence[float] | Array, rng: Generator
) -> dict[str, Array]:
    """The paper's record of a scalar example, whose two linear parameters come first."""
    A, b = model.evaluate({"eta": ETA}, xi[2:])
    z = A[:, 0] @ xi[:2] + b[:, 0]
    return {"eta": ETA, "z": z + SIGMA * rng.standard_normal(ETA.size)}


def rate(events: int, of: int) -> str:
    """A share with Clopper and Pearson's 95 % limits, "97.8 % (96.7-98.6)"."""
    if of == 0:
        return "-"
    low, high = binomial_limits(events, of)
    return f"{100 * events / of:.1f} % ({100 * low:.1f}-{100 * high:.1f})"


def figures(value: float, digits: int = 4) -> str:
    """So many after the point; "-" of what there isn't."""
    return f"{value:.{digits}f}" if math.isfinite(value) else "-"


def exact(what: str, holds: bool, figure: str, limits: str) -> Finding:
    """A known answer."""
    return Finding(what, figure, limits, holds)
