# SPDX-License-Identifier: BSD-3-Clause
"""`python -m sepcal study hidden-effects`."""

from __future__ import annotations

import argparse
from pathlib import Path

from sepcal._core import Error
from sepcal.progress import progress_bar
from sepcal.study.experiments import StudyOptions, hidden_effects
from sepcal.study.write_up import write_up


def add_to(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Registers the command."""
    parser = commands.add_parser("study", help="runs a study and writes its tables")
    parser.add_argument("name", choices=["hidden-effects"], help="which one")
    parser.add_argument("-o", "--output", type=Path, default=Path("hidden-effects.md"))
    defaults = StudyOptions()
    parser.add_argument("--seeds", type=int, default=defaults.seeds, help="of each case and size")
    parser.add_argument(
        "--null-seeds", type=int, default=defaults.null_seeds, help="with nothing hidden, of each"
    )
    parser.add_argument("--first-seed", type=int, default=defaults.first_seed)
    parser.add_argument("--processes", type=int, default=None, help="default: one a core")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Runs it and writes the tables and the picture."""
    if min(arguments.seeds, arguments.null_seeds) < 1 or arguments.first_seed < 0:
        raise Error("--seeds and --null-seeds must be at least 1, --first-seed not negative")
    if arguments.processes is not None and arguments.processes < 1:
        raise Error("--processes must be at least 1")
    if not arguments.output.parent.is_dir():
        raise Error(f"-o {arguments.output}: there is no folder {arguments.output.parent}")
    options = StudyOptions(
        seeds=arguments.seeds,
        null_seeds=arguments.null_seeds,
        first_seed=arguments.first_seed,
        processes=arguments.processes,
    )
    with progress_bar() as tell:
        rows = hidden_effects(options, tell)
    write_up(rows, options, arguments.output)
    print(f"wrote {arguments.output} and {arguments.output.with_suffix('.svg')}")
    return 0
