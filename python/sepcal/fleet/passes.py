# SPDX-License-Identifier: BSD-3-Clause
"""All logs of a fleet visited: each alone, then at its vehicle's estimates until these stay."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from sepcal import _core
from sepcal.calibration import Calibration
from sepcal.columns import Array
from sepcal.executors import Executors, describe, stream
from sepcal.fleet.growth import Growth, in_flight, with_rates
from sepcal.fleet.logs import Log
from sepcal.fleet.store import Store
from sepcal.fleet.visiting import Question, Visit, visit
from sepcal.flight import kind_of
from sepcal.interrupts import interrupts_held
from sepcal.printing import in_line
from sepcal.progress import Shown, show_progress

TASKS = 64  # of a pass over all logs, at least where there are as many
MOST_PASSES = 8


@dataclass(frozen=True)
class FleetFlight:
    """A flight of a fleet."""

    log: Log
    calibration: str  # of the flight alone, JSON
    factor: _core.FlightFactor
    sha256: str
    rows: int
    means: Mapping[str, float]  # of the log's channels

    @property
    def misfit(self) -> float:
        """-2 ln L per reading at the vehicle's parameters; 1: what the flight alone leaves."""
        square = float(np.sum(np.asarray(self.factor.triangle)[:, -1] ** 2))
        return square / float(self.factor.readings)

    def asked(self) -> tuple[str, str, _core.FlightFactor, dict[str, float]]:
        """As the engine takes it."""
        return self.log.name, self.log.vehicle, self.factor, dict(self.log.attributes)


@dataclass(frozen=True)
class Way:
    """How logs are visited."""

    cluster: Executors = None
    store: Store | None = None
    progress: Shown = None
    tolerance: float = 0.01  # of a vehicle's standard error, at which its parameters stay


@dataclass(frozen=True)
class Sharing:
    """What all vehicles share."""

    parameters: tuple[str, ...] = ()
    growths: tuple[Growth, ...] = ()

    @property
    def common(self) -> list[str]:
        """Parameters and rates that have one value for the fleet."""
        return [*self.parameters, *(growth.name for growth in self.growths)]


@dataclass
class Fitted:
    """What came of it."""

    sharing: Sharing = field(default_factory=Sharing)
    flights: dict[str, FleetFlight] = field(default_factory=dict)  # by name, in the logs' order
    left_out: dict[str, str] = field(default_factory=dict)  # why, by name
    vehicles: list[_core.VehicleFit] = field(default_factory=list)  # of these flights
    passes: int = 0
    cpu_seconds: float = 0.0


def fit_flights(
    logs: Sequence[Log],
    base: Calibration,
    own: tuple[str, ...],
    candidates: tuple[str, ...] | None,
    sharing: Sharing,
    way: Way,
) -> Fitted:
    """Visits the logs. Raises Error where none can be used."""
    fitted = Fitted(sharing)
    kind = kind_of(base.core.model)
    asked = {log.name: Question(base, kind, own, log.name, log.file, candidates) for log in logs}
    _take(logs, _visit(asked, "calibrating each flight", way, fitted), fitted)
    named = sorted({effect for one in fitted.flights.values() for effect, *_ in one.factor.columns})
    if candidates and (unknown := [name for name in candidates if name not in named]):
        raise _core.Error(f"no flight can show the effect '{in_line(unknown[0])}'")
    centres = mean_centres(fitted.flights)
    for _ in range(MOST_PASSES):
        values = _vehicle_values(fitted)
        parameters = next(iter(fitted.flights.values())).factor.parameters
        questions = {
            name: replace(
                asked[name],
                candidates=tuple(named),
                at=in_flight(
                    dict(zip(parameters, map(float, values[one.log.vehicle]), strict=True)),
                    sharing.growths,
                    one.log.attributes,
                ),
                centres=centres,
                calibration=one.calibration,
            )
            for name, one in fitted.flights.items()
        }
        task = "reducing each flight at its vehicle's parameters"
        _take(logs, _visit(questions, task, way, fitted), fitted)
        if _moved(fitted.vehicles, values) <= way.tolerance:
            break
    return fitted


