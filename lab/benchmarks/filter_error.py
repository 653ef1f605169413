# SPDX-License-Identifier: BSD-3-Clause
"""Filter error of a short period, 20 s at 50 Hz: the score of 15 parameters, and tracks.

The score by sepcal, by differences through its filter, and by statsmodels; then what a sample costs
that is tracked.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import expm

from benchmarks.output_error import AIRSPEED, INTERVAL, ROWS, elevator
from benchmarks.race import Competitor, Result, judge, program, race, show_time, timed

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from filterpy.kalman import ExtendedKalmanFilter
    from statsmodels.tsa.statespace.mlemodel import MLEModel

# b_alpha b_q b_az Zd Md alpha_0 q_0 Za Ma Mq, then ln of the noises of alpha', q', alpha, q, az
NOISES = np.log([0.003, 0.09, 0.005, 0.01, 0.15])
TRUTH = np.array([0.02, -0.01, 0.5, -0.35, -45.0, 0.01, -0.05, -4.0, -40.0, -5.0, *NOISES])
AT = 1.01 * TRUTH  # where the score is taken


class System:
    """The discrete system at theta, complex where theta is: exact for an elevator of lines."""

    def __init__(self, theta: np.ndarray) -> None:
        zd, md, za, ma, mq = theta[[3, 4, 7, 8, 9]]
        zero = np.zeros((2, 2), dtype=theta.dtype)
        self.F = np.array([[za, np.ones_like(za)], [ma, mq]])
        block = np.zeros((4, 4), dtype=theta.dtype)
        block[:2, :2], block[:2, 2] = INTERVAL * self.F, INTERVAL * np.array([zd, md])
        block[2, 3] = 1.0
        step = expm(block)
        self.Phi, self.of_input, self.of_slope = step[:2, :2], step[:2, 2], step[:2, 3]
        density = np.diag(np.exp(2.0 * theta[10:12]))
        van_loan = expm(INTERVAL * np.block([[-self.F, density], [zero, self.F.T]]))
        self.Q = self.Phi @ van_loan[:2, 2:]
        self.C = np.array([[1.0, 0.0], [0.0, 1.0], [AIRSPEED * za, 0.0]])
        self.D = np.array([0.0, 0.0, AIRSPEED * zd])
        self.R = np.diag(np.exp(2.0 * theta[12:]))

    def shifts(self, u: np.ndarray) -> np.ndarray:
        """What the elevator adds to the state from each row to the next, (2, rows); then zero."""
        added = np.zeros((2, len(u)), dtype=self.Phi.dtype)
        added[:, :-1] = np.outer(self.of_input, u[:-1]) + np.outer(self.of_slope, np.diff(u))
        return added


def fly(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, elevator and readings (3 x rows) in turbulence."""
    rng = np.random.default_rng(seed)
    system = System(TRUTH)
    t = INTERVAL * np.arange(ROWS)
    u = elevator(t)
    added = system.shifts(u)
    shaken = np.linalg.cholesky(system.Q) @ rng.standard_normal((2, ROWS))
    x = np.empty((ROWS, 2))
    x[0] = TRUTH[5:7]
    for k in range(ROWS - 1):
        x[k + 1] = system.Phi @ x[k] + added[:, k] + shaken[:, k]
    z = system.C @ x.T + np.outer(system.D, u) + TRUTH[:3, None]
    return t, u, z + np.sqrt(system.R) @ rng.standard_normal(z.shape)


