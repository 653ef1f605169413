# SPDX-License-Identifier: BSD-3-Clause
"""Stage two of the five-hole probe from the best of the samples: sepcal, Ceres and SciPy."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.five_hole import NOISE, FiveHoleFlight, by_sepcal
from benchmarks.numpy_five_hole import alternate, solve
from benchmarks.python_peers import python_peers
from benchmarks.race import Competitor, Result, judge, lengths_within, peer, race, timed

CERES = {
    "a row a block": "1",
    "a row a block, QR": "1-qr",
    "50 rows a block": "50",
    "50 rows a block, QR": "50-qr",
    "50 rows a block, derivatives by hand": "50-by-hand",
}


def competitors(flight: FiveHoleFlight, known: bool) -> list[Competitor]:
    """With R known, or alternated with the parameters."""
    method = "known-noise" if known else "stage-two"
    repeats = 3 if flight.rows < 50_000 else 1
    all_of_them = by_sepcal(method, flight, 3 * repeats)
    for name, way in CERES.items():
        for flags in ("plain", "native"):
            run = peer(flags, "five-hole", f"{method}:{way}", flight.file, repeats)
            all_of_them.append(Competitor(f"Ceres, {name}, {flags}", run))
    for scipy in ("trf", "lm"):

        def run_scipy(scipy: str = scipy) -> np.ndarray:
            probe = flight.hoist()
            if not known:
                return alternate(probe, flight.start, flight.start_noise, scipy)
            probe.set_noise(np.array(NOISE))
            return solve(probe, flight.start, scipy)

        all_of_them.append(Competitor(f"SciPy {scipy}, derivatives by hand", timed(run_scipy)))
    return all_of_them + (python_peers(flight) if known else [])


def run(folder: Path, rounds: int, longest: int) -> Iterator[Result]:
    """Both noises, short and long."""
    for rows in lengths_within(longest, (5_000, 100_000)):
        flight = FiveHoleFlight(folder, rows)
        for known in (True, False):
            racing = competitors(flight, known)
            race(racing, rounds)
            title = f"Stage two alone, {rows:,} rows, R {'known' if known else 'alternated'}"
            yield judge("stage-two", title, racing, flight.in_errors, "standard errors")
