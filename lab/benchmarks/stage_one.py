# SPDX-License-Identifier: BSD-3-Clause
"""Stage one of the five-hole probe: its samples by themselves, and with its descents."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np

from benchmarks.five_hole import FiveHoleFlight, by_sepcal
from benchmarks.limits import instruction_sets, measure
from benchmarks.numpy_five_hole import sample
from benchmarks.race import Competitor, Result, ask, judge, lengths_within, peer, race, timed

LENGTHS = (5_000, 100_000)


def repeats_of(flight: FiveHoleFlight) -> int:
    """Long records need no second look."""
    return 3 if flight.rows < 50_000 else 1


def race_samples(flight: FiveHoleFlight, rounds: int) -> Result:
    """One linear least squares a sample; the share of the arithmetic limit that sepcal reaches."""
    repeats = repeats_of(flight)
    ours = by_sepcal("sampling", flight, 3 * repeats)
    others = [
        Competitor(
            f"Eigen ColPivHouseholderQR, {flags}",
            peer(flags, "five-hole", "sampling", flight.file, repeats),
        )
        for flags in ("plain", "native")
    ]
    numpy = Competitor("NumPy lstsq", timed(lambda: sample(flight.hoist(), flight.points)))
    racing = [*ours, *others, numpy]
    race(racing, rounds)
    # Who samples answers with the best point, sepcal with the sum of squares there.
    for one in racing[len(ours) :]:
        probe = flight.hoist()
        one.answer = np.array([np.linalg.norm(probe.residuals(one.answer))])
    least = float(ours[0].answer[0])
    title = f"{len(flight.points)} samples of stage one, {flight.rows:,} rows"
    result = judge(
        "samples", title, racing, lambda off: abs(float(off[0])) / least, "of the residual"
    )
    operations = float(ask("sepcal", "five-hole", "operations", flight.file, 1)[1][0])
    count = flight.rows * len(flight.points)
    result.facts["operations a row and sample"] = operations
    shares = []
    for line, isa in zip(result.lines, instruction_sets(), strict=False):
        share = operations * count / line.median / measure().operations[isa]
        result.facts[f"share of the limit.{isa}"] = share
        shares.append(f"{100 * share:.0f} % ({isa}, {1e9 * line.median / count:.3g} ns)")
    own, unprepared = (
        float(
            np.median([ask("sepcal", "five-hole", method, flight.file, repeats)[0] for _ in "123"])
        )
        for method in ("sampling-own", "sampling-unprepared")
    )
    result.facts["prepare() brings"] = unprepared / own
    result.notes.append(
        "As a user's own model, compiled for SSE2, the probe takes "
        f"{unprepared / own:.2g} times as long where it doesn't tell what prepare() and settle() "
        "may compute once."
    )
    result.notes.append(
        f"{operations:.0f} operations a row and sample: sepcal reaches {', '.join(shares)} of what "
        "one core can do."
    )
    return result


def race_stage_one(flight: FiveHoleFlight, rounds: int) -> Result:
    """Samples, and as many descents as sepcal makes, from where it makes them."""
    repeats = repeats_of(flight)
    racing = by_sepcal("stage-one", flight, repeats) + [
        Competitor(
            f"Eigen + Ceres, {name}, {flags}",
            peer(flags, "five-hole", f"stage-one:{way}", flight.file, repeats),
        )
        for name, way in {"automatic": "50", "by hand": "50-by-hand"}.items()
        for flags in ("plain", "native")
    ]
    race(racing, rounds)
    title = f"Stage one with {flight.descents} descents, {flight.rows:,} rows"
    return judge("stage-one", title, racing, flight.in_errors, "standard errors")


def run(folder: Path, rounds: int, longest: int) -> Iterator[Result]:
    """Samples alone."""
    for rows in lengths_within(longest, LENGTHS):
        yield race_samples(FiveHoleFlight(folder, rows), rounds)


def run_whole(folder: Path, rounds: int, longest: int) -> Iterator[Result]:
    """Samples and descents, white noise and pink."""
    for rows, noise in product(lengths_within(longest, LENGTHS), ("white", "pink")):
        result = race_stage_one(FiveHoleFlight(folder, rows, noise), rounds)
        result.title += f", {noise} noise"
        yield result
