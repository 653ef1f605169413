# SPDX-License-Identifier: BSD-3-Clause
"""What models with a state cost: fits by filter and output error, diagnoses, tracks.

    PYTHONPATH=build/python:lab python -m benchmarks.state_models [CASE ...]

prints seconds of CPU, how a fit ended, and how far its answer is from that of another build
(--answers there, --against here). --instructions counts instructions by valgrind instead, as many
on a busy machine as on a quiet one.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np

import sepcal

GRAVITY = 9.80665  # m/s^2


class Jet:
    """A jet's longitudinal motion: 4 states, 7 outputs, 11 coefficients."""

    inputs: ClassVar = {"elevator": "rad", "thrust": "N"}
    states: ClassVar = {"V": "m/s", "alpha": "rad", "theta": "rad", "q": "rad/s"}
    outputs: ClassVar = {
        "V_m": "m/s",
        "alpha_m": "rad",
        "theta_m": "rad",
        "q_m": "rad/s",
        "qdot_m": "rad/s^2",
        "ax_m": "m/s^2",
        "az_m": "m/s^2",
    }
    linear: ClassVar[dict[str, str]] = {}
    nonlinear: ClassVar = {
        "CD0": ("1", 0, 0.5),
        "CDV": ("1", -0.5, 0.5),
        "CDa": ("1", 0, 1),
        "CL0": ("1", -1, 1),
        "CLV": ("1", -0.5, 0.5),
        "CLa": ("1", 2, 8),
        "Cm0": ("1", -0.5, 0.5),
        "CmV": ("1", -0.5, 0.5),
        "Cma": ("1", -3, 0),
        "Cmq": ("1", -60, 0),
        "Cmde": ("1", -3, 0),
    }
    noise: ClassVar = {"V": "m/s/sqrt(s)", "alpha": "rad/sqrt(s)", "q": "rad/s/sqrt(s)"}
    MASS, AREA, CHORD, IY, ARM, V0, RHO = 7500.0, 30.0, 2.4, 50000.0, 0.3, 105.0, 0.79
    TRUTH = np.array([0.12, -0.06, 0.32, -0.09, 0.15, 4.3, 0.11, 0.004, -0.97, -34.7, -1.53])
    NOISE = (0.4, 0.004, 0.004)
    READINGS = (0.1, 0.001, 0.0008, 0.0008, 0.004, 0.03, 0.08)
    START = (106.0, 0.11, 0.1, 0.0)

    def _forces(self, x: np.ndarray, u: SimpleNamespace, p: np.ndarray) -> tuple[Any, ...]:
        V, alpha, _, q = x
        CD0, CDV, CDa, CL0, CLV, CLa, Cm0, CmV, Cma, Cmq, Cmde = p
        v = V / self.V0
        pressure = 0.5 * self.RHO * V * V * self.AREA
        CD = CD0 + CDV * v + CDa * alpha
        CL = CL0 + CLV * v + CLa * alpha
        Cm = Cm0 + CmV * v + Cma * alpha + Cmq * q * self.CHORD / (2 * self.V0) + Cmde * u.elevator
        moment = pressure * self.CHORD * Cm + u.thrust * self.ARM
        return pressure * CD, pressure * CL, moment / self.IY

    def rate(self, x: np.ndarray, u: SimpleNamespace, p: np.ndarray) -> list[np.ndarray]:
        """Of the states."""
        V, alpha, theta, q = x
        D, L, turn = self._forces(x, u, p)
        return [
            -D / self.MASS + u.thrust / self.MASS * np.cos(alpha) + GRAVITY * np.sin(alpha - theta),
            (-L - u.thrust * np.sin(alpha)) / (self.MASS * V)
            + q
            + GRAVITY / V * np.cos(alpha - theta),
            q,
            turn,
        ]

    def at(
        self, x: np.ndarray, u: SimpleNamespace, p: np.ndarray
    ) -> tuple[np.ndarray, list[np.ndarray]]:
        """What is read."""
        V, alpha, theta, q = x
        D, L, turn = self._forces(x, u, p)
        s, c = np.sin(alpha), np.cos(alpha)
        ax = (L * s - D * c + u.thrust) / self.MASS
        az = (-L * c - D * s) / self.MASS
        return np.empty((7, 0)), [V, alpha, theta, q, turn, ax, az]

    def start(self, u: SimpleNamespace, z: np.ndarray) -> np.ndarray:
        """Where readings begin."""
        return z[:4]


