# SPDX-License-Identifier: BSD-3-Clause
"""Estimates against time: a recursive estimator along a record, as it would run in flight."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, Literal, Unpack

import numpy as np

from sepcal import _core
from sepcal.arguments import Missing, Misuse, checked, shown
from sepcal.bands import RIGID, to_band
from sepcal.columns import Array, Columns, by_name, labels_in, take_columns
from sepcal.fit_options import FitOptions
from sepcal.flight import Flight
from sepcal.options import LOG_CHOICE, spelled_out, to_core
from sepcal.own_state_model import AnyModel, as_model
from sepcal.plots import Backend, Theme
from sepcal.results import Fit
from sepcal.states_module import states_module
from sepcal.tables import table_of

REFUSED = ("effects", *LOG_CHOICE)  # of a fit's options


@checked
class Track(_core.Track):
    """Estimates against time. `track["Za"]` is one of them, (M,).

    Attributes:
        units: Units of states, parameters and outputs by name, as far as they are known; pickled
            they are lost.
        notes: For a flight: what was dropped or assumed, one line each, for people.

    Example:
        >>> flight = sepcal.datasets.load("aircraft")
        >>> path = sepcal.fit(sepcal.FlightPath(), flight)
        >>> path.track(start_rows=200).names[:3]
        ('u', 'v', 'w')
    """

    units: Mapping[str, str] = MappingProxyType({})
    notes: Sequence[str] = ()

    def __init__(
        self,
        core: _core.Track,
        units: Mapping[str, str] | None = None,
        notes: Sequence[str] = (),
    ) -> None:
        super().__init__(core)
        self.units = units_of_states(units or {})
        self.notes = list(notes)

    def __getitem__(self, name: str) -> Array:
        """One estimate against time, (M,)."""
        return np.asarray(self.estimates[:, self._place(name)])

    def standard_deviation(self, name: str) -> Array:
        """The standard deviation of one estimate against time, (M,).

        Example:
            >>> flight = sepcal.datasets.load("aircraft")
            >>> path = sepcal.fit(sepcal.FlightPath(), flight)
            >>> track = path.track(start_rows=200)
            >>> spread = track.standard_deviation("b_ax")
            >>> bool(spread[-1] < spread[0])  # every row tells more
            True
        """
        return np.asarray(self.standard_deviations[:, self._place(name)])

    def plot(
        self,
        what: Literal["estimates", "innovations"] | str = "estimates",
        *,
        backend: Backend = "plotly",
        theme: Theme = "light",
    ) -> Any:  # noqa: ANN401
        """Draws every estimate over time with 2 standard deviations to either side.

        Args:
            what: "estimates", of what is not held, or "innovations".
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; the library is not installed.

        Example:
            >>> flight = sepcal.datasets.load("aircraft")
            >>> path = sepcal.fit(sepcal.FlightPath(), flight)
            >>> drawn = path.track(start_rows=200).plot(backend="matplotlib")
        """
        from sepcal.plotting import as_figure, choose
        from sepcal.plotting.of_records import picture_track

        choose(what, ("estimates", "innovations"))
        return as_figure(picture_track(self, what), backend, theme)

    def _place(self, name: str) -> int:
        if not isinstance(name, str) or name not in self.names:
            raise Missing(f"there is no {shown(name)}; there are: {', '.join(self.names)}")
        return self.names.index(name)

    def _repr_html_(self) -> str:
        """The last estimates as a small table, for notebooks."""
        rows = [
            {
                "name": name,
                "estimate": float(self.estimates[-1, i]),
                "standard_deviation": float(self.standard_deviations[-1, i]),
                "unit": self.units.get(name, ""),
            }
            for i, name in enumerate(self.names)
        ]
        caption = f"sepcal.Track: the last of {len(self.rows)} rows"
        return table_of(caption, ("name", "estimate", "standard_deviation", "unit"), rows)

    def __repr__(self) -> str:
        return f"<sepcal.Track {', '.join(self.names)}: {len(self.rows)} rows>"


def units_of_states(units: Mapping[str, str]) -> dict[str, str]:
    """With those of the states, which are their initial values', "alpha_0" or "alpha_0[turn]"."""
    named = dict(units)
    for name, unit in units.items():
        state, is_initial, _ = name.partition("_0")
        if is_initial:
            named.setdefault(state, unit)
    return named


def track_options(
    *,
    method: str,
    noise: Mapping[str, float] | None,
    walk: Mapping[str, float] | None,
    changes: str,
    row_iterations: int,
    tolerance: float,
    start_rows: int,
    process_noise: Mapping[str, float] | None = None,
    initial_states: Mapping[str, float] | None = None,
    forgetting: float = 1.0,
    memory: float = 0.0,
    every: int = 10,
    band: tuple[float, float] = RIGID,
    spacing: float = 0.0,
    differentiate: bool = False,
    own: Sequence[str] = (),
    second: str = "rls",
) -> _core.FlightTrackOptions:
    """How a flight is followed, as the core has it."""
    return _core.FlightTrackOptions(
        method=method,
        noise=dict(noise or {}),
        process_noise=dict(process_noise or {}),
        walk=dict(walk or {}),
        changes=changes,
        initial_states=dict(initial_states or {}),
        iterations=_core.IterationOptions(row_iterations, tolerance),
        forgetting=forgetting,
        memory=memory,
        every=every,
        band=to_band(band, spacing),
        differentiate=differentiate,
        start_rows=start_rows,
        own=list(own),
        second=second,
    )


