# SPDX-License-Identifier: BSD-3-Clause
"""The coverage of intervals as a Markdown table."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby
from pathlib import Path

from scipy.stats import binom

from sepcal import Error
from studies.intervals.coverage import Coverage, CoverageOptions

LEVEL = 0.95
MANY = 4  # parameters of a case that may share a row
HEADING = "## How often they hold the truth"


def write_coverage(rows: Sequence[Coverage], options: CoverageOptions, file: Path) -> None:
    """Writes `file`; of one that is there what stands above the study's heading is kept.

    Raises Error where it can't be written.
    """
    try:
        above = file.read_text(encoding="utf-8") if file.exists() else ""
        above = above.partition(HEADING)[0] if HEADING in above else "# Intervals\n\n"
        file.write_text(f"{above}{_head(options)}\n\n{_table(rows)}\n", encoding="utf-8")
    except OSError as error:
        raise Error(f"{file} can't be written: {error.strerror}") from error


def _head(options: CoverageOptions) -> str:
    lowest, highest = (100 * k / options.seeds for k in binom.interval(0.99, options.seeds, LEVEL))
    return f"""{HEADING}

The rest of this page is written by

    scripts/study intervals --seeds {options.seeds} -o docs/intervals.md

The study draws every record from its seed, counted from {options.first_seed}, fits it with
unknown noise and finds both 95 % intervals. Of {options.seeds} correct intervals {lowest:.1f} to
{highest:.1f} % hold the truth (99 % binomial limits, wider for fewer draws); coverage outside is
bold.

- "none": the estimate is at its bound, so there is no Gaussian interval. Coverage is that of the
  other draws, in brackets that of all.
- "bound", "open": how often the parameter's bound ends a side of the profile interval, or nothing.
- "failed": how often a side was not found, which counts as a miss.

A case with many parameters and nothing remarkable has one row, with their range."""


def _share(part: int, whole: int) -> str:
    return f"{100 * part / whole:.1f}" if whole else "-"


def _is_within_limits(holds: int, given: int) -> bool:
    lowest, highest = binom.interval(0.99, given, LEVEL)
    return bool(lowest <= holds <= highest)


def _coverage(holds: int, given: int) -> str:
    """Per cent, bold outside the binomial limits."""
    if not given:
        return "-"
    share = _share(holds, given)
    return share if _is_within_limits(holds, given) else f"**{share}**"


def _is_plain(row: Coverage) -> bool:
    """Whether both intervals were always found, within no bound, and cover."""
    return (
        row.gaussian_given == row.profile_given == row.seeds
        and row.bound == row.open == 0
        and _is_within_limits(row.gaussian_holds, row.seeds)
        and _is_within_limits(row.profile_holds, row.seeds)
    )


def _range(shares: Iterable[str]) -> str:
    lowest, *_, highest = sorted(shares, key=float)
    return f"{lowest} to {highest}"


def _cells(row: Coverage) -> list[str]:
    gaussian = _coverage(row.gaussian_holds, row.gaussian_given)
    if row.gaussian_given < row.seeds:
        gaussian += f" ({_share(row.gaussian_holds, row.seeds)})"
    return [
        f"`{row.parameter}`",
        gaussian,
        _share(row.seeds - row.gaussian_given, row.seeds),
        f"{row.gaussian_length:.3g}",
        _coverage(row.profile_holds, row.seeds),
        _share(row.bound, row.seeds),
        _share(row.open, row.seeds),
        _share(row.seeds - row.profile_given, row.seeds),
        f"{row.profile_length:.3g}",
    ]


def _rows_of_case(rows: list[Coverage]) -> list[list[str]]:
    if len(rows) < MANY or not all(map(_is_plain, rows)):
        return [_cells(row) for row in rows]
    gaussian = _range(_share(row.gaussian_holds, row.seeds) for row in rows)
    profile = _range(_share(row.profile_holds, row.seeds) for row in rows)
    never = "0.0"
    return [[f"{len(rows)} parameters", gaussian, never, "", profile, never, never, never, ""]]


def _table(rows: Sequence[Coverage]) -> str:
    head = [
        "case",
        "draws",
        "parameter",
        "Gaussian holds it",
        "none",
        "length",
        "profile holds it",
        "bound",
        "open",
        "failed",
        "length",
    ]
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    for case, of_case in groupby(rows, key=lambda row: row.case):
        group = list(of_case)
        names = [case, str(group[0].seeds)]
        for cells in _rows_of_case(group):
            lines.append(f"| {' | '.join([*names, *cells])} |")
            names = ["", ""]
    return "\n".join(lines) + "\n\nShares are per cent of the draws, lengths medians."
