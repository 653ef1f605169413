# SPDX-License-Identifier: BSD-3-Clause
"""Figures of frequency responses and of inputs to be flown."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sepcal.columns import Array
from sepcal.plotting.drawings import draw_column, name_bands
from sepcal.reporting import words
from sepcal.reporting.page import Figure

if TYPE_CHECKING:
    from sepcal.frequency_responses import FrequencyResponse
    from sepcal.input_design import InputDesign

HERTZ = "frequency [Hz]"


def picture_response(found: FrequencyResponse) -> list[Figure]:
    """Magnitude, phase and coherence of every input, a row each."""
    drawn = []
    for i, name in enumerate(found.inputs):
        sizes = (found.magnitude[:, i], found.magnitude_low[:, i], found.magnitude_high[:, i])
        angles = (found.phase[:, i], found.phase_low[:, i], found.phase_high[:, i])
        of = f"of {found.output} by {name}"
        drawn += name_bands(
            [
                _over_band(f"magnitude {of}", "magnitude [dB]", found.frequencies,
                           *(_decibels(size) for size in sizes)),
                _over_band(f"phase {of}", "phase [deg]", found.frequencies,
                           *(np.degrees(angle) for angle in angles)),
                _over_band(f"coherence {of}", "coherence", found.frequencies,
                           found.coherence[:, i], range=[0.0, 1.02]),
            ],
            "confidence interval",
        )  # fmt: skip
    return drawn


def picture_design(made: InputDesign) -> list[Figure]:
    """Every signal over time."""
    return [
        draw_column(name, name, made.time, signal, [], "time [s]")
        for name, signal in made.signals.items()
    ]


def _decibels(size: Array) -> Array:
    with np.errstate(divide="ignore"):
        decibels = 20.0 * np.log10(size)
    return np.where(np.isfinite(decibels), decibels, np.nan)  # a circle that holds zero


def _over_band(
    title: str,
    y_title: str,
    x: Array,
    middle: Array,
    low: Array | None = None,
    high: Array | None = None,
    **axis: object,
) -> Figure:
    data: list[dict[str, Any]] = []
    if low is not None and high is not None:
        there = np.isfinite(low) & np.isfinite(high)
        data.append(words.band(x[there], low[there], high[there], words.BAND))
    data.append({
        "type": "scatter", "mode": "lines+markers", "x": x, "y": middle, "hoverinfo": "x+y",
        "line": {"color": words.MODELLED, "width": 1.2},
        "marker": {"size": 4, "color": words.MODELLED},
    })  # fmt: skip
    layout = words.layout(
        220,
        words.abbreviate(title, 48),
        margin={"l": 56, "r": 8, "t": 30, "b": 38},
        xaxis=words.axis(HERTZ, range=[float(x[0]), float(x[-1])], nticks=6),
        yaxis=words.axis(y_title, nticks=5, **axis),
    )
    return Figure(data, layout, title)
