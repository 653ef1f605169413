# SPDX-License-Identifier: BSD-3-Clause
"""Draws the gallery: runs the blocks of gallery.md, and puts each picture above its code.

python docs/site/gallery.py FOLDER writes FOLDER/gallery.md and FOLDER/gallery/*.png. Blocks of
Python share their names; one that ends with a call of plot() is drawn, on light ground and on dark.
Blocks of sh run in a folder of their own, with the programs of build/apps.
"""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from assemble import lead_here, write

SITE = Path(__file__).resolve().parent
APPS = Path(os.environ.get("SEPCAL_APPS", SITE.parents[1] / "build" / "apps"))
BLOCK = re.compile(r"^```(python|sh)\n(.*?)^```\n", re.M | re.S)
DPI = 150  # of pictures 960 px wide at 100
SHOWN = """```{{image}} {file}-{theme}.png
:alt: {alt}
:class: only-{theme}
```
"""


def draw(last: ast.Expr, names: dict[str, Any], file: Path) -> None:
    """The figure that a block ends with, by matplotlib, twice."""
    for theme in ("light", "dark"):
        call = ast.parse(ast.unparse(last), mode="eval")
        assert isinstance(call.body, ast.Call)
        words = {"backend": "matplotlib", "theme": theme}
        call.body.keywords += [ast.keyword(word, ast.Constant(at)) for word, at in words.items()]
        figure = eval(compile(ast.fix_missing_locations(call), "gallery.md", "eval"), names)
        figure.savefig(f"{file}-{theme}.png", dpi=DPI)


def run(language: str, code: str, names: dict[str, Any], file: Path) -> bool:
    """Runs a block; whether it drew."""
    if language == "sh":
        path = f"{APPS}{os.pathsep}{os.environ['PATH']}"
        subprocess.run(
            ["bash", "-ec", code],
            check=True,
            stdout=subprocess.DEVNULL,
            env={**os.environ, "PATH": path},
        )
        return False
    tree = ast.parse(code)
    last = tree.body[-1]
    draws = isinstance(last, ast.Expr)
    exec(
        compile(ast.Module(tree.body[:-1] if draws else tree.body, []), "gallery.md", "exec"), names
    )
    if isinstance(last, ast.Expr):
        draw(last, names, file)
    return draws


def main(folder: Path) -> None:
    """The page and its pictures."""
    text = lead_here((SITE / "gallery.md").read_text(encoding="utf-8"))
    pictures = folder.resolve() / "gallery"
    pictures.mkdir(parents=True, exist_ok=True)
    names: dict[str, Any] = {}
    page, begin = "", 0
    with tempfile.TemporaryDirectory() as scratch:
        os.chdir(scratch)
        for number, block in enumerate(BLOCK.finditer(text)):
            heading = re.findall(r"^## (.*)$", text[: block.start()], re.M)[-1:]
            page += text[begin : block.start()]
            name = f"{number:02}"
            if run(block[1], block[2], names, pictures / name):
                for theme in ("light", "dark"):
                    page += SHOWN.format(file=f"gallery/{name}", theme=theme, alt=heading[0])
                page += "\n"
            page += block[0]
            begin = block.end()
        os.chdir(SITE)
    write(folder.resolve() / "gallery.md", page + text[begin:])


if __name__ == "__main__":
    main(Path(sys.argv[1]).absolute())
