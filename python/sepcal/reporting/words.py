# SPDX-License-Identifier: BSD-3-Clause
"""Numbers and names for people, and the look that all figures share."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.markup import Html, as_html, html, in_figure

INK, QUIET, RULE = "#1c2127", "#5c6670", "#e6e9ec"
MEASURED, MODELLED, ALARM = "#9aa3ab", "#2463a8", "#b83a26"
BAND = "rgba(36,99,168,0.16)"
HELD_OUT, PROMISED = "#d98a2b", "#1c2127"
ON_HELD_OUT = "#1d2228"  # words on its bars: dark in either theme
BY_OUTPUT = ["#2463a8", "#c4622d", "#2c7a4b", "#7b4fa3", "#8a6d1d", "#4a5560"]
LEGEND_WIDTH, LEGEND_KEY, LETTER = 240, 42, 6.6  # [px] of a small picture, an entry, a letter
FONT = '"Inter","Segoe UI","Helvetica Neue",Helvetica,Arial,"DejaVu Sans",sans-serif'

MEANINGS = {
    "lambda_va": "airspeed scale error", "b_va": "airspeed bias",
    "w_n": "wind, north", "w_e": "wind, east", "w_d": "wind, down",
    "lambda_alpha": "angle-of-attack scale error", "b_alpha": "angle-of-attack bias",
    "lambda_beta": "sideslip scale error", "b_beta": "sideslip bias",
    "eps_phi": "probe's rotation about the longitudinal axis",
    "s_va": "scale of the reading", "c_va": "bias of the reading",
    **{f"lambda_{axis}": f"scale error, {axis}" for axis in "xyz"},
    **{f"n_{axis}": f"hard iron, {axis}" for axis in "xyz"},
    **{f"eta_{axis}": f"misalignment about {axis}" for axis in "xyz"},
    **{f"alpha_{pair}": f"soft iron, {pair}" for pair in ("xy", "xz", "yz")},
}  # fmt: skip
MODELS = dict(_core.shipped_probes())
VERDICTS = {
    "adequate": "Nothing found",
    "effect_missing": "An effect is missing",
    "slow_change": "A slow change",
    "unexplained": "Unexplained structure",
}
NOTHING_ELSE = "Nothing else found"  # adequate, since an effect was added


def number(value: float | None, digits: int = 3) -> Html:
    """With so many significant digits; a dash where it is undefined."""
    if value is None or math.isnan(value):
        return html("–")
    if math.isinf(value):
        return html("∞") if value > 0 else html("−∞")
    if value == 0:
        return html("0")
    text = f"{value:#.{digits}g}".removesuffix(".")
    if "e" in text:
        mantissa, exponent = text.split("e")
        if -5 <= int(exponent) < 6:
            text = f"{value:.{max(0, digits - 1 - int(exponent))}f}"
        else:
            return power_of_ten(mantissa.removesuffix("."), int(exponent))
    return as_html(text.replace("-", "−"))


def abbreviate(name: str, most: int) -> str:
    """The name, its middle left out where it has more than `most` letters."""
    if len(name) <= most:
        return name
    tail = (most - 1) // 2
    return f"{name[: most - 1 - tail]}…{name[len(name) - tail :]}"


def titled(name: str, unit: str) -> str:
    """`airspeed [m/s]`; without brackets where there is no unit."""
    return f"{name} [{unit}]" if unit not in ("1", "") else name


def legend_rows(names: Sequence[str]) -> int:
    """How many rows the legend of a small picture takes: its entries are equally wide."""
    entry = LEGEND_KEY + LETTER * max(map(len, names), default=0)
    return -(-len(names) // max(1, int(LEGEND_WIDTH / entry)))


def power_of_ten(mantissa: str, exponent: int) -> Html:
    """`1.2*10^-7`."""
    signs = (f"{part}".replace("-", "−") for part in (mantissa, exponent))
    return html("{}·10<sup>{}</sup>", *signs)


def estimate(value: float | None, error: float | None, unit: str) -> Html:
    """`1.234 ± 0.056 m/s`, the value to its error's second digit."""
    suffix = unit_suffix(unit)
    if value is None or error is None or not error > 0 or not math.isfinite(error):
        return html("{}{}", number(value, 4), suffix)
    places = 1 - math.floor(math.log10(error))
    if abs(value) >= 1e6 or error < 1e-6:
        return html("{} ± {}{}", number(value, 4), number(error, 2), suffix)
    shown = f"{value:.{max(0, places)}f}".replace("-", "−")
    return html("{} ± {}{}", shown, f"{error:.{max(0, places)}f}", suffix)


