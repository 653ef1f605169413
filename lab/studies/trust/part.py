# SPDX-License-Identifier: BSD-3-Clause
"""What a part of the study of trust is: trials by key, each a row of figures, and what they say."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from scipy.stats import beta

from studies.study import Finding

Key: TypeAlias = tuple[str, str, str, float, int, int]  # part, case, noise, sigmas, rows, seed
Row: TypeAlias = dict[str, Any]


@dataclass(frozen=True)
class Part:
    """`--part NAME`."""

    keys: Callable[[argparse.Namespace], Iterator[Key]]
    try_key: Callable[[Key], Row]
    summarise: Callable[[Sequence[Row]], list[Finding]]


def upper_limit(events: int, trials: int) -> float:
    """Of a rate, 99 % one-sided (Clopper & Pearson)."""
    return 1.0 if events == trials else float(beta.ppf(0.99, events + 1, trials - events))


def limits(events: int, trials: int, confidence: float = 0.95) -> tuple[float, float]:
    """Of a rate, two-sided (Clopper & Pearson)."""
    tail = 0.5 * (1.0 - confidence)
    lower = 0.0 if events == 0 else float(beta.ppf(tail, events, trials - events + 1))
    upper = 1.0 if events == trials else float(beta.ppf(1.0 - tail, events + 1, trials - events))
    return lower, upper


def in_per_cent(events: int, trials: int) -> str:
    """`3 of 600, 0.5 % (0.1 to 1.5)`."""
    if trials == 0:
        return "0 of 0"
    lower, upper = (100.0 * limit for limit in limits(events, trials))
    rate = f"{100.0 * events / trials:.1f} % ({lower:.1f} to {upper:.1f})"
    return f"{events} of {trials}, {rate}"


def flight_seeds(arguments: argparse.Namespace) -> range:
    """Of the parts that take so many flights a noise and size."""
    return range(arguments.first_seed, arguments.first_seed + arguments.flights)


def chosen_noises(arguments: argparse.Namespace, every: Iterable[str]) -> list[str]:
    """Those of --noise, in the order of `every`; all where none is named."""
    return [noise for noise in every if not arguments.noise or noise in arguments.noise]
