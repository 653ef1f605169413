# SPDX-License-Identifier: BSD-3-Clause
"""Tracks that forget, over a band and in two steps, against calculations of NumPy's own."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray

import sepcal

Array = NDArray[np.float64]

RATE = 50
FREQUENCIES = np.linspace(0.1, 2.0, 39)  # Hz


class Moment:
    """Linear: a coefficient on three regressors and a constant."""

    inputs: ClassVar = {"alpha": "rad", "q": "rad/s", "elevator": "rad"}
    outputs: ClassVar = {"c": "1"}
    linear: ClassVar = {"c_alpha": "1", "c_q": "1", "c_elevator": "1", "c_0": "1"}
    nonlinear: ClassVar[dict[str, str]] = {}

    def at(self, u: Any, _: Any) -> tuple[Array, Array]:
        """A and b."""
        rows = np.stack([u.alpha, u.q, u.elevator, np.ones_like(u.q)], axis=-1)
        return rows[:, None, :], np.zeros((len(u.q), 1))


class Pitching(Moment):
    """The same as a derivative: q' of the measured q."""

    outputs: ClassVar = {"q": "rad/s"}


def fly(seed: int, seconds: float = 60.0) -> dict[str, Array]:
    """Alpha and q that an elevator and gusts move, and a coefficient whose noise is coloured."""
    rng = np.random.default_rng(seed)
    time = np.arange(int(seconds * RATE)) / RATE
    elevator = 0.05 * np.sign(np.sin(1.7 * time)) * (np.sin(0.4 * time) > -0.5)
    alpha, q = np.zeros(time.size), np.zeros(time.size)
    for k in range(time.size - 1):
        gust = 0.02 * rng.standard_normal() / np.sqrt(RATE)
        alpha[k + 1] = alpha[k] + (-1.2 * alpha[k] + q[k]) / RATE + gust
        q[k + 1] = q[k] + (-6.0 * alpha[k] - 1.8 * q[k] - 9.0 * elevator[k]) / RATE
    c = -0.5 * alpha - 0.1 * q - 0.8 * elevator + 0.04 + 0.003 * rng.standard_normal(time.size)
    return {"time": time, "alpha": alpha + 0.1, "q": q, "elevator": elevator, "c": c}


def over_band(time: Array, A: Array, z: Array, forgetting: float) -> tuple[Array, Array]:
    """Estimates and standard deviations of complex least squares without lines in time."""
    fade = forgetting ** (0.5 * np.arange(time.size)[::-1])
    wave = fade * np.exp(-2j * np.pi * np.outer(FREQUENCIES, time - time[0]))
    X = wave @ np.column_stack([A - A[0], z - z[0]])
    line = wave @ np.column_stack([np.ones(time.size), time - time[0]])
    parts, ends = np.vstack([X.real, X.imag]), np.vstack([line.real, line.imag])
    there = np.linalg.norm(ends, axis=0) > 1e-9 * time.size  # none of 1 at multiples of 1 / length
    ends = ends[:, there] / np.linalg.norm(ends[:, there], axis=0)
    parts -= ends @ np.linalg.lstsq(ends, parts, rcond=None)[0]
    squares, fourths = np.sum(fade**2), np.sum(fade**4)
    lasts = squares**2 / fourths * (time[-1] - time[0]) / (time.size - 1)
    shared = max(1.0, 1.0 / (0.05 * lasts))
    xi = np.linalg.lstsq(parts[:, :-1], parts[:, -1], rcond=None)[0]
    left = parts[:, -1] - parts[:, :-1] @ xi
    dof = 2 * FREQUENCIES.size / shared - 2 - xi.size
    covariance = np.linalg.inv(parts[:, :-1].T @ parts[:, :-1]) * (left @ left) / dof
    return xi, np.sqrt(np.diag(covariance))


@pytest.mark.parametrize("forgetting", [1.0, 0.998])
def test_recursive_transform_is_numpys_least_squares_of_all_rows(forgetting: float) -> None:
    data = fly(1)
    track = sepcal.track(Moment(), data, start_rows=500, method="rft", forgetting=forgetting)
    assert track.rows[0] == 500
    for at in (600, 1500, 2999):
        rows = slice(0, at + 1)
        A = np.column_stack([data["alpha"], data["q"], data["elevator"]])[rows]
        xi, deviation = over_band(data["time"][rows], A, data["c"][rows], forgetting)
        # The constant spends one number of the parts that are left over, and brings one.
        assert track.estimates[at - 500, :3] == pytest.approx(xi, rel=1e-8)
        assert track.standard_deviations[at - 500, :3] == pytest.approx(deviation, rel=1e-6)
        weight = forgetting ** (0.5 * np.arange(at + 1)[::-1])
        constant = np.average(data["c"][rows] - A @ xi, weights=weight)
        assert track["c_0"][at - 500] == pytest.approx(constant, rel=1e-8)


