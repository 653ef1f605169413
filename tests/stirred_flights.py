# SPDX-License-Identifier: BSD-3-Clause
"""A short period in turbulence, flown exactly: 20 s at 50 Hz.

The state goes from row to row by the matrix exponential, its noise by Van Loan's integral; the
elevator is a line between rows.
"""

import numpy as np
from scipy.linalg import expm

STEP = 0.02  # s
ROWS = 1000
AIRSPEED = 25.0  # m/s
TRUTH = {"Za": -4.0, "Zd": -0.35, "Ma": -40.0, "Mq": -5.0, "Md": -45.0}
BIASES = {"b_alpha": 0.02, "b_q": -0.01, "b_az": 0.5}
READS = {"alpha_m": 0.005, "q_m": 0.01, "az_m": 0.15}
NOISES = {"alpha": 0.003, "q": 0.09}
SIZES = {f"q_{name}": size for name, size in NOISES.items()} | {
    f"r_{name}": size for name, size in READS.items()
}


def elevator(time: np.ndarray) -> np.ndarray:
    """3-2-1-1 of 0.06 rad both ways, then a sweep of 0.04 rad up to 3 Hz."""
    u = np.zeros_like(time)
    for begin, sign in ((1.0, 0.06), (6.0, -0.06)):
        at = np.floor((time - begin) / 0.3 + 1e-9)
        for first, last, way in ((0, 3, 1), (3, 5, -1), (5, 6, 1), (6, 7, -1)):
            u[(at >= first) & (at < last)] = sign * way
    late = time - 10.0
    return np.where(late < 0, u, 0.04 * np.sin(2 * np.pi * (0.1 * late + 0.145 * late**2)))


def fly(
    seed: int, *, reads: dict[str, float] = READS, noises: dict[str, float] = NOISES
) -> dict[str, np.ndarray]:
    """The columns of a log, of readings and states with these noises."""
    rng = np.random.default_rng(seed)
    F = np.array([[TRUTH["Za"], 1.0], [TRUTH["Ma"], TRUTH["Mq"]]])
    B = np.array([TRUTH["Zd"], TRUTH["Md"]])
    block = np.zeros((4, 4))  # x' = F x + B u, u' = its slope
    block[:2, :2], block[:2, 2], block[2, 3] = F, B, 1.0
    step = expm(block * STEP)
    density = np.diag(np.square(list(noises.values())))
    van_loan = expm(np.block([[-F, density], [np.zeros((2, 2)), F.T]]) * STEP)
    noise = np.linalg.cholesky(van_loan[2:, 2:].T @ van_loan[:2, 2:])
    time = STEP * np.arange(ROWS)
    u = elevator(time)
    x = np.zeros((ROWS, 2))
    for row in range(ROWS - 1):
        slope = (u[row + 1] - u[row]) / STEP
        x[row + 1] = (step @ [*x[row], u[row], slope])[:2] + noise @ rng.standard_normal(2)
    true = {
        "alpha_m": x[:, 0],
        "q_m": x[:, 1],
        "az_m": AIRSPEED * (TRUTH["Za"] * x[:, 0] + TRUTH["Zd"] * u),
    }
    readings = {
        name: true[name] + bias + reads[name] * rng.standard_normal(ROWS)
        for name, bias in zip(reads, BIASES.values(), strict=True)
    }
    return {"time": time, "elevator": u, "airspeed": np.full(ROWS, AIRSPEED), **readings}
