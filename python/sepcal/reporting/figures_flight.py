# SPDX-License-Identifier: BSD-3-Clause
"""Figures of what the flight covered: directions on a sphere, flow angles, heading and speed."""

from __future__ import annotations

from typing import Any

import numpy as np

from sepcal.columns import Array
from sepcal.reporting import words
from sepcal.reporting.page import Figure

DENSITY = [[0, "#e4edf6"], [0.5, "#5b94cc"], [1, "#123f73"]]
BINS = 48  # of a map, each way
QUARTERS = [0, 90, 180, 270, 360]  # [deg]
TURN: dict[str, Any] = {
    "tickvals": QUARTERS, "ticktext": [f"{at}" for at in QUARTERS], "range": [0, 360],
}  # fmt: skip
CELLS = (6, 12)  # of a sphere, of equal area: rows of latitude, columns of longitude
SIDES = [(0, 0, "nose"), (90, 0, "right"), (-90, 0, "left"), (0, -90, "belly"), (0, 90, "roof")]


def draw_map(
    title: str, x: Array, y: Array, x_title: str, y_title: str, *, compass: bool = False
) -> Figure:
    """Where a flight was in two quantities: the logarithm of the rows in each cell.

    By `compass` x is a direction of 0 to 360 deg, and the whole turn is shown.
    """
    there = np.isfinite(x) & np.isfinite(y)
    counts, x_edges, y_edges = np.histogram2d(x[there], y[there], BINS)
    share = np.where(counts > 0, np.log10(np.maximum(counts, 1)), np.nan).T
    data = [{
        "type": "heatmap", "z": share, "x": 0.5 * (x_edges[1:] + x_edges[:-1]),
        "y": 0.5 * (y_edges[1:] + y_edges[:-1]), "colorscale": DENSITY, "showscale": False,
        "hoverongaps": False, "hovertemplate": "%{x:.3g}, %{y:.3g}<extra></extra>",
    }]  # fmt: skip
    layout = words.layout(
        290,
        title,
        xaxis=words.axis(x_title, **(TURN if compass else {})),
        yaxis=words.axis(y_title),
    )
    return Figure(data, layout, title)


