# SPDX-License-Identifier: BSD-3-Clause
"""Standard errors: how often estimate -+ 1.96 of them holds the truth, way by way.

And whether the estimates of a flight's two halves differ by as much as their errors say.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np

from sepcal import Error
from sepcal.calibration import Calibration
from sepcal.flight import Flight
from studies.hidden_effects.cases import PROBES, calibrate
from studies.study import Finding, seed_range
from studies.trust.flights import FURTHER, HEADERS, NOISES, SAMPLES_ALONE, fly
from studies.trust.part import Key, Part, Row, chosen_noises

WAYS = (
    "standard_error",
    "standard_error_noise_model",
    "standard_error_blocks",
    "standard_error_white",
)
REACH = 1.96
LENGTHS = (400, 4000)
LOWER_BOUND = "lower bound"  # what the status says of a record that is too short for its noise
CUT_STRAIGHT = "no standard error tells"  # what a note says of interpolated columns


def _keys(arguments: argparse.Namespace) -> Iterator[Key]:
    noises = chosen_noises(arguments, [*NOISES, *FURTHER])
    for seed in seed_range(arguments):
        for rows in arguments.rows or LENGTHS:
            for noise in noises:
                for probe in PROBES:
                    yield "errors", probe, noise, 0.0, rows, seed


def measure(probe: str, noise: str, seed: int, rows: int) -> Row:
    """By parameter: the estimate's error and what each way says of it, for whole and halves."""
    flight, quiet = fly(probe, noise, seed, rows)
    slow = HEADERS[probe] if noise == SAMPLES_ALONE else ()
    whole = calibrate(probe, flight, drop_repeats=slow)
    row: Row = {
        "status": whole.status,
        "told": LOWER_BOUND in whole.message or any(CUT_STRAIGHT in note for note in whole.notes),
        "errors": {},
        "halves": {},
    }
    halves = _halves(probe, flight, slow)
    for name in whole.names:
        parameter = whole[name]
        if parameter.fixed or name not in quiet.truth:
            continue
        stated = [_number(getattr(parameter, way)) for way in WAYS]
        row["errors"][name] = [parameter.value - quiet.truth[name], *stated]
        if halves:
            one, two = (half[name] for half in halves)
            row["halves"][name] = [
                one.value - two.value,
                *(_number(np.hypot(getattr(one, way), getattr(two, way))) for way in WAYS),
            ]
    return row


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _halves(
    probe: str, flight: Flight, slow: Sequence[str]
) -> tuple[Calibration, Calibration] | None:
    """Fits of the first and of the second half, where both determine the model."""
    stamps = flight["time_s"]
    middle = float(stamps[stamps.size // 2])
    spans = (f"{stamps[0]:.6f}:{middle - 1e-6:.6f}", f"{middle:.6f}:{stamps[-1]:.6f}")
    try:
        one, two = (calibrate(probe, flight, segments=s, drop_repeats=slow) for s in spans)
    except Error:
        return None
    return (one, two) if one.status == two.status == "converged" else None


def split_half(rows: Sequence[Row], way: int) -> float:
    """Variance of the halves' differences over their errors, by a quantile: 1 where right."""
    ratios = [
        values[0] / values[1 + way]
        for row in rows
        for values in row["halves"].values()
        if values[1 + way]
    ]
    if not ratios:
        return float("nan")
    return float(np.quantile(np.square(ratios), 0.6827))


def coverage(rows: Sequence[Row], way: int, names: Sequence[str]) -> tuple[int, int, float]:
    """Intervals that hold the truth, intervals, and the median error stated over the true one."""
    pairs = [
        (abs(row["errors"][name][0]), row["errors"][name][1 + way])
        for row in rows
        for name in names
        if name in row["errors"] and row["errors"][name][1 + way] is not None
    ]
    held = sum(error <= REACH * stated for error, stated in pairs)
    ratios = []
    for name in names:
        of = [row["errors"][name] for row in rows if name in row["errors"]]
        stated = [values[1 + way] for values in of if values[1 + way] is not None]
        if stated:
            true = float(np.sqrt(np.mean([values[0] ** 2 for values in of])))
            ratios.append(float(np.median(stated)) / true)
    return held, len(pairs), float(np.median(ratios)) if ratios else float("nan")


def _summarise(rows: Sequence[Row]) -> list[Finding]:
    """A line for each noise, length and way."""
    groups: dict[tuple[int, str], list[Row]] = defaultdict(list)
    for row in rows:
        groups[row["key"][4], row["key"][2]].append(row)
    findings = []
    for (length, noise), flights in groups.items():
        warned = sum(row["told"] for row in flights)
        told = 2 * warned > len(flights)
        for at, way in enumerate(WAYS):
            parts = []
            shares = []
            for kind in ("linear", "nonlinear"):
                held = of = 0
                sizes = []
                for probe, model in PROBES.items():
                    of_probe = [row for row in flights if row["key"][1] == probe]
                    names = list(getattr(model, kind))
                    one = coverage(of_probe, at, names)
                    held, of = held + one[0], of + one[1]
                    sizes.append(one[2])
                share = held / of if of else float("nan")
                shares.append(share)
                parts.append(f"{kind} {100 * share:.1f} % of {of} (size {np.nanmedian(sizes):.2f})")
            halves = split_half(flights, at)
            figure = f"{', '.join(parts)}, split halves {halves:.2f}"
            if at == 0:
                figure += f", said to be too small in {warned} of {len(flights)}"
            asked = at == 0 and not told
            chance = 2.0 * np.sqrt(0.05 * 0.95 / len(flights))  # a flight's intervals go together
            holds = not asked or (
                all(0.92 - chance <= share <= 0.97 + chance for share in shares)
                and 0.7 - 2.0 * chance <= halves <= 1.4 + 4.0 * chance
            )
            limits = f"92 to 97 % and {100 * chance:.0f} by chance, halves 0.7 to 1.4"
            limits = limits if asked else "reported"
            findings.append(Finding(f"{noise}, {length} rows, {way}", figure, limits, holds))
    return findings


ERRORS = Part(_keys, lambda key: measure(key[1], key[2], key[5], key[4]), _summarise)
