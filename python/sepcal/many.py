# SPDX-License-Identifier: BSD-3-Clause
"""Many flights fitted jointly: parameters shared by all, and each flight's own."""

from __future__ import annotations

import os
import uuid
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from functools import partial
from typing import Any, TypeAlias, Unpack

from sepcal import _core
from sepcal.arguments import checked, shown
from sepcal.columns import by_name
from sepcal.executors import describe, stream
from sepcal.fit_options import FitOptions
from sepcal.flight import Flight
from sepcal.many_results import ManyFit
from sepcal.many_workers import PREPARED, Absent, Question, Source, Task, ask, unusable
from sepcal.options import spelled_out, to_core, to_names
from sepcal.own_state_model import AnyModel, as_model
from sepcal.trajectories import TrajectoryModel
from sepcal.whole_files import name_of

Executors: TypeAlias = Executor | Callable[[], Executor] | None

TASKS = 64  # that one pass over all flights is cut into, at most


@spelled_out(without=("effects", "loss", "loss_width"))
@checked
def fit_many(
    model: AnyModel,
    flights: Mapping[str, Source] | Sequence[Source],
    *,
    own: Sequence[str] = (),
    executor: Executors = None,
    leave_out: bool = False,
    **options: Unpack[FitOptions],
) -> ManyFit:
    """Fits several flights jointly: one probe, a wind a flight.

        fit = sepcal.fit_many(probe, ["a.csv", "b.csv"], own=["w_n", "w_e", "w_d"])

    What a flight says at a point is one small triangular factor an output; factors merge exactly,
    and the data never move. The result is that of one fit of all rows together, and does not depend
    on the executor or on its workers. R is common to all flights, and by method="filter-error" the
    process noises are too (ManyFit.noise_sizes). Every flight is tested for its departure from the
    others (ManyFit.departed).

    Args:
        model: As in fit().
        flights: A list, or a dict by name, of CSV files, Flights, or columns by the model's names.
            A worker reads a file itself, so that its name must mean the same to it. Files are
            called as they are named, others in a list "flight 0", "flight 1", ...
        own: Parameters estimated per flight; the others are shared.
        executor: Where flights are visited: None: here, on `threads` threads; a
            concurrent.futures.Executor (Dask: client.get_executor()), which is left open; or a
            function that makes one, ProcessPoolExecutor itself. Work that a dying worker took
            with it is done again.
        leave_out: Leave out flights that can't be used, and list them, instead of refusing all.
        **options: Those of fit() but effects and a loss; they hold for every flight. `prior`
            of a shared parameter counts once, that of an own one in every flight.

    Raises:
        Error: Bad input or misuse: one line that names the flight, the culprit and the way out.
        TypeError: An option that there isn't, or of the wrong kind.
        Exception: Whatever at() of a model in Python raises.

    Example:
        >>> days = {
        ...     f"day {seed}": sepcal.simulate(
        ...         "pitot-static", rows=200, seed=seed, parameters={"w_n": float(seed)}
        ...     )
        ...     for seed in (1, 2, 3)
        ... }
        >>> fleet = sepcal.fit_many(sepcal.PitotStatic(), days, own=["w_n"])
        >>> [round(fleet.flights[day]["w_n"].value) for day in days]
        [1, 2, 3]
    """
    sources = _name(flights)
    model = as_model(model)
    if isinstance(model, TrajectoryModel) and model.options["shoot"] is not None:
        raise _core.Error(
            "shoot cuts one record's segments; fit_many() gives every flight one start: cut flights"
        )
    threads = options.pop("threads", None) or 0
    if model.runs_in_python:
        threads = 1
    own = to_names("own", own)
    here = {name: value for name, value in options.items() if value is not None}
    core = to_core({**here, "threads": threads})
    task = Task(uuid.uuid4().hex, model, {**here, "threads": 1}, tuple(own))
    is_threaded = executor is None and threads != 1 and len(sources) > 1
    maker = partial(ThreadPoolExecutor, threads or os.cpu_count()) if is_threaded else executor
    visits = _Visits(task, sources, maker)
    try:
        fit = _core.fit_many(model._core, list(sources), core, own, leave_out, visits)
    finally:
        PREPARED.forget(task.token)
    return ManyFit(fit)


class _Visits:
    """Asks flights, in parallel; the answers are in the order of the questions."""

    def __init__(self, task: Task, sources: dict[str, Source], executor: Executors) -> None:
        self._task = task
        self._names = list(sources)
        self._sources = list(sources.values())
        self._executor = executor
        self._sha256: dict[int, str] = {}

    def __call__(self, kind: str, asked: list[tuple[int, Any]]) -> list[Any]:
        questions = [self._question(kind, index, argument) for index, argument in asked]
        answers = self._stream(questions)
        absent = [place for place, answer in enumerate(answers) if isinstance(answer, Absent)]
        if absent:
            again = [self._question(kind, *asked[place], whole=True) for place in absent]
            for place, answer in zip(absent, self._stream(again), strict=True):
                answers[place] = answer
        if kind != "start":
            return answers
        self._sha256 = {index: sha for (index, _), (_, sha) in zip(asked, answers, strict=True)}
        return [start for start, _ in answers]

    def _question(self, kind: str, index: int, argument: object, whole: bool = False) -> Question:
        """Arrays in memory are sent at the start, and later only to workers that lack them."""
        source = self._sources[index]
        is_sent = whole or kind == "start" or isinstance(source, str | os.PathLike)
        return Question(
            self._task,
            index,
            self._names[index],
            source if is_sent else None,
            self._sha256.get(index, ""),
            kind,
            argument,
        )

    def _stream(self, questions: list[Question]) -> list[Any]:
        batch = -(-len(questions) // TASKS)
        answers: list[Any] = [None] * len(questions)
        for place, answer in stream(ask, questions, self._executor, batch=batch, lost=_lose):
            answers[place] = answer
        return answers


def _lose(question: Question, error: BaseException) -> object:
    """Stands for a flight that killed its worker at every attempt."""
    reason = f"its worker dies of it, or is killed ({describe(error)})"
    if question.kind == "start":
        return unusable(reason), ""
    raise _core.Error(f"flight '{question.name}': {reason}") from error


def _name(flights: Mapping[str, Source] | Sequence[Source]) -> dict[str, Source]:
    """The flights by name. Raises Error for one alone and for names that are used twice."""
    if isinstance(flights, Flight | str | os.PathLike):
        raise _core.Error("flights is one flight; give several, as a list or as {name: flight}")
    if isinstance(flights, Mapping):
        named = {str(name): source for name, source in flights.items()}
        for name, source in named.items():
            _refuse_no_flight(name, source)
        return named
    if not isinstance(flights, Iterable):
        raise _core.Error(f"flights is a {type(flights).__name__}; give a list or {{name: flight}}")
    listed: dict[str, Source] = {}
    for index, source in enumerate(flights):
        name = f"flight {index}"
        _refuse_no_flight(name, source)
        if isinstance(source, str | os.PathLike):
            name = name_of(source)
        elif isinstance(source, Flight) and source.sha256:
            name = source.name
        if name in listed:
            raise _core.Error(f"two flights are called '{name}'; give them as {{name: flight}}")
        listed[name] = source
    return listed


def _refuse_no_flight(name: str, source: object) -> None:
    if not isinstance(source, str | os.PathLike):
        try:
            by_name(source)  # type: ignore[arg-type]
        except _core.Error:
            raise _core.Error(
                f"{name} is {shown(source)}; give a file's name, a Flight or columns by name"
            ) from None
