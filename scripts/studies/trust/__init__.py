# SPDX-License-Identifier: BSD-3-Clause
"""The study of trust: what is called found on noise that nobody fitted, and what large effects do.

Every trial is a line in a file; a run takes up where the lines end, and files of several machines
may be joined by `cat`.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import defaultdict
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any, TypeAlias

from scipy.stats import beta

from sepcal import Error
from studies.hidden_effects.cases import CASES, PROBES, calibrate, factor_for
from studies.study import Finding, Outcome, Progress, Study, check_folder, seeds
from studies.trust import errors
from studies.trust.flights import FURTHER, NOISES, fly

Key: TypeAlias = tuple[str, str, str, float, int, int]  # part, case, noise, sigmas, rows, seed
Row: TypeAlias = dict[str, Any]

ALARM_ROWS = 400
POWER_NOISES = ("white", "white + GM 60 s")
STEPS = ("bias_step", "water_blockage")


def _options(parser: argparse.ArgumentParser) -> None:
    seeds(100, "null flights of each probe and noise; a tenth as many of each effect and size")(
        parser
    )
    parser.add_argument("--part", choices=("alarms", "power", "errors"), help="one alone")
    parser.add_argument("--sigmas", type=float, nargs="*", default=[10.0, 30.0, 100.0, 300.0])
    parser.add_argument("--noise", nargs="*", default=list(NOISES), help="of the null flights")
    parser.add_argument("--rows", type=int, nargs="*", default=[400, 4000], help="of errors")
    parser.add_argument("-o", "--output", type=Path, default=Path("trust.jsonl"))


def _keys(arguments: argparse.Namespace) -> Iterator[Key]:
    first = arguments.first_seed
    if arguments.part in (None, "alarms"):
        for seed in range(first, first + arguments.seeds):
            for noise in arguments.noise:
                for probe in PROBES:
                    yield "alarms", probe, noise, 0.0, ALARM_ROWS, seed
    if arguments.part in (None, "power"):
        for seed in range(first, first + max(1, arguments.seeds // 10)):
            for sigmas in arguments.sigmas:
                for noise in POWER_NOISES:
                    for case in CASES:
                        label = f"{case.probe}: {case.effect}"
                        yield "power", label, noise, sigmas, case.rows, seed

    if arguments.part in (None, "errors"):
        noises = [*arguments.noise, *(FURTHER if arguments.noise == list(NOISES) else ())]
        for seed in range(first, first + arguments.seeds):
            for rows in arguments.rows:
                for noise in noises:
                    for probe in PROBES:
                        yield "errors", probe, noise, 0.0, rows, seed


def _try(key: Key) -> Row:
    part, label, noise, sigmas, rows, seed = key
    if part == "errors":
        return {"key": key, **errors.measure(label, noise, seed, rows)}
    begun = time.process_time()
    hide = None
    probe = label
    try:
        if part == "power":
            case = next(case for case in CASES if f"{case.probe}: {case.effect}" == label)
            probe = case.probe
            hide = {case.effect: case.sizes(factor_for(case, sigmas))}
        flight, quiet = fly(probe, noise, seed, rows, hide)
    except Error:  # an effect so large that the sensor reads nothing
        return {"key": key, "verdict": "not flown", "visible": False, "seconds": 0.0}
    diagnosis = calibrate(probe, flight).diagnose()
    row: Row = {"key": key, "verdict": diagnosis.verdict, "advice": diagnosis.advice["effect"]}
    if diagnosis.effects:
        row |= {"top": diagnosis.effects[0].name, "p": diagnosis.effects[0].p_adjusted}
    if quiet.effects:
        name = quiet.effects[0]
        own = diagnosis[name]
        row |= {
            "effect": name,
            "first": name in diagnosis.effects[0].family,
            "found": any(name in effect.family for effect in diagnosis.found),
            "visible": own.status != "cannot_be_seen",
        }
    row["seconds"] = time.process_time() - begun
    return row


def _read(file: Path) -> dict[Key, Row]:
    if not file.exists():
        return {}
    rows = [json.loads(line) for line in file.read_text().splitlines()]
    return {tuple(row["key"]): row for row in rows}


def upper_limit(events: int, trials: int) -> float:
    """Of a rate, 99 % one-sided (Clopper & Pearson)."""
    return 1.0 if events == trials else float(beta.ppf(0.99, events + 1, trials - events))


def _alarms(rows: Iterable[Row]) -> list[Finding]:
    by_noise: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        by_noise[row["key"][2]].append(row)
    findings = []
    for noise, flights in by_noise.items():
        found = sum(row["verdict"] == "effect_missing" for row in flights)
        slow = sum(row["verdict"] == "slow_change" for row in flights)
        limit = upper_limit(found, len(flights))
        what = f"{found} of {len(flights)} found (below {100 * limit:.1f} %), {slow} slow_change"
        findings.append(Finding(f"nothing hidden, {noise}", what, "below 10 %", limit < 0.1))
    everything = [row for flights in by_noise.values() for row in flights]
    found = sum(row["verdict"] == "effect_missing" for row in everything)
    limit = upper_limit(found, len(everything)) if everything else 1.0
    what = f"{found} of {len(everything)} found (below {100 * limit:.1f} %)"
    return [*findings, Finding("nothing hidden, all noises", what, "below 3 %", limit < 0.03)]


def _power(rows: Iterable[Row]) -> list[Finding]:
    by_size: dict[tuple[str, float], list[Row]] = defaultdict(list)
    for row in rows:
        by_size[row["key"][2], row["key"][3]].append(row)
    findings = []
    for (noise, sigmas), flights in sorted(by_size.items()):
        seen = [row for row in flights if row["visible"]]
        both = sum(row["first"] and row["found"] for row in seen)
        slow = sum(row["verdict"] == "slow_change" for row in seen)
        missed: dict[str, int] = defaultdict(int)
        for row in seen:
            missed[row["effect"]] += not (row["first"] and row["found"])
        failures = ", ".join(f"{name} ({n})" for name, n in sorted(missed.items()) if n)
        asked = noise == "white" and sigmas >= 30.0
        steps = any(missed[name] for name in STEPS)
        findings.append(
            Finding(
                f"{sigmas:g} sigmas in {noise}",
                f"first and found {both} of {len(seen)}, {slow} slow_change; missed: {failures}",
                "98 %, no step missed" if asked else "reported",
                not asked or (both >= 0.98 * len(seen) and not steps),
            )
        )
    return findings


def _run(arguments: argparse.Namespace, report_progress: Progress) -> Outcome:
    output: Path = arguments.output
    check_folder(output)
    done = _read(output)
    keys = list(_keys(arguments))
    left = [key for key in keys if key not in done]
    with output.open("a") as lines, ProcessPoolExecutor(arguments.processes) as pool:
        running = [pool.submit(_try, key) for key in left]
        for count, future in enumerate(as_completed(running), 1):
            row = future.result()
            done[tuple(row["key"])] = row
            lines.write(json.dumps(row) + "\n")
            lines.flush()
            report_progress((len(keys) - len(left) + count) / len(keys))
    rows = [done[key] for key in keys]
    hours = sum(row["seconds"] for row in rows) / 3600.0
    findings: list[Finding] = []
    alarms = [row for row in rows if row["key"][0] == "alarms"]
    power = [row for row in rows if row["key"][0] == "power"]
    findings += _alarms(alarms) if alarms else []
    findings += _power(power) if power else []
    errors_made = [row for row in rows if row["key"][0] == "errors"]
    findings += errors.judge(errors_made) if errors_made else []
    return Outcome(f"{len(rows)} flights, {hours:.2f} core-hours", findings)


STUDY = Study(
    "trust",
    "what is called found on noise as instruments have it, and whether large effects are",
    _run,
    _options,
)