def fly_jet(rows: int, seed: int) -> dict[str, np.ndarray]:
    """60 s at 10 Hz in turbulence, integrated in steps of 10 ms."""
    rng = np.random.default_rng(seed)
    model, dt, finer = Jet(), 0.1, 10
    t = dt * np.arange(rows)
    elevator = 0.02 * np.sign(np.sin(2 * np.pi * t / 6.0)) * (t % 20 < 9) - 0.022
    thrust = 11000.0 + 1500.0 * ((t > 20) & (t < 40))
    x = np.array(Jet.START)
    z = np.empty((7, rows))
    for k in range(rows):
        z[:, k] = model.at(x, SimpleNamespace(elevator=elevator[k], thrust=thrust[k]), Jet.TRUTH)[1]
        if k + 1 == rows:
            break
        for i in range(finer):
            share = (i + 0.5) / finer
            u = SimpleNamespace(
                elevator=elevator[k] + share * (elevator[k + 1] - elevator[k]),
                thrust=thrust[k] + share * (thrust[k + 1] - thrust[k]),
            )
            h = dt / finer
            half = x + 0.5 * h * np.array(model.rate(x, u, Jet.TRUTH))
            x = x + h * np.array(model.rate(half, u, Jet.TRUTH))
            shake = np.sqrt(h) * np.array(Jet.NOISE) * rng.standard_normal(3)
            x[[0, 1, 3]] += shake
    z += np.array(Jet.READINGS)[:, None] * rng.standard_normal(z.shape)
    return {"time": t, "elevator": elevator, "thrust": thrust} | dict(
        zip(Jet.outputs, z, strict=True)
    )


def fly_aircraft(rows: int, turbulence: float, seed: int = 5) -> sepcal.Flight:
    """The simulated aircraft for 40 s, by so many rows, in gusts of so many m/s."""
    return sepcal.simulate(
        "aircraft", rate=rows / 40.0, seed=seed, truth={"options": {"turbulence": turbulence}}
    )


def longitudinal() -> sepcal.RigidAircraft:
    """Of the simulated aircraft."""
    inertia = (1285.0, 1825.0, 2667.0, 60.0)
    aircraft = sepcal.Aircraft(area=16.2, chord=1.49, span=10.9, mass=1050.0, inertia=inertia)
    return sepcal.RigidAircraft(aircraft, "longitudinal")


def fit(flight: sepcal.Flight, method: str, iterations: int = 100) -> sepcal.AircraftFit:
    """Of the aircraft."""
    return sepcal.fit(longitudinal(), flight, method=method, iterations=iterations)


def fit_jet(flight: dict[str, np.ndarray]) -> sepcal.Fit:
    """Of the jet by filter error, from coefficients that are a fifth off."""
    off = np.where(np.arange(len(Jet.TRUTH)) % 2, 1.2, 0.8)
    start = dict(zip(Jet.nonlinear, off * Jet.TRUTH, strict=True))
    return sepcal.fit(Jet(), flight, method="filter-error", start=start)


Work = Callable[[], Any]  # what is measured


def to_fit_jet(rows: int) -> Work:
    """A fit."""
    flight = fly_jet(rows, 7)
    return lambda: fit_jet(flight)


def to_fit(rows: int, method: str, turbulence: float, iterations: int = 100) -> Work:
    """A fit."""
    flight = fly_aircraft(rows, turbulence)
    return lambda: fit(flight, method, iterations)


def to_diagnose(rows: int, method: str, turbulence: float) -> Work:
    """A diagnosis, of a fit that doesn't count."""
    found = fit(fly_aircraft(rows, turbulence), method)
    return lambda: found.diagnose()


