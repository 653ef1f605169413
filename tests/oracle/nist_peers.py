# SPDX-License-Identifier: BSD-3-Clause
"""Other programs on NIST's sets: all parameters at once, from NIST's whole start.

SciPy has exact derivatives, lmfit its differences, Ceres automatic ones. Each may evaluate 20,000
times and stops at tolerances of 1e-15, Ceres at 1e-16.
"""

import subprocess
from dataclasses import dataclass

import lmfit
import numpy as np
from scipy.linalg import qr, solve_triangular
from scipy.optimize import least_squares

from apps import APPS
from oracle.model import Array
from oracle.nist import Digits, NistSet, count_digits

PEERS = ("SciPy lm", "SciPy trf", "lmfit", "Ceres")
EVALUATIONS = 20_000
TIGHT = {"ftol": 1e-15, "xtol": 1e-15, "gtol": 1e-15}
CERES = APPS.parent / "tests" / "nist_ceres"


@dataclass(frozen=True)
class Answer:
    """What a program came to."""

    converged: bool  # as the program says
    digits: Digits


def ask(peer: str, given: NistSet, start: int) -> Answer:
    """One of PEERS on a set. What it refuses to go on with is no answer: no digits."""
    try:
        with np.errstate(all="ignore"):
            if peer == "lmfit":
                return _ask_lmfit(given, given.starts[start])
            if peer == "Ceres":
                return _ask_ceres(given, given.starts[start])
            return _ask_scipy(given, given.starts[start], peer.removeprefix("SciPy "))
    except (ValueError, np.linalg.LinAlgError):
        return Answer(converged=False, digits=Digits(0.0, 0.0, 0.0))


def deviate(given: NistSet, xi: Array) -> Array:
    """Standard deviations at xi by the QR of the exact Jacobian, shape (n,)."""
    residual = given.y - given.model.predict(given.inputs, xi)
    _, r = qr(given.model.jacobian(given.inputs, xi), mode="economic")
    inverse = solve_triangular(r, np.eye(xi.size))
    variance = np.sum(residual**2) / (residual.size - xi.size)
    return np.sqrt(variance * np.sum(inverse**2, axis=1))


def _ask_scipy(given: NistSet, start: Array, method: str) -> Answer:
    found = least_squares(
        lambda xi: given.model.predict(given.inputs, xi) - given.y,
        start,
        jac=lambda xi: given.model.jacobian(given.inputs, xi),
        method=method,
        x_scale="jac",
        max_nfev=EVALUATIONS,
        **TIGHT,
    )
    return Answer(
        converged=bool(found.success),
        digits=count_digits(given, found.x, deviate(given, found.x)),
    )


def _ask_lmfit(given: NistSet, start: Array) -> Answer:
    parameters = lmfit.Parameters()
    for name, value in zip(given.parameters, start, strict=True):
        parameters.add(name, value=value)

    def residual(at: lmfit.Parameters) -> Array:
        xi = np.array([parameter.value for parameter in at.values()])
        return given.model.predict(given.inputs, xi) - given.y

    found = lmfit.minimize(residual, parameters, max_nfev=EVALUATIONS, **TIGHT)
    xi = np.array([parameter.value for parameter in found.params.values()])
    errors = [parameter.stderr or np.nan for parameter in found.params.values()]
    return Answer(converged=bool(found.success), digits=count_digits(given, xi, np.array(errors)))


def _ask_ceres(given: NistSet, start: Array) -> Answer:
    order = np.argsort([int(name[1:]) for name in given.parameters])  # NIST's
    rows = np.column_stack([*given.inputs, given.y])
    numbers = [*start[order].tolist(), *rows.ravel().tolist()]
    done = subprocess.run(
        [CERES, given.name],
        input=" ".join(map(repr, numbers)),
        capture_output=True,
        text=True,
        check=True,
    )
    verdict, *values = done.stdout.split()
    xi = np.empty(start.size)
    xi[order] = [float(value) for value in values]
    return Answer(
        converged=verdict == "converged", digits=count_digits(given, xi, deviate(given, xi))
    )
