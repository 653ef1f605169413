# SPDX-License-Identifier: BSD-3-Clause
"""What is lost where workers die, as a Markdown table: executors alone, and under sepcal's retries.

    pip install loky joblib
    PYTHONPATH=build/python:tests .venv/bin/python lab/pages/executor_promises.py --runs 10

Of each run it counts the items that give no result, but for the one that is to blame every time.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from concurrent.futures import Executor, ProcessPoolExecutor, wait
from dataclasses import dataclass
from functools import partial
from typing import Any

import dask
import joblib
import loky
from distributed import Client, LocalCluster

from sepcal.executors import stream
from trial_functions import DieOnce, die_on_third, refuse

Function = Callable[[int], Any]
Count = Callable[[Function, int], int]
HEAD = ("a worker dies once, 30 items", "one item kills, 24 items", "one error can't be read, 10")
LOST = object()


def alone(executor: Executor, function: Function, count: int) -> int:
    """Items that give a result; what is refused, fails, or takes a minute gives none."""
    futures = []
    for item in range(count):
        try:
            futures.append(executor.submit(function, item))
        except Exception:
            continue
    done, _ = wait(futures, timeout=60)
    return sum(not future.cancelled() and future.exception() is None for future in done)


def in_a_pool(function: Function, count: int) -> int:
    """The standard library's, a new one each time: one that broke takes no more work."""
    with ProcessPoolExecutor(2) as pool:
        return alone(pool, function, count)


def in_loky(function: Function, count: int) -> int:
    """Its reusable executor, which is another one when asked for after it broke."""
    return alone(loky.get_reusable_executor(2), function, count)


def in_joblib(function: Function, count: int) -> int:
    """It raises the first failure and stops."""
    given = 0
    try:
        tasks = (joblib.delayed(function)(item) for item in range(count))
        for _ in joblib.Parallel(2, return_as="generator_unordered")(tasks):
            given += 1
    except Exception:
        return given
    return given


@dataclass(frozen=True)
class Guarded:
    """A function whose exceptions are results: those of the function's own are no loss."""

    function: Function

    def __call__(self, item: int) -> object:
        """What it gives, or says."""
        try:
            return self.function(item)
        except Exception as error:
            return str(error)


def in_sepcal(make: Callable[[], Executor], function: Function, count: int) -> int:
    """stream(), which submits lost work again."""
    results = stream(Guarded(function), range(count), make, lost=lambda item, error: LOST)
    return sum(result is not LOST for _, result in results)


def row(name: str, run: Count, runs: int) -> str:
    """Of each experiment the fewest and the most that are lost beside what is to blame."""
    lost: list[list[int]] = [[], [], []]
    for _ in range(runs):
        with tempfile.TemporaryDirectory() as folder:
            lost[0].append(30 - run(DieOnce(folder, 11), 30))
        lost[1].append(23 - run(die_on_third, 24))
        lost[2].append(max(0, 9 - run(refuse, 10)))
    cells = [f"{min(some)} to {max(some)}" for some in lost]
    return f"| {' | '.join([name, *cells])} |"


def main() -> None:
    """Prints a row for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=10)
    runs = parser.parse_args().runs
    print(f"| lost of | {' | '.join(HEAD)} |\n|{'---|' * 4}")
    print(row("ProcessPoolExecutor", in_a_pool, runs))
    print(row("loky", in_loky, runs))
    print(row("joblib", in_joblib, runs))
    pools, reusable = partial(ProcessPoolExecutor, 2), partial(loky.get_reusable_executor, 2)
    print(row("sepcal on ProcessPoolExecutor", partial(in_sepcal, pools), runs))
    print(row("sepcal on loky", partial(in_sepcal, reusable), runs))
    # The cluster waits for a nanny that takes its time; it would else do without the worker.
    patient = {"distributed.deploy.lost-worker-timeout": "10 minutes"}
    with (
        dask.config.set(patient),
        LocalCluster(  # type: ignore[no-untyped-call]
            n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50
        ) as cluster,
        Client(cluster) as client,  # type: ignore[no-untyped-call]
    ):
        for patience in (3, 0):
            cluster.scheduler.allowed_failures = patience
            make = partial(client.get_executor, pure=False, retries=3)
            name = f"Dask, retries=3, allowed-failures {patience}"
            print(row(name, partial(alone, make()), runs))
            print(row(f"sepcal on {name}", partial(in_sepcal, make), runs))


if __name__ == "__main__":
    main()
