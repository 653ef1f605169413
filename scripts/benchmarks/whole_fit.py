# SPDX-License-Identifier: BSD-3-Clause
"""The whole fit of the five-hole probe: sepcal's default, and others doing the two stages alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.five_hole import FiveHoleFlight
from benchmarks.numpy_five_hole import alternate, sample
from benchmarks.race import Contender, Result, judge, peer, program, race, timed


def by_numpy_and_scipy(flight: FiveHoleFlight) -> np.ndarray:
    """500 linear least squares, then SciPy from the best."""
    probe = flight.hoist()
    x = sample(probe, flight.points)
    return alternate(probe, x, probe.noise_at(x), "trf")


def contenders(flight: FiveHoleFlight) -> list[Contender]:
    """The first is sepcal."""
    repeats = 3 if flight.rows < 50_000 else 1
    return [
        Contender("sepcal", program("five-hole", "fit", flight.file, repeats)),
        *(
            Contender(
                f"Eigen + Ceres, {name}, {flags}",
                peer(flags, f"fit:{way}", flight.file, repeats),
            )
            for name, way in {"automatic": "50", "by hand": "50-by-hand"}.items()
            for flags in ("plain", "native")
        ),
        Contender("NumPy + SciPy", timed(lambda: by_numpy_and_scipy(flight))),
    ]


def run(folder: Path, rounds: int, quick: bool) -> list[Result]:
    """White and pink noise; a million rows of white."""
    flights = (
        [(500, "white")]
        if quick
        else [
            (5_000, "white"),
            (5_000, "pink"),
            (100_000, "white"),
            (100_000, "pink"),
            (1_000_000, "white"),
        ]
    )
    results = []
    for rows, noise in flights:
        flight = FiveHoleFlight(folder, rows, noise)
        racing = contenders(flight)
        race(racing, rounds)
        title = f"The whole fit, {rows:,} rows, {noise} noise"
        results.append(judge("fit", title, racing, flight.in_errors, "standard errors"))
    return results
