# SPDX-License-Identifier: BSD-3-Clause
"""Figures of causes: residual against channels, and added-variable plots of candidates."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from sepcal import _core
from sepcal._core import ChannelMisfit
from sepcal.columns import Array
from sepcal.comparison import Comparison
from sepcal.markup import in_figure
from sepcal.reporting import words
from sepcal.reporting.page import Figure
from sepcal.reporting.thin import keep_even

MEANS = 14  # bins whose mean an added-variable plot shows
FARTHEST = 25  # points of each output that an added-variable plot always shows
CHANNELS = 12  # drawn; the others are named


def best_channels(comparison: Comparison) -> list[ChannelMisfit]:
    """Every channel with the output where it explains the most, the largest share first."""
    best: dict[str, ChannelMisfit] = {}
    for channel in comparison.channels:
        best.setdefault(channel.driver, channel)
    return list(best.values())


def draw_channels(comparison: Comparison, read: Callable[[str], Array | None]) -> list[Figure]:
    """Residuals over the channels that they follow most; `read` gives one's values, (N,)."""
    outputs = [misfit.output for misfit in comparison.overall]
    figures: list[Figure] = []
    for channel in best_channels(comparison)[:CHANNELS]:
        x, place = read(channel.driver), outputs.index(channel.output)
        residual = comparison.residuals[:, place]
        if x is None or (smooth := _core.smooth(x, residual)) is None:
            continue
        driver = words.abbreviate(channel.driver, 22)
        output = words.abbreviate(channel.output, 14)
        title = f"{driver}: {words.percent(channel.share_smooth)} of {output}"
        _, _, per = channel.unit.partition(" per ")
        x_title = words.titled(words.abbreviate(channel.driver, 24), per)
        y_title = words.titled("residual", comparison.overall[place].unit)
        figures.append(draw_channel(title, x_title, y_title, x, residual, smooth))
    return figures


def draw_channel(
    title: str,
    x_title: str,
    y_title: str,
    x: Array,
    residual: Array,
    smooth: tuple[Array, Array, Array],
) -> Figure:
    """A cloud of residuals over a channel, the spline through it, and its band about zero."""
    kept = keep_even(x.size)
    at, mean, half_width = smooth
    data: list[dict[str, Any]] = [
        {"type": "scatter", "mode": "markers", "x": x[kept], "y": residual[kept],
         "marker": {"size": 3, "color": "rgba(120,132,144,0.45)"}, "hoverinfo": "skip"},
        words.band(at, mean - half_width, mean + half_width, "rgba(184,58,38,0.20)"),
        {"type": "scatter", "mode": "lines", "x": at, "y": mean,
         "line": {"color": words.ALARM, "width": 2}},
    ]  # fmt: skip
    layout = words.layout(
        220,
        title,
        margin={"l": 48, "r": 8, "t": 30, "b": 38},
        xaxis=words.axis(x_title, nticks=5),
        yaxis=words.axis(
            y_title, zeroline=True, zerolinecolor="#8b949c", nticks=5, range=visible(residual)
        ),
    )
    return Figure(data, layout, f"{title}: residual against {x_title}")


def visible(residual: Array) -> list[float]:
    """A range that holds all but the farthest thousandth on either side, and a little room."""
    low, high = np.quantile(residual, [0.001, 0.999])
    room = 0.08 * max(high - low, 1e-300)
    return [float(low - room), float(high + room)]


def draw_added_variable(
    title: str, explained: Array, residual: Array, noise: Array, outputs: list[str]
) -> Figure:
    """Residual over what adding the candidate explains, both in units of the noise.

    Args:
        title: The candidate's name.
        explained: Old minus new residual, (N, n_z); NaN where there is none.
        residual: (N, n_z).
        noise: Standard deviations, (n_z,).
        outputs: n_z names.
    """
    x, y = explained / noise, residual / noise
    data: list[dict[str, Any]] = []
    names = [words.abbreviate(output, 24) for output in outputs]
    for i in range(len(outputs)):
        there = np.flatnonzero(np.isfinite(x[:, i]))
        kept = there[keep_even(there.size, 500)]
        kept = np.union1d(kept, there[np.argsort(-np.abs(x[there, i]))[:FARTHEST]])
        colour = words.BY_OUTPUT[i % len(words.BY_OUTPUT)]
        data.append({
            "type": "scatter", "mode": "markers", "name": in_figure(names[i]), "x": x[kept, i],
            "y": y[kept, i],
            "marker": {"size": 3, "color": colour, "opacity": 0.35}, "hoverinfo": "skip",
        })  # fmt: skip
    whole = np.isfinite(x)
    low, high = float(np.min(x[whole])), float(np.max(x[whole]))
    means = _core.bin_means(x[whole], y[whole], MEANS)
    data += [
        {"type": "scatter", "mode": "lines", "showlegend": False, "x": [low, high],
         "y": [low, high], "line": {"color": words.INK, "width": 1.4, "dash": "dash"}},
        {"type": "scatter", "mode": "markers", "showlegend": False, "x": means[0], "y": means[1],
         "marker": {"size": 8, "color": "#fff", "line": {"width": 2, "color": words.INK}}},
    ]  # fmt: skip
    rows = words.legend_rows(names)
    layout = words.layout(
        302 + 18 * rows,
        words.abbreviate(title, 34),
        showlegend=len(outputs) > 1,
        margin={"l": 48, "r": 10, "t": 40 + 18 * rows, "b": 42},
        xaxis=words.axis("what it explains [sigma]"),
        yaxis=words.axis("residual [sigma]", zeroline=True, zerolinecolor="#8b949c"),
    )
    return Figure(data, layout, f"Added-variable plot of {title}")
