# SPDX-License-Identifier: BSD-3-Clause
"""An aircraft fitted on a flight, to be compared, extended, applied, smoothed, tracked, saved."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Unpack, overload

from sepcal import _core
from sepcal.aircraft import Aero, AircraftModel
from sepcal.arguments import checked
from sepcal.bands import RIGID
from sepcal.columns import Array
from sepcal.comparison import Comparison
from sepcal.diagnosis import Diagnosis
from sepcal.fit_options import FitOptions
from sepcal.flight import AnyFlight, Flight, to_flight, to_flight_of
from sepcal.geometry import Aircraft
from sepcal.input_design import InputDesign
from sepcal.intervals import Intervals
from sepcal.options import spelled_out, to_core, to_names
from sepcal.own_effect import given_effects, name_effects
from sepcal.pages import Page
from sepcal.plots import Backend, Theme
from sepcal.results import Fit
from sepcal.smoothing import Smoothed
from sepcal.states_module import states_module
from sepcal.stepwise import Stepwise, diagnosis_options, to_injected
from sepcal.tracking import Track, track_options
from sepcal.trajectories import FlightPath
from sepcal.whole_files import name_of

if TYPE_CHECKING:
    from sepcal import _states

Path = str | os.PathLike[str]


class AddedRegressor(NamedTuple):
    """An effect that was added, and the error of each output without and with it.

    Example:
        >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
        >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
        >>> aircraft = sepcal.Aircraft(**size, **mass)
        >>> flight = sepcal.simulate(aircraft, rows=400)
        >>> fit = sepcal.fit(sepcal.Aero(aircraft, "CX"), flight)
        >>> entry = fit.add("CX[alpha*q_hat]").history[0]
        >>> entry.effect, entry.rmse_after["CX"] <= entry.rmse_before["CX"]
        ('CX[alpha*q_hat]', True)
    """

    effect: str
    rmse_before: dict[str, float]
    rmse_after: dict[str, float]
    predicted_drop: float  # over all outputs, each in units of its own, as one step promised
    drop: float  # the same as it fell; predicted is NaN of equation error


@checked
class AircraftFit(Fit):
    """A Fit of a flight path or an aircraft, with all that later verbs need.

    It pickles as its JSON, without the flight.

    Example:
        >>> flight = sepcal.datasets.load("aircraft")
        >>> path = sepcal.fit(sepcal.FlightPath(), flight)
        >>> abs(path["b_ax"].value - flight.truth["b_ax"]) < 3 * path["b_ax"].standard_error
        True
    """

    core: _states.Fit
    flight: Flight | None  # that was fitted; None where the fit was loaded

    def __init__(self, core: _states.Fit, flight: Flight | None = None) -> None:
        super().__init__(core.fit)
        self.core = core
        self.flight = flight

    @property
    def model(self) -> str:
        """One of path, longitudinal, lateral, six-dof, aero."""
        return self.core.model

    @property
    def method(self) -> str:
        """Either output-error or equation-error."""
        return self.core.method

    @property
    def equations(self) -> dict[str, list[str]]:
        """{coefficient: [regressors]}, of a path none."""
        return self.core.equations

    @property
    def initial_states(self) -> list[str]:
        """Names of these parameters."""
        return self.core.initial_states

    @property
    def history(self) -> list[AddedRegressor]:
        """An entry for every add()."""
        return [AddedRegressor(*entry) for entry in self.core.history]

    @property
    def notes(self) -> list[str]:
        """Notes on what was dropped or assumed, one line each, for people."""
        return self.core.notes

    @property
    def warning(self) -> str:
        """Errors that the intervals leave out; empty if none is known."""
        return self.core.warning

    def _summary(self) -> str:
        parameters = len(self.parameters)
        return f"{self.model} by {self.method}: {self.status}, {parameters} parameters"

    def compare(
        self,
        flight: AnyFlight | Sequence[AnyFlight] | None = None,
        *,
        reference: str | Sequence[str] = (),
    ) -> Comparison:
        """Residuals on a flight, by default the fitted one.

        Of another flight the initial states are estimated anew, all else is held.

        Args:
            flight: To compare with.
            reference: Columns of independent sensors, as of Calibration.compare(); they are set
                against what apply() gives.

        Raises:
            Error: Bad input, as in fit(); no flight given where the fit was loaded; a reference
                that is not there, or of nothing that apply() gives.

        Example:
            >>> flight = sepcal.datasets.load("aircraft")
            >>> path = sepcal.fit(sepcal.FlightPath(), flight)
            >>> round(path.compare().overall[0].rmse, 1)  # of the airspeed
            0.2
        """
        chosen = self._or_fitted(flight, "compare(")
        names = [reference] if isinstance(reference, str) else list(reference)
        return Comparison(self.core.compare(chosen._core, names), self.noise)

    def residuals(
        self, flight: AnyFlight | Sequence[AnyFlight] | None = None
    ) -> dict[str, Array | list[str]]:
        """The residuals on a flight, row by row, as `sepcal aircraft residuals` writes them.

        Arrays by header, of shape (rows,), rows being the flight's: time_s, and of each output
        what was measured and modelled and the residual in its unit, ax_residual_mps2, and
        ax_whitened, the residual over the standard deviation of its noise; NaN in rows that were
        not used, of which `why_not` tells why, and is "" of the others.

        Raises:
            Error: As in compare().

        Example:
            >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
            >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
            >>> aircraft = sepcal.Aircraft(**size, **mass)
            >>> flight = sepcal.simulate(aircraft, rows=400)
            >>> fit = sepcal.fit(sepcal.Aero(aircraft, "CX"), flight)
            >>> left = fit.residuals()
            >>> left["CX_residual"].shape, left["why_not"][:1]
            ((400,), [''])
        """
        chosen = self._or_fitted(flight, "residuals(")
        columns, why_not = self.core.residuals(chosen._core)
        return {**dict(columns), "why_not": why_not}

    @overload
    def diagnose(
        self,
        flight: AnyFlight | Sequence[AnyFlight] | None = None,
        *,
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
        auto: Literal[True],
        most: int | None = None,
        only: Sequence[str] = (),
        simulations: int = 40,
        seed: int = 0,
        pse: Literal["sidpac", "classic"] | str = "sidpac",
        rule: Literal["verdict", "partial-f"] | str = "verdict",
        error_budget: Mapping[str, float] | None = None,
        within: float | None = None,
    ) -> Stepwise[AircraftFit]: ...

    def diagnose(
        self,
        flight: AnyFlight | Sequence[AnyFlight] | None = None,
        *,
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
    ) -> Diagnosis | Stepwise[AircraftFit]:
        """Which effect or regressor does it lack on a flight?

        Of coefficients tried are products as "Cm[alpha*elevator]", of Aero splines too,
        "CX[spline(alpha,5)]", and every other numeric channel of the log. Along a trajectory also
        what sensors and wind may have, "gyro_bias[imu_temp_degc]", "imu_late", "wind[time]".

        Args:
            flight: By default the fitted one.
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
            Error: Bad input, as in fit(); an effect to inject that the fit has, or beside auto;
                most below 1 or without auto; a name in only that is no regressor.

        Example:
            >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
            >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
            >>> aircraft = sepcal.Aircraft(**size, **mass)
            >>> flight = sepcal.simulate(aircraft, rows=400)
            >>> fit = sepcal.fit(sepcal.Aero(aircraft, "CX"), flight)
            >>> fit.diagnose(only=["CX[alpha*q_hat]"], simulations=10).verdict  # nothing is missing
            'adequate'
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
        if not auto:
            return Diagnosis(self.core.diagnose(chosen._core, injected, asked))
        stepped = self.core.diagnose_stepwise(chosen._core, most, asked)
        return Stepwise(AircraftFit(stepped.fitted, chosen), stepped)

    def intervals(
        self,
        flight: AnyFlight | Sequence[AnyFlight] | None = None,
        *,
        level: float = 0.95,
        names: Sequence[str] | None = None,
    ) -> Intervals:
        """Gaussian and profile-likelihood intervals of the parameters, side by side.

        Args:
            flight: That was fitted; to be given where the fit was loaded.
            level: How often an interval should hold the true value.
            names: Parameters [all that are free].

        Raises:
            Error: Another flight; a fit by filter error; a parameter that there isn't or that is
                fixed; a level outside (0, 1).

        Example:
            >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
            >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
            >>> aircraft = sepcal.Aircraft(**size, **mass)
            >>> flight = sepcal.simulate(aircraft, rows=400)
            >>> fit = sepcal.fit(sepcal.Aero(aircraft, "CX"), flight)
            >>> fit.intervals(names=["CX_alpha"])
            <sepcal.Intervals of 95 %: 1 parameters>
        """
        chosen = self._or_fitted(flight, "intervals(")
        return Intervals(
            self.core.intervals(
                chosen._core, level, to_names("names", () if names is None else names)
            )
        )

    def expect(
        self,
        inputs: InputDesign | AnyFlight,
        flight: AnyFlight | Sequence[AnyFlight] | None = None,
    ) -> Fit:
        """The fit that a flight of these inputs would give, before it is flown.

        The model flies them at this fit's values, and what it gives is fitted without noise: the
        standard errors are the bound of Cramer and Rao, for white noise of this fit's size (of one
        by filter error with its process noise), with this fit's options and what it holds.

        Args:
            inputs: The result of multisines() or three_two_one_one(); or time_s and columns by the
                log's headers, which add to what the first row has.
            flight: Where the aircraft begins: its first row, and this fit's initial state there.

        Raises:
            Error: A path or equation error, which fly nothing; an input that the model doesn't
                read of the flight; as fit().

        Example:
            >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
            >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
            >>> aircraft = sepcal.Aircraft(**size, **mass)
            >>> flight = sepcal.simulate(aircraft, rows=400)
            >>> fit = sepcal.fit(sepcal.RigidAircraft(aircraft, "longitudinal"), flight)
            >>> short = fit.expect(sepcal.multisines({"elevator_rad": 0.02}, duration=10))
            >>> twice = fit.expect(sepcal.multisines({"elevator_rad": 0.02}, duration=20))
            >>> twice["Cm_elevator"].standard_error < short["Cm_elevator"].standard_error
            True
        """
        chosen = self._or_fitted(flight, "expect(..., ")
        if isinstance(inputs, InputDesign):
            inputs = {"time_s": inputs.time, **inputs.signals}
        table = to_flight(inputs, "expect(")
        return Fit(self.core.expect(chosen._core, table._core))

    def add(
        self, effect: str, flight: AnyFlight | Sequence[AnyFlight] | None = None
    ) -> AircraftFit:
        """The same fit with an effect more, as "Cm[alpha^2]" or "imu_late", from where it ended.

        Of Aero also a spline, "CX[spline(alpha,5)]".

        Raises:
            Error: Bad input, as in fit(); an effect that the model doesn't know, listing those
                that it does.

        Example:
            >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
            >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
            >>> aircraft = sepcal.Aircraft(**size, **mass)
            >>> flight = sepcal.simulate(aircraft, rows=400)
            >>> fit = sepcal.fit(sepcal.Aero(aircraft, "CX"), flight)
            >>> fit.add("CX[alpha*q_hat]").history[0].effect
            'CX[alpha*q_hat]'
        """
        chosen = self._or_fitted(flight, "add(..., ")
        return AircraftFit(self.core.add(chosen._core, effect), chosen)

    def apply(
        self, flight: AnyFlight | None = None, *, process_noise: Mapping[str, float] | None = None
    ) -> dict[str, Array]:
        """The corrected readings and modelled outputs by header, each of shape (rows,).

        Of every model the outputs as modelled, `alpha_model_rad`. Of a path also readings
        corrected, `ax_cal_mps2`, `alpha_cal_rad`, the velocity through the air, `u_mps`, and with
        an aircraft the six coefficients. With process noise also `u_smooth_mps`, `u_sd_mps`,
        `w_ax_mps2`, `alpha_innovation_rad`, as smooth() has them. NaN outside segments.

        Args:
            flight: By default the fitted one.
            process_noise: As in smooth().

        Example:
            >>> flight = sepcal.datasets.load("aircraft")
            >>> path = sepcal.fit(sepcal.FlightPath(), flight)
            >>> [name for name in path.apply() if name.endswith("_cal_rad")]
            ['beta_cal_rad', 'alpha_cal_rad', 'roll_cal_rad', 'pitch_cal_rad', 'yaw_cal_rad']
        """
        chosen = self._or_fitted(flight, "apply(")
        columns, _ = self.core.apply(chosen._core, dict(process_noise or {}))
        return columns

    def apply_to_file(
        self, file: Path, output: Path, *, process_noise: Mapping[str, float] | None = None
    ) -> _core.Applied:
        """Copies a CSV log and adds these columns; `output` appears whole or not at all.

        Example:
            >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
            >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
            >>> aircraft = sepcal.Aircraft(**size, **mass)
            >>> flight = sepcal.simulate(aircraft, rows=400)
            >>> fit = sepcal.fit(sepcal.Aero(aircraft, "CX"), flight)
            >>> flight.to_csv(folder / "flight.csv")
            >>> fit.apply_to_file(folder / "flight.csv", folder / "modelled.csv").rows
            400
            >>> "CX_model" in sepcal.read_csv(folder / "modelled.csv").columns
            True
        """
        given = dict(process_noise or {})
        return self.core.apply_to_file(name_of(file), name_of(output), given)

    def smooth(
        self, process_noise: Mapping[str, float] | None = None, flight: AnyFlight | None = None
    ) -> Smoothed:
        """States and process noise, given all of a flight, at the fit's parameters.

        Args:
            process_noise: Roots of spectral densities, {name: sd}: of a path the inertial unit's
                ax ay az [m/s^2/sqrt(Hz)], p q r [rad/s/sqrt(Hz)]; of an aircraft those of u v w p
                q r's derivatives.
            flight: By default the fitted one.

        Raises:
            Error: No process noise, another name; equation error, which has no state.

        Example:
            >>> flight = sepcal.datasets.load("aircraft")
            >>> path = sepcal.fit(sepcal.FlightPath(), flight)
            >>> path.smooth({"ax": 0.05, "az": 0.05}).states
            ('u', 'v', 'w', 'phi', 'theta', 'psi')
        """
        chosen = self._or_fitted(flight, "smooth({...}, ")
        core = self.core.smooth(chosen._core, dict(process_noise or {}))
        return Smoothed(core, _seconds(chosen), self._units_on(chosen))

    def track(
        self,
        flight: AnyFlight | None = None,
        *,
        start_rows: int = 0,
        method: Literal["rls", "ekf", "iekf", "srif", "rml", "rft"] | str = "ekf",
        noise: Mapping[str, float] | None = None,
        process_noise: Mapping[str, float] | None = None,
        walk: Mapping[str, float] | None = None,
        changes: Literal["ignore", "find", "follow"] | str = "ignore",
        initial_states: Mapping[str, float] | None = None,
        row_iterations: int = 20,
        tolerance: float = 1e-8,
        forgetting: float = 1.0,
        memory: float = 0.0,
        every: int = 10,
        band: tuple[float, float] = RIGID,
        spacing: float = 0.0,
    ) -> Track:
        """States and parameters against time, as a filter in flight estimates them.

        Args:
            flight: By default the fitted one, which needs start_rows.
            start_rows: Fits so many first rows and goes on after them; 0: from this fit, which must
                be of another flight.
            method: As in sepcal.track().
            noise: Standard deviation of every output, in the first rows too [the start's].
            process_noise: As in smooth(); those not named are none.
            walk: Random walks of parameters, as in sepcal.track().
            changes: "find" or "follow" parameters that jump, as in sepcal.track().
            initial_states: Standard deviations of states where a segment begins [as good as
                unknown].
            row_iterations: For iekf: the largest number of iterations per row.
            tolerance: For iekf.
            forgetting: Forgetting factor, above 0, at most 1: multiplies older rows' weights.
            memory: As in sepcal.track().
            every: For rml: the number of samples between steps of the parameters.
            band: For rft, as in sepcal.track().
            spacing: For rft.

        Raises:
            Error: The fit's own flight without start_rows, whose rows must not count twice; rows
                that are too few; names that the model doesn't have.

        Example:
            >>> flight = sepcal.datasets.load("aircraft")
            >>> path = sepcal.fit(sepcal.FlightPath(), flight)
            >>> track = path.track(start_rows=200)
            >>> off = track["b_ax"][-1] - flight.truth["b_ax"]
            >>> bool(abs(off) < 3 * track.standard_deviation("b_ax")[-1])
            True
        """
        chosen = self._or_fitted(flight, "track(")
        options = track_options(
            method=method,
            noise=noise,
            process_noise=process_noise,
            walk=walk,
            changes=changes,
            initial_states=initial_states,
            row_iterations=row_iterations,
            tolerance=tolerance,
            forgetting=forgetting,
            memory=memory,
            every=every,
            band=band,
            spacing=spacing,
            start_rows=start_rows,
        )
        core, notes = self.core.track(chosen._core, options)
        return Track(core, self._units_on(chosen), notes)

    def plot(
        self,
        what: Literal[
            "fit", "channels", "states", "innovations", "process noise", "correlation", "ellipses"
        ]
        | str = "fit",
        flight: Flight | Sequence[Flight] | None = None,
        *,
        process_noise: Mapping[str, float] | None = None,
        backend: Backend = "plotly",
        theme: Theme = "light",
    ) -> Any:  # noqa: ANN401
        """Draws the fit on a flight, as the report does.

        Args:
            what: "fit", measured over modelled with the residuals below; "channels", residuals
                against the channels that they follow most; "correlation" of the estimates,
                "ellipses" of the pairs that are correlated most; with process noise "states",
                "innovations" and "process noise".
            flight: By default the fitted one.
            process_noise: As in smooth() [of a fit by filter error what it found].
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; bad input, as in compare(); no process noise where
                it is needed; the library is not installed.

        Example:
            >>> flight = sepcal.datasets.load("aircraft")
            >>> path = sepcal.fit(sepcal.FlightPath(), flight)
            >>> figure = path.plot()
            >>> states = path.plot("states", process_noise={"ax": 0.05}, backend="matplotlib")
        """
        from sepcal.plotting import as_figure, choose
        from sepcal.plotting.of_fits import picture_aircraft, picture_fit

        smoothed = ("states", "innovations", "process noise")
        choose(what, ("fit", "channels", *smoothed, "correlation", "ellipses"))
        if what in ("correlation", "ellipses"):
            return as_figure(picture_fit(self, what), backend, theme)
        chosen = self._or_fitted(flight, "plot(flight=")
        given = process_noise or {}
        return as_figure(picture_aircraft(self, what, chosen, given), backend, theme)

    def report(self, file: Path, flight: AnyFlight | None = None, **options: Any) -> None:  # noqa: ANN401
        """Writes its report to one HTML page, as sepcal.report(), which takes several as well.

        Args:
            file: To write.
            flight: To report on [the one that was fitted].
            **options: Those of sepcal.report(): files, process_noise, progress.

        Raises:
            Error: As sepcal.report().

        Example:
            >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
            >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
            >>> aircraft = sepcal.Aircraft(**size, **mass)
            >>> flight = sepcal.simulate(aircraft, rows=400)
            >>> fit = sepcal.fit(sepcal.Aero(aircraft, "CX"), flight)
            >>> fit.report(folder / "report.html")
            >>> (folder / "report.html").read_text(encoding="utf-8")[:15]
            '<!DOCTYPE html>'
        """
        from sepcal.reporting import report

        report(self, file, flight, **options)

    def _units_on(self, flight: Flight) -> dict[str, str]:
        """Units of the parameters and, if the flight has all outputs, of these."""
        known = {name: parameter.unit for name, parameter in self.parameters.items()}
        try:
            outputs = self.core.compare(flight._core).overall
        except _core.Error:  # a filter goes without an output that is not logged
            return known
        return known | {misfit.output: misfit.unit for misfit in outputs}

    def _or_fitted(self, flight: AnyFlight | Sequence[AnyFlight] | None, call: str) -> Flight:
        """A flight, or several as one. Raises Error, which shows how to call again, for none."""
        flight = flight if flight is not None else self.flight
        if isinstance(flight, Sequence) and not isinstance(flight, str):
            given = [to_flight_of(self.core, one, call)._core for one in flight]
            return Flight._of(states_module().join(given, _core.Options(), self.core))
        if flight is None:
            raise _core.Error(
                f"a loaded fit has no flight; give one: {call}sepcal.read({self.core.file!r}))"
            )
        return to_flight_of(self.core, flight, call)

    def save(self, file: Path) -> None:
        """Writes to_json() to a file that appears whole or not at all.

        Example:
            >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
            >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
            >>> aircraft = sepcal.Aircraft(**size, **mass)
            >>> flight = sepcal.simulate(aircraft, rows=400)
            >>> fit = sepcal.fit(sepcal.Aero(aircraft, "CX"), flight)
            >>> fit.save(folder / "aero.json")
            >>> sepcal.load(folder / "aero.json")["CX_alpha"].value == fit["CX_alpha"].value
            True
        """
        self.core.save(name_of(file))

    def to_json(self) -> str:
        """The JSON that the app's fit writes with -o.

        Example:
            >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
            >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
            >>> aircraft = sepcal.Aircraft(**size, **mass)
            >>> flight = sepcal.simulate(aircraft, rows=400)
            >>> fit = sepcal.fit(sepcal.Aero(aircraft, "CX"), flight)
            >>> _ = (folder / "aero.json").write_text(fit.to_json())
            >>> sepcal.load(folder / "aero.json").model
            'aero'
        """
        return self.core.to_json()

    def to_dict(self) -> dict[str, Any]:
        """The same as a dictionary; None where a number is undefined.

        Example:
            >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
            >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
            >>> aircraft = sepcal.Aircraft(**size, **mass)
            >>> flight = sepcal.simulate(aircraft, rows=400)
            >>> fit = sepcal.fit(sepcal.Aero(aircraft, "CX"), flight)
            >>> fit.to_dict()["model"]
            'aero'
        """
        read: dict[str, Any] = json.loads(self.to_json())
        return read

    def __reduce__(self) -> tuple[Any, ...]:
        return _parse, (self.to_json(),)


