# SPDX-License-Identifier: BSD-3-Clause
"""Which logs a fleet is of, and what is known of each: its vehicle, its date, numbers.

Files lie in folders or on any filesystem of fsspec ("s3://bucket/logs/*.ulg"). What is known of
them stands in their names, by a pattern as "{vehicle}/{date}_*.ulg", or in a table with a column
`file`.
"""

from __future__ import annotations

import csv
import glob
import math
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from sepcal import _core
from sepcal.printing import in_line

if TYPE_CHECKING:
    import fsspec

AGE = "age_days"  # since the vehicle's first flight, where dates are known


@dataclass(frozen=True)
class Log:
    """A log of a fleet."""

    name: str  # no other log's
    file: str  # a path, or a URL
    vehicle: str
    attributes: Mapping[str, float] = field(default_factory=dict)  # what effects may grow with
    labels: Mapping[str, str] = field(default_factory=dict)  # what flights are compared by


def filesystem_of(file: str) -> tuple[fsspec.AbstractFileSystem, str]:
    """The filesystem of a URL, and the path on it. Raises Error where there is none."""
    try:
        import fsspec
    except ImportError:
        raise _core.Error(
            f"{in_line(file)}: a URL is read by fsspec: pip install sepcal[fleet]"
        ) from None
    try:
        system, path = fsspec.core.url_to_fs(file)
    except (ImportError, ValueError, OSError) as error:
        raise _core.Error(f"{in_line(file)}: {in_line(str(error))}") from None
    return system, path


def is_url(file: str) -> bool:
    """Whether fsspec reads it, and not the system."""
    return "://" in file


def find_files(logs: str | os.PathLike[str] | Iterable[str | os.PathLike[str]]) -> list[str]:
    """The files that paths, URLs and patterns of them name, each once, in order of their names.

    Raises Error for a pattern that names none.
    """
    patterns = [logs] if isinstance(logs, str | os.PathLike) else list(logs)
    files: dict[str, None] = {}
    for given in patterns:
        pattern = os.fspath(given)
        if not isinstance(pattern, str):
            raise _core.Error("a log's name is bytes; give a text")
        is_pattern = any(sign in pattern for sign in "*?[")
        if is_url(pattern):
            system, path = filesystem_of(pattern)
            try:
                found = [system.unstrip_protocol(one) for one in system.glob(path)]
            except OSError as error:
                raise _core.Error(f"{in_line(pattern)}: {in_line(str(error))}") from None
        elif os.path.isdir(pattern):
            inside = glob.glob(f"{glob.escape(pattern)}/**", recursive=True)
            found = [one for one in inside if os.path.isfile(one) and not one.endswith(".json")]
        else:
            found = glob.glob(pattern, recursive=True) if is_pattern else [pattern]
        if not found:
            raise _core.Error(f"no log is called {in_line(pattern)}")
        files |= dict.fromkeys(sorted(found))
    if not files:
        raise _core.Error("there are no logs")
    return list(files)


def compile_names(pattern: str) -> re.Pattern[str]:
    """A pattern of names as "{vehicle}/{date}_*.ulg", which holds for the end of a path.

    Raises Error for a pattern without a field.
    """
    text, at = r"(?:^|.*/)", 0
    for match in re.finditer(r"\{([A-Za-z_][A-Za-z0-9_]*)\}|\*", pattern):
        text += re.escape(pattern[at : match.start()])
        text += f"(?P<{match[1]}>[^/]+?)" if match[1] else "[^/]*"
        at = match.end()
    text += re.escape(pattern[at:])
    try:
        compiled = re.compile(text)
    except re.error as error:
        raise _core.Error(f"names={in_line(pattern)!r}: {error}") from None
    if not compiled.groups:
        raise _core.Error(
            f"names={in_line(pattern)!r} has no {{field}}; write it as '{{vehicle}}_{{date}}.csv'"
        )
    return compiled


def read_table(file: str | os.PathLike[str]) -> list[dict[str, str]]:
    """The rows of a CSV or Parquet table of logs, all as text. Raises Error without `file`."""
    name = os.fspath(file)
    if name.endswith(".parquet"):
        try:
            from pyarrow import parquet
        except ImportError:
            raise _core.Error(f"{in_line(name)}: pip install pyarrow to read it") from None
        try:
            rows = [
                {key: "" if value is None else str(value) for key, value in row.items()}
                for row in parquet.read_table(name).to_pylist()
            ]
        except (OSError, ValueError) as error:
            raise _core.Error(f"{in_line(name)}: {in_line(str(error))}") from None
    else:
        try:
            with open(name, encoding="utf-8-sig", newline="") as lines:
                rows = [
                    {key: value or "" for key, value in row.items() if isinstance(key, str)}
                    for row in csv.DictReader(lines)
                ]
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise _core.Error(f"{in_line(name)}: {in_line(reason)}") from None
    if not rows or "file" not in rows[0]:
        raise _core.Error(f"{in_line(name)}: a table of logs has a column 'file', and a row a log")
    return rows


