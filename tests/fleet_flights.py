# SPDX-License-Identifier: BSD-3-Clause
"""Fleets of simulated logs, and executors in which something happens on the way."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

import numpy as np

import sepcal
from sepcal.dask_executor import with_sure_futures

WIND = ("w_n", "w_e", "w_d")
PROBE = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))


def simulate_flight(index: int, rows: int = 120, **parameters: float) -> sepcal.SimulatedFlight:
    """A flight of the same probe in a wind of its own."""
    generator = np.random.default_rng(index)
    wind = dict(zip(WIND, generator.normal(0.0, 3.0, 3), strict=True))
    return sepcal.simulate(PROBE, parameters={**wind, **parameters}, rows=rows, seed=index)


def write_log(flight: sepcal.Flight, file: Path) -> Path:
    """The log as a CSV file that reads back to the same numbers."""
    lines = [",".join(flight)]
    lines += [",".join(map(repr, row)) for row in zip(*map(_floats, flight.values()), strict=True)]
    file.write_text("\n".join(lines) + "\n")
    return file


def write_fleet(folder: Path, count: int, rows: int = 120) -> list[Path]:
    """So many logs."""
    return [
        write_log(simulate_flight(index, rows), folder / f"{index:03d}.csv")
        for index in range(count)
    ]


def _floats(values: Any) -> list[float]:
    return np.asarray(values).tolist()


def check_same(found: sepcal.ManyFit, expected: sepcal.ManyFit) -> None:
    """Bit for bit."""
    assert str(found) == str(expected)
    assert found.covariance.tobytes() == expected.covariance.tobytes()
    assert found.covariance_white.tobytes() == expected.covariance_white.tobytes()
    assert found.cost == expected.cost
    for field in ("shared", "flights", "noise", "rmse", "left_out", "passes"):
        assert pickle.dumps(getattr(found, field)) == pickle.dumps(getattr(expected, field)), field


class Interrupted(Executor):
    """Another executor, with something done before its n-th task is submitted.

    Dask's gets the futures that sepcal gives it: its own may end in a TypeError as a worker dies.
    """

    def __init__(self, executor: Executor, at: int, action: Callable[[], None]) -> None:
        self.executor, self.at, self.action = with_sure_futures(executor), at, action
        self.submitted = 0

    def submit(self, function: Callable[..., Any], /, *items: Any, **named: Any) -> Future[Any]:
        """As the other executor's."""
        self.submitted += 1
        if self.submitted == self.at:
            self.action()
        return self.executor.submit(function, *items, **named)
