# SPDX-License-Identifier: BSD-3-Clause
"""What is said of flights of another simulator in which nothing is hidden."""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Iterator, Sequence

from studies.study import Finding
from studies.trust.asked import ask, first_of, is_lag
from studies.trust.by_key import NOTHING, fly_key
from studies.trust.part import Key, Part, Row, chosen_noises, flight_seeds, in_per_cent
from studies.trust.simulator.disturbances import DISTURBANCES, HELD, NOISE_HELD
from studies.trust.simulator.flights import rows_of

FOUND, FOUND_IN_ALL = 0.03, 0.015
SLOW = 0.05
STEADY = (  # noises that do not wander
    *("white", "AR(0.9)", "bursty", "quantised at 1 noise", "quantised at 3 noises"),
    *(NOISE_HELD, HELD),
)


def list_keys(arguments: argparse.Namespace) -> Iterator[Key]:
    """A flight each noise in turn, of the seed's probe."""
    for seed in flight_seeds(arguments):
        for noise in chosen_noises(arguments, DISTURBANCES):
            probes = DISTURBANCES[noise].probes
            yield NOTHING, probes[seed % len(probes)], noise, 0.0, rows_of(seed), seed


def _try(key: Key) -> Row:
    return ask(*fly_key(key))[0]


def is_false(row: Row) -> bool:
    """Whether an effect is called found. A held column is late, and saying so is right."""
    late = row["key"][2] == HELD and is_lag(first_of(row))
    return row["verdict"] == "effect_missing" and not late


def _summarise(rows: Sequence[Row]) -> list[Finding]:
    by_noise: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        by_noise[row["key"][2]].append(row)
    findings = [_count_found(noise, flights, FOUND) for noise, flights in by_noise.items()]
    findings.append(_count_found("all noises", rows, FOUND_IN_ALL))
    for noise, flights in by_noise.items():
        slow = sum(row["verdict"] == "slow_change" for row in flights)
        asked = f"{100 * SLOW:g} %" if noise in STEADY else "reported"
        holds = noise not in STEADY or slow <= SLOW * len(flights)
        what = f"nothing hidden, {noise}: a slow change"
        findings.append(Finding(what, in_per_cent(slow, len(flights)), asked, holds))
    return findings


def _count_found(where: str, rows: Sequence[Row], most: float) -> Finding:
    found = sum(map(is_false, rows))
    what = f"nothing hidden, {where}: found"
    figure = in_per_cent(found, len(rows))
    return Finding(what, figure, f"{100 * most:g} %", found <= most * len(rows))


NOTHING_HIDDEN = Part(list_keys, _try, _summarise)
