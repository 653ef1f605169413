# SPDX-License-Identifier: BSD-3-Clause
"""Whether a flight is called adequate although some candidate takes a fifth of the error.

Every candidate is added to the model by a real fit, whatever the screens say of it.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator, Sequence

from sepcal import Error
from studies.study import Finding
from studies.trust.asked import ask, share_of
from studies.trust.by_key import SCREENS, fly_key
from studies.trust.part import Key, Part, Row, chosen_noises, in_per_cent
from studies.trust.simulator.channels import CHANNELS
from studies.trust.simulator.disturbances import DISTURBANCES
from studies.trust.simulator.probes import INSTRUMENTS
from studies.trust.something_hidden import PROBES, list_keys

MUCH = 0.2  # of the RMSE on rows held out
SHARES = (0.0, 0.25)  # hidden, of three flights in turn


def _keys(arguments: argparse.Namespace) -> Iterator[Key]:
    noises = chosen_noises(arguments, DISTURBANCES)
    first = arguments.first_seed
    for seed in range(first, first + arguments.refitted):
        share = SHARES[seed // len(PROBES) % len(SHARES)]
        yield from list_keys(SCREENS, [share], noises, [seed])


def list_forms(probe: str) -> Iterator[str]:
    """Every port along every channel and time, straight and bent."""
    for port in INSTRUMENTS[probe].ports:
        yield f"{port}[step(time)]"
        for driver in ("time", *CHANNELS):
            yield f"{port}[{driver}]"
            yield f"{port}[spline({driver},9)]"


def _try(key: Key) -> Row:
    probe, flown = fly_key(key)
    row, base = ask(probe, flown)
    if base is None:
        return row | {"much": {}}
    tried = [effect.name for effect in base.diagnose().effects if effect.visibility > 0.05]
    shares: dict[str, float] = {}
    refused = []
    for name in dict.fromkeys([*tried, *list_forms(probe)]):
        try:
            taken = share_of(base, name)
        except Error:
            refused.append(name)
            continue
        if taken is not None:
            shares[name] = taken
    much = {name: taken for name, taken in shares.items() if taken >= MUCH}
    best = sorted(much, key=lambda name: -much[name])
    return row | {"refitted": len(shares), "refused": refused, "much": {n: much[n] for n in best}}


def _summarise(rows: Sequence[Row]) -> list[Finding]:
    missed = [row for row in rows if row["verdict"] == "adequate" and row["much"]]
    unseen = sum(_is_beyond_the_screens(row) for row in missed)
    firsts = Counter(next(iter(row["much"])) for row in missed)
    listed = ", ".join(f"{name} ({count})" for name, count in firsts.most_common())
    figure = f"{in_per_cent(len(missed), len(rows))}: {listed or 'none'}"
    what = f"adequate, though a refitted candidate takes {100 * MUCH:g} % of what is held out"
    return [
        Finding(what, figure, "none", not missed),
        Finding("of these, no candidate of the page has so much", str(unseen), "reported", True),
    ]


def _is_beyond_the_screens(row: Row) -> bool:
    return all((effect["held_out_gain"] or 0.0) < MUCH for effect in row["ranked"])


REFITS = Part(_keys, _try, _summarise)
