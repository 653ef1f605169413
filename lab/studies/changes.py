# SPDX-License-Identifier: BSD-3-Clause
"""What changes in flight: is it said in time, is it named rightly, and are false alarms rare?

A short period in Dryden's vertical gusts, which are no white noise, its sensors quantised and with
spikes: at 30 s Ma and Md halve within 0.1 s, or the vane bends by 0.02 rad. A Pitot-static tube
circles in gusts and ices at 60 s: it reads 30 % less within half a second. The filter begins with
20 s of first rows (the tube with another flight's calibration), and its noise is what a user would
compute of the gusts' spectrum; along the tube's path they are a wind that walks.
Ma alone halves, and Mq falls to a third: large jumps, behind which estimates are asked for too.
Beside it the same filter without the test, with a memory that follows its innovations, recursive
maximum likelihood that forgets, and the recursive Fourier transform of q' = Ma alpha + Mq q + Md
elevator, which knows of no gusts.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm, solve_continuous_lyapunov

import sepcal
from studies.study import Finding, Outcome, Progress, Study, seed_range, seeds

Array = NDArray[np.float64]

SEEDS = 100  # flights of each kind
AT, SPAN, QUIET = 30.0, 65.0, 600.0  # s: of the change, and how long the flights are
WITHIN = 5.0  # s
AFTER = (10.0, 30.0)  # s
NAMED, COVERED = 0.9, (0.90, 0.98)
ALARMS_AN_HOUR = 1.0

RATE = 50
AIRSPEED = 60.0  # m/s
GUST, LENGTH = 0.7, 150.0  # m/s rms, m
SPIKES = 1e-3  # of the readings
TRUTH = {"Za": -1.2, "Ma": -6.0, "Mq": -1.8, "Zd": -0.12, "Md": -9.0}
LEFT = {
    "halve": {"Ma": 0.5, "Md": 0.5},
    "Ma halves": {"Ma": 0.5},
    "Mq to a third": {"Mq": 1.0 / 3.0},
}  # of the parameters
NOISE = {"alpha_m": 0.005, "q_m": 0.01, "az_m": 0.15}
STEP = {"alpha_m": 1e-3, "q_m": 2e-3, "az_m": 0.02}  # of the converters
BIAS = {"alpha_m": 0.003, "q_m": -0.004, "az_m": 0.1}
WIND_WALK = {"w_n": 0.15, "w_e": 0.15}  # of the gusts along the tube's path, about 8 s long
DENSITY = GUST / AIRSPEED * np.sqrt(3.0 * AIRSPEED / LENGTH)  # of alpha' by gusts, high up


def gusts(rng: np.random.Generator, steps: int, dt: float, speed: float) -> Array:
    """Dryden's vertical or lateral gusts [m/s], rms GUST, (steps,)."""
    T = LENGTH / speed
    A = np.array([[0.0, 1.0], [-1.0 / T**2, -2.0 / T]])
    stationary = solve_continuous_lyapunov(A, -np.diag([0.0, 1.0]))
    C = np.array([1.0, np.sqrt(3.0) * T])
    C *= GUST / np.sqrt(C @ stationary @ C)
    Phi = expm(A * dt)
    root = np.linalg.cholesky(stationary - Phi @ stationary @ Phi.T + 1e-16 * np.eye(2))
    noise = rng.standard_normal((steps, 2)) @ root.T
    x = np.linalg.cholesky(stationary) @ rng.standard_normal(2)
    out = np.empty(steps)
    for k in range(steps):
        out[k] = C @ x
        x = Phi @ x + noise[k]
    return out


def deflect(rng: np.random.Generator, time: Array) -> Array:
    """The elevator [rad]: a 3-2-1-1 of its own pace every 6 s, on a slow drift."""
    elevator = 1e-4 * np.cumsum(rng.standard_normal(time.size))
    for start in np.arange(0.5, time[-1], 6.0):
        step, sign = rng.uniform(0.25, 0.4), rng.choice([-1.0, 1.0])
        for k, (begin, length) in enumerate(((0, 3), (3, 2), (5, 1), (6, 1))):
            during = (time >= start + begin * step) & (time < start + (begin + length) * step)
            elevator[during] = sign * (-1) ** k * 0.04
    return elevator


