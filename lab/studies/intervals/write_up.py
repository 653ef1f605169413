# SPDX-License-Identifier: BSD-3-Clause
"""The coverage of intervals as a Markdown table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from scipy.stats import binom

from sepcal import Error
from studies.intervals.coverage import Coverage, CoverageOptions

LEVEL = 0.95
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

From here on written by

    scripts/study intervals --seeds {options.seeds} -o docs/intervals.md

Every record is drawn from its seed (they count from {options.first_seed}) and fitted, the noise
unknown; both 95 % intervals of every parameter are found. Of {options.seeds} intervals that are
right, {lowest:.1f} to {highest:.1f} % hold the truth (99 % binomial limits; wider for fewer draws);
what lies outside is bold. "None": how often there is no Gaussian interval, as the estimate is at
its bound; its coverage is that of the others, in brackets of all draws. "Bound" and "open": how
often the bound ends the profile interval on a side, and how often nothing does. "Failed": how often
a side could not be found, which counts as a miss. The length is the median."""


def _share(part: int, whole: int) -> str:
    return f"{100 * part / whole:.1f}" if whole else "-"


def _coverage(holds: int, given: int) -> str:
    """Per cent, bold outside the binomial limits."""
    if not given:
        return "-"
    lowest, highest = binom.interval(0.99, given, LEVEL)
    share = _share(holds, given)
    return share if lowest <= holds <= highest else f"**{share}**"


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
    before = ""
    for row in rows:
        gaussian = _coverage(row.gaussian_holds, row.gaussian_given)
        if row.gaussian_given < row.seeds:
            gaussian += f" ({_share(row.gaussian_holds, row.seeds)})"
        cells = [
            row.case if row.case != before else "",
            str(row.seeds) if row.case != before else "",
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
        before = row.case
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n\nAll but draws and lengths in per cent of the draws."
