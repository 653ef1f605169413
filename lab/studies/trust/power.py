# SPDX-License-Identifier: BSD-3-Clause
"""Whether effects are found and come first, and what comes of adding what is advised.

First is the true effect, or one that explains as much when it is added in its place.
"""

from __future__ import annotations

import argparse
import math
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from functools import cache

import numpy as np

from sepcal import Calibration, Error
from sepcal.diagnosis import Diagnosis
from sepcal.flight import Flight
from sepcal.simulation import SimulatedFlight, simulate
from studies.hidden_effects.cases import CASES, OUTPUTS, Case, calibrate, factor_for
from studies.study import Finding, seed_range
from studies.trust.flights import fly
from studies.trust.part import Key, Part, Row

NOISES = ("white", "white + GM 60 s")
STEPS = ("bias_step", "water_blockage")
ADD_TO_READINGS = ("bias", "warm_up", "bias_step")  # of a magnetometer
QUIET = dict.fromkeys(OUTPUTS["magnetometer"], 1e-9)
AS_LIKELY = 9.2  # in -2 ln L
LARGE = 30.0  # sigmas
MOST_ADDED = 3  # of what would do as well


def _label(case: Case) -> str:
    return f"{case.probe}: {case.effect}"


BY_LABEL = {_label(case): case for case in CASES}
size_for = cache(factor_for)


def _keys(arguments: argparse.Namespace) -> Iterator[Key]:
    for seed in seed_range(arguments):
        for sigmas in arguments.sigmas:
            for noise in NOISES:
                for case in CASES:
                    yield "power", _label(case), noise, sigmas, case.rows, seed


def _try(key: Key) -> Row:
    _, label, noise, sigmas, rows, seed = key
    case = BY_LABEL[label]
    try:
        hide = {case.effect: case.sizes(size_for(case, sigmas))}
        flight, quiet = fly(case.probe, noise, seed, rows, hide)
    except Error:  # so large that the sensor reads nothing
        return {"verdict": "not flown", "visible": False}
    base = calibrate(case.probe, flight)
    diagnosis = base.diagnose()
    name = quiet.effects[0]
    stands_first = name in diagnosis.explanations
    row: Row = {
        "verdict": diagnosis.verdict,
        "top": diagnosis.effects[0].name,
        "p": diagnosis.effects[0].p_adjusted,
        "effect": name,
        "first": stands_first,
        "found": stands_first or name in [effect.name for effect in diagnosis.found],
        "visible": diagnosis[name].status != "cannot_be_seen"
        and not _is_beyond(base, name, hide[case.effect]),
        "advice": diagnosis.advice.effect,
        "withheld": diagnosis.advice.withheld,
    }
    if row["advice"]:
        row["harm"] = _harm(base, base.add(row["advice"]), _truths(flight, quiet, seed))
    if noise == "white" and diagnosis.found:
        row["differences"] = _differences(base, diagnosis)
    return row


def _is_beyond(base: Calibration, name: str, sizes: Sequence[float]) -> bool:
    """Whether the size lies beyond the bounds that the catalogue gives the effect."""
    try:
        better = base.add(name)
    except Error:
        return False
    added = [better[parameter] for parameter in better.names if parameter.startswith(name)]
    return any(
        not parameter.lower <= size <= parameter.upper
        for parameter, size in zip(added, sizes, strict=False)
    )


def _truths(flight: Flight, quiet: SimulatedFlight, seed: int) -> dict[str, list[float]]:
    """What each parameter of the probe may be: a hard iron with or without the effect's mean.

    Which of the two it is depends on where the added effect is zero. What a drift comes to on
    average is a hard iron of the flight: nothing in it tells the two apart. The wind is the
    flight's.
    """
    truths = {name: [value] for name, value in quiet.truth.items() if not name.startswith("w_")}
    for name in [name for name in truths if name.startswith("n_")]:
        header = f"m{name[-1]}_ut"
        drift = float(np.mean(flight[header] - quiet[header]))
        truths[name] = [truths[name][0] + drift]
    if quiet.effects[0].split("[")[0] in ADD_TO_READINGS:
        without = simulate("magnetometer", rows=flight.rows, seed=seed, noise=QUIET)
        for axis in "xyz":
            header = f"m{axis}_ut"
            mean = float(np.mean(np.subtract(quiet[header], without[header])))
            truths[f"n_{axis}"].append(truths[f"n_{axis}"][0] + mean)
    return truths