def read(rng: np.random.Generator, true: Array, noise: float, step: float) -> Array:
    """White noise, spikes and a converter's steps."""
    reading = true + noise * rng.standard_normal(true.size)
    spikes = rng.random(true.size) < SPIKES
    reading[spikes] += noise * rng.uniform(5, 20, spikes.sum()) * rng.choice([-1, 1], spikes.sum())
    return np.asarray(step * np.round(reading / step))


@dataclass
class Flown:
    """A flight, and its parameters row by row."""

    data: dict[str, Array]
    truth: dict[str, Array]


def fly(seed: int, kind: str, span: float) -> Flown:
    """The short period, by four steps of Heun's a row."""
    rng = np.random.default_rng([seed, len(kind)])
    time = np.arange(int(span * RATE)) / RATE
    elevator = deflect(rng, time)
    parts = 4
    h = 1.0 / RATE / parts
    gust = gusts(rng, parts * time.size + 1, h, AIRSPEED) / AIRSPEED
    since = np.clip((time - AT) / 0.1, 0.0, 1.0)
    left = {name: LEFT[kind].get(name, 1.0) if kind in LEFT else 1.0 for name in TRUTH}
    p = {name: value * (1.0 - (1.0 - left[name]) * since) for name, value in TRUTH.items()}
    states = np.empty((time.size, 2))
    alpha, q = 0.0, 0.0
    for k in range(time.size):
        states[k] = alpha, q
        Za, Ma, Mq, Zd, Md = (p[name][k] for name in TRUTH)
        slope = elevator[min(k + 1, time.size - 1)] - elevator[k]
        for part in range(parts):
            e = elevator[k] + slope * (part + 0.5) / parts
            here, there = gust[parts * k + part], gust[parts * k + part + 1]
            da, dq = Za * (alpha + here) + q + Zd * e, Ma * (alpha + here) + Mq * q + Md * e
            a, b = alpha + h * da + there, q + h * dq
            alpha += h * (da + Za * a + b + Zd * e) / 2
            q += h * (dq + Ma * a + Mq * b + Md * e) / 2
    alphas = states[:, 0] + gust[::parts][: time.size]
    b_alpha = BIAS["alpha_m"] + 0.02 * np.clip((time - AT) / 0.1, 0.0, 1.0) * (kind == "vane")
    force = AIRSPEED * (p["Za"] * alphas + p["Zd"] * elevator)
    true = {
        "alpha_m": alphas + b_alpha,
        "q_m": states[:, 1] + BIAS["q_m"],
        "az_m": force + BIAS["az_m"],
    }
    readings = {name: read(rng, z, NOISE[name], STEP[name]) for name, z in true.items()}
    airspeed = np.full(time.size, AIRSPEED)
    data = {"time": time, "elevator": elevator, "airspeed": airspeed, **readings}
    return Flown(data, {**p, "b_alpha": b_alpha})


def track(flown: Flown, method: str = "ekf", **how: Any) -> sepcal.Track:  # noqa: ANN401
    """From 20 s of first rows."""
    if method == "ekf":
        how |= {"noise": NOISE, "process_noise": {"alpha": DENSITY}}
    return sepcal.track(
        sepcal.ShortPeriod(), flown.data, start_rows=20 * RATE, method=method, **how
    )


class Pitching:
    """q' of the pitching moment, from q itself."""

    inputs: ClassVar = {"alpha_m": "rad", "elevator": "rad", "q": "rad/s"}
    outputs: ClassVar = {"q_m": "rad/s"}
    linear: ClassVar = {"Ma": "1/s^2", "Mq": "1/s", "Md": "1/s^2", "c": "rad/s^2"}
    nonlinear: ClassVar[dict[str, str]] = {}

    def at(self, u: Any, _: Any) -> tuple[Array, Array]:  # noqa: ANN401
        """A and b."""
        rows = np.stack([u.alpha_m, u.q, u.elevator, np.ones_like(u.q)], axis=-1)
        return rows[:, None, :], np.zeros((len(u.q), 1))


