# SPDX-License-Identifier: BSD-3-Clause
"""A damaged or forged log through `python -m sepcal log`: one line of error, or a page and a table.

What is written reads back the same by Python's own csv and json.
"""

from __future__ import annotations

import contextlib
import csv
import io
import json
import math
from collections.abc import Hashable
from pathlib import Path

from mutation import check_message, check_printed

import sepcal
from sepcal.__main__ import main as run_sepcal

OUTPUTS = (Path("flight.csv"), Path("flight.csv.json"))


def run(*arguments: str) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of the command in this process."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = run_sepcal(["log", *arguments])
    check_printed(out.getvalue())
    check_printed(err.getvalue())
    return code, out.getvalue(), err.getvalue()


def check_refusal(code: int, out: str, err: str) -> str:
    """One line on standard error and nothing else; returns its kind."""
    assert (code, out) == (2, ""), (code, out)
    assert err.endswith("\n")
    return check_message(err[:-1])


def check_list(file: str) -> Hashable:
    """The page of what is in the log, and the same as JSON."""
    code, out, err = run(file, "--list", "--cut-off")
    if code != 0:
        return check_refusal(code, out, err)
    again, told, _ = run(file, "--list", "--cut-off", "--json")
    assert again == 0
    sensors = json.loads(told)["sensors"]
    assert len([sensor for sensor in sensors if sensor["name"] in out]) == len(sensors)
    return len(sensors)


def check_flight(file: str) -> Hashable:
    """The table and what is beside it."""
    for output in OUTPUTS:
        output.unlink(missing_ok=True)
    code, out, err = run(file, "-o", "flight.csv", "--cut-off", "--no-field")
    if code != 0:
        assert not any(output.exists() for output in OUTPUTS)
        return check_refusal(code, out, err)
    told = json.loads(OUTPUTS[1].read_text(encoding="utf-8"))
    with OUTPUTS[0].open(encoding="utf-8", newline="") as opened:
        header, *rows = list(csv.reader(opened, strict=True))
    assert len(rows) == told["rows"] > 0
    assert all(len(row) == len(header) for row in rows)
    flight = sepcal.read_csv(OUTPUTS[0])
    assert [*flight.columns] == [name for name in header if name != "maneuver"]
    for at, name in enumerate(header):
        cells = [row[at] for row in rows]
        if name == "maneuver":
            assert cells == flight.maneuvers
            continue
        for cell, value in zip(cells, flight[name], strict=True):
            assert math.isnan(value) if cell == "" else float(cell) == value
    return (*header,)


def check_log(name: str, data: bytes) -> Hashable:
    """Of a file of that name."""
    Path(name).write_bytes(data)
    return check_list(name), check_flight(name)
