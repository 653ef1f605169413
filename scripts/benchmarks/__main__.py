# SPDX-License-Identifier: BSD-3-Clause
"""Times of sepcal beside other programs' on the same problems, on one core, in turns."""

from __future__ import annotations

import argparse
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path

# One core, before NumPy starts threads of its own.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"


def main(arguments: Sequence[str] | None = None) -> int:
    """Returns the exit code."""
    from benchmarks import output_error, smoother  # NumPy starts here

    races = {"output-error": output_error.run, "smoother": smoother.run}
    parser = argparse.ArgumentParser(prog="scripts/benchmark", description=__doc__)
    names = " or ".join(races)
    parser.add_argument("race", nargs="*", metavar="RACE", help=f"{names}; all where none is named")
    parser.add_argument("--rounds", type=int, default=9, help="turns of every contender (9)")
    chosen = parser.parse_args(arguments)
    for name in chosen.race:
        if name not in races:
            parser.error(f"there is no race '{name}'; there are {', '.join(races)}")
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    with tempfile.TemporaryDirectory() as folder:
        for name in chosen.race or races:
            print(races[name](Path(folder), max(1, chosen.rounds)), end="\n\n", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
