# SPDX-License-Identifier: BSD-3-Clause
"""What scripts/wheel says of a wheel, beside objdump."""

import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts" / "parts"))

import pack_wheel

BINARY = Path("/bin/bash")

pytestmark = pytest.mark.skipif(
    not (shutil.which("objdump") and BINARY.is_file()), reason="no binutils, or no bash at /bin"
)


def objdump(*options):
    return subprocess.run(
        ["objdump", *options, BINARY], capture_output=True, text=True, check=True
    ).stdout


def test_the_libraries_that_a_binary_loads():
    assert pack_wheel.needed(BINARY) == re.findall(r"NEEDED +(\S+)", objdump("-p"))


def test_the_newest_glibc_that_a_binary_asks_for():
    versions = re.findall(r"\(?GLIBC_([0-9.]+)\)? ", objdump("-T"))
    newest = max(tuple(int(part) for part in version.split(".")) for version in versions)
    assert pack_wheel.newest_glibc(BINARY) == newest


def test_show_names_binaries_and_licences(tmp_path, capsys):
    wheel = tmp_path / "sepcal-0-cp311-cp311-linux.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.write(BINARY, "sepcal/bin/shell")
        archive.writestr("sepcal/__init__.py", "")
        archive.writestr("sepcal-0.dist-info/licenses/LICENSE", "free")
    assert pack_wheel.main(["show", str(wheel)]) == 0
    shown = capsys.readouterr().out
    assert f"sepcal/bin/shell: {BINARY.stat().st_size / 1e6:.2f} MB" in shown
    assert "loads " + ", ".join(pack_wheel.needed(BINARY)) in shown
    assert "licence: sepcal-0.dist-info/licenses/LICENSE" in shown
    assert "__init__" not in shown


def test_anything_else_prints_the_usage(capsys):
    assert pack_wheel.main(["unpack"]) == 2
    assert "Usage: pack_wheel.py" in capsys.readouterr().err
