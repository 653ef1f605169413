# SPDX-License-Identifier: BSD-3-Clause
"""The two apps as a user meets them: a command line, a folder, what comes back.

The apps are looked for in $SEPCAL_APPS, by default build/apps in the checkout.
"""

import json
import os
import re
import resource
import subprocess
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from oracle.five_hole_probe import FiveHoleProbe
from oracle.model import Model

APPS = Path(os.environ.get("SEPCAL_APPS", Path(__file__).parents[1] / "build" / "apps")).resolve()
OLD_OUTPUT = "what was there before\n"
FIVE_HOLE_OPTIONS = ("--k-alpha", "4.5", "--k-beta", "4.5", "--lever-arm", "0.35,0,-0.02")
FIVE_HOLE_MODEL = FiveHoleProbe(4.5, 4.5, (0.35, 0.0, -0.02))


@dataclass(frozen=True)
class Outcome:
    """What a command left behind."""

    code: int
    out: str
    err: str

    @property
    def result(self) -> dict[str, Any]:
        """Standard output as JSON; Python's reader is told to take no NaN or Infinity."""
        return parse_json(self.out)


def run(
    app: str,
    *arguments: str | Path,
    folder: Path,
    before: Callable[[], None] | None = None,
    instruction_set: str | None = None,
) -> Outcome:
    """Runs an app in `folder`; `before` is called in the new process first.

    On an instruction set: with SEPCAL_ISA set, else as the tests' own environment has it.
    """
    command = [str(APPS / app), *map(str, arguments)]
    chosen = {} if instruction_set is None else {"SEPCAL_ISA": instruction_set}
    done = subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, **chosen},
        capture_output=True,
        check=False,
        timeout=120,
        preexec_fn=before,
    )
    return Outcome(done.returncode, done.stdout.decode(), done.stderr.decode())


def list_instruction_sets(app: str, *fit: str | Path, folder: Path) -> list[str]:
    """Those of this processor, the widest first, as the refusal of an unknown one lists them."""
    refused = run(app, *fit, folder=folder, instruction_set="abacus")
    assert refused.code == 2
    assert len(refused.err.splitlines()) == 1
    listed = re.search(r"SEPCAL_ISA is abacus; this processor takes (.*)$", refused.err.strip())
    assert listed
    return listed.group(1).split(", ")


def parse_json(text: str) -> dict[str, Any]:
    """JSON by the letter of RFC 8259: no NaN, no Infinity."""

    def refuse(constant: str) -> None:
        raise ValueError(f"{constant} is not JSON")

    return json.loads(text, parse_constant=refuse)


class Log:
    """A CSV file as text, for a test to spoil: headers and cells are what stands in the file."""

    def __init__(self, file: Path) -> None:
        """Reads a file without quoted cells."""
        self.headers, *self.rows = [line.split(",") for line in file.read_text().splitlines()]

    def index(self, header: str) -> int:
        """The column's number."""
        return self.headers.index(header)

    def column(self, header: str) -> NDArray[np.float64]:
        """The column's numbers, shape (rows,)."""
        return np.array([float(row[self.index(header)]) for row in self.rows])

    def replace(
        self, header: str, values: Sequence[str] | ArrayLike, to: str | None = None
    ) -> None:
        """Puts other cells, and maybe another header, in a column's place."""
        at = self.index(header)
        self.headers[at] = to or header
        for row, value in zip(self.rows, values, strict=True):
            row[at] = value if isinstance(value, str) else repr(float(value))

    def add(self, header: str, values: Sequence[str] | ArrayLike) -> None:
        """Adds a column on the right."""
        self.headers.append(header)
        for row in self.rows:
            row.append("")
        self.replace(header, values)

    def drop(self, header: str) -> None:
        """Takes a column out."""
        at = self.index(header)
        for cells in (self.headers, *self.rows):
            del cells[at]

    def put(self, line: int, header: str, cell: str) -> None:
        """Writes one cell; `line` counts as the apps do, the header's is 1."""
        self.rows[line - 2][self.index(header)] = cell

    def text(self, separator: str = ",") -> str:
        """The file's text."""
        return "".join(separator.join(cells) + "\n" for cells in (self.headers, *self.rows))


@dataclass(frozen=True)
class Bench:
    """One app in a folder of its own with a short simulated flight and its calibration there."""

    app: str
    folder: Path  # holds flight.csv and base.json
    options: tuple[str, ...]  # what a fit can't do without
    model: Model  # the same sensor, as the oracle has it

    @property
    def flight(self) -> Path:
        """The log."""
        return self.folder / "flight.csv"

    @property
    def base(self) -> dict[str, Any]:
        """The calibration that lies in the folder."""
        return parse_json((self.folder / "base.json").read_text())

    def read_log(self) -> Log:
        """The log as it stands."""
        return Log(self.flight)

    def run(self, *arguments: str | Path, before: Callable[[], None] | None = None) -> Outcome:
        """Runs the app in the folder."""
        return run(self.app, *arguments, folder=self.folder, before=before)

    def fit(self, *arguments: str | Path, flight: str = "flight.csv") -> Outcome:
        """Runs `fit --json` with the options that it can't do without."""
        return self.run("fit", flight, "--json", *self.options, *arguments)


@contextmanager
def small_files(largest: int) -> Iterator[None]:
    """No file of this process may grow beyond so many bytes; Python ignores the signal."""
    old, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (largest, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (old, hard))


def values_of(result: dict[str, Any]) -> NDArray[np.float64]:
    """The parameters' values in the result's order, shape (n,)."""
    return np.array([entry["value"] for entry in result["parameters"].values()])


def read_folder(folder: Path) -> dict[str, bytes | None]:
    """Every entry, hidden ones too, with its bytes; None for a folder."""
    return {
        entry.name: entry.read_bytes() if entry.is_file() else None for entry in folder.iterdir()
    }


def assert_one_line(bench: Bench, outcome: Outcome, *words: str) -> None:
    """Exit 2, nothing on standard output, one line on standard error with all of `words` in it."""
    assert outcome.code == 2, outcome
    assert outcome.out == ""
    assert outcome.err.startswith(f"{bench.app}: ")
    assert outcome.err.count("\n") == 1, outcome.err
    assert outcome.err.endswith("\n")
    for word in words:
        assert word in outcome.err


def assert_refused(bench: Bench, *command: str | Path, words: tuple[str, ...]) -> None:
    """Refused as above without and with an old output; the folder stays as it was to the byte."""
    for old in (False, True):
        if old:
            (bench.folder / "output").write_text(OLD_OUTPUT)
        before = read_folder(bench.folder)
        assert_one_line(bench, bench.run(*command, "-o", "output"), *words)
        assert read_folder(bench.folder) == before
