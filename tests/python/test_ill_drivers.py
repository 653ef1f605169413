# SPDX-License-Identifier: BSD-3-Clause
"""Drivers without a number or called as readings are, and what contradicts itself."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sepcal

TUBE = sepcal.PitotStatic()
MAG = sepcal.Magnetometer(field=[19.7, -1.4, 49.4])


def renamed(flight: sepcal.Flight, old: str, new: str) -> sepcal.Flight:
    columns = {header: np.asarray(flight[header]) for header in flight}
    return sepcal.Flight({new if header == old else header: columns[header] for header in columns})


def load(file: Path) -> sepcal.Calibration:
    found = sepcal.load(file)
    assert isinstance(found, sepcal.Calibration)
    return found


@pytest.fixture(scope="module")
def tube() -> sepcal.Flight:
    return sepcal.simulate(TUBE, rows=400, seed=1)


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The calibration of a compass beside a current."""
    file = tmp_path_factory.mktemp("base") / "base.json"
    flight = sepcal.simulate(MAG, rows=400, seed=1)
    sepcal.fit(MAG, flight, effects=["bias[current_a]"]).save(file)
    return file


@pytest.mark.parametrize("dead", [np.nan, np.inf])
def test_a_driver_without_a_number_is_named(base: Path, dead: float) -> None:
    flight = sepcal.simulate(MAG, rows=60, seed=2)
    columns = {header: np.array(flight[header]) for header in flight}
    columns["current_a"][:] = dead
    with pytest.raises(
        sepcal.Error, match=r"bias\[current_a\]: no row has a number of 'current_a'"
    ):
        load(base).apply(sepcal.Flight(columns))


@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("name", ["alpha", "beta", "pt_pa", "mx", "errno", "stdout"])
def test_a_driver_may_be_called_as_another_probe_reads(
    tube: sepcal.Flight, tmp_path: Path, name: str, single: bool
) -> None:
    flight = renamed(tube, "current_a", name)
    found = sepcal.fit(TUBE, flight, effects=[f"airspeed_scale[{name}]"])
    header = tmp_path / "tube.h"
    sepcal.export(found, header, "c", single=single)
    program = tmp_path / "tube.c"
    text = header.read_text()
    test = next(word for word in text.split() if "self_test" in word).split("(")[0]
    includes = '#include <errno.h>\n#include <stdio.h>\n#include "tube.h"\n'
    program.write_text(f"{includes}int main(void) {{ return {test}(); }}\n")
    command = ["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", str(program), "-lm"]
    subprocess.run([*command, "-o", str(tmp_path / "tube")], check=True)
    subprocess.run([str(tmp_path / "tube")], check=True)


@pytest.mark.parametrize(("change", "said"), [
    (lambda root: root["driver_ranges"].update(current_a=[-1e308, 1e308]), "two numbers within"),
    (lambda root: root["driver_ranges"].update(current_a=[1, 2, 3]), "two numbers within"),
    (lambda root: root["options"].update(effects=[]), "an effect that it does not list"),
    (lambda root: root["options"]["effects"].extend(root["options"]["effects"]), "twice"),
])  # fmt: skip
def test_a_calibration_that_contradicts_itself_is_damaged(
    base: Path, tmp_path: Path, change: Callable[[dict[str, Any]], None], said: str
) -> None:
    root = json.loads(base.read_text())
    change(root)
    file = tmp_path / "changed.json"
    file.write_text(json.dumps(root))
    with pytest.raises(sepcal.Error, match=f"is damaged: .*{said}"):
        sepcal.load(file)


def test_a_file_that_ends_at_a_nul_is_no_other_file(base: Path, tmp_path: Path) -> None:
    kept = tmp_path / "kept.csv"
    kept.write_text("old")
    with pytest.raises(sepcal.Error, match="can't hold a NUL"):
        load(base).save(f"{kept}\0.json")
    with pytest.raises(sepcal.Error, match="can't hold a NUL"):
        sepcal.export(load(base), f"{kept}\0.h", "c")
    assert kept.read_text() == "old"
