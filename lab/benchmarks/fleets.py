# SPDX-License-Identifier: BSD-3-Clause
"""What fleets cost: time, memory and bytes by flights and candidates, and the honest alternative.

    python -m benchmarks.fleets scale --flights 100 1000 10000
    python -m benchmarks.fleets alternative --flights 200
    python -m benchmarks.fleets extrapolate --flights 1000000 --cores 1000

`scale` fits and diagnoses fleets of so many flights of 2,000 rows and writes fleets.json and its
plots. Logs are 200 simulated ones, again and again, so that what is found in them means nothing.
`alternative` is one fit a flight by SciPy on Dask's delayed functions, and the average of the
estimates. `extrapolate` simulates a scheduler with the task times that `scale` measured, with
stragglers and workers that die.
"""

from __future__ import annotations

import argparse
import heapq
import json
import os
import pickle
import resource
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

import sepcal

Array = NDArray[np.float64]
ROWS = 2000
DISTINCT = 200  # simulated logs
A_VEHICLE = 20  # flights
PORTS = ("airspeed_bias", "airspeed_scale", "pressure_offset", "wind")
CHANNELS = ("throttle", "altitude_m", "q", "r")
RESULTS = Path(__file__).parent / "results" / "fleets.json"
TRUTH = {"s_va": 0.95, "c_va": -0.6}