def track_in_band(flown: Flown) -> sepcal.Track:
    """The recursive Fourier transform, its memory ten seconds long."""
    data = {**flown.data, "q": flown.data["q_m"]}
    return sepcal.track(
        Pitching(),
        data,
        start_rows=20 * RATE,
        method="rft",
        differentiate=True,
        forgetting=1.0 - 1.0 / (10 * RATE),
    )


def circle(seed: int, ices: bool, span: float) -> sepcal.Flight:
    """A tube on an aircraft that circles, with gusts along its path that nothing else measures."""
    rng = np.random.default_rng([seed, 77])
    time = np.arange(int(20 * span)) / 20.0
    speed = 20.0 + 2.0 * np.sin(0.17 * time + rng.uniform(0, 6))
    yaw = rng.uniform(0, 6) + np.cumsum(0.15 + 0.05 * np.sin(0.05 * time)) / 20.0
    scale = 0.95 * (1.0 - 0.3 * np.clip((time - 2 * AT) / 0.5, 0.0, 1.0) * ices)
    gust = 0.3 / GUST * gusts(rng, time.size, 0.05, 20.0)
    columns = {
        "time_s": time,
        "airspeed_mps": read(rng, scale * (speed + gust) + 0.4, 0.2, 0.01),
        "vn_mps": speed * np.cos(yaw) + 4.0,
        "ve_mps": speed * np.sin(yaw) - 3.0,
        "vd_mps": np.zeros(time.size),
        "roll_rad": np.zeros(time.size),
        "pitch_rad": np.zeros(time.size),
        "yaw_rad": np.arctan2(np.sin(yaw), np.cos(yaw)),
    }
    return sepcal.Flight(columns, name=f"circle {seed}")


def track_tube(seed: int, ices: bool, span: float) -> sepcal.Track:
    """Its wind found in 60 s of first rows, all else another flight's."""
    base = sepcal.fit(sepcal.PitotStatic(), circle(seed + 10_000, False, 200.0))
    return base.track(
        circle(seed, ices, span),
        start_rows=400,
        own=["w_n", "w_e"],
        changes="follow",
        walk=WIND_WALK,
    )


@dataclass
class Tally:
    """Of one kind of change."""

    said: int = 0
    named: int = 0
    exactly: int = 0
    delays: list[float] | None = None


def judge(tracked: sepcal.Track, right: set[str], at: float, tally: Tally) -> None:
    """Whether a change was said in time, and what it named."""
    found = [c for c in tracked.changes if at - 1.0 <= c.found_time <= at + WITHIN]
    names = {moved.name for change in found for moved in change.parameters}
    tally.said += bool(found)
    tally.named += right <= names
    tally.exactly += right == names


def off(tracked: sepcal.Track, flown: Flown, name: str, after: float) -> tuple[float, float]:
    """Error and standard deviation of a parameter some seconds after the change."""
    place = int(np.searchsorted(tracked.time, AT + after))
    error = tracked[name][place] - flown.truth[name][tracked.rows[place]]
    return float(error), float(tracked.standard_deviation(name)[place])


