# SPDX-License-Identifier: BSD-3-Clause
"""Quantiles of Student's t, and Clopper & Pearson's limits of a rate."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

NODES, WEIGHTS = np.polynomial.legendre.leggauss(48)
HALVINGS = 60


@lru_cache(maxsize=1024)
def student_quantile(probability: float, degrees_of_freedom: int) -> float:
    """The t that a variable of Student's distribution stays below with this probability, 0.5 to 1.

    With t = sqrt(m) tan(theta) the density is that of cos(theta)^(m - 1), integrated by Gauss and
    Legendre. NaN where there are no degrees of freedom.
    """
    m = degrees_of_freedom
    if m < 1:
        return math.nan
    scale = math.exp(math.lgamma(0.5 * (m + 1)) - math.lgamma(0.5 * m)) / math.sqrt(math.pi)

    def between_zero_and(t: float) -> float:
        end = math.atan(t / math.sqrt(m))
        theta = 0.5 * end * (NODES + 1.0)
        return float(0.5 * end * scale * (WEIGHTS @ np.cos(theta) ** (m - 1)))

    high = 1.0
    while between_zero_and(high) < probability - 0.5 and high < 1e6:
        high *= 2.0
    low = 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if between_zero_and(middle) < probability - 0.5:
            low = middle
        else:
            high = middle
    return high


def upper_limit(events: int, trials: int, confidence: float = 0.99) -> float:
    """Clopper & Pearson's one-sided upper limit of a rate, by bisection."""
    if events >= trials:
        return 1.0
    k = np.arange(events + 1)
    steps = np.log((trials - k[1:] + 1.0) / k[1:]) if events else np.empty(0)
    log_ways = np.concatenate(([0.0], np.cumsum(steps)))  # of choosing k out of the trials

    def at_most(rate: float) -> float:
        logs = log_ways + k * math.log(rate) + (trials - k) * math.log1p(-rate)
        return float(np.exp(logs).sum())

    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if at_most(middle) > 1.0 - confidence else (low, middle)
    return high


def binomial_limits(events: int, trials: int, confidence: float = 0.95) -> tuple[float, float]:
    """Clopper & Pearson's two-sided limits of a rate; NaN of no trials."""
    if trials < 1:
        return math.nan, math.nan
    one_sided = 0.5 * (1.0 + confidence)
    lower = 1.0 - upper_limit(trials - events, trials, one_sided)
    return lower, upper_limit(events, trials, one_sided)
