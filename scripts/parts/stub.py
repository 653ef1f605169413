# SPDX-License-Identifier: BSD-3-Clause
"""What is made from the modules: their types for type checkers, and the options of fit().

Usage: stub.py check|write BUILD, a build folder with python/sepcal. `check` fails where a file in
the repository, python/sepcal/_core.pyi, _states.pyi or fit_options.py, says anything else than its
module does.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
STUBS = [ROOT / "python" / "sepcal" / f"{name}.pyi" for name in ("_core", "_states")]
HEAD = (
    "# SPDX-License-Identifier: BSD-3-Clause\n# Made by scripts/lint --fix from cpp/src/bindings.\n"
)


# What options print about themselves: the engine's table, with the defaults.
ROWS = """
import json
from sepcal import _core
defaults = _core.Options()
print(json.dumps([
    {"name": row.name, "sentence": row.sentence, "type": row.type,
     "unset": row.unset or json.dumps(getattr(defaults, row.name))}
    for row in _core.option_rows()
]))
"""
OPTIONS = ROOT / "python" / "sepcal" / "fit_options.py"
OPTIONS_HEAD = '''# SPDX-License-Identifier: BSD-3-Clause
# Made by scripts/lint --fix from cpp/src/flight/schema/option_fields.hpp.
"""The keyword arguments of fit(), with their types."""

from collections.abc import Mapping, Sequence
from typing import Literal, TypedDict

from sepcal.own_effect import Effect


class FitOptions(TypedDict, total=False):
    """Every choice of a fit; None, like leaving it out, means the default, given in brackets.

    `effects` takes Effects of your own, too. Of a model that is no probe each linear parameter and
    each input is a port, and its component is called s: "k[temp_degc]" adds the parameter
    k[temp_degc].s. Options of a flight's columns and rows, and `free`, are for flights alone.

    Attributes:
'''
OPTIONS_TAIL = '''
    Example:
        >>> options: sepcal.FitOptions = {"fix": {"w_d": 0.0}, "samples": 100, "seed": 1}
        >>> base = sepcal.fit(sepcal.PitotStatic(), sepcal.datasets.load("pitot"), **options)
        >>> base["w_d"].fixed
        True
    """

'''


def in_environment(build: Path) -> dict[str, str]:
    """That of a program that imports the build's sepcal."""
    return {**os.environ, "PYTHONPATH": str(build / "python")}


def formatted(text: str, file: Path) -> str:
    """By ruff."""
    told = subprocess.run(
        [sys.executable, "-m", "ruff", "format", "--stdin-filename", str(file), "-"],
        input=text, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return told.stdout


def generate_options(build: Path) -> str:
    """The class FitOptions, formatted."""
    told = subprocess.run(
        [sys.executable, "-c", ROWS],
        env=in_environment(build), capture_output=True, text=True, check=True,
    )  # fmt: skip
    rows = json.loads(told.stdout)
    python = {"true": "True", "false": "False"}
    entries = []
    for row in rows:
        sentence = row["sentence"][0].upper() + row["sentence"][1:]
        text = f"{row['name']}: {sentence} [{python.get(row['unset'], row['unset'])}]."
        entries.append(textwrap.fill(text, 100, initial_indent=" " * 8, subsequent_indent=" " * 12))
    members = [f"    {row['name']}: {row['type']} | None" for row in rows]
    body = "\n".join(entries) + "\n" + OPTIONS_TAIL + "\n".join(members) + "\n"
    return formatted(OPTIONS_HEAD + body, OPTIONS)


def generate(build: Path, stub: Path) -> str:
    """A stub, formatted. Exits with the generator's words where Python does not know a type."""
    with tempfile.TemporaryDirectory() as folder:
        told = subprocess.run(
            [sys.executable, "-m", "pybind11_stubgen", f"sepcal.{stub.stem}",
             "--exit-code", "-o", folder],
            env=in_environment(build), capture_output=True, text=True, check=False,
        )  # fmt: skip
        if told.returncode != 0:
            raise SystemExit(f"pybind11-stubgen failed:\n{told.stderr}")
        made = (Path(folder) / "sepcal" / stub.name).read_text()
    # The module makes Error, and says that it is sepcal's: a traceback shows the public name.
    if stub.stem == "_core":
        made = made.replace("from sepcal import Error\n", "") + "class Error(ValueError): ...\n"
    return formatted(HEAD + made, stub)


def main(action: str, build: str) -> int:
    """0 where the files are current or were written."""
    status = 0
    folder = (ROOT / build).resolve()
    for stub in STUBS:
        if not list((folder / "python" / "sepcal").glob(f"{stub.stem}.*.so")):
            raise SystemExit(
                f"{build} has no {stub.stem}: run ninja -C {build} _core _states first"
            )
    made = {stub: generate(folder, stub) for stub in STUBS} | {OPTIONS: generate_options(folder)}
    for file, text in made.items():
        if action == "write":
            file.write_text(text)
        elif file.read_text() != text:
            name = file.relative_to(ROOT)
            print(f"{name} is not what the module says; scripts/lint --fix writes it")
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
