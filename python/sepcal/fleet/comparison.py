# SPDX-License-Identifier: BSD-3-Clause
"""Where a fleet's model fails: flights by vehicle, month, label, attribute or driver."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sepcal import _core
from sepcal.fleet.logs import read_date
from sepcal.printing import aligned, in_line

if TYPE_CHECKING:
    from sepcal.fleet.passes import FleetFlight

GROUPS = 5  # of a number, of as many flights each
FAILS_FROM = 1.2  # times the median error of all groups


@dataclass(frozen=True)
class Group:
    """Flights that have something in common."""

    name: str
    flights: int
    readings: float
    rmse: float  # over the flights, at each vehicle's parameters
    misfit: float  # -2 ln L per reading; 1: noise alone
    worst: str  # its flight that fits worst
    worst_misfit: float
    fails: bool  # whether its error is far above the groups' median


@dataclass(frozen=True)
class FleetComparison:
    """A fleet by groups of its flights; `print` shows the page.

    Example:
        >>> files = sepcal.datasets.write_fleet(folder)
        >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
        >>> [group.flights for group in fleet.compare("vehicle").groups]
        [3, 3, 3, 3]
    """

    by: str
    groups: tuple[Group, ...]
    median: float  # misfit per reading of a typical flight

    def to_json(self) -> str:
        """As JSON.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> '"by": "vehicle"' in fleet.compare("vehicle").to_json()
            True
        """
        told = {"by": self.by, "median": self.median, "groups": [asdict(g) for g in self.groups]}
        return json.dumps(told, indent=2) + "\n"

    def __str__(self) -> str:
        rows = [["", "flights", "rmse", "misfit", "worst flight", "its misfit"]]
        rows += [
            [
                in_line(group.name),
                str(group.flights),
                f"{group.rmse:.4g}" + (" *" if group.fails else ""),
                f"{group.misfit:.3g}",
                in_line(group.worst),
                f"{group.worst_misfit:.3g}",
            ]
            for group in self.groups
        ]
        failing = [group.name for group in self.groups if group.fails]
        lines = [
            f"By {self.by}. rmse is the error that is left. Misfit is -2 ln L per reading, against "
            f"the noise that each flight shows; a typical flight has {self.median:.3g}."
        ]
        if failing:
            lines.append(
                f"{len(failing)} of {len(self.groups)} (*) have an error of more than {FAILS_FROM} "
                "times the median."
            )
        return "\n".join([*lines, "", *aligned(rows)])


def compare_groups(flights: Sequence[FleetFlight], by: str) -> FleetComparison:
    """The flights grouped. Raises Error where nothing is called so."""
    keys = _keys(flights, by)
    median = float(np.median([flight.misfit for flight in flights]))
    groups = []
    for key in dict.fromkeys(sorted(keys, key=_order)):
        members = [flight for flight, own in zip(flights, keys, strict=True) if own == key]
        readings = np.array([flight.factor.readings for flight in members])
        misfits = np.array([flight.misfit for flight in members])
        errors = np.array([flight.factor.rmse for flight in members])
        worst = members[int(np.argmax(misfits))]
        misfit = float(readings @ misfits / readings.sum())
        groups.append(
            Group(
                key,
                len(members),
                float(readings.sum()),
                float(np.sqrt(readings @ errors**2 / readings.sum())),
                misfit,
                worst.log.name,
                float(misfits.max()),
                False,
            )
        )
    usual = float(np.median([group.rmse for group in groups]))
    groups = [replace(group, fails=group.rmse > FAILS_FROM * usual) for group in groups]
    if by in ("flight", "vehicle"):
        groups.sort(key=lambda group: -group.rmse)
    return FleetComparison(by, tuple(groups), median)


def _order(key: str) -> tuple[int, float | str]:
    try:
        return 0, float(key.split(" to ")[0])
    except ValueError:
        return 1, key


def _keys(flights: Sequence[FleetFlight], by: str) -> list[str]:
    if by == "flight":
        return [flight.log.name for flight in flights]
    if by == "vehicle":
        return [flight.log.vehicle for flight in flights]
    if by == "month":
        dates = [read_date(flight.log.labels.get("date", "")) for flight in flights]
        if any(dates):
            return ["no date" if date is None else f"{date:%Y-%m}" for date in dates]
    labels = {label for flight in flights for label in flight.log.labels}
    if by in labels:
        return [flight.log.labels.get(by, f"no {by}") for flight in flights]
    numbers = [_number_of(flight, by) for flight in flights]
    if any(number is not None for number in numbers):
        return _fifths(numbers, by)
    known = {*labels, "flight", "vehicle"}
    known |= {name for flight in flights for name in flight.log.attributes}
    known |= {channel for flight in flights for channel in flight.means}
    if any(read_date(flight.log.labels.get("date", "")) for flight in flights):
        known.add("month")
    raise _core.Error(f"nothing is called '{in_line(by)}'; there is: {', '.join(sorted(known))}")


def _number_of(flight: FleetFlight, by: str) -> float | None:
    """An attribute, or a channel's mean."""
    number = flight.log.attributes.get(by, flight.means.get(by))
    return None if number is None else float(number)


def _fifths(numbers: Sequence[float | None], by: str) -> list[str]:
    known = np.array([number for number in numbers if number is not None])
    if len(set(known.tolist())) <= GROUPS:
        return [f"no {by}" if number is None else f"{number:.4g}" for number in numbers]
    edges = np.unique(np.quantile(known, np.linspace(0.0, 1.0, GROUPS + 1)))
    keys = []
    for number in numbers:
        if number is None:
            keys.append(f"no {by}")
            continue
        at = int(np.clip(np.searchsorted(edges, number, side="right") - 1, 0, len(edges) - 2))
        keys.append(f"{edges[at]:.4g} to {edges[min(at + 1, len(edges) - 1)]:.4g}")
    return keys
