# SPDX-License-Identifier: BSD-3-Clause
"""A calibration: a probe fitted on a flight, to be compared, applied, saved and loaded."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeGuard, overload

import numpy as np

from sepcal import _core
from sepcal.aircraft_fits import AircraftFit, read_fit
from sepcal.arguments import Missing, checked
from sepcal.bands import RIGID
from sepcal.certificates import Certificate
from sepcal.columns import Array
from sepcal.comparison import Comparison
from sepcal.diagnosis import Diagnosis
from sepcal.flight import AnyFlight, Flight, to_flight_of
from sepcal.intervals import Intervals, Prediction
from sepcal.models import Model
from sepcal.options import to_names
from sepcal.own_effect import Effect, to_core_effects
from sepcal.own_state_model import AnyModel, to_own
from sepcal.plots import Backend, Theme
from sepcal.results import Fit
from sepcal.stepwise import Stepwise, diagnosis_options, to_injected
from sepcal.tracking import Track, track_options
from sepcal.whole_files import name_of

if TYPE_CHECKING:
    from sepcal.exporting import Exported

Path = str | os.PathLike[str]


@checked
class Calibration(Fit):
    """A Fit of a probe, with all that later verbs need: probe, options, and the flight fitted.

    It pickles as its JSON and its own effects, without the flight and stage one's samples.

    Example:
        >>> flight = sepcal.datasets.load("pitot")
        >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
        >>> print(f"{base['w_e'].value:.1f} +- {base['w_e'].standard_error:.1f} {base['w_e'].unit}")
        2.5 +- 0.2 m/s
        >>> base.names
        ('s_va', 'c_va', 'w_n', 'w_e', 'w_d')
    """

    core: _core.Calibration
    flight: Flight | None  # that was fitted, or several, joined; None where it was loaded
    own_effects: list[Effect]  # of the caller's making, among `effects`
    own_model: Model | None  # where a file can't make it again

    def __init__(
        self,
        core: _core.Calibration,
        flight: Flight | None = None,
        own: Sequence[Effect] = (),
        own_model: Model | None = None,
    ) -> None:
        super().__init__(core.fit)
        self.core = core
        self.flight = flight
        self.own_effects = list(own)
        self.own_model = own_model

    @property
    def restated(self) -> dict[str, dict[str, Any]]:
        """Estimates in other forms, by name: a "sentence", and its numbers.

        "wind": from_deg, speed_mps, ellipse_mps (half axes that hold it in 95 %), ellipse_axis_deg.
        "correction" of a magnetometer: h = A (m - b), A row by row and b_ut. "airspeed_ratio": the
        factor on an autopilot's ARSPD_RATIO.
        """
        return self.core.restated

    @property
    def derived(self) -> dict[str, _core.Derived]:
        """Derived quantities: a Pitot-static tube's lambda_va, b_va, which correct the reading."""
        return self.core.derived

    def __getitem__(self, name: str) -> _core.Parameter:
        """The parameter. Raises KeyError listing the names."""
        if isinstance(name, str) and name in self.derived:
            raise Missing(f"'{name}' follows from the parameters: derived['{name}']")
        return super().__getitem__(name)

    @property
    def history(self) -> list[_core.HistoryEntry]:
        """An entry for every add()."""
        return self.core.history

    @property
    def flights(self) -> list[str]:
        """The labels of a joint fit's flights, "w_n@monday" by its label; of one flight, none."""
        return self.core.flights

    @property
    def departures(self) -> dict[str, _core.FlightDeparture]:
        """For a joint fit: whether a flight, by its label, agrees with the others."""
        return {one.flight: one for one in self.core.departures}

    def departed(self, level: float = 0.01) -> list[str]:
        """Labels of flights that depart from the others, by p below `level`; the surest first.

        Example:
            >>> def fly(seed):
            ...     flown = sepcal.simulate("pitot-static", rows=200, seed=seed)
            ...     return sepcal.Flight(flown, name=f"day {seed}")
            ...
            >>> flights = [fly(1), fly(2), fly(3)]
            >>> both = sepcal.fit_jointly(sepcal.PitotStatic(), flights)
            >>> both.departed()  # none: all fly one tube
            []
        """
        found = [label for label, one in self.departures.items() if one.p < level]
        return sorted(found, key=lambda label: self.departures[label].p)

    @property
    def notes(self) -> list[str]:
        """Notes on what was dropped or ignored, one line each, for people."""
        return self.core.notes

    def _summary(self) -> str:
        errors = np.array(list(self.rmse.values()))
        total = f"{float(np.sqrt(np.mean(errors**2))):.3g} {self.core.unit}"
        if not self.core.unit:
            total = ", ".join(f"{name} {error:.3g}" for name, error in self.rmse.items())
        return f"{self.core.model}: {self.status}, rmse {total}, {len(self.parameters)} parameters"

    @property
    def fit(self) -> Fit:
        """The fit alone."""
        return Fit(self)

    def compare(
        self,
        flight: AnyFlight | Sequence[AnyFlight] | None = None,
        *,
        reference: str | Sequence[str] = (),
    ) -> Comparison:
        """Residuals on a flight, by default the fitted one, by maneuver and output.

        Of a joint fit: on all its flights, or on one of them.

        Args:
            flight: To compare with.
            reference: Columns of independent sensors, "airspeed_2_mps", which what is calibrated is
                set against in `references`; "airspeed_kt=TAS" where a name doesn't say what it is.

        Raises:
            Error: Bad input, as in fit(); no flight given where the calibration was loaded; a
                reference that is not there, or of nothing that is calibrated.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> worst = max(base.compare().where, key=lambda misfit: misfit.rmse)
            >>> worst.segment, worst.output, round(worst.rmse, 1)
            ('wind_circle_1', 'airspeed', 0.6)
        """
        core, chosen = self._on(flight, "compare(", known=True)
        names = [reference] if isinstance(reference, str) else list(reference)
        return Comparison(core.compare(chosen._core, references=names), self.noise)

    def residuals(
        self, flight: AnyFlight | Sequence[AnyFlight] | None = None
    ) -> dict[str, Array | list[str]]:
        """The residuals on a flight, row by row, as `sepcal mag residuals` writes them.

        Arrays by header, of shape (rows,), rows being the flight's: time_s, and of each output
        what was measured and modelled and the residual in its unit, mx_residual_ut, and
        mx_whitened, the residual over the standard deviation of its noise; NaN in rows that were
        not used, of which `why_not` tells why, and is "" of the others.

        Raises:
            Error: As in compare().

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> left = base.residuals()
            >>> list(left)[:3], left["airspeed_residual_mps"].shape == (flight.rows,)
            (['time_s', 'airspeed_measured_mps', 'airspeed_modelled_mps'], True)
        """
        core, chosen = self._on(flight, "residuals(", known=True)
        columns, why_not = core.residuals(chosen._core)
        return {**dict(columns), "why_not": why_not}

    def track(
        self,
        flight: AnyFlight | None = None,
        *,
        start_rows: int = 0,
        own: Sequence[str] = (),
        method: Literal["rls", "ekf", "iekf", "srif", "rft"] | str = "ekf",
        noise: Mapping[str, float] | None = None,
        walk: Mapping[str, float] | None = None,
        changes: Literal["ignore", "find", "follow"] | str = "ignore",
        row_iterations: int = 20,
        tolerance: float = 1e-8,
        forgetting: float = 1.0,
        memory: float = 0.0,
        band: tuple[float, float] = RIGID,
        spacing: float = 0.0,
    ) -> Track:
        """Parameters against time, as a filter in flight estimates them.

        Args:
            flight: By default the fitted one, which needs start_rows.
            start_rows: Fits so many first rows and goes on after them; 0: from this calibration,
                which must be of another flight.
            own: With start_rows, parameters of the flight alone, as "wind", all of its components;
                all others begin as this calibration has them, of another flight. None: the rows
                alone tell.
            method: As in sepcal.track().
            noise: Standard deviation of every output, in the first rows too [the start's].
            walk: Random walks of parameters, as in sepcal.track().
            changes: "find" or "follow" parameters that jump, as in sepcal.track().
            row_iterations: For iekf: the largest number of iterations per row.
            tolerance: For iekf.
            forgetting: Forgetting factor, above 0, at most 1: multiplies older rows' weights.
            memory: As in sepcal.track().
            band: For rft, as in sepcal.track().
            spacing: For rft.

        Raises:
            Error: The calibration's own flight without start_rows, whose rows must not count twice;
                rows that are too few; names that the model doesn't have; a model with a state,
                which sepcal.track() follows.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> track = base.track(start_rows=300)
            >>> off = track["c_va"][-1] - base["c_va"].value
            >>> bool(abs(off) < 3 * track.standard_deviation("c_va")[-1])
            True
        """
        core, chosen = self._on(flight, "track(", known=False)
        if chosen is self.flight and (own or not start_rows):
            raise _core.Error(
                "the calibration is of this flight, whose rows must not count twice; start from "
                "its first ones alone, by start_rows"
            )
        options = track_options(
            method=method,
            noise=noise,
            walk=walk,
            changes=changes,
            row_iterations=row_iterations,
            tolerance=tolerance,
            forgetting=forgetting,
            memory=memory,
            band=band,
            spacing=spacing,
            start_rows=start_rows,
            own=own,
        )
        tracked, notes = core.track(chosen._core, options)
        units = {name: parameter.unit for name, parameter in self.parameters.items()}
        return Track(tracked, units, notes)

    @overload
    def diagnose(
        self,
        flight: AnyFlight | Sequence[AnyFlight] | None = None,
        *,
        effects: Sequence[Effect] = (),
        inject: Mapping[str, float | Sequence[float]] | None = None,
        auto: Literal[False] = False,
        only: Sequence[str] = (),
        simulations: int = 40,
        seed: int = 0,
        pse: Literal["sidpac", "classic"] | str = "sidpac",
        rule: Literal["verdict", "partial-f"] | str = "verdict",
        error_budget: Mapping[str, float] | None = None,
        within: float | None = None,
    ) -> Diagnosis: ...

    @overload
    def diagnose(
        self,
        flight: AnyFlight | Sequence[AnyFlight] | None = None,
        *,
        effects: Sequence[Effect] = (),
        auto: Literal[True],
        most: int | None = None,
        only: Sequence[str] = (),
        simulations: int = 40,
        seed: int = 0,
        pse: Literal["sidpac", "classic"] | str = "sidpac",
        rule: Literal["verdict", "partial-f"] | str = "verdict",
        error_budget: Mapping[str, float] | None = None,
        within: float | None = None,
    ) -> Stepwise[Calibration]: ...

    def diagnose(
        self,
        flight: AnyFlight | Sequence[AnyFlight] | None = None,
        *,
        effects: Sequence[Effect] = (),
        inject: Mapping[str, float | Sequence[float]] | None = None,
        auto: bool = False,
        most: int | None = None,
        only: Sequence[str] = (),
        simulations: int = 40,
        seed: int = 0,
        pse: Literal["sidpac", "classic"] | str = "sidpac",
        rule: Literal["verdict", "partial-f"] | str = "verdict",
        error_budget: Mapping[str, float] | None = None,
        within: float | None = None,
    ) -> Diagnosis | Stepwise[Calibration]:
        """Which physical effect is missing on a flight, by default the fitted one?

        Args:
            flight: To diagnose.
            effects: Candidates of your own, beside the catalogue's.
            inject: One effect with its size (or one a coefficient) that is put into the
                measurements first, to see whether it would have been found.
            auto: Adds what is advised, fits and asks again, until nothing passes.
            most: With auto: the largest number of effects [no limit].
            only: The candidates, in place of those that are known.
            simulations: How many simulations of the noise calibrate a test.
            seed: The seed of these simulations.
            pse: The noise bound in the candidates' predicted square error: half the variance
                of what is measured, as SIDPAC has it, or all of it.
            rule: How to decide: by all that a verdict asks, or by stepwise regression's partial F,
                one candidate at a time from 20 on, residuals taken for white.
            error_budget: How far each error of an instrument drifts at most, in its unit, where
                you know it, by the names that `Diagnosis.error_budget` has.
            within: Answers within so many seconds [no limit]; `Diagnosis.left_undone` says what
                there was no time for.

        Returns:
            A Diagnosis; with auto a Stepwise, whose `fitted` has what was added.

        Raises:
            Error: Bad input, as in fit(); an effect to inject that the flight can't make, or beside
                auto; most below 1 or without auto; one of only that the flight can't make.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> found = base.diagnose()
            >>> found.verdict, found.advice.effect, flight.effects
            ('effect_missing', 'wind[altitude_m]', ('wind[altitude_m]',))
        """
        chosen = self._or_fitted(flight, "diagnose(")
        injected = to_injected(inject, auto=auto)
        asked = diagnosis_options(
            auto=auto,
            most=most,
            only=only,
            simulations=simulations,
            seed=seed,
            pse=pse,
            rule=rule,
            error_budget=error_budget,
            within=within,
        )
        own = to_core_effects(effects)
        if not auto:
            return Diagnosis(self.core.diagnose(chosen._core, own, injected, asked))
        stepped = self.core.diagnose_stepwise(chosen._core, own, most, asked)
        return Stepwise(self._next(stepped.fitted, chosen, effects), stepped)

    def add(
        self, effect: str | Effect, flight: AnyFlight | Sequence[AnyFlight] | None = None
    ) -> Calibration:
        """The calibration with one more effect, refitted from these estimates.

        Args:
            effect: A name, an alias, several joined as "E1+E2", or one of your own.
            flight: To fit; by default the one that was fitted.

        Returns:
            Another Calibration, whose `history` is longer by an entry.

        Raises:
            Error: Bad input, as in fit(); an effect that it has already; no flight given where the
                calibration was loaded.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> step = base.add("wind[altitude_m]").history[0]
            >>> round(step.rmse_before, 2), round(step.rmse_after, 2)
            (0.46, 0.31)
        """
        chosen = self._or_fitted(flight, "add(..., ")
        name = effect.name if isinstance(effect, Effect) else effect
        own = [effect] if isinstance(effect, Effect) else []
        core = self.core.add(chosen._core, name, to_core_effects(own))
        return self._next(core, chosen, own)

    def _next(self, core: _core.Calibration, flight: Flight, own: Sequence[Effect]) -> Calibration:
        """The same with more effects."""
        return Calibration(core, flight, [*self.own_effects, *own], self.own_model)

    def intervals(
        self,
        flight: AnyFlight | Sequence[AnyFlight] | None = None,
        *,
        level: float = 0.95,
        names: Sequence[str] | None = None,
    ) -> Intervals:
        """Gaussian and profile-likelihood intervals of the parameters, side by side.

        Args:
            flight: That was fitted; to be given where the calibration was loaded.
            level: How often an interval should hold the true value.
            names: Parameters [all that are free].

        Raises:
            Error: Another flight, a parameter that there isn't or that is fixed, a level outside
                (0, 1).

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> interval = base.intervals(names=["s_va"])["s_va"]
            >>> interval.profile[0] < interval.value < interval.profile[1], interval.ends
            (True, ('crossed', 'crossed'))
        """
        chosen = self._or_fitted(flight, "intervals(")
        return Intervals(
            self.core.intervals(
                chosen._core, level, to_names("names", () if names is None else names)
            )
        )

    def certify(
        self, flight: AnyFlight | None = None, *, tolerance: float = 1e-6, boxes: int = 20000
    ) -> Certificate:
        """Prove that no cost within the bounds is lower, or find one; see sepcal.certify().

        Args:
            flight: That was fitted; to be given where the calibration was loaded.
            tolerance: How much lower another cost may be, as a share of the fit's.
            boxes: At most so many.

        Raises:
            Error: Another flight, a calibration with effects, a probe that can't be enclosed.

        Example:
            >>> flight = sepcal.simulate("pitot-static", rows=40)
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight, fix={"w_n": -3.8, "w_d": 0.0})
            >>> base.certify(tolerance=0.01).is_global
            True
        """
        chosen = self._or_fitted(flight, "certify(")
        return Certificate(self.core.certify(chosen._core, tolerance, boxes))

    def predict(
        self, flight: AnyFlight | Sequence[AnyFlight] | None = None, *, level: float = 0.95
    ) -> Prediction:
        """The calibrated model on a flight, by default the fitted one, with its bands.

        Raises:
            Error: Bad input, as in fit(); no flight given where the calibration was loaded.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> low, high = base.predict(level=0.99).measurement_band  # of the airspeed [m/s]
            >>> bool((high > low).all())
            True
        """
        chosen = self._or_fitted(flight, "predict(")
        outputs = list(self.noise)
        units = dict.fromkeys(outputs, self.core.unit) if self.core.unit else {}
        return Prediction(self.core.predict(chosen._core, level), outputs, units, level)

    def plot(
        self,
        what: Literal[
            "fit", "channels", "noise", "coverage", "steps", "correlation", "ellipses", "stage one"
        ]
        | str = "fit",
        flight: Flight | Sequence[Flight] | None = None,
        *,
        backend: Backend = "plotly",
        theme: Theme = "light",
    ) -> Any:  # noqa: ANN401
        """Draws the calibration on a flight, as the report does.

        Args:
            what: "fit", measured over modelled with the residuals below; "channels", residuals
                against the channels that they follow most; "noise", whether what is left is noise;
                "coverage", what the flight covered; "steps", the error after every effect that was
                added; "correlation" of the estimates, "ellipses" of the pairs that are correlated
                most; "stage one", Tr[R] over the nonlinear parameters within their bounds: a curve,
                a map, of more than two the least over all others for each pair.
            flight: By default the fitted one.
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; bad input, as in compare(); "steps" where nothing
                was added; the library is not installed.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> figure = base.plot()  # figure.show(), or the last line of a notebook's cell
            >>> base.plot("noise", backend="matplotlib", theme="dark").savefig(folder / "noise.png")
        """
        from sepcal.plotting import as_figure, choose
        from sepcal.plotting.of_fits import picture_calibration, picture_fit, picture_steps

        of_estimates = ("correlation", "ellipses")
        choose(what, ("fit", "channels", "noise", "coverage", "steps", *of_estimates, "stage one"))
        if what in of_estimates:
            return as_figure(picture_fit(self, what), backend, theme)
        if what == "steps":
            return as_figure(picture_steps(self), backend, theme)
        core, chosen = self._on(flight, "plot(flight=", known=True)
        return as_figure(picture_calibration(self, what, core, chosen), backend, theme)

    def export(self, file: Path, to: str, **options: Any) -> Exported:  # noqa: ANN401
        """Writes what a vehicle loads of it, as sepcal.export(), which says what the options are.

        Args:
            file: To write.
            to: "c", "cpp", "px4" or "ardupilot".
            **options: Those of sepcal.export().

        Raises:
            Error: As sepcal.export().

        Example:
            >>> flight = sepcal.datasets.load("magnetometer")
            >>> base = sepcal.fit(sepcal.Magnetometer(), flight)
            >>> written = base.export(folder / "compass.h", "c", single=True)
        """
        from sepcal.exporting import export

        return export(self, file, to, **options)

    def report(self, file: Path, flight: AnyFlight | None = None, **options: Any) -> None:  # noqa: ANN401
        """Writes its report to one HTML page, as sepcal.report(), which takes several as well.

        Args:
            file: To write.
            flight: To report on [the one that was fitted].
            **options: Those of sepcal.report(): diagnosis, files, progress.

        Raises:
            Error: As sepcal.report().

        Example:
            >>> base = sepcal.fit(sepcal.PitotStatic(), sepcal.datasets.load("pitot"))
            >>> base.report(folder / "report.html")
        """
        from sepcal.reporting import report

        report(self, file, flight, **options)

    def join(self, flights: Sequence[AnyFlight]) -> Flight:
        """The flights of a joint fit, in any order, as the one that it is of.

        Raises:
            Error: Other flights than those, or one that was changed; a fit of one flight.

        Example:
            >>> def fly(seed):
            ...     flown = sepcal.simulate("pitot-static", rows=200, seed=seed)
            ...     return sepcal.Flight(flown, name=f"day {seed}")
            ...
            >>> flights = [fly(1), fly(2), fly(3)]
            >>> both = sepcal.fit_jointly(sepcal.PitotStatic(), flights)
            >>> both.join(flights).rows
            600
        """
        return Flight._of(
            self.core.rejoin([self._to_flight(one, "join([")._core for one in flights])
        )

    def _on(
        self, flight: AnyFlight | Sequence[AnyFlight] | None, call: str, *, known: bool
    ) -> tuple[_core.Calibration, Flight]:
        """The calibration on a flight; `known`: with what is the flight's own."""
        chosen = self._or_fitted(flight, call)
        if not self.flights or chosen is self.flight or _are_several(flight):
            return self.core, chosen
        return self.core.on_flight(chosen._core, known), chosen

    def _or_fitted(self, flight: AnyFlight | Sequence[AnyFlight] | None, call: str) -> Flight:
        """A flight, or several joined. Raises Error, which shows how to call again, for none."""
        flight = flight if flight is not None else self.flight
        if _are_several(flight):
            return self.join(flight)
        if flight is None:
            raise _core.Error(
                "a loaded calibration has no flight; give one: "
                f"{call}sepcal.read({self.core.file!r}))"
            )
        return self._to_flight(flight, call)

    def _to_flight(self, flight: object, call: str) -> Flight:
        return to_flight_of(self.core, flight, call)

    def apply(self, flight: AnyFlight) -> dict[str, Array]:
        """The corrected readings of a flight by header, each of shape (rows,).

        Five-hole: airspeed_cal_mps, alpha_cal_rad, beta_cal_rad. Pitot-static: airspeed_cal_mps.
        Magnetometer: mx_cal_ut, my_cal_ut, mz_cal_ut, the field in body axes; up to a rotation
        where only its strength is known. NaN in a row that can't be calibrated.

        Raises:
            Error: Bad input, or a calibration that can't be inverted.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> sorted(base.apply(flight))
            ['airspeed_cal_mps']
        """
        core, chosen = self._on(flight, "apply(", known=False)
        return core.apply(chosen._core)

    def apply_to_file(self, file: Path, output: Path) -> _core.Applied:
        """Copies a CSV log and adds the corrected columns; `output` appears whole or not at all.

        Raises:
            Error: Bad input, columns of those names that are there already, an output that can't be
                written.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> np.savetxt(folder / "log.csv", [[150.0, 1.19]], header="dp_pa,rho_kgpm3",
            ...            delimiter=",", comments="")
            >>> base.apply_to_file(folder / "log.csv", folder / "corrected.csv").rows
            1
        """
        return self.core.apply_to_file(name_of(file), name_of(output))

    def save(self, file: Path) -> None:
        """Writes to_json() to a file that appears whole or not at all; raises Error if it can't.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> base.save(folder / "base.json")  # for sepcal.load(), and for the apps
        """
        self.core.save(name_of(file))

    def to_json(self) -> str:
        """The JSON that the app's fit writes with -o.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> _ = (folder / "base.json").write_text(base.to_json())
            >>> sepcal.load(folder / "base.json").names == base.names
            True
        """
        return self.core.to_json()

    def to_dict(self) -> dict[str, Any]:
        """The same as a dictionary; None where a number is undefined.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> base.to_dict()["status"]
            'converged'
        """
        read: dict[str, Any] = json.loads(self.to_json())
        return read

    def __reduce__(self) -> tuple[Any, ...]:
        return parse, (self.to_json(), self.own_effects, self.own_model)


