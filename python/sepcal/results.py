# SPDX-License-Identifier: BSD-3-Clause
"""Results of a fit: estimates with their uncertainty, the noise, and what stage one saw.

Undefined numbers (the standard error of a fixed parameter, say) are NaN.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from sepcal import _core
from sepcal.arguments import checked, found_by
from sepcal.columns import Array
from sepcal.pages import Page, Row
from sepcal.plots import Backend, Theme


@checked
class Fit(Page, _core.Fit):
    """The two-stage batch estimate. `print(fit)` shows the table; `fit["w_n"]` is one parameter.

    Example:
        >>> class Line:
        ...     inputs, outputs = {"v": "m/s"}, {"z": "m/s"}
        ...     linear, nonlinear = {"k": "1"}, {}
        ...     def at(self, u, xi2):
        ...         return u.v[:, None, None], np.zeros((len(u.v), 1))
        ...
        >>> v = np.linspace(10.0, 20.0, 50)
        >>> fit = sepcal.fit(Line(), {"v": v, "z": 2.0 * v})
        >>> fit
        <sepcal.Fit converged, 1 parameters, 50 rows>
        >>> round(fit["k"].value, 6)
        2.0
    """

    _shown = ("name", "value", "standard_error", "unit")

    def __getitem__(self, name: str) -> _core.Parameter:
        """The parameter. Raises Error, a KeyError too, listing the names."""
        return found_by(super().__getitem__, name)

    @property
    def success(self) -> bool:
        """Whether the status is "converged"."""
        return self.status == "converged"

    @property
    def names(self) -> tuple[str, ...]:
        """The n parameters, linear, then nonlinear."""
        return tuple(self.parameters)

    @property
    def values(self) -> Array:
        """The estimates, shape (n,)."""
        return np.array([parameter.value for parameter in self.parameters.values()])

    @property
    def at_bound(self) -> list[str]:
        """Names of the parameters that a bound stopped."""
        return [name for name, parameter in self.parameters.items() if parameter.at_bound]

    @property
    def collinearity(self) -> _core.Collinearity:
        """Which estimates the record hardly tells apart, by their covariance.

        `names` (k) are those that have a standard error; `pairs` those whose correlation is above
        0.9 either way, the strongest first; `condition_indices` (k,), from 1 up, of J with columns
        of unit length, above 30 where columns hardly differ; `variance_proportions` (k, k) the
        share of an estimate's variance, a column each, by the direction of each index, a row each.
        Belsley, Kuh and Welsch, Regression Diagnostics, ch. 3.
        """
        return super().collinearity

    def ellipse(self, first: str, second: str, *, level: float = 0.95, points: int = 73) -> Array:
        """The ellipse that holds the true values of two parameters in `level` of all records.

        By the covariance of the estimates, which allows for coloured residuals.

        Args:
            first: A parameter with a standard error.
            second: Another one.
            level: How often it should hold both at once.
            points: On the ellipse, the last one being the first again.

        Returns:
            Shape (points, 2), in the parameters' units.

        Raises:
            Error: A parameter that isn't there, is named twice or has no standard error; a level
                outside (0, 1); fewer than four points.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> around = base.ellipse("w_n", "w_e")
            >>> centre = around[:-1].mean(axis=0)
            >>> np.allclose(centre, [base["w_n"].value, base["w_e"].value]), around.shape
            (True, (73, 2))
        """
        return _core.confidence_ellipse(self, first, second, level, points)

    def plot(
        self,
        what: Literal["correlation", "ellipses", "stage one"] | str = "correlation",
        *,
        backend: Backend = "plotly",
        theme: Theme = "light",
    ) -> Any:  # noqa: ANN401
        """Draws how the estimates go together.

        Args:
            what: "correlation", of the parameters that are not fixed; "ellipses", in which 95 % of
                records have the true values of the pairs that are correlated most; "stage one",
                Tr[R] at the samples of the nonlinear parameters.
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; the library is not installed.

        Example:
            >>> eta = np.linspace(-3.0, 3.0, 40)
            >>> z = 1.3 * np.cos(eta + 0.2) + 1.0
            >>> data = {"eta": eta, "z": z + 0.01 * np.sin(50.0 * eta)}
            >>> fit = sepcal.fit(sepcal.ScalarExample1(), data)
            >>> drawn = fit.plot(backend="matplotlib")
        """
        from sepcal.plotting import as_figure, choose
        from sepcal.plotting.of_fits import picture_fit

        choose(what, ("correlation", "ellipses", "stage one"))
        return as_figure(picture_fit(self, what), backend, theme)

    def _summary(self) -> str:
        return f"{self.status}, {len(self.parameters)} parameters, {self.rows} rows"

    def _rows(self) -> list[Row]:
        return [parameter._asdict() for parameter in self.parameters.values()]
