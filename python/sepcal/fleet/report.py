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

MOST_DRAWN = 12  # vehicles, in time


def fleet_report(fleet: Fleet) -> str:
    """The page. Raises Error where plotly is not installed."""
    found, watched = fleet.diagnose(), fleet.monitor()
    sections = [
        _missing(found),
        _vehicles(fleet),
        _flights(fleet),
        _in_time(watched),
    ]
    return build_page(
        Page(f"Fleet of {len(fleet.vehicles)} vehicles", _verdict(fleet, found, watched), sections),
        read_plotly(),
    )


def _verdict(fleet: Fleet, found: FleetDiagnosis, watched: Monitoring) -> Html:
    lines: list[Html] = []
    if found.found:
        first = found.found[0]
        lines.append(html("<h1>{}</h1>", f"Missing: {sentence_of(first)}"))
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
        lines.append(html("<p>{} logs could not be used.</p>", len(fleet.left_out)))
    return join("\n", lines)


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
    data: dict[str, Any] = {
        "type": "scatter", "mode": "markers", "x": np.arange(len(values), dtype=float), "y": values,
        "text": [in_figure(name) for name in names],
        "hovertemplate": "%{text}: %{y:.5g}<extra></extra>",
        "marker": {"size": 5, "color": words.MODELLED},
    }  # fmt: skip
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
            f"{one.drop:.3g}",
        ]
        for one in (*found.found, *found.others[:8])
    ]
    head = [("effect", False), ("where", False), ("p", True), ("drop of the misfit", True)]
    lead = (
        f"{len(found.found)} found. With all of them the misfit per reading falls from "
        f"{found.misfit_before:.3g} to {found.misfit_after:.3g}; of noise alone it is 1."
        if found.found
        else "No test is significant; these come nearest."
    )
    return Section("What is missing", lead, [table(head, rows)])


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
    misfits = np.array([flight.misfit for flight in flights])
    names = [flight.log.name for flight in flights]
    worst = sorted(flights, key=lambda flight: -flight.misfit)[:8]
    rows = [
        [one.log.name, one.log.vehicle, f"{one.misfit:.3g}", f"{one.factor.rmse:.3g}"]
        for one in worst
    ]
    head = [("worst flight", False), ("vehicle", False), ("misfit", True), ("rmse", True)]
    lead = "How well the vehicle's parameters fit each of its flights."
    figure = _draw_points("Misfit per reading", "flights", "noise alone: 1", misfits, names)
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
