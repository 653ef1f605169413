# SPDX-License-Identifier: BSD-3-Clause
"""Smoothing along a record: brute-force conditioning, an extended smoother by hand, coverage."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import multivariate_normal

import sepcal
from own_models import WindBox
from own_state_models import (
    PERIOD,
    Pendulum,
    RollMode,
    ShortPeriod,
    excite,
    fly_short_period,
    swing,
)
from refusals import refuse

DENSITY = {"alpha": 0.003, "q": 0.09}
START = {"alpha": 0.02, "q": 0.1}
FLIGHT = fly_short_period()
NEAR = {name: PERIOD[name] for name in ("Za", "Ma", "Mq")}


@pytest.fixture(scope="module")
def fit() -> sepcal.Fit:
    return sepcal.fit(sepcal.ShortPeriod(), FLIGHT, start=NEAR)


def step(slope, x, known, dt):
    """Runge and Kutta's, with what is known a line between two rows."""
    middle = 0.5 * (known[0] + known[1])
    k1 = slope(x, known[0])
    k2 = slope(x + 0.5 * dt * k1, middle)
    k3 = slope(x + 0.5 * dt * k2, middle)
    return x + dt / 6 * (k1 + 2 * k2 + 2 * k3 + slope(x + dt * k3, known[1]))


def matrices(fit: sepcal.Fit, data: dict, k: int) -> tuple[np.ndarray, ...]:
    """Of row k: Phi, shift, Gamma to the next one, C, and the outputs' offset."""
    at = {name: fit[name].value for name in fit.names}
    F = np.array([[at["Za"], 1.0], [at["Ma"], at["Mq"]]])
    B = np.array([at["Zd"], at["Md"]])
    u, V = data["elevator"], data["airspeed"][k]
    C = np.array([[1, 0], [0, 1], [V * at["Za"], 0]])
    offset = np.array([at["b_alpha"], at["b_q"], V * at["Zd"] * u[k] + at["b_az"]])
    if k + 1 == len(u):
        return C, offset
    dt = data["time"][k + 1] - data["time"][k]
    A = F * dt
    Phi = np.eye(2) + A + A @ A / 2 + A @ A @ A / 6 + A @ A @ A @ A / 24
    mean = dt * (np.eye(2) + A / 2 + A @ A / 6 + A @ A @ A / 24)  # of noise that is held
    ramp = np.array([[-np.sqrt(3.0)], [np.sqrt(3.0)]])  # and of noise that rises from row to row
    slope = [
        step(lambda x, w, i=i: F @ x + np.eye(2)[i] * w, np.zeros(2), ramp, dt) for i in (0, 1)
    ]
    Gamma = np.hstack([mean, np.stack(slope, axis=1)])
    shift = step(lambda x, e: F @ x + B * e, np.zeros(2), u[k : k + 2], dt)
    return C, offset, Phi, shift, Gamma, dt


def condition(fit: sepcal.Fit, data: dict) -> tuple[np.ndarray, np.ndarray, float, int]:
    """Mean and covariance of (x0, w, x) given y, all at once; ln L; where x begins."""
    N = len(data["time"])
    size = 2 + 4 * (N - 1)  # of two noises means and slopes
    Sigma = np.zeros((size, size))
    Sigma[:2, :2] = np.diag([START["alpha"] ** 2, START["q"] ** 2])
    rows, mean = [np.eye(2, size)], [np.array([fit["alpha_0"].value, fit["q_0"].value])]
    H, expected = [], []
    for k in range(N):
        C, offset, *to = matrices(fit, data, k)
        H.append(C @ rows[k])
        expected.append(C @ mean[k] + offset)
        if not to:
            break
        Phi, shift, Gamma, dt = to
        w = slice(2 + 4 * k, 6 + 4 * k)
        Sigma[w, w] = np.diag(np.square([*DENSITY.values(), *DENSITY.values()])) / dt
        row = Phi @ rows[k]
        row[:, w] += Gamma
        rows.append(row)
        mean.append(Phi @ mean[k] + shift)
    y = np.stack([data["alpha_m"], data["q_m"], data["az_m"]], axis=1).ravel()
    there = ~np.isnan(y)
    H, expected = np.concatenate(H)[there], np.concatenate(expected)[there]
    R = np.diag(np.tile([fit.noise[name] ** 2 for name in fit.noise], N)[there])
    S = H @ Sigma @ H.T + R
    gain = np.linalg.solve(S, H @ Sigma).T
    all_rows = np.concatenate([np.eye(size), *rows])
    prior = np.concatenate([mean[0], np.zeros(size - 2), *mean])
    found = prior + all_rows @ gain @ (y[there] - expected)
    covariance = all_rows @ (Sigma - gain @ H @ Sigma) @ all_rows.T
    return found, covariance, multivariate_normal(expected, S).logpdf(y[there]), size


