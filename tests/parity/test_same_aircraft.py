# SPDX-License-Identifier: BSD-3-Clause
"""Equations of motion and flight path reconstruction on a flight that JSBSim flew."""

import json
from pathlib import Path

import numpy as np
import pytest

from oracle import jsbsim_flight
from parity.programs import BUILD, run

FOOT = jsbsim_flight.FOOT
PROGRAM = BUILD / "tests" / "aircraft_record"
AREA, CHORD, SPAN = 174 * FOOT**2, 4.9 * FOOT, 35.8 * FOOT
GRAVITY = 9.798  # m/s^2, effective: JSBSim's gravitation less what the Earth's turning takes off

Columns = dict[str, np.ndarray]


@pytest.fixture(scope="module")
def flight() -> Columns:
    """The flight's columns."""
    pytest.importorskip("jsbsim", reason="jsbsim isn't installed")
    return jsbsim_flight.fly()


def write(file: Path, columns: Columns) -> Path:
    """A record as the program reads it."""
    rows = [" ".join(repr(float(x)) for x in row) for row in zip(*columns.values(), strict=True)]
    file.write_text("\n".join([" ".join(columns), *rows]) + "\n")
    return file


def test_equations_of_motion(flight: Columns, tmp_path: Path) -> None:
    """S 6.16 to 6.18 to 0.07 ft/s^2 in the median, 6.19 to 0.2 % of the rms."""
    geometry = {
        "area_m2": AREA, "chord_m": CHORD, "span_m": SPAN, "mass_kg": float(flight["mass"][0]),
        "inertia_kgm2": [float(np.mean(flight[name])) for name in ("Ix", "Iy", "Iz", "Ixz")],
        "rate_reference": "c/2V",
    }  # fmt: skip
    aircraft = tmp_path / "aircraft.json"
    aircraft.write_text(json.dumps(geometry))
    force = 0.5 * flight["rho"] * flight["airspeed"] ** 2 * AREA
    states = ("u", "v", "w", "p", "q", "r", "phi", "theta", "psi")
    columns = {name: flight[name] for name in (*states, "rho", "mass")}
    for name, axis in zip(("CX", "CY", "CZ"), ("fx", "fy", "fz"), strict=True):
        columns[name] = flight[axis] / force
    moments = zip(("Cl", "Cm", "Cn"), ("roll", "pitch", "yaw"), (SPAN, CHORD, SPAN), strict=True)
    for name, axis, arm in moments:
        columns[name] = flight[f"{axis}_moment"] / (force * arm)
    printed = run(PROGRAM, "rates", aircraft, write(tmp_path / "record.txt", columns))
    rates = np.array([line.split() for line in printed.splitlines()], dtype=float)
    for i, name in enumerate(("udot", "vdot", "wdot")):
        residual = np.median(np.abs(rates[:, i] - flight[name])) / FOOT
        print(f"{name}: median residual {residual:.4f} ft/s^2")
        assert residual <= 0.07
    for i, name in enumerate(("pdot", "qdot", "rdot"), start=3):
        residual = np.sqrt(np.mean((rates[:, i] - flight[name]) ** 2))
        share = residual / np.sqrt(np.mean(flight[name] ** 2))
        print(f"{name}: rms residual {100 * share:.3f} % of its rms")
        assert share <= 0.002


def test_flight_path_finds_the_errors_of_the_sensors(flight: Columns, tmp_path: Path) -> None:
    """Noise-free: what was put into the readings comes out."""
    truth = {
        "b_ax": 0.15, "b_ay": -0.1, "b_az": 0.2, "b_p": 2e-3, "b_q": -3e-3, "b_r": 1.5e-3,
        "lambda_v": 0.03, "b_v": 0.5, "lambda_beta": 0.05, "b_beta": 0.003,
        "lambda_alpha": -0.08, "b_alpha": 0.01,
    }  # fmt: skip
    columns = {"time": flight["time"]}
    for axis in "xyz":
        columns[f"a{axis}"] = flight[f"f{axis}"] / flight["mass"] - truth[f"b_a{axis}"]
    for axis in "pqr":
        columns[axis] = flight[f"{axis}_inertial"] - truth[f"b_{axis}"]
    for name, short in (("airspeed", "v"), ("beta", "beta"), ("alpha", "alpha")):
        columns[name] = (1 + truth[f"lambda_{short}"]) * flight[name] + truth[f"b_{short}"]
    columns |= {"roll": flight["phi"], "pitch": flight["theta"]}
    columns["yaw"] = np.unwrap(flight["psi"])
    printed = run(PROGRAM, "path", str(GRAVITY), write(tmp_path / "record.txt", columns))
    found = {name: float(value) for name, value, _ in map(str.split, printed.splitlines())}
    for name, value in truth.items():
        print(f"{name}: {found[name]:.5f} of {value}")
    limits = {"b_a": 0.006, "b_p": 1e-4, "b_q": 1e-4, "b_r": 1e-4, "lambda": 0.012, "b_v": 0.15}
    for start, limit in limits.items():
        for name in (name for name in truth if name.startswith(start) and name[:7] != "b_alpha"):
            assert abs(found[name] - truth[name]) <= limit, name
