# SPDX-License-Identifier: BSD-3-Clause
"""scripts/study NAME: runs a study and says what it found.

Exit codes: 0 done, 1 a number is outside its limits, 2 bad input in one line on standard error.
"""

from __future__ import annotations

import os
import shlex
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from measured import find_commit
from sepcal import Error
from sepcal.__main__ import BAD_INPUT, Parser
from sepcal.progress import show_progress
from studies import (
    changes,
    constants,
    effect_coverage,
    field_strength,
    fleets,
    flight_path,
    frequency_domain,
    hidden_effects,
    intervals,
    model_structure,
    monte_carlo,
    native,
    paper,
    starts,
    trajectories,
    trust,
)
from studies.study import Finding, Study, check_options

STUDIES: tuple[Study, ...] = (
    hidden_effects.STUDY,
    trust.STUDY,
    intervals.STUDY,
    monte_carlo.STUDY,
    effect_coverage.STUDY,
    field_strength.STUDY,
    fleets.STUDY,
    starts.STUDY,
    changes.STUDY,
    flight_path.STUDY,
    frequency_domain.STUDY,
    trajectories.STUDY,
    model_structure.STUDY,
    constants.STUDY,
    paper.STUDY,
    *native.STUDIES,
)
OUTSIDE_LIMITS = 1


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a study and returns its exit code."""
    typed = list(sys.argv[1:] if arguments is None else arguments)
    chosen = make_parser().parse_args(typed)
    study: Study = chosen.study
    try:
        check_options(chosen)
        with show_progress() as report_progress:
            outcome = study.run(chosen, lambda fraction: report_progress("", fraction))
        if outcome.page:
            print(outcome.page)
        for finding in outcome.findings:
            print(in_words(finding))
        outside = [finding for finding in outcome.findings if not finding.holds]
        of_all = f"{len(outcome.findings) - len(outside)} of {len(outcome.findings)} within limits"
        figures = f"{outcome.figures}; {of_all}" if outcome.findings else outcome.figures
        print(figures)
        if chosen.record is not None:
            write_row(chosen.record, study, typed, figures)
    except Error as error:
        print(f"study {study.name}: {error}", file=sys.stderr)
        return BAD_INPUT
    return OUTSIDE_LIMITS if outside else 0


def make_parser() -> Parser:
    """A command each study."""
    parser = Parser(
        prog="scripts/study",
        description="Rates and coverages over many simulated flights. docs/studies.md has their "
        "last figures. Exit code 1: a number is outside the limits that a right build keeps.",
    )
    commands = parser.add_subparsers(metavar="NAME", required=True)
    for study in STUDIES:
        text = study.shows.replace("%", "%%")
        command = commands.add_parser(study.name, help=text, description=text)
        study.options(command)
        command.add_argument(
            "--record", metavar="FILE", type=Path, help="put the figures into this file's table"
        )
        command.set_defaults(study=study)
    return parser


def in_words(finding: Finding) -> str:
    """A line."""
    mark = "" if finding.holds else "   OUTSIDE"
    return f"{finding.what}: {finding.figure} (limits: {finding.limits}){mark}"


def write_row(file: Path, study: Study, typed: Sequence[str], figures: str) -> None:
    """Replaces the study's row of the same part in the file's first table, or else adds it there.

    Raises Error where the file can't be read or written.
    """
    command = shlex.join(["scripts/study", *without(("--record", "--processes"), typed)])
    minutes = f"{sum(os.times()[:4]) / 60.0:.1f}"
    cells = (f"`{study.name}`", f"`{command}`", study.shows, figures, minutes, f"`{find_commit()}`")
    row = f"| {' | '.join(cells)} |"
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
        own = [i for i, line in enumerate(lines) if line.startswith(f"| `{study.name}` |")]
        same = [i for i in own if part_of(lines[i].split("`")[3]) == part_of(command)]
        rows = [i for i, line in enumerate(lines) if line.startswith("|")]
        behind = next((i + 1 for i in rows if i + 1 not in rows), 0)
        first, last = (same[0], same[0] + 1) if same else (own[-1] + 1 if own else behind,) * 2
        file.write_text("\n".join([*lines[:first], row, *lines[last:]]) + "\n", encoding="utf-8")
    except OSError as error:
        raise Error(f"{file}: {error.strerror}") from error


def part_of(command: str) -> tuple[str, ...]:
    """What a command measures, however many seeds it takes and wherever it writes."""
    sizes = ("--seeds", "--first-seed", "--null-seeds", "--runs", "-o", "--figures", "--json")
    return tuple(without(sizes, shlex.split(command)))


def without(options: Sequence[str], typed: Sequence[str]) -> Iterator[str]:
    """What was typed but for these options and their values, which change no figure."""
    words = iter(typed)
    for word in words:
        if word in options:
            next(words, None)
        elif not word.startswith(tuple(f"{option}=" for option in options)):
            yield word


if __name__ == "__main__":
    sys.exit(main())
