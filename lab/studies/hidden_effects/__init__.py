# SPDX-License-Identifier: BSD-3-Clause
"""The study of hidden effects: what is found, and what isn't. It writes docs/hidden-effects.md."""

from __future__ import annotations

import argparse
from pathlib import Path

from studies.hidden_effects.experiments import StudyOptions, hidden_effects
from studies.hidden_effects.sizes import SIZED, check_size
from studies.hidden_effects.write_up import write_up
from studies.study import Outcome, Progress, Study, check_folder, seeds


def _add_options(parser: argparse.ArgumentParser) -> None:
    seeds(StudyOptions.seeds, "flights of each effect and size")(parser)
    parser.add_argument(
        "--null-seeds",
        type=int,
        default=StudyOptions.null_seeds,
        help=f"flights of each probe and noise with nothing hidden ({StudyOptions.null_seeds})",
    )
    parser.add_argument("-o", "--output", type=Path, default=Path("hidden-effects.md"))


def _run(arguments: argparse.Namespace, report_progress: Progress) -> Outcome:
    output: Path = arguments.output
    check_folder(output)
    options = StudyOptions(
        seeds=arguments.seeds,
        null_seeds=arguments.null_seeds,
        first_seed=arguments.first_seed,
        processes=arguments.processes,
    )
    rows = hidden_effects(options, report_progress)
    write_up(rows, options, output)
    print(f"wrote {output} and {output.with_suffix('.svg')}")
    alarms = sum(row["verdict"] == "effect_missing" for row in rows["null"])
    shares = ", ".join(
        f"{100 * sum(found) / len(found):.0f} % at {sigmas:g} sigmas"
        for sigmas in options.sigmas
        for found in [[row["found"] for row in rows["power"] if row["sigmas"] == sigmas]]
    )
    return Outcome(
        f"found: {shares}; called found of nothing: {alarms} of {len(rows['null'])}",
        [check_size(case, range(40)) for case in SIZED],
    )


STUDY = Study(
    "hidden-effects",
    "how often the missing effect is found, and how often one that isn't there",
    _run,
    _add_options,
)
