# SPDX-License-Identifier: BSD-3-Clause
"""An error that names options says the same in an app and in Python, each with its own spelling."""

import json
from collections.abc import Callable

import pytest

import sepcal
from apps import Bench, assert_one_line

MARKED = {"sepcal-pitot": "dpa_pa", "sepcal-mag": "mx_ut"}


def spoil(bench: Bench) -> None:
    """Writes holes.csv, the flight with a cell that is no number."""
    log = bench.read_log()
    log.put(9, MARKED[bench.app], "lost")
    (bench.folder / "holes.csv").write_text(log.text())


def check_spellings(
    bench: Bench, command: tuple[str, ...], work: Callable[[], object], options: dict[str, str]
) -> None:
    """`command` and `work` are refused in the same words but for the options' spelling."""
    refused = bench.run(*command)
    assert_one_line(bench, refused, *options.values())
    with pytest.raises(sepcal.Error) as caught:
        work()
    said = str(caught.value)
    for in_code, typed in options.items():
        assert typed not in said
        assert in_code in said
        said = said.replace(in_code, typed)
    assert refused.err == f"{bench.app}: {said}\n"


def test_rows_that_could_be_dropped(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(bench.folder)
    spoil(bench)
    base = sepcal.load(bench.folder / "base.json")
    holes = sepcal.read_csv("holes.csv")
    dropping = {"drop_invalid": "--drop-invalid"}
    for verb, work in (("compare", base.compare), ("diagnose", base.diagnose)):
        command = (verb, "holes.csv", "base.json")
        check_spellings(bench, command, lambda work=work: work(holes), dropping)


def test_a_damaged_calibration(pitot: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(pitot.folder)
    damaged = pitot.base
    damaged["options"]["k_alpha"] = -1.0
    (pitot.folder / "base.json").write_text(json.dumps(damaged))
    check_spellings(
        pitot,
        ("compare", "flight.csv", "base.json"),
        lambda: sepcal.load("base.json"),
        {"k_alpha": "--k-alpha"},
    )


def test_a_field_that_could_be_given(magnetometer: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(magnetometer.folder)
    log = magnetometer.read_log()
    for header in [name for name in log.headers if name.startswith(("h", "bn", "be", "bd"))]:
        log.drop(header)
    (magnetometer.folder / "flight.csv").write_text(log.text())
    check_spellings(
        magnetometer,
        ("fit", "flight.csv", "-o", "new.json"),
        lambda: sepcal.fit(sepcal.Magnetometer(), sepcal.read_csv("flight.csv")),
        {"field N,E,D": "--field N,E,D", "fit with field_strength": "fit with --field-strength"},
    )
