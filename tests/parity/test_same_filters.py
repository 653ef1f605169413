# SPDX-License-Identifier: BSD-3-Clause
"""The filters and smoothers, in C++ and Python, give what statsmodels and FilterPy give.

A time-varying system of three states with correlated noises, 40 samples, inputs, missing outputs.
"""

import subprocess
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm, logm

import sepcal
from own_state_models import ShortPeriod, fly_short_period
from parity.programs import BUILD

N_X, N_W, N_Z, SAMPLES = 3, 2, 2, 40
FORMS = ("square-root", "joseph")


@dataclass(frozen=True)
class System:
    """Matrices of every sample first by sample."""

    x0: np.ndarray
    P0: np.ndarray
    Phi: np.ndarray
    shift: np.ndarray  # Psi u
    Gamma: np.ndarray
    Q: np.ndarray
    C: np.ndarray
    offset: np.ndarray  # D u
    R: np.ndarray
    y: np.ndarray


def draw_system(seed: int, inputs: bool) -> System:
    """A random stable one; y is any record, not one of the system's own."""
    rng = np.random.default_rng(seed)

    def covariances(size: int) -> np.ndarray:
        roots = rng.standard_normal((SAMPLES, size, size + 1))
        return roots @ roots.transpose(0, 2, 1) / size

    Phi = rng.standard_normal((SAMPLES, N_X, N_X))
    Phi *= 0.95 / np.linalg.norm(Phi, ord=2, axis=(1, 2), keepdims=True)
    return System(
        x0=rng.standard_normal(N_X),
        P0=covariances(N_X)[0],
        Phi=Phi,
        shift=rng.standard_normal((SAMPLES, N_X)) * inputs,
        Gamma=rng.standard_normal((SAMPLES, N_X, N_W)),
        Q=covariances(N_W),
        C=rng.standard_normal((SAMPLES, N_Z, N_X)),
        offset=rng.standard_normal((SAMPLES, N_Z)) * inputs,
        R=covariances(N_Z),
        y=2.0 * rng.standard_normal((SAMPLES, N_Z)),
    )


def run_filter(system: System, form: str) -> dict[str, np.ndarray]:
    """What the C++ program prints, by name."""
    parts = [np.array([SAMPLES]), system.x0, system.P0]
    for k in range(SAMPLES):
        parts += [system.Phi[k], system.shift[k], system.Gamma[k], system.Q[k]]
        parts += [system.C[k], system.offset[k], system.R[k], system.y[k]]
    text = " ".join(repr(float(number)) for part in parts for number in np.ravel(part))
    text = text.replace(f"{SAMPLES}.0", str(SAMPLES), 1)
    done = subprocess.run(
        [BUILD / "tests" / "filter_record", form],
        input=text, capture_output=True, text=True, check=True,
    )  # fmt: skip
    numbers = np.array([line.split() for line in done.stdout.splitlines()], dtype=float)
    shapes = {
        "x": (N_X,), "P": (N_X, N_X), "x_next": (N_X,), "P_next": (N_X, N_X),
        "x_smoothed": (N_X,), "P_smoothed": (N_X, N_X), "w": (N_W,), "Q": (N_W, N_W), "cost": (),
    }  # fmt: skip
    result, first = {}, 0
    for name, shape in shapes.items():
        size = int(np.prod(shape))
        result[name] = numbers[:, first : first + size].reshape(SAMPLES, *shape)
        first += size
    assert first == numbers.shape[1]
    return result


def distance(ours: np.ndarray, theirs: np.ndarray) -> float:
    """The largest difference, in parts of the largest number."""
    return float(np.abs(ours - theirs).max() / np.abs(theirs).max())


