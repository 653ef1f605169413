# SPDX-License-Identifier: BSD-3-Clause
"""Describes a log before anything is fitted, and what each problem does to a calibration."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

from sepcal import _core
from sepcal.aircraft import Aero, RigidAircraft
from sepcal.arguments import checked
from sepcal.flight import AnyFlight, Flight, to_flight
from sepcal.options import to_core
from sepcal.own_state_model import AnyModel, as_model
from sepcal.pages import Page, Row
from sepcal.plots import Backend, Theme
from sepcal.states_module import states_module
from sepcal.trajectories import FlightPath


@checked
class FlightCheck(Page, _core.FlightCheck):
    """A log, column by column, and notes. `print(check)` shows the page.

    Example:
        >>> check = sepcal.check(sepcal.PitotStatic(), sepcal.datasets.load("pitot"))
        >>> [column.header for column in check.columns if not column.quantity]  # channels
        ['altitude_m', 'throttle', 'current_a']
    """

    _shown = ("concern", "found", "effect", "advice")
    flight: Flight | None = None  # None where it was pickled

    def __init__(self, core: _core.FlightCheck, flight: Flight | None = None) -> None:
        super().__init__(core)
        self.flight = flight

    @property
    def explained(self) -> str:
        """The same page: it hides nothing."""
        return self.text

    def to_json(self) -> str:
        """The JSON that the app's check prints.

        Example:
            >>> check = sepcal.check(sepcal.PitotStatic(), sepcal.datasets.load("pitot"))
            >>> check.to_json().startswith("{")
            True
        """
        return self.json

    def to_dict(self) -> dict[str, Any]:
        """The same as a dictionary; None where a number is undefined.

        Example:
            >>> check = sepcal.check(sepcal.PitotStatic(), sepcal.datasets.load("pitot"))
            >>> check.to_dict()["model"]
            'pitot-static'
        """
        read: dict[str, Any] = json.loads(self.json)
        return read

    def plot(self, *, backend: Backend = "plotly", theme: Theme = "light") -> Any:  # noqa: ANN401
        """Draws what the model reads, over time; what is noted about a column is shaded there.

        Args:
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; a check that was pickled; the library is not
                installed.

        Example:
            >>> check = sepcal.check(sepcal.PitotStatic(), sepcal.datasets.load("pitot"))
            >>> drawn = check.plot(backend="matplotlib")
        """
        from sepcal.plotting import as_figure
        from sepcal.plotting.of_records import picture_check

        if self.flight is None:
            raise _core.Error("a check that was pickled has no flight; check it again to draw it")
        return as_figure(picture_check(self, self.flight), backend, theme)

    def _summary(self) -> str:
        count = f"{len(self.notes)} note{'' if len(self.notes) == 1 else 's'}"
        refused = "a fit would refuse it, " if self.refused else ""
        return f"{self.model} on {self.file}: {refused}{count}"

    def _rows(self) -> list[Row]:
        return [note._asdict() for note in self.notes]


@checked
def check(
    model: AnyModel | Aero | RigidAircraft,
    flight: AnyFlight,
    *,
    map: Mapping[str, str] | None = None,
    ignore: Sequence[str] | None = None,
    where: str | None = None,
    from_time: float | None = None,
    to_time: float | None = None,
    drop_invalid: bool = False,
    drop_repeats: Sequence[str] | None = None,
    join: str | None = None,
    delimiter: str = "",
    decimal: str = "",
) -> FlightCheck:
    """Describes a log, column by column, and what each problem does to a calibration.

    Nothing is fitted, and a log that a fit would refuse is described all the same.

    Args:
        model: A probe, a FlightPath, Aero or RigidAircraft, or a model of your own, as for the fit.
        flight: The log, or what read() makes a flight of.
        map: How a fit is to read the log, as its options: columns under other headers.
        ignore: Likewise, columns that are not looked at.
        where: Likewise, a condition that rows are to fulfil.
        from_time: Likewise [s].
        to_time: Likewise [s].
        drop_invalid: Likewise, of rows with a cell that is no number.
        drop_repeats: Likewise, of rows between the samples of these columns.
        join: Likewise, of quantities that are logged at other times.
        delimiter: For a file, as in read().
        decimal: Likewise.

    Returns:
        A FlightCheck: `columns`, `notes` (worst first; each with what it is, what it does to the
        result, what to do), `refused` (what a fit would say instead of fitting; empty: nothing).

    Raises:
        Error: A model that takes no flight, or what fit() says of these options.

    Example:
        >>> flight = sepcal.datasets.load("pitot")
        >>> check = sepcal.check(sepcal.PitotStatic(), flight)
        >>> check.refused, [note.kind for note in check.notes], round(check.rate)
        ('', [], 4)
        >>> early = sepcal.check(sepcal.PitotStatic(), flight, where="altitude_m < 310")
        >>> early.to_dict()["inputs"]["rows_used"] < check.to_dict()["inputs"]["rows_used"]
        True
    """
    if isinstance(model, Flight | str | os.PathLike):
        raise _core.Error("the model comes first, then the flight: sepcal.check(model, flight)")
    form = {"delimiter": delimiter, "decimal": decimal}
    options = to_core(
        {
            "map": map,
            "ignore": ignore,
            "where": where,
            "from_time": from_time,
            "to_time": to_time,
            "drop_invalid": drop_invalid,
            "drop_repeats": drop_repeats,
            "join": join,
            **form,
        }
    )
    if isinstance(model, Aero | RigidAircraft | FlightPath):
        name = model._aircraft_options()["model"]
        chosen = to_flight(flight, "check(model, ", "", form)
        return FlightCheck(states_module().check(name, chosen._core, options), chosen)
    model = as_model(model)
    chosen = to_flight(flight, "check(model, ", model, form)
    return FlightCheck(_core.check(model._core, chosen._core, options), chosen)
