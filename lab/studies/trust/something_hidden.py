# SPDX-License-Identifier: BSD-3-Clause
"""Whether causes that are hidden in flights of another simulator are seen, and by their name.

Part `hidden` makes a cause as large as takes a share of the error on rows held out, part `wander`
a multiple of the stated wander of the instrument.
"""

from __future__ import annotations

import argparse
import statistics
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from sepcal import Error
from studies.study import Finding
from studies.trust.asked import REFUSED, ask, names, share_of
from studies.trust.by_key import HIDDEN, WANDER, fly_key, make_case, parse_case
from studies.trust.part import Key, Part, Row, chosen_noises, flight_seeds, in_per_cent
from studies.trust.simulator.causes import Cause, causes_of
from studies.trust.simulator.disturbances import DISTURBANCES, WANDERING
from studies.trust.simulator.flights import rows_of
from studies.trust.simulator.probes import INSTRUMENTS

SEEN = {0.3: 0.99, 0.6: 0.995}  # by the share that the cause takes: how often not adequate
NAMED = {0.3: 0.9, 0.6: 0.97}
BESIDE_WANDER = {2.0: 0.8, 4.0: 0.97}  # by how many wanders: how often effect_missing
LARGEST_SET = 3


def _causes(probe: str) -> list[Cause]:
    """In an order that any stretch of them is a fair sample of."""
    every = list(causes_of(probe))
    return [every[i] for i in np.random.default_rng(len(probe)).permutation(len(every))]


PROBES = tuple(INSTRUMENTS)
CAUSES = {probe: _causes(probe) for probe in PROBES}


def list_keys(
    part: str, sizes: Sequence[float], noises: Sequence[str], seeds: Sequence[int]
) -> Iterator[Key]:
    """A flight each noise and size in turn, of the seed's probe and its cause."""
    for seed in seeds:
        for noise in noises:
            probes = DISTURBANCES[noise].probes
            probe = probes[seed % len(probes)]
            causes = CAUSES[probe]
            cause = causes[seed // len(probes) % len(causes)]
            for size in sizes:
                yield part, make_case(probe, cause), noise, size, rows_of(seed), seed


def _keys(part: str, sizes: Sequence[float]) -> Callable[[argparse.Namespace], Iterator[Key]]:
    def keys(arguments: argparse.Namespace) -> Iterator[Key]:
        noises = chosen_noises(arguments, DISTURBANCES if part == HIDDEN else WANDERING)
        return list_keys(part, sizes, noises, flight_seeds(arguments))

    return keys


def try_hidden(key: Key) -> Row:
    """The flight is asked, and its true effect fitted."""
    probe, flown = fly_key(key)
    row, base = ask(probe, flown)
    if base is None:
        return row | {"share": None}
    try:
        return row | {"share": share_of(base, flown.hidden[0].cause.effect)}
    except Error as error:
        return row | {"share": None, "not_added": str(error)}


def is_as_large(row: Row) -> bool:
    """Whether the true effect takes its share by a real fit: the others are not judged."""
    return row["share"] is not None and row["share"] >= row["key"][3]


def is_seen(row: Row) -> bool:
    """Whether the page says that something is wrong."""
    return row["verdict"] not in ("adequate", REFUSED)


def is_named(row: Row) -> bool:
    """Whether the true cause is first or in the set."""
    return names(row, *parse_case(row["key"][1])[1])


def _by_cell(rows: Sequence[Row]) -> dict[tuple[float, str], list[Row]]:
    cells: dict[tuple[float, str], list[Row]] = defaultdict(list)
    for row in rows:
        cells[row["key"][3], row["key"][2]].append(row)
    return cells


def _summarise_hidden(rows: Sequence[Row]) -> list[Finding]:
    findings = []
    for (share, noise), flights in _by_cell([row for row in rows if is_as_large(row)]).items():
        seen = sum(is_seen(row) for row in flights)
        named = [row for row in flights if is_named(row)]
        set_size = statistics.median(len(set(row["set"])) for row in named) if named else 0
        what = f"{100 * share:g} % hidden, {noise}"
        for how, count, least in (
            ("not adequate", seen, SEEN[share]),
            ("named", len(named), NAMED[share]),
        ):
            figure = in_per_cent(count, len(flights))
            holds = count >= least * len(flights)
            findings.append(Finding(f"{what}: {how}", figure, f"{100 * least:g} %", holds))
        asked = f"at most {LARGEST_SET}"
        holds = set_size <= LARGEST_SET
        findings.append(Finding(f"{what}: in a set of", f"{set_size:g}", asked, holds))
    return findings


def _summarise_wander(rows: Sequence[Row]) -> list[Finding]:
    findings = []
    for (times, noise), flights in _by_cell(rows).items():
        found = sum(row["verdict"] == "effect_missing" for row in flights)
        least = BESIDE_WANDER[times]
        what = f"{times:g} wanders hidden, {noise}: effect_missing"
        figure = in_per_cent(found, len(flights))
        holds = found >= least * len(flights)
        findings.append(Finding(what, figure, f"{100 * least:g} %", holds))
    return findings


SHARES_HIDDEN = Part(_keys(HIDDEN, tuple(SEEN)), try_hidden, _summarise_hidden)
WANDERS_HIDDEN = Part(_keys(WANDER, tuple(BESIDE_WANDER)), try_hidden, _summarise_wander)
