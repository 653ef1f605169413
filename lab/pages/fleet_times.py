# SPDX-License-Identifier: BSD-3-Clause
"""The time of a joint fit of many logs against the number of Dask workers.

python lab/pages/fleet_times.py [--flights 200] [--rows 2000] [--workers 1,2,4]

Each row is the median of three fits; every one must be that of one process to the last bit.
"""

import argparse
import logging
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import Executor
from pathlib import Path

import numpy as np
from distributed import Client, LocalCluster

import sepcal

WIND = ("w_n", "w_e", "w_d")
PROBE = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))


def write_log(folder: Path, index: int, rows: int) -> Path:
    """A simulated log in a wind of its own."""
    wind = dict(zip(WIND, np.random.default_rng(index).normal(0.0, 3.0, 3), strict=True))
    flight = sepcal.simulate(PROBE, parameters=wind, rows=rows, seed=index)
    file = folder / f"{index:04d}.csv"
    table = np.column_stack([flight[header] for header in flight])
    np.savetxt(file, table, delimiter=",", header=",".join(flight), comments="", fmt="%.17g")
    return file


def fit(files: list[Path], executor: Executor | None, threads: int = 1) -> sepcal.ManyFit:
    """The joint fit, a wind a flight."""
    return sepcal.fit_many(PROBE, files, own=WIND, executor=executor, threads=threads)


def time_of(run: Callable[[], sepcal.ManyFit], expected: sepcal.ManyFit) -> float:
    """The median of three runs [s]."""
    times = []
    for _ in range(3):
        start = time.perf_counter()
        found = run()
        times.append(time.perf_counter() - start)
        if (
            str(found) != str(expected)
            or found.covariance.tobytes() != expected.covariance.tobytes()
        ):
            sys.exit("another result than that of one process")
    return statistics.median(times)


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--flights", type=int, default=200)
    parser.add_argument("--rows", type=int, default=2000)
    parser.add_argument("--workers", default="1,2")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        files = [
            write_log(Path(folder), index, arguments.rows) for index in range(arguments.flights)
        ]
        megabytes = sum(file.stat().st_size for file in files) / 1e6
        expected = fit(files, None)
        print(
            f"{len(files)} logs of {arguments.rows} rows, {megabytes:.0f} MB; {expected.passes} "
            f"passes; {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}"
        )
        one = time_of(lambda: fit(files, None), expected)
        print(f"{'one process, one thread':<28}{one:8.2f} s")
        many = time_of(lambda: fit(files, None, threads=0), expected)
        print(f"{'one process, all cores':<28}{many:8.2f} s{one / many:8.2f} x")
        for workers in map(int, arguments.workers.split(",")):
            with (
                LocalCluster(  # type: ignore[no-untyped-call]
                    processes=True,
                    n_workers=workers,
                    threads_per_worker=1,
                    dashboard_address=":0",
                    silence_logs=logging.ERROR,
                ) as cluster,
                Client(cluster) as client,  # type: ignore[no-untyped-call]
            ):
                client.wait_for_workers(workers)
                fit(files[:workers], client.get_executor())  # every worker has imported sepcal
                spent = time_of(lambda: fit(files, client.get_executor()), expected)
                print(f"{f'Dask, {workers} workers':<28}{spent:8.2f} s{one / spent:8.2f} x")


if __name__ == "__main__":
    main()