@checked
class TwoSteps(Page):
    """A flight path, then the aerodynamics of what was flown.

    Attributes:
        path: The first step.
        aero: The second.
        notes: One line each, for people.

    Example:
        >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
        >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
        >>> aircraft = sepcal.Aircraft(**size, **mass)
        >>> flight = sepcal.simulate(aircraft, rows=400)
        >>> steps = sepcal.two_step(flight, aircraft, equations={"CZ": ["1", "alpha"]})
        >>> steps.path.model, steps.aero.equations
        ('path', {'CZ': ['1', 'alpha']})
    """

    _shown = ("name", "value", "standard_error", "unit")

    def __init__(self, core: _states.Steps, flight: Flight) -> None:
        self._core, self._flight = core, flight
        self.path, self.aero = AircraftFit(core.path, flight), AircraftFit(core.aero, flight)
        self.notes, self._page, self._json = core.notes, core.text, core.json

    @property
    def text(self) -> str:
        """The app's page, as print() shows it."""
        return self._page

    def to_json(self) -> str:
        """The JSON that the app's two-step writes with -o.

        Example:
            >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
            >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
            >>> aircraft = sepcal.Aircraft(**size, **mass)
            >>> flight = sepcal.simulate(aircraft, rows=400)
            >>> steps = sepcal.two_step(flight, aircraft, equations={"CZ": ["1", "alpha"]})
            >>> _ = (folder / "steps.json").write_text(steps.to_json())
        """
        return self._json

    def track(
        self,
        flight: AnyFlight | None = None,
        *,
        start_rows: int = 0,
        method: Literal["ekf", "iekf", "srif"] | str = "ekf",
        second: Literal["rls", "ekf", "srif", "rft"] | str = "rls",
        noise: Mapping[str, float] | None = None,
        process_noise: Mapping[str, float] | None = None,
        walk: Mapping[str, float] | None = None,
        changes: Literal["ignore", "find", "follow"] | str = "ignore",
        forgetting: float = 1.0,
        memory: float = 0.0,
        band: tuple[float, float] = RIGID,
        spacing: float = 0.0,
    ) -> Track:
        """Both steps in flight: a filter of the path, and the coefficients where it says one is.

        Coefficients of a row are known half a window of the rates' differentiation later.

        Args:
            flight: By default the fitted one, which needs start_rows.
            start_rows: Fits so many first rows and goes on after them; 0: from these steps, which
                must be of another flight.
            method: For the path, as in sepcal.track().
            second: The method for the coefficients.
            noise: Standard deviations of the path's outputs [the start's].
            process_noise: For the path, {"ax": sd, ...} [that of the readings].
            walk: Random walks of parameters of either step; coefficients walk by ekf and srif.
            changes: "find" or "follow" coefficients that jump, by ekf and srif.
            forgetting: For the second step, as are the next three.
            memory: As in sepcal.track().
            band: For rft.
            spacing: For rft.

        Returns:
            A Track: states and parameters of the path, then the coefficients' terms.

        Raises:
            Error: As in AircraftFit.track().

        Example:
            >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
            >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
            >>> aircraft = sepcal.Aircraft(**size, **mass)
            >>> flight = sepcal.simulate(aircraft, rows=800)
            >>> steps = sepcal.two_step(flight, aircraft, equations={"CZ": ["1", "alpha"]})
            >>> steps.track(start_rows=400).names[-2:]
            ('CZ_0', 'CZ_alpha')
        """
        chosen = self.path._or_fitted(flight, "track(")
        options = track_options(
            method=method,
            noise=noise,
            walk=walk,
            changes=changes,
            row_iterations=20,
            tolerance=1e-8,
            start_rows=start_rows,
            process_noise=process_noise,
            forgetting=forgetting,
            memory=memory,
            band=band,
            spacing=spacing,
            second=second,
        )
        core, notes = self._core.track(chosen._core, options)
        units = {**self.path._units_on(chosen), **self.aero._units_on(chosen)}
        return Track(core, units, notes)

    def _summary(self) -> str:
        return f"path {self.path.status}, aerodynamics {self.aero.status}"

    def _rows(self) -> list[Any]:
        return self.aero._rows()

    def plot(
        self,
        what: Literal["path", "aero"] | str = "path",
        *,
        backend: Backend = "plotly",
        theme: Theme = "light",
    ) -> Any:  # noqa: ANN401
        """Draws one of the steps, measured over modelled.

        Args:
            what: "path" or "aero".
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; the library is not installed.

        Example:
            >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
            >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
            >>> aircraft = sepcal.Aircraft(**size, **mass)
            >>> flight = sepcal.simulate(aircraft, rows=400)
            >>> steps = sepcal.two_step(flight, aircraft, equations={"CZ": ["1", "alpha"]})
            >>> drawn = steps.plot("aero", backend="matplotlib")
        """
        from sepcal.plotting import choose

        choose(what, ("path", "aero"))
        step: AircraftFit = getattr(self, what)
        return step.plot(backend=backend, theme=theme)


