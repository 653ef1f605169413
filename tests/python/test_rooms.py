# SPDX-License-Identifier: BSD-3-Clause
"""The rooms of the C++ sources keep to cpp/rooms.toml, and the check sees one that doesn't."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CHECK = [sys.executable, str(ROOT / "scripts/parts/rooms.py"), "check"]


def check(folder: Path) -> subprocess.CompletedProcess[str]:
    """Every include of the sources in `folder` against its table."""
    return subprocess.run([*CHECK, str(folder)], capture_output=True, text=True, check=False)


@pytest.fixture
def copied(tmp_path: Path) -> Path:
    """The sources, to be spoilt."""
    folder = tmp_path / "cpp"
    shutil.copytree(ROOT / "cpp", folder)
    return folder


def test_every_include_goes_the_right_way():
    done = check(ROOT / "cpp")
    assert done.stdout == ""
    assert done.returncode == 0


@pytest.mark.parametrize(
    ("file", "include", "complaint"),
    [
        (
            "src/numerics/basins.cpp",
            "estimation/problem.hpp",
            "numerics may not include estimation",
        ),
        ("src/simulation/wander.cpp", "sepcal/fit.hpp", "simulation may not include estimation"),
        (
            "include/sepcal/record.hpp",
            "sepcal/detail/block_model.hpp",
            "base may not include model",
        ),
        ("src/diagnosis/trial.cpp", "many/split.hpp", "diagnosis may not include many"),
        ("src/noise/whitener.cpp", "somewhere/else.hpp", "is in no room"),
    ],
)
def test_a_planted_wrong_way_include_is_named(
    copied: Path, file: str, include: str, complaint: str
):
    with (copied / file).open("a") as source:
        source.write(f'#include "{include}"\n')
    done = check(copied)
    assert done.returncode == 1
    assert len(done.stdout.splitlines()) == 1
    assert complaint in done.stdout
    assert include in done.stdout


@pytest.mark.parametrize(
    "line",
    [
        "#include <sepcal/fit.hpp>",
        '#  include "sepcal/fit.hpp"',
        "  # include <sepcal/fit.hpp>",
        "#include <estimation/problem.hpp>",
    ],
)
def test_however_an_include_is_written(copied: Path, line: str):
    with (copied / "src/base/utf8.cpp").open("a") as source:
        source.write(f"{line}\n")
    assert "base may not include estimation" in check(copied).stdout


def test_a_grant_that_nobody_uses_is_named(copied: Path):
    table = copied / "rooms.toml"
    head = "[diagnosis] # which effect is missing\nmay_include = ["
    text = table.read_text()
    assert head in text
    table.write_text(text.replace(head, head + '"many", '))
    assert check(copied).stdout == "rooms.toml: diagnosis may include many and doesn't\n"


def test_a_file_without_a_room_is_named(copied: Path):
    (copied / "src/lost.cpp").write_text("")
    assert "src/lost.cpp: it has no room" in check(copied).stdout