def find_logs(
    logs: str | os.PathLike[str] | Iterable[str | os.PathLike[str]] | None,
    names: str | None = None,
    table: str | os.PathLike[str] | None = None,
    share: str = "vehicle",
) -> tuple[list[Log], dict[str, str]]:
    """The logs with what names and the table say of them.

    A file of the table is one of `logs` by its path or its name; without `logs` the table's files
    are the logs, relative to the table. `share` is the field or column whose logs share parameters;
    without `vehicle` the folder is the vehicle.

    Logs whose names do not fit, or whose date is none, are left out: the second of both.

    Raises Error where none is left, and for a log that the table lacks.
    """
    rows = read_table(table) if table is not None else []
    if logs is None:
        if table is None:
            raise _core.Error("give logs, or a table of them")
        folder = os.path.dirname(os.fspath(table))
        files = [
            row["file"] if is_url(row["file"]) else os.path.join(folder, row["file"])
            for row in rows
        ]
        known = dict(zip(files, rows, strict=True))
    else:
        files = find_files(logs)
        known = _rows_by_file(files, rows, table)
    pattern = compile_names(names) if names is not None else None
    told: list[dict[str, str]] = []
    named: list[str] = []
    misnamed: dict[str, str] = {}  # and why they are left out
    for file in files:
        labels = {key: value for key, value in known.get(file, {}).items() if key != "file"}
        if pattern is not None:
            match = pattern.fullmatch(file)
            if match is None:
                misnamed[file] = f"its name does not fit {in_line(names or '')!r}"
                continue
            labels |= match.groupdict()
        if labels.get("date") and read_date(labels["date"]) is None:
            misnamed[file] = f"'{in_line(labels['date'])}' is no date"
            continue
        told.append(labels)
        named.append(file)
    if not named:
        file, reason = next(iter(misnamed.items()))
        raise _core.Error(f"no log can be used; of {in_line(file)}: {reason}")
    if share != "vehicle":
        lacking = [file for file, labels in zip(named, told, strict=True) if not labels.get(share)]
        if lacking:
            raise _core.Error(
                f"{in_line(lacking[0])} has no '{in_line(share)}', which is to share parameters"
            )
        told = [labels | {"vehicle": labels[share]} for labels in told]
    return _describe(named, told), misnamed


def _rows_by_file(
    files: Sequence[str], rows: Sequence[dict[str, str]], table: str | os.PathLike[str] | None
) -> dict[str, dict[str, str]]:
    if table is None:
        return {}
    by_path = {row["file"]: row for row in rows}
    by_name = {row["file"].rpartition("/")[2]: row for row in rows}
    known = {}
    for file in files:
        row = by_path.get(file) or by_name.get(file.rpartition("/")[2])
        if row is None:
            raise _core.Error(f"{in_line(os.fspath(table))} has no row of {in_line(file)}")
        known[file] = row
    return known


def _describe(files: Sequence[str], told: Sequence[dict[str, str]]) -> list[Log]:
    names = _short_names(files)
    folders = [file.rpartition("/")[0].rpartition("/")[2] for file in files]
    vehicles = [
        labels.get("vehicle") or folder or "fleet"
        for labels, folder in zip(told, folders, strict=True)
    ]
    numbers = _numeric(told)
    ages = _ages(vehicles, [labels.get("date", "") for labels in told])
    logs = []
    for index, file in enumerate(files):
        attributes = {key: float(told[index][key]) for key in numbers if told[index].get(key)}
        if not math.isnan(ages[index]):
            attributes[AGE] = ages[index]
        labels = {k: v for k, v in told[index].items() if v and k not in (*numbers, "vehicle")}
        place = file if is_url(file) else os.path.abspath(file)
        logs.append(Log(names[index], place, vehicles[index], attributes, labels))
    return logs


def _short_names(files: Sequence[str]) -> list[str]:
    """The ends of the files' paths, with as many folders as tell them apart."""
    parts = [file.split("/") for file in files]
    for count in range(1, max(map(len, parts))):
        names = ["/".join(part[-count:]) for part in parts]
        if len(set(names)) == len(names):
            return names
    return list(files)


def _numeric(told: Sequence[Mapping[str, str]]) -> list[str]:
    """What is a number of every log that has it, and differs."""
    found = []
    for key in dict.fromkeys(key for labels in told for key in labels):
        if key in ("vehicle", "date", "sensor", "serial", "operator", "firmware"):
            continue
        values = [labels[key] for labels in told if labels.get(key)]
        if len(set(values)) > 1 and all(_is_number(value) for value in values):
            found.append(key)
    return found


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def read_date(text: str) -> datetime | None:
    """2026-03-01, 20260301, 2026-03-01T10:20:00Z, 2026-03-01_10-20-00; None: no date."""
    clock = re.fullmatch(r"(\d{4}-?\d\d-?\d\d)[ _-](\d\d)[-._:]?(\d\d)[-._:]?(\d\d)", text)
    try:
        date = datetime.fromisoformat("{}T{}:{}:{}".format(*clock.groups()) if clock else text)
    except ValueError:
        return None
    return date if date.tzinfo else date.replace(tzinfo=UTC)


def _ages(vehicles: Sequence[str], dates: Sequence[str]) -> list[float]:
    """Days since the vehicle's first flight; NaN where no date is known."""
    read = [read_date(date) for date in dates]
    first: dict[str, datetime] = {}
    for vehicle, date in zip(vehicles, read, strict=True):
        if date is not None:
            first[vehicle] = min(first.get(vehicle, date), date)
    return [
        math.nan if date is None else (date - first[vehicle]).total_seconds() / 86400.0
        for vehicle, date in zip(vehicles, read, strict=True)
    ]


def as_json(log: Log) -> dict[str, Any]:
    """What is known of a log, to be written."""
    return {
        "name": log.name,
        "file": log.file,
        "vehicle": log.vehicle,
        "attributes": dict(log.attributes),
        "labels": dict(log.labels),
    }
