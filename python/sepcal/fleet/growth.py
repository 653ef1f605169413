# SPDX-License-Identifier: BSD-3-Clause
"""Parameters that grow with an attribute of flights, at one rate for the fleet: with age, say."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from sepcal import _core


@dataclass(frozen=True)
class Growth:
    """In a flight the parameter is the vehicle's plus rate (attribute - mean)."""

    parameter: str
    attribute: str
    mean: float  # over the fleet's flights

    @property
    def name(self) -> str:
        """Of its rate: "s_va[age_days]"."""
        return f"{self.parameter}[{self.attribute}]"

    def distance(self, attributes: Mapping[str, float]) -> float:
        """From the mean; a flight without the attribute counts as one at the mean."""
        return attributes.get(self.attribute, self.mean) - self.mean


def growth_of(
    name: str, parameters: Iterable[str], flights: Iterable[Mapping[str, float]]
) -> Growth | None:
    """What is called so, where these are the parameters and flights have such an attribute."""
    parts = re.fullmatch(r"(.+)\[([^][]+)\]", name)
    if not parts or parts[1] not in parameters:
        return None
    values = [one[parts[2]] for one in flights if parts[2] in one]
    return Growth(parts[1], parts[2], sum(values) / len(values)) if values else None


def with_rates(
    factor: _core.FlightFactor, growths: Iterable[Growth], attributes: Mapping[str, float]
) -> _core.FlightFactor:
    """The flight's factor with the rates among its parameters."""
    for growth in growths:
        factor = _core.with_rate(
            factor, growth.parameter, growth.attribute, growth.distance(attributes)
        )
    return factor


def in_flight(
    values: Mapping[str, float], growths: Iterable[Growth], attributes: Mapping[str, float]
) -> dict[str, float]:
    """A vehicle's parameters as they are in a flight, without the rates."""
    here = dict(values)
    for growth in growths:
        here[growth.parameter] += here.pop(growth.name) * growth.distance(attributes)
    return here
