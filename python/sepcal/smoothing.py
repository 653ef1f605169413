# SPDX-License-Identifier: BSD-3-Clause
"""States and process noise along a record, given all of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from sepcal import _core
from sepcal.arguments import Missing, checked, shown
from sepcal.columns import Array, Columns, by_name, labels_in, take_columns, to_column
from sepcal.own_state_model import AnyModel, as_model
from sepcal.plots import Backend, Theme
from sepcal.results import Fit
from sepcal.states_module import states_module
from sepcal.tracking import units_of_states


@checked
class Smoothed(_core.SmoothedRecord):
    """States and process noise, given all samples. `smoothed["alpha"]` is one state, (N,).

    Attributes:
        time: (N,) [s]; None where the data have none, and where it was pickled.
        units: Units of states and outputs by name, as far as they are known; pickled they are lost.

    Example:
        >>> flight = sepcal.datasets.load("aircraft")
        >>> path = sepcal.fit(sepcal.FlightPath(), flight)
        >>> smoothed = path.smooth({"ax": 0.05})
        >>> smoothed["u"].shape == (flight.rows,)
        True
    """

    time: Array | None = None
    units: Mapping[str, str] = MappingProxyType({})

    def __init__(
        self,
        core: _core.SmoothedRecord,
        time: Array | None = None,
        units: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(core)
        self.time, self.units = time, units_of_states(units or {})

    @property
    def standard_error(self) -> Array:
        """Standard errors of x, (N, n_x)."""
        return np.sqrt(np.diagonal(self.covariance, axis1=1, axis2=2))

    @property
    def w_standard_error(self) -> Array:
        """Standard errors of w, (N, n_w): those of its density less what the record tells."""
        return np.sqrt(np.diagonal(self.w_covariance, axis1=1, axis2=2))

    @property
    def log_likelihood(self) -> float:
        """Ln L of the record's outputs, S 5.5."""
        return -self.cost - 0.5 * self.readings * math.log(2.0 * math.pi)

    def plot(
        self,
        what: Literal["states", "innovations", "process noise"] | str = "states",
        *,
        backend: Backend = "plotly",
        theme: Theme = "light",
    ) -> Any:  # noqa: ANN401
        """Draws states with their bands; innovations and noises that should be nothing.

        Args:
            what: "states", "innovations" or "process noise".
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; the library is not installed.

        Example:
            >>> flight = sepcal.datasets.load("aircraft")
            >>> path = sepcal.fit(sepcal.FlightPath(), flight)
            >>> drawn = path.smooth({"ax": 0.05}).plot(backend="matplotlib")
        """
        from sepcal.plotting import as_figure, choose
        from sepcal.plotting.of_records import picture_smoothed

        choose(what, ("states", "innovations", "process noise"))
        return as_figure(picture_smoothed(self, what), backend, theme)

    def __getitem__(self, state: str) -> Array:
        """x(k|N) of one state, (N,)."""
        if not isinstance(state, str) or state not in self.states:
            raise Missing(f"there is no state {shown(state)}; there are: {', '.join(self.states)}")
        return np.asarray(self.x[:, self.states.index(state)])

    def __repr__(self) -> str:
        return f"<sepcal.Smoothed {', '.join(self.states)}: {len(self.x)} rows>"


@checked
def smooth(
    model: AnyModel,
    data: Columns,
    fit: Fit,
    process_noise: Mapping[str, float] | None = None,
    *,
    noise: Mapping[str, float] | None = None,
    start: Mapping[str, float] | None = None,
    parameter_errors: bool = True,
) -> Smoothed:
    """States and process noise along a record, by the extended filter and its smoother.

    System Identification Summary, S 2.20 to 2.23 and 3.1 to 3.14, at the parameters of a fit.

    Args:
        model: With a state, that was fitted.
        data: As for the fit; outputs may be missing, NaN.
        fit: The fit.
        process_noise: Roots of the noises' spectral densities, {name: sd}, by the names and in the
            units of the model's table of noises; those not named are none [of a fit by filter error
            those that it found].
        noise: Standard deviation of every output [the fit's].
        start: Standard deviation of states at the start about the fit's [ten times the largest
            value of the state on the way, as good as unknown].
        parameter_errors: Whether the fit's errors are part of the states' and the noise's, to first
            order; else they are of parameters that are known.

    Returns:
        A Smoothed: x and w with their covariances, innovations, the likelihood.

    Raises:
        Error: No process noise, or one that the model doesn't have; a model without a state; an
            input that is missing; where the filter can't go on, the row.

    Example:
        >>> class RollMode:
        ...     inputs, states, outputs = {"aileron": "rad"}, {"p": "rad/s"}, {"p_m": "rad/s"}
        ...     linear, nonlinear = {"b_p": "rad/s"}, {"Lp": ("1/s", -20, 0), "La": "1/s^2"}
        ...     linear_dynamic, noise = ["La"], {"p": "rad/s/sqrt(s)"}
        ...     def rate(self, x, u, p):
        ...         return [p[0] * x[0] + p[1] * u.aileron]
        ...     def at(self, x, u, p):
        ...         return [[1.0]], [x[0]]
        ...
        >>> t = np.linspace(0.0, 3.0, 100)
        >>> p = 0.3 * t - 0.15 * (1.0 - np.exp(-2.0 * t))
        >>> data = {"time": t, "aileron": 0.1 * t, "p_m": p}
        >>> fit = sepcal.fit(RollMode(), data, noise={"p_m": 0.01})
        >>> smoothed = sepcal.smooth(RollMode(), data, fit, {"p": 0.01})
        >>> bool(np.allclose(smoothed["p"] + fit["b_p"].value, data["p_m"], atol=1e-4))
        True
    """
    model = as_model(model)
    if fit.effects:
        raise _core.Error("smooth() knows no effects; fit the model without them")
    data = by_name(data)
    names = [*model._columns_in(data), *model._measured_in(data)]
    columns, labels = take_columns(model._owner, data, dict.fromkeys(names)), labels_in(data)
    parameters = {parameter.name: parameter.value for parameter in fit.parameters.values()}
    laid = model._core.along(columns, labels)
    outputs = dict(fit.noise if noise is None else noise)
    found = {
        size.name[2:]: size.value
        for size in fit.noise_sizes.values()
        if size.name.startswith("q_") and size.value > 0
    }
    time = to_column(model._owner, "time", data["time"]) if "time" in set(data) else None
    return Smoothed(
        states_module().smooth(
            laid,
            columns,
            labels,
            parameters,
            dict(found if process_noise is None else process_noise),
            outputs,
            dict(start or {}),
            fit if parameter_errors else None,
        ),
        time,
        model.units,
    )