@pytest.mark.parametrize("model", [sepcal.ShortPeriod(), ShortPeriod()], ids=["cpp", "python"])
def test_it_is_conditioning(model: object, fit: sepcal.Fit) -> None:
    """Rows that lie unevenly, outputs that are missing, one row without any.

    So close that the series which says what a noise does from row to row is exact.
    """
    rng = np.random.default_rng(2)
    N = 9
    time = np.cumsum(rng.uniform(0.0002, 0.001, N))
    data = {"time": time, "elevator": 0.05 * rng.standard_normal(N), "airspeed": 25 + rng.random(N)}
    data |= {name: 0.1 * rng.standard_normal(N) for name in ("alpha_m", "q_m", "az_m")}
    data["alpha_m"][[2, 5]] = data["az_m"][5] = data["q_m"][5] = np.nan
    smoothed = sepcal.smooth(model, data, fit, DENSITY, start=START, parameter_errors=False)
    mean, covariance, log_likelihood, begin = condition(fit, data)
    assert smoothed.states == ("alpha", "q")
    assert smoothed.noises == ("alpha", "q")
    assert_allclose(smoothed.x.ravel(), mean[begin:], rtol=0, atol=1e-12)
    noises = mean[2:begin].reshape(-1, 4)[:, :2]
    assert_allclose(smoothed.w[:-1], noises, rtol=1e-9, atol=1e-9)
    for k in range(N):
        at = slice(begin + 2 * k, begin + 2 * k + 2)
        assert_allclose(smoothed.covariance[k], covariance[at, at], rtol=1e-8)
        if k + 1 < N:
            w = slice(2 + 4 * k, 4 + 4 * k)
            assert_allclose(smoothed.w_covariance[k], covariance[w, w], rtol=1e-9, atol=1e-12)
    assert smoothed.log_likelihood == pytest.approx(log_likelihood, abs=1e-9)
    assert smoothed.readings == 3 * N - 4
    assert np.isnan(smoothed.innovations[5]).all()
    assert_allclose(smoothed["q"], smoothed.x[:, 1])
    sd = np.sqrt(np.diagonal(smoothed.covariance, axis1=1, axis2=2))
    assert_allclose(smoothed.standard_error, sd)


def test_an_extended_smoother_by_hand() -> None:
    """The pendulum's, its Jacobians by complex steps; filter and smoother as in any textbook.

    What a noise does is told from Phi as if the pendulum's stiffness stayed from row to row.
    """
    data = swing(rows=150)
    fit = sepcal.fit(Pendulum(), data, samples=20)
    smoothed = sepcal.smooth(
        Pendulum(), data, fit, {"v": 0.3}, start={"x": 0.1, "v": 0.2}, parameter_errors=False
    )
    at = {name: fit[name].value for name in fit.names}

    def slope(x, known):
        u, w = known
        return np.array([x[1], -(at["w"] ** 2) * np.sin(x[0]) - at["d"] * x[1] + at["g"] * u + w])

    def move(k, x, w):
        known = np.array([[data["u"][k], w[0]], [data["u"][k + 1], w[1]]])
        return step(slope, x, known, data["time"][k + 1] - data["time"][k])

    N, h = len(data["time"]), 1e-30
    x, P = np.array([at["x_0"], at["v_0"]]), np.diag([0.01, 0.04])
    H, R = np.array([[1 + at["s"], 0.0], [0.0, 1.0]]), np.diag(np.square(list(fit.noise.values())))
    filtered, predicted = [], []
    for k in range(N):
        e = np.array([data["x_m"][k], data["v_m"][k]]) - H @ x - [at["b"], 0.0]
        K = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
        x, P = x + K @ e, (np.eye(2) - K @ H) @ P
        filtered.append((x, P))
        if k + 1 == N:
            break
        none = (0.0, 0.0)
        Phi = np.stack(
            [move(k, x + 1j * h * np.eye(2)[i], none).imag / h for i in range(2)], axis=1
        )
        ramps = ((1.0, 1.0), (-np.sqrt(3.0), np.sqrt(3.0)))  # a noise's mean, and its slope
        driven = [move(k, x.astype(complex), 1j * h * np.array(ramp)).imag / h for ramp in ramps]
        Gamma = np.stack(driven, axis=1)
        Q = 0.3**2 / (data["time"][k + 1] - data["time"][k])
        x, P = move(k, x, none), Phi @ P @ Phi.T + Q * Gamma @ Gamma.T
        predicted.append((x, P, Phi, Gamma * Q))
    for k in range(N - 2, -1, -1):
        ahead, P_ahead, Phi, noise = predicted[k]
        (x_k, P_k), inverse = filtered[k], np.linalg.inv(P_ahead)
        C = P_k @ Phi.T @ inverse
        assert_allclose(smoothed.w[k], (noise.T @ inverse @ (x - ahead))[:1], rtol=0, atol=1e-3)
        x, P = x_k + C @ (x - ahead), P_k + C @ (P - P_ahead) @ C.T
        assert_allclose(smoothed.x[k], x, rtol=0, atol=1e-4)
        assert_allclose(smoothed.covariance[k], P, rtol=1e-2, atol=1e-7)


