# SPDX-License-Identifier: BSD-3-Clause
"""Whether the simplest of equals is named, and whether two causes are found and nothing else."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from sepcal import StepwiseStep
from studies.study import Finding
from studies.trust.asked import ask, first_of
from studies.trust.by_key import SIMPLE, TWO, fly_key, make_case, parse_case
from studies.trust.part import Key, Part, Row, chosen_noises, flight_seeds, in_per_cent
from studies.trust.simulator.causes import Cause
from studies.trust.simulator.flights import rows_of
from studies.trust.something_hidden import CAUSES, PROBES, try_hidden

NOISES = ("white", "AR(0.9)", "Gauss-Markov 10 s")
SHARE = 0.45  # of the RMSE on rows held out, of the one cause
WANDERS = 4.0  # of the instrument, each of two: what is within one can't be told from noise
SIMPLEST_FIRST, TWO_AND_NO_MORE = 0.97, 0.9


def _lines(probe: str) -> list[Cause]:
    return [cause for cause in CAUSES[probe] if cause.shape == "drift"]


def _cells(arguments: argparse.Namespace) -> Iterator[tuple[int, int, str, str]]:
    """Count, seed, noise and probe of one flight in six of those asked for."""
    noises = chosen_noises(arguments, NOISES)
    for count, seed in enumerate(flight_seeds(arguments)[:: len(PROBES) * 2]):
        for i, noise in enumerate(noises):
            yield count, seed, noise, PROBES[(count + i) % len(PROBES)]


def _simple_keys(arguments: argparse.Namespace) -> Iterator[Key]:
    for count, seed, noise, probe in _cells(arguments):
        lines = _lines(probe)
        cause = lines[count // len(PROBES) % len(lines)]
        yield SIMPLE, make_case(probe, cause), noise, SHARE, rows_of(seed), seed


def _two_keys(arguments: argparse.Namespace) -> Iterator[Key]:
    for _, seed, noise, probe in _cells(arguments):
        lines = _lines(probe)
        one, other = _draw_two(lines, seed)
        yield TWO, make_case(probe, one, other), noise, WANDERS, rows_of(seed), seed


def _draw_two(lines: Sequence[Cause], seed: int) -> tuple[Cause, Cause]:
    """Of different drivers, and not both of the airspeed: those two look alike."""
    rng = np.random.default_rng(seed)
    while True:
        one, other = (lines[i] for i in rng.permutation(len(lines))[:2])
        alike = {one.port, other.port} == {"airspeed_scale", "airspeed_bias"}
        if one.driver != other.driver and not alike:
            return one, other


def complication(name: str) -> str:
    """What a name has that a line does not: a curve, a power, a second cause; empty of a line."""
    if "+" in name:
        return "a pair"
    for mark, what in (("spline(", "a spline"), ("step(", "a step"), ("ramp(", "a ramp")):
        if mark in name:
            return what
    return "a power or product" if "^" in name or "*" in name else ""


def _summarise_simple(rows: Sequence[Row]) -> list[Finding]:
    found = [row for row in rows if row["verdict"] == "effect_missing"]
    before = Counter(complication(first_of(row)) for row in found)
    simple = before.pop("", 0)
    true = sum(parse_case(row["key"][1])[1][0].is_named_by(first_of(row)) for row in found)
    listed = ", ".join(f"{what} ({count})" for what, count in before.most_common())
    return [
        Finding(
            "a line is hidden and something found: a line is first",
            f"{in_per_cent(simple, len(found))}; else {listed or 'nothing'}",
            f"{100 * SIMPLEST_FIRST:g} %",
            simple >= SIMPLEST_FIRST * len(found),
        ),
        Finding("the true line is", in_per_cent(true, len(found)), "reported", True),
    ]


def _try_two(key: Key) -> Row:
    probe, flown = fly_key(key)
    causes = [hidden.cause for hidden in flown.hidden]
    row, base = ask(probe, flown)
    if base is None:
        return row | {"added": [], "true": [False, False], "false": []}
    stepped = base.diagnose(auto=True)
    kept = [step for step in stepped.steps if step.effect in stepped.effects]
    return row | {
        "added": [name for step in kept for name in step.effect.split("+")],
        "end": stepped.end,
        "last": stepped.diagnosis.verdict,
        "true": [any(_says(step, cause) for step in kept) for cause in causes],
        "false": [
            name
            for step in kept
            if not any(_says(step, cause) for cause in causes)
            for name in step.effect.split("+")
        ],
    }


def _says(step: StepwiseStep, cause: Cause) -> bool:
    """Whether the step adds the cause, or what the page calls as good."""
    said = [step.effect, *step.as_good]
    return any(cause.is_named_by(name) for names in said for name in names.split("+"))


def _summarise_two(rows: Sequence[Row]) -> list[Finding]:
    exact = [row for row in rows if all(row["true"]) and len(row["added"]) == len(row["true"])]
    both = [row for row in rows if all(row["true"])]
    false = Counter(name for row in rows for name in row["false"])
    listed = ", ".join(f"{name} ({count})" for name, count in false.most_common())
    beside = sum(bool(row["false"]) for row in both)
    return [
        Finding(
            "two causes: --auto ends with these two and no more",
            in_per_cent(len(exact), len(rows)),
            f"{100 * TWO_AND_NO_MORE:g} %",
            len(exact) >= TWO_AND_NO_MORE * len(rows),
        ),
        Finding("a false one stands beside the two", str(beside), "none", beside == 0),
        Finding("false ones added", listed or "none", "reported", True),
    ]


SIMPLEST = Part(_simple_keys, try_hidden, _summarise_simple)
TWO_CAUSES = Part(_two_keys, _try_two, _summarise_two)
