# SPDX-License-Identifier: BSD-3-Clause
"""What a fit says: estimates with their uncertainty, the noise, and what stage one saw.

Undefined numbers (the standard error of a fixed parameter, say) are NaN.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sepcal import _core
from sepcal.columns import Array
from sepcal.pages import Page, Row


@dataclass(frozen=True)
class Parameter:
    """One estimate, in `unit`."""

    name: str
    value: float
    standard_error: float  # NaN where undefined: fixed, at a bound, singular
    standard_error_white: float  # what it would be if the residuals were white
    unit: str
    lower: float
    upper: float
    at_bound: bool
    fixed: bool

    @property
    def remark(self) -> str:
        """Fixed, at its lower or at its upper bound; else nothing."""
        if self.fixed:
            return "fixed"
        if not self.at_bound:
            return ""
        side = "lower" if self.value - self.lower <= self.upper - self.value else "upper"
        return f"at its {side} bound"


@dataclass(frozen=True)
class Combination:
    """A linear combination of parameters that the record leaves open or determines poorly."""

    text: str  # "0.8 w_n - 0.6 lambda_va", coefficients of unit length
    parameters: tuple[str, ...]  # those that take part, largest share first
    standard_error: float  # of the combination; infinite where it is singular


@dataclass(frozen=True)
class LocalMinimum:
    """A local minimum of Tr[R] within the bounds."""

    xi2: dict[str, float]
    trace_r: float  # sum over outputs of the mean squared residual, in the outputs' units


@dataclass(frozen=True, eq=False)
class ScreenResults:
    """Eqs. 17 and 18 at every sample, each (S,); norms are Frobenius', over the whole record."""

    ratio_a: Array  # |dA/dxi2| l_2 / |A|
    ratio_b: Array  # |db/dxi2| l_2 / |b|; zero where b does not depend on xi2
    curvature_a: Array  # smallest eigenvalue of the sum of A's second derivatives
    curvature_b: Array  # the same of b
    accepted: NDArray[np.bool_]  # False: the sample was not used


@dataclass(frozen=True, eq=False)
class StageOne:
    """Samples of xi2 and Tr[R] at each (Eqs. 16, 19, Steps 2-4); of a global search, all it tried.

    Fixed parameters have no part in it. The samples are not kept in a calibration's JSON.
    """

    samples: Array  # (S, n_2), in the model's order
    trace_r: Array  # (S,); infinite where the model is not finite
    best: dict[str, float]  # the sample with the least Tr[R]
    best_trace_r: float
    minima: list[LocalMinimum]  # distinct ones, lowest first
    unique_minimum: bool  # one minimum and no flat direction
    flat_directions: list[str]  # in words: a valley of Tr[R] and no point (Fig. 6)
    screens: ScreenResults | None  # where fit() was asked for them


@dataclass(frozen=True)
class EffectSetting:
    """An effect of a fit, with what it took from the record; None or empty where it takes none."""

    name: str  # whole, aliases resolved: "wind[altitude_m]"
    centre: float | None  # of a power's driver, in the driver's unit
    knots: tuple[float, ...]  # of a spline
    labels: tuple[str, ...]  # of the driver `maneuver`; the first has no coefficient
    span: tuple[float, float] | None  # the record's first and last time [s]
    t0: float | None  # [s] of a step


@dataclass(frozen=True, eq=False, repr=False)
class Fit(Page):
    """The two-stage batch estimate. `print(fit)` shows the table; `fit["w_n"]` is one parameter."""

    _shown = ("name", "value", "standard_error", "unit")

    status: str  # "converged", "not_converged" or "not_identifiable"
    message: str  # one line; empty where there is nothing to say
    parameters: dict[str, Parameter]  # linear, then nonlinear, in the model's order
    covariance: Array  # (n, n), in that order; NaN where there is no standard error
    correlation: Array  # (n, n)
    covariance_white: Array  # (n, n), of white residuals; of a loaded one only its diagonal
    noise: dict[str, float]  # by output: standard deviation, given or from R-hat = SSE / N
    rmse: dict[str, float]  # by output, unwhitened, in its unit
    cost: float  # J of Eq. 6
    rows: int  # that stage two used
    unobservable: list[Combination]  # singular, or uncertain beyond half the width of their bounds
    weak: list[Combination]  # singular value below a fiftieth of the largest
    stage_one: StageOne
    method: str  # "joint" or "projected": what stage two used in the end
    iterations: int  # of stage two's minimisations
    noise_iterations: int  # of R against the parameters
    effects: list[EffectSetting]  # that joined the model, in order
    text: str  # what print() shows: the app's page
    explained: str  # the same with the whole message, as by the apps' --explain

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

    def __getitem__(self, name: str) -> Parameter:
        """The parameter of that name. Raises KeyError listing the names."""
        if name not in self.parameters:
            raise KeyError(f"there is no parameter '{name}'; the fit has: {', '.join(self.names)}")
        return self.parameters[name]

    @property
    def at_bound(self) -> list[str]:
        """Names of the parameters that a bound stopped."""
        return [name for name, parameter in self.parameters.items() if parameter.at_bound]

    def _summary(self) -> str:
        return f"{self.status}, {len(self.parameters)} parameters, {self.rows} rows"

    def _rows(self) -> list[Row]:
        return [asdict(parameter) for parameter in self.parameters.values()]


def to_fields(described: _core.FitDescription) -> dict[str, Any]:
    """The fields of a Fit from what C++ says of it."""
    stage_one: Mapping[str, Any] = described["stage_one"]
    fields: Mapping[str, Any] = {
        "parameters": {entry["name"]: Parameter(**entry) for entry in described["parameters"]},
        "unobservable": [Combination(**entry) for entry in described["unobservable"]],
        "weak": [Combination(**entry) for entry in described["weak"]],
        "effects": [EffectSetting(**entry) for entry in described["effects"]],
        "stage_one": StageOne(
            **{
                **stage_one,
                "minima": [LocalMinimum(**at) for at in stage_one["minima"]],
                "screens": stage_one["screens"] and ScreenResults(**stage_one["screens"]),
            }
        ),
    }
    return {**described, **fields}
