# SPDX-License-Identifier: BSD-3-Clause
"""What is called found where nothing is hidden."""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Iterator, Sequence

from studies.hidden_effects.cases import PROBES, calibrate
from studies.study import Finding, seed_range
from studies.trust.flights import NOISES, fly
from studies.trust.part import Key, Part, Row, chosen_noises, upper_limit

ROWS = 400
DECOYS = 5  # channels that drive nothing
QUIET = ("white", "AR(0.9)", "bursty", "bursty AR")  # that hardly wander


def _keys(part: str, arguments: argparse.Namespace) -> Iterator[Key]:
    for seed in seed_range(arguments):
        for rows in arguments.rows or (ROWS,):
            for noise in chosen_noises(arguments, NOISES):
                for probe in PROBES:
                    yield part, probe, noise, 0.0, rows, seed


def _try(key: Key) -> Row:
    part, probe, noise, _, rows, seed = key
    flight, _ = fly(probe, noise, seed, rows, decoys=DECOYS if part == "decoys" else 0)
    diagnosis = calibrate(probe, flight).diagnose()
    row: Row = {"verdict": diagnosis.verdict}
    if diagnosis.effects:
        row |= {"top": diagnosis.effects[0].name, "p": diagnosis.effects[0].p_adjusted}
    return row


def _count(what: str, rows: Sequence[Row], most: float) -> Finding:
    found = sum(row["verdict"] == "effect_missing" for row in rows)
    slow = sum(row["verdict"] == "slow_change" for row in rows)
    limit = upper_limit(found, len(rows))
    figure = f"{found} of {len(rows)} found (below {100 * limit:.1f} %), {slow} slow_change"
    return Finding(what, figure, f"below {100 * most:g} %", limit < most)


def _summarise(rows: Sequence[Row]) -> list[Finding]:
    by_noise: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        by_noise[row["key"][2]].append(row)
    part = rows[0]["key"][0]
    findings = [_count(f"{part}, {noise}", flights, 0.1) for noise, flights in by_noise.items()]
    quiet = [row for noise in QUIET for row in by_noise.get(noise, ())]
    if quiet:
        slow = sum(row["verdict"] == "slow_change" for row in quiet)
        figure = f"{slow} of {len(quiet)} slow_change"
        what = f"{part}, {', '.join(noise for noise in QUIET if noise in by_noise)}"
        findings.append(Finding(what, figure, "at most 5 %", slow <= 0.05 * len(quiet)))
    return [*findings, _count(f"{part}, all noises", rows, 0.03)]


ALARMS = Part(lambda arguments: _keys("alarms", arguments), _try, _summarise)
DECOY_CHANNELS = Part(lambda arguments: _keys("decoys", arguments), _try, _summarise)
