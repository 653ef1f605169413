# SPDX-License-Identifier: BSD-3-Clause
"""Calls that fail in turn: memory, threads and files are refused to an app, one call a run.

Each run must succeed, or end with exit code 2 and one line on standard error; the file that was
there before holds what it held, or all of the new text, and nothing else lies in the folder.

    python -m failing_calls [--calls 1000] [--every 1] [--jobs 2]

fits, applies and exports a small log, and prints a table (scripts/failures).
"""

import argparse
import collections
import os
import re
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from apps import APPS, OLD_OUTPUT, read_folder, run

LIBRARY = APPS.parent / "tests" / "failing" / "libfailing_calls.so"
APP = "sepcal-pitot"
ROWS = 40
BAD_INPUT = 2
# Libraries that don't take a refusal, and where. Their frames are named in docs/testing.md.
UNAVOIDABLE = {
    "libgfortran.so": "sets itself up before main",
    "libgomp.so": "sets itself up before main",
    "libglog.so": "asks for the user's name before main",
    "Eigen::": "DenseStorage::resize frees what the destructor then frees again",
}
COMMON = ("libfailing_calls.so", "libc.so", "libstdc++.so", "libgcc_s.so", "ld-linux")
# The loader's own exit code, for what it can't load before the app is there.
LOADER = 127


@dataclass(frozen=True)
class Verb:
    """What is run, in a folder with the log and its calibration, and what it leaves."""

    name: str
    command: tuple[str, ...]
    output: str
    folder: Path
    text: bytes
    said: str

    @property
    def expected(self) -> dict[str, bytes | None]:
        """The folder before a run."""
        return {**self.inputs, self.output: OLD_OUTPUT.encode()}

    @property
    def inputs(self) -> dict[str, bytes | None]:
        """What the run reads."""
        return {name: (self.folder / name).read_bytes() for name in ("flight.csv", "base.json")}


@dataclass(frozen=True)
class Ending:
    """How a run with a failing call ended; `fault` is empty where that is as promised."""

    fails: str
    code: int
    err: str
    reached: bool  # a call failed
    fault: str
    log: str

    @property
    def frames(self) -> list[str]:
        """Where it crashed, or else what was refused; innermost first, without the C library."""
        before, crashed, after = self.log.partition("crashed")
        frames = [line.strip() for line in (after if crashed else before).splitlines()[1:]]
        return [frame for frame in frames if not frame.startswith(COMMON)]

    @property
    def culprit(self) -> str:
        """The innermost frame at fault by its name, where a crash or an exit names one."""
        if self.code not in (BAD_INPUT, LOADER) and self.code != 0:
            for frame in self.frames:
                if not (name := name_of(frame)).startswith(("std::", "void std::", "operator")):
                    return name
        return ""

    @property
    def in_library(self) -> bool:
        """Whether it is a library's fault that can't be helped."""
        return self.culprit.startswith(tuple(UNAVOIDABLE))


def name_of(frame: str) -> str:
    """The function of a frame of the app, by its symbols; of another module the frame itself.

    A library of templates is compiled into the app: its functions have its namespace.
    """
    found = re.fullmatch(rf"{APP} (\S+)\+0x(\w+)", frame)
    if not found:
        return frame
    symbol, offset = found.groups()
    if symbol == "?":
        at = hex(int(offset, 16) - 1)
        command = ["addr2line", "-f", "-e", str(APPS / APP), at]
        symbol = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()[
            0
        ]
    shown = subprocess.run(["c++filt", symbol], capture_output=True, text=True, check=True).stdout
    return re.sub(r"^(void|bool|int|auto) ", "", shown.strip())[:120]


@dataclass
class Tally:
    """Of many runs."""

    runs: int = 0
    succeeded: int = 0
    refused: int = 0
    unreached: int = 0
    in_libraries: list[Ending] = field(default_factory=list)
    faults: list[Ending] = field(default_factory=list)

    def count(self, ending: Ending) -> None:
        """Adds a run."""
        self.runs += 1
        self.unreached += not ending.reached
        if ending.fault:
            (self.in_libraries if ending.in_library else self.faults).append(ending)
        elif ending.code == 0:
            self.succeeded += 1
        else:
            self.refused += 1


def prepare(folder: Path) -> list[Verb]:
    """The log, its calibration, and each verb as it runs with nothing failing."""
    rows = str(ROWS)
    made = run(
        APP,
        "simulate",
        "--probe",
        "pitot-static",
        "--rows",
        rows,
        "-o",
        "flight.csv",
        folder=folder,
    )
    assert made.code == 0, made.err
    fitted = run(APP, "fit", "flight.csv", "-o", "base.json", folder=folder)
    assert fitted.code == 0, fitted.err
    commands = {
        "fit": ("fit", "flight.csv"),
        "apply": ("apply", "flight.csv", "base.json"),
        "export": ("export", "base.json", "--to", "c"),
    }
    outputs = {"fit": "again.json", "apply": "corrected.csv", "export": "correction.h"}
    verbs = []
    for name, command in commands.items():
        whole = (*command, "-o", outputs[name])
        done = run(APP, *whole, folder=folder)
        assert done.code == 0, done.err
        assert done.err == "", "a line on standard error is to be the failure's"
        text = (folder / outputs[name]).read_bytes()
        (folder / outputs[name]).unlink()
        verbs.append(Verb(name, whole, outputs[name], folder, text, done.out))
    return verbs


