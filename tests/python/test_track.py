# SPDX-License-Identifier: BSD-3-Clause
"""Estimates against time: an extended filter by hand, the same model in C++ and Python, batches."""

import pickle

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import sepcal
from own_state_models import (
    PERIOD,
    Pendulum,
    RollMode,
    ShortPeriod,
    fly_short_period,
    swing,
)
from refusals import refuse

FLIGHT = fly_short_period()
NEAR = {name: PERIOD[name] for name in ("Za", "Ma", "Mq")}
NOISE = {"alpha_m": 0.005, "q_m": 0.01, "az_m": 0.15}
METHODS = ("rls", "ekf", "iekf", "srif")
QUIET = {"coloured_errors": False, "threads": 1}


def roll(seed: int = 1, rows: int = 400) -> dict[str, np.ndarray]:
    """A roll mode's record, by its closed form between rows over which the aileron is held."""
    draws = np.random.default_rng(seed)
    time = np.arange(rows) * 0.05
    aileron = np.where(np.sin(2 * np.pi * 0.3 * time) > 0, 0.1, -0.1)
    p, reading = 0.2, []
    for k in range(rows):
        reading.append(p + 0.03 + 0.01 * draws.normal())
        decay = np.exp(-2.0 * 0.05)
        p = decay * p + (1 - decay) / 2.0 * 20.0 * aileron[k]
    return {"time": time, "aileron": aileron, "p_m": np.array(reading)}


def slope(s: np.ndarray, u: float) -> np.ndarray:
    """Of s = p, b_p, La, Lp: the state moves, the parameters stay."""
    return np.array([s[3] * s[0] + s[2] * u, 0.0, 0.0, 0.0])


def differences(f, s: np.ndarray) -> np.ndarray:
    h = 1e-5
    return np.stack([(f(s + h * e) - f(s - h * e)) / (2 * h) for e in np.eye(len(s))], axis=1)


def test_an_extended_filter_by_hand() -> None:
    """Of s = [p, b_p, La, Lp]: Runge and Kutta, differences, and the textbooks' filter."""
    data = roll()
    batch = 150
    model = sepcal.Trajectory(RollMode(), inputs="hold")
    noise = {"p_m": 0.01}
    first = {name: column[:batch] for name, column in data.items()}
    start = sepcal.fit(
        model, first, noise=noise, process_noise={"p": 0.02}, method="filter-error", **QUIET
    )
    found = sepcal.track(model, data, start_rows=batch, noise=noise, process_noise={"p": 0.02})
    assert found.names == ("p", "b_p", "La", "Lp")

    order = ["p_0", "b_p", "La", "Lp"]
    s = np.array([start[name].value for name in order])
    places = [start.names.index(name) for name in order]
    sd = np.array([start[name].standard_error_white for name in order])
    P = start.correlation[np.ix_(places, places)] * np.outer(sd, sd)
    dt, C = 0.05, np.array([[1.0, 1.0, 0.0, 0.0]])

    def advance(s: np.ndarray, u: float) -> np.ndarray:
        k1 = slope(s, u)
        k2 = slope(s + 0.5 * dt * k1, u)
        k3 = slope(s + 0.5 * dt * k2, u)
        return s + dt / 6 * (k1 + 2 * k2 + 2 * k3 + slope(s + dt * k3, u))

    def driven(s: np.ndarray) -> float:
        """The variance that white noise, which enters all the way, adds to p in a step."""
        return 0.02**2 * np.expm1(2 * s[3] * dt) / (2 * s[3])

    # What the batch knows of p at its end: given s, a filter's, whose gains stay where s moves.
    gains, own = [], 0.0
    for _ in range(batch):
        gains.append(own / (own + 0.01**2))
        own = (1 - gains[-1]) * own
        last = own
        own = np.exp(2 * s[3] * dt) * own + driven(s)

    def at_end(s: np.ndarray) -> np.ndarray:
        s = s.copy()
        for k in range(batch):
            s[0] += gains[k] * (data["p_m"][k] - C[0] @ s)
            if k + 1 < batch:
                s = advance(s, data["aileron"][k])
        return s

    moved = differences(at_end, s)
    s, P = at_end(s), moved @ P @ moved.T
    P[0, 0] += last

    for k in range(batch, len(data["time"])):
        u = data["aileron"][k - 1]
        Phi = differences(lambda at, u=u: advance(at, u), s)
        Q = np.zeros((4, 4))
        Q[0, 0] = driven(s)
        s = advance(s, u)
        P = Phi @ P @ Phi.T + Q
        e = data["p_m"][k] - C[0] @ s
        K = P @ C.T / (C @ P @ C.T + 0.01**2)
        s, P = s + K[:, 0] * e, (np.eye(4) - K @ C) @ P
        row = k - batch
        assert_allclose(found.innovations[row, 0], e, atol=1e-7)
        deviations = np.sqrt(np.diag(P))
        assert_allclose(found.standard_deviations[row], deviations, rtol=1e-5)
        assert np.all(np.abs(found.estimates[row] - s) < 1e-5 * deviations)
    assert found.time[0] == data["time"][batch]
    assert list(found.rows) == list(range(batch, len(data["time"])))


