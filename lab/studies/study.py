# SPDX-License-Identifier: BSD-3-Clause
"""What a study is, and what comes of it: numbers beside the limits that a right build keeps."""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

from scipy.stats import binom

from sepcal import Error

Progress: TypeAlias = Callable[[float], None]  # of the fraction done


@dataclass(frozen=True)
class Finding:
    """A number and its limits, in words, and whether it keeps them."""

    what: str
    figure: str
    limits: str
    holds: bool


@dataclass(frozen=True)
class Outcome:
    """What a study found; `figures` is the sentence that docs/studies.md has of it.

    `page`, where there is one, is Markdown that is printed before the findings.
    """

    figures: str
    findings: Sequence[Finding] = ()
    page: str = ""


@dataclass(frozen=True)
class Study:
    """`scripts/study NAME`."""

    name: str
    shows: str  # in one sentence
    run: Callable[[argparse.Namespace, Progress], Outcome]
    options: Callable[[argparse.ArgumentParser], None] = field(default=lambda _: None)


def seeds(default: int, of: str) -> Callable[[argparse.ArgumentParser], None]:
    """The options of a study that draws from seeds, so many of each thing as it has them."""

    def add(parser: argparse.ArgumentParser) -> None:
        text = f"{of} (default: {default})"
        parser.add_argument("--seeds", type=int, default=default, help=text)
        parser.add_argument("--first-seed", type=int, default=0, help="default: 0")
        parser.add_argument("--processes", type=int, default=os.cpu_count(), help="one a core")

    return add


def check_options(options: argparse.Namespace) -> None:
    """Raises Error for numbers of seeds or processes that are none."""
    for name, least in (("seeds", 1), ("null_seeds", 1), ("first_seed", 0), ("processes", 1)):
        if (value := getattr(options, name, None)) is not None and value < least:
            raise Error(f"--{name.replace('_', '-')} {value} must be at least {least}")


def seed_range(options: argparse.Namespace) -> range:
    """Those of --seeds and --first-seed."""
    return range(options.first_seed, options.first_seed + options.seeds)


def binomial_limits(trials: int, rate: float, odds: float) -> tuple[int, int]:
    """The fewest and the most events; either side leaves out less than these odds."""
    fewest, most = binom.ppf([odds, 1.0 - odds], trials, rate)
    return int(fewest), int(most)


def pooled_limits(
    flights: Iterable[tuple[int, int]], rate: float, errors: float = 4.0
) -> tuple[int, int]:
    """The fewest and the most events in all, of (events a flight, flights) of several kinds.

    So many standard errors about the mean, as if all events of a flight came together or none.
    """
    kinds = list(flights)
    mean = rate * sum(events * count for events, count in kinds)
    square = rate * (1.0 - rate) * sum(events**2 * count for events, count in kinds)
    off = errors * math.sqrt(square)
    most = sum(events * count for events, count in kinds)
    return math.ceil(mean - off), min(math.floor(mean + off), most)


def check_folder(file: Path) -> None:
    """Raises Error where there is none to write the file to; before hours are spent."""
    if not file.parent.is_dir():
        raise Error(f"-o {file}: there is no folder {file.parent}")