def _harm(base: Calibration, better: Calibration, truths: dict[str, list[float]]) -> float:
    """How much further from the truth the worst parameter is, in standard errors of after.

    Before and after are held against one truth, whichever of them speaks for what was added.
    """

    def move(name: str) -> float:
        further = min(
            abs(better[name].value - truth) - abs(base[name].value - truth)
            for truth in truths[name]
        )
        return further / better[name].standard_error

    moves = [
        move(name)
        for name, before in base.parameters.items()
        if name in truths and not before.fixed and better[name].standard_error > 0.0
    ]
    return max((move for move in moves if math.isfinite(move)), default=0.0)


def _likelihood(calibration: Calibration) -> float:
    """-2 ln L in white noise, but for a constant."""
    return sum(2.0 * calibration.rows * math.log(rmse) for rmse in calibration.rmse.values())


def _differences(base: Calibration, diagnosis: Diagnosis) -> list[float]:
    """-2 ln L of what is said to do as well instead, less the first's."""
    names = [name for name in diagnosis.explanations[1:] if not diagnosis[name].shapes]
    if not names or diagnosis.effects[0].shapes:
        return []
    first = base.add(diagnosis.effects[0].name)
    others = [base.add(name) for name in names[:MOST_ADDED]]
    return [  # of the same rows: a delay takes the ends off
        _likelihood(other) - _likelihood(first) for other in others if other.rows == first.rows
    ]


def _sizes(rows: Sequence[Row]) -> list[Finding]:
    by_size: dict[tuple[str, float], list[Row]] = defaultdict(list)
    for row in rows:
        by_size[row["key"][2], row["key"][3]].append(row)
    findings = []
    for (noise, sigmas), flights in sorted(by_size.items()):
        seen = [row for row in flights if row["visible"]]
        both = sum(row["first"] and row["found"] for row in seen)
        slow = sum(row["verdict"] == "slow_change" for row in seen)
        missed = Counter(row["effect"] for row in seen if not (row["first"] and row["found"]))
        failures = ", ".join(f"{name} ({n})" for name, n in sorted(missed.items()))
        figure = f"first and found {both} of {len(seen)}, {slow} slow_change; missed: {failures}"
        findings.append(Finding(f"{sigmas:g} sigmas in {noise}", figure, "reported", True))
    large = [
        row
        for (noise, sigmas), flights in by_size.items()
        if noise == "white" and sigmas >= LARGE
        for row in flights
        if row["visible"]
    ]
    if not large:
        return findings
    missed = Counter(row["effect"] for row in large if not (row["first"] and row["found"]))
    both = len(large) - missed.total()
    steps = sum(missed[name] for name in STEPS)
    figure = f"{both} of {len(large)} first and found, {steps} steps missed"
    holds = both >= 0.98 * len(large) and steps == 0
    asked = "98 %, no step"
    return [*findings, Finding(f"{LARGE:g} sigmas and more in white", figure, asked, holds)]


def _advice(rows: Sequence[Row]) -> list[Finding]:
    given = [row for row in rows if row.get("advice")]
    harmed = [row for row in given if row["harm"] > 2.0]
    by_truth = [row for row in harmed if row["advice"] == row["effect"]]
    by_another = [row for row in harmed if row["advice"] != row["effect"]]

    def named(rows: Sequence[Row]) -> str:
        counts = Counter(f"{row['effect']} ({row['key'][2]})" for row in rows)
        return f"{len(rows)} of {len(given)}: " + ", ".join(
            f"{name} x {n}" for name, n in sorted(counts.items())
        )

    firsts = [row for row in rows if row.get("first")]
    wrongly = sum(not row["advice"] and bool(row["withheld"]) for row in firsts)
    said = "advice withheld though the true effect came first"
    return [
        Finding(
            "advice of another effect that moves a parameter from the truth by over two errors",
            named(by_another),
            "5 %: an estimate is that far off by chance",
            len(by_another) <= 0.05 * len(given),
        ),
        Finding(
            "advice of the true effect that does: its errors are too small",
            named(by_truth),
            "reported",
            True,
        ),
        Finding(said, f"{wrongly} of {len(firsts)}", "reported", True),
    ]


def _instead(rows: Sequence[Row]) -> list[Finding]:
    differences = [d for row in rows for d in row.get("differences", ())]
    if not differences:
        return []
    right = sum(abs(d) < AS_LIKELY for d in differences)
    figure = f"{right} of {len(differences)}"
    holds = right >= 0.95 * len(differences)
    return [Finding("said to do as well, and does when it is added", figure, "95 %", holds)]


def _summarise(rows: Sequence[Row]) -> list[Finding]:
    return [*_sizes(rows), *_advice(rows), *_instead(rows)]


POWER = Part(_keys, _try, _summarise)