def _take(logs: Sequence[Log], visits: Mapping[str, Visit], fitted: Fitted) -> None:
    """Keeps what can be used, and why the rest can't."""
    flights = {}
    by_name = {log.name: log for log in logs}
    first_of: dict[str, str] = {}  # a flight that counted twice would be twice as sure
    for name, answer in visits.items():
        if answer.factor is None:
            fitted.left_out[name] = answer.error
            continue
        other = first_of.setdefault(answer.sha256, name)
        if other != name:
            fitted.left_out[name] = f"its bytes are those of {other}"
            continue
        log = by_name[name]
        factor = with_rates(answer.factor, fitted.sharing.growths, log.attributes)
        flights[name] = FleetFlight(
            log, answer.calibration, factor, answer.sha256, answer.rows, answer.means
        )
    if not flights:
        reason = next(iter(fitted.left_out.values()))
        raise _core.Error(f"no log can be used; of the first: {in_line(reason)}")
    first = next(iter(flights.values())).factor.parameters
    for name in [name for name in flights if flights[name].factor.parameters != first]:
        fitted.left_out[name] = "it has other parameters than the first flight"
        del flights[name]
    fitted.flights = flights
    fitted.vehicles = _core.fit_vehicles(
        [flight.asked() for flight in flights.values()], fitted.sharing.common
    )


def _vehicle_values(fitted: Fitted) -> dict[str, Array]:
    """Of what a vehicle's flights do not tell, the median of the others."""
    all_values = np.array([fit.values for fit in fitted.vehicles])
    known = np.isfinite(all_values)
    typical = np.array(
        [
            np.median(column[there]) if there.any() else np.nan
            for column, there in zip(all_values.T, known.T, strict=True)
        ]
    )
    start = np.asarray(next(iter(fitted.flights.values())).factor.values)
    typical = np.where(np.isfinite(typical), typical, start)
    return {
        fit.vehicle: np.where(known[k], all_values[k], typical)
        for k, fit in enumerate(fitted.vehicles)
    }


def _moved(vehicles: Sequence[_core.VehicleFit], values: Mapping[str, Array]) -> float:
    """The largest step of a vehicle's parameter, in its standard errors."""
    largest = 0.0
    for found in vehicles:
        step = np.abs(np.asarray(found.values) - values[found.vehicle])
        error = np.sqrt(np.diag(np.asarray(found.covariance)))
        told = np.isfinite(step) & (error > 0)
        largest = max(largest, *(step[told] / error[told]), 0.0)
    return largest


def _visit(
    questions: Mapping[str, Question], task: str, way: Way, fitted: Fitted
) -> dict[str, Visit]:
    """All answers, in the order of the questions; those that are known are not asked again."""
    answers: dict[str, Visit] = {}
    open_ones: list[Question] = []
    for name, question in questions.items():
        known = way.store.find(question) if way.store else None
        if known is None:
            open_ones.append(question)
        else:
            answers[name] = known
    fitted.passes += 1
    batch = max(1, len(open_ones) // (TASKS * 4))
    threads = partial(ThreadPoolExecutor, os.cpu_count())
    cluster = way.cluster if way.cluster is not None or len(open_ones) < 2 else threads
    done = 0
    every = None if way.progress is False else 10.0
    try:
        with show_progress("sepcal fleet", way.progress, every=every) as tell:
            for place, answer in stream(visit, open_ones, cluster, batch=batch, lost=_lose):
                answers[answer.name] = answer
                fitted.cpu_seconds += answer.seconds
                if way.store is not None:
                    with interrupts_held():
                        way.store.keep(open_ones[place], answer)
                done += 1
                tell(f"{task}, {len(open_ones)} logs", done / len(open_ones))
    finally:
        if way.store is not None:
            with interrupts_held():
                way.store.save_index()
    return {name: answers[name] for name in questions}


def mean_centres(flights: Mapping[str, FleetFlight]) -> dict[str, float]:
    """Of each effect, the mean over the flights of what its driver goes about in each."""
    found: dict[str, list[float]] = {}
    for flight in flights.values():
        for effect, centre in flight.factor.centres.items():
            found.setdefault(effect, []).append(centre)
    return {effect: float(np.mean(values)) for effect, values in sorted(found.items())}


def vehicle_error(fit: _core.VehicleFit, k: int) -> float:
    """A parameter's standard error: of leaving out flights and the noise models the larger."""
    both = [np.asarray(fit.covariance)[k, k], np.asarray(fit.jackknife)[k, k]]
    known = [value for value in both if np.isfinite(value)]
    return float(np.sqrt(max(known))) if known else float("nan")


def _lose(question: Question, error: BaseException) -> Visit:
    """Stands for a log that killed its worker at every attempt."""
    return Visit(question.name, error=f"its worker dies of it, or is killed ({describe(error)})")
