# SPDX-License-Identifier: BSD-3-Clause
"""Bad calibrations: what apply and compare say of a JSON that is not theirs."""

import pytest

from apps import Bench, assert_one_line, assert_refused, read_folder


def assert_calibration_refused(bench: Bench, *words: str) -> None:
    assert_refused(bench, "apply", "flight.csv", "other.json", words=("other.json", *words))
    before = read_folder(bench.folder)
    assert_one_line(bench, bench.run("compare", "flight.csv", "other.json"), "other.json", *words)
    assert read_folder(bench.folder) == before


@pytest.mark.parametrize("version", ["0", "4", '"1"', "null"])
def test_another_schema_version(bench: Bench, version: str):
    text = (bench.folder / "base.json").read_text()
    other = text.replace('"schema_version": 3', f'"schema_version": {version}')
    assert other != text
    (bench.folder / "other.json").write_text(other)
    assert_calibration_refused(bench, f"schema version {version}", "reads 1 to 3", "fit the flight")


def test_the_other_apps_calibration(prepared: dict[str, Bench], bench: Bench):
    (other,) = (one for one in prepared.values() if one.app != bench.app)
    (bench.folder / "other.json").write_bytes((other.folder / "base.json").read_bytes())
    assert_calibration_refused(bench, other.base["model"], f"use {other.app}")


@pytest.mark.parametrize("kept", [0.0, 0.3, 0.99])
def test_a_truncated_calibration(bench: Bench, kept: float):
    text = (bench.folder / "base.json").read_text()
    (bench.folder / "other.json").write_text(text[: round(kept * len(text))])
    assert_calibration_refused(bench, "a calibration; give the JSON that fit wrote with -o")


@pytest.mark.parametrize(
    "text", ["time_s,roll_rad\n0,1\n", "[]", "1", "{}", '{"schema_version": 1}', "\x00\x01"]
)
def test_no_calibration(bench: Bench, text: str):
    (bench.folder / "other.json").write_text(text)
    assert_calibration_refused(bench, "a calibration; give the JSON that fit wrote with -o")


@pytest.mark.parametrize("key", ["options", "parameters", "status", "correlation", "stage_one"])
@pytest.mark.parametrize("damage", ["renamed", "a number", "a list"])
def test_a_damaged_calibration(bench: Bench, key: str, damage: str):
    text = (bench.folder / "base.json").read_text()
    replacement = {
        "renamed": f'"{key}_": ',
        "a number": f'"{key}": 3, "was": ',
        "a list": f'"{key}": [], "was": ',
    }[damage]
    other = text.replace(f'\n  "{key}": ', "\n  " + replacement)
    assert other != text
    (bench.folder / "other.json").write_text(other)
    assert_calibration_refused(bench, "damaged", "fit the flight again")


def test_no_such_calibration(bench: Bench):
    assert_calibration_refused(bench, "a calibration; give the JSON that fit wrote with -o")
