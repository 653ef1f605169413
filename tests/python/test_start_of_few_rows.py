# SPDX-License-Identifier: BSD-3-Clause
"""Filters that start from 2 s of a flight in which noise drives the states, its size not given.

The parameters follow part of that noise: the likelihood finds none of it in three of four flights,
and intervals are too narrow. The restricted likelihood finds it.
"""

import numpy as np
import pytest

import sepcal
from studies import starts

FLIGHTS = range(1, 13)
ROWS = 100


@pytest.fixture(scope="module")
def tracks() -> list[sepcal.Track]:
    """Recursive maximum likelihood, from the first rows on."""
    model = sepcal.ShortPeriod()
    return [
        sepcal.track(
            model,
            {name: values[: ROWS + 2] for name, values in starts.fly(seed, 1.0).items()},
            start_rows=ROWS,
            method="rml",
        )
        for seed in FLIGHTS
    ]


@pytest.mark.slow
def test_the_noise_is_found(tracks: list[sepcal.Track]) -> None:
    alone = []
    for seed in FLIGHTS:
        first = {name: values[:ROWS] for name, values in starts.fly(seed, 1.0).items()}
        fit = sepcal.fit(sepcal.ShortPeriod(), first, method="filter-error")
        alone.append(fit.noise_sizes["q_q"].value / starts.DENSITY[1])
    found = [track["q_q"][0] / starts.DENSITY[1] for track in tracks]
    assert np.mean(np.array(alone) < 0.1) > 0.4
    assert np.mean(np.array(found) > 0.2) > 0.8
    assert 0.4 < np.median(found) < 2.5


def test_intervals_hold(tracks: list[sepcal.Track]) -> None:
    holds = [
        abs(track[name][0] - true) < 1.96 * track.standard_deviation(name)[0]
        for track in tracks
        for name, true in starts.TRUTH.items()
    ]
    assert np.mean(holds) > 0.85  # of 60, from 12 flights; 0.76 by the likelihood alone
