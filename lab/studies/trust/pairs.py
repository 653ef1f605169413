# SPDX-License-Identifier: BSD-3-Clause
"""Two causes at once, some behind a channel that goes with both: are the two named?"""

from __future__ import annotations

import argparse
import statistics
from collections import defaultdict
from collections.abc import Iterator, Sequence

from sepcal.diagnosis import Diagnosis
from studies.hidden_effects.cases import PAIRS, Case, calibrate
from studies.study import Finding, seed_range
from studies.trust.flights import fly
from studies.trust.part import Key, Part, Row
from studies.trust.power import size_for


def _label(pair: tuple[Case, Case]) -> str:
    return f"{pair[0].probe}: {pair[0].effect} and {pair[1].effect}"


BY_LABEL = {_label(pair): pair for pair in PAIRS}


def _keys(arguments: argparse.Namespace) -> Iterator[Key]:
    for seed in seed_range(arguments):
        for sigmas in arguments.sigmas:
            for label, pair in BY_LABEL.items():
                yield "pairs", label, "white", sigmas, max(case.rows for case in pair), seed


def _said(diagnosis: Diagnosis) -> list[frozenset[str]]:
    """The pairs that the diagnosis names: as such, or as one that counts beside another."""
    named = [frozenset(pair.split("+")) for pair in diagnosis.pairs]
    if diagnosis.found:
        named.append(frozenset(diagnosis.effects[0].name.split("+")))
    for first in diagnosis.explanations:
        named += [frozenset([first, name]) for name in diagnosis.list_beside("counts")]
    return [pair for pair in named if len(pair) == 2]


def _try(key: Key) -> Row:
    _, label, noise, sigmas, rows, seed = key
    pair = BY_LABEL[label]
    hide = {case.effect: case.sizes(size_for(case, sigmas)) for case in pair}
    flight, quiet = fly(pair[0].probe, noise, seed, rows, hide)
    diagnosis = calibrate(pair[0].probe, flight).diagnose()
    said = _said(diagnosis)
    return {
        "verdict": diagnosis.verdict,
        "top": diagnosis.effects[0].name,
        "held": frozenset(quiet.effects) in said,
        "size": len(set(said)),
    }


def _summarise(rows: Sequence[Row]) -> list[Finding]:
    by_pair: dict[tuple[str, float], list[Row]] = defaultdict(list)
    for row in rows:
        by_pair[row["key"][1], row["key"][3]].append(row)
    findings = []
    for (label, sigmas), flights in sorted(by_pair.items()):
        held = sum(row["held"] for row in flights)
        size = statistics.median(row["size"] for row in flights)
        figure = f"the two are named in {held} of {len(flights)}, among {size:g} pairs"
        what = f"{label}, {sigmas:g} sigmas each"
        asked = sigmas >= 7.0
        holds = not asked or (held >= 0.95 * len(flights) and size <= 8)
        findings.append(Finding(what, figure, "95 %, 8 pairs" if asked else "reported", holds))
    return findings


PAIR_SETS = Part(_keys, _try, _summarise)
