# SPDX-License-Identifier: BSD-3-Clause
"""docs/performance.md's tables and its picture, from lab/benchmarks/results/latest.json alone.

Usage: python -m benchmarks.pages [DOCS]. It needs matplotlib, which scripts/setup installs.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.results import result_of

ROOT = Path(__file__).parents[2]
RESULTS = ROOT / "lab" / "benchmarks" / "results" / "latest.json"
BEGIN, END = "<!-- results -->\n", "<!-- end of results -->"
# Each reads on a white page and on a dark one.
GREY, OURS, THEIRS = "#7d858f", "#2f81f7", "#dd641b"

Json = dict[str, Any]


def describe(race: Json) -> str:
    """Where and of what a table is."""
    machine = race["machine"]
    return f"`{race['commit']}` on {machine['processor']} ({machine['instructions']})"


def tables(held: Json) -> str:
    """What was measured, then all races."""
    measured = sorted({describe(race) for race in held["races"]})
    parts = ["Measured: " + "; ".join(measured) + "."]
    parts += [result_of(race).table() for race in held["races"]]
    return "\n\n".join(parts)


def put_between(page: str, text: str) -> str:
    """The page with what stands between its two marks replaced. Raises ValueError without them."""
    found = re.search(f"{re.escape(BEGIN)}.*?{re.escape(END)}", page, re.S)
    if found is None:
        raise ValueError(f"the page lacks the marks {BEGIN.strip()} and {END}")
    return page[: found.start()] + BEGIN + "\n" + text + "\n\n" + END + page[found.end() :]


def series(held: Json, title: str) -> tuple[list[float], list[float]]:
    """Counts and seconds of the growth table whose title begins so; empty where it wasn't run."""
    for race in held["races"]:
        if race["race"] == "growth" and race["title"].startswith(title):
            return [float(count) for count in race["facts"]], list(race["facts"].values())
    return [], []


def whole_fits(held: Json) -> dict[str, tuple[list[float], list[float]]]:
    """Rows and median seconds of the fit's peers with white noise, by name."""
    peers: dict[str, tuple[list[float], list[float]]] = {}
    for race in held["races"]:
        rows = re.match(r"The whole fit, ([\d,]+) rows, white", race["title"])
        if race["race"] not in ("fit", "long-fit") or rows is None:
            continue
        for line in race["competitors"]:
            if not line["name"].startswith("sepcal"):
                counts, seconds = peers.setdefault(line["name"], ([], []))
                counts.append(float(rows[1].replace(",", "")))
                seconds.append(line["median"])
    return peers


def draw_growth(axes: Axes, counts: list[float], seconds: list[float], label: str) -> None:
    """Sepcal's times by what is counted, on two logarithmic axes."""
    axes.loglog(counts, seconds, "o-", color=OURS, markersize=4)
    axes.set_xlabel(label)
    axes.set_ylabel("CPU time of a fit [s]")


def draw_peers(axes: Axes, held: Json) -> None:
    """The best of Eigen + Ceres at each length, and NumPy + SciPy."""
    peers = whole_fits(held)
    for start, shade, marker in (("Eigen", THEIRS, "s"), ("NumPy", GREY, "^")):
        best: dict[float, float] = {}
        for name, (counts, seconds) in peers.items():
            if name.startswith(start):
                for count, second in zip(counts, seconds, strict=True):
                    best[count] = min(second, best.get(count, second))
        axes.plot(list(best), list(best.values()), marker + "--", color=shade, markersize=5)
        if best:
            label = {"Eigen": "Eigen + Ceres, the best", "NumPy": "NumPy + SciPy"}[start]
            axes.annotate(label, max(best.items()), (-6, 4), textcoords="offset points",
                          color=shade, ha="right")  # fmt: skip


def draw(held: Json, picture: Path) -> None:
    """Three panels: rows, samples, threads."""
    with mpl.rc_context():
        mpl.rc("font", size=10)
        mpl.rc("axes", labelcolor=GREY, edgecolor=GREY)
        mpl.rc("xtick", color=GREY)
        mpl.rc("ytick", color=GREY)
        mpl.rc("svg", hashsalt="sepcal")  # the same names within the file every time
        figure = Figure(figsize=(10.0, 3.6), layout="constrained")
        by_rows, by_samples, by_threads = figure.subplots(1, 3, width_ratios=[2, 1.3, 0.8])
        draw_growth(by_rows, *series(held, "Growth with rows"), "rows")
        draw_peers(by_rows, held)
        draw_growth(by_samples, *series(held, "Growth with samples"), "samples of stage one")
        counts, seconds = series(held, "Wall time by threads")
        by_threads.bar([f"{count:.0f}" for count in counts], seconds, color=OURS, width=0.5)
        by_threads.set_xlabel("threads")
        by_threads.set_ylabel("wall time of a fit [s]")
        for axes in (by_rows, by_samples, by_threads):
            axes.spines[["top", "right"]].set_visible(False)
        figure.savefig(picture, transparent=True, metadata={"Date": None})


def write(held: Json, docs: Path) -> None:
    """performance.md, between its marks, and performance.svg."""
    page = docs / "performance.md"
    page.write_text(put_between(page.read_text(), tables(held)))
    draw(held, docs / "performance.svg")


if __name__ == "__main__":
    write(json.loads(RESULTS.read_text()), Path(sys.argv[1] if sys.argv[1:] else ROOT / "docs"))
