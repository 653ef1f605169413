# SPDX-License-Identifier: BSD-3-Clause
"""Time of a Monte Carlo study against executor and workers, as a Markdown table.

    PYTHONPATH=build/python .venv/bin/python lab/pages/executor_times.py --workers 1,2

Every study must equal the serial one, to the last bit, and is timed next to it. Workers are started
before the clock is.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager

from numpy.random import Generator

import sepcal
from sepcal.executors import gather

PROBE = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
TRIALS = {
    "five-hole probe, 400 rows": sepcal.SimulatedTrial(PROBE, simulation={"rows": 400}),
    "Pitot-static tube, 100 rows": sepcal.SimulatedTrial(
        sepcal.PitotStatic(), simulation={"rows": 100}, samples=50
    ),
}


def wait(seconds: float) -> None:
    """Keeps a worker busy, so that the next task starts another."""
    time.sleep(seconds)


@contextmanager
def dask(workers: int) -> Iterator[Executor]:
    """Dask's executor on a cluster of this machine."""
    from distributed import Client, LocalCluster

    with (
        LocalCluster(  # type: ignore[no-untyped-call]
            processes=True, n_workers=workers, threads_per_worker=1, dashboard_address=":0"
        ) as cluster,
        Client(cluster) as client,  # type: ignore[no-untyped-call]
    ):
        client.wait_for_workers(workers)
        yield client.get_executor()


EXECUTORS: dict[str, Callable[[int], object]] = {
    "threads": ThreadPoolExecutor,
    "processes": ProcessPoolExecutor,
    "Dask": dask,
}


def measure(trial: Callable[[Generator], object], trials: int, workers: list[int]) -> None:
    """Prints the rows of one trial."""

    def run(executor: Executor | None) -> tuple[float, sepcal.MonteCarlo]:
        begun = time.perf_counter()
        study = sepcal.monte_carlo(trial, trials, executor=executor, progress=False)
        return time.perf_counter() - begun, study

    expected = run(None)[1]
    for name, make in EXECUTORS.items():
        for count in workers:
            with make(count) as executor:  # type: ignore[attr-defined]
                gather(wait, [0.2] * count, executor)
                gather(trial, [record.rng for record in expected.trials[:count]], executor)
                seconds, study = run(executor)
            if study.estimates.tobytes() != expected.estimates.tobytes():
                sys.exit(f"{name} with {count} workers differ from the serial study")
            serial = run(None)[0]
            times = f"{1e3 * serial / trials:.1f} | {1e3 * seconds / trials:.1f}"
            print(f"| {name} | {count} | {times} | {serial / seconds:.2f} |", flush=True)


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=200)
    parser.add_argument("--workers", default="1,2", help="numbers of workers, comma-separated")
    arguments = parser.parse_args()
    workers = [int(count) for count in arguments.workers.split(",")]
    for name, trial in TRIALS.items():
        print(f"\n{name}, {arguments.trials} trials\n")
        print("| executor | workers | ms a trial, serial | ms a trial | ratio |")
        print("|---|---|---|---|---|")
        measure(trial, arguments.trials, workers)


if __name__ == "__main__":
    main()
