# SPDX-License-Identifier: BSD-3-Clause
"""Quantities with their bands over time: states, innovations, process noise."""

from __future__ import annotations

from typing import Any

import numpy as np

from sepcal.columns import Array
from sepcal.reporting import words
from sepcal.reporting.figures_fit import Run, shade
from sepcal.reporting.page import Figure
from sepcal.reporting.thin import keep_extremes

POINTS = 1200  # of a small picture's curve


def draw_with_band(
    title: str,
    unit: str,
    time: Array,
    value: Array,
    deviation: Array,
    runs: list[Run],
    x_title: str = "time [s]",
) -> Figure:
    """A quantity and 2 standard deviations to either side, over time [s]; arrays (N,)."""
    kept = keep_extremes(value, POINTS)
    t, y, sd = time[kept], value[kept], deviation[kept]
    data = [
        words.band(t, y - 2 * sd, y + 2 * sd, words.BAND),
        _line(t, y, words.MODELLED),
    ]
    return _over_time(data, title, unit, time, runs, x_title)


def draw_beside_zero(
    title: str,
    unit: str,
    time: Array,
    value: Array,
    deviation: Array,
    runs: list[Run],
    x_title: str = "time [s]",
) -> Figure:
    """A quantity that should be nothing, before the band of 2 standard deviations about zero."""
    kept = keep_extremes(value, POINTS)
    t, y, sd = time[kept], value[kept], deviation[kept]
    data = [
        words.band(t, -2 * sd, 2 * sd, words.BAND),
        _line(t, y, words.MODELLED, width=0.8),
    ]
    # Where nothing is known yet the band is as wide as can be, and would hide all that follows.
    reach = 1.1 * float(np.nanmax([np.nanmax(np.abs(value)), 2 * np.nanmedian(deviation)]))
    return _over_time(data, title, unit, time, runs, x_title, range=[-reach, reach])


def _line(t: Array, y: Array, colour: str, width: float = 1.2) -> dict[str, Any]:
    return {
        "type": "scatter", "mode": "lines", "x": t, "y": y, "hoverinfo": "x+y",
        "line": {"color": colour, "width": width},
    }  # fmt: skip


def _over_time(
    data: list[dict[str, Any]],
    title: str,
    unit: str,
    time: Array,
    runs: list[Run],
    x_title: str,
    **axis: object,
) -> Figure:
    y_title = words.abbreviate(title.partition(" of ")[0], 20)  # of "residual of mx" the first
    layout = words.layout(
        220,
        words.abbreviate(title, 40),
        margin={"l": 56, "r": 8, "t": 30, "b": 38},
        shapes=shade(runs),
        xaxis=words.axis(x_title, range=[float(np.min(time)), float(np.max(time))], nticks=6),
        yaxis=words.axis(words.titled(y_title, unit), nticks=5, **axis),
    )
    return Figure(data, layout, f"{title} over {x_title.partition(' ')[0]}")
