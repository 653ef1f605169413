# SPDX-License-Identifier: BSD-3-Clause
"""Bad logs: exit 2, one line that names file, line or column and the way out; nothing written."""

from collections.abc import Callable

import numpy as np
import pytest

from apps import Bench, Log, assert_one_line, assert_refused, read_folder


def assert_log_refused(bench: Bench, flight: str, *words: str) -> None:
    """By every verb that reads a log; compare has no output of its own."""
    assert_refused(bench, "fit", flight, *bench.options, words=words)
    assert_refused(bench, "apply", flight, "base.json", words=words)
    before = read_folder(bench.folder)
    assert_one_line(bench, bench.run("compare", flight, "base.json"), *words)
    assert read_folder(bench.folder) == before


# --- text that is no table: every verb that reads a log refuses it


def spoil_header(log: Log) -> str:
    log.headers[log.index("current_a")] = "roll_rad"
    return log.text()


def blank_header(log: Log) -> str:
    log.headers[log.index("current_a")] = " "
    return log.text()


def shorten_row(log: Log) -> str:
    del log.rows[5][-1]
    return log.text()


def lengthen_row(log: Log) -> str:
    log.rows[5].append("1")
    return log.text()


def write_decimal_comma(log: Log) -> str:
    log.put(7, "roll_rad", "0,5")
    return log.text()


def insert_blank_line(log: Log) -> str:
    lines = log.text().splitlines(keepends=True)
    return "".join([*lines[:6], "\n", *lines[6:]])


def open_quote(log: Log) -> str:
    log.put(7, "maneuver", '"turn')
    return log.text()


NO_TABLES: dict[str, tuple[Callable[[Log], str | bytes], tuple[str, ...]]] = {
    "open quote": (open_quote, ("line 7", "never closed", "ends on its line")),
    "binary": (lambda log: b"\x89PNG\r\n\x1a\n" + bytes(range(256)), ("no text", "CSV file?")),
    "binary amid text": (
        lambda log: log.text().encode()[:-40] + b"\x00\xff" + log.text().encode()[-40:],
        ("line ", "byte 0x00", "CSV file?"),
    ),
    "no line end": (lambda log: b"x" * (2 << 20), ("line 1", "longer than 1 MiB", "CSV file?")),
    "empty": (lambda log: "", ("empty", "name the columns")),
    "header only": (lambda log: log.text().splitlines()[0] + "\n", ("header", "no row of data")),
}
# Read with a note, which says how.
ODD_TABLES: dict[str, tuple[Callable[[Log], str | bytes], str]] = {
    "column without a name": (blank_header, "a column without a name is column_"),
    "blank line": (insert_blank_line, "line 7 is blank and is passed"),
    "semicolons": (lambda log: log.text(";"), "semicolons part the columns"),
    "tabs": (lambda log: log.text("\t"), "tabs part the columns"),
    "UTF-16": (lambda log: log.text().encode("utf-16"), "the text is UTF-16"),
}
# Refused by a fit, at the row that has no values.
BROKEN_ROWS: dict[str, tuple[Callable[[Log], str], tuple[str, ...]]] = {
    "short row": (shorten_row, ("line 7", "cells in a row of", "--drop-invalid")),
    "long row": (lengthen_row, ("line 7", "cells in a row of", "--drop-invalid")),
    "decimal comma": (write_decimal_comma, ("line 7", "cells in a row of", "--drop-invalid")),
    "duplicate column": (spoil_header, ("missing", "roll_rad.")),
}


@pytest.mark.parametrize("kind", NO_TABLES)
def test_no_table(bench: Bench, kind: str):
    spoil, words = NO_TABLES[kind]
    spoilt = spoil(bench.read_log())
    data = spoilt if isinstance(spoilt, bytes) else spoilt.encode()
    (bench.folder / "spoilt.csv").write_bytes(data)
    assert_log_refused(bench, "spoilt.csv", "spoilt.csv", *words)


@pytest.mark.parametrize("kind", ODD_TABLES)
def test_an_odd_table_is_read_with_a_note(bench: Bench, kind: str):
    spoil, note = ODD_TABLES[kind]
    spoilt = spoil(bench.read_log())
    data = spoilt if isinstance(spoilt, bytes) else spoilt.encode()
    (bench.folder / "odd.csv").write_bytes(data)
    result = bench.run("fit", "odd.csv", *bench.options)
    assert result.code == 0
    assert note in result.err


