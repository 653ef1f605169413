# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of each vehicle in time: control limits, changes, and vehicles that depart."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.fleet.logs import AGE
from sepcal.fleet.parquet import or_none
from sepcal.printing import aligned, in_line

if TYPE_CHECKING:
    from sepcal.fleet.passes import FleetFlight

LIMIT = 3.0  # standard errors, as Shewhart's charts have it
ALARM = 3  # an exit code, as of a diagnosis that found something


@dataclass(frozen=True)
class Change:
    """A parameter that changed for good."""

    vehicle: str
    after: str  # the flight before it
    parameter: str
    size: float
    standard_error: float
    p_adjusted: float


@dataclass(frozen=True)
class Departure:
    """How far a vehicle is from the others, by the parameter that is farthest."""

    vehicle: str
    parameter: str
    value: float
    others: float  # their mean
    errors: float  # its distance, in standard deviations of what vehicles and errors spread by
    p_adjusted: float  # for the number of vehicles and parameters


@dataclass(frozen=True)
class Monitoring:
    """A fleet watched; `print` shows the page, `exit_code` is a scheduler's.

    Example:
        >>> files = sepcal.datasets.write_fleet(folder)
        >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
        >>> watched = fleet.monitor()
        >>> watched.departed, watched.exit_code
        ([], 0)
    """

    parameters: tuple[str, ...]
    series: tuple[_core.VehicleSeries, ...]
    changes: tuple[Change, ...]  # significant ones, the surest first
    departures: tuple[Departure, ...]  # all vehicles, the farthest first
    outside: tuple[tuple[str, str, str, float], ...]  # vehicle, flight, parameter, errors
    significance: float

    @property
    def departed(self) -> list[str]:
        """Vehicles that depart significantly, the farthest first."""
        return [one.vehicle for one in self.departures if one.p_adjusted < self.significance]

    @property
    def exit_code(self) -> int:
        """3 where something changed or departs, else 0."""
        return ALARM if self.changes or self.departed else 0

    def to_json(self) -> str:
        """As JSON; a number that is not defined is null.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> '"alarm": false' in fleet.monitor().to_json()
            True
        """
        told = {
            "alarm": bool(self.exit_code),
            "changes": [asdict(one) for one in self.changes],
            "departures": [asdict(one) for one in self.departures],
            "outside": [
                dict(zip(("vehicle", "flight", "parameter", "errors"), one, strict=True))
                for one in self.outside
            ],
            "vehicles": {
                one.vehicle: {
                    "flights": list(one.flights),
                    "parameters": {
                        name: {
                            "values": _finite(np.asarray(one.values)[k]),
                            "standard_errors": _finite(np.asarray(one.errors)[k]),
                        }
                        for k, name in enumerate(self.parameters)
                    },
                }
                for one in self.series
            },
        }
        return json.dumps(told, indent=2, allow_nan=False) + "\n"

    def __str__(self) -> str:
        lines = []
        if not self.changes:
            lines.append("No parameter changed.")
        for one in self.changes:
            lines.append(
                f"{in_line(one.vehicle)}: {one.parameter} changed by {one.size:.4g} +- "
                f"{one.standard_error:.2g} after {in_line(one.after)} (p {one.p_adjusted:.1g})."
            )
        lines.append("")
        names = self.departed
        if names:
            lines.append(f"Vehicles that depart from the others: {', '.join(map(in_line, names))}.")
        else:
            lines.append(
                f"No vehicle departs from the others for sure (p below {self.significance:g}); the "
                "farthest come first."
                if self.departures
                else "Fewer than four vehicles do not show which of them departs."
            )
        rows = [["vehicle", "parameter", "value", "others", "distance", "p"]]
        rows += [
            [
                in_line(one.vehicle),
                one.parameter,
                f"{one.value:.5g}",
                f"{one.others:.5g}",
                f"{one.errors:.2g} s.d.",
                f"{one.p_adjusted:.2g}",
            ]
            for one in self.departures[:10]
        ]
        lines += ["", *aligned(rows)]
        if self.outside:
            lines += ["", f"Single flights beyond {LIMIT:g} standard errors: {len(self.outside)}."]
        return "\n".join(lines)


def watch(
    flights: Sequence[FleetFlight],
    parameters: Sequence[str],
    common: Sequence[str],
    significance: float,
) -> Monitoring:
    """A vehicle's own parameters, its flights in the order of their ages, or as they come."""
    order = sorted(
        range(len(flights)),
        key=lambda i: (flights[i].log.vehicle, flights[i].log.attributes.get(AGE, 0.0), i),
    )
    series = _core.follow_vehicles([flights[i].asked() for i in order], common)
    own = {name: k for k, name in enumerate(parameters) if name not in common}
    changes = [
        Change(
            one.vehicle,
            one.flights[one.change - 1],
            one.parameter,
            one.after - one.before,
            one.standard_error,
            one.p_adjusted,
        )
        for one in series
        if one.p_adjusted < significance and one.change > 0
    ]
    changes.sort(key=lambda one: one.p_adjusted)
    outside = []
    for one in series:
        values, errors = np.asarray(one.values), np.asarray(one.errors)
        for k, name in enumerate(own):
            known = np.isfinite(values[k]) & (errors[k] > 0)
            if known.sum() < 3:
                continue
            weights = np.where(known, 1.0 / errors[k] ** 2, 0.0)
            mean = float(np.nansum(weights * np.where(known, values[k], 0.0)) / weights.sum())
            # A flight's own share in the mean makes its difference from it smaller.
            spread = np.sqrt(np.maximum(errors[k] ** 2 - 1.0 / weights.sum(), 0.0))
            for i in np.flatnonzero(known & (spread > 0)):
                distance = float((values[k, i] - mean) / spread[i])
                if abs(distance) > LIMIT:
                    outside.append((one.vehicle, one.flights[i], name, distance))
    departures = _departures([flights[i] for i in order], own, common)
    return Monitoring(
        tuple(own),
        tuple(series),
        tuple(changes),
        tuple(departures),
        tuple(outside),
        significance,
    )


def _departures(
    flights: Sequence[FleetFlight], own: Mapping[str, int], common: Sequence[str]
) -> list[Departure]:
    """Of each vehicle, against what the others spread by, its own error being added.

    `own`: the vehicles' parameters, and their places.
    """
    fits = _core.fit_vehicles([flight.asked() for flight in flights], common)
    if len(fits) < 4:
        return []
    found: list[Departure] = []
    values = np.array([fit.values for fit in fits])
    variances = np.array(
        [
            np.fmax(np.diag(np.asarray(fit.covariance)), np.diag(np.asarray(fit.jackknife)))
            for fit in fits
        ]
    )
    tests = len(fits) * len(own)
    for v, fit in enumerate(fits):
        best: Departure | None = None
        for name, k in own.items():
            others = [i for i in range(len(fits)) if i != v and np.isfinite(values[i, k])]
            if len(others) < 3 or not np.isfinite(values[v, k]):
                continue
            spread = _core.find_spread(values[others, k].tolist(), variances[others, k].tolist())
            mean, error, variance = spread
            scale = float(np.sqrt(variance + variances[v, k] + error**2))
            distance = float((values[v, k] - mean) / scale)
            p = min(1.0, tests * _core.p_of_distance(distance, len(others) - 1))
            one = Departure(fit.vehicle, name, float(values[v, k]), mean, distance, p)
            if best is None or abs(one.errors) > abs(best.errors):
                best = one
        if best is not None:
            found.append(best)
    return sorted(found, key=lambda one: -abs(one.errors))


def _finite(values: Array) -> list[float | None]:
    return [or_none(value) for value in values]
