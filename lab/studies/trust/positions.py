# SPDX-License-Identifier: BSD-3-Clause
"""Velocity from logged positions: how often the wind's 95 % intervals hold it.

A Pitot-static tube's flight is flown, its path integrated on the ellipsoid, and what a GNSS
receiver would have said of it put into the log in the velocity's place.
"""

from __future__ import annotations

import argparse
import itertools
from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np

import sepcal
from studies.hidden_effects.cases import NOISE
from studies.study import Finding, seed_range
from studies.trust.noises import Array
from studies.trust.part import Key, Part, Row
from studies.trust.simulator.ground_track import fly_path

RATE = 10  # rows a second
FIXES = (1, 5, 10)  # a second
SIZES = (1.5, 0.05)  # m
WHITE, SLOW = "white", "Gauss-Markov"
TIME_CONSTANT = 30.0  # s, of slow errors; a tenth of their variance is white
WIND = ("w_n", "w_e")
REACH = 1.96


def _case(fixes: int, size: float, kind: str) -> str:
    return f"{fixes} Hz, {size:g} m, {kind}"


CASES = {_case(*one): one for one in itertools.product(FIXES, SIZES, (WHITE, SLOW))}


def _keys(arguments: argparse.Namespace) -> Iterator[Key]:
    for seed in seed_range(arguments):
        for case in CASES:
            yield "positions", case, "white", 0.0, 0, seed


def draw_errors(rng: np.random.Generator, kind: str, count: int, interval: float) -> Array:
    """Of unit size, shape (count,)."""
    white = rng.standard_normal(count)
    if kind == WHITE:
        return white
    phi = np.exp(-interval / TIME_CONSTANT)
    slow = np.empty(count)
    slow[0] = rng.standard_normal()
    for i in range(1, count):
        slow[i] = phi * slow[i - 1] + np.sqrt(1.0 - phi * phi) * rng.standard_normal()
    return np.asarray(np.sqrt(0.9) * slow + np.sqrt(0.1) * white)


def log_positions(
    fixes: int, size: float, kind: str, seed: int
) -> tuple[sepcal.Flight, dict[str, float]]:
    """The log, and the true wind."""
    rng = np.random.default_rng([seed, *(list(CASES).index(_case(fixes, size, kind)),)])
    quiet = sepcal.simulate("pitot-static", noise={"airspeed": 1e-9}, rate=RATE, seed=seed)
    columns = {name: np.array(quiet[name]) for name in quiet}
    time = columns["time_s"]
    columns["airspeed_mps"] += NOISE["pitot-static"] * rng.standard_normal(time.size)
    velocity = [columns.pop(f"v{axis}_mps") for axis in "ned"]
    path = fly_path(velocity, time, (np.radians(47.3), np.radians(11.4), 900.0))
    every = RATE // fixes
    count = -(-time.size // every)
    metres = 6.37e6
    for row, scale in zip(path, (metres, metres * np.cos(path[0]), 1.0), strict=True):
        errors = size * draw_errors(rng, kind, count, every / RATE)
        row += np.repeat(errors, every)[: time.size] / scale
    held = np.arange(time.size) // every * every
    columns["lat_deg"] = np.round(np.degrees(path[0][held]), 9)
    columns["lon_deg"] = np.round(np.degrees(path[1][held]), 9)
    columns["altitude_m"] = path[2][held]
    return sepcal.Flight(columns, maneuver=quiet.maneuvers), dict(quiet.truth)


def measure(case: str, seed: int) -> Row:
    """The wind's errors, and what is said of them."""
    flight, truth = log_positions(*CASES[case], seed)
    calibration = sepcal.fit(sepcal.PitotStatic(), flight)
    return {
        "status": calibration.status,
        "errors": {
            name: [calibration[name].value - truth[name], calibration[name].standard_error]
            for name in WIND
        },
    }


def _summarise(rows: Sequence[Row]) -> list[Finding]:
    """A line for each case."""
    groups: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        groups[row["key"][1]].append(row)
    findings = []
    for case, flights in groups.items():
        pairs = [row["errors"][name] for row in flights for name in WIND]
        share = float(np.mean([abs(error) <= REACH * stated for error, stated in pairs]))
        size = float(np.sqrt(np.mean([error**2 for error, _ in pairs])))
        stated = float(np.median([one for _, one in pairs]))
        chance = 2.0 * np.sqrt(0.05 * 0.95 / len(pairs))
        figure = (
            f"{100 * share:.1f} % of {len(pairs)}, rms error {size:.3g}, stated {stated:.3g} m/s"
        )
        limits = f"92 to 97 % and {100 * chance:.0f} by chance"
        holds = 0.92 - chance <= share <= 0.97 + chance
        findings.append(Finding(case, figure, limits, holds))
    return findings


POSITIONS = Part(_keys, lambda key: measure(key[1], key[5]), _summarise)