@spelled_out(without=(*REFUSED, "process_noise", "method"))
@checked
def track(  # type: ignore[misc]  # its process_noise drives the filter, not errors of a fit
    model: AnyModel,
    data: Columns,
    *,
    fitted: Fit | None = None,
    start_rows: int | None = None,
    method: Literal["rls", "ekf", "iekf", "srif", "rml", "rft"] | str = "ekf",
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
    differentiate: bool = False,
    **options: Unpack[FitOptions],
) -> Track:
    """Runs a recursive estimator along a record, from a calibration or from its own first rows.

    Of a model with a state, states and parameters are estimated together. The start from a
    mini-batch is Sun & Gebre-Egziabher's, Sec. VI: stages one and two on the first rows, whose
    triangular factor goes on as the stream's information.

    Args:
        model: As for fit().
        data: As for fit(); outputs of a model with a state may be missing, NaN, but for rls.
        fitted: A fit of other data to start from.
        start_rows: Fits so many rows first, by the options, and goes on after them.
        method: "rls", recursive least squares linearised at the start; "ekf", the extended filter;
            "iekf", iterated; "srif", the extended filter as square-root information; "rml",
            recursive maximum likelihood, S 5.10 to 5.13, from a start by filter error: sizes of the
            noises are estimated too, `q_alpha`, `r_alpha_m`; "rft", of models that are linear in
            their parameters, the recursive Fourier transform: equation error over a band (Morelli,
            J. Guid. Control Dyn. 23, 2000).
        process_noise: For a model with a state: roots of the noises' spectral densities, {name:
            sd}, by the names and in the units of its table of noises; those not named are none. By
            rml these are held, and those not named are estimated, as `noise` is of outputs. With
            start_rows the first rows are fitted by filter error then.
        walk: Parameters that may change on the way, {name: sd}: random walks, sd what one gathers
            in a second [unit / sqrt(s)]. Of ekf, iekf and srif.
        changes: For ekf, iekf and srif, a test on innovations that says when the parameters ceased
            to hold and which of them moved. "find": the first is in `changes`, the estimates stay
            as they are; "follow": what moved is opened from its onset on, and the next is looked
            for.
        initial_states: For states at the start of a segment that `start_rows` hasn't fitted: {name:
            sd} [ten times the largest value of the state on the way, as good as unknown].
        row_iterations: For iekf: the largest number of iterations per row.
        tolerance: For iekf: the shortest step, in standard deviations of the estimate.
        forgetting: Forgetting factor, above 0, at most 1: multiplies older rows' weights.
        memory: For rls, ekf, iekf and srif: how many rows count while innovations are as large as
            expected, fewer where they are larger [0: forgetting is constant].
        every: For rml: the number of samples between steps of the parameters.
        band: For rft, (low, high) of the frequencies [Hz].
        spacing: For rft, the step between frequencies [0: 0.05 Hz].
        differentiate: For rft: outputs hold what the model gives the derivatives of, and their
            transforms are multiplied by jw in place of a differentiation in time.
        **options: FitOptions.

    Returns:
        A Track.

    Raises:
        Error: No start, or two; rows that are too few; names that the model doesn't have; what
            fit() refuses.
        TypeError: An option that there isn't.

    Example:
        >>> class Line:
        ...     inputs, outputs = {"v": "m/s"}, {"z": "m/s"}
        ...     linear, nonlinear = {"k": "1"}, {}
        ...     def at(self, u, xi2):
        ...         return u.v[:, None, None], np.zeros((len(u.v), 1))
        ...
        >>> v = np.linspace(10.0, 20.0, 50)
        >>> data = {"v": v, "z": 2.0 * v + np.sin(9.0 * v)}
        >>> track = sepcal.track(Line(), data, start_rows=10, method="rls")
        >>> float(track["k"][-1].round(1))
        2.0
    """
    if (fitted is None) == (start_rows is None):
        raise _core.Error(
            "track() starts from one of two: fitted=FIT of other data, or start_rows=N of these"
        )
    for name in options:
        if name not in FitOptions.__annotations__:
            raise Misuse(f"track() has no option '{name}'; help(sepcal.track) shows what it has")
    for name in REFUSED:
        if options.get(name):
            raise _core.Error(f"track() knows no {name}; leave it out")
    if isinstance(data, Flight):
        raise _core.Error("track() takes columns by name; of a flight: AircraftFit.track(flight)")
    if fitted is not None and not isinstance(fitted, Fit):
        raise _core.Error(f"fitted is {fitted!r}; give a Fit, as sepcal.fit() makes it")
    if fitted is not None and fitted.effects:
        raise _core.Error("track() knows no effects; fit the model without them")
    if start_rows is not None and start_rows < 1:
        raise _core.Error(f"start_rows is {start_rows}; give the number of rows to fit first")
    model = as_model(model)
    if model.runs_in_python:
        options["threads"] = options.get("threads") or 1
    data = by_name(data)
    there = set(data)
    names = [*model._columns_in(data), *model._measured_in(data), *({"time"} & there)]
    columns = take_columns(model._owner, data, dict.fromkeys(names))
    return Track(
        states_module().track(
            model._core,
            columns,
            labels_in(data),
            fitted,
            to_core(options),
            track_options(
                method=method,
                noise=None,
                walk=walk,
                changes=changes,
                row_iterations=row_iterations,
                tolerance=tolerance,
                start_rows=start_rows or 0,
                process_noise=process_noise,
                initial_states=initial_states,
                forgetting=forgetting,
                memory=memory,
                every=every,
                band=band,
                spacing=spacing,
                differentiate=differentiate,
            ),
        ),
        model.units,
    )
