# SPDX-License-Identifier: BSD-3-Clause
"""Proves that no other minimum is lower than a fit's cost, or how much lower it can be.

By interval arithmetic through the model itself: no rounding, no sample and no solver is trusted.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Unpack

from sepcal import _core
from sepcal.arguments import checked
from sepcal.columns import Columns, labels_in, take_columns
from sepcal.fit_options import FitOptions
from sepcal.intervals import as_fitted
from sepcal.options import spelled_out
from sepcal.own_state_model import AnyModel, as_model
from sepcal.results import Fit


class Certificate(_core.Certificate):
    """A proof about a fit's cost in the box of its bounds; `print(certificate)` says it.

    Example:
        >>> eta = np.linspace(-3.0, 3.0, 40)
        >>> z = 1.3 * np.cos(eta + 0.2) + 1.0
        >>> data = {"eta": eta, "z": z + 0.01 * np.sin(50.0 * eta)}
        >>> fit = sepcal.fit(sepcal.ScalarExample1(), data)
        >>> certificate = sepcal.certify(sepcal.ScalarExample1(), data, fit)
        >>> certificate.status, certificate.is_global
        ('global', True)
    """

    def __str__(self) -> str:
        return self.message

    @property
    def is_global(self) -> bool:
        """Whether the fit has the least cost within its bounds, to the tolerance."""
        return self.status == "global"


class CostBound(_core.CostBound):
    """How far the least cost in a box may be below that at one xi2 (Eqs. 7 to 13).

    Example:
        >>> eta = np.linspace(-3.0, 3.0, 40)
        >>> z = 1.3 * np.cos(eta + 0.2) + 1.0
        >>> bound = sepcal.bound_cost(sepcal.ScalarExample1(), {"eta": eta, "z": z}, {"b": 0.2})
        >>> bound.paper_lower <= bound.lower  # the paper's bound is the looser one
        True
    """


@spelled_out()
@checked
def certify(
    model: AnyModel,
    data: Columns,
    fit: Fit,
    *,
    tolerance: float = 1e-6,
    boxes: int = 20000,
    **options: Unpack[FitOptions],
) -> Certificate:
    """Prove that a fit has the least cost within its bounds, or find a lower one.

    Branch and bound over the nonlinear parameters that are free, with R and the fixed ones as the
    fit has them. It serves for one or two of them; three take many boxes, and
    more are refused.

    Args:
        model: That was fitted, one of sepcal's own: a scalar example, a PitotStatic, or a probe or
            magnetometer most of whose nonlinear parameters are held.
        data: The inputs and outputs that were fitted.
        fit: The fit, by squares and without priors.
        tolerance: How much lower another cost may be, as a share of the fit's.
        boxes: At most so many; time and memory grow with them.
        **options: Those of the fit.

    Raises:
        Error: The fit is not that of the model; a model that can't be enclosed, as one of your own
            in Python; a nonlinear parameter without bounds.

    Example:
        >>> eta = np.linspace(-3.0, 3.0, 40)
        >>> z = 1.3 * np.cos(eta + 0.2) + 1.0
        >>> data = {"eta": eta, "z": z + 0.01 * np.sin(50.0 * eta)}
        >>> fit = sepcal.fit(sepcal.ScalarExample1(), data)
        >>> sepcal.certify(sepcal.ScalarExample1(), data, fit).is_global
        True
    """
    laid, columns, labels, core, own = as_fitted(model, data, fit, options, measured=True)
    return Certificate(_core.certify(laid, columns, labels, core, own, fit, tolerance, boxes))


@checked
def bound_cost(
    model: AnyModel,
    data: Columns,
    xi2p: Mapping[str, float],
    *,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    noise: Mapping[str, float] | None = None,
) -> CostBound:
    """Bound how far the least cost in a box may be below that at one point of xi2.

    Args:
        model: A scalar example, a PitotStatic, a FiveHoleProbe, a Magnetometer.
        data: Its inputs and outputs, each of shape (N,).
        xi2p: The nonlinear parameters there, by name.
        bounds: Boxes of parameters (lower, upper) [the model's]. Of linear parameters without any
            the range is proven, where it can be.
        noise: Standard deviation of outputs [1].

    Raises:
        Error: A model that can't be enclosed, xi2p outside of the box, a nonlinear parameter
            without bounds.

    Example:
        >>> eta = np.linspace(-3.0, 3.0, 40)
        >>> z = 1.3 * np.cos(eta + 0.2) + 1.0
        >>> bound = sepcal.bound_cost(sepcal.ScalarExample1(), {"eta": eta, "z": z}, {"b": 0.2})
        >>> bound.lower <= bound.cost < 1e-20  # z is exact
        True
    """
    model = as_model(model)
    columns = take_columns(
        model._owner, data, dict.fromkeys([*model._columns_in(data), *model._measured_in(data)])
    )
    labels = labels_in(data)
    laid = model._core.along(columns, labels)
    return CostBound(
        _core.bound_cost(laid, columns, labels, dict(xi2p), dict(bounds or {}), dict(noise or {}))
    )