def test_a_derivative_is_taken_in_the_band() -> None:
    """What Euler's steps are over the band: q' of this flight is a difference of first order."""
    data = fly(2)
    track = sepcal.track(Pitching(), data, start_rows=100, method="rft", differentiate=True)
    off = (track.estimates[-1, :3] - [-6.0, -1.8, -9.0]) / [6.0, 1.8, 9.0]
    assert np.abs(off).max() < 0.1
    assert np.isnan(track.innovations).all()


def test_intervals_over_a_band_hold_in_flights_whose_noise_is_white() -> None:
    held = []
    for seed in range(100):
        data = fly(100 + seed, 30.0)
        track = sepcal.track(Moment(), data, start_rows=200, method="rft")
        error = track.estimates[-1] - [-0.5, -0.1, -0.8, 0.04 + 0.5 * 0.1]
        held.append(np.abs(error) < 1.96 * track.standard_deviations[-1])
    # 400 intervals of three correlated parameters and a constant: four deviations of chance.
    assert 0.95 - 4 * 0.016 <= np.mean(held) <= 0.95 + 4 * 0.016


def fortescue(A: Array, z: Array, start: Array, R: Array, noise: float, memory: float) -> Array:
    """Recursive least squares whose memory follows the innovations, (rows, k)."""
    P, xi, out = np.linalg.inv(R.T @ R), start.copy(), []
    by = 1.0 - 1.0 / memory
    for row, reading in zip(A, z, strict=True):
        P = P / by
        S = row @ P @ row + noise**2
        e = reading - row @ xi
        gain = P @ row / S
        xi, P = xi + gain * e, P - np.outer(gain, row @ P)
        by = 1.0 - min(e**2 / S, 9.0) / memory
        out.append(xi.copy())
    return np.array(out)


@pytest.mark.parametrize("method", ["rls", "ekf", "srif"])
def test_memory_is_fortescues(method: str) -> None:
    data = fly(3)
    data["c"][1500:] -= 0.4 * data["alpha"][1500:]
    first = {name: column[:1000] for name, column in data.items()}
    fit = sepcal.fit(Moment(), first)
    track = sepcal.track(Moment(), data, start_rows=1000, method=method, memory=200)
    A = np.column_stack([data["alpha"], data["q"], data["elevator"], np.ones(3000)])
    noise = fit.rmse["c"] * np.sqrt(1000 / 996)
    T = np.linalg.qr(A[:1000] / noise, mode="r")
    start = np.linalg.lstsq(A[:1000], data["c"][:1000], rcond=None)[0]
    expected = fortescue(A[1000:], data["c"][1000:], start, T, noise, 200.0)
    unit = np.abs(expected).max(axis=0)
    assert np.abs((track.estimates - expected) / unit).max() < 1e-6
    assert abs(track["c_alpha"][-1] + 0.9) < 0.05


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"memory": 5}, "give 20 or more"),
        ({"memory": 100, "forgetting": 0.9}, "leave forgetting out"),
        ({"memory": 100, "method": "rft"}, "take forgetting"),
        ({"differentiate": True}, "of rft alone"),
        ({"method": "rft", "walk": {"c_q": 0.1}}, "of ekf, iekf and srif"),
        ({"method": "rft", "band": (2, 1)}, "Hz is none"),
        ({"method": "rft", "differentiate": True, "fix": {"c_0": 1.0}}, "no b"),
    ],
)
def test_what_cant_be_is_said(options: dict[str, Any], says: str) -> None:
    with pytest.raises(sepcal.Error, match=says):
        sepcal.track(Moment(), fly(4, 30.0), start_rows=700, **options)


def test_a_model_that_bends_isnt_followed_over_a_band() -> None:
    flight = sepcal.datasets.load("pitot")
    base = sepcal.fit(sepcal.PitotStatic(), flight)
    with pytest.raises(sepcal.Error, match="linear in their parameters"):
        base.track(start_rows=300, method="rft")
