# SPDX-License-Identifier: BSD-3-Clause
"""Output error of a short period, over a band and in time, and over the band once more in NumPy.

The aircraft is linear about level flight, its speed and attitude held; gusts, white noise through
a first-order lag, add to the angle of attack that wing and vane feel. States go from row to row by
matrix exponentials, without an error of integration.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, optimize

import sepcal
from sepcal.columns import Array

STEP, ROWS = 0.04, 1000  # s
BAND = (0.1, 2.0)  # Hz
SPEED, RHO, GRAVITY = 50.0, 1.1, 9.80665
AREA, CHORD, MASS, INERTIA = 16.2, 1.49, 1100.0, 1825.0
LAG = 0.6  # s, of a gust
TRUTH = {
    "CZ_alpha": -4.8, "CZ_q": -5.0, "CZ_elevator": -0.4,
    "Cm_alpha": -0.9, "Cm_q": -14.0, "Cm_elevator": -1.2,
}  # fmt: skip
NOISE = np.array([0.002, 0.002, 0.05])  # of alpha [rad], q [rad/s], az [m/s^2]
LIFT = 0.5 * RHO * SPEED**2 * AREA / (MASS * SPEED)  # 1/s of CZ
PITCH = 0.5 * RHO * SPEED**2 * AREA * CHORD / INERTIA  # 1/s^2 of Cm


@dataclass(frozen=True)
class Estimates:
    """In TRUTH's order."""

    values: Array
    errors: Array

    def scaled(self) -> Array:
        """(estimate - truth) / standard error."""
        return np.asarray((self.values - list(TRUTH.values())) / self.errors)


def dynamics(derivatives: Array) -> tuple[Array, Array, Array, Array]:
    """F, G of alpha and q; H, D of alpha, q and az."""
    CZ_alpha, CZ_q, CZ_elevator, Cm_alpha, Cm_q, Cm_elevator = derivatives
    q_hat = CHORD / (2 * SPEED)
    F = np.array(
        [[LIFT * CZ_alpha, 1 + LIFT * CZ_q * q_hat], [PITCH * Cm_alpha, PITCH * Cm_q * q_hat]]
    )
    H = np.array([[1, 0], [0, 1], [SPEED * LIFT * CZ_alpha, SPEED * LIFT * CZ_q * q_hat]])
    return (
        F,
        np.array([LIFT * CZ_elevator, PITCH * Cm_elevator]),
        H,
        np.array([0.0, 0.0, SPEED * LIFT * CZ_elevator]),
    )


def row_to_row(F: Array, G: Array) -> tuple[Array, Array, Array]:
    """x_next = A x + B_0 u + B_1 u_next, the input in a straight line."""
    n = len(F)
    whole = np.zeros((n + 2, n + 2))
    whole[:n, :n], whole[:n, n], whole[n, n + 1] = F * STEP, G * STEP, 1.0
    moved = linalg.expm(whole)
    return moved[:n, :n], moved[:n, n] - moved[:n, n + 1], moved[:n, n + 1]


@cache
def elevator() -> Array:
    """(ROWS,) [rad]."""
    made = sepcal.multisines({"u": 0.02}, duration=ROWS * STEP, rate=1 / STEP)
    return np.asarray(made.signals["u"][:ROWS])


def fly(seed: int, gusts: float) -> Array:
    """(ROWS, 3): alpha, q and az as read; `gusts` [rad]."""
    rng = np.random.default_rng(seed)
    F, G, H, D = dynamics(np.array(list(TRUTH.values())))
    with_gust = np.zeros((3, 3))
    with_gust[:2, :2], with_gust[:2, 2], with_gust[2, 2] = F, F[:, 0], -1 / LAG
    with_gust[0, 2] = F[0, 0]
    A, B_0, B_1 = row_to_row(with_gust, np.append(G, 0.0))
    density = np.zeros((3, 3))
    density[2, 2] = 2 * gusts**2 / LAG
    loan = linalg.expm(STEP * np.block([[-with_gust, density], [np.zeros((3, 3)), with_gust.T]]))
    stirred = np.linalg.svd(loan[3:, 3:].T @ loan[:3, 3:])
    shakes = rng.standard_normal((ROWS, 3)) * np.sqrt(stirred.S) @ stirred.U.T
    u = elevator()
    x = np.array([0.0, 0.0, gusts * rng.standard_normal()])
    states = np.empty((ROWS, 3))
    for row in range(ROWS):
        states[row] = x
        x = A @ x + B_0 * u[row] + B_1 * u[min(row + 1, ROWS - 1)] + shakes[row]
    felt = np.column_stack([H, H[:, 0]])
    return np.asarray(states @ felt.T + np.outer(u, D) + NOISE * rng.standard_normal((ROWS, 3)))


