# SPDX-License-Identifier: BSD-3-Clause
"""The apps of this checkout beside those of an older commit, on the same files: CPU of a run."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.race import Competitor, Result, judge, lengths_within, race

ROOT = Path(__file__).parents[2]
NOW = ROOT / "build" / "apps"
FINDS = (0, 3, 4, 5, 6)  # exit codes of a verb that did what it was asked
PROBE = ("--k-alpha", "4.5", "--k-beta", "4.5", "--lever-arm", "0.35,0,-0.02")
FIELD = 53.2016  # uT


@dataclass
class Spent:
    """By a process and all its threads."""

    seconds: float  # user and system
    kilobytes: int  # the most memory that it had


def peak_of(process: int) -> int:
    """The most memory [kB] that a running process has had; 0 where nobody says.

    What wait4() says is no less than what Python has, whose memory a child shares until it runs.
    """
    try:
        told = Path(f"/proc/{process}/status").read_text()
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in told.splitlines() if "VmHWM" in line), 0)


def spend(command: Sequence[str | Path]) -> Spent:
    """Runs to the end; raises where it says that its input is bad."""
    with tempfile.TemporaryFile() as told:
        child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=told)
        peak, ended = 0, 0
        while not ended:
            peak = max(peak, peak_of(child.pid))
            time.sleep(0.01)
            ended, status, usage = os.wait4(child.pid, os.WNOHANG)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode not in FINDS:
            told.seek(0)
            raise RuntimeError(f"{' '.join(map(str, command))}: {told.read().decode().strip()}")
    return Spent(usage.ru_utime + usage.ru_stime, peak or usage.ru_maxrss)


def of_parameters(calibration: dict[str, Any]) -> np.ndarray:
    """Values over their standard errors."""
    entries = calibration["parameters"].values()
    return np.array([one["value"] / one["standard_error"] for one in entries])


def of_effects(diagnosis: dict[str, Any]) -> np.ndarray:
    """Coefficients over their standard errors, effects by name; NaN where one can't be seen."""
    ratios = []
    for effect in sorted(diagnosis["effects"], key=lambda one: str(one["name"])):
        for name, value in effect["estimate"].items():
            error = effect["standard_error"][name]
            ratios.append(float("nan") if value is None else value / error)
    return np.array(ratios)


@dataclass
class Task:
    """A verb on a file; `{out}` in its arguments is the JSON that it writes."""

    title: str
    app: str
    arguments: list[str]
    answer: Callable[[dict[str, Any]], np.ndarray]


def race_task(task: Task, folder: Path, older: dict[str, Path], rounds: int) -> Result:
    """This checkout's app first."""
    peaks: dict[str, list[int]] = {}
    racing = []
    for name, apps in ({"now": NOW} | older).items():

        def run(name: str = name, apps: Path = apps) -> tuple[float, np.ndarray]:
            out = folder / f"{task.app}_{name}.json"
            given = [one.format(out=out) for one in task.arguments]
            spent = spend([str(apps / task.app), *given])
            peaks.setdefault(name, []).append(spent.kilobytes)
            return spent.seconds, task.answer(json.loads(out.read_text()))

        racing.append(Competitor(name, run))
    race(racing, rounds)

    def differ(off: np.ndarray) -> float:
        return float(np.nanmax(np.abs(off)))

    result = judge("baseline", task.title, racing, differ, "standard errors")
    megabytes = {name: statistics.median(sizes) / 1024 for name, sizes in peaks.items()}
    result.facts |= {f"megabytes.{name}": size for name, size in megabytes.items()}
    told = ", ".join(f"{size:.0f} MB ({name})" for name, size in megabytes.items())
    result.notes.append(f"Memory at most: {told}.")
    return result


def tasks(folder: Path, longest: int) -> Iterator[Task]:
    """Their files are simulated by this checkout."""
    pitot, mag = str(NOW / "sepcal-pitot"), str(NOW / "sepcal-mag")
    lengths = lengths_within(longest, (5_000, 100_000))
    for rows in lengths:
        log = str(folder / f"{rows}.csv")
        spend([pitot, "simulate", "-o", log, "--rows", str(rows), "--seed", "1"])
        fit = ["fit", log, *PROBE, "--threads", "1", "-o", "{out}"]
        yield Task(f"sepcal-pitot fit, {rows:,} rows", "sepcal-pitot", fit, of_parameters)
    rows = lengths_within(longest, (37_000,))[0]
    log = str(folder / "turns.csv")
    spend([mag, "simulate", "-o", log, "--rows", str(rows), "--seed", "1"])
    fit = ["fit", log, "--field-strength", str(FIELD), "--threads", "1", "-o", "{out}"]
    title = f"sepcal-mag fit by the field's strength alone, {rows:,} rows"
    yield Task(title, "sepcal-mag", fit, of_parameters)
    rows = lengths[-1]
    log, base = str(folder / "hidden.csv"), str(folder / "base.json")
    hidden = ["--hide", "propwash=40", "--decoys", "4"]
    spend([pitot, "simulate", "-o", log, "--rows", str(rows), *hidden, "--seed", "1"])
    spend([pitot, "fit", log, *PROBE, "-o", base])
    diagnose = ["diagnose", log, base, "-o", "{out}"]
    title = f"sepcal-pitot diagnose, {rows:,} rows, a hundred candidates"
    yield Task(title, "sepcal-pitot", diagnose, of_effects)


def run(folder: Path, rounds: int, longest: int, commit: str) -> Iterator[Result]:
    """`commit`, whose apps scripts/benchmark has built; the shares of reading a file are in all."""
    older = {commit: ROOT / "build" / f"baseline-{commit}" / "apps"}
    for task in tasks(folder, longest):
        yield race_task(task, folder, older, rounds)
