# SPDX-License-Identifier: BSD-3-Clause
"""`scripts/study paper`: which parts are run, and where their tables, figures and numbers go."""

from __future__ import annotations

import argparse
import json
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from measured import renew_line
from sepcal import Error
from studies.paper import (
    bounds,
    certificates,
    magnetometers,
    probe,
    scalar_examples,
    screens,
    wind_map,
)
from studies.paper.parts import Options, Part, Result, share_of
from studies.study import Outcome, Progress, Study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PARTS: tuple[Part, ...] = (
    *scalar_examples.PARTS,
    *probe.PARTS,
    *wind_map.PARTS,
    *bounds.PARTS,
    *certificates.PARTS,
    *screens.PARTS,
    *magnetometers.PARTS,
)
RUNS = 1000


def add_options(parser: argparse.ArgumentParser) -> None:
    """Those of the study."""
    names = ", ".join(part.name for part in PARTS)
    parser.add_argument(
        "--part",
        action="append",
        metavar="NAME",
        choices=[part.name for part in PARTS],
        help=f"one part alone, or several ({names})",
    )
    parser.add_argument("--runs", type=int, default=RUNS, help=f"of each table (default: {RUNS})")
    parser.add_argument("--first-seed", type=int, default=0, help="default: 0")
    parser.add_argument("--processes", type=int, default=os.cpu_count(), help="one a core")
    parser.add_argument("--json", metavar="FILE", type=Path, help="write all numbers")
    parser.add_argument("--figures", metavar="FOLDER", type=Path, help="write the figures, SVG")
    parser.add_argument(
        "-o", "--output", metavar="FILE", type=Path, help="put the tables into this page"
    )


def run(arguments: argparse.Namespace, report_progress: Progress) -> Outcome:
    """Runs the parts; what was asked for is written behind each, so that nothing is lost."""
    chosen = [part for part in PARTS if not arguments.part or part.name in arguments.part]
    check(arguments, [part.name for part in chosen])
    options = Options(arguments.runs, arguments.first_seed, arguments.processes)
    results: dict[str, Result] = {}
    for i, part in enumerate(chosen):
        result = part.run(options, share_of(report_progress, i, len(chosen)))
        results[part.name] = result
        for table in result.tables:
            print(f"\n{table.text()}", flush=True)
        if arguments.json is not None:
            write_numbers(arguments.json, options, results)
        if arguments.output is not None:
            write_tables(arguments.output, part.name, result)
        if arguments.figures is not None:
            draw_figures(arguments.figures, result)
    if arguments.output is not None and len(results) == len(PARTS):
        arguments.output.write_text(renewed(arguments.output), encoding="utf-8")
    print()
    findings = [finding for result in results.values() for finding in result.findings]
    return Outcome(f"{', '.join(results)}: {options.runs} runs", findings)


def check(arguments: argparse.Namespace, names: Sequence[str]) -> None:
    """Before minutes are spent.

    Raises:
        Error: Too few runs, or a place where nothing can be written.
    """
    if arguments.runs < 1:
        raise Error(f"--runs {arguments.runs} must be at least 1")
    if arguments.output is not None:
        for name in names:
            find_place(arguments.output, name)
        if len(names) == len(PARTS):
            renewed(arguments.output)
    file, folder = arguments.json, arguments.figures
    if file is not None and (file.is_dir() or not file.parent.is_dir()):
        raise Error(f"--json {file} is no file in a folder that there is")
    if folder is not None:
        figure_class()
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise Error(f"--figures {folder}: {error.strerror}") from error


def write_numbers(file: Path, options: Options, results: Mapping[str, Result]) -> None:
    """As JSON, by part."""
    whole = {
        "runs": options.runs,
        "first_seed": options.seed,
        "parts": {name: result.numbers for name, result in results.items()},
    }
    file.write_text(json.dumps(whole, indent=2, allow_nan=True) + "\n", encoding="utf-8")


def figure_class() -> type[Figure]:
    """Matplotlib's, which figures alone need.

    Raises:
        Error: It is missing.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise Error("--figures needs matplotlib: pip install matplotlib") from error
    return Figure


def draw_figures(folder: Path, result: Result) -> None:
    """One SVG each."""
    for name, draw in result.figures.items():
        figure = figure_class()(figsize=(7.0, 5.0), layout="constrained")
        draw(figure)
        figure.savefig(folder / f"{name}.svg", dpi=120, metadata={"Date": None})


def find_place(page: Path, name: str) -> str:
    """What stands in the page from `<!-- tables of NAME -->` to `<!-- end -->`.

    Raises:
        Error: The page can't be read or has no place, or several, for a part's tables.
    """
    try:
        text = page.read_text(encoding="utf-8")
    except OSError as error:
        raise Error(f"-o {page}: {error.strerror}") from error
    places = re.findall(
        rf"<!-- tables of {re.escape(name)} -->.*?<!-- end -->", text, flags=re.DOTALL
    )
    if len(places) != 1:
        raise Error(
            f"-o {page} has no place for the tables of {name}: give it two lines, "
            f"<!-- tables of {name} --> and <!-- end -->"
        )
    return str(places[0])


def write_tables(page: Path, name: str, result: Result) -> None:
    """Into their place; the rest of the page stays."""
    tables = "\n\n".join(table.markdown() for table in result.tables)
    text = page.read_text(encoding="utf-8").replace(
        find_place(page, name), f"<!-- tables of {name} -->\n{tables}\n<!-- end -->"
    )
    page.write_text(text, encoding="utf-8")


def renewed(page: Path) -> str:
    """The page with the commit of what was measured, which then is that of all tables.

    Raises:
        Error: It has no line for it.
    """
    try:
        return renew_line(page.read_text(encoding="utf-8"))
    except ValueError as error:
        raise Error(f"-o {page}: {error}") from error


STUDY = Study(
    "paper",
    "the paper's tables and figures again, its rivals beside it, and where its claims hold",
    run,
    add_options,
)
