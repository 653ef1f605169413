# SPDX-License-Identifier: BSD-3-Clause
"""Pictures that plot() draws of flights, checks and estimates along a record."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.plotting.drawings import draw_column, name_bands, shade_rows
from sepcal.reporting.figures_fit import Run, runs_of, shade
from sepcal.reporting.figures_states import draw_beside_zero, draw_with_band
from sepcal.reporting.page import Figure
from sepcal.reporting.trajectory import draw_record

if TYPE_CHECKING:
    from sepcal.checking import FlightCheck
    from sepcal.filters import SmoothedPass
    from sepcal.flight import Flight
    from sepcal.smoothing import Smoothed
    from sepcal.tracking import Track

DEVIATIONS = "2 standard deviations to either side"
COLUMNS = 12  # of a flight, where none are named


def picture_flight(flight: Flight, columns: Sequence[str] | None) -> list[Figure]:
    """Columns over time, maneuvers shaded."""
    time, x_title = time_of(flight)
    names = [name for name in flight if not name.startswith("time")][:COLUMNS]
    for name in columns or ():
        if name not in flight:
            raise _core.Error(f"column '{name}' is missing; {flight._core.list_columns()}")
    stripes = shade(_maneuvers(flight, time))
    return [_draw(flight, name, time, stripes, x_title) for name in columns or names]


def picture_check(check: FlightCheck, flight: Flight) -> list[Figure]:
    """The model's columns over time; red where something was noted about the column."""
    time, x_title = time_of(flight)
    there = set(flight)
    read = [at.header for at in check.columns if at.quantity and at.header in there]
    drawn = []
    for name in read:
        if name.startswith("time"):
            continue
        concerned = [
            shade_rows(note.first_s, note.last_s)
            for note in check.notes
            if name in note.columns and math.isfinite(note.first_s) and x_title != "row"
        ]
        drawn.append(_draw(flight, name, time, concerned, x_title))
    return drawn


def time_of(flight: Flight) -> tuple[Array, str]:
    """The flight's times [s] and the words for their axis; rows where it has none in seconds."""
    if "time_s" in set(flight):
        return np.asarray(flight["time_s"]), "time [s]"
    return np.arange(flight.rows, dtype=float), "row"


def _draw(
    flight: Flight, name: str, time: Array, shapes: list[dict[str, Any]], x_title: str
) -> Figure:
    return draw_column(name, name, time, np.asarray(flight[name]), shapes, x_title)


def _maneuvers(flight: Flight, time: Array) -> list[Run]:
    labels = flight.maneuvers
    if not labels:
        return []
    edges = [0, *(i for i in range(1, len(labels)) if labels[i] != labels[i - 1]), len(labels)]
    return runs_of(time, [(labels[a], a, b) for a, b in itertools.pairwise(edges)])


def picture_track(track: Track, what: str) -> list[Figure]:
    """Every estimate with its band, or every innovation, over time."""
    has_time = track.time.size == len(track.rows)
    at = track.time if has_time else track.rows.astype(float)
    x_title = "time [s]" if has_time else "row"
    runs = _since_changes(track, at)
    said = [f"shaded {name}" for name, _, _ in runs]
    if what == "innovations":
        drawn = [
            draw_beside_zero(
                f"innovation of {name}", track.units.get(name, "1"), at, track.innovations[:, i],
                np.full(at.size, float(np.nanstd(track.innovations[:, i]))), runs, x_title,
            )
            for i, name in enumerate(track.outputs)
        ]  # fmt: skip
        return name_bands(drawn, ", ".join(["2 standard deviations of them all", *said]))
    drawn = [
        draw_with_band(
            name,
            track.units.get(name, "1"),
            at,
            track.estimates[:, i],
            track.standard_deviations[:, i],
            runs,
            x_title,
        )
        for i, name in enumerate(track.names)
        if track.standard_deviations[:, i].any()
    ]
    return name_bands(drawn, ", ".join([DEVIATIONS, *said]))


def _since_changes(track: Track, at: Array) -> list[Run]:
    """The stretches behind each change, named by what jumped."""
    onsets = [float(at[np.searchsorted(track.rows, change.onset)]) for change in track.changes]
    ends = [*onsets[1:], float(at[-1])] if onsets else []
    names = [", ".join(moved.name for moved in change.parameters) for change in track.changes]
    return [(f"since {name} jumped", onset, end)
            for name, onset, end in zip(names, onsets, ends, strict=True)]  # fmt: skip


def picture_smoothed(smoothed: Smoothed, what: str) -> list[Figure]:
    """States, innovations or process noise."""
    time = smoothed.time
    at = np.arange(len(smoothed.x), dtype=float) if time is None else time
    kinds = {"state": smoothed.states, "output": smoothed.outputs, "noise": smoothed.noises}
    units = {
        f"{kind} {name}": "1" if kind == "noise" else smoothed.units.get(name, "1")
        for kind, names in kinds.items()
        for name in names
    }
    rows = np.flatnonzero(np.isfinite(smoothed.x).any(axis=1))
    x_title = "row" if time is None else "time [s]"
    drawn = draw_record(smoothed, what, at[rows], rows, [], units, x_title)
    return name_bands(drawn, DEVIATIONS)


def picture_pass(smoothed: SmoothedPass) -> list[Figure]:
    """The states of a filter's pass."""
    at = np.arange(len(smoothed.x), dtype=float)
    errors = np.sqrt(np.diagonal(smoothed.covariance, axis1=1, axis2=2))
    drawn = [
        draw_with_band(f"x[{i}]", "1", at, smoothed.x[:, i], errors[:, i], [], "sample")
        for i in range(smoothed.x.shape[1])
    ]
    return name_bands(drawn, DEVIATIONS)
