# SPDX-License-Identifier: BSD-3-Clause
"""A sensor that is slower than the log leaves cells empty: what is said, and what it leads to."""

import csv
from pathlib import Path

from apps import run


def write_rows(file: Path, rows: list[list[str]]) -> None:
    with file.open("w", newline="") as stream:
        csv.writer(stream, lineterminator="\n").writerows(rows)


def test_a_path_without_a_slow_vane_says_which_log_has_it(tmp_path: Path) -> None:
    run("sepcal-aircraft", "simulate", "-o", "flight.csv", "--seed", "2", folder=tmp_path)
    with (tmp_path / "flight.csv").open(newline="") as stream:
        header, *rows = csv.reader(stream)
    vane = header.index("alpha_rad")
    for number, row in enumerate(rows):
        if number % 5:
            row[vane] = ""
    write_rows(tmp_path / "slow.csv", [header, *rows])
    fitted = run("sepcal-aircraft", "fit", "slow.csv", "--model", "path", folder=tmp_path)
    assert fitted.code == 0
    assert (
        f"column 'alpha_rad' is not used: is empty; {len(rows[::5])} of {len(rows)} rows have a "
        "number there, and a log of these rows alone has the column"
    ) in fitted.err
    write_rows(tmp_path / "advised.csv", [header, *rows[::5]])
    advised = run(
        "sepcal-aircraft", "fit", "advised.csv", "--model", "path", "--json", folder=tmp_path
    )
    loss = advised.result["parameters"]["lambda_alpha"]
    assert abs(loss["value"]) < 3.0 * loss["standard_error"]
    refused = run("sepcal-aircraft", "fit", "slow.csv", "--model", "aero", folder=tmp_path)
    assert "--drop-invalid drops such rows" in refused.err