@pytest.mark.parametrize("kind", BROKEN_ROWS)
def test_a_broken_row_is_refused_and_its_way_out_works(bench: Bench, kind: str):
    spoil, words = BROKEN_ROWS[kind]
    (bench.folder / "spoilt.csv").write_text(spoil(bench.read_log()))
    assert_refused(bench, "fit", "spoilt.csv", *bench.options, words=words)
    if "--drop-invalid" in words:
        assert bench.run("fit", "spoilt.csv", *bench.options, "--drop-invalid").code == 0


def test_no_such_file(bench: Bench):
    assert_log_refused(bench, "nowhere.csv", "nowhere.csv: no such file")


def test_a_folder_for_a_file(bench: Bench):
    (bench.folder / "logs").mkdir()
    assert_log_refused(bench, "logs", "logs: is a folder", "name a CSV file")


# --- tables that are no flight: a fit refuses them


def repeat_time(log: Log) -> None:
    log.put(9, "time_s", log.rows[6][log.index("time_s")])


def run_back(log: Log) -> None:
    log.put(9, "time_s", "0.001")


def empty_density(log: Log) -> None:
    for header in ("rho_kgpm3", "temp_k"):
        log.drop(header)


def stop_air(share: float) -> Callable[[Log], None]:
    """Total below static pressure in that share of the rows, from the third on."""

    def spoil(log: Log) -> None:
        for row in log.rows[1 : 1 + round(share * len(log.rows))]:
            row[log.index("pt_pa")] = "90000"

    return spoil


BOTH = ("sepcal-pitot", "sepcal-mag")
NO_FLIGHTS: dict[str, tuple[tuple[str, ...], Callable[[Log], object], tuple[str, ...]]] = {
    "missing time": (BOTH[:1], lambda log: log.drop("time_s"),
                     ("column 'time_s' is missing", "the file has: ", "p_radps, q_radps")),
    "missing pressure": (BOTH[:1], lambda log: log.drop("dpb_pa"),
                         ("column 'dpb_pa' is missing", "the file has: time_s, ")),
    "missing rate for the lever arm": (BOTH[:1], lambda log: log.drop("q_radps"),
                                       ("column 'q_radps' is missing", "the file has: time_s, ")),
    "missing density": (BOTH[:1], empty_density,
                        ("density is missing", "rho_kgpm3 or temp_k", "the file has: ")),
    "missing reading": (BOTH[1:], lambda log: log.drop("mz_ut"),
                        ("column 'mz_ut' is missing", "the file has: time_s, ")),
    "missing field": (BOTH[1:], lambda log: log.drop("be_ut"),
                      ("true field is missing", "--field N,E,D", "the file has: time_s, ")),
    "unknown unit": (BOTH, lambda log: log.replace("roll_rad", log.column("roll_rad"), "roll_grad"),
                     ("column 'roll_grad'", "unit", "roll_rad, roll_deg")),
    "two units": (BOTH, lambda log: log.add("roll_deg", np.zeros(len(log.rows))),
                  ("roll_rad", "roll_deg", "twice", "--ignore roll_deg leaves one out")),
    "word": (BOTH, lambda log: log.put(9, "pitch_rad", "level"),
             ("line 9", "column 'pitch_rad' holds 'level'", "--drop-invalid")),
    "NaN": (BOTH, lambda log: log.put(9, "pitch_rad", "NaN"),
            ("line 9", "column 'pitch_rad' holds 'NaN'", "--drop-invalid")),
    "infinity": (BOTH, lambda log: log.put(9, "pitch_rad", "inf"),
                 ("line 9", "column 'pitch_rad' holds 'inf'", "--drop-invalid")),
    "empty cell": (BOTH, lambda log: log.put(9, "pitch_rad", ""),
                   ("line 9", "column 'pitch_rad' is empty", "--drop-invalid")),
    "negative density": (BOTH[:1], lambda log: log.put(9, "rho_kgpm3", "-1.2"),
                         ("line 9", "rho is not positive", "--drop-invalid")),
    "time repeats": (BOTH, repeat_time, ("line 9", "time_s repeats", "must increase", "sort")),
    "time runs back": (BOTH, run_back, ("line 9", "time_s runs back", "must increase", "sort")),
    "total below static in 21 %": (BOTH[:1], stop_air(0.21),
                                   ("84 of 400 rows", "a fifth", "line 3", "check the two")),
}  # fmt: skip


