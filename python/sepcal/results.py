# SPDX-License-Identifier: BSD-3-Clause
"""What a fit says: estimates with their uncertainty, the noise, and what stage one saw.

Undefined numbers (the standard error of a fixed parameter, say) are NaN.
"""

from __future__ import annotations

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.pages import Page, Row


class Fit(Page, _core.Fit):
    """The two-stage batch estimate. `print(fit)` shows the table; `fit["w_n"]` is one parameter."""

    _shown = ("name", "value", "standard_error", "unit")

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

    def _summary(self) -> str:
        return f"{self.status}, {len(self.parameters)} parameters, {self.rows} rows"

    def _rows(self) -> list[Row]:
        return [parameter._asdict() for parameter in self.parameters.values()]
