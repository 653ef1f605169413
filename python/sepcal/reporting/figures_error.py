# SPDX-License-Identifier: BSD-3-Clause
"""How large the error is: the waterfall of a chain of effects, and the heat strip of where."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sepcal._core import HistoryEntry, Misfit
from sepcal.markup import html, in_figure
from sepcal.reporting import words
from sepcal.reporting.page import Figure

CELL, THIN, BESIDE = 40, 14, 200  # [px] of a cell with a number, one without, beside them all
LEGIBLE = 26  # columns of a heat strip whose numbers can be read


@dataclass(frozen=True)
class Step:
    """One bar of the waterfall; NaN where a number is unknown."""

    label: str
    fitted: float  # RMSE over all outputs; of a step not taken, what is predicted
    held_out: float
    promised: float  # what was predicted before the effect was added
    is_next: bool = False  # not taken yet


def steps_of(history: Sequence[HistoryEntry]) -> list[Step]:
    """The first model and what was added to it; none where nothing was."""
    if not history:
        return []
    before = history[0]
    steps = [Step("first model", before.rmse_before, before.held_out_before, math.nan)]
    for entry in history:
        promised = entry.rmse_before * (1 - entry.predicted_drop)
        steps.append(Step(f"+ {entry.effect}", entry.rmse_after, entry.held_out_after, promised))
    return steps


def draw_waterfall(steps: list[Step], floor: float, unit: str) -> Figure:
    """A bar a step, fitted and held out, the promise as a tick, the noise floor as a line."""
    held = any(not math.isnan(step.held_out) for step in steps)
    data: list[dict[str, Any]] = [
        _bars(
            "fitted", steps, [step.fitted for step in steps], -0.19 * held, words.MODELLED, "#fff"
        ),
        _bars(
            "held out",
            steps,
            [step.held_out for step in steps],
            0.19,
            words.HELD_OUT,
            words.ON_HELD_OUT,
        ),
    ]
    data[1]["visible"] = held
    shapes: list[dict[str, Any]] = []
    notes: list[dict[str, Any]] = []
    for i, step in enumerate(steps):
        if not math.isnan(step.promised):
            at = i - 0.19 * held
            shapes.append({
                "type": "line", "x0": at - 0.23, "x1": at + 0.23, "y0": step.promised,
                "y1": step.promised, "line": {"color": words.INK, "width": 3},
            })  # fmt: skip
    if any(not math.isnan(step.promised) for step in steps):
        line = {"color": words.INK, "width": 3}
        data.append({
            "type": "scatter", "mode": "lines", "name": "promised", "x": [None], "y": [None],
            "line": line,
        })  # fmt: skip
    if not math.isnan(floor):
        shapes.append({
            "type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": floor, "y1": floor,
            "line": {"color": words.ALARM, "width": 1.5, "dash": "dash"},
        })  # fmt: skip
        notes.append({
            "xref": "paper", "x": 1, "y": floor, "xanchor": "right", "yanchor": "bottom",
            "text": f"noise floor {words.number(floor)} {in_figure(unit)}",
            "showarrow": False, "font": {"color": words.ALARM, "size": 12},
            "bgcolor": "rgba(255,255,255,0.75)",
        })  # fmt: skip
    ticks = words.axis(
        tickvals=list(range(len(steps))),
        ticktext=[in_figure(words.abbreviate(step.label, 36)) for step in steps],
        tickfont={"size": 13},
        showgrid=False,
        # Room for the noise floor's words at the right, where it is known.
        range=[-0.6, max(len(steps), 2) - (0.4 if math.isnan(floor) else 0.05)],
    )
    layout = words.layout(
        330,
        barmode="overlay",
        showlegend=True,
        shapes=shapes,
        annotations=notes,
        xaxis=ticks,
        yaxis=words.axis(
            f"RMSE over all outputs [{unit}]" if unit else "RMSE, each output by its own before",
            rangemode="tozero",
        ),
    )
    return Figure(data, layout, "The error after every step")


def _bars(
    name: str, steps: list[Step], values: list[float], shift: float, colour: str, ink: str
) -> dict[str, Any]:
    """One bar a step, pale where the step has not been taken."""
    return {
        "type": "bar", "name": name, "x": [i + shift for i in range(len(steps))], "y": values,
        "width": 0.34, "text": ["" if math.isnan(at) else words.number(at) for at in values],
        "textposition": "auto", "insidetextanchor": "middle", "textangle": 0, "cliponaxis": False,
        "hoverinfo": "y+name", "textfont": {"size": 13}, "insidetextfont": {
            "color": [words.INK if step.is_next else ink for step in steps], "size": 13,
        },
        "marker": {"color": colour, "opacity": [0.32 if step.is_next else 1 for step in steps]},
    }  # fmt: skip


def draw_heat_strip(
    where: Sequence[Misfit],
    outputs: list[str],
    floors: list[float],
    per: str = "noise floor",
    title: str = "",
) -> Figure:
    """RMSE by stretch (columns) and output (rows); the colour is its ratio to what `per` calls."""
    stretches = list(dict.fromkeys(misfit.segment for misfit in where))
    shown = {(misfit.output, misfit.segment): misfit for misfit in where}
    values = np.array(
        [
            [shown[output, at].rmse if (output, at) in shown else np.nan for at in stretches]
            for output in outputs
        ]
    )
    ratio = values / np.array(floors)[:, None]
    ticks = [in_figure(words.abbreviate(shorten(at), 24)) for at in stretches]
    legible = len(stretches) <= LEGIBLE
    trace: dict[str, Any] = {
        "type": "heatmap", "z": ratio, "zmin": 1, "zmax": max(2.0, float(np.nanmax(ratio))),
        "x": list(range(len(stretches))), "y": list(range(len(outputs))), "xgap": 2, "ygap": 2,
        "colorscale": [[0, "#f2f5f7"], [0.35, "#f6c98f"], [0.7, "#dd7447"], [1, "#a32a1c"]],
        "customdata": [
            [f"{in_figure(outputs[i])}, {ticks[j]}: {words.number(values[i, j])}"
             for j in range(len(ticks))]
            for i in range(len(outputs))
        ],
        "hovertemplate": html("%{{customdata}}<br>%{{z:.2f}} times the {}<extra></extra>", per),
        "colorbar": {
            "title": {"text": html("times the<br>{}", per)}, "thickness": 10, "outlinewidth": 0,
            "lenmode": "pixels", "len": 130, "y": 1, "yanchor": "top", "nticks": 4,
        },
        "text": [[words.number(value, 2) for value in row] if legible else [] for row in values],
        "texttemplate": "%{text}" if legible else "",
    }  # fmt: skip
    layout = words.layout(
        148 + 40 * len(outputs),
        title,
        xaxis=words.axis(
            tickvals=list(range(len(ticks))), ticktext=ticks, tickangle=-35, showgrid=False,
        ),
        yaxis=words.axis(
            tickvals=list(range(len(outputs))),
            ticktext=[in_figure(words.abbreviate(output, 22)) for output in outputs],
            autorange="reversed", showgrid=False, ticks="",
        ),
    )  # fmt: skip
    least = BESIDE + (CELL if legible else THIN) * len(stretches)
    return Figure([trace], layout, "The error by stretch of the flight and output", least)


def shorten(stretch: str) -> str:
    """A stretch without a label is its times: "3.76597:7.53917" becomes "3.77 to 7.54 s"."""
    first, colon, last = stretch.partition(":")
    try:
        times = float(first), float(last)
    except ValueError:
        return stretch.replace("_", " ")
    return f"{times[0]:.4g} to {times[1]:.4g} s" if colon else stretch
