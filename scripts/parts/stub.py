# SPDX-License-Identifier: BSD-3-Clause
"""The types of sepcal._core for type checkers, python/sepcal/_core.pyi, made from the module.

Usage: stub.py check|write BUILD, a build folder with python/sepcal. `check` fails where the file
in the repository says anything else than the module does.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
STUB = ROOT / "python" / "sepcal" / "_core.pyi"
HEAD = (
    "# SPDX-License-Identifier: BSD-3-Clause\n# Made by scripts/lint --fix from cpp/src/bindings.\n"
)


def generate(build: Path) -> str:
    """The stub, formatted. Exits with the generator's words where Python does not know a type."""
    environment = {**os.environ, "PYTHONPATH": str(build / "python")}
    with tempfile.TemporaryDirectory() as folder:
        told = subprocess.run(
            [sys.executable, "-m", "pybind11_stubgen", "sepcal._core", "--exit-code", "-o", folder],
            env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        if told.returncode != 0:
            raise SystemExit(f"pybind11-stubgen failed:\n{told.stderr}")
        made = (Path(folder) / "sepcal" / "_core.pyi").read_text()
    # The module makes Error, and says that it is sepcal's: a traceback shows the public name.
    made = HEAD + made.replace("from sepcal import Error\n", "")
    made += "class Error(ValueError): ...\n"
    formatted = subprocess.run(
        ["ruff", "format", "--stdin-filename", str(STUB), "-"],
        input=made, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return formatted.stdout


def main(action: str, build: str) -> int:
    """0 where the stub is current or was written."""
    made = generate((ROOT / build).resolve())
    if action == "write":
        STUB.write_text(made)
        return 0
    if STUB.read_text() == made:
        return 0
    print(f"{STUB.relative_to(ROOT)} is not what the module says; scripts/lint --fix writes it")
    return 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
