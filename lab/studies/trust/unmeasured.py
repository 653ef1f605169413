# SPDX-License-Identifier: BSD-3-Clause
"""Causes that follow no channel of the log: are they called so, and is noise not?"""

from __future__ import annotations

import argparse
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from sepcal.diagnosis import Diagnosis
from sepcal.flight import Flight
from studies.hidden_effects.cases import NOISE, PROBES, calibrate
from studies.study import Finding, seed_range
from studies.trust.flights import HEADERS, NOISES, fly
from studies.trust.noises import Array
from studies.trust.part import Key, Part, Row, chosen_noises, upper_limit

ROWS = 400
NOTHING, BURST, LINE = "nothing", "burst in two outputs", "line in one output"
SIGMAS = {NOTHING: 0.0, BURST: 20.0, LINE: 10.0}  # of the whole record, all outputs together
ASKED = {BURST: 0.8, LINE: 2.0 / 3.0}  # how often it is to be called so in white noise
OUTPUTS = {BURST: 2, LINE: 1}
LOUD = ("white", "AR(0.9)", "pink", "white + GM 60 s")  # in which causes are hidden
LINE_HZ = 0.35
Hidden = dict[str, Any]


def _burst(rng: np.random.Generator, time: Array) -> tuple[Array, Hidden]:
    """A swing of 0.1 to 0.8 Hz for a tenth to a quarter of the record."""
    frequency = rng.uniform(0.1, 0.8)
    length = rng.uniform(0.1, 0.25) * float(np.ptp(time))
    first = rng.uniform(time[0], time[-1] - length)
    wave = np.sin(2.0 * np.pi * (frequency * time + rng.uniform()))
    wave[(time < first) | (time > first + length)] = 0.0
    return wave, {"hz": frequency, "first_s": first, "last_s": first + length}


def _line(rng: np.random.Generator, time: Array) -> tuple[Array, Hidden]:
    wave = np.sin(2.0 * np.pi * (LINE_HZ * time + rng.uniform()))
    return wave, {"hz": LINE_HZ, "first_s": float(time[0]), "last_s": float(time[-1])}


def fly_with(
    cause: str, probe: str, noise: str, seed: int, rows: int = ROWS, sigmas: float | None = None
) -> tuple[Flight, Hidden]:
    """A flight in whose outputs something swings that no channel follows, and what that is."""
    flight, _ = fly(probe, noise, seed, rows)
    if cause == NOTHING:
        return flight, {}
    rng = np.random.default_rng([seed, rows, OUTPUTS[cause]])
    columns: dict[str, Array] = {name: np.array(flight[name]) for name in flight}
    wave, hidden = (_burst if cause == BURST else _line)(rng, columns["time_s"])
    size = SIGMAS[cause] if sigmas is None else sigmas
    wave *= NOISE[probe] * size / np.linalg.norm(wave) / np.sqrt(OUTPUTS[cause])
    shown = rng.permutation(HEADERS[probe])[: OUTPUTS[cause]]
    for header in shown:
        columns[header] += float(rng.choice([-1.0, 1.0])) * wave
    hidden["outputs"] = sorted(header.rpartition("_")[0].removesuffix("_") for header in shown)
    return Flight(columns, maneuver=list(flight.maneuvers) if flight.maneuvers else None), hidden


def _keys(arguments: argparse.Namespace) -> Iterator[Key]:
    for seed in seed_range(arguments):
        for rows in arguments.rows or (ROWS,):
            for probe in PROBES:
                for noise in chosen_noises(arguments, NOISES):
                    yield "unmeasured", f"{NOTHING}: {probe}", noise, 0.0, rows, seed
                for cause, outputs in OUTPUTS.items():
                    if len(HEADERS[probe]) < outputs:
                        continue
                    for noise in chosen_noises(arguments, LOUD):
                        yield "unmeasured", f"{cause}: {probe}", noise, SIGMAS[cause], rows, seed


def names(diagnosis: Diagnosis, hidden: Hidden) -> bool:
    """Whether a cause that is told has an output, the frequency and a time of the hidden one."""
    return any(
        set(cause.outputs) & set(hidden["outputs"])
        and abs(cause.frequency_hz - hidden["hz"]) < 0.05
        and cause.first_s < hidden["last_s"]
        and cause.last_s > hidden["first_s"]
        for cause in diagnosis.unmeasured
    )


def _try(key: Key) -> Row:
    _, label, noise, _, rows, seed = key
    cause, _, probe = label.partition(": ")
    flight, hidden = fly_with(cause, probe, noise, seed, rows)
    diagnosis = calibrate(probe, flight).diagnose()
    return {
        "verdict": diagnosis.verdict,
        "kinds": [told.kind for told in diagnosis.unmeasured],
        "named": bool(hidden) and names(diagnosis, hidden),
    }


def _alarms(rows: Sequence[Row]) -> list[Finding]:
    told = [row for row in rows if row["kinds"]]
    unexplained = sum(row["verdict"] == "unexplained" for row in rows)
    by_noise = Counter(row["key"][2] for row in told)
    where = ", ".join(f"{noise} ({count})" for noise, count in by_noise.items())
    limit = upper_limit(len(told), len(rows))
    figure = f"{len(told)} of {len(rows)} (below {100 * limit:.1f} %): {where or 'none'}"
    return [
        Finding(
            "an unmeasured cause told of nothing", figure, "2 %", len(told) <= 0.02 * len(rows)
        ),
        Finding("unexplained where nothing is", f"{unexplained} of {len(rows)}", "reported", True),
    ]


def _power(cause: str, noise: str, rows: Sequence[Row]) -> Finding:
    told = sum(bool(row["kinds"]) for row in rows)
    named = sum(row["named"] for row in rows)
    asked = ASKED[cause] if noise == "white" else 0.0
    return Finding(
        f"{cause}, {SIGMAS[cause]:g} sigmas in {noise}",
        f"told in {told} of {len(rows)}, with its frequency and time in {named}",
        f"{100 * asked:.0f} %" if asked else "reported",
        told >= asked * len(rows),
    )


def _summarise(rows: Sequence[Row]) -> list[Finding]:
    by_cause: dict[tuple[str, str], list[Row]] = defaultdict(list)
    for row in rows:
        cause = row["key"][1].partition(": ")[0]
        by_cause[cause, "" if cause == NOTHING else row["key"][2]].append(row)
    nothing = by_cause.pop((NOTHING, ""), [])
    powers = [_power(cause, noise, flights) for (cause, noise), flights in by_cause.items()]
    return [*(_alarms(nothing) if nothing else []), *powers]


UNLOGGED = Part(_keys, _try, _summarise)