def run_failing(verb: Verb, fails: str) -> Ending:
    """Runs the verb in a folder of its own, over an old output, with one kind of call failing."""
    with tempfile.TemporaryDirectory() as scratch:
        folder, log = Path(scratch, "run"), Path(scratch, "log")
        folder.mkdir()
        for name, content in verb.expected.items():
            (folder / name).write_bytes(content or b"")
        done = subprocess.run(
            [str(APPS / APP), *verb.command],
            cwd=folder,
            env={**os.environ, "LD_PRELOAD": str(LIBRARY), "SEPCAL_FAIL": fails,
                 "SEPCAL_FAIL_LOG": str(log)},
            capture_output=True,
            check=False,
            timeout=120,
        )  # fmt: skip
        told = log.read_text() if log.exists() else ""
        err = done.stderr.decode()
        fault = find_fault(verb, done.returncode, done.stdout.decode(), err, read_folder(folder))
        return Ending(fails, done.returncode, err, "failed" in told, fault, told)


def find_fault(verb: Verb, code: int, out: str, err: str, folder: dict[str, bytes | None]) -> str:
    """What a run did that it must not; empty: nothing."""
    output = folder.pop(verb.output, None)
    if folder != verb.inputs:
        return f"left in the folder: {sorted(folder)}"
    if output not in (OLD_OUTPUT.encode(), verb.text):
        return "the output is neither the old nor the new one"
    if code == 0:
        if output != verb.text:
            return "success without the output"
        return "" if (out, err) == (verb.said, "") else "success, but other words"
    if code < 0:
        return f"crash: signal {-code}"
    if code not in (BAD_INPUT, LOADER):
        return f"exit code {code}"
    return "" if re.fullmatch(r"[^\n]+\n", err) else "not one line on standard error"


def list_stacks(verb: Verb) -> list[str]:
    """Hashes of the distinct call stacks that memory is asked from, in the order of their calls."""
    told = run_failing(verb, "list")
    assert not told.fault, told
    return re.findall(r"^stack (\w+) of call", told.log, re.MULTILINE)


def tally(verb: Verb, failing: Sequence[str], jobs: int) -> Tally:
    """Runs the verb once for each."""
    counted = Tally()
    with ThreadPoolExecutor(jobs) as pool:
        for ending in pool.map(lambda fails: run_failing(verb, fails), failing):
            counted.count(ending)
    return counted


def plans(verb: Verb, calls: int, every: int) -> Iterator[tuple[str, list[str]]]:
    """What fails, by kind."""
    yield "request in turn", [f"allocation:{n}" for n in range(1, calls + 1, every)]
    yield "every request from", [f"allocations:{n}" for n in range(1, calls + 1, every)]
    yield "call stack", [f"stack:{stack}" for stack in list_stacks(verb)[::every]]
    yield "thread from", [f"thread:{n}" for n in (1, 2)]
    yield "file call", [f"file:{n}" for n in range(1, 13)]


def show(faults: list[Ending]) -> None:
    """Each kind of fault once, with where it was."""
    kinds: dict[tuple[str, str], list[str]] = collections.defaultdict(list)
    for one in faults:
        said = one.culprit or one.err[:200]
        kinds[one.fault, said].append(one.fails)
    for (fault, said), failing in sorted(kinds.items(), key=lambda entry: -len(entry[1])):
        print(f"    {len(failing)} x {fault} in {said!r}; first: {failing[0]}", flush=True)


def main() -> int:
    """Prints the table; returns 1 where a run did what it must not."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--calls", type=int, default=1000, help="requests that fail in turn")
    parser.add_argument(
        "--every", type=int, default=1, help="of these and of the stacks each so-manieth"
    )
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--verb", choices=("fit", "apply", "export"), action="append")
    asked = parser.parse_args()
    found = 0
    with tempfile.TemporaryDirectory() as folder:
        for verb in prepare(Path(folder)):
            if asked.verb and verb.name not in asked.verb:
                continue
            for kind, failing in plans(verb, asked.calls, asked.every):
                counted = tally(verb, failing, asked.jobs)
                print(
                    f"{verb.name:6}  {kind:18} {counted.runs:6} runs: {counted.refused} refused in "
                    f"one line, {counted.succeeded} succeeded, {len(counted.in_libraries)} "
                    f"ended in a library, {len(counted.faults)} faults "
                    f"({counted.unreached} never came to the call)",
                    flush=True,
                )
                show(counted.in_libraries + counted.faults)
                found += len(counted.faults)
    return int(found > 0)


if __name__ == "__main__":
    raise SystemExit(main())
