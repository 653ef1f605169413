# SPDX-License-Identifier: BSD-3-Clause
"""`python -m sepcal study NAME`: hidden-effects, intervals."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from sepcal._core import Error
from sepcal.progress import progress_bar
from sepcal.study.coverage import CoverageOptions, interval_coverage
from sepcal.study.coverage_write_up import write_coverage
from sepcal.study.experiments import StudyOptions, hidden_effects
from sepcal.study.write_up import write_up


def add_to(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Registers the command."""
    parser = commands.add_parser("study", help="runs a study and writes its tables")
    parser.add_argument("name", choices=list(STUDIES), help="which one")
    parser.add_argument("-o", "--output", type=Path, default=None, help="default: NAME.md")
    parser.add_argument("--seeds", type=int, default=None, help="of each case (and size)")
    defaults = StudyOptions()
    parser.add_argument(
        "--null-seeds",
        type=int,
        default=defaults.null_seeds,
        help="of hidden-effects: with nothing hidden, of each",
    )
    parser.add_argument("--first-seed", type=int, default=defaults.first_seed)
    parser.add_argument("--processes", type=int, default=None, help="default: one a core")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Runs it and writes what it found."""
    seeds = 1 if arguments.seeds is None else arguments.seeds
    if min(seeds, arguments.null_seeds) < 1 or arguments.first_seed < 0:
        raise Error("--seeds and --null-seeds must be at least 1, --first-seed not negative")
    if arguments.processes is not None and arguments.processes < 1:
        raise Error("--processes must be at least 1")
    output = arguments.output or Path(f"{arguments.name}.md")
    if not output.parent.is_dir():
        raise Error(f"-o {output}: there is no folder {output.parent}")
    with progress_bar() as tell:
        written = STUDIES[arguments.name](arguments, output, tell)
    print(f"wrote {written}")
    return 0


def _hidden_effects(
    arguments: argparse.Namespace, output: Path, tell: Callable[[float], None]
) -> str:
    options = StudyOptions(
        seeds=arguments.seeds or StudyOptions.seeds,
        null_seeds=arguments.null_seeds,
        first_seed=arguments.first_seed,
        processes=arguments.processes,
    )
    write_up(hidden_effects(options, tell), options, output)
    return f"{output} and {output.with_suffix('.svg')}"


def _intervals(arguments: argparse.Namespace, output: Path, tell: Callable[[float], None]) -> str:
    options = CoverageOptions(
        seeds=arguments.seeds or CoverageOptions.seeds,
        first_seed=arguments.first_seed,
        processes=arguments.processes,
    )
    write_coverage(interval_coverage(options, tell), options, output)
    return str(output)


STUDIES: dict[str, Callable[[argparse.Namespace, Path, Callable[[float], None]], str]] = {
    "hidden-effects": _hidden_effects,
    "intervals": _intervals,
}
