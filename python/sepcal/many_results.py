# SPDX-License-Identifier: BSD-3-Clause
"""What a joint fit of many flights says. Undefined numbers are NaN."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sepcal import _core
from sepcal.columns import Array
from sepcal.results import Combination, Parameter


@dataclass(frozen=True)
class Departure:
    """Does a flight's own estimate of the shared parameters agree with that of all the others?

    Both to first order at the joint solution, along the combinations that both determine.
    """

    combinations: int  # k of them; 0: nothing can be tested
    statistic: float  # d' V^-1 d, d the difference, V as the flights' noise models have it
    p: float  # of a larger one where nothing departs: F(k, rows x outputs - n)
    p_holm: float  # the same, by Holm for the number of flights
    p_white: float  # with white residuals of the common R, off the drop in cost
    p_white_holm: float
    difference: dict[str, float]  # own estimate less the others', by shared parameter
    standard_error: dict[str, float]  # of the difference

    @property
    def largest(self) -> str:
        """The shared parameter that differs by most of its standard errors; "" where none does."""
        sizes = {
            name: abs(value / self.standard_error[name])
            for name, value in self.difference.items()
            if self.standard_error[name] > 0
        }
        return max(sizes, key=sizes.__getitem__, default="")


@dataclass(frozen=True)
class FlightFit:
    """One flight of a joint fit."""

    name: str
    own: dict[str, Parameter]  # in the model's order
    rmse: dict[str, float]  # by output, in its unit
    rows: int
    alone: str  # status of the flight's fit by itself, where the joint one began
    message: str  # of that fit
    departure: Departure

    def __getitem__(self, name: str) -> Parameter:
        """The flight's own parameter of that name. Raises KeyError listing the names."""
        return _find(self.own, name, "own parameter", "the flight")


@dataclass(frozen=True, eq=False, repr=False)
class ManyFit:
    """A joint fit: `fit["lambda_va"]` is a shared parameter, `fit.flights["a.csv"]` a flight."""

    status: str  # "converged", "not_converged" or "not_identifiable"
    message: str  # one line; empty where there is nothing to say
    shared: dict[str, Parameter]  # in the model's order, fixed ones among them
    covariance: Array  # of the shared parameters, in that order; NaN without a standard error
    correlation: Array
    covariance_white: Array  # as white residuals would have it
    flights: dict[str, FlightFit]  # in the order given
    left_out: dict[str, str]  # flights that can't be used, and why
    noise: dict[str, float]  # by output, common to all flights: given, or from R-hat = SSE / N
    rmse: dict[str, float]  # over all flights
    cost: float  # J of Eq. 6 over all rows
    unobservable: list[Combination]  # of the shared parameters
    weak: list[Combination]
    iterations: int
    noise_iterations: int
    passes: int  # over the data, beside each flight's own fit
    rows: int  # of all flights

    def __getitem__(self, name: str) -> Parameter:
        """The shared parameter of that name. Raises KeyError listing the names."""
        return _find(self.shared, name, "shared parameter", "the fit")

    @property
    def success(self) -> bool:
        """Whether the status is "converged"."""
        return self.status == "converged"

    def departed(self, level: float = 0.01) -> list[str]:
        """Flights that depart from the others, by p_holm below `level`; the surest first."""
        found = [name for name, one in self.flights.items() if one.departure.p_holm < level]
        return sorted(found, key=lambda name: self.flights[name].departure.p)

    def __str__(self) -> str:
        width = max(map(len, self.shared))
        lines = [f"{'shared':<{width}}{'value':>14}{'std. error':>12}{'white':>10}  unit"]
        for parameter in self.shared.values():
            errors = [
                f"{error:.2g}" if error >= 0 else "-"
                for error in (parameter.standard_error, parameter.standard_error_white)
            ]
            line = f"{parameter.name:<{width}}{parameter.value:>14.6g}"
            line += f"{errors[0]:>12}{errors[1]:>10}  {parameter.unit:<6}{parameter.remark}"
            lines.append(line.rstrip())
        rmse = ", ".join(f"{name} {value:.4g}" for name, value in self.rmse.items())
        lines.append(f"rmse: {rmse}; {self.rows} rows of {len(self.flights)} flights")
        for name in self.departed():
            departure = self.flights[name].departure
            line = f"{name} departs from the others: p {departure.p_holm:.2g}"
            if largest := departure.largest:
                line += (
                    f", {largest} by {departure.difference[largest]:.3g}"
                    f" +- {departure.standard_error[largest]:.2g}"
                )
            lines.append(line)
        lines += [f"{name} is left out: {reason}" for name, reason in self.left_out.items()]
        lines.append(f"{self.status}: {self.message}" if self.message else self.status)
        return "\n".join(lines)

    def __repr__(self) -> str:
        return (
            f"<sepcal.ManyFit {self.status}: {len(self.flights)} flights, {self.rows} rows, "
            f"{len(self.shared)} shared parameters>"
        )


def to_many_fit(described: _core.ManyFitDescription) -> ManyFit:
    """The result from what C++ says of it."""
    fields: dict[str, Any] = dict(described)
    fields["shared"] = _by_name(described["shared"])
    fields["unobservable"] = [Combination(**entry) for entry in described["unobservable"]]
    fields["weak"] = [Combination(**entry) for entry in described["weak"]]
    fields["flights"] = {
        flight["name"]: FlightFit(
            name=flight["name"],
            own=_by_name(flight["own"]),
            rmse=flight["rmse"],
            rows=flight["rows"],
            alone=flight["alone"],
            message=flight["message"],
            departure=Departure(**flight["departure"]),
        )
        for flight in described["flights"]
    }
    return ManyFit(**fields)


def _by_name(parameters: list[_core.ParameterDescription]) -> dict[str, Parameter]:
    return {entry["name"]: Parameter(**entry) for entry in parameters}


def _find(parameters: dict[str, Parameter], name: str, what: str, owner: str) -> Parameter:
    if name not in parameters:
        known = ", ".join(parameters) or "none"
        raise KeyError(f"there is no {what} '{name}'; {owner} has: {known}")
    return parameters[name]
