# SPDX-License-Identifier: BSD-3-Clause
"""The study of intervals: how often both kinds hold the truth. It writes docs/intervals.md."""

from __future__ import annotations

import argparse
from pathlib import Path

from studies.intervals.coverage import CoverageOptions, interval_coverage
from studies.intervals.promises import promises
from studies.intervals.write_up import write_coverage
from studies.study import Outcome, Progress, Study, check_folder, seeds


def _add_options(parser: argparse.ArgumentParser) -> None:
    seeds(CoverageOptions.seeds, "records of each case, of slow ones fewer")(parser)
    parser.add_argument("-o", "--output", type=Path, default=Path("intervals.md"))


def _run(arguments: argparse.Namespace, report_progress: Progress) -> Outcome:
    output: Path = arguments.output
    check_folder(output)
    options = CoverageOptions(
        seeds=arguments.seeds, first_seed=arguments.first_seed, processes=arguments.processes
    )
    rows = interval_coverage(options, report_progress)
    write_coverage(rows, options, output)
    print(f"wrote {output}")
    right = [row for row in rows if row.name != "coloured"]
    shares = [100.0 * row.profile_holds / row.seeds for row in right]
    return Outcome(
        f"white noise: profile intervals hold {min(shares):.1f} to {max(shares):.1f} %",
        promises(rows),
    )


STUDY = Study(
    "intervals",
    "how often Gaussian and profile intervals hold the truth: short records, bounds, curved and "
    "weak models, coloured noise, a probe",
    _run,
    _add_options,
)
