# SPDX-License-Identifier: BSD-3-Clause
"""A fleet as one HTML page: what is missing, where, who departs, how parameters run."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sepcal.fleet.findings import FleetDiagnosis, in_short, sentence_of
from sepcal.fleet.fleet import Fleet
from sepcal.fleet.monitoring import Monitoring
from sepcal.fleet.passes import vehicle_error
from sepcal.markup import Html, html, in_figure, join
from sepcal.reporting import words
from sepcal.reporting.page import Figure, Grid, Page, Section, build_page, read_plotly

MOST_DRAWN = 12  # vehicles, in time


def fleet_report(fleet: Fleet) -> str:
    """The page. Raises Error where plotly is not installed."""
    found, watched = fleet.diagnose(), fleet.monitor()
    sections = [
        _missing(found),
        _vehicles(fleet),
        _flights(fleet),
        _in_time(fleet, watched),
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


def _table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> Html:
    top = join("", (html("<th>{}</th>", cell) for cell in head))
    body = join(
        "\n",
        (
            html("<tr>{}</tr>", join("", (html("<td>{}</td>", cell) for cell in row)))
            for row in rows
        ),
    )
    return html(
        '<div class="table"><table><thead><tr>{}</tr></thead><tbody>{}</tbody></table></div>',
        top,
        body,
    )


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
    lead = (
        f"{len(found.found)} found. With all of them the misfit per reading falls from "
        f"{found.misfit_before:.3g} to {found.misfit_after:.3g}; of noise alone it is 1."
        if found.found
        else "No test is significant; these come nearest."
    )
    return Section(
        "What is missing", lead, [_table(["effect", "where", "p", "drop of the misfit"], rows)]
    )


def _vehicles(fleet: Fleet) -> Section:
    """Each parameter of each vehicle, sorted, with two standard errors."""
    vehicles = list(fleet.vehicles.values())
    figures = []
    for k, name in enumerate(fleet.parameters):
        values = np.array([fit.values[k] for fit in vehicles])
        errors = np.array([vehicle_error(fit, k) for fit in vehicles])
        order = np.argsort(values)
        names = [in_figure(vehicles[i].vehicle) for i in order]
        data = [{
            "type": "scatter", "mode": "markers", "x": np.arange(len(order), dtype=float),
            "y": values[order], "text": names, "hovertemplate": "%{text}: %{y:.5g}<extra></extra>",
            "error_y": {"type": "data", "array": 2 * errors[order], "thickness": 1, "width": 0},
            "marker": {"size": 5, "color": words.MODELLED},
        }]  # fmt: skip
        layout = words.layout(
            260, name, xaxis=words.axis("vehicles, sorted"), yaxis=words.axis(name)
        )
        figures.append(Figure(data, layout, f"{name} of each vehicle"))
    return Section(
        "Vehicles", "Each vehicle's parameters with two standard errors, sorted.",
        [Grid(figures)],
    )  # fmt: skip


def _flights(fleet: Fleet) -> Section:
    flights = list(fleet.flights.values())
    misfits = np.array([flight.misfit for flight in flights])
    names = [in_figure(flight.log.name) for flight in flights]
    data = [{
        "type": "scatter", "mode": "markers", "x": np.arange(len(flights), dtype=float),
        "y": misfits, "text": names, "hovertemplate": "%{text}: %{y:.3g}<extra></extra>",
        "marker": {"size": 4, "color": words.MODELLED},
    }]  # fmt: skip
    layout = words.layout(
        280, "Misfit per reading", xaxis=words.axis("flights"), yaxis=words.axis("noise alone: 1")
    )
    worst = sorted(flights, key=lambda flight: -flight.misfit)[:8]
    rows = [
        [one.log.name, one.log.vehicle, f"{one.misfit:.3g}", f"{one.factor.rmse:.3g}"]
        for one in worst
    ]
    return Section(
        "Flights",
        "How well the vehicle's parameters fit each of its flights.",
        [
            Figure(data, layout, "misfit of each flight"),
            _table(["worst flight", "vehicle", "misfit", "rmse"], rows),
        ],
    )


def _in_time(fleet: Fleet, watched: Monitoring) -> Section:
    """Of vehicles that changed, else of those that depart most."""
    named = [one.vehicle for one in watched.changes] + [one.vehicle for one in watched.departures]
    shown = list(dict.fromkeys(named))[:MOST_DRAWN]
    series = {one.vehicle: one for one in watched.series}
    figures = []
    for vehicle in shown:
        one = series[vehicle]
        change = next((c for c in watched.changes if c.vehicle == vehicle), None)
        depart = next(d for d in watched.departures if d.vehicle == vehicle)
        name = change.parameter if change else depart.parameter
        k = watched.parameters.index(name)
        values, errors = np.asarray(one.values)[k], np.asarray(one.errors)[k]
        data = [{
            "type": "scatter", "mode": "markers", "x": np.arange(len(values), dtype=float),
            "y": values, "text": [in_figure(flight) for flight in one.flights],
            "hovertemplate": "%{text}: %{y:.5g}<extra></extra>",
            "error_y": {"type": "data", "array": 2 * errors, "thickness": 1, "width": 0},
            "marker": {"size": 5, "color": words.MODELLED},
        }]  # fmt: skip
        title = f"{in_figure(vehicle)}: {name}" + (" changes" if change else "")
        layout = words.layout(240, title, xaxis=words.axis("flights"), yaxis=words.axis(name))
        figures.append(Figure(data, layout, f"{vehicle}: {name} from flight to flight"))
    lead = (
        "Parameters that changed, and vehicles that are farthest from the others: each flight by "
        "itself, with two standard errors."
    )
    return Section("In time", lead, [Grid(figures)] if figures else [])