class Line:
    """z = k v + c."""

    inputs, outputs = {"v": "m/s"}, {"z": "m/s"}
    linear, nonlinear = {"k": "1", "c": "m/s"}, {}

    def at(self, u, xi2):
        """A and b of every row."""
        return np.stack([u.v, np.ones_like(u.v)], axis=-1)[:, None, :], np.zeros((len(u.v), 1))


@pytest.mark.parametrize("method", ["ekf", "iekf", "srif"])
def test_a_parameter_that_walks_by_hand(method: str) -> None:
    """Of z = k v + c, k a random walk: the textbook's filter, at uneven times."""
    draw = np.random.default_rng(3)
    time = np.cumsum(draw.uniform(0.05, 0.2, 200))
    v = 15.0 + 5.0 * np.sin(time)
    k = np.where(time < time[120], 2.0, 1.5)
    data = {"time": time, "v": v, "z": k * v + 0.7 + 0.1 * draw.standard_normal(time.size)}
    noise = {"z": 0.1}
    found = sepcal.track(Line(), data, start_rows=40, method=method, noise=noise, walk={"k": 0.05})
    H = np.column_stack([v, np.ones(v.size)])
    P = np.linalg.inv(H[:40].T @ H[:40] / 0.01)
    s = P @ H[:40].T @ data["z"][:40] / 0.01
    for row in range(40, time.size):
        if row > 40:
            P = P + np.diag([0.05**2 * (time[row] - time[row - 1]), 0.0])
        gain = P @ H[row] / (H[row] @ P @ H[row] + 0.01)
        s = s + gain * (data["z"][row] - H[row] @ s)
        P = P - np.outer(gain, H[row] @ P)
        at = row - 40
        assert_allclose(found["k"][at], s[0], rtol=1e-7)
        assert_allclose(found.standard_deviation("k")[at], np.sqrt(P[0, 0]), rtol=1e-6)
    assert abs(found["k"][-1] - 1.5) < 3 * found.standard_deviation("k")[-1]
    still = sepcal.track(Line(), data, start_rows=40, method=method, noise=noise)
    assert abs(still["k"][-1] - 1.5) > 10 * still.standard_deviation("k")[-1]


def test_an_aircraft_that_changes_is_followed() -> None:
    """Halfway the aileron loses half of its power: let walk, it is found; held, it isn't."""
    data = roll(rows=800)
    half = 400
    decay, p = np.exp(-2.0 * 0.05), data["p_m"][half] - 0.03
    draw = np.random.default_rng(5)
    for row in range(half, 800):
        data["p_m"][row] = p + 0.03 + 0.01 * draw.normal()
        p = decay * p + (1 - decay) / 2.0 * 10.0 * data["aileron"][row]
    model = sepcal.Trajectory(RollMode(), inputs="hold")
    given = {"start_rows": 150, "noise": {"p_m": 0.01}, "process_noise": {"p": 0.01}}
    walking = sepcal.track(model, data, **given, walk={"La": 2.0})
    still = sepcal.track(model, data, **given)
    assert abs(walking["La"][-1] - 10.0) < 3 * walking.standard_deviation("La")[-1]
    assert walking.standard_deviation("La")[-1] < 1.0
    assert abs(still["La"][-1] - 10.0) > 10 * still.standard_deviation("La")[-1]


