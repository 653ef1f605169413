# SPDX-License-Identifier: BSD-3-Clause
"""How far parameters may lie, by standard errors and by the likelihood; predictions with bands."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Unpack

from sepcal import _core
from sepcal.arguments import checked, found_by
from sepcal.columns import Array, Columns, by_name, labels_in, take_columns, take_drivers
from sepcal.fit_options import FitOptions
from sepcal.options import spelled_out, to_core, to_names
from sepcal.own_effect import CoreEffect, given_effects, name_effects, to_core_effects
from sepcal.own_state_model import AnyModel, as_model
from sepcal.pages import Page, Row
from sepcal.plots import Backend, Theme
from sepcal.results import Fit


@checked
class Intervals(Page, _core.Intervals):
    """`print(intervals)` shows the table; `intervals["w_n"]` is one parameter's.

    Example:
        >>> flight = sepcal.datasets.load("pitot")
        >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
        >>> intervals = base.intervals(level=0.9, names=["w_n", "w_e"])
        >>> intervals
        <sepcal.Intervals of 90 %: 2 parameters>
        >>> intervals["w_n"].gaussian[0] < intervals["w_n"].value
        True
    """

    _shown = (
        "name",
        "value",
        "gaussian_lower",
        "gaussian_upper",
        "profile_lower",
        "profile_upper",
        "unit",
    )

    def __getitem__(self, name: str) -> _core.ParameterInterval:
        """One parameter's. Raises Error, a KeyError too, listing the names."""
        return found_by(super().__getitem__, name)

    def to_json(self) -> str:
        """The JSON; of a calibration's, what the app's `intervals` prints.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> base.intervals(names=["s_va"]).to_json().startswith("{")
            True
        """
        return self.json

    def to_dict(self) -> dict[str, Any]:
        """The same as a dictionary; None where a number is undefined or infinite.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> base.intervals(names=["s_va"]).to_dict()["level"]
            0.95
        """
        read: dict[str, Any] = json.loads(self.json)
        return read

    def plot(self, *, backend: Backend = "plotly", theme: Theme = "light") -> Any:  # noqa: ANN401
        """Draws both kinds of interval, a row a parameter.

        Args:
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; the library is not installed.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> drawn = base.intervals(names=["w_n", "w_e"]).plot(backend="matplotlib")
        """
        from sepcal.plotting import as_figure
        from sepcal.plotting.of_fits import picture_intervals

        return as_figure(picture_intervals(self), backend, theme)

    def _summary(self) -> str:
        return f"of {100 * self.level:g} %: {len(self.parameters)} parameters"

    def _rows(self) -> list[Row]:
        return [
            {
                "name": at.name,
                "value": at.value,
                "unit": at.unit,
                "gaussian_lower": at.gaussian[0],
                "gaussian_upper": at.gaussian[1],
                "profile_lower": at.profile[0],
                "profile_upper": at.profile[1],
                "lower_end": at.ends[0],
                "upper_end": at.ends[1],
                "message": at.message,
            }
            for at in self.parameters.values()
        ]


@checked
class Prediction(_core.Prediction):
    """A fit's predictions of N samples, in the outputs' units and the model's order of outputs.

    Attributes:
        outputs: Their names; pickled they are lost.
        units: Units of outputs by name, as far as they are known; pickled they are lost.

    Example:
        >>> flight = sepcal.datasets.load("pitot")
        >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
        >>> prediction = base.predict()
        >>> prediction.outputs, prediction.value.shape
        (('airspeed',), (480, 1))
    """

    outputs: tuple[str, ...] = ()
    units: Mapping[str, str] = MappingProxyType({})
    _level: float | None = None

    def __init__(
        self,
        core: _core.Prediction,
        outputs: Iterable[str] = (),
        units: Mapping[str, str] | None = None,
        level: float | None = None,
    ) -> None:
        super().__init__(core)
        self.outputs, self.units, self._level = tuple(outputs), dict(units or {}), level

    @property
    def band(self) -> tuple[Array, Array]:
        """Lower and upper limits of the value."""
        half = self.quantile * self.standard_error
        return self.value - half, self.value + half

    @property
    def measurement_band(self) -> tuple[Array, Array]:
        """Lower and upper limits of a new measurement, its noise included."""
        half = self.quantile * self.measurement_error
        return self.value - half, self.value + half

    def plot(self, *, backend: Backend = "plotly", theme: Theme = "light") -> Any:  # noqa: ANN401
        """Draws every output's value with the band of a new measurement.

        Args:
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; the library is not installed.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> drawn = base.predict().plot(backend="matplotlib")
        """
        from sepcal.plotting import as_figure
        from sepcal.plotting.of_fits import picture_prediction

        return as_figure(picture_prediction(self), backend, theme, columns=1)