def to_track(method: str) -> Work:
    """2,000 samples of another flight, from a fit that doesn't count."""
    likelihood = method == "rml"
    turbulence = 0.3 if likelihood else 0.0
    flights = [fly_aircraft(rows, turbulence, seed) for rows, seed in ((600, 5), (2000, 6))]
    found = fit(flights[0], "filter-error" if likelihood else "output-error")
    return lambda: found.track(flights[1], method=method)


CASES: dict[str, Callable[[], Work]] = {
    "own-filter-error-600": lambda: to_fit_jet(600),
    "two-steps-600": lambda: to_fit(600, "filter-error", 0.3, iterations=2),
    "filter-error-600": lambda: to_fit(600, "filter-error", 0.3),
    "filter-error-2000": lambda: to_fit(2000, "filter-error", 0.3),
    "filter-error-2000-calm": lambda: to_fit(2000, "filter-error", 0.0),
    "output-error-3000": lambda: to_fit(3000, "output-error", 0.0),
    "output-error-3000-turbulence": lambda: to_fit(3000, "output-error", 0.3),
    "diagnose-filter-error-600": lambda: to_diagnose(600, "filter-error", 0.3),
    "diagnose-output-error-3000": lambda: to_diagnose(3000, "output-error", 0.0),
    "track-ekf-2000": lambda: to_track("ekf"),
    "track-iekf-2000": lambda: to_track("iekf"),
    "track-srif-2000": lambda: to_track("srif"),
    "track-rml-2000": lambda: to_track("rml"),
}


def numbers_of(found: Any) -> dict[str, Any]:  # noqa: ANN401
    """What is held against other answers: values with their standard errors, and words."""
    if hasattr(found, "estimates"):
        last = zip(found.names, found.estimates[-1], found.standard_deviations[-1], strict=True)
        return {"values": {name: [float(value), float(sd)] for name, value, sd in last}}
    if hasattr(found, "verdict"):
        values = {each.name: [each.p_value, 1.0] for each in found.effects}
        return {"said": f"{found.verdict} {found.advice.effect}", "values": values}
    values = {n: [found[n].value, found[n].standard_error] for n in found.parameters}
    said = f"{found.status}, {found.iterations} iterations"
    return {"said": said, "cost": found.cost, "values": values}


def distance(now: dict[str, Any], before: dict[str, Any]) -> float:
    """The largest, in standard errors; what is held has none."""
    largest = 0.0
    for name, (value, _) in now["values"].items():
        there, error = before["values"].get(name, (value, 1.0))
        if error > 0.0:
            largest = max(largest, abs(value - there) / error)
    return largest


def count(case: str, *options: str) -> int:
    """Instructions of a process that runs a case."""
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", sys.executable]
    command += ["-m", "benchmarks.state_models", case, *options]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stderr
    found = re.search(r"Collected : (\d+)", said)
    if not found:
        raise RuntimeError(f"valgrind counted nothing: {said}")
    return int(found[1])


def main() -> int:
    """Runs the cases named, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case", nargs="*", help=", ".join(CASES))
    parser.add_argument("--answers", type=Path, help="a file that answers are written to")
    parser.add_argument("--against", type=Path, help="such a file of another build")
    parser.add_argument("--instructions", action="store_true", help="50 times as long")
    parser.add_argument("--prepare", action="store_true", help="stop before what is measured")
    asked = parser.parse_args()
    for name in asked.case or CASES:
        if asked.instructions:
            millions = (count(name) - count(name, "--prepare")) / 1e6
            print(f"{name:29} {millions:12,.0f} million instructions", flush=True)
            continue
        work = CASES[name]()
        if asked.prepare:
            continue
        begin = time.process_time()
        found = work()
        told = {"seconds": time.process_time() - begin} | numbers_of(found)
        line = f"{name:29} {told['seconds']:8.2f} s  {told.get('said', '')}"
        if asked.against:
            before = json.loads(asked.against.read_text()).get(name)
            if before:
                line += f"; before {before['seconds']:.2f} s, {distance(told, before):.1g} sd off"
        print(line, flush=True)
        if asked.answers:
            known = json.loads(asked.answers.read_text()) if asked.answers.exists() else {}
            asked.answers.write_text(json.dumps(known | {name: told}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
