# SPDX-License-Identifier: BSD-3-Clause
"""A flight path with its position, of a log: nine states, six biases and the wind, by SciPy too."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import least_squares

import apps
import sepcal

Array = NDArray[np.float64]

STEP, ROWS = 0.1, 600  # s
WIND = np.array([6.0, -3.0, 0.4])  # m/s
BIASES = np.array([0.05, -0.08, 0.1, 0.002, -0.001, 0.0015])  # true = reading + b
GRAVITY = 9.80665
OUTPUTS = ("airspeed", "beta", "alpha", "roll", "pitch", "yaw", "north", "east", "down")
NOISE = dict(zip(OUTPUTS, (0.5, 0.004, 0.004, 0.003, 0.003, 0.006, 1.2, 1.2, 2.0), strict=True))
UNITS = ("mps", "rad", "rad", "rad", "rad", "rad", "m", "m", "m")
INERTIAL = ("ax", "ay", "az", "p", "q", "r")
FREE = ("b_ax", "b_ay", "b_az", "b_p", "b_q", "b_r", "w_n", "w_e", "w_d")
STATES = ("u", "v", "w", "phi", "theta", "psi", "x", "y", "z")
HELD = {f"{kind}_{of}": 0.0 for kind in ("lambda", "b")
        for of in ("v", "beta", "alpha", "phi", "theta", "psi")}  # fmt: skip


def to_ned(phi: Array, theta: Array, psi: Array) -> Array:
    """(3, 3, ...) from body axes."""
    s, c = np.sin, np.cos
    return np.array([
        [c(theta) * c(psi), s(phi) * s(theta) * c(psi) - c(phi) * s(psi),
         c(phi) * s(theta) * c(psi) + s(phi) * s(psi)],
        [c(theta) * s(psi), s(phi) * s(theta) * s(psi) + c(phi) * c(psi),
         c(phi) * s(theta) * s(psi) - s(phi) * c(psi)],
        [-s(theta), s(phi) * c(theta), c(phi) * c(theta)],
    ])  # fmt: skip


def rate(x: Array, u: Array, p: Array) -> Array:
    """(9, m): the states' rates, of inertial readings u (6) and parameters p (9, m)."""
    ax, ay, az, roll_rate, pitch_rate, yaw_rate = u[:, None] + p[:6]
    phi, theta, psi = x[3:6]
    turn = (pitch_rate * np.sin(phi) + yaw_rate * np.cos(phi)) / np.cos(theta)
    ground = np.einsum("ij...,j...->i...", to_ned(phi, theta, psi), x[:3]) + p[6:]
    return np.array([
        ax - pitch_rate * x[2] + yaw_rate * x[1] - GRAVITY * np.sin(theta),
        ay - yaw_rate * x[0] + roll_rate * x[2] + GRAVITY * np.sin(phi) * np.cos(theta),
        az - roll_rate * x[1] + pitch_rate * x[0] + GRAVITY * np.cos(phi) * np.cos(theta),
        roll_rate + np.sin(theta) * turn,
        pitch_rate * np.cos(phi) - yaw_rate * np.sin(phi),
        turn,
        *ground,
    ])  # fmt: skip


def integrate(inertial: Array, theta: Array, substeps: int = 4) -> Array:
    """(rows, 9, m): the states, of parameters and initial states theta (18, m)."""
    p, x = theta[:9], theta[9:]
    path = [x]
    for before, after in pairwise(inertial):
        h = STEP / substeps
        for k in range(substeps):
            at = [before + (after - before) * (k + part) / substeps for part in (0.0, 0.5, 1.0)]
            k_1 = rate(x, at[0], p)
            k_2 = rate(x + h / 2 * k_1, at[1], p)
            k_3 = rate(x + h / 2 * k_2, at[1], p)
            k_4 = rate(x + h * k_3, at[2], p)
            x = x + h / 6 * (k_1 + 2 * k_2 + 2 * k_3 + k_4)
        path.append(x)
    return np.array(path)


def outputs_of(path: Array) -> Array:
    """(rows, 9, m) in the order of OUTPUTS."""
    u, v, w = path[:, 0], path[:, 1], path[:, 2]
    speed = np.sqrt(u**2 + v**2 + w**2)
    air = np.stack([speed, np.arcsin(v / speed), np.arctan2(w, u)], axis=1)
    return np.concatenate([air, path[:, 3:]], axis=1)


