# SPDX-License-Identifier: BSD-3-Clause
"""A fleet: many flights of many vehicles, compared, diagnosed, added to and watched together."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Unpack

import numpy as np

from sepcal import _core
from sepcal.arguments import checked
from sepcal.calibration import Calibration, parse
from sepcal.executors import Executors
from sepcal.fit_options import FitOptions
from sepcal.fitting import fit
from sepcal.fleet.comparison import FleetComparison, compare_groups
from sepcal.fleet.findings import FleetDiagnosis
from sepcal.fleet.growth import Growth, growth_of
from sepcal.fleet.kept import SCHEMA, fleet_json, write_files
from sepcal.fleet.logs import Log, find_logs
from sepcal.fleet.monitoring import Monitoring, watch
from sepcal.fleet.passes import Fitted, FleetFlight, Sharing, Way, fit_flights, mean_centres
from sepcal.fleet.populations import Population
from sepcal.fleet.store import Store
from sepcal.fleet.visiting import read_log
from sepcal.flight import Flight, kind_of
from sepcal.models import Model
from sepcal.options import to_names
from sepcal.own_effect import Effect
from sepcal.own_state_model import AnyModel, as_model
from sepcal.printing import in_line
from sepcal.progress import Shown

Logs = str | os.PathLike[str] | Iterable[str | os.PathLike[str]]


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
        common: Sequence[str] = (),
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
            common: Parameters that all vehicles share.
            names: What stands in the logs' names: "{vehicle}/{date}_*.ulg". `vehicle` is the group
                that shares parameters [the folder], `date` makes flights age, other numbers are
                attributes that parameters may grow with, other words are what flights are compared
                by.
            table: A CSV or Parquet file with a column `file` and the same as other columns.
            share: The field or column whose flights share parameters: "sensor", say.
            candidates: Effects to be tested [all that are linear].
            cluster: A concurrent.futures.Executor (Dask: client.get_executor()), a function that
                makes one, as ProcessPoolExecutor, or None: threads, here.
            store: A folder that keeps what was done; a run that ended early is taken up there.
            progress: None: on a terminal and in a notebook; "tqdm"; False: never.
            tolerance: Flights are visited again until no vehicle's parameter moves by more of its
                standard error.
            **options: FitOptions.

        Raises:
            Error: No log; no name that fits; a log that the table lacks; a calibration of some
                seconds of its flight.
        """
        if isinstance(like, Calibration):
            _refuse_segments(like)
        self.logs, self._misnamed = find_logs(logs, names, table, share)
        self._like = like
        self._options = options
        self._own = None if own is None else tuple(to_names("own", own))
        self._sharing = Sharing(tuple(to_names("common", common)))
        self._candidates = None if candidates is None else tuple(to_names("candidates", candidates))
        self._way = Way(cluster, None if store is None else Store(store), progress, tolerance)
        self._base: Calibration | None = like if isinstance(like, Calibration) else None
        self._fitted: Fitted | None = None
        self.added: list[dict[str, Any]] = []

    def _of(self, logs: list[Log], base: Calibration) -> Fleet:
        """Other logs, or another base, and all else as it is."""
        fleet = Fleet.__new__(Fleet)
        fleet.__dict__ |= self.__dict__
        fleet.logs, fleet._like, fleet._base = logs, base, base
        fleet._fitted = None
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
            fleet._misnamed = dict(told["misnamed"])
            fleet._like = fleet._base = base
            fleet._options = {}
            fleet._own = tuple(told["own"])
            growths = (Growth(**one) for one in told["growths"])
            fleet._sharing = Sharing(tuple(told["common"]), tuple(growths))
            fleet._candidates = None if told["candidates"] is None else tuple(told["candidates"])
            fleet._way = Way(cluster, Store(folder), None, float(told["tolerance"]))
            fleet.added = list(told["added"])
        except OSError as error:
            raise _core.Error(
                f"{in_line(place)}: {error.strerror}; sepcal fleet fit ... -o {in_line(folder)} "
                "makes a fleet there"
            ) from None
        except (ValueError, KeyError, TypeError) as error:
            if isinstance(error, _core.Error):
                raise
            raise _core.Error(f"{in_line(place)}: it is no fleet's setup") from None
        fleet._fitted = None
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
            unknown = [name for name in self._own if name not in self.base.names]
            if unknown:
                raise _core.Error(
                    f"own: no parameter is called '{in_line(unknown[0])}'; there are: "
                    + ", ".join(self.base.names)
                )
            return self._own
        return tuple(name for name in self.base.names if name in ("w_n", "w_e", "w_d"))

    @property
    def fitted(self) -> Fitted:
        """What came of the logs, which are visited when it is first asked for."""
        if self._fitted is None:
            self._fitted = fit_flights(
                self.logs, self.base, self.own, self._candidates, self._sharing, self._way
            )
            self._fitted.left_out |= self._misnamed
        return self._fitted

    @property
    def flights(self) -> dict[str, FleetFlight]:
        """Each flight that can be used, by its name."""
        return self.fitted.flights

    @property
    def left_out(self) -> dict[str, str]:
        """Logs that can't be used, and why."""
        return self.fitted.left_out

    @property
    def vehicles(self) -> dict[str, _core.VehicleFit]:
        """Each vehicle's parameters, from all its flights."""
        return {fit.vehicle: fit for fit in self.fitted.vehicles}

    @property
    def parameters(self) -> list[str]:
        """The vehicles' parameters, by name, in the order of their values."""
        return list(next(iter(self.flights.values())).factor.parameters)

    @property
    def common(self) -> list[str]:
        """Of these, those that have one value for the whole fleet."""
        return self._sharing.common

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
        _check_significance(significance)
        return FleetDiagnosis(_core.diagnose_fleet(self._asked(), significance, most, self.common))

    def add(
        self,
        effect: str | Effect,
        *,
        common: bool = False,
        store: str | os.PathLike[str] | None = None,
    ) -> Fleet:
        """The fleet with one more effect in every flight.

        Args:
            effect: As diagnose() names it, or one of your own. "s_va[age_days]", a parameter and an
                attribute: it grows, at one rate for the fleet.
            common: One coefficient for all vehicles; else each has its own.
            store: A folder that keeps what is done [the fleet's own].

        Raises:
            Error: An effect that the fleet has, or that its base can't have.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> (step,) = fleet.add("pressure_offset", common=True).added
            >>> step["flights"]
            12
        """
        fleet = self._with(effect, common)
        if store is not None:
            fleet._way = replace(self._way, store=Store(store))
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

    def _with(self, effect: str | Effect, common: bool) -> Fleet:
        """The fleet with the effect, not fitted yet."""
        attributes = [flight.log.attributes for flight in self.flights.values()]
        growth = growth_of(str(effect), self.parameters, attributes)
        if growth:
            if growth.name in self.common:
                raise _core.Error(f"the fleet has {in_line(growth.name)} already")
            fleet = self._of(self.logs, self.base)
            growths = (*self._sharing.growths, growth)
            fleet._sharing = replace(self._sharing, growths=growths)
            return fleet
        first = self._read_base_flight()
        grown = about_centres(self.base.add(effect, first), mean_centres(self.flights))
        fleet = self._of(self.logs, grown)
        if common:
            new = [name for name in grown.names if name not in self.base.names]
            shared = (*self._sharing.parameters, *new)
            fleet._sharing = replace(self._sharing, parameters=shared)
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
        found = _core.fit_population(self._asked(), correlated, np.zeros(0), self.common)
        return Population(found, self.base, tuple(self.common))

    def monitor(self, *, significance: float = 0.01) -> Monitoring:
        """Each vehicle's parameters from flight to flight: control limits, changes, who departs.

        Flights of a vehicle are in the order of their dates, or of their names.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> fleet.monitor().changes
            ()
        """
        _check_significance(significance)
        return watch(list(self.flights.values()), self.parameters, self.common, significance)

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

    # What is kept

    def to_json(self) -> str:
        """What is known of each flight and vehicle, as JSON.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> '"kind": "fleet"' in fleet.to_json()
            True
        """
        return fleet_json(self)

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
        write_files(self, folder)

    def __repr__(self) -> str:
        if self._fitted is None:
            return f"<sepcal.Fleet of {len(self.logs)} logs, not fitted yet>"
        vehicles = len({flight.log.vehicle for flight in self.flights.values()})
        left = f", {len(self.left_out)} logs left out" if self.left_out else ""
        return f"<sepcal.Fleet {len(self.flights)} flights of {vehicles} vehicles{left}>"

    def __str__(self) -> str:
        from sepcal.fleet.pages import fleet_page

        return fleet_page(self)


def _check_significance(significance: float) -> None:
    """Raises Error for what is no probability."""
    if not 0.0 < significance < 1.0:
        raise _core.Error(f"significance={significance}: give a probability between 0 and 1")


def _refuse_segments(like: Calibration) -> None:
    """Raises Error where it is of times that no other flight has."""
    options = json.loads(like.to_json())["options"]
    for name in ("stage_one_segments", "stage_two_segments"):
        if ":" in (segments := str(options.get(name, ""))):
            raise _core.Error(
                f"the calibration to be like is of the rows {in_line(segments)} of its flight, "
                'times of no other; fit it with where instead, as where="dp_pa > 80"'
            )


def about_centres(calibration: Calibration, centres: Mapping[str, float]) -> Calibration:
    """The same calibration, its effects' drivers about the fleet's centres."""
    told = json.loads(calibration.to_json())
    for setting in told["options"].get("effects", []):
        if isinstance(setting, dict) and setting.get("name") in centres:
            setting["centre"] = centres[setting["name"]]
    moved = parse(json.dumps(told), calibration.own_effects, calibration.own_model)
    moved.flight = calibration.flight
    return moved


def _rms(values: Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if values else float("nan")
