# SPDX-License-Identifier: BSD-3-Clause
"""A fleet: many flights of many vehicles, compared, diagnosed, added to and watched together."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Unpack

import numpy as np

from sepcal import _core
from sepcal.arguments import checked
from sepcal.calibration import Calibration, parse
from sepcal.columns import Array
from sepcal.executors import Executors, describe, stream
from sepcal.fit_options import FitOptions
from sepcal.fitting import fit
from sepcal.fleet.comparison import FleetComparison, compare_groups
from sepcal.fleet.findings import FleetDiagnosis
from sepcal.fleet.logs import Log, as_json, find_logs
from sepcal.fleet.monitoring import Monitoring, watch
from sepcal.fleet.populations import Population
from sepcal.fleet.store import Store
from sepcal.fleet.visiting import Question, Visit, read_log, visit
from sepcal.flight import Flight, kind_of
from sepcal.models import Model
from sepcal.options import to_names
from sepcal.own_effect import Effect
from sepcal.own_state_model import AnyModel, as_model
from sepcal.printing import in_line
from sepcal.progress import Shown, show_progress
from sepcal.whole_files import write_bytes

Logs = str | os.PathLike[str] | Iterable[str | os.PathLike[str]]
TASKS = 64  # of a pass over all logs, at least where there are as many
MOST_PASSES = 8
SCHEMA = 1


@dataclass(frozen=True)
class FleetFlight:
    """A flight of a fleet."""

    log: Log
    calibration: str  # of the flight alone, JSON
    factor: _core.FlightFactor
    sha256: str
    rows: int

    @property
    def misfit(self) -> float:
        """-2 ln L per reading at the vehicle's parameters; 1: noise alone."""
        square = float(np.sum(np.asarray(self.factor.triangle)[:, -1] ** 2))
        return square / float(self.factor.readings)

    def asked(self) -> tuple[str, str, _core.FlightFactor, dict[str, float]]:
        """As the engine takes it."""
        return self.log.name, self.log.vehicle, self.factor, dict(self.log.attributes)


