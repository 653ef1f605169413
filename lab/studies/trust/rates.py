# SPDX-License-Identifier: BSD-3-Clause
"""Sensors of different rates in two files: how often 95 % intervals hold the truth once joined.

A tube at 10 Hz and a GNSS receiver at 5 Hz never share a row. Each has a clock, stamps that jitter,
lost rows, a pause, and readings in steps; the tube's clock is 0.15 s late. The receiver's noise is
white, or remembers a second (its tracking loops), or drifts over ten. `one file` is the drift
without any joining: what it costs there, no joining brought about.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

import sepcal
from studies.study import Finding, seed_range
from studies.trust.noises import Array
from studies.trust.part import Key, Part, Row

LATE = 0.15  # s, the tube's clock
FAST, SLOW = 10.0, 5.0  # Hz
TUBE = 0.1  # m/s, white
REACH = 1.96


@dataclass(frozen=True)
class Receiver:
    """Noise of each component of the velocity [m/s]."""

    white: float
    slow: float = 0.0
    remembers: float = 1.0  # s
    in_one_file: bool = False


CASES = {
    "white": Receiver(0.05),
    "remembers 1 s": Receiver(0.03, 0.03, 1.0),
    "drifts over 10 s": Receiver(0.03, 0.02, 10.0),
    "drifts over 10 s, one file": Receiver(0.0, 0.02, 10.0, in_one_file=True),
}


def _keys(arguments: argparse.Namespace) -> Iterator[Key]:
    for seed in seed_range(arguments):
        for case in CASES:
            yield "rates", case, "white", 0.0, 0, seed


def draw_drift(rng: np.random.Generator, time: Array, remembers: float) -> Array:
    """Gauss-Markov, of unit size, at each of the times [s]."""
    drift = rng.standard_normal(time.size)
    for i, interval in enumerate(np.diff(time), start=1):
        phi = np.exp(-interval / remembers)
        drift[i] = phi * drift[i - 1] + np.sqrt(1.0 - phi * phi) * drift[i]
    return np.asarray(drift)


def draw_times(rng: np.random.Generator, ends: tuple[float, float], rate: float) -> Array:
    """When a sensor was read: nearly regular, with lost rows and a pause of 3 s."""
    time = np.arange(ends[0] + rng.uniform(0.5, 1.0), ends[1] - 0.5, 1.0 / rate)
    time = time + rng.uniform(-0.05, 0.05, time.size) / rate
    pause = rng.uniform(ends[0] + 20.0, ends[1] - 20.0)
    kept = (rng.random(time.size) > 0.02) & ~((time > pause) & (time < pause + 3.0))
    return np.asarray(time[kept])


def draw_pair(case: str, seed: int) -> tuple[sepcal.Flight, sepcal.Flight, dict[str, float]]:
    """The tube's log, the receiver's, and the truth."""
    noise = CASES[case]
    rng = np.random.default_rng([seed, list(CASES).index(case)])
    quiet = sepcal.simulate("pitot-static", noise={"airspeed": 1e-9}, rate=50, seed=seed)
    flown = np.array(quiet["time_s"])
    ends = (float(flown[0]), float(flown[-1]))
    read = draw_times(rng, ends, FAST)
    late = 0.0 if noise.in_one_file else LATE
    airspeed = np.interp(read, flown, quiet["airspeed_mps"]) + TUBE * rng.standard_normal(read.size)
    stamps = np.round(read + late + 0.002 * rng.standard_normal(read.size), 3)
    tube = {"time_s": stamps, "airspeed_mps": np.round(airspeed, 2)}
    fixed = read if noise.in_one_file else draw_times(rng, ends, SLOW)
    receiver = {"time_s": np.round(fixed, 3)}
    for axis in "ned":
        errors = noise.white * rng.standard_normal(fixed.size)
        errors += noise.slow * draw_drift(rng, fixed, noise.remembers)
        velocity = np.interp(fixed, flown, quiet[f"v{axis}_mps"]) + errors
        receiver[f"v{axis}_mps"] = np.round(velocity, 2)
    truth = dict(quiet.truth) | {"time_offset.tau": late}
    return sepcal.Flight(tube, name="tube"), sepcal.Flight(receiver, name="receiver"), truth


def measure(case: str, seed: int) -> Row:
    """Each parameter's error, and what is said of it."""
    tube, receiver, truth = draw_pair(case, seed)
    if CASES[case].in_one_file:
        columns = {header: receiver[header] for header in receiver if header != "time_s"}
        flight = sepcal.Flight({**{header: tube[header] for header in tube}, **columns})
        calibration = sepcal.fit(sepcal.PitotStatic(), flight)
    else:
        flight = sepcal.join(tube, receiver)
        calibration = sepcal.fit(sepcal.PitotStatic(), flight, effects=["time_offset"])
    free = [name for name, one in calibration.parameters.items() if not one.fixed]
    return {
        "status": calibration.status,
        "errors": {
            name: [calibration[name].value - truth[name], calibration[name].standard_error]
            for name in free
        },
    }


def _summarise(rows: Sequence[Row]) -> list[Finding]:
    """A line for each case and parameter; the drifts are shown, and nothing is asked of them."""
    groups: dict[tuple[str, str], list[list[float]]] = defaultdict(list)
    for row in rows:
        for name, pair in row["errors"].items():
            groups[row["key"][1], name].append(pair)
    findings = []
    for (case, name), pairs in groups.items():
        share = float(np.mean([abs(error) <= REACH * stated for error, stated in pairs]))
        size = float(np.sqrt(np.mean([error**2 for error, _ in pairs])))
        stated = float(np.median([one for _, one in pairs]))
        chance = 2.0 * np.sqrt(0.05 * 0.95 / len(pairs))
        figure = f"{100 * share:.1f} % of {len(pairs)}, rms error {size:.3g}, stated {stated:.3g}"
        asked = CASES[case].remembers <= 1.0
        limits = f"92 to 97 % and {100 * chance:.0f} by chance" if asked else "shown"
        holds = not asked or 0.92 - chance <= share <= 0.97 + chance
        findings.append(Finding(f"{case}: {name}", figure, limits, holds))
    return findings


RATES = Part(_keys, lambda key: measure(key[1], key[5]), _summarise)