@pytest.mark.parametrize("method", ["rls", "ekf", "iekf", "srif"])
def test_what_is_forgotten_by_hand(method: str) -> None:
    """Of z = k v + c: weighted least squares, every row worth 0.97 of the next."""
    draw = np.random.default_rng(8)
    v = 15.0 + 5.0 * np.sin(0.3 * np.arange(300))
    k = np.where(np.arange(300) < 150, 2.0, 1.5)
    data = {"v": v, "z": k * v + 0.7 + 0.1 * draw.standard_normal(300)}
    found = sepcal.track(
        Line(), data, start_rows=40, method=method, noise={"z": 0.1}, forgetting=0.97
    )
    for row in (41, 200, 299):
        H = np.column_stack([v, np.ones(300)])[: row + 1]
        weight = 0.97 ** np.minimum(row - np.arange(row + 1), row - 39)
        information = H.T @ (weight[:, None] * H) / 0.01
        by_hand = np.linalg.solve(information, H.T @ (weight * data["z"][: row + 1]) / 0.01)
        assert_allclose(found["k"][row - 40], by_hand[0], rtol=1e-7)
        deviation = np.sqrt(np.linalg.inv(information)[0, 0])
        assert_allclose(found.standard_deviation("k")[row - 40], deviation, rtol=1e-6)
    for wrong in (0.0, 1.1, -0.5):
        with pytest.raises(sepcal.Error, match="forgetting multiplies the weight of older rows"):
            sepcal.track(Line(), data, start_rows=40, method=method, forgetting=wrong)


def halved(seed: int = 5, rows: int = 1600, at: int = 800) -> dict[str, np.ndarray]:
    """A roll mode whose aileron loses half of its power at row `at`, noise in the states."""
    draw = np.random.default_rng(seed)
    time = 0.05 * np.arange(rows)
    aileron = 0.05 * np.sign(np.sin(1.7 * time)) + 0.02 * np.sin(0.31 * time)
    p = np.zeros(rows)
    for row in range(rows - 1):
        power = 20.0 if row < at else 10.0
        decay = np.exp(-2.0 * 0.05)
        p[row + 1] = decay * p[row] + (1 - decay) / 2.0 * power * aileron[row]
        p[row + 1] += 0.01 * np.sqrt(0.05) * draw.standard_normal()
    return {"time": time, "aileron": aileron, "p_m": p + 0.03 + 0.01 * draw.standard_normal(rows)}


SLOW = [pytest.param(method, marks=pytest.mark.slow) for method in ("iekf", "srif")]


@pytest.mark.parametrize("method", ["ekf", *SLOW])
def test_a_jump_is_found_and_followed(method: str) -> None:
    model = sepcal.Trajectory(RollMode(), inputs="hold")
    given = {"start_rows": 200, "noise": {"p_m": 0.01}, "process_noise": {"p": 0.01}}
    data = halved()
    followed = sepcal.track(model, data, method=method, **given, changes="follow")
    (change,) = followed.changes
    assert 39.0 <= change.onset_time <= 41.0 <= change.found_time <= 45.0
    assert data["time"][change.found] == change.found_time
    (moved,) = change.parameters
    assert moved.name == "La"
    assert abs(moved.before - 20.0) < 1.0
    assert abs(moved.after - 10.0) < 3 * moved.standard_deviation < 9.0
    off = (followed["La"] - 10.0) / followed.standard_deviation("La")
    assert np.max(np.abs(off[followed.time > 45.0])) < 3.5
    found = sepcal.track(model, data, method=method, **given, changes="find")
    plain = sepcal.track(model, data, method=method, **given)
    assert [c.found for c in found.changes] == [change.found]
    assert_array_equal(found.estimates, plain.estimates)
    assert plain.changes == ()
    assert (
        sepcal.track(model, halved(at=1600), method=method, **given, changes="find").changes == ()
    )