def by_sepcal(read: Array, band: tuple[float, float] | None) -> Estimates:
    """Over the band, or in time: there constants and initial states are estimated too."""
    zero = np.zeros(ROWS)
    log = {
        "time_s": STEP * np.arange(ROWS), "alpha_rad": read[:, 0], "q_radps": read[:, 1],
        "az_mps2": read[:, 2] - GRAVITY, "ax_mps2": zero, "pitch_rad": zero,
        "airspeed_mps": np.full(ROWS, SPEED), "elevator_rad": elevator(),
        "rho_kgpm3": np.full(ROWS, RHO),
    }  # fmt: skip
    aircraft = sepcal.Aircraft(
        area=AREA, chord=CHORD, span=10.9, mass=MASS, inertia=(1285.0, INERTIA, 2667.0, 0.0)
    )
    felt = ["1", "alpha", "q_hat", "elevator"]
    model = sepcal.RigidAircraft(
        aircraft,
        "longitudinal",
        equations={"CX": ["1"], "CZ": felt, "Cm": felt},
        measured=("u", "theta", "v", "p", "r", "phi", "psi"),
        outputs=("alpha", "q", "az"),
        band=band,
    )
    held = {"CX_0": 0.0} if band else {"CX_0": 0.0, "b_az": 0.0, "b_q": 0.0}
    fit = sepcal.fit(model, sepcal.Flight(log), fix=held, threads=1)
    return Estimates(
        np.array([fit[name].value for name in TRUTH]),
        np.array([fit[name].standard_error for name in TRUTH]),
    )


def by_numpy(read: Array) -> Estimates:
    """Maximum likelihood over the band, the noise of each output level there.

    Of a record that ends elsewhere than it begins (z I - A) X = (B_0 + z B_1) U + z c, c two more
    parameters.
    """
    first, last = round(BAND[0] * ROWS * STEP), round(BAND[1] * ROWS * STEP)
    k = np.arange(first, last + 1)
    z = np.exp(2j * np.pi * k / ROWS)
    scale = np.sqrt(2 / ROWS)
    Y, U = scale * np.fft.fft(read, axis=0)[k], scale * np.fft.fft(elevator())[k]

    def errors(p: Array, sizes: Array) -> Array:
        F, G, H, D = dynamics(p[:6])
        A, B_0, B_1 = row_to_row(F, G)
        right = np.outer(U, B_0) + np.outer(z * U, B_1) + np.outer(z, p[6:])
        X = solve_two(z, A, right)
        E = (Y - X @ H.T - np.outer(U, D)) / sizes
        return np.concatenate([E.real.ravel(), E.imag.ravel()])

    truth = np.array(list(TRUTH.values()))
    p, sizes = np.append(0.8 * truth, [0.0, 0.0]), NOISE
    for _ in range(40):
        found = optimize.least_squares(
            errors, p, args=(sizes,), x_scale=np.append(np.abs(truth), [0.01, 0.01]), method="lm"
        )
        p = found.x
        left = errors(p, np.ones(3)).reshape(2, -1, 3)
        before, sizes = sizes, np.sqrt((left**2).sum(axis=(0, 1)) / (2 * len(k)))
        if np.allclose(sizes, before, rtol=1e-6):
            break
    readings = 6 * len(k)
    covariance = np.linalg.inv(found.jac.T @ found.jac) * readings / (readings - len(p))
    return Estimates(p[:6], np.sqrt(np.diag(covariance))[:6])


def solve_two(z: NDArray[np.complex128], A: Array, right: NDArray[np.complex128]) -> Array:
    """(z I - A)^-1 right of two states, (frequencies, 2)."""
    determinant = (z - A[0, 0]) * (z - A[1, 1]) - A[0, 1] * A[1, 0]
    return np.asarray(
        np.column_stack(
            [
                (z - A[1, 1]) * right[:, 0] + A[0, 1] * right[:, 1],
                A[1, 0] * right[:, 0] + (z - A[0, 0]) * right[:, 1],
            ]
        )
        / determinant[:, None]
    )