@pytest.mark.parametrize(
    ("app", "kind"), [(app, kind) for kind, (apps, *_) in NO_FLIGHTS.items() for app in apps]
)
def test_no_flight(request: pytest.FixtureRequest, app: str, kind: str):
    bench: Bench = request.getfixturevalue("pitot" if app == "sepcal-pitot" else "magnetometer")
    _, spoil, words = NO_FLIGHTS[kind]
    log = bench.read_log()
    spoil(log)
    (bench.folder / "spoilt.csv").write_text(log.text())
    assert_refused(bench, "fit", "spoilt.csv", *bench.options, words=("spoilt.csv", *words))
    before = read_folder(bench.folder)
    assert_one_line(bench, bench.run("compare", "spoilt.csv", "base.json"), "spoilt.csv", *words)
    assert read_folder(bench.folder) == before


@pytest.mark.parametrize("parameters_less_rows", [0, 1])
def test_fewer_rows_than_parameters(bench: Bench, parameters_less_rows: int):
    """As many rows as parameters are the fewest that are taken."""
    log = bench.read_log()
    parameters = len(bench.base["parameters"])
    rows = parameters - parameters_less_rows
    step = len(log.rows) // rows
    log.rows = log.rows[::step][:rows]
    (bench.folder / "few.csv").write_text(log.text())
    if parameters_less_rows == 0:
        assert bench.fit(flight="few.csv").code in (0, 4, 5)
        return
    words = ("few.csv", f"{rows} usable rows", f"the {parameters} parameters", "log more", "--fix")
    assert_refused(bench, "fit", "few.csv", *bench.options, words=words)


@pytest.mark.parametrize("share", [0.0025, 0.2])
def test_total_below_static_pressure_is_dropped_and_counted(pitot: Bench, share: float):
    """Up to a fifth of the rows: a note says how many, the JSON too, apply leaves them empty."""
    log = pitot.read_log()
    stop_air(share)(log)
    (pitot.folder / "gusty.csv").write_text(log.text())
    lost = round(share * 400)
    fitted = pitot.fit(flight="gusty.csv")
    assert fitted.code == 0, fitted.err
    assert fitted.err == f"note: gusty.csv: {lost} of 400 rows were dropped: pt is not above ps\n"
    assert fitted.result["inputs"]["rows"] == 400
    assert fitted.result["inputs"]["rows_used"] == 400 - lost

    applied = pitot.run("apply", "gusty.csv", "base.json", "-o", "corrected.csv")
    assert applied.code == 0
    assert applied.err == (
        f"note: gusty.csv: {lost} of 400 rows can't be calibrated: pt is not above ps\n"
    )
    corrected = Log(pitot.folder / "corrected.csv")
    empty = [row[-3:] == ["", "", ""] for row in corrected.rows]
    assert empty == [False] + [True] * lost + [False] * (399 - lost)


def test_drop_invalid_drops_and_counts(bench: Bench):
    """The estimate is that of the log without these rows, and the calibration keeps the option."""
    log = bench.read_log()
    for line, cell in ((9, "level"), (12, ""), (13, "nan"), (40, "-inf")):
        log.put(line, "pitch_rad", cell)
    (bench.folder / "holes.csv").write_text(log.text())
    fitted = bench.fit("--drop-invalid", "-o", "holes.json", flight="holes.csv")
    assert fitted.code == 0
    assert fitted.err == (
        f"note: holes.csv: 4 of {len(log.rows)} rows were dropped: "
        "a cell of a needed column is no finite number\n"
    )
    assert fitted.result["inputs"]["rows_used"] == len(log.rows) - 4
    assert fitted.result["options"]["drop_invalid"] is True
    assert bench.run("compare", "holes.csv", "holes.json").code == 0

    for line in (40, 13, 12, 9):
        del log.rows[line - 2]
    (bench.folder / "whole.csv").write_text(log.text())
    assert fitted.result["parameters"] == bench.fit(flight="whole.csv").result["parameters"]


def test_text_in_a_column_that_nothing_needs(bench: Bench):
    """An effect takes the value between its neighbours; where it is in many rows there is none."""
    log = bench.read_log()
    log.put(9, "current_a", "n/a")
    (bench.folder / "spare.csv").write_text(log.text())
    fitted = bench.fit(flight="spare.csv")
    assert fitted.code == 0
    assert fitted.err == (
        f"note: spare.csv: column 'current_a' has no reading in 1 of {len(log.rows)} rows, "
        "first at line 9 (1 without a number): an effect takes the value between its neighbours "
        "there\n"
    )
    assert fitted.result["parameters"] == bench.base["parameters"]
    for line in range(10, 70):
        log.put(line, "current_a", "n/a")
    (bench.folder / "spare.csv").write_text(log.text())
    assert bench.fit(flight="spare.csv").err == (
        "note: spare.csv: column 'current_a' can't drive an effect: "
        "at spare.csv line 9 it holds 'n/a'\n"
    )
