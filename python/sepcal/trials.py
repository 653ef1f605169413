# SPDX-License-Identifier: BSD-3-Clause
"""One trial of a Monte Carlo study: its seed, what is kept of it, and what is kept of a failure."""

from __future__ import annotations

import importlib.util
import inspect
import os
import pickle
import time
import traceback
import uuid
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.random import Generator, SeedSequence, default_rng

from sepcal.columns import Array
from sepcal.executors import describe
from sepcal.results import Fit


@runtime_checkable
class TrialTogether(Protocol):
    """A trial of which several are done at once faster than one by one."""

    @property
    def goes_together(self) -> bool:
        """Whether they are, as this trial is."""

    def __call__(self, rng: Generator, /) -> Any:  # noqa: ANN401
        """One trial by itself."""

    def together(self, rngs: Sequence[Generator], /) -> Sequence[object | None]:
        """The record of each generator's trial; None if it is to run by itself."""


TrialFunction: TypeAlias = Callable[[Generator], Any] | Callable[[Generator, int], Any]

IMPORT = uuid.uuid4().hex  # with the process's number, which a fork changes, it names a process


@dataclass(frozen=True, eq=False)
class Estimates:
    """The parts of a fit that a study keeps.

    Example:
        >>> eta, truth = np.linspace(-3.0, 3.0, 40), {"a": 0.3, "c": 1.0, "b": 0.2}
        >>> trial = sepcal.DesignTrial(sepcal.ScalarExample1(), {"eta": eta}, truth, 0.1, samples=0)
        >>> study = sepcal.monte_carlo(trial, 2, seed=1, progress=False)
        >>> study.values[0].names, study.values[0].degrees_of_freedom
        (('a', 'c', 'b'), 37)
    """

    names: tuple[str, ...]  # n parameters
    values: Array  # (n,)
    standard_errors: Array  # (n,); NaN where undefined
    degrees_of_freedom: int  # measurements less parameters estimated; 0 where unknown
    status: str  # of the fit; empty for plain numbers
    message: str
    truth: Array | None = None  # (n,), where the trial gave it; NaN for what it doesn't name

    @classmethod
    def of_fit(cls, fit: Fit, truth: Mapping[str, float] | None = None) -> Estimates:
        """The fit without covariance and samples.

        Example:
            >>> eta = np.linspace(-3.0, 3.0, 40)
            >>> z = 1.3 * np.cos(eta + 0.2) + 1.0
            >>> data = {"eta": eta, "z": z + 0.01 * np.sin(50.0 * eta)}
            >>> fit = sepcal.fit(sepcal.ScalarExample1(), data)
            >>> sepcal.Estimates.of_fit(fit).names == fit.names
            True
        """
        parameters = fit.parameters.values()
        estimated = sum(not parameter.fixed for parameter in parameters)
        return cls(
            names=fit.names,
            values=fit.values,
            standard_errors=np.array([parameter.standard_error for parameter in parameters]),
            degrees_of_freedom=fit.rows * len(fit.rmse) - estimated,
            status=fit.status,
            message=fit.message,
            truth=None if truth is None else in_order(truth, fit.names),
        )


@dataclass(frozen=True)
class Failure:
    """How a trial failed.

    Example:
        >>> study = sepcal.monte_carlo(lambda rng: 1 / 0, 2, progress=False)
        >>> study.failed[0].failure.type, study.failed[0].failure.message
        ('ZeroDivisionError', 'division by zero')
    """

    type: str  # of the exception, with its module: "sepcal.Error"
    message: str
    traceback: str


@dataclass(frozen=True, eq=False)
class TrialRecord:
    """One trial. Its generator is default_rng(SeedSequence(seed, spawn_key=(index,))).

    Example:
        >>> study = sepcal.monte_carlo(lambda rng: rng.normal(), 3, seed=1, progress=False)
        >>> record = study.trials[2]
        >>> record.index, record.rng.normal() == record.value  # the trial anew
        (2, True)
    """

    index: int
    seed: int  # of the study
    value: Any  # what the trial gave, a Fit as Estimates; None where it failed
    failure: Failure | None
    seconds: float  # that it took

    @property
    def rng(self) -> Generator:
        """The trial's generator anew, to run it again: trial(record.rng)."""
        return spawn(self.seed, self.index)


@dataclass(frozen=True)
class Sealed:
    """A result on its way from another process, pickled where the trial ran.

    So that no executor meets a result that it can't send.
    """

    pickled: bytes


def _this_process() -> tuple[str, int]:
    return IMPORT, os.getpid()


