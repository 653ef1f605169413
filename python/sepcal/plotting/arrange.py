# SPDX-License-Identifier: BSD-3-Clause
"""Several figures as one: each in a cell of a grid, with axes of its own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sepcal.reporting import words
from sepcal.reporting.page import Figure

ABOVE, BELOW = 30, 46  # [px] of a cell, for its title and for its axis
LEGEND = 34  # [px] at the bottom
BESIDE = 0.1  # of the width, between cells, for the axis of the right one


def arrange(figures: Sequence[Figure], columns: int) -> Figure:
    """Each figure has one pair of axes, or is polar; names that recur stand in the legend once."""
    columns = min(columns, len(figures))
    rows = [figures[at : at + columns] for at in range(0, len(figures), columns)]
    heights = [max(int(figure.layout["height"]) for figure in row) for row in rows]
    has_legend = any(figure.layout.get("showlegend") for figure in figures)
    bottom = LEGEND if has_legend else 8
    whole = sum(heights)
    wide = (1 - BESIDE * (columns - 1)) / columns
    layout = words.layout(
        whole + bottom,
        showlegend=has_legend,
        margin={"l": 62, "r": 16, "t": 6, "b": bottom},
        shapes=[],
        annotations=[],
        legend={"orientation": "h", "x": 0, "xanchor": "left", "y": 0, "yref": "container",
                "yanchor": "bottom", "traceorder": "normal"},
    )  # fmt: skip
    data: list[dict[str, Any]] = []
    seen: set[str] = set()
    top, number = 0, 0
    for row, height in zip(rows, heights, strict=True):
        down = (1 - (top + height - BELOW) / whole, 1 - (top + ABOVE) / whole)
        for place, figure in enumerate(row):
            number += 1
            left = place * (wide + BESIDE)
            _put(figure, number, (left, left + wide), down, data, layout, seen)
        top += height
    return Figure(data, layout, "; ".join(figure.name for figure in figures))


def _put(
    figure: Figure,
    number: int,
    across: tuple[float, float],
    down: tuple[float, float],
    data: list[dict[str, Any]],
    layout: dict[str, Any],
    seen: set[str],
) -> None:
    """Adds a figure whose axes are called x3, y3 for number 3."""
    end = str(number) if number > 1 else ""
    own = figure.layout
    shows = bool(own.get("showlegend"))
    for trace in figure.data:
        placed = dict(trace)
        if trace["type"] == "barpolar":
            placed["subplot"] = f"polar{end}"
        else:
            placed |= {"xaxis": f"x{end}", "yaxis": f"y{end}"}
        name = trace.get("name")
        is_first = bool(name) and name not in seen and trace.get("showlegend", True)
        placed["showlegend"] = shows and is_first
        if name and shows:
            placed["legendgroup"] = name
            seen.update([name] if is_first else [])
        data.append(placed)
    if "polar" in own:
        low, high = down
        room = 0.12 * (high - low)  # for the words around the circle
        domain = {"x": list(across), "y": [low, high - room]}
        layout[f"polar{end}"] = own["polar"] | {"domain": domain}
    else:
        layout[f"xaxis{end}"] = _tied(own["xaxis"]) | {"domain": list(across), "anchor": f"y{end}"}
        layout[f"yaxis{end}"] = _tied(own["yaxis"], end) | {
            "domain": list(down),
            "anchor": f"x{end}",
        }
    for kind in ("shapes", "annotations"):
        layout[kind] += [_moved(one, end) for one in own.get(kind, ())]
    if own.get("barmode"):
        layout["barmode"] = own["barmode"]
    if "bargap" in own:
        layout["bargap"] = own["bargap"]
    title = own["title"]
    layout["annotations"].append({
        "text": title["text"], "font": title["font"], "showarrow": False, "xref": "paper",
        "yref": "paper", "x": across[0], "y": down[1], "xanchor": "left", "yanchor": "bottom",
        "yshift": 4,
    })  # fmt: skip


def _tied(axis: dict[str, Any], end: str = "") -> dict[str, Any]:
    return axis | ({"scaleanchor": f"x{end}"} if "scaleanchor" in axis else {})


def _moved(mark: dict[str, Any], end: str) -> dict[str, Any]:
    """A shape or an annotation, in its cell."""
    moved = dict(mark)
    for axis in "xy":
        given = mark.get(f"{axis}ref", axis)
        moved[f"{axis}ref"] = f"{axis}{end} domain" if given == "paper" else f"{axis}{end}"
    return moved
