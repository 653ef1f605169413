# SPDX-License-Identifier: BSD-3-Clause
"""Flight logs: the table of a CSV file, or arrays under the same headers."""

import json
import math
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol, Self, TypeAlias

import numpy as np

from sepcal import _core
from sepcal.arguments import Missing, checked
from sepcal.columns import Array, Columns, by_name, to_column, to_labels
from sepcal.markup import html as markup
from sepcal.markup import join
from sepcal.options import to_names
from sepcal.plots import Backend, Theme
from sepcal.printing import as_utf8, in_line
from sepcal.reading import AIR, MAGNETIC, is_text, read_file, reading_for
from sepcal.reading.extras import load
from sepcal.reading.frames import is_frame, of_frame
from sepcal.reading.units import quantity_of
from sepcal.tables import table_of
from sepcal.whole_files import name_of, write_whole

if TYPE_CHECKING:
    import pandas

    from sepcal.models import Model

ROWS_SHOWN = 5
KINDS = {  # by the model's name and by its class
    **dict.fromkeys(("five-hole", "pitot-static", "vane-boom"), AIR),
    **dict.fromkeys(("FiveHoleProbe", "PitotStatic", "VaneBoom"), AIR),
    **dict.fromkeys(("magnetometer", "magnetometer-norm", "Magnetometer"), MAGNETIC),
}


class Fitted(Protocol):
    """A compiled calibration, or fit of an aircraft."""

    @property
    def model(self) -> str:
        """Its name."""

    def to_json(self) -> str:
        """Its file."""


class ArrowTable(Protocol):
    """A table of Arrow's, polars' or another's that Arrow's C interface hands over."""

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """The stream."""


class Dataset(Protocol):
    """xarray's."""

    @property
    def data_vars(self) -> object:
        """Its variables."""


@checked
class Flight(Mapping[str, Array]):
    """A flight log: columns under headers with units, `<quantity>_<unit>`, as in a CSV file.

    A C-contiguous float64 array is viewed, not copied: a later change of it shows in the flight.
    Everything else (lists, other types, strides) is converted once. It is a mapping:
    `flight["pt_pa"]` is a read-only array of shape (rows,) in the header's unit, uncopied.

    Args:
        columns: Arrays of shape (N,) by header: a dict, a structured array, a DataFrame of pandas
            or polars, an Arrow table, an xarray Dataset. A column "maneuver" holds labels, as in a
            file. Dates, also of an index, become time_s, seconds since midnight UTC of the first.
        maneuver: A label a row, N of them; a run of one label is a segment.
        name: The flight's name in messages.

    Raises:
        Error: A column of another length, without a name, not one-dimensional or not of numbers; a
            name or a label that no UTF-8 is of.

    Example:
        >>> flight = sepcal.Flight({"time_s": [0.0, 0.1], "dp_pa": [150.0, 151.0]}, ["a", "b"])
        >>> flight.columns, float(flight["dp_pa"].mean()), flight.maneuvers
        (('time_s', 'dp_pa'), 150.5, ['a', 'b'])
    """

    def __init__(
        self,
        columns: "Columns | ArrowTable | Dataset",
        maneuver: Iterable[object] | None = None,
        name: str = "flight",
    ) -> None:
        notes = columns.notes if isinstance(columns, Flight) else []
        if is_frame(columns):
            table = of_frame(columns)
            notes = [f"{name}: {note}" for note in table.notes]
            columns = {**table.columns, **({"maneuver": table.labels} if table.labels else {})}
        columns = by_name(columns)  # type: ignore[arg-type]  # what is no frame has columns
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
        for note in notes:
            self._core.note(note)

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
        """SHA-256 of the file's bytes, 64 hexadecimal digits; empty for arrays."""
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
        """The decisions of the file's reader, one line each."""
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

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> drawn = flight.plot(["dp_pa", "altitude_m"], backend="matplotlib")
            >>> drawn.savefig(folder / "flight.png")
        """
        from sepcal.plotting import as_figure
        from sepcal.plotting.of_records import picture_flight

        chosen = None if columns is None else to_names("columns", columns)
        return as_figure(picture_flight(self, chosen), backend, theme)

    def __getitem__(self, header: str) -> Array:
        """The column, shape (rows,), read-only; NaN where a file's cell is no number."""
        values = self._core.column(header) if isinstance(header, str) else None
        if values is None:
            raise Missing(f"column {header!r} is missing; {self._core.list_columns()}")
        return values

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def __repr__(self) -> str:
        headers = ", ".join(self.columns)
        return in_line(f"<{type(self).__name__} {self.name!r}: {self.rows} rows of {headers}>")

    def head(self, rows: int = ROWS_SHOWN) -> "Flight":
        """The first rows, as a flight of the same name. Raises Error for fewer than one.

        Example:
            >>> sepcal.Flight({"time_s": [0.0, 0.1, 0.2]}).head(2)["time_s"].tolist()
            [0.0, 0.1]
        """
        if rows < 1:
            raise _core.Error(f"head({rows}): give one row or more")
        first = Flight(
            {header: self[header][:rows].copy() for header in self},
            self.maneuvers[:rows] or None,
            self.name,
        )
        for note in self.notes:
            first._core.note(note)
        return first

    def to_frame(self) -> "pandas.DataFrame":
        """A pandas DataFrame of copies, with "maneuver" behind the first column.

        Raises:
            Error: pandas is not installed.

        Example:
            >>> flight = sepcal.Flight({"time_s": [0.0, 0.1], "dp_pa": [150.0, 151.0]}, ["a", "b"])
            >>> list(flight.to_frame())
            ['time_s', 'maneuver', 'dp_pa']
        """
        frame = load("pandas", self.name, "to_frame()").DataFrame(dict(self))
        if self.maneuvers:
            frame.insert(min(1, len(self)), "maneuver", self.maneuvers)
        return frame

    def to_csv(self, file: str | os.PathLike[str]) -> None:
        """Writes a CSV file, numbers to the last bit; it appears whole or not at all.

        Raises:
            Error: The file can't be written.

        Example:
            >>> flight = sepcal.Flight({"time_s": [0.0, 0.1], "dp_pa": [150.0, 151.0]})
            >>> flight.to_csv(folder / "log.csv")
            >>> (folder / "log.csv").read_text().splitlines()
            ['time_s,dp_pa', '0.0,150.0', '0.1,151.0']
        """
        write_whole({name_of(file): csv_of(self)})

    def _repr_html_(self) -> str:
        """A notebook's view: the first rows, and what the reader decided."""
        shown = min(self.rows, ROWS_SHOWN)
        columns: dict[str, Sequence[object]] = {
            header: self[header][:shown].tolist() for header in self
        }
        if self.maneuvers:
            columns["maneuver"] = self.maneuvers[:shown]
        rows = (
            dict(zip(columns, cells, strict=True)) for cells in zip(*columns.values(), strict=True)
        )
        notes = join("", (markup("<li>{}</li>", note) for note in self.notes))
        table = table_of(f"{self.name}: {self.rows} rows", list(columns), rows, as_they_are=True)
        return join("", [table, markup("<ul>{}</ul>", notes) if notes else ""])


