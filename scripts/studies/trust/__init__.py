# SPDX-License-Identifier: BSD-3-Clause
"""The study of trust: verdicts, minima and standard errors under noise that nobody fitted.

Every trial is a line in a file; a run takes up where the lines end, and files of several machines
may be joined by `cat`.
"""

from __future__ import annotations

import argparse
import json
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from studies.study import Finding, Outcome, Progress, Study, check_folder, seeds
from studies.trust.errors import ERRORS
from studies.trust.flights import NOISES
from studies.trust.minima import HARD_PROBLEMS, MINIMA
from studies.trust.pairs import PAIR_SETS
from studies.trust.part import Key, Part, Row
from studies.trust.positions import POSITIONS
from studies.trust.power import POWER
from studies.trust.unlogged import UNLOGGED
from studies.trust.verdicts import ALARMS, DECOY_CHANNELS

PARTS: dict[str, Part] = {
    "alarms": ALARMS,
    "decoys": DECOY_CHANNELS,
    "power": POWER,
    "pairs": PAIR_SETS,
    "unlogged": UNLOGGED,
    "errors": ERRORS,
    "positions": POSITIONS,
    "minima": MINIMA,
    "hard": HARD_PROBLEMS,
}


def _options(parser: argparse.ArgumentParser) -> None:
    seeds(10, "flights of each kind, of each probe and noise or of each effect and size")(parser)
    parser.add_argument("--part", choices=tuple(PARTS), nargs="*", default=list(PARTS))
    parser.add_argument("--sigmas", type=float, nargs="*", default=[5.0, 10.0, 30.0, 100.0, 300.0])
    parser.add_argument("--noise", nargs="*", default=list(NOISES), help="of the null flights")
    parser.add_argument(
        "--rows",
        type=int,
        nargs="*",
        help="of null flights (400), and of those for errors (400, 4000)",
    )
    parser.add_argument("-o", "--output", type=Path, default=Path("trust.jsonl"))


def _try(key: Key) -> Row:
    begun = time.process_time()
    row = PARTS[key[0]].try_key(key)
    return {"key": key, **row, "seconds": time.process_time() - begun}


def _read(file: Path) -> dict[Key, Row]:
    if not file.exists():
        return {}
    rows = [json.loads(line) for line in file.read_text().splitlines()]
    return {tuple(row["key"]): row for row in rows}


def _run(arguments: argparse.Namespace, report_progress: Progress) -> Outcome:
    output: Path = arguments.output
    check_folder(output)
    done = _read(output)
    keys = {part: list(PARTS[part].keys(arguments)) for part in arguments.part}
    every = [key for part in keys.values() for key in part]
    left = [key for key in every if key not in done]
    with output.open("a") as lines, ProcessPoolExecutor(arguments.processes) as pool:
        running = [pool.submit(_try, key) for key in left]
        for count, future in enumerate(as_completed(running), 1):
            row = future.result()
            done[tuple(row["key"])] = row
            lines.write(json.dumps(row) + "\n")
            lines.flush()
            report_progress((len(every) - len(left) + count) / len(every))
    hours = sum(done[key]["seconds"] for key in every) / 3600.0
    findings: list[Finding] = []
    for part, own in keys.items():
        findings += PARTS[part].summarise([done[key] for key in own])
    return Outcome(f"{len(every)} flights, {hours:.2f} core-hours", findings)


STUDY = Study(
    "trust",
    "what is called found on noise as instruments have it, whether large effects are, whether fits "
    "end in the lowest minimum and whether standard errors hold",
    _run,
    _options,
)
