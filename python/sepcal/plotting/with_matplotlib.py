# SPDX-License-Identifier: BSD-3-Clause
"""The same figures by matplotlib: what they use of Plotly, and no more.

Importing this imports matplotlib.
"""

from __future__ import annotations

import itertools
import math
import re
from io import BytesIO
from typing import Any, TypeAlias

import numpy as np
from matplotlib import font_manager
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure as Canvas
from matplotlib.ticker import FixedLocator, MaxNLocator, NullLocator, ScalarFormatter

from sepcal.columns import Array
from sepcal.markup import as_read
from sepcal.reporting.page import Figure

WIDTH, DPI = 960, 100  # [px], [px/inch]
POINTS = 72 / DPI  # a px
FAMILY = ["Inter", "Segoe UI", "Helvetica Neue", "Helvetica", "Arial", "DejaVu Sans"]
DASHES = {"dash": (0, (6, 4)), "dot": (0, (1.5, 2.5))}
RAISED = str.maketrans("0123456789-−", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁻")
Colour: TypeAlias = tuple[float, float, float, float]

STEPS = [1, 2, 5, 10]  # between ticks, as Plotly has them
LIGHT = 0.55  # luminance of a ground on which dark words are read better


class Drawn(Canvas):
    """Shows itself in notebooks; pyplot doesn't know it, so that nothing has to be closed."""

    def _repr_png_(self) -> bytes:
        shown = BytesIO()
        self.savefig(shown, format="png", dpi=self.dpi)
        return shown.getvalue()


def to_matplotlib(figure: Figure) -> Drawn:
    """A matplotlib.figure.Figure."""
    known = {font.name for font in font_manager.fontManager.ttflist}
    family = next((name for name in FAMILY if name in known), "sans-serif")
    height = figure.layout["height"]
    canvas = Drawn(figsize=(WIDTH / DPI, height / DPI), dpi=DPI)
    _Drawing(canvas, figure, family).draw()
    return canvas


class _Drawing:
    """One figure on its way: axes by the names of Plotly's, "x2/y3" or "polar2"."""

    def __init__(self, canvas: Drawn, figure: Figure, family: str) -> None:
        self.canvas, self.figure, self.family = canvas, figure, family
        self.layout = figure.layout
        self.axes: dict[str, Any] = {}
        self.handles: dict[str, Any] = {}
        self.margin = {side: float(self.layout["margin"][side]) for side in "lrtb"}  # [px]
        self.bar: Any = None  # axes, cells and look of the scale of colours, where there is one
        self.beside: list[Any] = []  # the scale's own axes

    def draw(self) -> None:
        """All that the figure has."""
        self.canvas.set_facecolor(_colour(self.layout["paper_bgcolor"]))
        for trace in self.figure.data:
            if trace.get("visible") is not False:
                self._draw_trace(trace)
        for shape in self.layout.get("shapes", ()):
            self._draw_shape(shape)
        for name, axes in self.axes.items():
            if not name.startswith("polar"):
                self._dress(axes, *name.split("/"))
        self._place()
        for mark in self.layout.get("annotations", ()):
            self._draw_words(mark)
        self._draw_title()
        self._draw_legend()

    def _draw_trace(self, trace: dict[str, Any]) -> None:
        {
            "scatter": self._draw_curve,
            "bar": self._draw_bars,
            "heatmap": self._draw_cells,
            "barpolar": self._draw_rose,
        }[trace["type"]](trace)

    def _axes_of(self, trace: dict[str, Any]) -> Any:  # noqa: ANN401
        """Made when it is first met; what shares an axis in Plotly shares it here."""
        x, y = trace.get("xaxis", "x"), trace.get("yaxis", "y")
        name = f"{x}/{y}"
        if name not in self.axes:
            share = next((at for key, at in self.axes.items() if key.startswith(f"{x}/")), None)
            self.axes[name] = self.canvas.add_axes(
                (0.1, 0.1, 0.8, 0.8), sharex=share, label=name, zorder=1
            )
        return self.axes[name]

    def _draw_curve(self, trace: dict[str, Any]) -> None:
        axes = self._axes_of(trace)
        x, y = _numbers(trace["x"]), _numbers(trace["y"])
        line, marker = trace.get("line", {}), trace.get("marker", {})
        handle: Any = None
        if trace.get("fill") == "toself":
            cuts = [0, *(np.flatnonzero(np.isnan(x)) + 1).tolist(), x.size + 1]
            for first, last in itertools.pairwise(cuts):
                part = slice(first, last - 1)
                handle = axes.fill(
                    x[part], y[part], color=_colour(trace["fillcolor"]), lw=0, zorder=2
                )[0]
        elif "lines" in trace["mode"]:
            (handle,) = axes.plot(
                x, y, color=_colour(line["color"]), lw=line["width"] * POINTS,
                ls=DASHES.get(line.get("dash", ""), "-"), zorder=3, solid_joinstyle="round",
            )  # fmt: skip
        if "markers" in trace["mode"]:
            edge = marker.get("line", {})
            handle = axes.scatter(
                x, y, s=(marker["size"] * POINTS) ** 2, c=_colours(marker["color"]),
                alpha=marker.get("opacity"), lw=edge.get("width", 0) * POINTS,
                edgecolors=_colour(edge["color"]) if edge else "none", zorder=4,
            )  # fmt: skip
        self._keep(trace, handle)

    def _draw_bars(self, trace: dict[str, Any]) -> None:
        axes = self._axes_of(trace)
        lies = trace.get("orientation") == "h"
        across = _numbers(trace["y" if lies else "x"])
        length = np.nan_to_num(_numbers(trace["x" if lies else "y"]))
        gap = self.layout.get("bargap", 0.2)
        step = float(np.min(np.diff(across))) if across.size > 1 else 1.0
        width = trace.get("width", (1 - gap) * step)
        marker = trace["marker"]
        colours = _colours(marker["color"], across.size)
        draw = axes.barh if lies else axes.bar
        bars = draw(across, length, width, zorder=2)
        opacities = np.broadcast_to(marker.get("opacity", 1.0), across.shape)
        for bar, colour, opacity in zip(bars, colours, opacities, strict=True):
            bar.set_facecolor((*colour[:3], colour[3] * float(opacity)))
        self._keep(trace, bars[0] if len(bars) else None)
        inside = trace.get("insidetextfont", {}).get("color")
        for i, words in enumerate(trace.get("text", ())):
            if not words:
                continue
            if lies:
                is_left = length[i] < 0
                axes.annotate(
                    _plain(words), (length[i], across[i]), (-4 if is_left else 4, 0),
                    textcoords="offset points", ha="right" if is_left else "left", va="center",
                    **self._font(trace.get("textfont", {})),
                )  # fmt: skip
            else:
                axes.text(
                    across[i], length[i] / 2, _plain(words), ha="center", va="center", zorder=5,
                    **self._font({"size": 13, "color": inside[i]}),
                )  # fmt: skip

    def _draw_cells(self, trace: dict[str, Any]) -> None:
        axes = self._axes_of(trace)
        scale = [(at, _colour(colour)) for at, colour in trace["colorscale"]]
        colours = LinearSegmentedColormap.from_list("figure", scale)
        values = np.array(trace["z"], dtype=float)
        x, y = _edges(_numbers(trace["x"])), _edges(_numbers(trace["y"]))
        mesh = axes.pcolormesh(
            x, y, np.ma.masked_invalid(values), cmap=colours, vmin=trace.get("zmin"),
            vmax=trace.get("zmax"), edgecolors=_colour(self.layout["plot_bgcolor"]),
            linewidth=trace.get("xgap", 0) * POINTS,
        )  # fmt: skip
        for i, row in enumerate(trace.get("text", ()) if trace.get("texttemplate") else ()):
            for j, words in enumerate(row):
                ground = mesh.cmap(mesh.norm(values[i, j]))
                ink = (0.11, 0.13, 0.15) if _luminance(ground) > LIGHT else (1.0, 1.0, 1.0)
                at = (0.5 * (x[j] + x[j + 1]), 0.5 * (y[i] + y[i + 1]))
                axes.text(
                    *at, _plain(words), ha="center", va="center", fontsize=12 * POINTS, color=ink,
                    family=self.family, parse_math=False, clip_on=True,
                )  # fmt: skip
        if "colorbar" in trace:
            self.bar = (axes, mesh, trace["colorbar"])

    def _draw_rose(self, trace: dict[str, Any]) -> None:
        name = trace.get("subplot", "polar")
        axes: Any = self.canvas.add_axes((0.1, 0.1, 0.8, 0.8), polar=True, label=name)
        self.axes[name] = axes
        axes.set_theta_zero_location("N")
        axes.set_theta_direction(-1)
        look = self.layout[name]["angularaxis"]
        axes.set_facecolor(_colour(self.layout["plot_bgcolor"]))
        axes.bar(
            np.radians(trace["theta"]), trace["r"], np.radians(trace["width"]),
            color=_colour(trace["marker"]["color"]), zorder=3,
        )  # fmt: skip
        axes.set_thetagrids(range(0, 360, 30))
        axes.set_yticklabels([])
        axes.grid(color=_colour(look["gridcolor"]))
        axes.spines["polar"].set_color(_colour(look["linecolor"]))
        self._tint(axes)

    def _draw_shape(self, shape: dict[str, Any]) -> None:
        """A line, or a stripe over the whole height."""
        lines = {"color": _colour(shape["line"]["color"]), "zorder": 3.5} if shape["line"].get(
            "color"
        ) else {}  # fmt: skip
        for axes in self._meant(shape):
            if shape["type"] == "rect":
                colour = _colour(shape["fillcolor"])
                axes.axvspan(shape["x0"], shape["x1"], color=colour, lw=0, zorder=0)
                continue
            lines |= {"lw": shape["line"]["width"] * POINTS,
                      "ls": DASHES.get(shape["line"].get("dash", ""), "-")}  # fmt: skip
            if _is_relative(shape.get("xref", "x")):
                axes.axhline(shape["y0"], **lines)
            elif _is_relative(shape.get("yref", "y")):
                axes.axvline(shape["x0"], **lines)
            else:
                axes.plot([shape["x0"], shape["x1"]], [shape["y0"], shape["y1"]], **lines)

    def _meant(self, mark: dict[str, Any]) -> list[Any]:
        """The axes that a shape lies in: all that share what it is measured in."""
        refs = [mark.get("xref", "x").split()[0], mark.get("yref", "y").split()[0]]
        return [
            axes
            for name, axes in self.axes.items()
            if not name.startswith("polar")
            and all(ref in ("paper", own) for ref, own in zip(refs, name.split("/"), strict=True))
        ]

    def _dress(self, axes: Any, x: str, y: str) -> None:  # noqa: ANN401
        """Limits, ticks, grid and titles of an axis."""
        axes.set_facecolor(_colour(self.layout["plot_bgcolor"]))
        axes.set_axisbelow(True)
        axis_colour = _colour(self.layout[f"yaxis{y[1:]}"].get("linecolor", "#8b949c"))
        axes.tick_params(color=axis_colour, length=3, pad=2.5)
        for side in axes.spines.values():
            side.set_color(axis_colour)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        for which, ref in (("x", x), ("y", y)):
            look = self.layout[ref[0] + "axis" + ref[1:]]
            axis = axes.xaxis if which == "x" else axes.yaxis
            ends = look.get("range")
            if look.get("visible") is False:
                axis.set_visible(False)
                for side in axes.spines.values():
                    side.set_visible(False)
            if look.get("type") == "log":
                getattr(axes, f"set_{which}scale")("log")
                axis.set_minor_locator(NullLocator())
                axis.set_major_formatter(_decade)
            elif "tickvals" in look:
                axis.set_major_locator(FixedLocator(look["tickvals"]))
                axis.set_ticklabels([_plain(at) for at in look["ticktext"]])
            else:
                axis.set_major_locator(
                    MaxNLocator(
                        look.get("nticks", 7), steps=STEPS, integer=look.get("tickformat") == "d"
                    )
                )
                axis.set_major_formatter(_Plain(useOffset=False))
            if ends is not None:
                getattr(axes, f"set_{which}lim")(*ends)
            elif which == "y" and look.get("rangemode") == "tozero":
                axes.set_ylim(bottom=0)
            if look.get("autorange") == "reversed":
                axis.set_inverted(True)
            if look.get("zeroline"):
                line = axes.axhline if which == "y" else axes.axvline
                line(0, color=_colour(look["zerolinecolor"]), lw=POINTS, zorder=1)
            if look.get("showgrid", True) and "gridcolor" in look:
                axis.grid(True, color=_colour(look["gridcolor"]), lw=POINTS)
            if "scaleanchor" in look:
                axes.set_aspect("equal", adjustable="box")
            # Of axes that share x the lowest alone has words below it.
            if which == "x" and look.get("anchor", y) != y:
                axis.set_tick_params(labelbottom=False, length=0)
            else:
                title = look.get("title", {}).get("text", "")
                font = {"size": 12, "color": self.layout["font"]["color"]}
                axis.set_label_text(_plain(title), **self._font(font))
            for label in axis.get_ticklabels():
                label.set_rotation(-look.get("tickangle", 0))
                if look.get("tickangle") and which == "x":
                    label.set(ha="right", rotation_mode="anchor")
        self._tint(axes)

    def _tint(self, axes: Any) -> None:  # noqa: ANN401
        """Words at the ticks in the figure's font and ink."""
        ink = _colour(self.layout["font"]["color"])
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_tick_params(labelsize=11.5 * POINTS, labelcolor=ink, width=POINTS)
            for label in axis.get_ticklabels():
                label.set(family=self.family, parse_math=False)

    def _place(self) -> None:
        """By the domains within the margins, which widen until all ticks' words are inside."""
        margin = self.margin
        size = {"l": WIDTH, "b": float(self.layout["height"])}
        legend = 26 if self.layout.get("showlegend") else 0
        for _ in range(2):
            self._spread(margin)
            renderer: Any = FigureCanvasAgg(self.canvas).get_renderer()  # type: ignore[no-untyped-call]
            boxes = [axes.get_tightbbox(renderer) for axes in self.axes.values()]
            boxes += [axes.get_tightbbox(renderer) for axes in self.beside]
            margin["l"] += max(0.0, 6 - min(box.x0 for box in boxes))
            margin["r"] += max(0.0, max(box.x1 for box in boxes) + 6 - size["l"])
            floor = legend if self.layout.get("legend", {}).get("yref") == "container" else 0
            margin["b"] += max(0.0, floor + 5 - min(box.y0 for box in boxes))
            top = max(box.y1 for box in boxes) + 4 - size["b"]
            margin["t"] += max(0.0, top)
        self._spread(margin)

    def _spread(self, margin: dict[str, float]) -> None:
        height = float(self.layout["height"])
        wide, tall = WIDTH - margin["l"] - margin["r"], height - margin["t"] - margin["b"]
        for name, axes in self.axes.items():
            if name.startswith("polar"):
                domain = self.layout[name]["domain"]
                across, down = domain.get("x", [0, 1]), domain.get("y", [0, 1])
            else:
                x, y = (self.layout[ref[0] + "axis" + ref[1:]] for ref in name.split("/"))
                across, down = x.get("domain", [0, 1]), y.get("domain", [0, 1])
            axes.set_position((
                (margin["l"] + across[0] * wide) / WIDTH,
                (margin["b"] + down[0] * tall) / height,
                (across[1] - across[0]) * wide / WIDTH,
                (down[1] - down[0]) * tall / height,
            ))  # fmt: skip
        self._draw_colour_bar()

    def _draw_colour_bar(self) -> None:
        if self.bar is None:
            return
        axes, mesh, look = self.bar
        box = axes.get_position()
        at = (box.x1 + 14 / WIDTH, box.y1 - 130 / self.layout["height"], 10 / WIDTH,
              130 / self.layout["height"])  # fmt: skip
        if not self.beside:
            own = self.canvas.add_axes(at, label="scale")
            shown = self.canvas.colorbar(mesh, cax=own)
            shown.outline.set_visible(False)
            shown.locator = MaxNLocator(4)
            shown.update_ticks()
            title = _plain(look["title"]["text"])
            font = {"size": 12, "color": self.layout["font"]["color"]}
            own.set_title(title, loc="left", **self._font(font))
            ink = _colour(self.layout["font"]["color"])
            own.tick_params(labelsize=11 * POINTS, colors=ink, length=3)
            for label in own.get_yticklabels():
                label.set(family=self.family)
            self.beside = [own]
        self.beside[0].set_position(at)

    def _draw_words(self, mark: dict[str, Any]) -> None:
        """An annotation, in the axes it is measured in or on the whole."""
        name = next(iter(self.axes), "")
        xref, yref = mark.get("xref", "x"), mark.get("yref", "y")
        ends = [ref.split()[0] for ref in (xref, yref)]
        for key in self.axes:
            own = key.split("/")
            if len(own) == 2 and all(e in ("paper", o) for e, o in zip(ends, own, strict=True)):
                name = key
                break
        axes = self.axes[name]
        given = {"x": float(mark["x"]), "y": float(mark["y"])}
        shift = (mark.get("xshift", 0) * POINTS, mark.get("yshift", 0) * POINTS)
        words = _plain(mark["text"])
        across = {"left": "left", "right": "right"}.get(mark.get("xanchor", ""), "center")
        up = {"bottom": "bottom", "top": "top"}.get(mark.get("yanchor", ""), "center")
        font = self._font({**self.layout["font"], **mark.get("font", {})})
        if "bgcolor" in mark:
            font["bbox"] = {"fc": _colour(mark["bgcolor"]), "lw": 0, "pad": 1}
        if angle := mark.get("textangle"):
            font |= {"rotation": -angle, "rotation_mode": "anchor"}
        if "paper" in (xref, yref):
            given = self._on_paper(axes, given, xref, yref)
            axes.annotate(words, (given["x"], given["y"]), shift, xycoords="figure fraction",
                          textcoords="offset points", ha=across, va=up, annotation_clip=False,
                          zorder=6, **font)  # fmt: skip
            return
        systems = tuple("axes fraction" if _is_relative(ref) else "data" for ref in (xref, yref))
        axes.annotate(words, (given["x"], given["y"]), shift, xycoords=systems,
                      textcoords="offset points", ha=across, va=up, annotation_clip=False,
                      zorder=6, **font)  # fmt: skip

    def _on_paper(
        self,
        axes: Any,  # noqa: ANN401
        at: dict[str, float],
        xref: str,
        yref: str,
    ) -> dict[str, float]:
        """The figure's coordinates, from those of Plotly's paper, the figure within its margins."""
        height, margin = float(self.layout["height"]), self.margin
        inside = {"x": WIDTH - margin["l"] - margin["r"], "y": height - margin["t"] - margin["b"]}
        data = axes.transData.transform((at["x"], at["y"]))
        whole = {"x": float(WIDTH), "y": height}
        start = {"x": margin["l"], "y": margin["b"]}
        found = {}
        for i, (which, ref) in enumerate((("x", xref), ("y", yref))):
            px = start[which] + at[which] * inside[which] if ref == "paper" else float(data[i])
            found[which] = px / whole[which]
        return found

    def _draw_title(self) -> None:
        title = self.layout["title"]
        if not title["text"]:
            return
        left = self.margin["l"] / WIDTH
        self.canvas.text(
            left, 1 - 8 / self.layout["height"], _plain(title["text"]), ha="left", va="top",
            **self._font({"color": self.layout["font"]["color"], **title["font"]}),
        )  # fmt: skip

    def _keep(self, trace: dict[str, Any], handle: Any) -> None:  # noqa: ANN401
        """The entries of the legend."""
        if handle is not None and trace.get("showlegend", True) and trace.get("name"):
            self.handles.setdefault(_plain(trace["name"]), handle)

    def _draw_legend(self) -> None:
        if not self.layout.get("showlegend") or not self.handles:
            return
        at_bottom = self.layout["legend"].get("yref") == "container"
        height = self.layout["height"]
        top = 1 - (self.margin["t"] - 2) / height
        shown = self.canvas.legend(
            list(self.handles.values()), list(self.handles), ncols=len(self.handles),
            frameon=False, loc="lower left", borderaxespad=0, borderpad=0.2,
            bbox_to_anchor=(self.margin["l"] / WIDTH, 2 / height if at_bottom else top),
            prop={"family": self.family, "size": 12 * POINTS}, markerscale=1.4,
        )  # fmt: skip
        for text in shown.get_texts():
            text.set(color=_colour(self.layout["font"]["color"]), parse_math=False)
        for handle in shown.legend_handles:
            if handle is not None:
                handle.set_alpha(None)

    def _font(self, font: dict[str, Any]) -> dict[str, Any]:
        ink = font.get("color", self.layout["font"]["color"])
        return {"fontsize": font.get("size", 12) * POINTS, "color": _colour(ink),
                "family": self.family, "parse_math": False}  # fmt: skip


class _Plain(ScalarFormatter):
    """Ticks as they are; tiny ones in millionths or billionths, as Plotly writes them."""

    def format_ticks(self, values: Any) -> list[str]:  # noqa: ANN401
        """The labels of all ticks of an axis."""
        size = max((abs(at) for at in values), default=0.0)
        for scale, prefix in ((1e-9, "n"), (1e-6, "µ")):
            if 0.0 < size < 1000 * scale:
                return [f"{at / scale:.3g}{prefix}".replace("-", "−") for at in values]
        return [str(at) for at in super().format_ticks(values)]


def _is_relative(ref: str) -> bool:
    return ref == "paper" or ref.endswith(" domain")


def _numbers(values: Any) -> Array:  # noqa: ANN401
    return np.array([np.nan if at is None else at for at in values], dtype=float)


def _edges(centres: Array) -> Array:
    """Between cells, and half a cell beyond the outer ones."""
    if centres.size == 1:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    between = 0.5 * (centres[1:] + centres[:-1])
    return np.concatenate(([2 * centres[0] - between[0]], between, [2 * centres[-1] - between[-1]]))


def _colour(text: str) -> Colour:
    """Red, green, blue, opacity of "#rgb", "#rrggbb" or "rgba(...)"."""
    if text.startswith("rgba("):
        red, green, blue, alpha = map(float, text[5:-1].split(","))
        return red / 255, green / 255, blue / 255, alpha
    digits = text[1:] if len(text) == 7 else "".join(2 * digit for digit in text[1:])
    red, green, blue = (int(digits[i : i + 2], 16) / 255 for i in (0, 2, 4))
    return red, green, blue, 1.0


def _colours(given: Any, count: int = 1) -> list[Colour]:  # noqa: ANN401
    return [_colour(given)] * count if isinstance(given, str) else [_colour(at) for at in given]


def _luminance(colour: Any) -> float:  # noqa: ANN401
    return float(0.299 * colour[0] + 0.587 * colour[1] + 0.114 * colour[2])


def _plain(text: object) -> str:
    """Plotly's words as they are read: "1.2·10⁻⁷" of its markup."""
    raised = re.sub(r"<sup>(.*?)</sup>", lambda at: at[1].translate(RAISED), str(text))
    return as_read(raised)


def _decade(value: float, _: object) -> str:
    """A tick of a logarithmic axis."""
    power = round(math.log10(value)) if value > 0 else 0
    return f"{value:g}" if -3 <= power <= 3 else f"10{str(power).translate(RAISED)}"
