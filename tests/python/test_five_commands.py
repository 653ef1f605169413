# SPDX-License-Identifier: BSD-3-Clause
"""From `sepcal --help` to a calibration in five commands at most, as docs/commands.md shows it."""

import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from documents import ROOT
from flown_logs import write_logs
from mutated_forms import TRUTH, fly

PAGE = (ROOT / "docs" / "commands.md").read_text()
SESSIONS = [
    re.findall(r"^    (sepcal .*)$", block, re.M)
    for block in PAGE.partition("## From a log to a calibration")[2]
    .partition("\n## ")[0]
    .split("\n\n")
    if block.startswith("    sepcal --help")
]


def type_session(lines: list[str], folder: Path) -> list[str]:
    """What each command of a session prints; `sepcal` is Python's."""
    paths = os.pathsep.join(path for path in sys.path if path)
    printed = []
    for line in lines:
        done = subprocess.run(
            [sys.executable, "-m", *line.split()],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": paths},
            capture_output=True,
            text=True,
            check=False,
            timeout=300,
        )
        assert done.returncode in (0, 3, 6), (line, done.stderr)
        printed.append(done.stdout)
    return printed


def session(word: str) -> list[str]:
    """The one that has the word."""
    (found,) = [lines for lines in SESSIONS if any(word in line for line in lines)]
    assert len(found) <= 5
    return found


def test_of_a_bench_table(tmp_path: Path) -> None:
    """Readings on a sphere of 48.9 uT, turned in all directions, with a bias of 12, -7, 5 uT."""
    rows = ["time_s,mx_ut,my_ut,mz_ut"]
    for k in range(400):
        height = 1.0 - (2 * k + 1) / 400
        angle = 2.399963 * k
        width = (1.0 - height**2) ** 0.5
        direction = (width * math.cos(angle), width * math.sin(angle), height)
        x, y, z = (48.9 * d + b for d, b in zip(direction, (12.0, -7.0, 5.0), strict=True))
        noise = [0.05 * ((k * 7919 * (j + 1)) % 1000 / 500 - 1) for j in range(3)]
        rows.append(f"{0.1 * k:.1f},{x + noise[0]:.4f},{y + noise[1]:.4f},{z + noise[2]:.4f}")
    (tmp_path / "bench.csv").write_text("\n".join(rows) + "\n")
    type_session(session("bench.csv"), tmp_path)
    found = json.loads((tmp_path / "base.json").read_text())["parameters"]
    for name, bias in (("n_x", 12.0), ("n_y", -7.0), ("n_z", 5.0)):
        assert found[name]["value"] == pytest.approx(bias, abs=0.05)


@pytest.mark.parametrize(
    ("word", "log"), [("flight.ulg", "corrected.ulg"), ("flight.bin", "new.bin")]
)
def test_of_an_autopilot_s_log(word: str, log: str, tmp_path: Path) -> None:
    for module in ("pyulog", "pymavlink", "pygeomag"):
        pytest.importorskip(module)
    (tmp_path / "logs").mkdir()
    logs = write_logs(tmp_path / "logs")
    names = sorted(file.name for file in logs.iterdir())
    assert log in names, names
    (tmp_path / word).write_bytes((logs / log).read_bytes())
    printed = type_session(session(word), tmp_path)
    assert "mag0" in printed[1]
    assert "status: converged" in printed[2]


def test_of_an_avionics_maker_s_log(tmp_path: Path) -> None:
    """A row a second of a Garmin G1000: speed and track, knots, feet, a row of units."""
    flown = fly()
    rows = [
        '#airframe_info, log_version="1.00", airframe_name="Cessna 172S"',
        "#yyy-mm-dd, hh:mm:ss, hh:mm, degrees, degrees, ft Baro, kt, kt, fpm, deg",
        "  Lcl Date, Lcl Time, UTCOfst, Latitude, Longitude, AltB, TAS, GndSpd, VSpd, TRK",
    ]
    knot = 1852 / 3600
    for k, (north, east, read) in enumerate(
        zip(flown["vn_mps"], flown["ve_mps"], flown["airspeed_mps"], strict=True)
    ):
        clock = f"{14 + k // 3600:02d}:{k // 60 % 60:02d}:{k % 60:02d}"
        speed, track = math.hypot(north, east) / knot, math.degrees(math.atan2(east, north)) % 360
        cells = f"2023-05-03, {clock}, -04:00, +44.1234567, -73.1234567, 2500.1"
        rows.append(f"{cells}, {read / knot:.3f}, {speed:.3f}, 0.00, {track:.3f}")
    (tmp_path / "log_230503.csv").write_text("\n".join(rows) + "\n")
    type_session(session("log_230503.csv"), tmp_path)
    found = json.loads((tmp_path / "base.json").read_text())["parameters"]
    for name, truth in TRUTH.items():
        assert abs(found[name]["value"] - truth) < 4 * found[name]["standard_error"], name
