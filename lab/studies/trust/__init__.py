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
from studies.trust import both_errors
from studies.trust.by_key import HIDDEN, NOTHING, SCREENS, SIMPLE, TWO, WANDER, write_log
from studies.trust.errors import ERRORS
from studies.trust.flights import FURTHER, NOISES
from studies.trust.minima import HARD_PROBLEMS, MINIMA
from studies.trust.nothing_hidden import NOTHING_HIDDEN
from studies.trust.pairs import PAIR_SETS
from studies.trust.part import Key, Part, Row
from studies.trust.positions import POSITIONS
from studies.trust.power import POWER
from studies.trust.rates import RATES
from studies.trust.screens import REFITS
from studies.trust.simplest import SIMPLEST, TWO_CAUSES
from studies.trust.simulator.disturbances import DISTURBANCES
from studies.trust.something_hidden import SHARES_HIDDEN, WANDERS_HIDDEN
from studies.trust.unmeasured import UNLOGGED
from studies.trust.verdicts import ALARMS, DECOY_CHANNELS

PARTS: dict[str, Part] = {
    NOTHING: NOTHING_HIDDEN,
    HIDDEN: SHARES_HIDDEN,
    WANDER: WANDERS_HIDDEN,
    SCREENS: REFITS,
    SIMPLE: SIMPLEST,
    TWO: TWO_CAUSES,
    "alarms": ALARMS,
    "decoys": DECOY_CHANNELS,
    "power": POWER,
    "pairs": PAIR_SETS,
    "unmeasured": UNLOGGED,
    "errors": ERRORS,
    "positions": POSITIONS,
    "rates": RATES,
    "minima": MINIMA,
    "hard": HARD_PROBLEMS,
}


def _options(parser: argparse.ArgumentParser) -> None:
    seeds(10, "of the other parts: flights of each kind, probe and noise, or effect and size")(
        parser
    )
    parser.add_argument("--part", choices=tuple(PARTS), nargs="*", default=list(PARTS))
    parser.add_argument("--sigmas", type=float, nargs="*", default=[5.0, 10.0, 30.0, 100.0, 300.0])
    parser.add_argument(
        "--noise",
        nargs="*",
        choices=tuple(dict.fromkeys([*DISTURBANCES, *NOISES, *FURTHER])),
        metavar="NOISE",
        help="the rows of the table and the noises of the null flights [all]",
    )
    parser.add_argument(
        "--flights",
        type=int,
        default=600,
        help=f"of {', '.join(both_errors.PARTS)}: so many each noise and size; a sixth of them "
        f"each noise of {SIMPLE} and {TWO} (default: 600)",
    )
    parser.add_argument(
        "--refitted",
        type=int,
        default=50,
        help="of screens: flights each noise, with every candidate added (default: 50)",
    )
    parser.add_argument(
        "--rows",
        type=int,
        nargs="*",
        help="of null flights (400), and of those for errors (400, 4000)",
    )
    parser.add_argument(
        "--logs",
        metavar="FOLDER",
        type=Path,
        help="write the flights of the table that fail there, as the programs read them",
    )
    parser.add_argument("-o", "--output", type=Path, default=Path("trust.jsonl"))


def _try(key: Key) -> Row:
    begun = time.process_time()
    row = PARTS[key[0]].try_key(key)
    return {"key": key, **row, "seconds": time.process_time() - begun}


def _read(file: Path) -> dict[Key, Row]:
    if not file.exists():
        return {}
    text = file.read_text()
    whole = text[: text.rfind("\n") + 1]
    if whole != text:  # a run was stopped in the middle of a line
        file.write_text(whole)
    rows = [json.loads(line) for line in whole.splitlines()]
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
        if not own:  # of a noise that it doesn't have
            continue
        findings += PARTS[part].summarise([done[key] for key in own])
    simulated = [done[key] for key in every if "nothing_missing" in done[key]]
    figures = f"{len(every)} flights, {hours:.2f} core-hours"
    if not simulated:
        return Outcome(figures, findings)
    tabled = [row for row in simulated if row["key"][0] in both_errors.PARTS]
    page = both_errors.tabulate(tabled) if tabled else ""
    if arguments.logs is not None:
        arguments.logs.mkdir(parents=True, exist_ok=True)
        for row in filter(both_errors.failure_of, tabled):
            write_log(tuple(row["key"]), arguments.logs)
    return Outcome(figures, [*findings, both_errors.judge_words(simulated)], page)


STUDY = Study(
    "trust",
    "both errors of the verdict, on flights of another simulator in noise as instruments have it: "
    "what is called found of nothing, and what is missed; and whether large effects are found, "
    "fits end in the lowest minimum and standard errors hold",
    _run,
    _options,
)
