# SPDX-License-Identifier: BSD-3-Clause
"""What intervals promise of each case, and whether the counts keep it.

Ranges are the binomial's, at 99.99 % for each number asked for: other seeds would fail a correct
build in fewer than one run of 500.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import groupby

from studies.intervals.coverage import Coverage
from studies.study import Finding, binomial_limits, pooled_limits

LEVEL = 0.95
ODDS = 5e-5  # that a count is outside, on either side
FEW = 200  # draws; with fewer, rates that aren't nominal are held to wider limits


def promises(rows: Sequence[Coverage]) -> list[Finding]:
    """The findings of those cases that there are."""
    found = [finding for row in rows if row.name in CASES for finding in CASES[row.name](row)]
    return [*found, _together([row for row in rows if row.name != "coloured"])]


def _count(row: Coverage, what: str, events: int, rate: float) -> Finding:
    fewest, most = binomial_limits(row.seeds, rate, ODDS)
    name = f"{row.case}, {row.parameter}: {what}"
    figure, limits = f"{events} of {row.seeds}", f"{fewest} to {most}"
    return Finding(name, figure, limits, fewest <= events <= most)


def _profile(row: Coverage, level: float = LEVEL) -> Finding:
    return _count(row, "profile holds the truth", row.profile_holds, level)


def _short(row: Coverage) -> list[Finding]:
    return [_profile(row), _count(row, "Gaussian holds the truth", row.gaussian_holds, LEVEL)]


def _at_bound(row: Coverage) -> list[Finding]:
    """A truth on its bound: half the fits have no Gaussian interval; the profile has one side."""
    if row.parameter != "b":
        return []
    without = _count(row, "no Gaussian", row.seeds - row.gaussian_given, 0.5)
    return [without, _given(row, 0), _profile(row, 0.975)]


def _near_bound(row: Coverage) -> list[Finding]:
    """One standard error off its bound, the estimate lies on it in 16 % of the draws."""
    if row.parameter != "b":
        return []
    return [_count(row, "no Gaussian", row.seeds - row.gaussian_given, 0.1587), _profile(row)]


def _curved(row: Coverage) -> list[Finding]:
    """The parabola misses; its ends are too near on the long side."""
    margin = 1 if row.seeds >= FEW else 0
    figure = f"{row.gaussian_holds} against {row.profile_holds}"
    fewer = row.gaussian_holds + margin <= row.profile_holds
    what = f"{row.case}, {row.parameter}: Gaussian holds the truth less often than the profile"
    return [_profile(row), Finding(what, figure, "fewer", fewer)]


def _weak(row: Coverage) -> list[Finding]:
    """w_n may reach its bound before w_e has an end."""
    return [_given(row, row.seeds // 500), _profile(row)]


def _given(row: Coverage, most: int) -> Finding:
    missing = row.seeds - row.profile_given
    what = f"{row.case}, {row.parameter}: an end of the profile is not found"
    return Finding(what, f"{missing} of {row.seeds}", f"{most} at most", missing <= most)


def _coloured(row: Coverage) -> list[Finding]:
    """300 rows of AR(0.9): both are a few per cent short, as docs/method.md says."""
    ratio = row.profile_length / row.gaussian_length
    apart = abs(row.profile_holds - row.gaussian_holds)
    near = max(1.0, 0.02 * row.seeds)
    least = 0.82 * row.seeds if row.seeds >= FEW else binomial_limits(row.seeds, 0.87, ODDS)[0] - 1
    name = f"{row.case}, {row.parameter}: "
    return [
        Finding(name + "ratio of lengths", f"{ratio:.3f}", "0.95 to 1.05", abs(ratio - 1) <= 0.05),
        Finding(name + "one holds and not the other", str(apart), f"{near:g}", apart <= near),
        Finding(
            name + "profile holds the truth",
            f"{row.profile_holds} of {row.seeds}",
            f"more than {least:g}",
            row.profile_holds > least,
        ),
    ]


def _together(rows: Sequence[Coverage]) -> Finding:
    """Profiles of all parameters: few draws show by their number what one parameter can't."""
    cases = [list(some) for _, some in groupby(rows, lambda row: row.name)]
    fewest, most = pooled_limits(((len(case), case[0].seeds) for case in cases), LEVEL)
    holds, of = sum(row.profile_holds for row in rows), sum(row.seeds for row in rows)
    what = "white noise, all together: profile holds the truth"
    return Finding(what, f"{holds} of {of}", f"{fewest} to {most}", fewest <= holds <= most)


CASES: dict[str, Callable[[Coverage], list[Finding]]] = {
    "short": _short,
    "at_bound": _at_bound,
    "near_bound": _near_bound,
    "curved": _curved,
    "weak": _weak,
    "coloured": _coloured,
}
