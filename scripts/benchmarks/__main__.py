# SPDX-License-Identifier: BSD-3-Clause
"""Times of sepcal beside other programs' on the same problems, on one core, in turns."""

from __future__ import annotations

import argparse
import importlib
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path

# One core, before NumPy starts threads of its own.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

ROOT = Path(__file__).parents[2]
RACES = {  # modules, each with run(folder, rounds, quick)
    "stage-two": "stage_two",
    "fit": "whole_fit",
    "output-error": "output_error",
    "smoother": "smoother",
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Returns the exit code."""
    parser = argparse.ArgumentParser(prog="scripts/benchmark", description=__doc__)
    names = ", ".join(RACES)
    parser.add_argument("race", nargs="*", metavar="RACE", help=f"{names}; all where none is named")
    parser.add_argument("--rounds", type=int, default=9, help="turns of every contender (9)")
    parser.add_argument("--quick", action="store_true", help="short records, to see that it runs")
    chosen = parser.parse_args(arguments)
    for name in chosen.race:
        if name not in RACES:
            parser.error(f"there is no race '{name}'; there are {names}")
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    from benchmarks import results  # NumPy starts here

    target = ROOT / ("build/benchmark-quick" if chosen.quick else "benchmarks/results")
    for name in chosen.race or RACES:
        race = importlib.import_module(f"benchmarks.{RACES[name]}")
        with tempfile.TemporaryDirectory() as folder:
            found = race.run(Path(folder), max(1, chosen.rounds), chosen.quick)
        for result in found:
            print(result.table(), end="\n\n", flush=True)
        results.write(target, found)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