def smooth_by_statsmodels(smoothing: Any, system: System) -> Any:
    """Its results object; `smoothing` is its module."""
    N, n_z, n_x = system.C.shape
    model = smoothing.KalmanSmoother(
        k_endog=n_z, k_states=n_x, k_posdef=system.Q.shape[1], nobs=N,
        design=np.moveaxis(system.C, 0, -1), obs_intercept=system.offset.T,
        obs_cov=np.moveaxis(system.R, 0, -1), transition=np.moveaxis(system.Phi, 0, -1),
        state_intercept=system.shift.T, selection=np.moveaxis(system.Gamma, 0, -1),
        state_cov=np.moveaxis(system.Q, 0, -1),
    )  # fmt: skip
    model.bind(system.y)
    model.initialize_known(system.x0, system.P0)
    return model.smooth()


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("missing", [False, True], ids=["whole", "missing"])
def test_statsmodels(form: str, missing: bool) -> None:
    """Filtered, predicted and smoothed states, smoothed noises, likelihood."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        smoothing = pytest.importorskip("statsmodels.tsa.statespace.kalman_smoother")
    system = draw_system(1, inputs=True)
    if missing:
        system.y[3, 0] = system.y[10, 1] = np.nan
        system.y[20:23] = np.nan
    theirs = smooth_by_statsmodels(smoothing, system)
    ours = run_filter(system, form)
    errors = {
        "x": distance(ours["x"], theirs.filtered_state.T),
        "P": distance(ours["P"], np.moveaxis(theirs.filtered_state_cov, -1, 0)),
        "x_next": distance(ours["x_next"], theirs.predicted_state.T[1:]),
        "P_next": distance(ours["P_next"], np.moveaxis(theirs.predicted_state_cov, -1, 0)[1:]),
        "x_smoothed": distance(ours["x_smoothed"], theirs.smoothed_state.T),
        "P_smoothed": distance(ours["P_smoothed"], np.moveaxis(theirs.smoothed_state_cov, -1, 0)),
        "w": distance(ours["w"], theirs.smoothed_state_disturbance.T),
        "Q": distance(ours["Q"], np.moveaxis(theirs.smoothed_state_disturbance_cov, -1, 0)),
    }
    print(errors, "ln L", abs(ours["cost"].sum() + theirs.llf))
    assert max(errors.values()) < 1e-12
    np.testing.assert_allclose(-ours["cost"], theirs.llf_obs, rtol=0, atol=1e-10)


@pytest.mark.parametrize("form", FORMS)
def test_filterpy(form: str) -> None:
    """Filtered, predicted and smoothed states, likelihood; FilterPy's smoother knows no inputs."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        kalman = pytest.importorskip("filterpy.kalman")
    system = draw_system(2, inputs=False)
    model = kalman.KalmanFilter(dim_x=N_X, dim_z=N_Z)
    model.x, model.P = system.x0, system.P0
    noise = system.Gamma @ system.Q @ system.Gamma.transpose(0, 2, 1)
    means, covariances, next_means, next_covariances, costs = [], [], [], [], []
    for k in range(SAMPLES):
        model.update(system.y[k], R=system.R[k], H=system.C[k])
        costs.append(-model.log_likelihood)
        means.append(model.x.copy())
        covariances.append(model.P.copy())
        model.predict(F=system.Phi[k], Q=noise[k])
        next_means.append(model.x.copy())
        next_covariances.append(model.P.copy())
    # Its smoother goes from k to k + 1 by the matrices at k + 1.
    smoothed, smoothed_covariances, _, _ = model.rts_smoother(
        np.array(means), np.array(covariances),
        Fs=np.roll(system.Phi, 1, axis=0), Qs=np.roll(noise, 1, axis=0),
    )  # fmt: skip
    ours = run_filter(system, form)
    errors = {
        "x": distance(ours["x"], np.array(means)),
        "P": distance(ours["P"], np.array(covariances)),
        "x_next": distance(ours["x_next"], np.array(next_means)),
        "P_next": distance(ours["P_next"], np.array(next_covariances)),
        "x_smoothed": distance(ours["x_smoothed"], smoothed),
        "P_smoothed": distance(ours["P_smoothed"], smoothed_covariances),
    }
    print(errors, "ln L", np.abs(ours["cost"] - costs).max())
    assert max(errors.values()) < 1e-12
    np.testing.assert_allclose(ours["cost"], costs, rtol=0, atol=1e-10)


