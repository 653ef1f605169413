# SPDX-License-Identifier: BSD-3-Clause
"""Whether what is left is noise: autocorrelation, spectrum, quantiles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.markup import in_figure
from sepcal.reporting import words
from sepcal.reporting.page import Figure

Rows: TypeAlias = tuple[str, int, int]  # label, first row, row after the last
LEAST = 0.1  # a correlation: no axis is drawn finer


def _legend(output: str) -> str:
    return words.abbreviate(output, 24)


def _layout(title: str, outputs: list[str], left: int, **axes: Any) -> dict[str, Any]:  # noqa: ANN401
    """With room for the outputs' names below the title."""
    rows = words.legend_rows([_legend(output) for output in outputs])
    margin = {"l": left, "r": 10, "t": 44 + 18 * rows, "b": 42}
    return words.layout(272 + 18 * rows, title, showlegend=True, margin=margin, **axes)


def _lines(output: str, i: int, x: Array, y: Array) -> dict[str, Any]:
    colour = words.BY_OUTPUT[i % len(words.BY_OUTPUT)]
    return {
        "type": "scatter", "mode": "lines", "name": in_figure(_legend(output)), "x": x, "y": y,
        "line": {"color": colour, "width": 1.4},
    }  # fmt: skip


def draw_autocorrelation(
    outputs: list[str], residuals: Array, runs: list[Rows], interval: float
) -> Figure:
    """Correlation over lag [s], with the limits that white noise keeps nineteen times in twenty."""
    data, widest = [], LEAST
    for i, output in enumerate(outputs):
        lags, values, limit = _core.autocorrelation(residuals[:, i], runs)
        if i == 0:
            grey = "rgba(92,102,112,0.22)"
            data.append(words.band(lags * interval, -limit, limit, grey, showlegend=False))
        widest = max(widest, float(np.nanmax(np.abs(values), initial=0.0)))
        data.append(_lines(output, i, lags * interval, values))
    layout = _layout(
        "Autocorrelation; grey: white noise",
        outputs,
        50,
        xaxis=words.axis("lag [s]", type="log", dtick=1),
        yaxis=words.axis(
            "correlation",
            zeroline=True,
            zerolinecolor="#8b949c",
            range=[-1.05 * widest, 1.05 * widest],
        ),
    )
    return Figure(data, layout, "Autocorrelation of the residuals")


def draw_spectrum(
    outputs: list[str],
    units: Sequence[str],
    residuals: Array,
    runs: list[Rows],
    interval: float,
    floors: list[float],
) -> Figure:
    """Power density over frequency; dotted, white noise of the floor's size."""
    data = []
    for i, output in enumerate(outputs):
        frequency, density = _core.spectrum(residuals[:, i], runs, interval)
        if frequency.size == 0:
            continue
        data.append(_lines(output, i, frequency, density))
        white = 2 * interval * floors[i] ** 2
        floor = _lines(output, i, np.array([frequency[0], frequency[-1]]), np.full(2, white))
        floor["line"] = {**floor["line"], "dash": "dot", "width": 1}
        data.append({**floor, "showlegend": False, "hoverinfo": "skip"})
    per = f"({units[0]})²/Hz" if len(set(units)) == 1 else "unit of each, squared, per Hz"
    layout = _layout(
        "Spectrum; dotted: white noise",
        outputs,
        62,
        xaxis=words.axis("frequency [Hz]", type="log", dtick=1),
        yaxis=words.axis(f"density [{per}]", type="log", exponentformat="power"),
    )
    return Figure(data, layout, "Spectrum of the residuals")


def draw_quantiles(outputs: list[str], residuals: Array, noise: Array) -> Figure:
    """Quantiles of the residual over its noise, against the normal distribution's."""
    data = []
    furthest = 3.0
    for i, output in enumerate(outputs):
        normal, found = _core.quantiles(residuals[:, i] / noise[i])
        trace = _lines(output, i, normal, found)
        data.append(
            {**trace, "mode": "markers", "marker": {"size": 4, "color": trace["line"]["color"]}}
        )
        furthest = max(furthest, float(normal[-1]))
    data.append({
        "type": "scatter", "mode": "lines", "name": "normal", "x": [-furthest, furthest],
        "y": [-furthest, furthest], "line": {"color": words.INK, "width": 1, "dash": "dash"},
        "showlegend": False,
    })  # fmt: skip
    layout = _layout(
        "Quantiles; dashed: normal",
        outputs,
        50,
        xaxis=words.axis("normal quantile [sigma]"),
        yaxis=words.axis("residual [sigma]"),
    )
    return Figure(data, layout, "Quantiles of the residuals against a normal distribution")


def draw_noise(
    outputs: list[str],
    units: Sequence[str],
    residuals: Array,
    runs: list[Rows],
    interval: float,
    floors: list[float],
    noise: Array,
) -> list[Figure]:
    """All three: of residuals (N, n_z) in `units`, `floors` and `noise` their n_z sizes."""
    return [
        draw_autocorrelation(outputs, residuals, runs, interval),
        draw_spectrum(outputs, units, residuals, runs, interval, floors),
        draw_quantiles(outputs, residuals, noise),
    ]
