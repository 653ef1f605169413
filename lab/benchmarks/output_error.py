# SPDX-License-Identifier: BSD-3-Clause
"""Output error of a short period, 20 s at 50 Hz: sepcal, Ceres and SciPy."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.linalg import expm
from scipy.optimize import least_squares

from benchmarks.race import Competitor, Result, judge, peer, program, race, timed

ROWS, INTERVAL, AIRSPEED = 1000, 0.02, 25.0
NOISE = np.array([0.005, 0.01, 0.15])  # alpha [rad], q [rad/s], az [m/s^2]
# Za Ma Mq Zd Md b_alpha b_q b_az alpha_0 q_0
TRUTH = np.array([-4.0, -40.0, -5.0, -0.35, -45.0, 0.02, -0.01, 0.5, 0.01, -0.05])
START = np.array([-3.0, -30.0, -4.0, -0.3, -35.0, 0.0, 0.0, 0.0, 0.0, 0.0])


def elevator(t: np.ndarray) -> np.ndarray:
    """3-2-1-1 both ways, then a sweep [rad]."""
    u = np.where(t < 10, 0.0, 0.04 * np.sin(2 * np.pi * (0.1 * (t - 10) + 0.145 * (t - 10) ** 2)))
    signs = np.array([1, 1, 1, -1, -1, 1, -1])
    for begin, size in ((1.0, 0.06), (6.0, -0.06)):
        at = np.floor((t - begin) / 0.3).astype(int)
        inside = (at >= 0) & (at < 7)
        u[inside] = size * signs[at[inside]]
    return u


def fly(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, elevator and readings (3 x rows), exact for an elevator of straight lines."""
    za, ma, mq, zd, md = TRUTH[:5]
    block = np.zeros((4, 4))
    block[0] = [za, 1, zd, 0]
    block[1] = [ma, mq, md, 0]
    block *= INTERVAL
    block[2, 3] = 1.0
    step = expm(block)
    t = INTERVAL * np.arange(ROWS)
    u = elevator(t)
    x = np.empty((ROWS, 2))
    x[0] = TRUTH[8:]
    for k in range(ROWS - 1):
        x[k + 1] = (step @ np.array([*x[k], u[k], u[k + 1] - u[k]]))[:2]
    z = np.array([x[:, 0], x[:, 1], AIRSPEED * (za * x[:, 0] + zd * u)]) + TRUTH[5:8, None]
    return t, u, z + NOISE[:, None] * np.random.default_rng(seed).standard_normal(z.shape)


class OutputError:
    """Residuals and Jacobian for scipy.optimize.least_squares.

    One Runge-Kutta integration of the state with its seven sensitivities, all columns at once.
    """

    def __init__(self, t: np.ndarray, u: np.ndarray, z: np.ndarray) -> None:
        self.t, self.u, self.z = t, u, z
        self.at: np.ndarray | None = None

    def integrate(self, p: np.ndarray) -> None:
        """Columns x, dx/d(Za, Ma, Mq, Zd, Md, alpha_0, q_0), kept for this p."""
        if self.at is not None and np.array_equal(p, self.at):
            return
        F: np.ndarray = np.array([[p[0], 1.0], [p[1], p[2]]])
        B = np.array([p[3], p[4]])

        def rate(X: np.ndarray, u: float) -> np.ndarray:
            dX: np.ndarray = F @ X
            dX[:, 0] += B * u
            dX[0, 1] += X[0, 0]
            dX[1, 2] += X[0, 0]
            dX[1, 3] += X[1, 0]
            dX[0, 4] += u
            dX[1, 5] += u
            return dX

        X = np.zeros((2, 8))
        X[:, 0] = p[8:]
        X[0, 6] = X[1, 7] = 1.0
        path = np.empty((ROWS, 2, 8))
        path[0] = X
        for k in range(ROWS - 1):
            dt, u0, u1 = self.t[k + 1] - self.t[k], self.u[k], self.u[k + 1]
            middle = 0.5 * (u0 + u1)
            k1 = rate(X, u0)
            k2 = rate(X + 0.5 * dt * k1, middle)
            k3 = rate(X + 0.5 * dt * k2, middle)
            k4 = rate(X + dt * k3, u1)
            X = X + dt / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
            path[k + 1] = X
        self.path, self.at = path, p.copy()

    def residuals(self, p: np.ndarray) -> np.ndarray:
        """Modelled less measured, whitened."""
        self.integrate(p)
        alpha, q = self.path[:, 0, 0], self.path[:, 1, 0]
        y = np.array([alpha, q, AIRSPEED * (p[0] * alpha + p[3] * self.u)]) + p[5:8, None]
        whitened: np.ndarray = ((y - self.z) / NOISE[:, None]).ravel()
        return whitened

    def jacobian(self, p: np.ndarray) -> np.ndarray:
        """Of residuals()."""
        self.integrate(p)
        S_alpha, S_q = self.path[:, 0, 1:], self.path[:, 1, 1:]
        J = np.zeros((3, ROWS, 10))
        columns = [0, 1, 2, 3, 4, 8, 9]
        J[0][:, columns] = S_alpha
        J[1][:, columns] = S_q
        J[2][:, columns] = AIRSPEED * p[0] * S_alpha
        J[2, :, 0] += AIRSPEED * self.path[:, 0, 0]
        J[2, :, 3] += AIRSPEED * self.u
        for j in range(3):
            J[j, :, 5 + j] = 1.0
        whitened: np.ndarray = (J / NOISE[:, None, None]).reshape(3 * ROWS, 10)
        return whitened


def by_scipy(t: np.ndarray, u: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Levenberg-Marquardt with the exact Jacobian."""
    problem = OutputError(t, u, z)
    found = least_squares(
        problem.residuals, START, jac=problem.jacobian, method="lm", x_scale="jac", ftol=1e-10
    )
    return np.asarray(found.x)


def run(folder: Path, rounds: int, longest: int) -> Iterator[Result]:
    """One race, short as it is."""
    t, u, z = fly(1)
    file = folder / "short_period.bin"
    np.concatenate([t, u, z.ravel()]).tofile(file)
    competitors = [
        Competitor("sepcal from the same start", program("output-error", "start", file)),
        Competitor("sepcal from no start", program("output-error", "no-start", file, 2)),
        Competitor("the same, with coloured errors", program("output-error", "coloured", file, 2)),
        *(
            Competitor(
                f"Ceres, automatic derivatives, {flags}",
                peer(flags, "output-error", "ceres", file, 10),
            )
            for flags in ("plain", "native")
        ),
        Competitor("SciPy, Runge-Kutta by rows", timed(lambda: by_scipy(t, u, z))),
    ]
    race(competitors, rounds)
    problem = OutputError(t, u, z)
    J = problem.jacobian(competitors[0].answer)
    sd = np.sqrt(np.diag(np.linalg.inv(J.T @ J)))
    title = "Output error of the short period, 20 s at 50 Hz, ten parameters"
    yield judge(
        "output-error",
        title,
        competitors,
        lambda off: float(np.abs(off / sd).max()),
        "standard errors",
    )
