# SPDX-License-Identifier: BSD-3-Clause
"""Times of sepcal beside other programs' on the same problems, on one core, in turns."""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections.abc import Sequence
from functools import partial
from pathlib import Path

# One core, before NumPy starts threads of its own.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

from benchmarks.races import BASELINE, RACES, find_run  # noqa: E402

ROOT = Path(__file__).parents[2]


def main(arguments: Sequence[str] | None = None) -> int:
    """Returns the exit code."""
    parser = argparse.ArgumentParser(prog="scripts/benchmark", description=__doc__)
    names = ", ".join(RACES)
    parser.add_argument("race", nargs="*", metavar="RACE", help=f"{names}; all where none is named")
    parser.add_argument("--rounds", type=int, default=9, help="turns of every competitor (9)")
    parser.add_argument("--quick", action="store_true", help="short records, to see that it runs")
    parser.add_argument("--longest", type=int, metavar="ROWS", help="leaves out longer records")
    parser.add_argument(
        "--baseline",
        metavar="COMMIT",
        help="race against that commit's apps; without RACE, nothing else",
    )
    chosen = parser.parse_args(arguments)
    for name in chosen.race:
        if name not in RACES:
            parser.error(f"there is no race '{name}'; there are {names}")
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    from benchmarks import results  # NumPy starts here
    from benchmarks.race import QUICK

    longest = QUICK if chosen.quick else chosen.longest or sys.maxsize
    target = ROOT / ("build/benchmark-quick" if chosen.quick else "lab/benchmarks/results")
    runs = {name: find_run(name) for name in chosen.race or ([] if chosen.baseline else RACES)}
    if chosen.baseline:
        from benchmarks import baseline

        runs[BASELINE] = partial(baseline.run, commit=chosen.baseline)
    for run in runs.values():
        found = []
        with tempfile.TemporaryDirectory() as folder:
            for result in run(Path(folder), max(1, chosen.rounds), longest):
                print(result.table(), end="\n\n", flush=True)
                found.append(result)
                results.write(target, found)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