def wanted(t: Array) -> Array:
    """(6, ...): u v w and the attitude of a flight that turns, climbs and slips."""
    return np.array([
        40 + 3 * np.sin(0.2 * t), 0.8 * np.sin(0.5 * t), 2 + np.sin(0.3 * t),
        0.4 * np.sin(0.25 * t), 0.05 + 0.06 * np.sin(0.4 * t),
        0.3 + 0.1 * t + 0.2 * np.sin(0.15 * t),
    ])  # fmt: skip


def true_inertial() -> Array:
    """(rows, 6): the specific forces and rates that it takes."""
    t = STEP * np.arange(ROWS)
    h = 1e-4
    (u, v, w, phi, theta, _), rates = wanted(t), (wanted(t + h) - wanted(t - h)) / (2 * h)
    p = rates[3] - rates[5] * np.sin(theta)
    q = rates[4] * np.cos(phi) + rates[5] * np.sin(phi) * np.cos(theta)
    r = -rates[4] * np.sin(phi) + rates[5] * np.cos(phi) * np.cos(theta)
    ax = rates[0] + q * w - r * v + GRAVITY * np.sin(theta)
    ay = rates[1] + r * u - p * w - GRAVITY * np.sin(phi) * np.cos(theta)
    az = rates[2] + p * v - q * u - GRAVITY * np.cos(phi) * np.cos(theta)
    return np.stack([ax, ay, az, p, q, r], axis=1)


@pytest.fixture(scope="module")
def log() -> dict[str, Array]:
    """Columns of a log, without velocity."""
    rng = np.random.default_rng(4)
    read = true_inertial() - BIASES
    start = np.concatenate([wanted(np.array(0.0)), [0.0, 0.0, -500.0]])
    true = np.concatenate([BIASES, WIND, start])[:, None]
    flown = outputs_of(integrate(read, true))[..., 0]
    noisy = flown + rng.standard_normal(flown.shape) * list(NOISE.values())
    columns = {"time_s": STEP * np.arange(ROWS)}
    for name, unit, values in zip(INERTIAL, ("mps2",) * 3 + ("radps",) * 3, read.T, strict=True):
        columns[f"{name}_{unit}"] = values
    for name, unit, values in zip(OUTPUTS, UNITS, noisy.T, strict=True):
        columns[f"{name}_{unit}"] = values
    return columns


def in_degrees(log: dict[str, Array]) -> dict[str, Array]:
    """The same log with latitude, longitude and altitude, by series about its first fix."""
    north, east, down = (log[f"{name}_m"] for name in ("north", "east", "down"))
    a, e2, latitude, height = 6378137.0, 6.69437999014e-3, np.radians(47.0), 500.0
    w = 1 - e2 * np.sin(latitude) ** 2
    meridian, normal = a * (1 - e2) / w**1.5 + height, a / np.sqrt(w) + height
    at = latitude + (north - north[0]) / meridian
    middle = 0.5 * (latitude + at)
    columns = {name: values for name, values in log.items() if not name.endswith("_m")}
    columns["lat_deg"] = np.degrees(at)
    columns["lon_deg"] = 11.0 + np.degrees((east - east[0]) / (normal * np.cos(middle)))
    columns["altitude_m"] = height - (down - down[0])
    return columns


@pytest.fixture(scope="module")
def fitted(log: dict[str, Array]) -> sepcal.AircraftFit:
    path = sepcal.FlightPath(position=True, substeps=4)
    return sepcal.fit(path, sepcal.Flight(log), fix=HELD, noise=NOISE)


@pytest.mark.slow
def test_estimates_and_errors_are_those_of_scipy(
    log: dict[str, Array], fitted: sepcal.AircraftFit
) -> None:
    names = [*FREE, *(f"{state}_0" for state in STATES)]
    inertial = np.stack([values for name, values in log.items() if name.split("_")[0] in INERTIAL])
    measured = np.stack([log[f"{n}_{u}"] for n, u in zip(OUTPUTS, UNITS, strict=True)], axis=1)
    weights = 1 / np.array(list(NOISE.values()))

    def residuals(theta: Array) -> Array:
        expected = outputs_of(integrate(inertial.T, theta.reshape(18, -1)))
        return np.asarray(((measured[..., None] - expected) * weights[:, None]).reshape(
            -1, theta.size // 18))  # fmt: skip

    sizes = np.array([fitted[name].standard_error_white for name in names])

    def jacobian(theta: Array) -> Array:
        steps = np.diag(0.05 * sizes)
        ends = residuals(np.concatenate([theta[:, None] + steps, theta[:, None] - steps], axis=1))
        return np.asarray((ends[:, :18] - ends[:, 18:]) / (0.1 * sizes))

    first = measured[0]
    start = [first[0] * np.cos(first[2]), first[0] * first[1], first[0] * np.sin(first[2])]
    theta = np.concatenate([np.zeros(9), start, first[3:]])
    found = least_squares(lambda x: residuals(x)[:, 0], theta, jacobian, x_scale=sizes, xtol=1e-12)
    estimates = np.array([fitted[name].value for name in names])
    np.testing.assert_array_less(np.abs(estimates - found.x) / sizes, 1e-3)
    errors = np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac)))
    np.testing.assert_allclose(sizes, errors, rtol=1e-3)
    for name, true in zip(FREE, [*BIASES, *WIND], strict=True):
        assert abs(fitted[name].value - true) < 4 * fitted[name].standard_error, name