@pytest.mark.parametrize("form", FORMS)
def test_the_filter_in_python(form: str) -> None:
    """sepcal.Filter beside statsmodels: means, covariances, likelihood, outputs missing."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        smoothing = pytest.importorskip("statsmodels.tsa.statespace.kalman_smoother")
    system = draw_system(3, inputs=True)
    system.y[3, 0] = system.y[10, 1] = np.nan
    system.y[20:23] = np.nan
    theirs = smooth_by_statsmodels(smoothing, system)
    ours = sepcal.Filter(system.x0, system.P0, form.replace("-", "_"))
    errors = []
    for k in range(SAMPLES):
        C = system.C[k]
        ours.update(system.y[k], C, system.R[k], expected=C @ ours.x + system.offset[k])
        errors.append(distance(ours.x, theirs.filtered_state[:, k]))
        errors.append(distance(ours.covariance, theirs.filtered_state_cov[:, :, k]))
        ours.predict(system.Phi[k], system.Q[k], Gamma=system.Gamma[k], shift=system.shift[k])
    print(max(errors), "ln L", abs(ours.log_likelihood - theirs.llf))
    assert max(errors) < 1e-12
    assert abs(ours.log_likelihood - theirs.llf) < 1e-9


@pytest.mark.parametrize("own", [False, True], ids=["cpp", "python"])
def test_a_smoothed_record(own: bool) -> None:
    """sepcal.smooth() of the short period, 300 rows, beside statsmodels with its matrices."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        smoothing = pytest.importorskip("statsmodels.tsa.statespace.kalman_smoother")
    data = fly_short_period(rows=300)
    fit = sepcal.fit(sepcal.ShortPeriod(), data, start={"Za": -4, "Ma": -40, "Mq": -5})
    data["alpha_m"][100:120] = data["az_m"][50] = np.nan
    density, start = {"alpha": 0.003, "q": 0.09}, {"alpha": 0.1, "q": 1.0}
    model = ShortPeriod() if own else sepcal.ShortPeriod()
    ours = sepcal.smooth(model, data, fit, density, start=start, parameter_errors=False)
    system, Gamma = short_period_system(data, fit, density, start)
    theirs = smooth_by_statsmodels(smoothing, system)
    # From what disturbed the state to the mean of each noise, of which it is a part.
    Q = np.diag([density["alpha"] ** 2, density["q"] ** 2]) / 0.02
    back = Q @ Gamma[:, :2].T @ np.linalg.inv(system.Q[0])
    told = system.Q[0] - np.moveaxis(theirs.smoothed_state_disturbance_cov, -1, 0)[:-1]
    errors = {
        "x": distance(ours.x, theirs.smoothed_state.T),
        "P": distance(ours.covariance, np.moveaxis(theirs.smoothed_state_cov, -1, 0)),
        "w": distance(ours.w[:-1], theirs.smoothed_state_disturbance.T[:-1] @ back.T),
        "Q": distance(ours.w_covariance[:-1], Q - back @ told @ back.T),
    }
    print(errors, "ln L", abs(ours.log_likelihood - theirs.llf))
    assert max(errors.values()) < 3e-6  # the series that says what a noise does from row to row
    assert abs(ours.log_likelihood - theirs.llf) < 2e-4


def short_period_system(
    data: dict[str, np.ndarray], fit: sepcal.Fit, density: dict, start: dict
) -> tuple[System, np.ndarray]:
    """Runge and Kutta's step of a linear system, written as its polynomial; Gamma."""
    at = {name: fit[name].value for name in fit.names}
    dt, u, N = 0.02, data["elevator"], len(data["time"])
    A = dt * np.array([[at["Za"], 1.0], [at["Ma"], at["Mq"]]])
    B = dt * np.array([at["Zd"], at["Md"]])
    eye, squared = np.eye(2), A @ A
    middle, end = u[:-1] + np.diff(u) / 2, u[1:]
    # k1 = B u0, k2 = k1 A / 2 + B um, k3 = k2 A / 2 + B um, k4 = k3 A + B u1 of x = 0
    k1 = np.outer(u[:-1], B)
    k2 = k1 @ A.T / 2 + np.outer(middle, B)
    k3 = k2 @ A.T / 2 + np.outer(middle, B)
    k4 = k3 @ A.T + np.outer(end, B)
    shift = np.zeros((N, 2))
    shift[:-1] = (k1 + 2 * k2 + 2 * k3 + k4) / 6
    Phi = eye + A + squared / 2 + squared @ A / 6 + squared @ squared / 24
    # Of noise that is a mean and a slope from row to row, were the dynamics Phi's own all the way.
    rate = logm(Phi)
    node, weight = np.polynomial.legendre.leggauss(12)
    ahead = [w / 2 * expm(rate * (1 - x) / 2) for x, w in zip(node, weight, strict=True)]
    mean = dt * sum(ahead)
    slope = dt * sum(np.sqrt(3.0) * x * term for x, term in zip(node, ahead, strict=True))
    Gamma = np.hstack([mean, slope])
    C = np.array([[1.0, 0.0], [0.0, 1.0], [25.0 * at["Za"], 0.0]])
    biases = np.array([at["b_alpha"], at["b_q"], at["b_az"]])
    noise = Gamma @ np.diag([density["alpha"] ** 2, density["q"] ** 2] * 2) @ Gamma.T / dt
    system = System(
        x0=np.array([at["alpha_0"], at["q_0"]]),
        P0=np.diag([start["alpha"] ** 2, start["q"] ** 2]),
        Phi=np.tile(Phi, (N, 1, 1)),
        shift=shift,
        Gamma=np.tile(eye, (N, 1, 1)),
        Q=np.tile(noise, (N, 1, 1)),
        C=np.tile(C, (N, 1, 1)),
        offset=biases + np.outer(u, [0.0, 0.0, 25.0 * at["Zd"]]),
        R=np.tile(np.diag([fit.noise[n] ** 2 for n in ("alpha_m", "q_m", "az_m")]), (N, 1, 1)),
        y=np.stack([data["alpha_m"], data["q_m"], data["az_m"]], axis=1),
    )
    return system, Gamma