def test_bands_hold_the_states(fit: sepcal.Fit) -> None:
    """40 flights with process noise, drawn twenty times finer than it is logged: 95 % bands."""
    rng = np.random.default_rng(7)
    at = {name: fit[name].value for name in fit.names}
    F = np.array([[at["Za"], 1.0], [at["Ma"], at["Mq"]]])
    B = np.array([at["Zd"], at["Md"]])
    rows, fine = 160, 20
    time = 0.02 * np.arange(rows)
    elevator = excite(time, 0.05)
    between = np.interp(np.arange(rows * fine) * 0.02 / fine, time, elevator)
    inside = []
    for _ in range(40):
        x, states = rng.standard_normal(2) * [0.02, 0.1] + [at["alpha_0"], at["q_0"]], []
        kicks = rng.standard_normal((rows * fine, 2)) * list(DENSITY.values())
        for k in range(rows * fine):
            if k % fine == 0:
                states.append(x)
            dt = 0.02 / fine
            x = x + dt * (F @ x + B * between[k]) + np.sqrt(dt) * kicks[k]
        true = np.array(states)
        noise = rng.standard_normal((rows, 3)) * list(fit.noise.values())
        data = {"time": time, "elevator": elevator, "airspeed": np.full(rows, 25.0)}
        data["alpha_m"] = true[:, 0] + at["b_alpha"] + noise[:, 0]
        data["q_m"] = true[:, 1] + at["b_q"] + noise[:, 1]
        az = 25.0 * (at["Za"] * true[:, 0] + at["Zd"] * elevator)
        data["az_m"] = az + at["b_az"] + noise[:, 2]
        smoothed = sepcal.smooth(sepcal.ShortPeriod(), data, fit, DENSITY, parameter_errors=False)
        z = (smoothed.x - true)[[0, 40, 80, 120, 159]] / smoothed.standard_error[
            [0, 40, 80, 120, 159]
        ]
        inside.append(np.abs(z) < 1.96)
    assert 0.92 < np.mean(inside) < 0.98  # 400 values; three standard deviations are 0.033


def test_errors_of_parameters_widen_the_bands(fit: sepcal.Fit) -> None:
    """By J C J', J by small differences of each parameter that is no initial state.

    On measurements as the fit predicts them: without innovations no gain matters.
    """
    model, at = sepcal.ShortPeriod(), {name: fit[name].value for name in fit.names}
    predicted = sepcal.predict(model, FLIGHT, fit).value
    flight = {**FLIGHT, **dict(zip(fit.noise, predicted.T, strict=True))}
    starts = ("alpha_0", "q_0")

    def smooth_at(moved: dict[str, float]) -> sepcal.Smoothed:
        fixed = {name: value for name, value in {**at, **moved}.items() if name != "alpha_0"}
        held = sepcal.fit(model, flight, fix=fixed)  # alpha_0 is where next to nothing begins
        return sepcal.smooth(model, flight, held, DENSITY, noise=fit.noise)

    names = [name for name in fit.names if name not in starts]
    places = [fit.names.index(name) for name in names]
    C = np.asarray(fit.covariance)[np.ix_(places, places)]
    columns = []
    for name in names:
        step = 0.01 * fit[name].standard_error
        above, below = smooth_at({name: at[name] + step}), smooth_at({name: at[name] - step})
        columns.append(((above.x - below.x) / (2 * step), (above.w - below.w) / (2 * step)))
    J_x, J_w = (np.stack(parts, axis=2) for parts in zip(*columns, strict=True))
    known = sepcal.smooth(model, flight, fit, DENSITY, parameter_errors=False)
    whole = sepcal.smooth(model, flight, fit, DENSITY)
    assert_allclose(whole.x, known.x, rtol=0, atol=0)
    for found, before, J in (
        (whole.covariance, known.covariance, J_x),
        (whole.w_covariance, known.w_covariance, J_w),
    ):
        expected = before + J @ C @ J.transpose(0, 2, 1)
        size = np.sqrt(np.diagonal(expected, axis1=1, axis2=2))
        scale = size[:, :, np.newaxis] * size[:, np.newaxis, :] + 1e-300
        assert np.max(np.abs(found - expected) / scale) < 1e-3  # of small differences


