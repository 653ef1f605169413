# SPDX-License-Identifier: BSD-3-Clause
"""What sepcal's site has beyond Sphinx: links of the repository, mathematics, plotly's pictures."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.fileutil import copy_asset_file

MARKS = re.compile(r"[|*]|_\b|\\")
ATTRIBUTES: dict[str, list[str]] = {}  # their docstrings, by name
ELSEWHERE = re.compile(r'<script[^>]* src="https:[^"]*"[^>]*></script>')


def take_as_written(
    app: Sphinx, what: str, name: str, at: object, options: object, lines: list[str]
) -> None:
    """Docstrings are plain text: `x` is code, and |x|, *x and x_ are no marks of Sphinx's.

    What is indented after a blank line is an example or an equation, as it stands.
    """
    taken: list[str] = []
    verbatim, last = False, "-"  # that had words
    for line in lines:
        starts = not (taken and taken[-1]) and line.startswith("    ") and not last.startswith(" ")
        if starts and not verbatim:
            taken += ["::", ""]
        verbatim = starts or (verbatim and (not line or line.startswith("    ")))
        if verbatim or line.lstrip().startswith((">>>", "...")):
            taken.append(line)
        else:
            parts = line.split("`")
            parts[::2] = [MARKS.sub(r"\\\g<0>", part) for part in parts[::2]]
            taken.append("``".join(parts))
        last = line or last
    lines[:] = taken
    if what in ("attribute", "property"):
        ATTRIBUTES[name] = taken


def take_back(
    app: Sphinx, what: str, name: str, at: object, options: object, lines: list[str]
) -> None:
    """Napoleon takes what stands before a colon of an attribute's docstring for its type."""
    lines[:] = ATTRIBUTES.get(name, lines)


def drop_foreign_names(app: Sphinx, doctree: nodes.document) -> None:
    """Types of C++ that the site doesn't have, as std::string: Sphinx would search all for each."""
    for name in list(doctree.findall(addnodes.pending_xref)):
        if name["refdomain"] == "cpp":
            last = re.split(r"::", name["reftarget"].split("<")[0])[-1]
            if last not in public_names(app):
                name.replace_self(name.children)


@cache
def public_names(app: Sphinx) -> set[str]:
    """What Doxygen's index lists, without the names before it."""
    index = Path(app.config.breathe_projects["sepcal"], "index.xml").read_text(encoding="utf-8")
    return {name.split("::")[-1] for name in re.findall(r"<name>([^<]*)</name>", index)}


def set_mathematics(translator: Any, node: Any) -> None:  # noqa: ANN401
    """As MathML, which browsers set by themselves; what TeX would refuse is a warning."""
    is_block = isinstance(node, nodes.math_block)
    try:
        formula = tex2mathml(node.astext(), as_block=is_block)
    except MathError as error:
        logging.getLogger(__name__).warning("%s in %r", error, node.astext(), location=node)
        formula = translator.encode(node.astext())
    translator.body.append(f'<div class="math">{formula}</div>' if is_block else formula)
    raise nodes.SkipNode


def load_plotly_from_here(
    app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: object
) -> None:
    """Notebooks' pictures load scripts from elsewhere; the site has its own copy, loaded once."""
    body = context.get("body", "")
    if "Plotly.newPlot" in body:
        script = f'<script src="{context["pathto"]("_static/plotly.min.js", 1)}"></script>'
        context["body"] = script + ELSEWHERE.sub("", body)


def copy_plotly(app: Sphinx, error: Exception | None) -> None:
    """Beside the style sheets."""
    if error is None:
        import plotly

        script = Path(plotly.__file__).parent / "package_data" / "plotly.min.js"
        copy_asset_file(script, app.outdir / "_static")


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", take_as_written, priority=400)  # napoleon has 500
    app.connect("autodoc-process-docstring", take_back, priority=600)
    app.connect("doctree-read", drop_foreign_names)
    app.connect("html-page-context", load_plotly_from_here)
    app.connect("build-finished", copy_plotly)
    app.add_html_math_renderer(
        "mathml", inline_renderers=(set_mathematics, None), block_renderers=(set_mathematics, None)
    )
    return {"parallel_read_safe": True, "parallel_write_safe": True}
