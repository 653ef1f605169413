# SPDX-License-Identifier: BSD-3-Clause
"""The documents as tests read them: their fenced blocks, and commands run as a reader would.

A mark before a block says what it is: `<!-- from examples/NAME -->` quotes an example, `<!-- output
of examples/NAME -->` shows lines of what it prints.
"""

import os
import re
import subprocess
from pathlib import Path

import sepcal

ROOT = Path(__file__).resolve().parents[1]
APPS = Path(os.environ.get("SEPCAL_APPS", ROOT / "build" / "apps"))
BUILT_EXAMPLES = APPS.parent / "examples"
EXAMPLES = ROOT / "examples"
DOCUMENTS = sorted([ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").glob("*.md")])

BLOCK = re.compile(
    r"^(?:<!-- (?P<mark>.*?) -->\n)?```(?P<language>\w*)\n(?P<text>.*?)^```$", re.M | re.S
)
BLOCKS = [
    {"document": str(document.relative_to(ROOT)), **match.groupdict(default="")}
    for document in DOCUMENTS
    for match in BLOCK.finditer(document.read_text())
]
TYPED = [block["text"] for block in BLOCKS if block["language"] == "sh"]


def marked(mark, document=""):
    """The texts of the blocks with this mark, in all documents or in one."""
    return [b["text"] for b in BLOCKS if b["mark"] == mark and document in ("", b["document"])]


def missing_lines(shown, printed):
    """Lines that a document shows and that were not printed."""
    return [line for line in shown.splitlines() if line not in printed.splitlines()]


def run(*command, cwd=None, codes=(0,)):
    """What a command prints; the apps are found, and a failure shows what it said."""
    path = f"{APPS}{os.pathsep}{os.environ['PATH']}"
    modules = f"{Path(sepcal.__file__).parents[1]}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        env={**os.environ, "PATH": path, "PYTHONPATH": modules},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode in codes, done.stderr
    return done.stdout
