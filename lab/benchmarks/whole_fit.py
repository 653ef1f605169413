# SPDX-License-Identifier: BSD-3-Clause
"""The whole fit of the five-hole probe: sepcal's default, and others doing the two stages alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np

from benchmarks.five_hole import FiveHoleFlight, by_sepcal
from benchmarks.numpy_five_hole import alternate, sample
from benchmarks.race import Competitor, Result, judge, lengths_within, peer, race, timed

BRIEF = ("sepcal", "Eigen + Ceres, by hand, native", "NumPy + SciPy")


def by_numpy_and_scipy(flight: FiveHoleFlight) -> np.ndarray:
    """500 linear least squares, then SciPy from the best."""
    probe = flight.hoist()
    x = sample(probe, flight.points)
    return alternate(probe, x, probe.noise_at(x), "trf")


def competitors(flight: FiveHoleFlight) -> list[Competitor]:
    """The first is sepcal."""
    repeats = 3 if flight.rows < 50_000 else 1
    return [
        *by_sepcal("fit", flight, repeats),
        *(
            Competitor(
                f"Eigen + Ceres, {name}, {flags}",
                peer(flags, "five-hole", f"fit:{way}", flight.file, repeats),
            )
            for name, way in {"automatic": "50", "by hand": "50-by-hand"}.items()
            for flags in ("plain", "native")
        ),
        Competitor("NumPy + SciPy", timed(lambda: by_numpy_and_scipy(flight))),
    ]


def competitors_with_effects(flight: FiveHoleFlight) -> list[Competitor]:
    """Two effects join at run time: wind that drifts, a pressure that follows the throttle."""
    repeats = 3 if flight.rows < 50_000 else 1
    return by_sepcal("fit-with-effects", flight, repeats) + [
        Competitor(
            f"Eigen + Ceres, automatic, {flags}",
            peer(flags, "five-hole", "fit-with-effects", flight.file, repeats),
        )
        for flags in ("plain", "native")
    ]


def race_fit(flight: FiveHoleFlight, racing: list[Competitor], rounds: int) -> Result:
    """One table."""
    race(racing, rounds)
    title = f"The whole fit, {flight.rows:,} rows, {flight.noise} noise"
    return judge("fit", title, racing, flight.in_errors, "standard errors")


def run(folder: Path, rounds: int, longest: int) -> Iterator[Result]:
    """White and pink noise."""
    for rows, noise in product(lengths_within(longest, (5_000, 100_000)), ("white", "pink")):
        flight = FiveHoleFlight(folder, rows, noise)
        yield race_fit(flight, competitors(flight), rounds)


def run_long(folder: Path, rounds: int, longest: int) -> Iterator[Result]:
    """A million rows of white noise; of each kind of peer the fastest there."""
    flight = FiveHoleFlight(folder, lengths_within(longest, (1_000_000,))[0])
    brief = [one for one in competitors(flight) if one.name in BRIEF]
    result = race_fit(flight, brief, rounds)
    yield replace(result, race="long-fit")


def run_with_effects(folder: Path, rounds: int, longest: int) -> Iterator[Result]:
    """White and pink noise."""
    for rows, noise in product(lengths_within(longest, (5_000, 100_000)), ("white", "pink")):
        hidden = {"propwash": 40.0, "wind_drift": 0.01}
        flight = FiveHoleFlight(folder, rows, noise, hidden)
        racing = competitors_with_effects(flight)
        race(racing, rounds)
        title = f"The whole fit with two effects, {rows:,} rows, {noise} noise"
        yield judge("fit-with-effects", title, racing, flight.in_errors, "standard errors")
