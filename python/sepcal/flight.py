# SPDX-License-Identifier: BSD-3-Clause
"""Flight logs: the table of a CSV file, or arrays under the same headers."""

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Self

from sepcal import _core
from sepcal.columns import Array, Columns, by_name, to_column, to_labels
from sepcal.options import to_names
from sepcal.plots import Backend, Theme
from sepcal.printing import as_utf8, in_line
from sepcal.whole_files import name_of


class Flight(Mapping[str, Array]):
    """A flight log: columns under headers with units, `<quantity>_<unit>`, as in a CSV file.

    A C-contiguous float64 array is viewed, not copied: a later change of it shows in the flight.
    Everything else (lists, other types, strides) is converted once. It is a mapping:
    `flight["pt_pa"]` is a read-only array of shape (rows,) in the header's unit, uncopied.

    Args:
        columns: Arrays of shape (N,) by header; a DataFrame or a structured array will do. A
            column "maneuver" holds labels, as in a file.
        maneuver: A label a row, N of them; a run of one label is a segment.
        name: What messages call the flight.

    Raises:
        Error: A column of another length, without a name, not one-dimensional or not of numbers; a
            name or a label that no UTF-8 is of.
    """

    def __init__(
        self, columns: Columns, maneuver: Iterable[object] | None = None, name: str = "flight"
    ) -> None:
        columns = by_name(columns)
        self._core = _core.Flight(as_utf8("the flight's name", name))
        for header in columns:
            if not isinstance(header, str):
                raise _core.Error(f"{name}: a column is called {header!r}; its name must be a text")
            as_utf8(f"{name}: the column's name", header)
            if header == "maneuver":
                self._core.label(to_labels(columns[header]))  # type: ignore[arg-type]
            else:
                self._core.view(header, to_column(name, header, columns[header]))
        if maneuver is not None:
            self._core.label(to_labels(maneuver))

    @classmethod
    def _of(cls, core: _core.Flight) -> Self:
        flight = cls.__new__(cls)
        flight._core = core
        return flight

    @property
    def name(self) -> str:
        """The file as it was named, or the name given."""
        return self._core.name

    @property
    def sha256(self) -> str:
        """Of the file's bytes, 64 hexadecimal digits; empty for arrays."""
        return self._core.sha256

    @property
    def rows(self) -> int:
        """Length of the columns, N."""
        return self._core.rows

    @property
    def columns(self) -> tuple[str, ...]:
        """The headers, in order, without "maneuver"."""
        return tuple(self._core.headers)

    @property
    def notes(self) -> list[str]:
        """What its reader decided about the file, one line each."""
        return self._core.notes

    @property
    def maneuvers(self) -> list[str]:
        """A label a row; empty where the log has none."""
        return self._core.maneuvers

    def plot(
        self,
        columns: Sequence[str] | None = None,
        *,
        backend: Backend = "plotly",
        theme: Theme = "light",
    ) -> Any:  # noqa: ANN401
        """Draws columns over time, maneuvers shaded.

        Args:
            columns: Their headers [the first twelve].
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: A column that there isn't; another word for one of these; the library is not
                installed.
        """
        from sepcal.plotting import as_figure
        from sepcal.plotting.of_records import picture_flight

        chosen = None if columns is None else to_names("columns", columns)
        return as_figure(picture_flight(self, chosen), backend, theme)

    def __getitem__(self, header: str) -> Array:
        """The column, shape (rows,), read-only; NaN where a file's cell is no number."""
        values = self._core.column(header)
        if values is None:
            raise KeyError(f"column '{header}' is missing; {self._core.list_columns()}")
        return values

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def __repr__(self) -> str:
        headers = ", ".join(self.columns)
        return in_line(f"<{type(self).__name__} {self.name!r}: {self.rows} rows of {headers}>")


def read_csv(file: str | os.PathLike[str]) -> Flight:
    """Reads a whole CSV flight log: one header line, comma separated, one row a sample.

    Units are converted and bad cells found when the flight is used, so that a column that is not
    needed can't stop the reading.

    Raises:
        Error: No such file, binary, separated by semicolons, a column twice, a short row, no rows;
            the message names file, line and column.
    """
    return Flight._of(_core.read_csv(name_of(file)))


def stream_csv(file: str | os.PathLike[str], folder: str | os.PathLike[str] = "") -> Flight:
    """The same of a log that may be longer than memory: its columns lie on disc, 8 bytes a cell.

    Args:
        file: The CSV; it may be a pipe.
        folder: Where the columns are written, in files without a name [$TMPDIR, or /tmp].

    Raises:
        Error: As read_csv(), and where the disc is full.
    """
    return Flight._of(_core.stream_csv(name_of(file), name_of(folder) if folder else ""))


def to_flight(flight: object, call: str) -> Flight:
    """A flight. Raises Error, which shows how to call again, for a file's name or columns."""
    if isinstance(flight, Flight):
        return flight
    is_file = isinstance(flight, str | os.PathLike)
    given = f"sepcal.read_csv({str(flight)!r})" if is_file else "sepcal.Flight(columns)"
    raise _core.Error(f"a {type(flight).__name__} is no flight; give one: {call}{given})")
