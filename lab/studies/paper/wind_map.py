# SPDX-License-Identifier: BSD-3-Clause
"""When two stages matter for the five-hole probe.

Each method's success over wind, excitation, noise, and how little is known of the probe's mounting.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import cos, pi, radians, sin
from typing import TYPE_CHECKING, Any

from numpy.random import Generator, default_rng

from studies.paper.parts import Options, Part, Result, Table, exact, over, rate
from studies.paper.probe_flights import (
    METHODS,
    PAPER_BOUNDS,
    SAME,
    TRUTH,
    Bounds,
    Ending,
    Question,
    fly,
    least_of,
    try_all,
)
from studies.study import Progress

if TYPE_CHECKING:
    from matplotlib.figure import Figure

AIRSPEED = 17.4  # of the simulated aircraft, mean [m/s]
RATIOS = (0.0, 0.25, 0.5, 1.0, 2.0, 3.0)  # wind over airspeed
NOISES = (0.15, 0.9, 3.0)  # [m/s]
EXCITATIONS = ("rich", "poor")
ROWS = 400
STARTS = 5  # random ones a flight
FLIGHTS_A_RUN = 100  # 1,000 runs are 10 flights a cell, 30 a share of the tables
ANGLES = ("b_alpha", "b_beta", "eps_phi")
WITHIN = {"known": 15.0, "hardly known": 90.0, "unbounded": 170.0, "unknown": 170.0}  # [deg]
MOUNTINGS = {
    "known": "Table 6's probe, angles bounded by 15 deg",
    "hardly known": "Table 6's probe, angles bounded by 90 deg",
    "unbounded": "Table 6's probe, angles bounded by 170 deg",
    "unknown": "angles anywhere within 120 deg, bounded by 170 deg",
}


@dataclass(frozen=True)
class Cell:
    """A condition."""

    mounting: str
    excitation: str
    ratio: float
    noise: float


def bounds_of(cell: Cell) -> Bounds:
    """The wind's leave room for twice what it is; the scale errors' are the paper's."""
    angle = radians(WITHIN[cell.mounting])
    wind = max(60.0, 2.0 * cell.ratio * AIRSPEED)
    return {
        **PAPER_BOUNDS,
        "b_va": (-10.0, 10.0),
        **dict.fromkeys(ANGLES, (-angle, angle)),
        **dict.fromkeys(("w_n", "w_e", "w_d"), (-wind, wind)),
    }


def draw_truth(cell: Cell, rng: Generator) -> dict[str, float]:
    """The wind from anywhere; a probe of unknown mounting turned anyhow."""
    from_where = rng.uniform(0.0, 2.0 * pi)
    wind = cell.ratio * AIRSPEED
    truth = {**TRUTH, "w_n": wind * cos(from_where), "w_e": wind * sin(from_where)}
    if cell.mounting == "unknown":
        truth |= {name: rng.uniform(-radians(120.0), radians(120.0)) for name in ANGLES}
    return truth


def fly_cell(seed: int, cell: Cell, flight: int) -> dict[str, list[Ending]]:
    """One flight, fitted in every way."""
    rng = default_rng([seed, flight, int(100 * cell.ratio), int(100 * cell.noise)])
    truth = draw_truth(cell, rng)
    noise = dict.fromkeys(("vn", "ve", "vd"), cell.noise)
    data = fly(int(rng.integers(2**31)), truth, noise, rows=ROWS, excitation=cell.excitation)
    return try_all(Question(data, bounds_of(cell)), rng, STARTS)[1]


