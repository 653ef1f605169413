# SPDX-License-Identifier: BSD-3-Clause
"""How often intervals of both kinds hold the truth, and how long they are."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

from sepcal import ParameterInterval
from studies.intervals.cases import coverage_cases


@dataclass(frozen=True)
class Coverage:
    """Counts over the seeds of one parameter of one case."""

    name: str  # of the case
    case: str  # its title
    parameter: str
    seeds: int
    gaussian_given: int
    gaussian_holds: int
    gaussian_length: float  # median of those given
    profile_given: int  # all but those that could not be found
    profile_holds: int
    profile_length: float  # median, open ones infinitely long
    bound: int  # profile intervals that a bound ends
    open: int  # and those that are open


@dataclass(frozen=True)
class CoverageOptions:
    """How much is drawn."""

    seeds: int = 2000
    first_seed: int = 0
    processes: int | None = None  # None: one a core
    cases: tuple[str, ...] = ()  # empty: all


def interval_coverage(
    options: CoverageOptions, report_progress: Callable[[float], None] = lambda _: None
) -> list[Coverage]:
    """Runs the study, case by case, parameter by parameter."""
    chunk = 20
    cases = coverage_cases()
    names = options.cases or tuple(cases)
    last = {
        name: options.first_seed + math.ceil(cases[name].share * options.seeds) for name in names
    }
    tasks = [
        (name, range(first, min(first + chunk, last[name])))
        for name in names
        for first in range(options.first_seed, last[name], chunk)
    ]
    drawn: dict[str, dict[str, list[ParameterInterval]]] = {name: {} for name in names}
    with ProcessPoolExecutor(options.processes) as pool:
        for done, ((name, _), parts) in enumerate(
            zip(tasks, pool.map(_draw, tasks), strict=True), 1
        ):
            for interval in parts:
                drawn[name].setdefault(interval.name, []).append(interval)
            report_progress(done / len(tasks))
    return [
        count(name, cases[name].title, intervals, cases[name].truth[parameter])
        for name, by_parameter in drawn.items()
        for parameter, intervals in by_parameter.items()
    ]


def _draw(task: tuple[str, range]) -> list[ParameterInterval]:
    name, seeds = task
    case = coverage_cases()[name]
    return [
        interval
        for seed in seeds
        for interval in case.draw(seed).parameters.values()
        if interval.name in case.truth
    ]


def count(name: str, case: str, intervals: Sequence[ParameterInterval], truth: float) -> Coverage:
    """The counts of one parameter's intervals."""
    gaussian = [at.gaussian for at in intervals if not math.isnan(at.gaussian[0])]
    profile = [at.profile for at in intervals if "failed" not in at.ends]
    return Coverage(
        name=name,
        case=case,
        parameter=intervals[0].name,
        seeds=len(intervals),
        gaussian_given=len(gaussian),
        gaussian_holds=_holds(gaussian, truth),
        gaussian_length=_median_length(gaussian),
        profile_given=len(profile),
        profile_holds=_holds(profile, truth),
        profile_length=_median_length(profile),
        bound=sum("bound" in at.ends for at in intervals),
        open=sum("open" in at.ends for at in intervals),
    )


def _holds(intervals: Sequence[tuple[float, float]], truth: float) -> int:
    return sum(lower <= truth <= upper for lower, upper in intervals)


def _median_length(intervals: Sequence[tuple[float, float]]) -> float:
    lengths = sorted(upper - lower for lower, upper in intervals)
    return lengths[len(lengths) // 2] if lengths else math.nan
