# SPDX-License-Identifier: BSD-3-Clause
"""The result of a joint fit of many flights. Undefined numbers are NaN."""

from __future__ import annotations

from typing import Any, Literal

from sepcal import _core
from sepcal.arguments import checked, found_by
from sepcal.plots import Backend, Theme
from sepcal.printing import page_of
from sepcal.tables import table_of


@checked
class ManyFit(_core.ManyFit):
    """A joint fit: `fit["lambda_va"]` is a shared parameter, `fit.flights["a.csv"]` a flight.

    Example:
        >>> flights = [sepcal.simulate("pitot-static", rows=200, seed=seed) for seed in (1, 2)]
        >>> fleet = sepcal.fit_many(sepcal.PitotStatic(), flights)
        >>> fleet
        <sepcal.ManyFit converged: 2 flights, 400 rows, 5 shared parameters>
        >>> fleet.departed()
        []
    """

    def __getitem__(self, name: str) -> _core.Parameter:
        """A shared parameter. Raises Error, a KeyError too, listing the names."""
        return found_by(super().__getitem__, name)

    @property
    def success(self) -> bool:
        """Whether the status is "converged"."""
        return self.status == "converged"

    def departed(self, level: float = 0.01) -> list[str]:
        """Flights that depart from the others, by p_holm below `level`; the surest first.

        Example:
            >>> days = [sepcal.simulate("pitot-static", rows=200, seed=seed) for seed in (1, 2, 3)]
            >>> sepcal.fit_many(sepcal.PitotStatic(), days).departed()  # none: all fly one tube
            []
        """
        found = [name for name, one in self.flights.items() if one.departure.p_holm < level]
        return sorted(found, key=lambda name: self.flights[name].departure.p)

    def plot(
        self,
        what: Literal["departures", "own"] | str = "departures",
        *,
        backend: Backend = "plotly",
        theme: Theme = "light",
    ) -> Any:  # noqa: ANN401
        """Draws the flights side by side, with 2 standard errors to either side.

        Args:
            what: "departures", by how much a flight's own estimate of a shared parameter differs
                from that of the others; "own", the parameters estimated per flight.
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; "own" where no flight has any; the library is not
                installed.

        Example:
            >>> days = [sepcal.simulate("pitot-static", rows=200, seed=seed) for seed in (1, 2, 3)]
            >>> drawn = sepcal.fit_many(sepcal.PitotStatic(), days).plot(backend="matplotlib")
        """
        from sepcal.plotting import as_figure, choose
        from sepcal.plotting.of_studies import picture_flights

        choose(what, ("departures", "own"))
        return as_figure(picture_flights(self, what), backend, theme)

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
        for size in self.noise_sizes.values():
            error = f" +- {size.standard_error:.2g}" if size.standard_error >= 0 else ""
            lines.append(f"{size.name}: {size.value:.4g}{error} {size.unit}")
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
        return page_of(lines)

    def _repr_html_(self) -> str:
        """A small table of what all share, for notebooks."""
        columns = ("name", "value", "standard_error", "unit")
        rows = [parameter._asdict() for parameter in self.shared.values()]
        return table_of(repr(self).strip("<>"), columns, rows)

    def __repr__(self) -> str:
        return (
            f"<sepcal.ManyFit {self.status}: {len(self.flights)} flights, {self.rows} rows, "
            f"{len(self.shared)} shared parameters>"
        )