def _seconds(flight: Flight) -> Array | None:
    """The flight's times, where they are in seconds."""
    return flight.get("time_s")


def fit_flight(model: AircraftModel, flight: Flight, options: FitOptions) -> AircraftFit:
    """Fits a flight path or an aircraft; fit() calls it."""
    core = states_module().fit(flight._core, _core_options(model, options))
    return AircraftFit(core, flight)


def fit_flights(
    model: AircraftModel, flights: Sequence[AnyFlight], options: FitOptions
) -> AircraftFit:
    """Fits several flights together, each with its own initial states; fit_jointly() calls it."""
    given = [to_flight(one, "fit_jointly(model, [", "", options)._core for one in flights]
    laid = _core_options(model, options)
    joined = Flight._of(states_module().join(given, to_core(options), None))
    return AircraftFit(states_module().fit(joined._core, laid), joined)


@spelled_out()
@checked
def two_step(
    flight: AnyFlight,
    aircraft: Aircraft,
    *,
    equations: Mapping[str, Any] | None = None,
    path: FlightPath | None = None,
    window: float = 0.0,
    **options: Unpack[FitOptions],
) -> TwoSteps:
    """The two-step method, S 6.3: the flight path, then equation error on what was flown.

    Args:
        flight: As for fit(FlightPath(...), flight) and fit(Aero(...), flight).
        aircraft: Its dimensions, mass and inertia.
        equations: {coefficient: [regressors]} of the second step [the standard ones, all six].
        path: How the first step is laid along the flight.
        window: Window of the local cubic that differentiates rates [s]; 0: seven rows.
        **options: FitOptions.

    Returns:
        A TwoSteps; its aero.warning says what is not in the intervals.

    Raises:
        Error: Bad input: one line that names the culprit and the way out.

    Example:
        >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
        >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
        >>> aircraft = sepcal.Aircraft(**size, **mass)
        >>> flight = sepcal.simulate(aircraft, rows=400)
        >>> steps = sepcal.two_step(flight, aircraft, equations={"CZ": ["1", "alpha"]})
        >>> abs(steps.aero["CZ_alpha"].value / flight.truth["CZ_alpha"] - 1) < 0.1
        True
    """
    chosen = to_flight(flight, "two_step(", "", options)
    aero = Aero(aircraft, equations=equations, window=window)
    first = (path or FlightPath())._aircraft_options()
    laid = {**aero._aircraft_options(), "trajectory": first["trajectory"]}
    laid["position"], laid["gravity"] = first["position"], first["gravity"]
    core = states_module().two_steps(chosen._core, _with_fit(laid, options))
    return TwoSteps(core, chosen)


def _core_options(model: AircraftModel, options: FitOptions) -> _states.Options:
    return _with_fit(model._aircraft_options(), options)


def _with_fit(laid: dict[str, Any], options: FitOptions) -> _states.Options:
    names = name_effects(given_effects(options))
    core: _states.Options = states_module().Options(
        **laid, fit=to_core({**options, "effects": names})
    )
    return core


def read_fit(file: Path) -> AircraftFit:
    """Reads what save() or the app's fit wrote. Raises Error for anything else."""
    return AircraftFit(states_module().read(name_of(file)))


def _parse(text: str) -> AircraftFit:
    return AircraftFit(states_module().parse(text, "pickle"))