@spelled_out()
@checked
def profile_intervals(
    model: AnyModel,
    data: Columns,
    fit: Fit,
    *,
    level: float = 0.95,
    names: Sequence[str] | None = None,
    **options: Unpack[FitOptions],
) -> Intervals:
    """Gaussian and profile-likelihood intervals of a fit on columns; a Calibration has a method.

    The profile-likelihood interval of a parameter is where the cost, with all others fitted again,
    stays below a height that the level gives. It follows a likelihood that is no parabola, and ends
    at a bound where the bound, not the data, ends it.

    Args:
        model: That was fitted.
        data: The inputs and outputs that were fitted.
        fit: The fit.
        level: How often an interval should hold the true value.
        names: Parameters [all that are free].
        **options: Those of the fit.

    Raises:
        Error: The fit is not that of the model, the data and the options; a parameter that there
            isn't or that is fixed; a level outside (0, 1).

    Example:
        >>> class Line:
        ...     inputs, outputs = {"v": "m/s"}, {"z": "m/s"}
        ...     linear, nonlinear = {"k": "1"}, {}
        ...     def at(self, u, xi2):
        ...         return u.v[:, None, None], np.zeros((len(u.v), 1))
        ...
        >>> v = np.linspace(10.0, 20.0, 50)
        >>> data = {"v": v, "z": 2.0 * v + np.sin(9.0 * v)}
        >>> fit = sepcal.fit(Line(), data)
        >>> low, high = sepcal.profile_intervals(Line(), data, fit)["k"].profile
        >>> low < 2.0 < high
        True
    """
    laid, columns, labels, core, own = as_fitted(model, data, fit, options, measured=True)
    names = to_names("names", () if names is None else names)
    return Intervals(_core.profile_intervals(laid, columns, labels, core, own, fit, level, names))


@spelled_out()
@checked
def predict(
    model: AnyModel,
    data: Columns,
    fit: Fit,
    *,
    level: float = 0.95,
    **options: Unpack[FitOptions],
) -> Prediction:
    """Predicts samples, with the bands of the value and of a new measurement.

    Args:
        model: That was fitted.
        data: Its inputs, and what drives its effects, each of shape (N,); other columns are
            ignored.
        fit: The fit.
        level: How often a band should hold what it is for.
        **options: Those of the fit: its noise, if it was given, and its effects matter.

    Raises:
        Error: Bad input, a fit of another model, a level outside (0, 1).

    Example:
        >>> class Line:
        ...     inputs, outputs = {"v": "m/s"}, {"z": "m/s"}
        ...     linear, nonlinear = {"k": "1"}, {}
        ...     def at(self, u, xi2):
        ...         return u.v[:, None, None], np.zeros((len(u.v), 1))
        ...
        >>> v = np.linspace(10.0, 20.0, 50)
        >>> fit = sepcal.fit(Line(), {"v": v, "z": 2.0 * v + np.sin(9.0 * v)})
        >>> float(sepcal.predict(Line(), {"v": [100.0]}, fit).value.round()[0, 0])
        200.0
    """
    laid, columns, labels, core, own = as_fitted(model, data, fit, options, measured=False)
    predicted = _core.predict(laid, columns, labels, core, own, fit, level)
    return Prediction(predicted, list(fit.noise), as_model(model).units, level)


def as_fitted(
    model: AnyModel,
    data: Columns,
    fit: Fit,
    options: FitOptions,
    *,
    measured: bool,
) -> tuple[_core.Model, dict[str, Array], list[str], _core.Options, list[CoreEffect]]:
    """The model along the columns, these, labels, options and own effects, as C++ takes them."""
    if hasattr(fit, "core"):
        raise _core.Error("a calibration knows its model: call its own intervals() or predict()")
    model = as_model(model)
    if model.runs_in_python:
        options["threads"] = options.get("threads") or 1
    own = to_core_effects(given_effects(options))
    options["effects"] = name_effects(given_effects(options))
    names = [setting.name for setting in fit.effects]
    data = by_name(data)
    there = set(data)
    needed = [*model._columns_in(data), *({"time"} & there)]
    if measured:
        needed += model._measured_in(data)
    columns = take_columns(model._owner, data, dict.fromkeys(needed))
    if names:
        columns |= take_drivers(model._owner, data, columns, _core.channels(names))
    labels = labels_in(data)
    return model._core.along(columns, labels), columns, labels, to_core(options), own
