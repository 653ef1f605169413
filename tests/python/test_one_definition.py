# SPDX-License-Identifier: BSD-3-Clause
"""The linter of types that two files define under one name."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

CHECK = Path(__file__).parents[2] / "scripts" / "parts" / "one_definition.py"


def run(folder: Path, *sources: str) -> subprocess.CompletedProcess[str]:
    paths = []
    for number, source in enumerate(sources):
        paths.append(folder / f"{number}.hpp")
        paths[-1].write_text(source)
    return subprocess.run(
        [sys.executable, CHECK, *paths], capture_output=True, text=True, check=False
    )


def test_two_types_of_one_full_name_are_named_with_their_files(tmp_path: Path) -> None:
    done = run(
        tmp_path,
        "namespace a::b {\nstruct Block { int n; };\nvoid f() { if (true) {} }\nclass Row {};\n}",
        "namespace a {\nnamespace b { class Row final : public Base {}; }\n}",
    )
    assert done.returncode == 1
    assert done.stderr == (
        f"a::b::Row is defined in {tmp_path}/0.hpp and in {tmp_path}/1.hpp; rename one\n"
    )


def test_types_that_no_other_file_sees_or_of_other_names_may_be_called_alike(
    tmp_path: Path,
) -> None:
    done = run(
        tmp_path,
        "namespace a { struct Row {}; namespace { struct Local {}; } struct Outer {}; }",
        "namespace b { struct Row {}; } namespace a { namespace { struct Local {}; } struct Row; }",
        'namespace a { // struct Row {}\nstruct Other { struct In {}; const char* text = "{"; }; }',
        "namespace a { void f() { struct Row {}; } struct Outer::In2 { int n; }; }",
    )
    assert (done.returncode, done.stderr) == (0, "")
