# SPDX-License-Identifier: BSD-3-Clause
"""Work on a worker in a joint fit: one flight asked one thing.

A worker reads its logs where they lie and keeps them prepared from one question to the next. One
that has never seen a flight, since another died with it, prepares it then.
"""

from __future__ import annotations

import os
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass
from threading import Lock
from typing import Any, TypeAlias

from sepcal import _core
from sepcal.columns import Columns, take_columns, to_labels
from sepcal.flight import Flight, to_flight
from sepcal.models import Model
from sepcal.options import refuse_log_choice, to_core

Source: TypeAlias = Flight | Columns | str | os.PathLike[str]

MOST_CELLS = 64_000_000  # numbers kept prepared in one process, 512 MB


@dataclass(frozen=True)
class Task:
    """The part of a fit that is the same for every flight."""

    token: str  # a fit's own
    model: Model
    options: Mapping[str, Any]
    own: tuple[str, ...]


@dataclass(frozen=True)
class Question:
    """One question to one flight."""

    task: Task
    index: int
    name: str
    source: Source | None  # None: the worker may have it; see Absent
    sha256: str  # of the log as it was at the start; empty where not known
    kind: str  # "start", or what of a _core.PreparedFlight answers
    argument: Any


@dataclass(frozen=True)
class Absent:
    """The answer of a worker that does not have the flight and was not given it."""


class _Prepared:
    """The flights prepared in this process; the ones used longest ago go first."""

    def __init__(self) -> None:
        self._flights: OrderedDict[tuple[str, int], tuple[_core.PreparedFlight, str, int]] = (
            OrderedDict()
        )
        self._lock = Lock()

    def find(self, question: Question) -> tuple[_core.PreparedFlight, str] | None:
        key = (question.task.token, question.index)
        with self._lock:
            if key not in self._flights:
                return None
            self._flights.move_to_end(key)
            flight, sha256, _ = self._flights[key]
            return flight, sha256

    def keep(
        self, question: Question, flight: _core.PreparedFlight, sha256: str, cells: int
    ) -> None:
        with self._lock:
            self._flights[question.task.token, question.index] = flight, sha256, cells
            total = sum(count for *_, count in self._flights.values())
            while total > MOST_CELLS and len(self._flights) > 1:
                total -= self._flights.popitem(last=False)[1][2]

    def forget(self, token: str) -> None:
        with self._lock:
            for key in [key for key in self._flights if key[0] == token]:
                del self._flights[key]


PREPARED = _Prepared()


def ask(question: Question) -> Any:  # noqa: ANN401
    """The flight's answer; of "start" with the log's sha256, or Absent.

    Raises:
        Error: The flight can't be used, but for "start", whose answer says so; the log was changed.
    """
    try:
        found = PREPARED.find(question) or _prepare(question)
    except _core.Error as error:
        if question.kind == "start":
            return unusable(str(error)), ""
        raise _core.Error(f"flight '{question.name}': {error}") from None
    if found is None:
        return Absent()
    flight, sha256 = found
    if question.sha256 != sha256 and question.kind != "start":
        raise _core.Error(
            f"flight '{question.name}' was changed while it was being fitted; leave it alone and "
            "fit again"
        )
    if question.kind == "start":
        try:
            return flight.start(), sha256
        except _core.Error as error:
            return unusable(str(error)), sha256
    return getattr(flight, question.kind)(question.argument)


def unusable(reason: str) -> tuple[object, ...]:
    """The answer of "start" of a flight that can't be used."""
    return None, reason, [], [], [[]], [], 0, []


def _prepare(question: Question) -> tuple[_core.PreparedFlight, str] | None:
    task, source = question.task, question.source
    if source is None:
        return None
    options, own, model = to_core(task.options), list(task.own), task.model
    if isinstance(source, str | os.PathLike):
        source = to_flight(source, "fit_many(model, ", model, question.task.options)
    if isinstance(source, Flight):
        flight = _core.prepare_flight(model._core, source._core, options, own)
        sha256, cells = source.sha256, source.rows * len(source)
    else:
        refuse_log_choice(task.options)
        there = set(source)
        needed = [*model._columns_in(source), *model._measured_in(source), *({"time"} & there)]
        columns = take_columns(model._owner, source, dict.fromkeys(needed))
        labels = to_labels(source["maneuver"]) if "maneuver" in there else []  # type: ignore[arg-type]
        flight = _core.prepare_columns(model._core, columns, labels, options, own)
        sha256, cells = "", sum(column.size for column in columns.values())
    PREPARED.keep(question, flight, sha256, cells)
    return flight, sha256
