# SPDX-License-Identifier: BSD-3-Clause
"""Logs longer than memory: --stream takes as much of it for a long log as for a short one."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

from apps import APPS, parse_json, run
from benchmarks.baseline import spend

SHORT = 150_000
LONG = 1_500_000


def write_log(file: Path, rows: int) -> None:
    """Readings of a sensor that is off by scale and hard iron, in an attitude that goes round."""
    random = np.random.default_rng(7)
    turn = np.linspace(0, 40 * np.pi, 10_000)
    field = 50 * np.column_stack(
        [np.cos(turn) * np.cos(turn / 7), np.sin(turn) * np.cos(turn / 7), np.sin(turn / 7)]
    )
    read = 1.02 * field + [1.0, -2.0, 3.0] + 0.1 * random.standard_normal(field.shape)
    cells = [
        ",".join(f"{value:.3f}" for value in (*true, *seen))
        for true, seen in zip(field, read, strict=True)
    ]
    with file.open("w") as log:
        log.write("time_s,hx_ut,hy_ut,hz_ut,mx_ut,my_ut,mz_ut\n")
        for first in range(0, rows, len(cells)):
            log.writelines(f"{(first + i) / 100},{row}\n" for i, row in enumerate(cells))


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("logs")
    write_log(folder / "short.csv", SHORT)
    write_log(folder / "long.csv", LONG)
    return folder


@pytest.mark.slow
def test_memory_does_not_grow_with_the_log(logs: Path):
    mag = APPS / "sepcal-mag"
    peaks = [
        spend([mag, "fit", logs / f"{name}.csv", "--stream", "--samples", "8",
               "-o", logs / f"{name}.json"]).kilobytes
        for name in ("short", "long")
    ]  # fmt: skip
    assert peaks[1] < 1.2 * peaks[0]
    long = json.loads((logs / "long.json").read_text())
    assert f"noise model is from 100000 of {LONG} rows" in long["message"]
    peaks = [
        spend([mag, "apply", logs / f"{name}.csv", logs / "short.json", "--stream",
               "-o", logs / f"{name}_out.csv"]).kilobytes
        for name in ("short", "long")
    ]  # fmt: skip
    assert peaks[1] < 1.2 * peaks[0]


def test_estimates_are_those_of_the_whole_log(logs: Path):
    fits = [
        parse_json(run("sepcal-mag", "fit", "short.csv", "--samples", "8", "--json", *how,
                       folder=logs).out)
        for how in ((), ("--stream",))
    ]  # fmt: skip
    assert fits[0]["parameters"].keys() == fits[1]["parameters"].keys()
    for name, whole in fits[0]["parameters"].items():
        streamed = fits[1]["parameters"][name]
        assert streamed["value"] == whole["value"]
        # Which of two errors to believe is asked of the blocks of the whole log alone.
        assert 0.4 < streamed["standard_error"] / whole["standard_error"] < 2.5


def test_apply_gives_the_same_file(logs: Path):
    run("sepcal-mag", "fit", "short.csv", "--samples", "8", "-o", "base.json", folder=logs)
    for name, how in (("whole.csv", ()), ("streamed.csv", ("--stream",))):
        done = run("sepcal-mag", "apply", "short.csv", "base.json", "-o", name, *how, folder=logs)
        assert done.code == 0
    assert (logs / "whole.csv").read_bytes() == (logs / "streamed.csv").read_bytes()


def test_a_folder_without_room_is_one_line(logs: Path):
    done = subprocess.run(
        [APPS / "sepcal-mag", "fit", "short.csv", "--stream"],
        cwd=logs, env={"TMPDIR": "/nowhere"}, capture_output=True, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    assert b"name a folder with room for them in TMPDIR" in done.stderr
