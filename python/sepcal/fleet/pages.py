# SPDX-License-Identifier: BSD-3-Clause
"""A fleet's estimates as a page of text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from sepcal import _core
from sepcal.fleet.passes import vehicle_error
from sepcal.printing import aligned, in_line

if TYPE_CHECKING:
    from sepcal.fleet.fleet import Fleet

MOST_VEHICLES = 40
MOST_COLUMNS = 5  # of parameters


def fleet_page(fleet: Fleet) -> str:
    """Vehicles with their parameters, what was left out, and what effects did."""
    vehicles = fleet.vehicles
    flights = fleet.flights
    misfit = float(np.median([flight.misfit for flight in flights.values()]))
    lines = [
        f"{len(flights)} flights of {len(vehicles)} vehicles, each with parameters of its own; "
        f"own to each flight: {', '.join(fleet.own) or 'none'}.",
        *_common(fleet),
        f"Misfit per reading of a typical flight, of noise alone 1: {misfit:.3g}.",
        "",
    ]
    if len(vehicles) == 1:
        lines.insert(
            2, "One vehicle: tell vehicles apart by a field {vehicle} of --names, or by folders."
        )
    own = {name: k for k, name in enumerate(fleet.parameters) if name not in fleet.common}
    if len(own) > MOST_COLUMNS:
        return "\n".join([*lines, *_by_parameter(fleet, own), *_rest(fleet)])
    rows = [["vehicle", "flights", *own]]
    for name, fit in list(vehicles.items())[:MOST_VEHICLES]:
        cells = []
        for k in own.values():
            told = np.isfinite(fit.values[k])
            cells.append(_with_error(fit, k) if told else "not told")
        rows.append([in_line(name), str(fit.flights), *cells])
    lines += aligned(rows)
    if any("not told" in row for row in rows):
        lines.append("not told: its flights don't show it, or their error wanders too much for it.")
    if len(vehicles) > MOST_VEHICLES:
        lines.append(f"... and {len(vehicles) - MOST_VEHICLES} more")
    return "\n".join([*lines, *_rest(fleet)])


def _with_error(fit: _core.VehicleFit, k: int) -> str:
    return f"{fit.values[k]:.5g} +- {vehicle_error(fit, k):.2g}"


def _common(fleet: Fleet) -> list[str]:
    """What all vehicles share."""
    fit = next(iter(fleet.vehicles.values()))
    sizes = [
        in_line(f"{name} = {_with_error(fit, fleet.parameters.index(name))}")
        for name in fleet.common
    ]
    return [f"The same in all vehicles: {', '.join(sizes)}."] if sizes else []


def _by_parameter(fleet: Fleet, own: Mapping[str, int]) -> list[str]:
    """Too many for a column each: a row each, over all vehicles."""
    rows = [["parameter", "median", "smallest", "largest", "its vehicle", "typical error"]]
    fits = list(fleet.vehicles.values())
    for name, k in own.items():
        values = np.array([fit.values[k] for fit in fits])
        known = np.flatnonzero(np.isfinite(values))
        if not known.size:
            rows.append([name, "not told", "", "", "", ""])
            continue
        errors = [vehicle_error(fits[i], k) for i in known]
        largest = known[np.argmax(values[known])]
        rows.append(
            [
                name,
                f"{np.median(values[known]):.5g}",
                f"{values[known].min():.5g}",
                f"{values[largest]:.5g}",
                in_line(fits[largest].vehicle),
                f"{np.median(errors):.2g}",
            ]
        )
    return aligned(rows)


def _rest(fleet: Fleet) -> list[str]:
    """What effects did, and what was left out."""
    lines: list[str] = []
    for step in fleet.added:
        lines += [
            "",
            f"With {in_line(step['effect'])} the error fell from {step['rmse_before']:.4g} to "
            f"{step['rmse_after']:.4g}, in {step['flights_better']} of {step['flights']} flights.",
        ]
    if fleet.left_out:
        lines += ["", f"Left out: {len(fleet.left_out)} log{'s' * (len(fleet.left_out) > 1)}."]
        lines += [
            f"  {in_line(name)}: {in_line(reason)}"
            for name, reason in list(fleet.left_out.items())[:5]
        ]
    return lines