def test_fixes_in_degrees_are_the_same_positions(
    log: dict[str, Array], fitted: sepcal.AircraftFit
) -> None:
    flight = sepcal.Flight(in_degrees(log))
    again = sepcal.fit(sepcal.FlightPath(position=True, substeps=4), flight, fix=HELD, noise=NOISE)
    assert "vn" not in again.rmse  # made of the same fixes: they would count twice
    assert any("metres from the first fix" in note for note in again.notes)
    for name in FREE:
        off = abs(again[name].value - fitted[name].value)
        assert off < 0.05 * fitted[name].standard_error, name
    alone = sepcal.fit(sepcal.FlightPath(), flight)
    assert "vn" in alone.rmse
    assert "north" not in alone.rmse


def test_a_filter_follows_eighteen_states(
    log: dict[str, Array], fitted: sepcal.AircraftFit
) -> None:
    track = fitted.track(start_rows=200, noise=NOISE, process_noise={"ax": 1e-4})
    assert {"x", "y", "z", "w_n", "b_ax"} <= set(track.names)
    last = [track[name][-1] - true for name, true in zip(("w_n", "w_e"), WIND, strict=False)]
    sd = [track.standard_deviation(name)[-1] for name in ("w_n", "w_e")]
    np.testing.assert_array_less(np.abs(last), 4 * np.array(sd))
    north = track["x"] - log["north_m"][200:]
    assert np.std(north) < 1.2 * NOISE["north"]


def test_the_command_does_what_python_does(
    tmp_path: Path, log: dict[str, Array], fitted: sepcal.AircraftFit
) -> None:
    header = ",".join(log)
    np.savetxt(
        tmp_path / "log.csv",
        np.stack(list(log.values()), axis=1),
        "%.17g",
        ",",
        header=header,
        comments="",
    )
    held = [f"--fix={name}=0" for name in HELD if name not in ("b_v", "b_alpha", "b_psi")]
    noise = [f"--noise={name}={size}" for name, size in NOISE.items()]
    made = apps.run(
        "sepcal-aircraft", "fit", "log.csv", "--model", "path", "--position", "--substeps", "4",
        *held, *noise, "-o", "fit.json", folder=tmp_path,
    )  # fmt: skip
    assert made.code == 0, made.err
    stored = json.loads((tmp_path / "fit.json").read_text())
    for name in FREE:
        assert stored["parameters"][name]["value"] == pytest.approx(fitted[name].value, abs=1e-9)
    made = apps.run(
        "sepcal-aircraft", "apply", "log.csv", "fit.json", "-o", "out.csv", folder=tmp_path
    )
    assert made.code == 0, made.err
    with (tmp_path / "out.csv").open() as lines:
        columns = next(lines).strip().split(",")
    assert {"x_m", "y_m", "z_m", "north_model_m"} <= set(columns)


def test_fixes_slower_than_the_log_are_told_of(log: dict[str, Array]) -> None:
    columns = dict(log)
    slow = np.arange(ROWS) % 5 != 0
    for name in ("north_m", "east_m", "down_m"):
        columns[name] = np.where(slow, np.nan, log[name])
    flight = sepcal.Flight(columns)
    path = sepcal.FlightPath(position=True, substeps=4)
    with pytest.raises(sepcal.Error, match="filter error takes the readings that are there"):
        sepcal.fit(path, flight, fix=HELD, noise=NOISE)
    given = dict(zip(INERTIAL, (1e-3,) * 3 + (1e-4,) * 3, strict=True))
    fit = sepcal.fit(
        path, flight, fix=HELD, noise=NOISE, method="filter-error", process_noise=given
    )
    for name, true in zip(FREE, [*BIASES, *WIND], strict=True):
        assert abs(fit[name].value - true) < 4 * fit[name].standard_error, name
