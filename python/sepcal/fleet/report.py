# SPDX-License-Identifier: BSD-3-Clause
"""A fleet as one HTML page: what is missing, where, who departs, how parameters run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from sepcal.columns import Array
from sepcal.fleet.findings import FleetDiagnosis, in_short, sentence_of
from sepcal.fleet.fleet import Fleet
from sepcal.fleet.monitoring import Monitoring
from sepcal.fleet.passes import vehicle_error
from sepcal.markup import Html, html, in_figure, join
from sepcal.reporting import words
from sepcal.reporting.page import Figure, Grid, Page, Section, build_page, read_plotly
from sepcal.reporting.tables import table

BEFORE = {"size": 5, "color": words.MEASURED}
MOST_DRAWN = 12  # vehicles, in time
MOST_LEFT_OUT = 40  # logs that are named
FEWEST_VEHICLES = 3  # of a population


def fleet_report(fleet: Fleet) -> str:
    """The page. Raises Error where plotly is not installed."""
    found, watched = fleet.diagnose(), fleet.monitor()
    sections = [
        *_added(fleet),
        _missing(found),
        *_population(fleet),
        _vehicles(fleet),
        _flights(fleet),
        _in_time(watched),
        *_left_out(fleet),
    ]
    return build_page(
        Page(f"Fleet of {len(fleet.vehicles)} vehicles", _verdict(fleet, found, watched), sections),
        read_plotly(),
    )


def _verdict(fleet: Fleet, found: FleetDiagnosis, watched: Monitoring) -> Html:
    lines: list[Html] = []
    if found.found:
        first = found.found[0]
        lines.append(html("<h1>{}</h1>", f"Missing: {sentence_of(first)}{found.doubt(first)}"))
    else:
        lines.append(html("<h1>Nothing was found missing in this fleet</h1>"))
    lines.append(
        html(
            "<p>{} flights of {} vehicles, {}.</p>",
            len(fleet.flights),
            len(fleet.vehicles),
            f"{found.tests} tests",
        )
    )
    if found.named_vehicles:
        lines.append(
            html(
                "<p>Vehicles with an effect of their own: {}.</p>", ", ".join(found.named_vehicles)
            )
        )
    if watched.departed:
        lines.append(html("<p>Vehicles that depart: {}.</p>", ", ".join(watched.departed)))
    if fleet.left_out:
        count = len(fleet.left_out)
        lines.append(
            html("<p>{} could not be used.</p>", f"{count} {'logs' if count > 1 else 'log'}")
        )
    return join("\n", lines)


def _points(values: Array, names: Sequence[str]) -> dict[str, Any]:
    return {
        "type": "scatter", "mode": "markers", "x": np.arange(len(values), dtype=float), "y": values,
        "text": [in_figure(name) for name in names],
        "hovertemplate": "%{text}: %{y:.5g}<extra></extra>",
        "marker": {"size": 5, "color": words.MODELLED},
    }  # fmt: skip


def _draw_points(
    title: str,
    x_title: str,
    y_title: str,
    values: Array,
    names: Sequence[str],
    errors: Array | None = None,
    height: int = 260,
) -> Figure:
    """Points side by side, each with two standard errors and a name."""
    data = _points(values, names)
    if errors is not None:
        data["error_y"] = {"type": "data", "array": 2 * errors, "thickness": 1, "width": 0}
    layout = words.layout(
        height, in_figure(title), xaxis=words.axis(x_title), yaxis=words.axis(y_title)
    )
    return Figure([data], layout, title)


def _missing(found: FleetDiagnosis) -> Section:
    rows = [
        [
            one.effect,
            one.vehicle or one.cause,
            in_short(one.p_adjusted),
            f"{100 * one.share:.2g} %",
        ]
        for one in (*found.found, *found.others[:8])
        if one.found or one.p_adjusted < 1.0
    ]
    head = [("effect", False), ("where", False), ("p", True), ("of the misfit", True)]
    lead = (
        f"{len(found.found)} found. With all of them the misfit per reading falls from "
        f"{found.misfit_before:.3g} to {found.misfit_after:.3g}; of noise alone it is 1."
        if found.found
        else f"No test is significant{'; these come nearest' * bool(rows)}."
    )
    notes = [html("<p>{}</p>", note) for note in found.notes]
    return Section("What is missing", lead, [*[table(head, rows)] * bool(rows), *notes])


def _added(fleet: Fleet) -> list[Section]:
    """What each effect did to the error, in the order in which they were added."""
    rows = [
        [
            step["effect"],
            f"{step['rmse_before']:.4g}",
            f"{step['rmse_after']:.4g}",
            f"{step['flights_better']} of {step['flights']}",
        ]
        for step in fleet.added
    ]
    head = [("effect", False), ("rmse before", True), ("after", True), ("flights better", True)]
    if not rows:
        return []
    last = fleet.added[-1]
    flights = list(last["by_flight"])
    errors = np.array(list(last["by_flight"].values()))
    before = _points(errors[:, 0], flights) | {"name": "before", "marker": BEFORE}
    after = _points(errors[:, 1], flights) | {"name": "after"}
    layout = words.layout(
        280, "", xaxis=words.axis("flights"), yaxis=words.axis("rmse"), showlegend=True
    )
    lead = (
        "The root mean square error, before and after: of all flights, and of each with the last."
    )
    figure = Figure([before, after], layout, "Each flight's rmse before and after the last effect")
    return [Section("What was added", lead, [table(head, rows), figure])]


def _population(fleet: Fleet) -> list[Section]:
    """Means and spreads, where there are vehicles enough."""
    if len(fleet.vehicles) < FEWEST_VEHICLES:
        return []
    population = fleet.population()
    rows = [
        [name, f"{value:.6g}", f"{error:.2g}", population.spread_in_words(name)]
        for name, (value, error) in population.mean.items()
    ]
    head = [("parameter", False), ("mean", True), ("std. error", True), ("spread", True)]
    lead = "Each parameter's mean over vehicles, and its standard deviation between them."
    return [Section("Population", lead, [table(head, rows)])]


def _left_out(fleet: Fleet) -> list[Section]:
    rows = [[name, reason] for name, reason in list(fleet.left_out.items())[:MOST_LEFT_OUT]]
    rest = len(fleet.left_out) - len(rows)
    lead = f"Logs that could not be used, and why{f'; {rest} more are in fleet.json' * bool(rest)}."
    return [Section("Left out", lead, [table([("log", False), ("why", False)], rows)])] * bool(rows)


def _vehicles(fleet: Fleet) -> Section:
    """Each parameter of each vehicle, sorted, with two standard errors."""
    vehicles = list(fleet.vehicles.values())
    figures = []
    for k, name in enumerate(fleet.parameters):
        if name in fleet.common:
            continue
        values = np.array([fit.values[k] for fit in vehicles])
        errors = np.array([vehicle_error(fit, k) for fit in vehicles])
        order = np.argsort(values)
        names = [vehicles[i].vehicle for i in order]
        figures.append(
            _draw_points(name, "vehicles, sorted", name, values[order], names, errors[order])
        )
    lead = "Each vehicle's parameters with two standard errors, sorted."
    return Section("Vehicles", lead, [Grid(figures)])


def _flights(fleet: Fleet) -> Section:
    flights = list(fleet.flights.values())
    errors = np.array([flight.factor.rmse for flight in flights])
    names = [flight.log.name for flight in flights]
    worst = sorted(flights, key=lambda flight: -flight.factor.rmse)[:8]
    rows = [
        [one.log.name, one.log.vehicle, f"{one.factor.rmse:.3g}", f"{one.misfit:.3g}"]
        for one in worst
    ]
    head = [("worst flight", False), ("vehicle", False), ("rmse", True), ("misfit", True)]
    lead = (
        "The error that its vehicle's parameters leave of each flight. Misfit is -2 ln L per "
        "reading, against the noise that the flight shows: 1 for noise alone."
    )
    figure = _draw_points("Error of each flight", "flights", "rmse", errors, names)
    return Section("Flights", lead, [figure, table(head, rows)])


def _in_time(watched: Monitoring) -> Section:
    """Of vehicles that changed, then of those that are farthest from the others."""
    shown = {one.vehicle: (one.parameter, " changes") for one in watched.changes}
    for departure in watched.departures:
        shown.setdefault(departure.vehicle, (departure.parameter, ""))
    series = {one.vehicle: one for one in watched.series}
    figures = []
    for vehicle, (name, what) in list(shown.items())[:MOST_DRAWN]:
        one = series[vehicle]
        k = watched.parameters.index(name)
        values, errors = np.asarray(one.values)[k], np.asarray(one.errors)[k]
        title = f"{vehicle}: {name}{what}"
        figures.append(_draw_points(title, "flights", name, values, one.flights, errors, 240))
    lead = (
        "Parameters that changed, and vehicles that are farthest from the others: each flight by "
        "itself, with two standard errors."
    )
    return Section("In time", lead, [Grid(figures)] if figures else [])
