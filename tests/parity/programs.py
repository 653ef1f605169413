# SPDX-License-Identifier: BSD-3-Clause
"""The programs of the apps' build folder, and files for them."""

import subprocess
from pathlib import Path

import sepcal
from apps import APPS

BUILD = APPS.parent


def run(*command: str | Path) -> str:
    """Standard output of a program that must succeed."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def write_flight(flight: sepcal.Flight, file: Path) -> None:
    """A CSV whose cells read back as the same doubles."""
    columns = [*([repr(float(x)) for x in flight[name]] for name in flight), flight.maneuvers]
    rows = [",".join(cells) for cells in zip(*columns, strict=True)]
    file.write_text("\n".join([",".join([*flight, "maneuver"]), *rows]) + "\n")
