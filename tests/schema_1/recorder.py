# SPDX-License-Identifier: BSD-3-Clause
"""Calibrations of schema version 1, and what the release that wrote them made of them.

Usage: PYTHONPATH=BUILD/python python recorder.py BUILD/apps

BUILD is a build of the last release that wrote version 1. Writes CASE.json and recorded.json beside
this file; test_schema_1.py holds the present release against them.
"""

from __future__ import annotations

import contextlib
import csv
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
EVERY = 50  # rows of a corrected log that are kept
FIVE_HOLE = ("--k-alpha", "4.5", "--k-beta", "4.5", "--lever-arm", "0.35,0,-0.02")
Run = Callable[..., str]  # an app's verb in the flight's folder -> its standard output


@dataclass(frozen=True)
class Case:
    """A calibration of a simulated flight, and an effect to add to it."""

    app: str
    flight: tuple[str, ...]  # of simulate
    fit: tuple[str, ...]  # of fit, in the words of version 1; none where Python wrote it
    effect: str


WINDY = ("--seed", "7", "--hide", "wind[altitude_m]=0.03:0.01", "--hide", "propwash=40")
BENT = ("--seed", "9", "--hide", "bias[current_a]=0.2:-0.1:0.15")
CASES = {
    "five_hole": Case(
        "sepcal-pitot",
        WINDY,
        (
            *(*FIVE_HOLE, "--effect", "wind[altitude_m]", "--samples", "60"),
            *("--know", "eps_phi=0.05:0.02", "--know", "b_va=0.4:0.5"),
        ),
        "propwash",
    ),
    "tube": Case(
        "sepcal-pitot",
        ("--probe", "pitot-static", "--seed", "8", "--noise", "ar", "--hide", "propwash=30"),
        ("--probe", "pitot-static", "--know", "c_va=0:2", "--bounds", "w_n=-40,40"),
        "pressure_offset[throttle]",
    ),
    "magnetometer": Case(
        "sepcal-mag", BENT, ("--effect", "bias[current_a]", "--loss", "huber"), "bias[time]"
    ),
    "field_strength": Case(
        "sepcal-mag", BENT, ("--field-strength", "53.2", "--know", "n_x=0:100"), "bias[current_a]"
    ),
    "drawn_samples": Case("sepcal-pitot", WINDY, (), "wind[altitude_m]"),
}
# Only Python gives what samples are drawn from: `priors` in version 1.
DRAWN: dict[str, Any] = {
    "knowledge": {"eps_phi": (0.05, 0.02), "b_va": (0.4, 0.5)},
    "priors": {"b_beta": (0.01, 0.02), "eps_phi": (0.0, 0.1)},
    "samples": 60,
}


def simulate(case: Case, run: Run) -> None:
    """Writes the case's flight.csv, the same to the last bit whenever."""
    run(case.app, "simulate", "-o", "flight.csv", "--rows", "300", *case.flight)


def ask(case: Case, run: Run, folder: Path) -> dict[str, Any]:
    """What compare, apply and add say of flight.csv and base.json in `folder`."""
    texts = {
        "compare": run(case.app, "compare", "flight.csv", "base.json"),
        "apply": run(case.app, "apply", "flight.csv", "base.json", "-o", "corrected.csv"),
        "add": run(case.app, "add", "flight.csv", "base.json", case.effect, "-o", "next.json"),
    }
    compared = json.loads(run(case.app, "compare", "flight.csv", "base.json", "--json"))
    added = json.loads((folder / "next.json").read_text())
    with (folder / "corrected.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))[::EVERY]
    corrected = [name for name in rows[0] if "_cal_" in name]
    return {
        "texts": texts,
        "rmse": compared["rmse"],
        "corrected": {name: [float(row[name]) for row in rows] for name in corrected},
        "added": {
            name: [entry["value"], entry["standard_error"]]
            for name, entry in added["parameters"].items()
        },
    }


def record(apps: Path) -> None:
    """Fits every case and writes what came of it."""
    recorded = {}
    for name, case in CASES.items():
        with tempfile.TemporaryDirectory() as at:
            folder = Path(at)

            def run(app: str, *arguments: str, folder: Path = folder) -> str:
                command = [str(apps / app), *arguments]
                return subprocess.run(
                    command, cwd=folder, check=True, capture_output=True, text=True
                ).stdout

            simulate(case, run)
            if case.fit:
                run(case.app, "fit", "flight.csv", "-o", "base.json", *case.fit)
            else:
                _fit_in_python(folder)
            recorded[name] = ask(case, run, folder)
            shutil.copy(folder / "base.json", HERE / f"{name}.json")
    (HERE / "recorded.json").write_text(json.dumps(recorded, indent=1) + "\n")


def _fit_in_python(folder: Path) -> None:
    import sepcal  # of the release that is recorded

    probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
    with contextlib.chdir(folder):
        sepcal.fit(probe, sepcal.read_csv("flight.csv"), **DRAWN).save("base.json")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit((__doc__ or "").strip())
    record(Path(sys.argv[1]).resolve())
