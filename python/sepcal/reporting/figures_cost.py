# SPDX-License-Identifier: BSD-3-Clause
"""Stage one's cost over the nonlinear parameters, and the ellipses of estimates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from sepcal.columns import Array
from sepcal.markup import html, in_figure
from sepcal.reporting import words
from sepcal.reporting.page import Figure
from sepcal.results import Fit

CELLS = 14  # to a side, of the pairs' least cost
PAIRS = 10  # drawn of many parameters
ELLIPSES = 6
STEEP = 30.0  # a cost's largest over its least, from where its logarithm is shown
COLOURS = [[0, words.MODELLED], [1, "#f2f5f7"]]


def draw_landscape(
    names: Sequence[str],
    units: Sequence[str],
    points: Array,
    trace_r: Array,
    minima: Sequence[Mapping[str, float]],
    estimate: Mapping[str, float],
) -> list[Figure]:
    """Tr[R] (S,) at `points` (S, n): a curve, a map, or of each pair the least over all others."""
    there = np.isfinite(trace_r)
    points, trace_r = points[there], trace_r[there]
    if not trace_r.size:
        return []
    if len(names) == 1:
        return [_draw_curve(names[0], units[0], points[:, 0], trace_r, minima, estimate)]
    pairs = list(combinations(range(len(names)), 2))[:PAIRS]
    return [_draw_map(names, units, pair, points, trace_r, minima, estimate) for pair in pairs]


def _is_steep(trace_r: Array) -> bool:
    low, high = float(np.min(trace_r)), float(np.max(trace_r))
    return 0 < low < high / STEEP


def _marks(
    xs: Sequence[float], ys: Sequence[float], name: str, symbol: str, colour: str
) -> dict[str, Any]:
    return {
        "type": "scatter", "mode": "markers", "x": list(xs), "y": list(ys), "name": name,
        "marker": {"symbol": symbol, "size": 9, "color": colour,
                   "line": {"color": colour, "width": 1.5}},
        "hovertemplate": html("{}: {}<extra></extra>", name, "%{x:.4g}, %{y:.4g}"),
    }  # fmt: skip


def _draw_curve(
    name: str,
    unit: str,
    x: Array,
    trace_r: Array,
    minima: Sequence[Mapping[str, float]],
    estimate: Mapping[str, float],
) -> Figure:
    order = np.argsort(x)
    x, y = x[order], trace_r[order]
    data: list[dict[str, Any]] = [
        {"type": "scatter", "mode": "lines", "x": x, "y": y, "hoverinfo": "x+y",
         "line": {"color": words.MODELLED, "width": 1.5}, "showlegend": False},
    ]  # fmt: skip
    at = [minimum[name] for minimum in minima if name in minimum]
    if at:
        data.append(_marks(at, np.interp(at, x, y).tolist(), "minima", "circle-open", words.INK))
    if name in estimate:
        here = [estimate[name]]
        data.append(_marks(here, np.interp(here, x, y).tolist(), "estimate", "x", words.ALARM))
    title = f"Tr[R] over {words.abbreviate(name, 24)}"
    layout = words.layout(
        300,
        title,
        showlegend=True,
        margin={"l": 56, "r": 14, "t": 58, "b": 42},
        xaxis=words.axis(words.titled(words.abbreviate(name, 24), unit)),
        yaxis=words.axis("Tr[R]", type="log" if _is_steep(y) else "linear"),
    )
    return Figure(data, layout, title)


def _draw_map(
    names: Sequence[str],
    units: Sequence[str],
    pair: tuple[int, int],
    points: Array,
    trace_r: Array,
    minima: Sequence[Mapping[str, float]],
    estimate: Mapping[str, float],
) -> Figure:
    """Over two parameters, the least over all others in each cell."""
    i, j = pair
    x, y, z = find_least(points[:, i], points[:, j], trace_r, grid=len(names) == 2)
    steep = _is_steep(trace_r)
    shown = np.log10(z) if steep else z
    data: list[dict[str, Any]] = [
        {"type": "heatmap", "x": x, "y": y, "z": shown, "colorscale": COLOURS, "showlegend": False,
         "colorbar": {"title": {"text": "log10 Tr[R]" if steep else "Tr[R]"}, "thickness": 10,
                      "outlinewidth": 0, "nticks": 5},
         "hovertemplate": "%{x:.4g}, %{y:.4g}: %{z:.4g}<extra></extra>"},
    ]  # fmt: skip
    for what, symbol, colour, places in (
        ("minima", "circle-open", words.INK, list(minima)),
        ("estimate", "x", words.ALARM, [estimate]),
    ):
        known = [at for at in places if names[i] in at and names[j] in at]
        if known:
            data.append(
                _marks([at[names[i]] for at in known], [at[names[j]] for at in known],
                       what, symbol, colour)
            )  # fmt: skip
    first, second = (words.abbreviate(names[k], 16) for k in pair)
    title = f"Tr[R] over {first} and {second}"
    layout = words.layout(
        320,
        title,
        showlegend=True,
        margin={"l": 56, "r": 14, "t": 58, "b": 42},
        xaxis=words.axis(words.titled(first, units[i]), showgrid=False),
        yaxis=words.axis(words.titled(second, units[j]), showgrid=False),
    )
    return Figure(data, layout, title)


def find_least(x: Array, y: Array, z: Array, *, grid: bool) -> tuple[Array, Array, Array]:
    """Centres of cells (n,), (m,) and the least z in each, (m, n); NaN where there is no point.

    `grid`: the points lie on one, each a cell of its own.
    """
    if grid and np.unique(x).size * np.unique(y).size <= 4 * z.size:
        across, up = np.unique(x), np.unique(y)
        column, row = np.searchsorted(across, x), np.searchsorted(up, y)
    else:
        across, column = _cells(x)
        up, row = _cells(y)
    least = np.full((up.size, across.size), np.inf)
    np.minimum.at(least, (row, column), z)
    return across, up, np.where(np.isfinite(least), least, np.nan)


def _cells(x: Array) -> tuple[Array, Any]:
    edges = np.linspace(x.min(), x.max(), CELLS + 1)
    return 0.5 * (edges[1:] + edges[:-1]), np.clip(np.digitize(x, edges) - 1, 0, CELLS - 1)


def draw_ellipses(fit: Fit, leave_out: Sequence[str] = ()) -> list[Figure]:
    """95 % of the pairs that are correlated most, those above 0.9 first; at least one pair."""
    known = [
        name
        for name, at in fit.parameters.items()
        if at.standard_error > 0 and name not in leave_out
    ]
    places = [fit.names.index(name) for name in known]
    ranked = sorted(
        combinations(range(len(known)), 2),
        key=lambda pair: -abs(fit.correlation[places[pair[0]], places[pair[1]]]),
    )
    strong = [p for p in ranked if abs(fit.correlation[places[p[0]], places[p[1]]]) > 0.9]
    figures = []
    for i, j in (strong or ranked[:1])[:ELLIPSES]:
        first, second = known[i], known[j]
        around = fit.ellipse(first, second)
        r = fit.correlation[places[i], places[j]]
        one, other = words.abbreviate(first, 16), words.abbreviate(second, 16)
        title = f"{one} and {other}: correlation {r:.3f}".replace("-", "−")
        at, beside = fit.parameters[first], fit.parameters[second]
        data: list[dict[str, Any]] = [
            {"type": "scatter", "mode": "lines", "x": around[:, 0], "y": around[:, 1],
             "line": {"color": words.MODELLED, "width": 1.5}, "hoverinfo": "x+y"},
            _marks([at.value], [beside.value], "estimate", "x", words.ALARM),
        ]  # fmt: skip
        layout = words.layout(
            300,
            title,
            margin={"l": 56, "r": 14, "t": 34, "b": 42},
            xaxis=words.axis(words.titled(one, at.unit), nticks=5),
            yaxis=words.axis(words.titled(other, beside.unit), nticks=5),
        )
        name = in_figure(f"{first} and {second}")
        figures.append(Figure(data, layout, f"95 % ellipse of {name}"))
    return figures