AnyFlight: TypeAlias = Flight | Columns | ArrowTable | Dataset | str | os.PathLike[str]


def csv_of(flight: Flight) -> str:
    """The flight as a CSV file's text; numbers to the last bit, nothing where there is none."""
    headers = list(flight.columns)
    columns = [
        ["" if math.isnan(value) else repr(value) for value in flight[header].tolist()]
        for header in headers
    ]
    if flight.maneuvers:
        headers.insert(1, "maneuver")
        columns.insert(1, flight.maneuvers)
    rows = (",".join(map(_cell, cells)) for cells in zip(*columns, strict=True))
    return "\n".join((",".join(map(_cell, headers)), *rows)) + "\n"


def _cell(text: str) -> str:
    """As it stands, or in double quotes where a comma, a quote or a line's end is in it."""
    if not any(mark in text for mark in ',"\r\n'):
        return text
    return '"' + text.replace('"', '""') + '"'


@checked
def read(
    data: AnyFlight, table: str | None = None, *, delimiter: str = "", decimal: str = ""
) -> Flight:
    """A flight of anything: a file of any form, or a table in memory.

    Args:
        data: A file's name: CSV, Parquet, Arrow or Feather, HDF5, .mat, .xlsx, MCAP, IGC, NMEA
            0183, ULog or DataFlash, which is found by what is in it (docs/files.md); a DataFrame of
            pandas or polars, an Arrow table, an xarray Dataset, a dict; a Flight, as it is.
        table: In a file with several tables, the one to read: a sheet, a group, a topic, a
            sensor [the one that measures]. "FILE::TABLE" says the same.
        delimiter: Column separator of a text table that can be read in two ways: ",",
            ";", "|", "tab" or "space" [as the file shows].
        decimal: Likewise its decimal mark, "." or ",".

    Returns:
        A Flight; its `notes` say what was decided.

    Raises:
        Error: No such file, damaged, of another form, larger unpacked than sepcal takes, without a
            table, with several that could be meant; a library that is not installed.

    Example:
        >>> sepcal.read({"time_s": [0.0, 0.1], "dp_pa": [150.0, 151.0]}).rows
        2
    """
    if isinstance(data, str | os.PathLike):
        return Flight._of(read_file(name_of(data), table, delimiter, decimal))
    for option, value in (("table", table), ("delimiter", delimiter), ("decimal", decimal)):
        if value:
            raise _core.Error(f"{option}={value!r} is for files; these data are one table")
    return data if isinstance(data, Flight) else Flight(data)


