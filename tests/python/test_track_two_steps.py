# SPDX-License-Identifier: BSD-3-Clause
"""Both steps in flight: the path by a filter, the coefficients where it says the aircraft is."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import sepcal
from apps import run

AIRCRAFT = sepcal.Aircraft(
    area=16.2, chord=1.49, span=10.9, mass=1100.0, inertia=(1285.0, 1825.0, 2667.0, 0.0)
)
EQUATIONS = {"Cm": ["1", "alpha", "q_hat", "elevator"]}
TERMS = ("Cm_0", "Cm_alpha", "Cm_q", "Cm_elevator")


@cache
def flown(seed: int) -> tuple[sepcal.Flight, sepcal.TwoSteps]:
    flight = sepcal.simulate(AIRCRAFT, rows=3000, seed=seed)
    return flight, sepcal.two_step(flight, AIRCRAFT, equations=EQUATIONS)


@pytest.mark.parametrize("second", ["rls", "ekf", "srif", "rft"])
def test_coefficients_come_out_where_the_flight_has_them(second: str) -> None:
    flight, _ = flown(5)
    track = flown(6)[1].track(flight, second=second)
    for name in TERMS:
        off = track[name][-1] - flight.truth[name]
        # Errors of the regressors bias them by a per cent or so, which no interval holds.
        most = 4 * track.standard_deviation(name)[-1] + 0.02 * abs(flight.truth[name])
        assert abs(off) < most, name
    assert abs(track["b_q"][-1] - flight.truth["b_q"]) < 4 * track.standard_deviation("b_q")[-1]


def test_recursive_least_squares_are_numpys_on_what_the_path_filter_says() -> None:
    """Coefficients again, from the filter's states and biases, in NumPy."""
    flight, _ = flown(5)
    before = flown(6)[1]
    track = before.track(flight)
    u, v, w = (track[name] for name in ("u", "v", "w"))
    speed, alpha = np.sqrt(u**2 + v**2 + w**2), np.arctan2(w, u)
    time = track.time
    rates = {
        axis: np.asarray(flight[f"{axis}_radps"])[track.rows] + track[f"b_{axis}"] for axis in "pqr"
    }
    qdot = _cubic(rates["q"], 7) / np.median(np.diff(time))
    qbar = 0.5 * np.asarray(flight["rho_kgpm3"])[track.rows] * speed**2
    Ix, Iy, Iz, _ = (1285.0, 1825.0, 2667.0, 0.0)
    moment = Iy * qdot + (Ix - Iz) * rates["p"] * rates["r"]
    Cm = moment / (qbar * 16.2 * 1.49)
    q_hat = rates["q"] * 1.49 / (2 * speed)
    elevator = np.asarray(flight["elevator_rad"])[track.rows]
    A = np.column_stack([np.ones(u.size), alpha, q_hat, elevator])
    aero = before.aero
    start = np.array([aero[name].value for name in TERMS])
    information = np.linalg.inv(aero.covariance)
    noise = aero.rmse["Cm"]
    normal = information + A.T @ A / noise**2
    xi = np.linalg.solve(normal, information @ start + A.T @ Cm / noise**2)
    ours = np.array([track[name][-1] for name in TERMS])
    deviation = np.sqrt(np.diag(np.linalg.inv(normal)))
    assert np.abs((ours - xi) / deviation).max() < 0.5  # slopes at the maneuvers' ends are others
    assert [track.standard_deviation(name)[-1] for name in TERMS] == pytest.approx(
        deviation, rel=0.05
    )


def _cubic(values: np.ndarray, rows: int) -> np.ndarray:
    """Slopes a row of local cubics over so many rows, one-sided at the ends."""
    out = np.empty(values.size)
    for k in range(values.size):
        first = min(max(k - rows // 2, 0), max(values.size - rows, 0))
        at = np.arange(first, min(first + rows, values.size))
        fit = np.polynomial.polynomial.polyfit(at - k, values[at], min(3, at.size - 1))
        out[k] = fit[1]
    return out


@pytest.mark.slow
def test_a_mini_batch_begins_both_steps() -> None:
    flight, steps = flown(5)
    long = sepcal.simulate(AIRCRAFT, rows=6000, seed=7)
    track = steps.track(long, start_rows=4000)
    assert track.rows[0] == 4000
    assert abs(track["Cm_alpha"][-1] / long.truth["Cm_alpha"] - 1) < 0.02
    with pytest.raises(sepcal.Error, match="must not count twice"):
        steps.track()
    with pytest.raises(sepcal.Error, match="don't tell both steps"):
        steps.track(start_rows=600)
    with pytest.raises(sepcal.Error, match="take fewer"):
        steps.track(start_rows=len(flight["time_s"]))


def test_the_program_follows_what_two_step_wrote(tmp_path: Path) -> None:
    flight, _ = flown(5)
    before = flown(6)[1]
    (tmp_path / "two.json").write_text(before.to_json())
    _write(flight, tmp_path)
    done = run("sepcal-aircraft", "track", str(tmp_path / "f.csv"), str(tmp_path / "two.json"),
               "--second", "rft", "--band", "0.1:1.5", "-o", str(tmp_path / "t.csv"),
               folder=tmp_path)  # fmt: skip
    assert done.code == 0, done.err
    written = np.genfromtxt(tmp_path / "t.csv", delimiter=",", names=True)
    track = before.track(sepcal.read(tmp_path / "f.csv"), second="rft", band=(0.1, 1.5))
    assert written["Cm_alpha"][-1] == pytest.approx(track["Cm_alpha"][-1], rel=1e-9)
    for options, says in (
        (("--second", "rml"), "is rls, ekf, srif or rft"),
        (("--method", "rls"), "is the path's: ekf, iekf or srif"),
    ):
        refused = run("sepcal-aircraft", "track", str(tmp_path / "f.csv"),
                      str(tmp_path / "two.json"), *options, "-o", str(tmp_path / "u.csv"),
                      folder=tmp_path)  # fmt: skip
        assert refused.code == 2
        assert says in refused.err
        assert refused.err.count("\n") == 1


def _write(flight: sepcal.Flight, folder: Path) -> None:
    columns = {name: np.asarray(flight[name]) for name in flight}
    np.savetxt(folder / "f.csv", np.column_stack(list(columns.values())), "%.17g", ",",
               header=",".join(columns), comments="")  # fmt: skip