def percent(fraction: float | None) -> str:
    """`12 %`; with a decimal below ten. Text, not HTML."""
    if fraction is None or math.isnan(fraction):
        return "–"
    value = 100 * fraction
    if 0 < value < 0.05:
        return "< 0.1 %"
    text = f"{value:.0f}" if abs(value) >= 9.95 else f"{value:.1f}"
    return f"{'0' if text in ('-0.0', '0.0') else text} %".replace("-", "−")


def probability(p: float | None) -> Html:
    """`0.031`, or `3*10^-12` where it is tiny."""
    if p is None or math.isnan(p):
        return html("–")
    if p >= 0.001:
        return as_html(f"{p:.2g}")
    if p < 1e-300:
        return html("&lt; 10<sup>−300</sup>")
    digit, exponent = f"{p:.0e}".split("e")
    return power_of_ten(digit, int(exponent))


def with_unit(value: float | None, unit: str, digits: int = 3) -> Html:
    """A number and its unit; none is shown for 1."""
    return html("{}{}", number(value, digits), unit_suffix(unit))


def unit_suffix(unit: str) -> Html:
    """` m/s`, ` per V` for `1 per V`, nothing for `1`."""
    shown = unit.removeprefix("1 ") if unit.startswith("1 per") else unit
    return html(" {}", shown) if shown not in ("1", "") else html("")


def polygon(x: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """Outlines of a band, one a stretch of finite values, NaN between them; for fill "toself"."""
    valid = np.isfinite(x) & np.isfinite(low) & np.isfinite(high)
    edges = np.flatnonzero(np.diff(valid.astype(int), prepend=0, append=0))
    xs: list[Array] = []
    ys: list[Array] = []
    between = np.array([np.nan])
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        part = slice(first, last)
        xs += [x[part], x[part][::-1], between]
        ys += [low[part], high[part][::-1], between]
    if not xs:
        return np.empty(0), np.empty(0)
    return np.concatenate(xs)[:-1], np.concatenate(ys)[:-1]


def band(x: Array, low: Array, high: Array, colour: str, **more: object) -> dict[str, Any]:
    """A trace that fills between two curves."""
    outline = polygon(x, low, high)
    return {
        "type": "scatter", "mode": "lines", "x": outline[0], "y": outline[1], "fill": "toself",
        "fillcolor": colour, "line": {"width": 0}, "hoverinfo": "skip", **more,
    }  # fmt: skip


def axis(title: str = "", **more: object) -> dict[str, Any]:
    """A quiet axis; the title is text, or Html."""
    return {
        "title": {"text": as_html(title), "standoff": 6, "font": {"size": 12}},
        "gridcolor": RULE,
        "zeroline": False,
        "linecolor": "#b9c1c8",
        "ticks": "outside",
        "ticklen": 3,
        "tickcolor": "#b9c1c8",
        "automargin": True,
        **more,
    }


def layout(height: int, title: str = "", **more: object) -> dict[str, Any]:
    """The layout of a figure `height` px tall; the title is text."""
    legend = {
        "orientation": "h", "x": 0, "y": 1.0, "yanchor": "bottom", "xanchor": "left",
        "itemsizing": "constant", "traceorder": "normal",
    }  # fmt: skip
    return {
        "height": height,
        "font": {"family": FONT, "size": 12, "color": INK},
        "paper_bgcolor": "#fff",
        "plot_bgcolor": "#fff",
        "margin": {"l": 56, "r": 14, "t": 34 if title else 24, "b": 42},
        "title": {"text": in_figure(title), "x": 0, "xref": "paper", "font": {"size": 13}},
        "hoverlabel": {"font": {"size": 12}},
        "hovermode": "closest",
        "showlegend": False,
        "legend": legend,
        **more,
    }
