# SPDX-License-Identifier: BSD-3-Clause
"""scripts/parts/house.py on a small tree that is counted by hand, and on this one."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PARTS = ROOT / "scripts" / "parts"
sys.path.insert(0, str(PARTS))

import house  # noqa: E402

TREE = {
    "apps/sepcal_pitot.cpp": '#include "instrument.hpp"\nif (probe == "aero") {}\n',
    "apps/command_line.cpp": (
        'a(cli.add_subcommand("fit", "-o,--output")), b(add_later_verb(\n  "compare", ""));\n'
        'fit.add_option("--noise-tolerance", x);\nfit.add_option("check");\n'
    ),
    "apps/sepcal_aircraft.cpp": 'for (auto* verb : {&fit}) {}\ncli.add_subcommand("apply", "");\n',
    "python/sepcal/own_commands.py": '_add(commands, "check", run)\n',
    "python/sepcal/reporting/command.py": "parser = 1\n",
    "python/sepcal/_core.pyi": "noise_tolerance: float\n",
    "python/sepcal/rivals.py": "noise_tolerance = 1\n",
    "cpp/src/bindings/engine.cpp": "#include <a>\n  # include <b>\n// the hot wire\n",
    "cpp/src/flight/hot_wire.cpp": (
        "#include <a>  // of a hot wire\nnoise_tolerance = noise_tolerance;\n"
        'if (name == "aero") {}\nint not_noise_tolerances;\n'
    ),
    "cpp/src/flight/json/fit.hpp": "// hot-wire, HotWire\n",
    "cpp/include/sepcal/fit.hpp": "",
    "cpp/include/sepcal/detail/deep/fit.hpp": "",
    "lab/tunnel.py": "HotWire()\n",
    "tests/cpp/hot_wire_test.cpp": "// hot wire, noise_tolerance\n",
    "docs/wires.md": "hotwire\n",
    "README.md": "Hot wires.\n",
}


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """What TREE says, known to git."""
    for name, text in TREE.items():
        file = tmp_path / "small" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    for arguments in (["init", "--quiet"], ["add", "."]):
        subprocess.run(["git", *arguments], cwd=tmp_path / "small", check=True)
    return tmp_path / "small"


def test_verbs_are_those_of_the_command_line_and_no_others(tree: Path) -> None:
    assert house.verbs(tree, "probes") == {"fit", "compare", "report", "save"}
    assert house.verbs(tree, "aero") == {"apply", "report"}
    assert house.verbs(tree, "own, static") == {"check"}
    assert house.loop(tree, "own, with a state") == "-"
    assert house.whole_loops(tree) == "0 of 8"


def test_files_that_name_a_subject_are_told_apart(tree: Path) -> None:
    assert house.subject_files(tree, "hot.?wire") == (
        "7: 1 own, 1 registration, 2 docs, 1 tests, 1 lab and scripts, 1 others"
    )
    assert house.subject_files(tree, "cold.?wire") == "-"


def test_what_is_generated_tested_or_a_rival_s_is_no_place_of_the_product(tree: Path) -> None:
    assert house.stands(tree, house.STANDS["option `noise_tolerance`"]) == "2 lines, 2 files"


def test_a_table_has_a_column_a_checkout_and_a_dash_for_what_is_not_there(tree: Path) -> None:
    empty = tree.parent / "empty"
    subprocess.run(["git", "init", "--quiet", empty], check=True)
    done = subprocess.run(
        [sys.executable, PARTS / "house.py", "--sizes", tree, empty],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    lines = done.stdout.splitlines()
    assert lines[:2] == ["|  | small | empty |", "| --- | --- | --- |"]
    told = dict(line.strip("| ").split(" | ", 1) for line in lines[2:])
    assert told.pop("subjects with the whole loop") == "0 of 8 | 0 of 8"
    assert {row.rsplit(" | ")[-1] for row in told.values()} == {"-"}
    for name, row in {
        "comparisons with a subject's name outside its own files": "1",
        "public headers outside detail/": "1",
        "headers in detail/": "1",
        "the aircraft's wing": "2 lines, 1 files",
        "JSON and bindings": "4 lines, 2 files",
        "cpp/src": "8 lines, 3 files",
        "includes of a file of cpp/src": "mean 1.0, most 2 (engine.cpp)",
    }.items():
        assert told[name] == f"{row} | -"


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="git tracks no file here")
@pytest.mark.parametrize("row", house.rows())
def test_a_row_finds_something_here(row: str) -> None:
    """A file that moved, or a word that was renamed, is to be followed."""
    assert house.rows()[row](ROOT) != "-"


def test_the_recipe_is_found() -> None:
    assert {"rooms.toml", "shipped_probes.cpp", "models.py"} <= house.recipe()