@checked
def read_csv(file: str | os.PathLike[str], delimiter: str = "", decimal: str = "") -> Flight:
    """Reads a whole text table, plain CSV or another form; `notes` say what was assumed.

    Units are converted and bad cells found when the flight is used, so that a column that is not
    needed can't stop the reading.

    Args:
        file: The table; of another form it is read as by read().
        delimiter: Column separator, if the file can be read in two ways: ",", ";", "|", "tab" or
            "space" [as the file shows].
        decimal: Its decimal mark, "." or "," [as the file shows].

    Raises:
        Error: No such file, binary, no rows, or one that can be read in two ways; the message names
            file and line.

    Example:
        >>> np.savetxt(folder / "log.csv", [[0.0, 150.2], [0.1, 151.0]], header="time_s,dp_pa",
        ...            delimiter=",", comments="")
        >>> sepcal.read_csv(folder / "log.csv").columns
        ('time_s', 'dp_pa')
    """
    return Flight._of(_core.read_csv(name_of(file), delimiter, decimal))


@checked
def stream_csv(
    file: str | os.PathLike[str],
    folder: str | os.PathLike[str] = "",
    delimiter: str = "",
    decimal: str = "",
) -> Flight:
    """The same of a log that may be longer than memory: its columns lie on disc, 8 bytes a cell.

    Args:
        file: The CSV; it may be a pipe.
        folder: Where the columns are written, in files without a name [$TMPDIR, or /tmp].
        delimiter: As in read_csv().
        decimal: As in read_csv().

    Raises:
        Error: As read_csv(), and where the disc is full.

    Example:
        >>> np.savetxt(folder / "log.csv", [[0.0, 150.2], [0.1, 151.0]], header="time_s,dp_pa",
        ...            delimiter=",", comments="")
        >>> sepcal.stream_csv(folder / "log.csv", folder).rows
        2
    """
    place = name_of(folder) if folder else ""
    return Flight._of(_core.stream_csv(name_of(file), place, delimiter, decimal))


def to_flight(
    flight: object,
    call: str,
    model: object = "",
    options: Mapping[str, Any] | None = None,
) -> Flight:
    """A flight of what read() takes; of a file the sensor of `model`, where it has several.

    `model` is one, or its name; of a fit's options delimiter and decimal are taken, as of read().

    Raises Error, which shows how to call again, for anything else.
    """
    if isinstance(flight, Flight):
        return flight
    if isinstance(flight, str | os.PathLike):
        form = {name: (options or {}).get(name) or "" for name in ("delimiter", "decimal")}
        with reading_for(kind_of(model)):
            return read(flight, **form)
    if is_frame(flight) or isinstance(flight, Mapping | np.ndarray):
        return Flight(flight)  # type: ignore[arg-type]
    raise _core.Error(f"a {type(flight).__name__} is no flight; give one: {call}sepcal.read(file))")


def to_flight_of(fitted: Fitted, flight: object, call: str) -> Flight:
    """The same for a later verb: a table as text has the form that the fit was told of its own."""
    has_form = isinstance(flight, str | os.PathLike) and is_text(name_of(flight))
    options = json.loads(fitted.to_json())["options"] if has_form else None
    return to_flight(flight, call, fitted.model, options)


def kind_of(model: object) -> str:
    """The kind of reading that a model, or its name, needs: MAGNETIC, AIR or none."""
    return KINDS.get(model if isinstance(model, str) else type(model).__name__, "")


def to_columns(data: object, model: "Model") -> Columns | None:
    """A model's own columns by name, and what was meant to be; None of a flight.

    A flight has one that is missing under a header that ends in a unit: "roll_deg" for roll.
    """
    if isinstance(data, str | os.PathLike) or not hasattr(data, "__getitem__"):
        return None
    columns = Flight(data) if is_frame(data) else by_name(data)  # type: ignore[arg-type]
    needed = {*model._columns_in(columns), *model._measured_in(columns)}
    with_units = {name for name, unit in map(quantity_of, map(str, columns)) if unit}
    is_flight = bool((needed - set(columns)) & with_units)
    return None if is_flight else columns