def _are_several(
    flight: AnyFlight | Sequence[AnyFlight] | None,
) -> TypeGuard[Sequence[AnyFlight]]:
    return isinstance(flight, Sequence) and not isinstance(flight, str)


@checked
def load(
    file: Path,
    effects: Sequence[Effect] = (),
    model: AnyModel | None = None,
) -> Calibration | AircraftFit:
    """Reads what save() or an app's fit wrote.

    Args:
        file: The JSON.
        effects: The effects of your own that the calibration was fitted with, which a file can't
            hold. Without them its numbers can be read and nothing be done with it.
        model: The model that it is of, but for a probe, which the file names; one with a state as
            it was laid, with its options, which the file doesn't hold.

    Returns:
        A Calibration; of a flight path or an aircraft an AircraftFit.

    Raises:
        Error: The file can't be read, is no calibration, or is of another schema version; an effect
            that it doesn't have; another model.

    Example:
        >>> flight = sepcal.datasets.load("pitot")
        >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
        >>> base.save(folder / "base.json")
        >>> sepcal.load(folder / "base.json")["w_n"].value == base["w_n"].value
        True
    """
    name = name_of(file)
    if _is_of_aircraft(name):
        return read_fit(name)
    own = None if model is None else to_own(model)
    core = _core.read_calibration(
        name, to_core_effects(effects), None if own is None else own._core
    )
    return Calibration(core, own=effects, own_model=own)


def _is_of_aircraft(file: str) -> bool:
    """Whether it says so; what can't be read is refused by who reads it in earnest."""
    try:
        with open(file, encoding="utf-8") as opened:
            read = json.load(opened)
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(read, dict) and ("aircraft" in read or {"path", "aero"} <= set(read))


def parse(text: str, effects: Sequence[Effect], own: Model | None = None) -> Calibration:
    """A calibration of its JSON, its own effects, and its own model."""
    core = _core.parse_calibration(
        text, "pickle", to_core_effects(effects), None if own is None else own._core
    )
    return Calibration(core, own=effects, own_model=own)
