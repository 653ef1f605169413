# SPDX-License-Identifier: BSD-3-Clause
"""The types of sepcal._core and sepcal._states for type checkers, made from the modules.

Usage: stub.py check|write BUILD, a build folder with python/sepcal. `check` fails where a file in
the repository, python/sepcal/_core.pyi or _states.pyi, says anything else than its module does.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
STUBS = [ROOT / "python" / "sepcal" / f"{name}.pyi" for name in ("_core", "_states")]
HEAD = (
    "# SPDX-License-Identifier: BSD-3-Clause\n# Made by scripts/lint --fix from cpp/src/bindings.\n"
)


def generate(build: Path, stub: Path) -> str:
    """A stub, formatted. Exits with the generator's words where Python does not know a type."""
    environment = {**os.environ, "PYTHONPATH": str(build / "python")}
    with tempfile.TemporaryDirectory() as folder:
        told = subprocess.run(
            [sys.executable, "-m", "pybind11_stubgen", f"sepcal.{stub.stem}",
             "--exit-code", "-o", folder],
            env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        if told.returncode != 0:
            raise SystemExit(f"pybind11-stubgen failed:\n{told.stderr}")
        made = (Path(folder) / "sepcal" / stub.name).read_text()
    # The module makes Error, and says that it is sepcal's: a traceback shows the public name.
    if stub.stem == "_core":
        made = made.replace("from sepcal import Error\n", "") + "class Error(ValueError): ...\n"
    made = HEAD + made
    formatted = subprocess.run(
        ["ruff", "format", "--stdin-filename", str(stub), "-"],
        input=made, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return formatted.stdout


def main(action: str, build: str) -> int:
    """0 where the stubs are current or were written."""
    status = 0
    for stub in STUBS:
        made = generate((ROOT / build).resolve(), stub)
        if action == "write":
            stub.write_text(made)
        elif stub.read_text() != made:
            name = stub.relative_to(ROOT)
            print(f"{name} is not what the module says; scripts/lint --fix writes it")
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
