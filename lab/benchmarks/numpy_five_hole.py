# SPDX-License-Identifier: BSD-3-Clause
"""The five-hole probe in NumPy, hoisted: what depends on a row's inputs alone is computed once."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.optimize import least_squares

Array = np.ndarray
LINEAR = 5


class HoistedProbe:
    """Residuals and Jacobian of a flight, (3 N,) and (3 N, 10), output by output; x (10,)."""

    def __init__(
        self, columns: Mapping[str, Array], k_alpha: float, k_beta: float, arm: tuple[float, ...]
    ) -> None:
        roll, pitch, yaw = (columns[name] for name in ("roll", "pitch", "yaw"))
        cr, sr, cp, sp = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch)
        cy, sy = np.cos(yaw), np.sin(yaw)
        self.C = np.array(
            [
                [cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy],
                [cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy],
                [-sp, sr * cp, cr * cp],
            ]
        )  # (3, 3, N), body to NED
        p, q, r = (columns[name] for name in "pqr")
        x, y, z = arm
        turning = np.array([q * z - r * y, r * x - p * z, p * y - q * x])
        self.rotation = np.einsum("ijn,jn->in", self.C, turning)
        pressure = columns["pt"] - columns["ps"]
        self.v = np.sqrt(2.0 * pressure / columns["rho"])
        self.alpha = columns["dpa"] / (k_alpha * pressure)
        self.beta = columns["dpb"] / (k_beta * pressure)
        self.z = np.array([columns[name] for name in ("vn", "ve", "vd")])
        self.rows = len(self.v)
        self.weights = np.ones((3, 1))
        self.J = np.zeros((3, self.rows, 10))
        self.at: Array | None = None

    def set_noise(self, noise: Array) -> None:
        """Residuals are over these standard deviations (3,) from now on."""
        self.weights = 1.0 / np.asarray(noise)[:, None]
        for j in range(3):
            self.J[j, :, 2 + j] = -self.weights[j]

    def turn(self, xi2: Array) -> None:
        """The air's direction and its sines at xi2 (5,), kept for the Jacobian."""
        if self.at is not None and np.array_equal(xi2, self.at):
            return
        alpha = (1.0 + xi2[0]) * self.alpha + xi2[1]
        beta = (1.0 + xi2[2]) * self.beta + xi2[3]
        self.ca, self.sa, self.cb, self.sb = (
            np.cos(alpha),
            np.sin(alpha),
            np.cos(beta),
            np.sin(beta),
        )
        self.ce, self.se = np.cos(xi2[4]), np.sin(xi2[4])
        self.up = self.sa * self.cb
        self.d1 = self.ce * self.sb + self.se * self.up
        self.d2 = self.ce * self.up - self.se * self.sb
        self.F = (
            self.C[:, 0] * (self.ca * self.cb) + self.C[:, 1] * self.d1 + self.C[:, 2] * self.d2
        )
        self.at = np.array(xi2)

    def residuals(self, x: Array) -> Array:
        """Measured less modelled, whitened."""
        self.turn(x[LINEAR:])
        V = (1.0 + x[0]) * self.v + x[1]
        off = self.z - self.F * V + self.rotation - x[2:5, None]
        whitened: Array = (off * self.weights).ravel()
        return whitened

    def jacobian(self, x: Array) -> Array:
        """Of residuals()."""
        self.turn(x[LINEAR:])
        w = self.weights
        V = (1.0 + x[0]) * self.v + x[1]
        F = -w * self.F
        by_alpha = self.C[:, 0] * (-self.up) + (self.C[:, 1] * self.se + self.C[:, 2] * self.ce) * (
            self.ca * self.cb
        )
        by_beta = (
            self.C[:, 0] * (-self.ca * self.sb)
            + self.C[:, 1] * (self.ce * self.cb - self.se * self.sa * self.sb)
            - self.C[:, 2] * (self.ce * self.sa * self.sb + self.se * self.cb)
        )
        by_eps = self.C[:, 1] * self.d2 - self.C[:, 2] * self.d1
        wV = -w * V
        J = self.J
        J[:, :, 0] = F * self.v
        J[:, :, 1] = F
        J[:, :, 6] = wV * by_alpha
        J[:, :, 5] = J[:, :, 6] * self.alpha
        J[:, :, 8] = wV * by_beta
        J[:, :, 7] = J[:, :, 8] * self.beta
        J[:, :, 9] = wV * by_eps
        whole: Array = J.reshape(-1, 10).copy()
        return whole

    def linear_fit(self, xi2: Array) -> tuple[Array, float]:
        """NumPy's least squares at xi2: xi1 (5,) and the sum of squares, R = I."""
        self.turn(xi2)
        A = np.zeros((3, self.rows, LINEAR))
        A[:, :, 0] = self.F * self.v
        A[:, :, 1] = self.F
        for j in range(3):
            A[j, :, 2 + j] = 1.0
        b = self.z - A[:, :, 0] + self.rotation
        xi1, squares, _, _ = np.linalg.lstsq(A.reshape(-1, LINEAR), b.ravel(), rcond=None)
        return xi1, float(squares[0])

    def noise_at(self, x: Array) -> Array:
        """Root mean square residuals (3,)."""
        off = self.residuals(x).reshape(3, -1) / self.weights
        noise: Array = np.sqrt(np.mean(off**2, axis=1))
        return noise


def solve(probe: HoistedProbe, x: Array, method: str) -> Array:
    """SciPy's least_squares with the analytic Jacobian."""
    found = least_squares(
        probe.residuals, x, jac=probe.jacobian, method=method, x_scale="jac", ftol=1e-10
    )
    return np.asarray(found.x)


def alternate(probe: HoistedProbe, x: Array, noise: Array, method: str) -> Array:
    """R and the parameters in turn until no variance changes by more than a thousandth."""
    for _ in range(20):
        probe.set_noise(noise)
        x = solve(probe, x, method)
        found = probe.noise_at(x)
        settled = np.max(np.abs((found / noise) ** 2 - 1.0)) < 1e-3
        noise = found
        if settled:
            break
    return x


def sample(probe: HoistedProbe, points: Array) -> Array:
    """The best of the samples of xi2 (S, 5) with its xi1: (10,)."""
    best: Array = points[0]
    least = np.inf
    for xi2 in points:
        xi1, square = probe.linear_fit(xi2)
        if square < least:
            least, best = square, np.concatenate([xi1, xi2])
    return best
