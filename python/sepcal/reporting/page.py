# SPDX-License-Identifier: BSD-3-Clause
"""A page as plain data, and its HTML: nothing here knows about calibrations.

Figures are Plotly's, as dictionaries of data and layout. Their arrays stand in a pool, each once,
as base64 of float32, or of float64 where rounding would show; draw.js puts them back. Plotly itself
is compressed, which makes the page a third as large.
"""

from __future__ import annotations

import base64
import gzip
import json
from dataclasses import dataclass, field
from importlib import resources
from typing import Any

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.markup import Html, as_html, html, join
from sepcal.reporting.colours import DARK

ROUNDING = 1e-4  # of an array's spread: float32 may change no value by more

# The browser itself then refuses whatever would come from outside.
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:"
)


@dataclass(frozen=True)
class Figure:
    """One Plotly figure; NumPy arrays may stand wherever Plotly takes a list."""

    data: list[dict[str, Any]]
    layout: dict[str, Any]
    name: str  # what a screen reader says
    least: int = 0  # [px] of its width: a narrower page scrolls it


@dataclass(frozen=True)
class Grid:
    """Figures side by side, as many a row as there is room for."""

    figures: list[Figure]
    width: int = 300  # [px], of one at least


@dataclass(frozen=True)
class Section:
    """A heading, what to look for in a sentence, and blocks: HTML, a figure or a grid of them."""

    title: str
    lead: str = ""  # text, or Html
    blocks: list[str | Figure | Grid] = field(default_factory=list)  # text, or Html


@dataclass(frozen=True)
class Page:
    """All that the page shows."""

    title: str  # text
    verdict: Html  # above all sections
    sections: list[Section]


class Pool:
    """The page's arrays and figures."""

    def __init__(self) -> None:
        self.arrays: dict[str, int] = {}  # "f4:..." or "f8:...", and its place
        self.figures: list[dict[str, Any]] = []

    def keep(self, figure: Figure) -> int:
        """The figure's place."""
        self.figures.append({"data": self._pack(figure.data), "layout": self._pack(figure.layout)})
        return len(self.figures) - 1

    def _pack(self, value: object) -> object:
        if isinstance(value, dict):
            return {key: self._pack(entry) for key, entry in value.items()}
        if isinstance(value, np.ndarray) and value.ndim == 1 and value.dtype.kind in "fiub":
            return {"$": self.arrays.setdefault(encode_array(value), len(self.arrays))}
        if isinstance(value, np.ndarray | list | tuple):
            return [self._pack(entry) for entry in value]
        if isinstance(value, float | np.floating):
            return float(value) if np.isfinite(value) else None
        return value.item() if isinstance(value, np.generic) else value

    def to_json(self) -> str:
        """For a script element: no "<" can end it early, or open a comment in it."""
        whole = {"arrays": list(self.arrays), "figures": self.figures, "dark": DARK}
        return json.dumps(whole, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def encode_array(values: Array) -> str:
    """Kind and base64, little endian: "f4:AACAPw=="."""
    exact = values.astype("<f8")
    short = values.astype("<f4")
    finite = exact[np.isfinite(exact)]
    spread = float(np.ptp(finite)) if finite.size else 0.0
    error = float(np.max(np.abs(finite.astype("<f4") - finite))) if finite.size else 0.0
    kind, kept = ("f4", short) if error <= ROUNDING * spread else ("f8", exact)
    return f"{kind}:{base64.b64encode(kept.tobytes()).decode()}"


def build_page(page: Page, plotly: str) -> str:
    """The HTML, with Plotly as read_plotly() gives it inside."""
    pool = Pool()
    entries = join(
        "",
        (
            html('<li><a href="#s{}">{}</a></li>', number, section.title)
            for number, section in enumerate(page.sections, 1)
        ),
    )
    sections = join(
        "\n",
        (_build_section(section, number, pool) for number, section in enumerate(page.sections, 1)),
    )
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{POLICY}">
<meta name="color-scheme" content="light dark">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{as_html(page.title)}</title>
<style>
{read_asset("style.css")}</style>
</head>
<body>
<main>
<header>
{as_html(page.verdict)}
</header>
<nav aria-label="Contents"><ol>{entries}</ol></nav>
{sections}
</main>
<script type="application/octet-stream" id="plotly">{plotly}</script>
<script type="application/json" id="pool">{pool.to_json()}</script>
<script>
{read_asset("draw.js")}</script>
</body>
</html>
"""


def _build_section(section: Section, number: int, pool: Pool) -> Html:
    lead = html('<p class="lead">{}</p>', section.lead) if section.lead else ""
    blocks = join("\n", (_build_block(block, pool) for block in section.blocks))
    title = html('<h2><span class="number">{}</span>{}</h2>', number, section.title)
    return html('<section id="s{}">\n{}\n{}\n{}\n</section>', number, title, lead, blocks)


def _build_block(block: str | Figure | Grid, pool: Pool) -> Html:
    if isinstance(block, str):
        return as_html(block)
    if isinstance(block, Grid):
        cells = join("", (_build_block(figure, pool) for figure in block.figures))
        return html('<div class="grid" style="--width:{}px">{}</div>', block.width, cells)
    drawn = html(
        '<div class="figure" role="img" aria-label="{}" data-figure="{}" '
        'style="height:{}px;min-width:{}px"></div>',
        block.name,
        pool.keep(block),
        block.layout["height"],
        block.least,
    )
    return html('<div class="table">{}</div>', drawn) if block.least else drawn


def read_asset(name: str) -> str:
    """The text of a file that stands beside this one."""
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")


def read_plotly() -> str:
    """Plotly's JavaScript, compressed by gzip and as base64, the same each time.

    Raises Error that says how to install it where it is missing.
    """
    try:
        from plotly.offline import get_plotlyjs
    except ImportError as error:
        raise _core.Error(
            "the report needs plotly, which is not installed: pip install sepcal[report]"
        ) from error
    return base64.b64encode(gzip.compress(get_plotlyjs().encode(), mtime=0)).decode()
