# SPDX-License-Identifier: BSD-3-Clause
"""A Kalman filter with fixed-interval smoothing: sepcal, statsmodels and FilterPy."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.race import Competitor, Result, judge, program, race, timed

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from filterpy.kalman import KalmanFilter
    from statsmodels.tsa.statespace.kalman_smoother import KalmanSmoother

SAMPLES = 2000
X0, P0 = np.zeros(4), np.diag([100.0, 100.0, 10.0, 10.0])
C = np.hstack([np.eye(2), np.zeros((2, 2))])
R = np.array([[4.0, 1.0], [1.0, 2.0]])


def draw(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Phi, Q_d (each sample its own) and y of a vehicle seen at irregular times."""
    rng = np.random.default_rng(seed)
    dt = rng.uniform(0.05, 0.2, SAMPLES)
    Phi = np.tile(np.eye(4), (SAMPLES, 1, 1))
    Phi[:, 0, 2] = Phi[:, 1, 3] = dt
    Q = np.zeros((SAMPLES, 4, 4))
    for i in range(2):
        Q[:, i, i] = dt**3 / 3
        Q[:, i, 2 + i] = Q[:, 2 + i, i] = dt**2 / 2
        Q[:, 2 + i, 2 + i] = dt
    x, y = X0.copy(), np.empty((SAMPLES, 2))
    for k in range(SAMPLES):
        y[k] = C @ x + rng.multivariate_normal(np.zeros(2), R)
        x = Phi[k] @ x + rng.multivariate_normal(np.zeros(4), Q[k])
    return Phi, Q, y


def statsmodels_model(Phi: np.ndarray, Q: np.ndarray, y: np.ndarray) -> KalmanSmoother:
    """Made once; what is timed is smooth()."""
    model = KalmanSmoother(
        k_endog=2, k_states=4, nobs=SAMPLES, design=C, obs_cov=R, selection=np.eye(4),
        transition=np.moveaxis(Phi, 0, -1), state_cov=np.moveaxis(Q, 0, -1),
    )  # fmt: skip
    model.bind(y)
    model.initialize_known(X0, P0)
    return model


def by_filterpy(Phi: np.ndarray, Q: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Its filter by rows, then its smoother, which goes to k + 1 by the matrices at k + 1."""
    model = KalmanFilter(dim_x=4, dim_z=2)
    model.x, model.P = X0.copy(), P0.copy()
    means, covariances = np.empty((SAMPLES, 4)), np.empty((SAMPLES, 4, 4))
    for k in range(SAMPLES):
        model.update(y[k], R=R, H=C)
        means[k], covariances[k] = model.x, model.P
        model.predict(F=Phi[k], Q=Q[k])
    smoothed = model.rts_smoother(
        means, covariances, Fs=np.roll(Phi, 1, axis=0), Qs=np.roll(Q, 1, axis=0)
    )[0]
    return np.asarray(smoothed).ravel()


def run(folder: Path, rounds: int, longest: int) -> Iterator[Result]:
    """One race, short as it is."""
    Phi, Q, y = draw(1)
    samples = np.hstack([Phi.reshape(SAMPLES, -1), Q.reshape(SAMPLES, -1), y])
    file = folder / "smoother.bin"
    np.concatenate([X0, P0.ravel(), C.ravel(), R.ravel(), samples.ravel()]).tofile(file)
    model = statsmodels_model(Phi, Q, y)
    competitors = [
        Competitor("sepcal, square roots", program("smoother", "square-root", file)),
        Competitor("sepcal, Joseph's form", program("smoother", "joseph", file)),
        Competitor("statsmodels", timed(lambda: model.smooth().smoothed_state.T.ravel())),
        Competitor("FilterPy", timed(lambda: by_filterpy(Phi, Q, y))),
    ]
    race(competitors, rounds)
    size = float(np.abs(competitors[0].answer).max())
    title = "Filter and smoother, four states, two outputs, 2000 samples at irregular times"
    yield judge(
        "smoother",
        title,
        competitors,
        lambda off: float(np.abs(off).max()) / size,
        "of the largest",
    )