@checked
class Fleet:
    """Many logs of one kind of instrument, each calibrated like one of them.

    A vehicle's flights share its parameters; `own` ones are each flight's. A flight is read,
    calibrated and reduced on a worker to one triangle; what vehicles share, lack and spread over is
    worked out of these, and the data never move. Nothing is done before it is asked for.

    Example:
        >>> files = sepcal.datasets.write_fleet(folder)
        >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
        >>> len(fleet.flights), list(fleet.vehicles)
        (12, ['V01', 'V02', 'V03', 'V04'])
    """

    def __init__(
        self,
        logs: Logs | None,
        like: Calibration | AnyModel,
        *,
        own: Sequence[str] | None = None,
        names: str | None = None,
        table: str | os.PathLike[str] | None = None,
        share: str = "vehicle",
        candidates: Sequence[str] | None = None,
        cluster: Executors = None,
        store: str | os.PathLike[str] | None = None,
        progress: Shown = None,
        tolerance: float = 0.01,
        **options: Unpack[FitOptions],
    ) -> None:
        """Finds the logs.

        Args:
            logs: Files of any form that read() takes, folders, patterns as "logs/**/*.ulg", on any
                filesystem of fsspec: "s3://bucket/*.ulg". None: those of the table.
            like: A calibration, as whose every flight is calibrated, with its options and effects;
                or a probe, and `options` as of fit().
            own: Parameters that each flight has for itself [the wind, where the probe has one].
            names: What stands in the logs' names: "{vehicle}/{date}_*.ulg". `vehicle` is the group
                that shares parameters [the folder], `date` makes flights age, other numbers are
                attributes that parameters may grow with, other words are what flights are compared
                by.
            table: A CSV or Parquet file with a column `file` and the same as other columns.
            share: The field or column whose flights share parameters: "sensor", say.
            candidates: Effects to be tested [all that are linear].
            cluster: A concurrent.futures.Executor (Dask: client.get_executor()), a function that
                makes one, as ProcessPoolExecutor, or None: here.
            store: A folder that keeps what was done; a run that ended early is taken up there.
            progress: None: on a terminal and in a notebook; "tqdm"; False: never.
            tolerance: Flights are visited again until no vehicle's parameter moves by more of its
                standard error.
            **options: FitOptions.

        Raises:
            Error: No log; a name that does not fit; a log that the table lacks.
        """
        self.logs = find_logs(logs, names, table, share)
        self._like = like
        self._options = options
        self._own = None if own is None else tuple(to_names("own", own))
        self._candidates = None if candidates is None else tuple(to_names("candidates", candidates))
        self._cluster = cluster
        self._store = Store(store) if store is not None else None
        self._progress = progress
        self._tolerance = tolerance
        self._base: Calibration | None = like if isinstance(like, Calibration) else None
        self._flights: dict[str, FleetFlight] | None = None
        self._left_out: dict[str, str] = {}
        self.passes = 0
        self.cpu_seconds = 0.0
        self.added: list[dict[str, Any]] = []

    def _of(self, logs: list[Log], base: Calibration) -> Fleet:
        """Other logs, or another base, and all else as it is."""
        fleet = Fleet.__new__(Fleet)
        fleet.__dict__ |= self.__dict__
        fleet.logs, fleet._like, fleet._base = logs, base, base
        fleet._flights, fleet._left_out, fleet.passes, fleet.cpu_seconds = None, {}, 0, 0.0
        return fleet

    @classmethod
    def load(
        cls,
        folder: str | os.PathLike[str],
        *,
        effects: Sequence[Effect] = (),
        model: AnyModel | None = None,
        cluster: Executors = None,
    ) -> Fleet:
        """A fleet that save() wrote: logs that have not changed are not read again.

        Args:
            folder: With setup.json, and with the store's answers where it is the store too.
            effects: Those of your own that its base has.
            model: Of your own, where its base is of one.
            cluster: As of Fleet(), for logs that have changed.

        Raises:
            Error: No fleet is there.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> fleet.save(folder / "fleet")
            >>> sepcal.Fleet.load(folder / "fleet").flights.keys() == fleet.flights.keys()
            True
        """
        place = os.path.join(os.fspath(folder), "setup.json")
        try:
            with open(place, encoding="utf-8") as file:
                told = json.load(file)
            if told["kind"] != "fleet" or told["schema"] != SCHEMA:
                raise _core.Error(f"{in_line(place)}: another schema than {SCHEMA} of a fleet")
            base = parse(
                json.dumps(told["base"]), effects, None if model is None else as_model(model)
            )
            fleet = cls.__new__(cls)
            fleet.logs = [Log(**one) for one in told["logs"]]
            fleet._like = fleet._base = base
            fleet._options = {}
            fleet._own = tuple(told["own"])
            fleet._candidates = None if told["candidates"] is None else tuple(told["candidates"])
            fleet._tolerance = float(told["tolerance"])
            fleet.added = list(told["added"])
        except OSError as error:
            raise _core.Error(f"{in_line(place)}: {error.strerror}") from None
        except (ValueError, KeyError, TypeError) as error:
            if isinstance(error, _core.Error):
                raise
            raise _core.Error(f"{in_line(place)}: it is no fleet's setup") from None
        fleet._cluster, fleet._progress, fleet._store = cluster, None, Store(folder)
        fleet._flights, fleet._left_out, fleet.passes, fleet.cpu_seconds = None, {}, 0, 0.0
        return fleet

    # What was fitted

    @property
    def base(self) -> Calibration:
        """The calibration as whose every flight is calibrated."""
        if self._base is None:
            assert not isinstance(self._like, Calibration)  # else the base is known
            self._base = self._fit_first(as_model(self._like))
        return self._base

    @property
    def own(self) -> tuple[str, ...]:
        """Parameters that each flight has for itself."""
        if self._own is not None:
            return self._own
        return tuple(name for name in self.base.names if name in ("w_n", "w_e", "w_d"))

    @property
    def flights(self) -> dict[str, FleetFlight]:
        """Each flight that can be used, by its name."""
        if self._flights is None:
            self._flights = self._fit()
        return self._flights

    @property
    def left_out(self) -> dict[str, str]:
        """Logs that can't be used, and why."""
        self.flights  # noqa: B018
        return self._left_out

    @property
    def vehicles(self) -> dict[str, _core.VehicleFit]:
        """Each vehicle's parameters, from all its flights."""
        return {fit.vehicle: fit for fit in _core.fit_vehicles(self._asked())}

    @property
    def parameters(self) -> list[str]:
        """The vehicles' parameters, by name, in the order of their values."""
        return list(next(iter(self.flights.values())).factor.parameters)

    def _asked(self) -> list[tuple[str, str, _core.FlightFactor, dict[str, float]]]:
        return [flight.asked() for flight in self.flights.values()]

    # The loop

    def compare(self, by: str = "vehicle") -> FleetComparison:
        """Where the model fails: by flight, vehicle, month, a label, an attribute or a channel.

        Args:
            by: What flights are grouped by. Numbers (an attribute, or a channel as "oat_degc" of
                which the flights have means) make five groups of as many flights.

        Raises:
            Error: Nothing is called so.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> fleet.compare("month").groups[0].name
            '2026-01'
        """
        return compare_groups(list(self.flights.values()), by)

    def diagnose(self, *, significance: float = 0.01, most: int = 8) -> FleetDiagnosis:
        """Which effect is missing: in the whole fleet, in one vehicle, or differing between them.

        Every candidate is tested over all flights at once, each weighed by its own noise, and every
        parameter's growth with every attribute. Errors are those of the scatter between vehicles
        and flights.

        Args:
            significance: Of the fleet, after correction for the number of tests.
            most: Findings, at most.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> fleet.diagnose().found
            []
        """
        return FleetDiagnosis(_core.diagnose_fleet(self._asked(), significance, most))

    def add(self, effect: str | Effect, *, store: str | os.PathLike[str] | None = None) -> Fleet:
        """The fleet with one more effect in every flight, each vehicle with its own coefficient.

        Args:
            effect: As diagnose() names it, or one of your own.
            store: A folder that keeps what is done [the fleet's own].

        Raises:
            Error: An effect that the fleet has, or that its base can't have.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> (step,) = fleet.add("pressure_offset").added
            >>> step["flights"]
            12
        """
        first = self._read_base_flight()
        grown = about_centres(self.base.add(effect, first), self._centres())
        fleet = self._of(self.logs, grown)
        fleet._store = self._store if store is None else Store(store)
        name = effect.name if isinstance(effect, Effect) else effect
        before = {flight.log.name: flight.factor.rmse for flight in self.flights.values()}
        after = {flight.log.name: flight.factor.rmse for flight in fleet.flights.values()}
        both = [name for name in before if name in after]
        fleet.added = [
            *self.added,
            {
                "effect": name,
                "rmse_before": _rms([before[one] for one in both]),
                "rmse_after": _rms([after[one] for one in both]),
                "flights_better": sum(after[one] < before[one] for one in both),
                "flights": len(both),
                "by_flight": {one: [before[one], after[one]] for one in both},
            },
        ]
        return fleet

    def population(self, *, correlated: bool = False) -> Population:
        """How the parameters spread over vehicles, and each vehicle's shrunken estimates.

        Args:
            correlated: A full covariance between parameters, in place of their variances.

        Raises:
            Error: Fewer than three vehicles.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> list(fleet.population().spread)
            ['s_va', 'c_va']
        """
        found = _core.fit_population(self._asked(), correlated, np.zeros(0))
        return Population(found, self.base)

    def monitor(self, *, significance: float = 0.01) -> Monitoring:
        """Each vehicle's parameters from flight to flight: control limits, changes, who departs.

        Flights of a vehicle are in the order of their dates, or of their names.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> fleet.monitor().changes
            ()
        """
        return watch(list(self.flights.values()), self.parameters, significance)

    # How it is done

    def _fit_first(self, model: Model) -> Calibration:
        """The calibration of the first log that can be used."""
        reasons = []
        for log in self.logs[:20]:
            try:
                flight, *_ = read_log(log.file, kind_of(model))
                made = fit(model, flight, **self._options)
                if isinstance(made, Calibration):
                    return made
            except (_core.Error, OSError) as error:
                reasons.append(str(error))
        raise _core.Error(f"no log can be calibrated; of the first: {in_line(reasons[0])}")

    def _read_base_flight(self) -> Flight:
        if self.base.flight is not None:
            return self.base.flight
        first = next(iter(self.flights.values())).log.file
        return read_log(first, kind_of(self.base.core.model))[0]

    def _fit(self) -> dict[str, FleetFlight]:
        asked = {
            log.name: Question(
                self.base,
                kind_of(self.base.core.model),
                self.own,
                log.name,
                log.file,
                self._candidates,
            )
            for log in self.logs
        }
        alone = self._visit(asked, "calibrating each flight")
        flights = self._take(alone, {})
        candidates = sorted(
            {effect for flight in flights.values() for effect, *_ in flight.factor.columns}
        )
        centres = _mean_centres(flights)
        values: dict[str, Array] = {}
        for _ in range(MOST_PASSES):
            values = self._vehicle_values(flights)
            parameters = next(iter(flights.values())).factor.parameters
            questions = {
                name: replace(
                    asked[name],
                    candidates=tuple(candidates),
                    at=dict(zip(parameters, map(float, values[flight.log.vehicle]), strict=True)),
                    centres=centres,
                    calibration=flight.calibration,
                )
                for name, flight in flights.items()
            }
            visits = self._visit(questions, "reducing each flight at its vehicle's parameters")
            flights = self._take(visits, flights)
            if self._moved(flights, values) <= self._tolerance:
                break
        return flights

    def _take(
        self, visits: Mapping[str, Visit], before: Mapping[str, FleetFlight]
    ) -> dict[str, FleetFlight]:
        flights = {}
        logs = {log.name: log for log in self.logs}
        first_of: dict[str, str] = {}  # a flight that counted twice would be twice as sure
        for name, answer in visits.items():
            if answer.factor is None:
                self._left_out[name] = answer.error
                continue
            other = first_of.setdefault(answer.sha256, name)
            if other != name:
                self._left_out[name] = f"its bytes are those of {other}"
                continue
            flights[name] = FleetFlight(
                logs[name], answer.calibration, answer.factor, answer.sha256, answer.rows
            )
        if not flights:
            reason = next(iter(self._left_out.values()))
            raise _core.Error(f"no log can be used; of the first: {in_line(reason)}")
        first = next(iter(flights.values())).factor.parameters
        for name in [name for name in flights if flights[name].factor.parameters != first]:
            self._left_out[name] = "it has other parameters than the first flight"
            del flights[name]
        return flights

    def _vehicle_values(self, flights: Mapping[str, FleetFlight]) -> dict[str, Array]:
        """Of what a vehicle's flights do not tell, the median of the others."""
        fits = _core.fit_vehicles([flight.asked() for flight in flights.values()])
        all_values = np.array([fit.values for fit in fits])
        known = np.isfinite(all_values)
        typical = np.array(
            [
                np.median(column[there]) if there.any() else np.nan
                for column, there in zip(all_values.T, known.T, strict=True)
            ]
        )
        start = np.asarray(next(iter(flights.values())).factor.values)
        typical = np.where(np.isfinite(typical), typical, start)
        return {
            fit.vehicle: np.where(known[k], all_values[k], typical) for k, fit in enumerate(fits)
        }

    @staticmethod
    def _moved(flights: Mapping[str, FleetFlight], values: Mapping[str, Array]) -> float:
        """The largest step of a vehicle's parameter, in its standard errors."""
        largest = 0.0
        for found in _core.fit_vehicles([flight.asked() for flight in flights.values()]):
            step = np.abs(np.asarray(found.values) - values[found.vehicle])
            error = np.sqrt(np.diag(np.asarray(found.covariance)))
            told = np.isfinite(step) & (error > 0)
            largest = max(largest, *(step[told] / error[told]), 0.0)
        return largest

    def _visit(self, questions: Mapping[str, Question], task: str) -> dict[str, Visit]:
        """All answers, in the order of the questions; those that are known are not asked again."""
        answers: dict[str, Visit] = {}
        open_ones: list[Question] = []
        for name, question in questions.items():
            known = self._store.find(question) if self._store else None
            if known is None:
                open_ones.append(question)
            else:
                answers[name] = known
        self.passes += 1
        batch = max(1, len(open_ones) // (TASKS * 4))
        threads = partial(ThreadPoolExecutor, os.cpu_count())
        cluster = self._cluster if self._cluster is not None or len(open_ones) < 2 else threads
        done = 0
        every = None if self._progress is False else 10.0
        try:
            with show_progress("sepcal fleet", self._progress, every=every) as tell:
                for place, answer in stream(visit, open_ones, cluster, batch=batch, lost=_lose):
                    answers[answer.name] = answer
                    self.cpu_seconds += answer.seconds
                    if self._store is not None:
                        self._store.keep(open_ones[place], answer)
                    done += 1
                    tell(f"{task}, {len(open_ones)} logs", done / len(open_ones))
        finally:
            if self._store is not None:
                self._store.save_index()
        return {name: answers[name] for name in questions}

    def _centres(self) -> dict[str, float]:
        return _mean_centres(self.flights)

    # What is kept

    def to_json(self) -> str:
        """What is known of each flight and vehicle, as JSON.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> '"kind": "fleet"' in fleet.to_json()
            True
        """
        vehicles = self.vehicles
        parameters = self.parameters
        told = {
            "schema": SCHEMA,
            "kind": "fleet",
            "model": self.base.core.model,
            "own": list(self.own),
            "added": self.added,
            "flights": [
                {
                    **as_json(flight.log),
                    "sha256": flight.sha256,
                    "rows": flight.rows,
                    "rmse": _or_none(flight.factor.rmse),
                    "misfit_per_reading": flight.misfit,
                    "own": dict(flight.factor.own),
                }
                for flight in self.flights.values()
            ],
            "left_out": [
                {"name": name, "reason": reason} for name, reason in self._left_out.items()
            ],
            "vehicles": [
                {
                    "vehicle": name,
                    "flights": fit.flights,
                    "parameters": {
                        parameter: {
                            "value": _or_none(fit.values[k]),
                            "standard_error": _or_none(vehicle_error(fit, k)),
                        }
                        for k, parameter in enumerate(parameters)
                    },
                }
                for name, fit in vehicles.items()
            ],
        }
        return json.dumps(told, indent=2, allow_nan=False) + "\n"

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes fleet.json, flights.parquet, vehicles.parquet and setup.json into a folder.

        What load() reads is setup.json; with the folder as the store nothing is done again.

        Raises Error where it can't, or where pyarrow is not installed.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> fleet.save(folder / "fleet")
            >>> sorted(file.name for file in (folder / "fleet").iterdir() if file.is_file())
            ['fleet.json', 'flights.parquet', 'setup.json', 'vehicles.parquet']
        """
        from sepcal.fleet.parquet import table_bytes

        told = json.loads(self.to_json())
        place = os.fspath(folder)
        setup = {
            "schema": SCHEMA,
            "kind": "fleet",
            "logs": [as_json(log) for log in self.logs],
            "base": json.loads(self.base.to_json()),
            "own": list(self.own),
            "candidates": None if self._candidates is None else list(self._candidates),
            "tolerance": self._tolerance,
            "added": self.added,
        }
        write_bytes(os.path.join(place, "setup.json"), json.dumps(setup, indent=1).encode())
        write_bytes(os.path.join(place, "fleet.json"), self.to_json().encode())
        flights = [
            {
                "name": one["name"],
                "file": one["file"],
                "vehicle": one["vehicle"],
                **one["labels"],
                **one["attributes"],
                "rows": one["rows"],
                "rmse": one["rmse"],
                "misfit_per_reading": one["misfit_per_reading"],
                **one["own"],
            }
            for one in told["flights"]
        ]
        vehicles = []
        for one in told["vehicles"]:
            row = {"vehicle": one["vehicle"], "flights": one["flights"]}
            for name, value in one["parameters"].items():
                row[name] = value["value"]
                row[f"{name}_error"] = value["standard_error"]
            vehicles.append(row)
        write_bytes(os.path.join(place, "flights.parquet"), table_bytes(flights))
        write_bytes(os.path.join(place, "vehicles.parquet"), table_bytes(vehicles))

    def __repr__(self) -> str:
        if self._flights is None:
            return f"<sepcal.Fleet of {len(self.logs)} logs, not fitted yet>"
        vehicles = len({flight.log.vehicle for flight in self._flights.values()})
        left = f", {len(self._left_out)} logs left out" if self._left_out else ""
        return f"<sepcal.Fleet {len(self._flights)} flights of {vehicles} vehicles{left}>"

    def __str__(self) -> str:
        from sepcal.fleet.pages import fleet_page

        return fleet_page(self)


def vehicle_error(fit: _core.VehicleFit, k: int) -> float:
    """A parameter's standard error: of leaving out flights and the noise models the larger."""
    both = [np.asarray(fit.covariance)[k, k], np.asarray(fit.jackknife)[k, k]]
    known = [value for value in both if np.isfinite(value)]
    return float(np.sqrt(max(known))) if known else float("nan")


def about_centres(calibration: Calibration, centres: Mapping[str, float]) -> Calibration:
    """The same calibration, its effects' drivers about the fleet's centres."""
    told = json.loads(calibration.to_json())
    for setting in told["options"].get("effects", []):
        if isinstance(setting, dict) and setting.get("name") in centres:
            setting["centre"] = centres[setting["name"]]
    moved = parse(json.dumps(told), calibration.own_effects, calibration.own_model)
    moved.flight = calibration.flight
    return moved


def _mean_centres(flights: Mapping[str, FleetFlight]) -> dict[str, float]:
    """Of each effect, the mean over the flights of what its driver goes about in each."""
    found: dict[str, list[float]] = {}
    for flight in flights.values():
        for effect, centre in flight.factor.centres.items():
            found.setdefault(effect, []).append(centre)
    return {effect: float(np.mean(values)) for effect, values in sorted(found.items())}


def _lose(question: Question, error: BaseException) -> Visit:
    """Stands for a log that killed its worker at every attempt."""
    return Visit(question.name, error=f"its worker dies of it, or is killed ({describe(error)})")


def _rms(values: Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if values else float("nan")


def _or_none(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