class Model(MLEModel):  # type: ignore[misc]
    """For statsmodels. Made once; what is timed starts at theta."""

    def __init__(self, u: np.ndarray, z: np.ndarray) -> None:
        super().__init__(z.T, k_states=2, k_posdef=2, initialization="known",
                         constant=np.zeros(2), stationary_cov=np.zeros((2, 2)))  # fmt: skip
        self.u = u
        self["selection"] = np.eye(2)

    @property
    def start_params(self) -> np.ndarray:
        """As it asks."""
        return AT

    def update(self, params: Any, **kwargs: Any) -> None:  # noqa: ANN401
        """The matrices at theta; theta may be complex."""
        theta = super().update(params, **kwargs)
        system = System(theta)
        self["transition"], self["state_cov"] = system.Phi, system.Q
        self["design"], self["obs_cov"] = system.C, system.R
        self["state_intercept"] = system.shifts(self.u)
        self["obs_intercept"] = np.outer(system.D, self.u) + theta[:3, None]
        self.ssm.initialize_known(theta[5:7], np.zeros((2, 2), dtype=theta.dtype))


def information_by_statsmodels(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """Score and Fisher's information from its complex steps, put together by NumPy."""
    e_slopes, slopes = model._forecasts_error_partial_derivatives(AT)
    model.update(AT)
    found = model.ssm.filter()
    inverse = np.linalg.inv(np.moveaxis(found.forecasts_error_cov, -1, 0))
    whitened = np.einsum("kab,bk->ka", inverse, found.forecasts_error)
    d = np.moveaxis(e_slopes, 1, 0)  # rows x outputs x parameters
    relative = np.einsum("kab,bcki->kiac", inverse, slopes)
    surprise = np.einsum("ka,bk->kab", whitened, found.forecasts_error) - np.eye(3)
    gradient = np.einsum("kai,ka->i", d, whitened) - 0.5 * np.einsum(
        "kiac,kca->i", relative, surprise
    )
    flat = relative.reshape(ROWS, len(AT), 9)
    turned = np.swapaxes(relative, 2, 3).reshape(ROWS, len(AT), 9)
    information = np.einsum("kai,kab,kbj->ij", d, inverse, d, optimize=True)
    information += 0.5 * np.einsum("kin,kjn->ij", flat, turned, optimize=True)
    return gradient, information


def step_by_statsmodels(model: Model) -> np.ndarray:
    """The gradient of V_m; Fisher's step is solved for too."""
    gradient, information = information_by_statsmodels(model)
    np.linalg.solve(information, -gradient)
    return gradient


def race_score(file: Path, u: np.ndarray, z: np.ndarray, rounds: int) -> Result:
    """The gradient at one theta."""
    model = Model(u, z)
    competitors = [
        Competitor("sepcal, score and information", program("filter-error", "score", file)),
        Competitor(
            "sepcal's filter, central differences, score alone",
            program("filter-error", "differences", file),
        ),
        Competitor(
            "statsmodels, complex steps, score alone",
            timed(lambda: -model.score(AT)),
        ),
        Competitor(
            "statsmodels, complex steps, score and information by NumPy",
            timed(lambda: step_by_statsmodels(model)),
        ),
        Competitor(
            "statsmodels, Harvey's score alone",
            timed(lambda: -np.asarray(model.score(AT, method="harvey")).real),
        ),
    ]
    race(competitors, rounds)
    sd = np.sqrt(np.diag(information_by_statsmodels(model)[1]))
    title = "Filter error of the short period, 20 s at 50 Hz, fifteen parameters: a step of scoring"
    return judge(
        "filter-error",
        title,
        competitors,
        lambda off: float(np.abs(off / sd).max()),
        "the score's standard deviations",
    )


class JointFilter(ExtendedKalmanFilter):  # type: ignore[misc]
    """For FilterPy: alpha q, b_alpha b_q b_az, Za Ma Mq Zd Md, the noises known."""

    def __init__(self) -> None:
        super().__init__(dim_x=10, dim_z=3)
        self.x = AT[[5, 6, 0, 1, 2, 7, 8, 9, 3, 4]]
        self.P = np.diag((0.1 * np.maximum(np.abs(self.x), 1.0)) ** 2)
        self.R = np.diag(np.exp(2.0 * AT[12:]))
        self.density = np.diag(np.exp(2.0 * AT[10:12]))
        self.between = (0.0, 0.0)  # elevator at the last row and at the next

    def rate(self, X: np.ndarray, u: float) -> np.ndarray:
        """Of the state (first column) and of its slopes by everything."""
        za, ma, mq, zd, md = self.x[5:]
        dX: np.ndarray = np.array([[za, 1.0], [ma, mq]]) @ X
        dX[:, 0] += np.array([zd, md]) * u
        dX[0, 6] += X[0, 0]
        dX[1, 7] += X[0, 0]
        dX[1, 8] += X[1, 0]
        dX[0, 9] += u
        dX[1, 10] += u
        return dX

    def predict_x(self, u: Any = 0) -> None:  # noqa: ANN401
        """One step of Runge and Kutta's, with F and Q beside it."""
        u0, u1 = self.between
        middle = 0.5 * (u0 + u1)
        X = np.zeros((2, 11))
        X[:, 0] = self.x[:2]
        X[0, 1] = X[1, 2] = 1.0
        k1 = self.rate(X, u0)
        k2 = self.rate(X + 0.5 * INTERVAL * k1, middle)
        k3 = self.rate(X + 0.5 * INTERVAL * k2, middle)
        k4 = self.rate(X + INTERVAL * k3, u1)
        X += INTERVAL / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
        self.x[:2] = X[:, 0]
        self.F = np.eye(10)
        self.F[:2] = X[:, 1:]
        Phi = X[:, 1:3]
        self.Q = np.zeros((10, 10))
        self.Q[:2, :2] = 0.5 * INTERVAL * (self.density + Phi @ self.density @ Phi.T)


def by_filterpy(u: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Za Ma Mq Zd Md after the last row."""
    joint = JointFilter()
    C = np.zeros((3, 10))
    C[:2, :2], C[:, 2:5] = np.eye(2), np.eye(3)

    def slopes(x: np.ndarray) -> np.ndarray:
        C[2, [0, 5, 8]] = AIRSPEED * x[5], AIRSPEED * x[0], AIRSPEED * elevation
        return C

    def outputs(x: np.ndarray) -> np.ndarray:
        az = AIRSPEED * (x[5] * x[0] + x[8] * elevation)
        return np.array([x[2] + x[0], x[3] + x[1], x[4] + az])

    for k, elevation in enumerate(u):
        if k > 0:
            joint.between = (u[k - 1], elevation)
            joint.predict()
        joint.update(z[:, k], slopes, outputs)
    return np.asarray(joint.x[5:])


def race_tracks(file: Path, u: np.ndarray, z: np.ndarray, rounds: int) -> Result:
    """Along all rows, from theta and a deviation of a tenth."""
    competitors = [
        Competitor(
            "sepcal, recursive maximum likelihood, noises estimated",
            program("filter-error", "rml", file),
        ),
        Competitor("sepcal, joint extended filter", program("filter-error", "joint", file)),
        Competitor("FilterPy, joint extended filter", timed(lambda: by_filterpy(u, z))),
    ]
    race(competitors, rounds)
    information = information_by_statsmodels(Model(u, z))[1]
    sd = np.sqrt(np.diag(np.linalg.inv(information)))[[7, 8, 9, 3, 4]]
    result = judge(
        "filter-error",
        f"Tracks of the short period, {ROWS} samples",
        competitors,
        lambda off: float(np.abs(off / sd).max()),
        "standard errors",
    )
    each = [line.median / ROWS for line in result.lines]
    result.facts |= {
        f"sample.{line.name}": seconds for line, seconds in zip(result.lines, each, strict=True)
    }
    told = ", ".join(
        f"{show_time(seconds)} ({line.name})"
        for line, seconds in zip(result.lines, each, strict=True)
    )
    result.notes.append(f"A sample takes {told}.")
    return result


def run(folder: Path, rounds: int, longest: int) -> Iterator[Result]:
    """Two races, short as they are."""
    t, u, z = fly(1)
    file = folder / "turbulence.bin"
    np.concatenate([AT, t, u, z.ravel()]).tofile(file)
    yield race_score(file, u, z, rounds)
    yield race_tracks(file, u, z, rounds)
