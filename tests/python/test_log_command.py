# SPDX-License-Identifier: BSD-3-Clause
"""python -m sepcal log as it is typed."""

import json
import re
import subprocess
import sys

import pytest

import sepcal
from documents import ROOT
from flown_logs import write_logs

pytest.importorskip("pyulog")
pytest.importorskip("pymavlink")
pytest.importorskip("pygeomag")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return write_logs(tmp_path_factory.mktemp("logs"))


def test_every_option_is_explained():
    text = (ROOT / "docs" / "commands.md").read_text()
    for command in ("log", "field"):
        done = subprocess.run(
            [sys.executable, "-m", "sepcal", command, "--help"],
            capture_output=True,
            text=True,
            check=True,
        )
        options = set(re.findall(r"--[a-z][a-z-]*", done.stdout)) - {"--help", "--output"}
        assert {o for o in options if f"{command} {o}" not in text} == set()


def run_log(folder, *arguments):
    command = [sys.executable, "-m", "sepcal", "log", *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def test_the_command(folder, tmp_path):
    log = str(folder / "corrected.ulg")
    page = run_log(tmp_path, log, "-o", "f.csv", "--from", "30", "--to", "50")
    assert {file.name for file in tmp_path.iterdir()} == {"f.csv", "f.csv.json"}
    flight = sepcal.read_log(log, start=30, end=50)
    assert page.startswith(f"wrote f.csv: {flight.rows} rows of mag0 (magnetometer, device 197388")
    for words in (
        "undone: CAL_MAG0_?OFF, 0.11, -0.06, 0.19 G",
        "rows left out: 799, outside from 30 s to 50 s",
        "field by WMM-2020: 21.5266,1.2875,43.2224 uT",
        "also in the log: pitot0 (--sensor)",
        "next: sepcal-mag check f.csv --field-strength 48.3035",
    ):
        assert words in page
    told = run_log(tmp_path, log, "-o", "g.csv", "--from", "30", "--to", "50", "--json")
    assert json.loads(told) == flight.conversion
    assert (tmp_path / "f.csv").read_bytes() == (tmp_path / "g.csv").read_bytes()
    tube = run_log(tmp_path, log, "-o", "t.csv", "--sensor", "pitot0")
    assert "next: sepcal-pitot check t.csv" in tube


def test_the_list(folder, tmp_path):
    page = run_log(tmp_path, str(folder / "new.bin"), "--list")
    assert list(tmp_path.iterdir()) == []
    assert page == f"{sepcal.list_log(folder / 'new.bin')}\n"
    for words in (
        "DataFlash, ArduCopter V4.5.7",
        "starts 2024-03-18T08:46:",
        "undone: COMPASS_OFS, -118.4, 71.6, -196 mG",
        "disarmed",
        "sepcal-pitot fit pitot0.csv",
        "--field 21.5266,1.2875,43.2224",
    ):
        assert words in page
    told = json.loads(run_log(tmp_path, str(folder / "new.bin"), "--list", "--json"))
    modes = [(mode["maneuver"], mode["from_s"]) for mode in told["modes"]]
    assert modes == [("disarmed", 19.0), ("stabilize", 25.0), ("loiter", 50.0)]


def test_a_reader_that_has_enough(folder):
    """As with `| head`: no traceback."""
    command = f"'{sys.executable}' -m sepcal log '{folder / 'new.bin'}' --list | true"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert done.stderr == ""