def test_little_noise_leaves_the_fits_trajectory(fit: sepcal.Fit) -> None:
    smoothed = sepcal.smooth(sepcal.ShortPeriod(), FLIGHT, fit, {"q": 1e-9})
    predicted = sepcal.predict(sepcal.ShortPeriod(), FLIGHT, fit).value
    assert_allclose(smoothed["q"] + fit["b_q"].value, predicted[:, 1], rtol=0, atol=2e-6)
    assert (smoothed.w_standard_error[:-1, 0] == 0).all()


def test_segments_are_smoothed_alone(fit: sepcal.Fit) -> None:
    labels = ["one"] * 150 + ["two"] * 150
    both = {**FLIGHT, "maneuver": labels}
    fitted = sepcal.fit(sepcal.ShortPeriod(), both, start=NEAR)
    whole = sepcal.smooth(sepcal.ShortPeriod(), both, fitted, DENSITY, start=START)
    assert (whole.w[[149, 299]] == 0).all()
    assert whole.x.shape == (300, 2)
    assert np.isfinite(whole.x).all()


@pytest.mark.long
def test_measured_states_are_known(fit: sepcal.Fit) -> None:
    options = {"measured": ["q"], "outputs": ["alpha_m", "az_m"]}
    data = {**FLIGHT, "q": FLIGHT["q_m"] + 0.01}
    found = [
        sepcal.smooth(model, data, sepcal.fit(model, data, fix={"Ma": -40, "Mq": -5, "Md": -45}),
                      {"alpha": 0.003}, start={"alpha": 0.02})
        for model in (sepcal.ShortPeriod(**options), sepcal.Trajectory(ShortPeriod(), **options))
    ]  # fmt: skip
    assert found[0].states == ("alpha",)
    assert_allclose(found[0].x, found[1].x, rtol=0, atol=1e-6)
    assert_allclose(found[0].standard_error, found[1].standard_error, rtol=1e-6)


def test_what_cannot_be_smoothed(fit: sepcal.Fit) -> None:
    model = sepcal.ShortPeriod()
    refuse(lambda: sepcal.smooth(model, FLIGHT, fit, {}), "no process noise", "alpha, q")
    refuse(lambda: sepcal.smooth(model, FLIGHT, fit, {"az": 1.0}), "'az'", "alpha, q")
    refuse(lambda: sepcal.smooth(model, FLIGHT, fit, {"q": -1.0}), "'q'", "positive")
    refuse(lambda: sepcal.smooth(model, FLIGHT, fit, DENSITY, noise={"q_m": 1.0}), "'alpha_m'")
    refuse(lambda: sepcal.smooth(model, FLIGHT, fit, DENSITY, start={"p": 1.0}), "state 'p'")
    refuse(lambda: sepcal.smooth(RollMode(), FLIGHT, fit, DENSITY), "RollMode", "'aileron'")
    quiet = type("Quiet", (ShortPeriod,), {"noise": {}})()
    refuse(lambda: sepcal.smooth(quiet, FLIGHT, fit, DENSITY), "table `noise`")
    gone = {**FLIGHT, "elevator": np.where(FLIGHT["time"] == 1.0, np.nan, FLIGHT["elevator"])}
    refuse(lambda: sepcal.smooth(model, gone, fit, DENSITY), "'elevator'", "row 50")
    two = {**FLIGHT, "maneuver": ["a"] * 150 + ["b"] * 150}
    refuse(lambda: sepcal.smooth(model, two, fit, DENSITY), "'alpha_0[a]'", "no value")
    box = {"v": [1.0, 2.0], "psi": [0.0, 1.0], "vn": [1.0, 2.0], "ve": [0.0, 1.0]}
    refuse(lambda: sepcal.smooth(WindBox(), box, fit, DENSITY), "no state")
    with pytest.raises(KeyError, match="alpha, q"):
        sepcal.smooth(model, FLIGHT, fit, DENSITY)["p"]
