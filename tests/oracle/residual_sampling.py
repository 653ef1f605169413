# SPDX-License-Identifier: BSD-3-Clause
"""Stage one at a given xi2 (Eqs. 16 and 19): xi1 by linear least squares with R = I, then Tr[R]."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from oracle.model import Array, Model, Record


@dataclass(frozen=True)
class LinearEstimate:
    """What linear least squares gives at one xi2."""

    xi1: Array  # shape (n_1,)
    trace_r: float  # sum over the outputs of their mean square residual
    gradient: Array  # d trace_r / d xi2, shape (n_2,)
    curvature: Array  # its second derivative as Gauss-Newton has it, shape (n_2, n_2)


def estimate_linear(model: Model, record: Record, xi2: ArrayLike) -> LinearEstimate:
    """Solves for xi1 at xi2 of shape (n_2,) by numpy.linalg.lstsq.

    As xi1 is optimal, trace_r varies with xi2 through the explicit dependence alone: with
    D = d(A xi1 + b)/d xi2 its gradient is -2 D' r / N. The curvature comes from the part P of D
    that A cannot mimic: 2 P' P / N (variable projection with Kaufman's Jacobian).
    """
    n_1 = len(model.linear)
    a, b = model.affine(record, xi2)
    rows = b.shape[1]
    design = a.reshape(-1, n_1)
    target = (model.measured(record) - b).ravel()

    xi1 = np.linalg.lstsq(design, target, rcond=None)[0]
    residual = target - design @ xi1
    xi = np.concatenate([xi1, np.asarray(xi2, dtype=float)])
    tangent = model.jacobian(record, xi)[..., n_1:].reshape(-1, len(model.nonlinear))
    projected = tangent - design @ np.linalg.lstsq(design, tangent, rcond=None)[0]
    return LinearEstimate(
        xi1=xi1,
        trace_r=float(residual @ residual) / rows,
        gradient=-2 * tangent.T @ residual / rows,
        curvature=2 * projected.T @ projected / rows,
    )
