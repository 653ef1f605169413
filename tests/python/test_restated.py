# SPDX-License-Identifier: BSD-3-Clause
"""Estimates in other forms: on the page, in the JSON, in Python, and what they mean."""

import json

import numpy as np
import pytest

import sepcal
from apps import Bench, Log


def test_a_matrix_and_an_offset_are_what_apply_does(magnetometer: Bench) -> None:
    correction = magnetometer.base["restated"]["correction"]
    A, b = np.reshape(correction["A"], (3, 3)), np.array(correction["b_ut"])
    log = magnetometer.read_log()
    raw = np.column_stack([log.column(f"m{axis}_ut") for axis in "xyz"])
    assert magnetometer.run("apply", "flight.csv", "base.json", "-o", "out.csv").code == 0
    written = Log(magnetometer.folder / "out.csv")
    applied = np.column_stack([written.column(f"m{axis}_cal_ut") for axis in "xyz"])
    assert (raw - b) @ A.T == pytest.approx(applied, abs=1e-9)
    page = magnetometer.run("fit", "flight.csv", *magnetometer.options).out
    assert f"correction: {correction['sentence']}" in page


def test_a_wind_is_told_as_pilots_tell_it(pitot: Bench) -> None:
    wind = pitot.base["restated"]["wind"]
    w_n, w_e = (pitot.base["parameters"][name]["value"] for name in ("w_n", "w_e"))
    assert wind["speed_mps"] == pytest.approx(np.hypot(w_n, w_e))
    assert wind["from_deg"] == pytest.approx(np.degrees(np.arctan2(-w_e, -w_n)) % 360)
    assert f"wind: {wind['sentence']}" in pitot.run("fit", "flight.csv", *pitot.options).out
    loaded = sepcal.load(pitot.folder / "base.json")
    assert loaded.restated["wind"] == wind


def test_a_wind_at_its_bound_is_none(pitot: Bench) -> None:
    held = pitot.run("fit", "flight.csv", *pitot.options, "--bounds", "w_n=40,60", "--json")
    assert held.result["parameters"]["w_n"]["at_bound"]
    assert "wind" not in held.result.get("restated", {})


def test_results_of_before_have_none(pitot: Bench) -> None:
    """A file without them is read, and later verbs go on."""
    old = pitot.base
    del old["restated"]
    (pitot.folder / "old.json").write_text(json.dumps(old))
    assert sepcal.load(pitot.folder / "old.json").restated == {}
    assert pitot.run("compare", "flight.csv", "old.json").code == 0