@pytest.mark.parametrize("method", ["ekf", "iekf", "srif"])
def test_a_sensor_that_jumps_is_found(method: str) -> None:
    """A model of samples: k of z = k v + c, in a record without time: rows are counted."""
    draw = np.random.default_rng(4)
    v = 15.0 + 5.0 * np.sin(0.05 * np.arange(3000))
    k = np.where(np.arange(3000) < 1500, 2.0, 2.05)
    data = {"v": v, "z": k * v + 0.7 + 0.5 * draw.standard_normal(3000)}
    found = sepcal.track(
        Line(), data, start_rows=300, method=method, noise={"z": 0.5}, changes="follow"
    )
    (change,) = found.changes
    assert 1475 <= change.onset <= 1525 < change.found
    assert np.isnan(change.onset_time)
    assert [moved.name for moved in change.parameters] == ["k"]
    assert abs(found["k"][-1] - 2.05) < 3 * found.standard_deviation("k")[-1]


@pytest.mark.slow
def test_methods_that_look_for_no_change() -> None:
    model = sepcal.Trajectory(RollMode(), inputs="hold")
    for method in ("rls", "rml"):
        with pytest.raises(sepcal.Error, match="changes is of ekf, iekf and srif"):
            sepcal.track(model, halved(), start_rows=200, method=method, changes="find")
    with pytest.raises(sepcal.Error, match=r"ignore.*find.*follow"):
        sepcal.track(model, halved(), start_rows=200, changes="seek")


def test_what_cannot_walk() -> None:
    data = roll()
    model = sepcal.Trajectory(RollMode(), inputs="hold")
    for method, walk, said in (
        ("ekf", {"Lb": 1.0}, "'Lb' can't walk: it is not estimated along the way; there are b_p, "),
        ("ekf", {"La": -1.0}, "the walk of 'La' is no standard deviation; give 0 or more"),
        ("rls", {"La": 1.0}, "walk is of ekf, iekf and srif; leave it out, or take ekf"),
    ):
        with pytest.raises(sepcal.Error) as error:
            sepcal.track(model, data, start_rows=150, method=method, walk=walk)
        assert said in str(error.value)


@pytest.mark.parametrize("method", METHODS)
def test_a_model_in_python_is_tracked_as_one_in_cpp(method: str) -> None:
    """By a noise that moves the state only a little: its covariance over a step is another one."""
    process = {} if method == "rls" else {"process_noise": {"alpha": 1e-6, "q": 1e-5}}
    tracks = [
        sepcal.track(
            model, FLIGHT, start_rows=120, method=method, noise=NOISE, start=NEAR, **process
        )
        for model in (sepcal.ShortPeriod(), ShortPeriod())
    ]
    assert set(tracks[0].names) == set(tracks[1].names)
    for name in tracks[0].names:
        sd = tracks[0].standard_deviation(name)
        assert np.all(np.abs(tracks[0][name] - tracks[1][name]) < 1e-3 * sd), name
        assert_allclose(tracks[1].standard_deviation(name), sd, rtol=1e-3)


@pytest.mark.parametrize("method", METHODS)
def test_the_truth_is_within_the_last_deviations(method: str) -> None:
    found = sepcal.track(sepcal.ShortPeriod(), FLIGHT, start_rows=120, method=method, noise=NOISE)
    for name, value in PERIOD.items():
        if name in found.names:
            assert abs(found[name][-1] - value) < 4.0 * found.standard_deviation(name)[-1], name
            assert found.standard_deviation(name)[-1] < found.standard_deviation(name)[0]


def test_from_another_flights_fit_through_readings_that_are_missing() -> None:
    fit = sepcal.fit(sepcal.ShortPeriod(), FLIGHT, start=NEAR)
    other = fly_short_period(seed=2)
    other["q_m"] = np.where(np.arange(len(other["q_m"])) % 3 == 0, np.nan, other["q_m"])
    found = sepcal.track(sepcal.ShortPeriod(), other, fitted=fit, method="iekf")
    assert np.isnan(found.innovations[0, 1])
    assert not np.isnan(found.innovations[1, 1])
    assert len(found.rows) == len(other["time"])
    assert found.standard_deviation("Mq")[-1] < fit["Mq"].standard_error


def test_a_pendulum_that_is_not_linear() -> None:
    data = swing()
    near = {"w": 2.0, "d": 0.3, "g": 1.0}
    half = len(data["time"]) // 2
    found = sepcal.track(Pendulum(), data, start_rows=half, method="iekf", start=near)
    whole = sepcal.fit(Pendulum(), data, start=near, **QUIET)
    for name in ("w", "d", "g"):
        error = whole[name].standard_error_white
        assert abs(found[name][-1] - whole[name].value) < 0.5 * error
        assert_allclose(found.standard_deviation(name)[-1], error, rtol=0.2)