def run(options: argparse.Namespace, report_progress: Progress) -> Outcome:
    """Every kind, then what is said where nothing changes."""
    kinds = {"halve": {"Ma", "Md"}, "vane": {"b_alpha"}, "Ma halves": {"Ma"}}
    kinds["Mq to a third"] = {"Mq"}
    tallies = {kind: Tally() for kind in (*kinds, "ice")}
    errors: dict[tuple[str, float, str], list[tuple[float, float]]] = {}
    early: list[str] = []
    quiet = {"short period": 0.0, "tube": 0.0}  # s
    alarms = {"short period": 0, "tube": 0}

    def fly_one(seed: int) -> None:
        for kind, right in kinds.items():
            flown = fly(seed, kind, SPAN)
            found = track(flown, changes="follow")
            judge(found, right, AT, tallies[kind])
            early.extend(kind for change in found.changes if change.found_time < AT - 1.0)
            others = {"followed": found, "plain ekf": track(flown)}
            if kind == "halve":
                others["ekf with a memory"] = track(flown, memory=500)
                with suppress(sepcal.Error):  # a start by filter error that doesn't converge
                    others["rml that forgets"] = track(flown, "rml", forgetting=0.995)
                others["recursive Fourier"] = track_in_band(flown)
            for method, tracked in others.items():
                for after in AFTER:
                    key = (kind, after, method)
                    known = [name for name in (*TRUTH, "b_alpha") if name in tracked.names]
                    pairs = [off(tracked, flown, name, after) for name in known]
                    errors.setdefault(key, []).extend(pairs)
        judge(track_tube(seed, True, 90.0), {"s_va"}, 2 * AT, tallies["ice"])
        still = track(fly(seed, "none", QUIET), changes="follow")
        calm = track_tube(seed + 5000, False, QUIET)
        for kind, tracked in (("short period", still), ("tube", calm)):
            quiet[kind] += tracked.time[-1] - tracked.time[0]
            alarms[kind] += len(tracked.changes)

    with ThreadPoolExecutor(options.processes) as pool:
        for done, _ in enumerate(pool.map(fly_one, seed_range(options))):
            report_progress((done + 1) / options.seeds)

    n = options.seeds
    least = NAMED * n - 2.0 * np.sqrt(NAMED * (1.0 - NAMED) * n)
    findings = []
    for kind, what in (
        ("halve", "Ma and Md halve"), ("Ma halves", "Ma halves"), ("Mq to a third", "Mq falls"),
        ("vane", "the vane bends"), ("ice", "the tube ices"),
    ):  # fmt: skip
        tally = tallies[kind]
        figure = f"said {tally.said}, named {tally.named}, these alone {tally.exactly} of {n}"
        right = min(tally.said, tally.named) >= least
        findings.append(Finding(f"{what}, within {WITHIN:g} s", figure, "90 %, and chance", right))
    for kind, seconds in quiet.items():
        hours = seconds / 3600.0
        figure = f"{alarms[kind]} false alarms in {hours:.1f} h"
        most = ALARMS_AN_HOUR * hours + 2.0 * np.sqrt(ALARMS_AN_HOUR * hours)
        findings.append(
            Finding(f"{kind}, nothing changes", figure, "one an hour", alarms[kind] <= most)
        )
    findings.append(Finding("before the changes", f"{len(early)} false alarms", "shown", True))
    for (kind, after, method), pairs in errors.items():
        z = np.array([error / deviation for error, deviation in pairs])
        held = float(np.mean(np.abs(z) < 1.96))
        figure = f"{100 * held:.1f} % of intervals hold"
        chance = 2.0 * np.sqrt(0.05 * 0.95 / n)
        asked = method == "followed"
        right = not asked or COVERED[0] - chance <= held <= COVERED[1] + chance
        findings.append(
            Finding(f"{kind}, {after:g} s after, {method}", figure,
                    "90 to 98 %, and chance" if asked else "shown", right)
        )  # fmt: skip
    said = ", ".join(f"{tallies[kind].named} of {n}" for kind in tallies)
    total = sum(alarms.values())
    hours = sum(quiet.values()) / 3600.0
    figures = (
        f"{n} flights each in gusts: the right parameters named within 5 s in {said} (Ma and Md "
        f"halve, a vane bends, Ma halves, Mq falls to a third, a tube ices); {total} false "
        f"alarms in {hours:.1f} h"
    )
    return Outcome(figures, findings)


STUDY = Study(
    name="changes",
    shows="what changes in flight: said in time, the right parameter named, few false alarms",
    run=run,
    options=seeds(SEEDS, "flights of each kind"),
)
