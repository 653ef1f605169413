# SPDX-License-Identifier: BSD-3-Clause
"""Many trials of one design, fitted side by side: the same inputs, other measurements."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sepcal import _core
from sepcal.arguments import checked
from sepcal.columns import Array, Columns, by_name, labels_in, take_columns
from sepcal.fit_options import FitOptions
from sepcal.matrices import to_numbers
from sepcal.options import refuse_log_choice, spelled_out, to_core
from sepcal.own_state_model import AnyModel, as_model
from sepcal.plots import Backend, Theme


@checked
@dataclass(frozen=True, eq=False)
class TrialFits:
    """The fits of K trials.

    Example:
        >>> class Line:
        ...     inputs, outputs = {"v": "m/s"}, {"z": "m/s"}
        ...     linear, nonlinear = {"k": "1"}, {}
        ...     def at(self, u, xi2):
        ...         return u.v[:, None, None], np.zeros((len(u.v), 1))
        ...
        >>> v = np.linspace(10.0, 20.0, 50)
        >>> fits = sepcal.fit_trials(Line(), {"v": v}, {"z": [2.0 * v, 3.0 * v]})
        >>> fits.names, fits.statuses
        (('k',), ('converged', 'converged'))
    """

    names: tuple[str, ...]  # n parameters, linear, then nonlinear
    estimates: Array  # (K, n); NaN where a trial could not be fitted
    standard_errors: Array  # (K, n); NaN where undefined
    squared_residuals: Array  # (K, n_z), sums over the rows
    statuses: tuple[str, ...]  # K: "converged", "not_converged", "not_identifiable"
    in_lanes: NDArray[np.bool_]  # (K,); False: fitted one by one
    estimated: int  # of the n parameters, those that are not fixed
    rows: int  # of each fit
    messages: Mapping[int, str]  # by trial, where there is something to say
    failures: Mapping[int, str]  # why a trial could not be fitted

    def plot(self, *, backend: Backend = "plotly", theme: Theme = "light") -> Any:  # noqa: ANN401
        """Draws how often the trials gave which estimate.

        Args:
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; the library is not installed.

        Example:
            >>> class Line:
            ...     inputs, outputs = {"v": "m/s"}, {"z": "m/s"}
            ...     linear, nonlinear = {"k": "1"}, {}
            ...     def at(self, u, xi2):
            ...         return u.v[:, None, None], np.zeros((len(u.v), 1))
            ...
            >>> v = np.linspace(10.0, 20.0, 50)
            >>> z = 2.0 * v + np.random.default_rng(1).normal(size=(20, 50))
            >>> fits = sepcal.fit_trials(Line(), {"v": v}, {"z": z})
            >>> drawn = fits.plot(backend="matplotlib")
        """
        from sepcal.plotting import as_figure
        from sepcal.plotting.of_studies import picture_trials

        return as_figure(picture_trials(self), backend, theme, columns=3)


@spelled_out(without=["effects"])
@checked
def fit_trials(
    model: AnyModel,
    design: Columns,
    measurements: Mapping[str, ArrayLike],
    **options: Unpack[FitOptions],
) -> TrialFits:
    """Fits a model to many records that share their inputs.

    With coloured_errors=False the trials of sepcal's own models are fitted side by side, one in
    each lane of the processor's registers: from a start, with samples=0 from the middle of the
    bounds, or with descents=1 from the best of the samples. All else is fitted one by one, with the
    same result.

    Args:
        model: As fit() takes it.
        design: The inputs by name, each of shape (N,), and "time" [s] and "maneuver" as fit() takes
            them; outputs in it are ignored.
        measurements: The outputs by name, each of shape (K, N): a row is a trial's.
        **options: FitOptions.

    Returns:
        TrialFits. What is wrong with one trial alone is in its failures.

    Raises:
        Error: Bad input or misuse: one line that names the culprit and the way out.

    Example:
        >>> class Line:
        ...     inputs, outputs = {"v": "m/s"}, {"z": "m/s"}
        ...     linear, nonlinear = {"k": "1"}, {}
        ...     def at(self, u, xi2):
        ...         return u.v[:, None, None], np.zeros((len(u.v), 1))
        ...
        >>> v = np.linspace(10.0, 20.0, 50)
        >>> fits = sepcal.fit_trials(Line(), {"v": v}, {"z": [2.0 * v, 3.0 * v]})
        >>> fits.estimates.round(6).ravel().tolist()
        [2.0, 3.0]
    """
    model = as_model(model)
    if model.runs_in_python:
        options["threads"] = options.get("threads") or 1
    refuse_log_choice(options)
    design = by_name(design)
    needed = [*model._columns_in(design), *({"time"} & set(design))]
    columns = take_columns(model._owner, design, dict.fromkeys(needed))
    labels = labels_in(design)
    laid = model._core.along(columns, labels)
    measured = [(name, _to_trials(name, values)) for name, values in measurements.items()]
    names, estimates, errors, squares, statuses, in_lanes, estimated, rows, messages, failures = (
        _core.fit_trials(laid, columns, labels, measured, to_core(options))
    )
    return TrialFits(
        tuple(names),
        np.ascontiguousarray(estimates),
        np.ascontiguousarray(errors),
        squares,
        tuple(statuses),
        np.array(in_lanes, dtype=np.bool_),
        estimated,
        rows,
        messages,
        failures,
    )


def _to_trials(name: str, values: ArrayLike) -> Array:
    array = to_numbers(f"the measurements of '{name}'", values)
    if array.ndim != 2:
        raise _core.Error(
            f"the measurements of '{name}' have the shape {array.shape}; give a row a trial, (K, N)"
        )
    return np.require(array, requirements=["C_CONTIGUOUS", "ALIGNED"])