def run(options: Options, report_progress: Progress) -> Result:
    """Every cell."""
    flights = max(2, options.runs // FLIGHTS_A_RUN)
    cells = [
        Cell(mounting, excitation, ratio, noise)
        for mounting in MOUNTINGS
        for excitation in EXCITATIONS
        for ratio in RATIOS
        for noise in NOISES
    ]
    work = [(cell, flight) for cell in cells for flight in range(flights)]
    flown = over(work, lambda one: fly_cell(options.seed, *one), options, report_progress)
    found: dict[Cell, list[dict[str, list[Ending]]]] = {cell: [] for cell in cells}
    for (cell, _), endings in zip(work, flown, strict=True):
        found[cell].append(endings)
    tallies = {cell: tally(ends) for cell, ends in found.items()}
    reached, of = pool(tallies, excitation="rich").at_least["two stages"]
    return Result(
        tables_of(tallies, flights),
        {"flights a cell": flights, "cells": [in_numbers(*one) for one in tallies.items()]},
        {"map": partial(draw_map, tallies)},
        [
            exact(
                "map: two stages end at the least cost found, rich excitation",
                reached >= 0.98 * of,
                f"{reached} of {of}",
                "98 %",
            )
        ],
    )


@dataclass(frozen=True)
class Tally:
    """Of some flights: how many fits of each method ended at the least cost found, of how many."""

    at_least: Mapping[str, tuple[int, int]]
    said_open: int  # flights that two stages called not identifiable
    flights: int


def tally(flown: Sequence[Mapping[str, Sequence[Ending]]]) -> Tally:
    """Counts them."""
    at_least = {}
    for method in METHODS:
        ends = [(end, least_of(one)) for one in flown for end in one[method]]
        at_least[method] = (sum(end.cost < least + SAME for end, least in ends), len(ends))
    said_open = sum(one["two stages"][0].open for one in flown)
    return Tally(at_least, said_open, len(flown))


Tallies = Mapping[Cell, Tally]


def pool(tallies: Tallies, **chosen: str | float) -> Tally:
    """Of all cells that have these values."""
    some = [
        one
        for cell, one in tallies.items()
        if all(getattr(cell, name) == value for name, value in chosen.items())
    ]
    at_least = {
        method: (
            sum(one.at_least[method][0] for one in some),
            sum(one.at_least[method][1] for one in some),
        )
        for method in METHODS
    }
    return Tally(at_least, sum(one.said_open for one in some), sum(one.flights for one in some))


def tables_of(tallies: Tallies, flights: int) -> list[Table]:
    """One a mounting and excitation, against the wind; one against the noise."""
    kinds = [(mounting, excitation) for mounting in MOUNTINGS for excitation in EXCITATIONS]
    return [*(map_table(*kind, tallies, flights) for kind in kinds), noise_table(tallies)]


def alike(tallies: Tallies) -> str:
    """What the variants of stage two differ in, in a sentence."""
    two, variants = METHODS[0], METHODS[1:3]
    apart = sum(
        one.at_least[two] != one.at_least[variant]
        for one in tallies.values()
        for variant in variants
    )
    if apart == 0:
        return "With xi2 alone, or jointly, stage two ended there as often in every cell."
    return f"With xi2 alone, or jointly, stage two differs in {apart} of {2 * len(tallies)} counts."


SHOWN = (METHODS[0], *METHODS[3:])


def map_table(mounting: str, excitation: str, tallies: Tallies, flights: int) -> Table:
    """Success against the wind, over all noises."""
    at = [pool(tallies, mounting=mounting, excitation=excitation, ratio=ratio) for ratio in RATIOS]
    rows = [[method, *(rate(*one.at_least[method]) for one in at)] for method in SHOWN]
    shares = [rate(one.said_open, one.flights) for one in at]
    rows.append(["two stages say: not identifiable", *shares])
    title = f"The least cost found, {MOUNTINGS[mounting]}, {excitation} excitation"
    note = (
        f"{ROWS} rows; {flights} flights at each of {len(NOISES)} noises; {STARTS} random starts "
        f"a flight. {alike(tallies)}"
    )
    return Table(title, ["wind over airspeed", *(f"{r:g}" for r in RATIOS)], rows, note)


def noise_table(tallies: Tallies) -> Table:
    """Success against the noise, over all winds, where the mounting is unknown."""
    at = [
        pool(tallies, mounting="unknown", excitation=excitation, noise=noise)
        for excitation in EXCITATIONS
        for noise in NOISES
    ]
    rows = [[method, *(rate(*one.at_least[method]) for one in at)] for method in SHOWN]
    head = ["noise [m/s]", *(f"{n:g}, {e}" for e in EXCITATIONS for n in NOISES)]
    return Table(f"The least cost found, {MOUNTINGS['unknown']}, all winds", head, rows)


def in_numbers(cell: Cell, one: Tally) -> dict[str, Any]:
    """For JSON."""
    return {
        "mounting": cell.mounting,
        "excitation": cell.excitation,
        "wind over airspeed": cell.ratio,
        "noise": cell.noise,
        "least cost": dict(one.at_least),
        "says open": one.said_open,
        "flights": one.flights,
    }


def draw_map(tallies: Tallies, figure: Figure) -> None:
    """Success against the wind, a panel a mounting and excitation."""
    panels = figure.subplots(len(EXCITATIONS), len(MOUNTINGS), sharex=True, sharey=True)
    for i, excitation in enumerate(EXCITATIONS):
        for j, mounting in enumerate(MOUNTINGS):
            panel = panels[i][j]
            at = [pool(tallies, mounting=mounting, excitation=excitation, ratio=r) for r in RATIOS]
            for method in SHOWN:
                counts = [one.at_least[method] for one in at]
                seen = [100.0 * reached / of for reached, of in counts]
                style = "-" if method.startswith("two") else "--"
                panel.plot(RATIOS, seen, style, marker=".", linewidth=1.0, label=method)
            panel.set_title(f"{mounting}, {excitation}", fontsize=8)
            panel.set_ylim(-5.0, 105.0)
            if j == 0:
                panel.set_ylabel("at the least cost [%]", fontsize=8)
            if i == len(EXCITATIONS) - 1:
                panel.set_xlabel("wind over airspeed [1]", fontsize=8)
    lines, names = panels[0][0].get_legend_handles_labels()
    figure.legend(lines, names, loc="outside lower center", ncols=2, fontsize=7)


PARTS = (
    Part(
        "map",
        "each method's success against wind over airspeed, excitation, noise and mounting",
        run,
    ),
)
