# SPDX-License-Identifier: BSD-3-Clause
"""What a fit says: estimates with their uncertainty, the noise, and what stage one saw.

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

    def plot(
        self,
        what: Literal["correlation"] | str = "correlation",
        *,
        backend: Backend = "plotly",
        theme: Theme = "light",
    ) -> Any:  # noqa: ANN401
        """Draws how the estimates go together.

        Args:
            what: "correlation", of the parameters that are not fixed.
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

        choose(what, ("correlation",))
        return as_figure(picture_fit(self), backend, theme)

    def _summary(self) -> str:
        return f"{self.status}, {len(self.parameters)} parameters, {self.rows} rows"

    def _rows(self) -> list[Row]:
        return [parameter._asdict() for parameter in self.parameters.values()]
