# SPDX-License-Identifier: BSD-3-Clause
"""The programs of a wheel: commands that become the native programs beside the modules."""

import subprocess
import sys
from pathlib import Path

import pytest

import sepcal
from sepcal import programs

NAMES = ("sepcal-aircraft", "sepcal-mag", "sepcal-pitot")


@pytest.mark.skipif(not programs.FOLDER.is_dir(), reason="sepcal runs from a build folder")
@pytest.mark.parametrize("name", NAMES)
def test_a_wheel_has_the_programs(name):
    done = subprocess.run(
        [Path(sys.executable).parent / name, "--version"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == ["sepcal", sepcal.__version__]


def test_a_program_that_is_not_there_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr(programs, "FOLDER", tmp_path)
    monkeypatch.setattr(sys, "argv", ["/usr/bin/sepcal-mag", "fit"])
    with pytest.raises(SystemExit, match=r"^sepcal-mag: .*sepcal-mag can't be run \(No such file"):
        programs.run()


def test_a_program_gets_its_arguments_and_its_name(tmp_path, monkeypatch):
    program = tmp_path / "sepcal-mag"
    program.write_text('#!/bin/sh\nprintf "%s|" "$@"\n')
    program.chmod(0o755)
    script = f"""
import sys
from pathlib import Path
from sepcal import programs
programs.FOLDER = Path({str(tmp_path)!r})
sys.argv = ["/usr/bin/sepcal-mag", "fit", "a b.csv", "--help"]
programs.run()
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout == "fit|a b.csv|--help|"