@dataclass(frozen=True)
class TrialRun:
    """From an index to a record: what runs on the workers."""

    trial: TrialFunction
    takes_index: bool
    seed: int
    keep_fits: bool
    home: tuple[str, int] = field(default_factory=_this_process)  # where the records go

    def __call__(self, index: int) -> TrialRecord:
        """Runs the trial; its exceptions become a Failure, as does a result that can't travel."""
        rng, begun = spawn(self.seed, index), time.perf_counter()
        try:
            value = self.trial(*((rng, index) if self.takes_index else (rng,)))
            kept = value if self.keep_fits else without_bulk(value)
        except (Exception, SystemExit) as error:
            failure = Failure(_name(error), str(error), traceback.format_exc())
            return TrialRecord(index, self.seed, None, failure, time.perf_counter() - begun)
        return self._record(index, kept, time.perf_counter() - begun)

    def _record(self, index: int, kept: object, seconds: float) -> TrialRecord:
        record = TrialRecord(index, self.seed, kept, None, seconds)
        return record if self.home == _this_process() else _seal(record)

    def lost(self, index: int, error: BaseException) -> TrialRecord:
        """Stands for a trial whose workers died."""
        message = f"its worker died in every attempt; the last: {describe(error)}"
        return TrialRecord(index, self.seed, None, Failure(_name(error), message, ""), 0.0)


@dataclass(frozen=True)
class TogetherRun(TrialRun):
    """The same of a TrialTogether, several indices at a time."""

    trial: TrialTogether

    def together(self, indices: Sequence[int]) -> list[TrialRecord]:
        """Runs the trials; one that fails is run by itself, so that its record says why."""
        begun = time.perf_counter()
        values: Sequence[object | None] = [None] * len(indices)
        with suppress(Exception):
            values = self.trial.together([spawn(self.seed, index) for index in indices])
        seconds = (time.perf_counter() - begun) / len(indices)
        return [
            self(index) if value is None else self._record(index, value, seconds)
            for index, value in zip(indices, values, strict=True)
        ]


def unseal(record: TrialRecord) -> TrialRecord:
    """The record as the trial gave it; of a failure where the result can't be read back."""
    if not isinstance(record.value, Sealed):
        return record
    try:
        return replace(record, value=pickle.loads(record.value.pickled))
    except Exception as error:
        return _not_sent(record, "the result can't be unpickled", error)


def _seal(record: TrialRecord) -> TrialRecord:
    try:
        return replace(record, value=Sealed(_to_bytes(record.value)))
    except Exception as error:
        return _not_sent(record, "the result can't be pickled", error)


def _to_bytes(value: object) -> bytes:
    """By pickle, else by cloudpickle where it is installed, as it is with Dask."""
    try:
        return pickle.dumps(value, protocol=pickle.HIGHEST_PROTOCOL)
    except Exception:
        if importlib.util.find_spec("cloudpickle") is None:
            raise
        pickled: bytes = importlib.import_module("cloudpickle").dumps(value)
        return pickled


def _not_sent(record: TrialRecord, what: str, error: Exception) -> TrialRecord:
    failure = Failure(_name(error), f"{what}: {describe(error)}", traceback.format_exc())
    return replace(record, value=None, failure=failure)


def spawn(seed: int, index: int) -> Generator:
    """The generator of a trial, the same as of SeedSequence(seed).spawn(...)[index]."""
    return default_rng(SeedSequence(seed, spawn_key=(index,)))


def takes_index(trial: TrialFunction) -> bool:
    """Is it trial(rng, index), two arguments without defaults, or trial(rng)?"""
    try:
        parameters = inspect.signature(trial).parameters.values()
    except (TypeError, ValueError):
        return False
    places = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return sum(one.kind in places and one.default is one.empty for one in parameters) > 1


def without_bulk(value: object) -> object:
    """Estimates in place of a Fit or (Fit, truth); anything else as it is."""
    match value:
        case Fit():
            return Estimates.of_fit(value)
        case (Fit() as fit, Mapping() as truth):
            return Estimates.of_fit(fit, truth)
    return value


def in_order(truth: Mapping[str, float], names: tuple[str, ...]) -> Array:
    """The truth of these names, (n,); NaN where it isn't known."""
    return np.array([truth.get(name, np.nan) for name in names], dtype=np.float64)


def _name(error: BaseException) -> str:
    kind = type(error)
    return kind.__name__ if kind.__module__ == "builtins" else f"{kind.__module__}.{kind.__name__}"
