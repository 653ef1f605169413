# SPDX-License-Identifier: BSD-3-Clause
"""Measured over modelled, and what lies between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sepcal._core import FlightFigures
from sepcal.columns import Array
from sepcal.comparison import Comparison
from sepcal.markup import html, in_figure
from sepcal.reporting import words
from sepcal.reporting.page import Figure
from sepcal.reporting.thin import Rows, keep_extremes

NAMED = 16  # maneuvers whose names fit above a picture
BACKGROUND = ("", "cruise")  # labels of flying between maneuvers, left unshaded
GAP_SHARE = 0.01  # of the flight: no line bridges a longer gap

Run = tuple[str, float, float]  # a maneuver: label, first and last time [s]


@dataclass(frozen=True)
class Channel:
    """One output over time; arrays of shape (N,)."""

    name: str
    unit: str
    measured: Array  # NaN where it can't be told
    modelled: Array
    residual: Array  # as the engine has it
    noise: float  # standard deviation


def draw_fit(comparison: Comparison, figures: FlightFigures, noise: Mapping[str, float]) -> Figure:
    """A calibration's outputs over time; `noise` is theirs where it was fitted."""
    channels = [
        Channel(
            "strength" if misfit.output == "field" else misfit.output,
            misfit.unit,
            figures.measured[:, i],
            figures.modelled[:, i],
            comparison.residuals[:, i],
            noise[misfit.output],
        )
        for i, misfit in enumerate(comparison.overall)
    ]
    after_gaps = [first for _, first, _ in figures.runs[1:]]
    return draw_overlay(
        comparison.time, channels, runs_of(comparison.time, figures.segments), after_gaps
    )


def runs_of(time: Array, segments: Sequence[tuple[str, int, int]]) -> list[Run]:
    """Label, first and last time [s] of each maneuver; none where the log has no labels."""
    if not any(label for label, _, _ in segments):
        return []
    return [(label, float(time[a]), float(time[b - 1])) for label, a, b in segments]


def draw_overlay(
    time: Array, channels: list[Channel], runs: list[Run], after_gaps: list[int]
) -> Figure:
    """Every output over the same time [s], measured over modelled; below each, its residual.

    `runs` are the maneuvers, `after_gaps` the rows before which the log has a gap.
    """
    is_long = np.diff(time, prepend=time[:1]) > GAP_SHARE * (time[-1] - time[0])
    breaks = np.zeros(time.size)
    breaks[after_gaps] = is_long[after_gaps]
    breaks = np.cumsum(breaks)  # number of gaps up to each row
    data: list[dict[str, Any]] = []
    slot = 1 / len(channels)
    shapes = shade(runs, 0.08 * slot)
    named = [run for run in runs if run[0] not in BACKGROUND]
    named = named if len(named) <= NAMED else []
    room = 88 if named else 30  # [px] above the first output, for names and the legend
    layout = words.layout(
        250 * len(channels) + room + 50,
        showlegend=True,
        shapes=shapes,
        annotations=[_name(run) for run in named],
        margin={"l": 62, "r": 72 if named else 14, "t": room, "b": 78},
        legend={"orientation": "h", "x": 0, "xanchor": "left", "y": 0, "yref": "container",
                "yanchor": "bottom", "traceorder": "normal"},
    )  # fmt: skip
    for i, channel in enumerate(channels):
        top = 1 - i * slot
        main, strip = f"y{2 * i + 1}", f"y{2 * i + 2}"
        kept = keep_extremes(channel.residual)
        data += _trace(channel, time[kept], kept, breaks, main, strip, legend=i == 0)
        layout[main.replace("y", "yaxis")] = words.axis(
            words.titled(words.abbreviate(channel.name, 16), channel.unit),
            domain=[top - 0.60 * slot, top],
        )
        layout[strip.replace("y", "yaxis")] = words.axis(
            _residual(channel.unit), domain=[top - 0.92 * slot, top - 0.65 * slot], nticks=4
        )
        for sign in (-2, 2):
            level = sign * channel.noise
            shapes.append({
                "type": "line", "xref": "paper", "x0": 0, "x1": 1, "yref": strip, "y0": level,
                "y1": level, "line": {"color": words.INK, "width": 1, "dash": "dot"},
            })  # fmt: skip
    layout["yaxis"] = layout.pop("yaxis1")
    bottom = f"y{2 * len(channels)}"
    ends = [float(time[0]), float(time[-1])]
    layout["xaxis"] = words.axis("time [s]", anchor=bottom, range=ends)
    return Figure(data, layout, "Measured and modelled, and the residuals, over time")


def _trace(
    channel: Channel, t: Array, kept: Rows, breaks: Array, main: str, strip: str, *, legend: bool
) -> list[dict[str, Any]]:
    """The curves of one output at the kept rows."""
    broken = np.diff(breaks[kept], prepend=breaks[kept[:1]]) > 0
    m, f, r = (
        np.where(broken, np.nan, at[kept])
        for at in (channel.measured, channel.modelled, channel.residual)
    )
    line: dict[str, Any] = {"mode": "lines", "type": "scatter", "x": t, "xaxis": "x"}
    main = main if main != "y1" else "y"
    show = {"showlegend": legend, "yaxis": main}
    around: list[dict[str, Any]] = []
    if np.isfinite(m).any():
        band = words.band(t, f - 2 * channel.noise, f + 2 * channel.noise, words.BAND, **show)
        grey, blue = {"color": words.MEASURED, "width": 2}, {"color": words.MODELLED, "width": 1.1}
        around = [
            {**band, "name": "modelled, 2-sigma band"},
            {**line, **show, "y": m, "line": grey, "name": "measured"},
            {**line, **show, "y": f, "line": blue, "name": "modelled"},
        ]
    thin = {"color": words.MODELLED, "width": 0.8}
    below = {**line, "y": r, "yaxis": strip, "line": thin, "name": "residual", "showlegend": False}
    return [*around, below]


def _residual(unit: str) -> str:
    """An axis title of two lines: its strip is low."""
    return html("residual<br>[{}]", unit) if unit not in ("1", "") else "residual"


def shade(runs: list[Run], bottom: float = 0.0) -> list[dict[str, Any]]:
    """A pale stripe a maneuver, darker by turns where they adjoin; `bottom` is of the height."""
    shapes = []
    for i, (_, first, last) in enumerate(run for run in runs if run[0] not in BACKGROUND):
        colour = "rgba(40,60,80,0.085)" if i % 2 == 0 else "rgba(40,60,80,0.045)"
        shapes.append({
            "type": "rect", "xref": "x", "yref": "paper", "x0": first, "x1": last,
            "y0": bottom, "y1": 1, "fillcolor": colour, "line": {"width": 0}, "layer": "below",
        })  # fmt: skip
    return shapes


def _name(run: Run) -> dict[str, Any]:
    """A maneuver's name above the picture."""
    return {
        "x": 0.5 * (run[1] + run[2]), "xref": "x", "y": 1.0, "yref": "paper", "yanchor": "bottom",
        "xanchor": "left", "text": in_figure(run[0].replace("_", " ")), "textangle": -35,
        "showarrow": False, "font": {"size": 11, "color": words.QUIET},
    }  # fmt: skip