def write_logs(folder: Path, count: int) -> list[Path]:
    """So many logs, each one of DISTINCT with blank lines of its own after it."""
    whole = folder / "distinct"
    if not whole.exists():
        whole.mkdir(parents=True)
        for seed in range(DISTINCT):
            rng = np.random.default_rng(seed)
            wind = {"w_n": float(rng.normal(0.0, 4.0)), "w_e": float(rng.normal(0.0, 4.0))}
            flown = sepcal.simulate("pitot-static", rows=ROWS, seed=seed, parameters=wind)
            flown.to_csv(whole / f"{seed}.csv")
    links = folder / f"fleet-{count}"
    links.mkdir()
    made = []
    for number in range(count):
        link = links / f"V{number // A_VEHICLE:05d}_{number % A_VEHICLE:02d}.csv"
        text = (whole / f"{number % DISTINCT}.csv").read_bytes()
        link.write_bytes(text + b"\n" * (number // DISTINCT))
        made.append(link)
    return made


def measure(folder: Path, count: int, candidates: Sequence[str] | None) -> dict[str, Any]:
    """A fleet of so many flights: seconds, CPU, memory, bytes a flight."""
    write_logs(folder, count)
    begun, cpu = time.monotonic(), time.process_time()
    fleet = sepcal.Fleet(
        folder / f"fleet-{count}",
        sepcal.PitotStatic(),
        names="{vehicle}_{number}.csv",
        candidates=candidates,
        progress=False,
    )
    flights = len(fleet.flights)
    fitted, fitted_cpu = time.monotonic(), time.process_time()
    found = fleet.diagnose()
    done, done_cpu = time.monotonic(), time.process_time()
    one = next(iter(fleet.flights.values()))
    return {
        "flights": flights,
        "rows": ROWS,
        "columns": len(one.factor.columns),
        "passes": fleet.fitted.passes,
        "fit_seconds": fitted - begun,
        "fit_cpu": fitted_cpu - cpu,
        "diagnose_seconds": done - fitted,
        "diagnose_cpu": done_cpu - fitted_cpu,
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
        "answer_bytes": len(pickle.dumps(one.factor)) + len(one.calibration),
        "findings": len(found.found),
        "cores": os.cpu_count(),
    }


def scale(arguments: argparse.Namespace) -> None:
    """Measures each size, and each number of candidates at the smallest."""
    told = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        told["by_flights"] = []
        for count in arguments.flights:
            told["by_flights"].append(measure(folder, count, None))
            print(json.dumps(told["by_flights"][-1]), flush=True)
        told["by_candidates"] = []
        for number in (0, 4, 8, 16):
            chosen = [f"{port}[{channel}]" for channel in CHANNELS for port in PORTS][:number]
            links = folder / "fleet-100"
            if links.exists():
                for link in links.iterdir():
                    link.unlink()
                links.rmdir()
            told["by_candidates"].append(measure(folder, 100, chosen))
            print(json.dumps(told["by_candidates"][-1]), flush=True)
    RESULTS.parent.mkdir(exist_ok=True)
    RESULTS.write_text(json.dumps(told, indent=1) + "\n")
    draw(told)


def draw(told: dict[str, Any]) -> None:
    """Growth with flights and with candidates, beside the results."""
    import matplotlib

    matplotlib.use("svg")
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
    flights = [one["flights"] for one in told["by_flights"]]
    for key, label in (("fit_cpu", "fit"), ("diagnose_cpu", "diagnose")):
        left.loglog(flights, [one[key] for one in told["by_flights"]], "o-", label=label)
    left.set_xlabel("flights of 2,000 rows")
    left.set_ylabel("seconds of CPU")
    left.legend()
    columns = [one["columns"] for one in told["by_candidates"]]
    right.plot(columns, [one["fit_cpu"] for one in told["by_candidates"]], "o-")
    right.set_xlabel("columns of candidates, 100 flights")
    right.set_ylabel("seconds of CPU, fit")
    figure.savefig(RESULTS.with_suffix(".svg"))
    pyplot.close(figure)


def fit_by_scipy(file: str) -> tuple[Array, Array]:
    """The tube's five parameters less w_d, and their covariance, as a careful user has it."""
    import pandas

    log = pandas.read_csv(file)
    north, east, down, z = (
        log[name].to_numpy() for name in ("vn_mps", "ve_mps", "vd_mps", "airspeed_mps")
    )

    def residual(x: Array) -> Array:
        speed = np.sqrt((north - x[2]) ** 2 + (east - x[3]) ** 2 + down**2)
        return np.asarray(z - x[0] * speed - x[1])

    found = least_squares(residual, [1.0, 0.0, 0.0, 0.0], x_scale="jac")
    variance = 2.0 * found.cost / (len(z) - 4)
    return found.x, variance * np.linalg.inv(found.jac.T @ found.jac)


def alternative(arguments: argparse.Namespace) -> None:
    """CPU and error of the mean of s_va: one fleet beside fits that are averaged."""
    from dask.base import compute
    from dask.delayed import delayed

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = write_logs(folder, arguments.flights)
        cpu = time.process_time()
        tasks = [delayed(fit_by_scipy)(str(file)) for file in files]
        fits = compute(  # type: ignore[no-untyped-call]
            *tasks, scheduler="threads", num_workers=os.cpu_count()
        )
        weights = np.array([1.0 / covariance[0, 0] for _, covariance in fits])
        values = np.array([x[0] for x, _ in fits])
        averaged = float(weights @ values / weights.sum())
        scipy_cpu = time.process_time() - cpu
        cpu = time.process_time()
        fleet = sepcal.Fleet(
            folder / f"fleet-{arguments.flights}",
            sepcal.PitotStatic(),
            names="{vehicle}_{number}.csv",
            candidates=[],
            progress=False,
        )
        population = fleet.population()
        sepcal_cpu = time.process_time() - cpu
        mean, error = population.mean["s_va"]
    told = {
        "flights": arguments.flights,
        "scipy_cpu": scipy_cpu,
        "scipy_error": averaged - TRUTH["s_va"],
        "scipy_standard_error": float(weights.sum() ** -0.5),
        "sepcal_cpu": sepcal_cpu,
        "sepcal_error": mean - TRUTH["s_va"],
        "sepcal_standard_error": error,
    }
    print(json.dumps(told, indent=1))
    whole = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    RESULTS.write_text(json.dumps(whole | {"alternative": told}, indent=1) + "\n")


def extrapolate(arguments: argparse.Namespace) -> None:
    """List scheduling with the measured times.

    One task in 1,000 takes ten times as long, one in 1,000 dies with its worker and is done again.
    """
    measured = json.loads(RESULTS.read_text())["by_flights"][-1]
    rng = np.random.default_rng(45)
    flights, cores = arguments.flights, arguments.cores
    mean = measured["fit_cpu"] / measured["flights"]
    batch = max(1, flights // (cores * 16))
    tasks = -(-flights // batch)
    times = rng.lognormal(np.log(mean * batch) - 0.02, 0.2, tasks)
    times *= np.where(rng.random(tasks) < 1e-3, 10.0, 1.0)
    free = [0.0] * cores
    heapq.heapify(free)
    queue = list(times)
    lost = 0
    while queue:
        start = heapq.heappop(free)
        length = queue.pop()
        if rng.random() < 1e-3:
            lost += 1
            queue.append(length)
            length *= rng.random()
        heapq.heappush(free, start + length)
    wall = max(free)
    diagnose = measured["diagnose_cpu"] / measured["flights"] * flights
    memory = measured["peak_mb"] / measured["flights"] * flights / 1024.0
    gigabytes = measured["answer_bytes"] * flights * measured["passes"] / 1e9
    told = {
        "flights": flights,
        "cores": cores,
        "wall_seconds": wall,
        "ideal_seconds": mean * flights / cores,
        "tasks_lost": lost,
        "answers_gb": gigabytes,
        "answers_gb_s": gigabytes / wall,
        "diagnose_seconds_one_process": diagnose,
        "memory_gb_one_process": memory,
    }
    print(json.dumps(told, indent=1))
    whole = json.loads(RESULTS.read_text())
    RESULTS.write_text(json.dumps(whole | {"extrapolated": told}, indent=1) + "\n")


def main() -> None:
    """Runs one of them."""
    parser = argparse.ArgumentParser(description=__doc__)
    commands = parser.add_subparsers(required=True)
    command = commands.add_parser("scale")
    command.add_argument("--flights", type=int, nargs="+", default=[100, 1000])
    command.set_defaults(run=scale)
    command = commands.add_parser("alternative")
    command.add_argument("--flights", type=int, default=200)
    command.set_defaults(run=alternative)
    command = commands.add_parser("extrapolate")
    command.add_argument("--flights", type=int, default=1_000_000)
    command.add_argument("--cores", type=int, default=1000)
    command.set_defaults(run=extrapolate)
    arguments = parser.parse_args()
    arguments.run(arguments)


if __name__ == "__main__":
    main()
