# SPDX-License-Identifier: BSD-3-Clause
"""The table of both errors: a row a noise, what is called found of nothing, and what of something.

Beside it, flight by flight, what fails: by what was hidden, and by what was said of it.
"""

from __future__ import annotations

import statistics
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence, Set

from studies.study import Finding
from studies.trust.asked import OVER_THE_FLOOR, REFUSED, first_of, why_missed
from studies.trust.by_key import HIDDEN, NOTHING, WANDER, parse_case
from studies.trust.nothing_hidden import is_false
from studies.trust.part import Row, limits
from studies.trust.simulator.disturbances import DISTURBANCES
from studies.trust.something_hidden import (
    BESIDE_WANDER,
    NAMED,
    is_as_large,
    is_named,
    is_seen,
)

PARTS = (NOTHING, HIDDEN, WANDER)


def tabulate(rows: Sequence[Row]) -> str:
    """Markdown: rates in %, with the 95 % limits of Clopper & Pearson; then the failures."""
    there = {(row["key"][0], row["key"][3]) for row in rows}
    lines: list[str] = []
    for noise in [noise for noise in DISTURBANCES if any(r["key"][2] == noise for r in rows)]:
        cells = dict(_cells([row for row in rows if row["key"][2] == noise], there))
        if not lines:
            lines += [_line(["noise", *cells]), _line(["---"] * (len(cells) + 1))]
        lines.append(_line([noise, *cells.values()]))
    lines.append(_line(["**all**", *dict(_cells(rows, there)).values()]))
    failures = list(list_failures(rows))
    told = ["", "What fails, by what was hidden and what was said:", "", *failures]
    return "\n".join([*lines, *(told if failures else ["", "Nothing fails."]), ""])


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _cells(rows: Sequence[Row], there: Set[tuple[str, float]]) -> Iterator[tuple[str, str]]:
    """Heads and cells of the parts that were flown."""

    def of(part: str, size: float = 0.0) -> list[Row]:
        return [row for row in rows if row["key"][0] == part and row["key"][3] == size]

    if (NOTHING, 0.0) in there:
        nothing = of(NOTHING)
        yield "nothing hidden: flights", str(len(nothing))
        yield "found", _rate(nothing, is_false)
        yield "slow_change", _rate(nothing, lambda row: row["verdict"] == "slow_change")
        yield "unexplained", _rate(nothing, lambda row: row["verdict"] == "unexplained")
        for probe in DISTURBANCES["white"].probes:
            own = [row for row in nothing if row["key"][1] == probe]
            yield f"found, {probe}", f"{sum(map(is_false, own))}/{len(own)}" if own else "-"
    for share in [share for share in NAMED if (HIDDEN, share) in there]:
        every = of(HIDDEN, share)
        large = [row for row in every if is_as_large(row)]
        percent = f"{100 * share:g} %"
        shares = [row["share"] for row in every if row["share"] is not None]
        sets = [len(set(row["set"])) for row in large if is_named(row)]
        yield f"{percent} hidden: flights", f"{len(large)} of {len(every)}"
        yield f"{percent}: not adequate", _rate(large, is_seen)
        yield f"{percent}: named", _rate(large, is_named)
        yield f"{percent}: median set", _median(sets, "g")
        yield f"{percent}: median share", _median(shares, ".2f")
    for times in [times for times in BESIDE_WANDER if (WANDER, times) in there]:
        rate = _rate(of(WANDER, times), lambda row: row["verdict"] == "effect_missing")
        yield f"{times:g} wanders: effect_missing", rate


def _rate(rows: Sequence[Row], event: Callable[[Row], bool]) -> str:
    if not rows:
        return "-"
    events = sum(map(event, rows))
    lower, upper = limits(events, len(rows))
    return f"{100 * events / len(rows):.1f} ({100 * lower:.1f}-{100 * upper:.1f})"


def _median(values: Sequence[float], form: str) -> str:
    return format(statistics.median(values), form) if values else "-"


def list_failures(rows: Sequence[Row]) -> Iterator[str]:
    """One line each kind of failure, with how many flights of which noises fail so."""
    kinds: dict[tuple[str, str], Counter[str]] = defaultdict(Counter)
    for row in rows:
        if failure := failure_of(row):
            kinds[failure][row["key"][2]] += 1
    for (what, why), noises in sorted(kinds.items(), key=lambda kind: -kind[1].total()):
        where = ", ".join(f"{noise} {count}" for noise, count in noises.most_common())
        yield f"- {noises.total()} x {what}: {why} ({where})"


def failure_of(row: Row) -> tuple[str, str] | None:
    """What was hidden and what was said of it, where that is wrong."""
    part, case, _, size, *_ = row["key"]
    if row["verdict"] == REFUSED:
        return case, f"refused: {row['sentence']}"
    if part == NOTHING:
        return (f"nothing, {case}", f"found {first_of(row)}") if is_false(row) else None
    causes = parse_case(case)[1]
    if part == HIDDEN:
        if not is_as_large(row) or is_named(row):
            return None
        return f"{100 * size:g} %, {case}", why_missed(row, causes)
    if row["verdict"] == "effect_missing":
        return None
    return f"{size:g} wanders, {case}", why_missed(row, causes)


def judge_words(rows: Sequence[Row]) -> Finding:
    """No page says that nothing is missing where the RMSE is far over the floor."""
    said = [
        row
        for row in rows
        if row["nothing_missing"] and row["floor"] and row["rmse"] >= OVER_THE_FLOOR * row["floor"]
    ]
    cases = Counter(f"{row['key'][1]} in {row['key'][2]}" for row in said)
    listed = ", ".join(f"{case} ({count})" for case, count in cases.most_common(5))
    what = f"nothing is missing, it says, at {OVER_THE_FLOOR:g} floors and more"
    return Finding(what, f"{len(said)} of {len(rows)}: {listed or 'none'}", "none", not said)