def test_samples_by_every_method() -> None:
    """Of a model of samples the parameters are the state; near the batch of all rows."""
    draws = np.random.default_rng(5)
    eta = draws.uniform(1, 10, 200)
    z = 2.0 * np.cos(1.05 * eta + 0.1) + 1.0 + 0.3 * draws.normal(size=200)
    data = {"eta": eta, "z": z}
    model = sepcal.ScalarExample2()
    whole = sepcal.fit(model, data, noise={"z": 0.3})
    for method in METHODS:
        found = sepcal.track(model, data, start_rows=60, method=method, noise={"z": 0.3})
        assert len(found.time) == 0
        assert found.estimates.shape == (140, 4)
        for name in found.names:
            assert abs(found[name][-1] - whole[name].value) < 0.5 * whole[name].standard_error


def test_bad_input_is_one_line() -> None:
    model = sepcal.ShortPeriod()
    refuse(
        lambda: sepcal.track(model, FLIGHT),
        "track() starts from one of two: fitted=FIT of other data, or start_rows=N of these",
    )
    refuse(
        lambda: sepcal.track(model, FLIGHT, start_rows=120, method="ukf"),
        "method 'ukf' is unknown; known: 'rls', 'ekf', 'iekf', 'srif', 'rml'",
    )
    refuse(
        lambda: sepcal.track(model, FLIGHT, start_rows=120, process_noise={"r": 1.0}),
        "the model has no process noise 'r'; it has alpha, q",
    )
    refuse(
        lambda: sepcal.track(model, FLIGHT, start_rows=10**6),
        f"start_rows is 1000000; the record has {len(FLIGHT['time'])} rows: take fewer, so that "
        "some are left to track",
    )
    refuse(
        lambda: sepcal.track(model, FLIGHT, start_rows=0),
        "start_rows is 0; give the number of rows to fit first",
    )
    refuse(
        lambda: sepcal.track(sepcal.ShortPeriod(shoot=2.0), FLIGHT, start_rows=120),
        "a track runs on; leave shoot out",
    )
    refuse(
        lambda: sepcal.track(
            model, FLIGHT, start_rows=250, method="rls", process_noise={"alpha": 0.01}
        ),
        "rls integrates no noise and starts where the batch does: leave the process noise 'alpha' "
        "out, or take ekf, iekf or srif",
    )
    for option in ({"row_iterations": -1}, {"tolerance": float("nan")}):
        refuse(
            lambda option=option: sepcal.track(model, FLIGHT, start_rows=250, **option),
            f"{next(iter(option))} needs a number above 0",
        )
    with pytest.raises(KeyError, match="there is no 'Zq'; there are: alpha, q, "):
        sepcal.track(model, FLIGHT, start_rows=250)["Zq"]


def test_it_pickles() -> None:
    found = sepcal.track(sepcal.ShortPeriod(), FLIGHT, start_rows=250)
    again = pickle.loads(pickle.dumps(found))
    assert again.names == found.names
    assert_allclose(again.estimates, found.estimates)
    assert repr(again) == repr(found)


def test_a_magnetometer_without_attitude_starts_as_its_fit_does() -> None:
    draws = np.random.default_rng(4)
    field = draws.normal(size=(600, 3))
    field *= 50.0 / np.linalg.norm(field, axis=1)[:, np.newaxis]
    C = np.array([[1.05, 0.02, -0.01], [0.02, 0.95, 0.03], [-0.01, 0.03, 1.02]])
    readings = field @ C.T + [3.0, -2.0, 5.0] + 0.1 * draws.normal(size=(600, 3))
    data = {**dict(zip(("mx", "my", "mz"), readings.T, strict=True)), "field": np.zeros(600)}
    model = sepcal.Magnetometer(field_strength=50.0)
    found = sepcal.track(model, data, start_rows=300)
    whole = sepcal.fit(model, data)
    for name in ("n_x", "n_y", "n_z"):
        error = whole[name].standard_error_white
        assert abs(found[name][-1] - whole[name].value) < error
