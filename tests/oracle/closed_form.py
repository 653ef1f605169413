# SPDX-License-Identifier: BSD-3-Clause
"""Estimates without iteration, for the two models that are linear problems in disguise."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import qr, solve_triangular

from oracle.model import Array, Record


def fit_scalar_example_1(record: Record) -> Array:
    """(a, c, b), shape (3,): the branch with 1 + a > 0.

    (1 + a) cos(eta + b) + c = p cos(eta) + q sin(eta) + c, p = (1 + a) cos b, q = -(1 + a) sin b.
    """
    eta = record["eta"]
    design = np.stack([np.cos(eta), np.sin(eta), np.ones_like(eta)], axis=-1)
    p, q, c = _solve(design, record["z"])[0]
    return np.array([np.hypot(p, q) - 1, c, np.arctan2(-q, p)])


@dataclass(frozen=True)
class FieldMap:
    """m = C h + n, each output a linear regression of its own, whatever the diagonal R."""

    matrix: Array  # C, shape (3, 3)
    bias: Array  # n [uT], shape (3,)
    unit_covariance: Array  # of a row of C and its bias at unit noise, shape (4, 4)


def fit_field_map(record: Record) -> FieldMap:
    """C and n of a magnetometer in a known field, by linear least squares."""
    field = [record[name] for name in ("hx", "hy", "hz")]
    design = np.stack([*field, np.ones_like(field[0])], axis=-1)
    readings = np.stack([record[name] for name in ("mx", "my", "mz")], axis=-1)
    solution, unit_covariance = _solve(design, readings)
    return FieldMap(solution[:3].T, solution[3], unit_covariance)


def _solve(design: Array, target: Array) -> tuple[Array, Array]:
    """Least squares by QR, and the inverse of design' design."""
    q, r = qr(design, mode="economic")
    inverse = solve_triangular(r, np.eye(r.shape[0]))
    return inverse @ (q.T @ target), inverse @ inverse.T
