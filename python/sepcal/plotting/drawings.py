# SPDX-License-Identifier: BSD-3-Clause
"""Figures that the report has no room for: intervals, rankings, estimates of many trials."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sepcal.columns import Array
from sepcal.markup import as_html, in_figure
from sepcal.reporting import words
from sepcal.reporting.page import Figure
from sepcal.reporting.thin import keep_extremes

ROW = 30  # [px] of a row of a figure that has one a parameter
BEYOND = 4.0  # half widths: an interval that goes on for ever is drawn so far
RANKED = 12  # candidates
CROWDED = 36  # estimates: the names of more don't fit below their cells
BARS = "#5b94cc"


@dataclass(frozen=True)
class Span:
    """An interval in a row."""

    low: float
    high: float


def draw_spans(
    title: str,
    x_title: str,
    rows: Sequence[str],
    middle: Sequence[float],
    kinds: Mapping[str, Sequence[Span]],
) -> Figure:
    """Intervals about points, a row each, the first on top; several kinds are drawn below another.

    Args:
        title: The figure's title.
        x_title: With the unit.
        rows: The words at the left, text or Html.
        middle: The points.
        kinds: By the legend's word, a span a row.
    """
    data: list[dict[str, Any]] = []
    at = np.arange(len(rows), dtype=float)
    colours = [words.MODELLED, words.HELD_OUT]
    for k, (kind, spans) in enumerate(kinds.items()):
        shift = 0.0 if len(kinds) == 1 else 0.16 * (2 * k - 1)
        x = np.array([[span.low, span.high, math.nan] for span in spans]).ravel()
        y = np.repeat(at + shift, 3)
        line = {"color": colours[k % 2], "width": 4}
        data.append({"type": "scatter", "mode": "lines", "name": kind, "x": x, "y": y,
                     "line": line, "hoverinfo": "x"})  # fmt: skip
    data.append({
        "type": "scatter", "mode": "markers", "showlegend": False, "x": np.array(middle), "y": at,
        "marker": {"size": 7, "color": words.INK}, "hoverinfo": "x",
    })  # fmt: skip
    ends = [at for spans in kinds.values() for span in spans for at in (span.low, span.high)]
    ends = [at for at in [*ends, *middle, 0.0] if math.isfinite(at)]
    room = 0.04 * (max(ends) - min(ends) or 1.0)
    layout = words.layout(
        ROW * len(rows) + 110,
        title,
        showlegend=len(kinds) > 1,
        margin={"l": 56, "r": 14, "t": 58 if len(kinds) > 1 else 34, "b": 46},
        xaxis=words.axis(
            x_title, zeroline=True, zerolinecolor="#8b949c",
            range=[min(ends) - room, max(ends) + room],
        ),
        yaxis=words.axis(
            tickvals=list(range(len(rows))), ticktext=[as_html(row) for row in rows],
            range=[len(rows) - 0.5, -0.5], showgrid=False,
        ),
    )  # fmt: skip
    return Figure(data, layout, title)


def draw_ranking(names: Sequence[str], drops: Array, gains: Array, found: Sequence[bool]) -> Figure:
    """Candidates, best on top: what each takes off the error, fitted and on rows held out [%]."""
    at = np.arange(len(names), dtype=float)
    ticks = [in_figure(words.abbreviate(name, 40) + (" (found)" if is_found else ""))
             for name, is_found in zip(names, found, strict=True)]  # fmt: skip

    def bars(name: str, values: Array, shift: float, colour: str) -> dict[str, Any]:
        return {
            "type": "bar", "orientation": "h", "name": name, "y": at + shift,
            "x": np.maximum(values, -deepest), "width": 0.36, "marker": {"color": colour},
            "text": ["" if math.isnan(v) else words.percent(v / 100) for v in values],
            "hovertemplate": "%{text}", "cliponaxis": False,
            "textposition": "outside", "textfont": {"size": 11},
        }  # fmt: skip

    finite = np.concatenate([drops, gains])
    finite = finite[np.isfinite(finite)]
    highest = float(finite.max(initial=1.0))
    deepest = min(highest, -float(finite.min(initial=0.0)))  # a bar that goes further is cut
    is_cut = bool((finite < -deepest).any())
    data = [
        bars("predicted drop of the error", drops, -0.19, words.MODELLED),
        bars("gain on rows held out", gains, 0.19, words.HELD_OUT),
    ]
    room = 0.09 * (highest + deepest)  # for the numbers at the bars' ends
    reach = [-deepest - room if deepest > 0 else 0.0, highest + room]
    x_title = (
        "of the error [%]; a bar that goes further left is cut" if is_cut else "of the error [%]"
    )
    layout = words.layout(
        ROW * len(names) + 120,
        "Candidates, best first",
        barmode="overlay",
        showlegend=True,
        margin={"l": 56, "r": 14, "t": 58, "b": 46},
        xaxis=words.axis(x_title, range=reach, zeroline=True, zerolinecolor="#8b949c"),
        yaxis=words.axis(
            tickvals=list(range(len(names))), ticktext=ticks,
            range=[len(names) - 0.5, -0.5], showgrid=False, ticks="",
        ),
    )  # fmt: skip
    return Figure(data, layout, "Candidates, best first")


def draw_correlation(names: Sequence[str], correlation: Array) -> Figure:
    """Draws the correlation of estimates, (n, n): blue if positive, red if negative."""
    places = list(range(len(names)))
    ticks = [in_figure(words.abbreviate(name, 28)) for name in names]
    longest = max(map(len, ticks), default=0)
    shown = places if len(names) <= CROWDED else []  # of the names below the cells
    is_legible = len(names) <= 16
    trace = {
        "type": "heatmap", "z": correlation, "zmin": -1, "zmax": 1, "x": places, "y": places,
        "xgap": 1, "ygap": 1, "colorscale": [[0, words.ALARM], [0.5, "#f2f5f7"],
                                             [1, words.MODELLED]],
        "colorbar": {"title": {"text": "correlation"}, "thickness": 10, "outlinewidth": 0,
                     "lenmode": "pixels", "len": 130, "y": 1, "yanchor": "top", "nticks": 5},
        "hovertemplate": "%{y} and %{x}: %{z:.2f}<extra></extra>",
        "text": [[_hundredths(v) if is_legible and np.isfinite(v) else ""
                  for v in row] for row in correlation],
        "texttemplate": "%{text}" if is_legible else "",
    }  # fmt: skip
    quiet: dict[str, Any] = {"showgrid": False, "ticks": ""}
    layout = words.layout(
        28 * len(names) + 60 + (max(90, 5 * longest) if shown else 20),
        "Correlation of the estimates",
        xaxis=words.axis(
            **quiet, tickvals=shown, ticktext=[ticks[i] for i in shown], tickangle=-45
        ),
        yaxis=words.axis(**quiet, tickvals=places, ticktext=ticks, autorange="reversed"),
    )
    return Figure([trace], layout, "Correlation of the estimates")


def _hundredths(value: float) -> str:
    text = f"{value:.2f}".replace("-", "−")
    return "0.00" if text == "−0.00" else text


def draw_estimates(title: str, x_title: str, values: Array, lines: Mapping[str, float]) -> Figure:
    """How often trials gave which value, (T,), and values to compare with as upright lines."""
    there = values[np.isfinite(values)]
    counts, edges = np.histogram(there, min(40, max(8, round(math.sqrt(there.size)) + 4)))
    data: list[dict[str, Any]] = [{
        "type": "bar", "x": 0.5 * (edges[1:] + edges[:-1]), "y": counts, "showlegend": False,
        "marker": {"color": BARS}, "hovertemplate": "%{x:.4g}: %{y} trials<extra></extra>",
    }]  # fmt: skip
    for i, (name, value) in enumerate(lines.items()):
        line = {"color": words.ALARM if i == 0 else words.INK, "width": 2,
                "dash": "solid" if i == 0 else "dash"}  # fmt: skip
        if math.isfinite(value):
            data.append({"type": "scatter", "mode": "lines", "name": name, "x": [value, value],
                         "y": [0, float(counts.max())], "line": line})  # fmt: skip
    return Figure(data, _of_trials(title, x_title), title)


def draw_pulls(title: str, pulls: Array) -> Figure:
    """Errors of estimates in their own standard errors, (T,), before the normal distribution."""
    there = pulls[np.isfinite(pulls)]
    reach = max(4.0, math.ceil(float(np.abs(there).max(initial=0.0))))
    counts, edges = np.histogram(there, np.linspace(-reach, reach, int(4 * reach) + 1))
    at = np.linspace(-reach, reach, 121)
    expected = there.size * (edges[1] - edges[0]) * np.exp(-0.5 * at**2) / math.sqrt(2 * math.pi)
    data: list[dict[str, Any]] = [
        {"type": "bar", "x": 0.5 * (edges[1:] + edges[:-1]), "y": counts, "showlegend": False,
         "marker": {"color": BARS}, "hovertemplate": "%{x:.2f}: %{y} trials<extra></extra>"},
        {"type": "scatter", "mode": "lines", "x": at, "y": expected, "hoverinfo": "skip",
         "name": "normal, as the standard errors say", "line": {"color": words.ALARM, "width": 2}},
    ]  # fmt: skip
    return Figure(data, _of_trials(title, "error [standard errors]"), title)


def _of_trials(title: str, x_title: str) -> dict[str, Any]:
    return words.layout(
        250,
        title,
        showlegend=True,
        bargap=0.04,
        margin={"l": 50, "r": 10, "t": 58, "b": 42},
        xaxis=words.axis(x_title, nticks=6),
        yaxis=words.axis("trials", rangemode="tozero", nticks=5, tickformat="d"),
    )


def name_bands(figures: Sequence[Figure], band: str) -> list[Figure]:
    """The same figures, with what their bands are in a legend."""
    named = []
    for figure in figures:
        data = [
            {**trace, "name": band, "showlegend": True} if "fill" in trace
            else {**trace, "showlegend": False}
            for trace in figure.data
        ]  # fmt: skip
        margin = figure.layout["margin"] | {"t": 54}
        own = {"showlegend": True, "margin": margin, "height": figure.layout["height"] + 24}
        named.append(Figure(data, figure.layout | own, figure.name))
    return named


def shade_rows(first: float, last: float) -> dict[str, Any]:
    """A stretch of time that something is wrong with."""
    return {
        "type": "rect", "xref": "x", "yref": "paper", "x0": first, "x1": last, "y0": 0, "y1": 1,
        "fillcolor": "rgba(184,58,38,0.20)", "line": {"width": 0}, "layer": "below",
    }  # fmt: skip


def draw_column(
    title: str, y_title: str, time: Array, values: Array, shapes: list[dict[str, Any]], x_title: str
) -> Figure:
    """A column of a log over time; a row without a number is a gap."""
    kept = keep_extremes(values, 1600)
    data = [{
        "type": "scatter", "mode": "lines", "x": time[kept], "y": values[kept], "hoverinfo": "x+y",
        "line": {"color": words.MODELLED, "width": 1.2},
    }]  # fmt: skip
    layout = words.layout(
        200,
        words.abbreviate(title, 44),
        margin={"l": 56, "r": 8, "t": 30, "b": 38},
        shapes=shapes,
        xaxis=words.axis(x_title, range=[float(np.min(time)), float(np.max(time))], nticks=6),
        yaxis=words.axis(words.abbreviate(y_title, 20), nticks=5),
    )
    return Figure(data, layout, f"{title} over time")