def draw_rose(title: str, degrees: Array) -> Figure:
    """Share of the rows on each of 24 headings, area true to it."""
    valid = degrees[np.isfinite(degrees)]
    counts = np.bincount((valid // 15).astype(int) % 24, minlength=24)
    share = 100 * counts / max(valid.size, 1)
    data = [{
        "type": "barpolar", "r": np.sqrt(share), "theta": 7.5 + 15.0 * np.arange(24),
        "width": [15] * 24, "customdata": share, "marker": {"color": "#5b94cc"},
        "hovertemplate": "%{theta:.0f}°: %{customdata:.1f} % of the rows<extra></extra>",
    }]  # fmt: skip
    layout = words.layout(
        290,
        title,
        margin={"l": 30, "r": 30, "t": 46, "b": 26},
        polar={
            "bgcolor": "#fff",
            "domain": {"y": [0, 0.94]},
            "angularaxis": {"direction": "clockwise", "rotation": 90, "dtick": 30,
                            "gridcolor": words.RULE, "linecolor": "#b9c1c8"},
            "radialaxis": {"showticklabels": False, "ticks": "", "gridcolor": words.RULE,
                           "showline": False},
        },
    )  # fmt: skip
    return Figure(data, layout, title)


def draw_histogram(title: str, values: Array, x_title: str) -> Figure:
    """Share of the rows by value."""
    valid = values[np.isfinite(values)]
    counts, edges = np.histogram(valid, 40)
    data = [{
        "type": "bar", "x": 0.5 * (edges[1:] + edges[:-1]), "y": 100 * counts / max(valid.size, 1),
        "marker": {"color": "#5b94cc"}, "hovertemplate": "%{x:.3g}: %{y:.1f} %<extra></extra>",
    }]  # fmt: skip
    layout = words.layout(
        290, title, bargap=0.04, xaxis=words.axis(x_title), yaxis=words.axis("% of the rows")
    )
    return Figure(data, layout, title)


def project(longitude: Array, latitude: Array) -> tuple[Array, Array]:
    """Mollweide's equal-area map of angles [rad]: x within +-2, y within +-1."""
    angle = np.array(latitude, dtype=float)
    for _ in range(30):
        step = 2 * angle + np.sin(2 * angle) - np.pi * np.sin(latitude)
        slope = 2 + 2 * np.cos(2 * angle)
        angle = angle - np.where(slope > 1e-9, step / np.maximum(slope, 1e-9), 0.0)
    angle = np.clip(angle, -np.pi / 2, np.pi / 2)
    return 2 / np.pi * longitude * np.cos(angle), np.sin(angle)


def covered_cells(vectors: Array) -> tuple[int, int]:
    """Cells of equal area that directions (N, 3) visit, and all there are."""
    length = np.linalg.norm(vectors, axis=1)
    unit = vectors[length > 0] / length[length > 0, None]
    rows = np.clip(((unit[:, 2] + 1) / 2 * CELLS[0]).astype(int), 0, CELLS[0] - 1)
    turn = (np.arctan2(unit[:, 1], unit[:, 0]) / (2 * np.pi)) % 1
    columns = np.clip((turn * CELLS[1]).astype(int), 0, CELLS[1] - 1)
    return len(set((rows * CELLS[1] + columns).tolist())), CELLS[0] * CELLS[1]


def draw_sphere(title: str, vectors: Array) -> Figure:
    """Directions (N, 3) in body axes on an equal-area map, the nose in the middle."""
    rows = np.unique(np.linspace(0, len(vectors) - 1, min(len(vectors), 2500)).astype(int))
    v = vectors[rows]
    x, y = project(np.arctan2(v[:, 1], v[:, 0]), -np.arctan2(v[:, 2], np.hypot(v[:, 0], v[:, 1])))
    data: list[dict[str, Any]] = []
    grid = {"type": "scatter", "mode": "lines", "hoverinfo": "skip"}
    turn = np.linspace(-np.pi, np.pi, 61)
    for degrees in range(-60, 61, 30):
        gx, gy = project(turn, np.full(61, np.radians(degrees)))
        data.append({**grid, "x": gx, "y": gy, "line": {"color": words.RULE, "width": 1}})
    for degrees in range(-180, 181, 45):
        gx, gy = project(np.full(61, np.radians(degrees)), turn / 2)
        rim = abs(degrees) == 180
        line = {"color": "#8b949c" if rim else words.RULE, "width": 1.2 if rim else 1}
        data.append({**grid, "x": gx, "y": gy, "line": line})
    data.append({
        "type": "scatter", "mode": "markers", "x": x, "y": y, "hoverinfo": "skip",
        "marker": {"size": 4, "color": words.MODELLED, "opacity": 0.4},
    })  # fmt: skip
    notes = []
    for longitude, latitude, side in SIDES:
        px, py = project(np.array([np.radians(longitude)]), np.array([np.radians(latitude)]))
        notes.append({
            "x": float(px[0]), "y": float(py[0]), "text": side, "showarrow": False,
            "font": {"size": 11, "color": words.INK}, "bgcolor": "rgba(255,255,255,0.75)",
            "yshift": 8 * np.sign(latitude),
        })  # fmt: skip
    hidden = {"visible": False, "fixedrange": True}
    layout = words.layout(
        290,
        title,
        margin={"l": 8, "r": 8, "t": 40, "b": 16},
        annotations=notes,
        xaxis={**hidden, "range": [-2.05, 2.05]},
        yaxis={**hidden, "range": [-1.1, 1.1], "scaleanchor": "x"},
    )
    return Figure(data, layout, title)
