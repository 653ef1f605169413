# SPDX-License-Identifier: BSD-3-Clause
"""Many small fits: trials of scalar example 1, z = (1 + a) cos(eta + b) + c."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares, leastsq

from benchmarks.race import QUICK, Competitor, Result, judge, peer, program, race, timed

ROWS, NOISE = 100, 0.1
TRUTH = (0.3, 1.0, 0.2)  # a, c, b


def draw(trials: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Eta (N,) and z (trials, N)."""
    eta = np.linspace(0.0, 10.0, ROWS)
    a, c, b = TRUTH
    noise = NOISE * np.random.default_rng(seed).standard_normal((trials, ROWS))
    return eta, (1.0 + a) * np.cos(eta + b) + c + noise


Residuals = Callable[[np.ndarray], np.ndarray]
Solve = Callable[[Residuals, Residuals], np.ndarray]


def fit_each(eta: np.ndarray, z: np.ndarray, solve: Solve) -> np.ndarray:
    """`solve` on residuals and Jacobian of every trial, derivatives by hand: a, c, b each."""
    answers = []
    for reading in z:

        def residuals(x: np.ndarray, reading: np.ndarray = reading) -> np.ndarray:
            off: np.ndarray = reading - ((1.0 + x[0]) * np.cos(eta + x[2]) + x[1])
            return off

        def jacobian(x: np.ndarray) -> np.ndarray:
            J = np.empty((ROWS, 3))
            J[:, 0] = -np.cos(eta + x[2])
            J[:, 1] = -1.0
            J[:, 2] = (1.0 + x[0]) * np.sin(eta + x[2])
            return J

        answers.append(solve(residuals, jacobian))
    return np.concatenate(answers)


def by_least_squares(residuals: Residuals, jacobian: Residuals) -> np.ndarray:
    """MINPACK behind SciPy's common front."""
    found = least_squares(residuals, np.zeros(3), jac=jacobian, method="lm", ftol=1e-10)
    return np.asarray(found.x)


def by_leastsq(residuals: Residuals, jacobian: Residuals) -> np.ndarray:
    """MINPACK with less around it."""
    return np.asarray(leastsq(residuals, np.zeros(3), Dfun=jacobian, ftol=1e-10)[0])


def run(folder: Path, rounds: int, longest: int) -> Iterator[Result]:
    """One table: the first is the default fit."""
    trials = 10 if longest <= QUICK else 200
    eta, z = draw(trials, 1)
    file = folder / "trials.bin"
    np.concatenate([[trials, ROWS], eta, z.ravel()]).tofile(file)
    racing = [
        Competitor("sepcal, default", program("scalar", "default", file, 1)),
        Competitor("sepcal, no samples", program("scalar", "no-samples", file, 1)),
        Competitor(
            "sepcal, no samples, white noise", program("scalar", "no-samples-white", file, 3)
        ),
        Competitor("sepcal, trials side by side", program("scalar", "together", file, 9)),
        Competitor("SciPy least_squares lm", timed(lambda: fit_each(eta, z, by_least_squares))),
        Competitor("SciPy leastsq", timed(lambda: fit_each(eta, z, by_leastsq))),
    ]
    racing += [
        Competitor(f"Ceres, {name}, {flags}", peer(flags, "scalar", method, file, 3))
        for name, method in {"one block": "ceres", "TinySolver": "tiny-solver"}.items()
        for flags in ("plain", "native")
    ]
    race(racing, rounds)
    errors = NOISE / np.sqrt(ROWS)  # about
    result = judge(
        "small-fits",
        f"{trials} fits of scalar example 1, {ROWS} rows each",
        racing,
        lambda off: float(np.abs(off).max()) / errors,
        "standard errors",
    )
    for line in result.lines:
        result.facts[f"fits a second.{line.name}"] = trials / line.median
    told = ", ".join(f"{trials / one.median:,.0f} ({one.name})" for one in result.lines)
    result.notes.append(f"Fits a second: {told}.")
    yield result
