# SPDX-License-Identifier: BSD-3-Clause
"""What a part of the study of trust is: trials by key, each a row of figures, and what they say."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Sequence
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
