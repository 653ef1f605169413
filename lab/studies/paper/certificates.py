# SPDX-License-Identifier: BSD-3-Clause
"""What a certificate takes, and whether it is right: against dense grids of the profile cost.

The profile cost of example 2 has a closed form, the squares left by a line through (cos, z), which
shares no code with sepcal.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from numpy.random import Generator, default_rng
from scipy.optimize import minimize

import sepcal
from sepcal.columns import Array
from studies.paper.parts import (
    Options,
    Part,
    Result,
    Table,
    exact,
    figures,
    measure_wave,
    over,
    rate,
    share_of,
)
from studies.study import Finding, Progress

TOLERANCES = (1e-6, 1e-3)
LIMIT = 3000  # boxes, where wide bounds are tried
MANY = 100000  # boxes, among several minima
HALF_WIDTHS = (1.0, 2.0, 4.0, 8.0, 16.0)  # of the winds [m/s]
WIDE = {"b": (-0.6, 1.2), "c": (-1.5, 1.5)}  # of example 2: several minima
GRID = (121, 31)  # points of b, of c
SAME = 1e-6  # of a cost: the certificate's tolerance
EXAMPLE_1, EXAMPLE_2, TUBE = sepcal.ScalarExample1(), sepcal.ScalarExample2(), sepcal.PitotStatic()
WIND = {"w_n": 3.0, "w_e": -4.0, "w_d": 0.5}
Data = Mapping[str, Array]
FitWith = Mapping[str, Any]


@dataclass(frozen=True)
class Case:
    """What is certified, for several draws of the noise."""

    name: str
    free: int  # nonlinear parameters
    model: sepcal.Model
    measure: Callable[[Generator], Data]
    fit_with: FitWith
    one_in: int  # runs a draw
    trial: str  # boxes that the first trial of the method took


@dataclass(frozen=True)
class Proof:
    """A certificate, and what it took."""

    status: str
    boxes: int
    seconds: float
    lower: float  # of the fit's cost


def measure_airspeed(rng: Generator) -> Data:
    """24 rows of 12 to 30 m/s in all directions, 30 deg up and down, noise of 0.3 m/s."""
    rows = 24
    course, climb = rng.uniform(-np.pi, np.pi, rows), rng.uniform(-0.5, 0.5, rows)
    speed = rng.uniform(12.0, 30.0, rows)
    data = {
        "vn": speed * np.cos(course) * np.cos(climb) + WIND["w_n"],
        "ve": speed * np.sin(course) * np.cos(climb) + WIND["w_e"],
        "vd": speed * np.sin(climb) + WIND["w_d"],
    }
    return data | {"airspeed": 0.95 * speed - 0.6 + 0.3 * rng.standard_normal(rows)}


def tube_within(half_width: float, vertical: bool, offset: bool) -> FitWith:
    """A tube's options: winds within so much of the truth; w_d and c_va free or held."""
    bounded = WIND if vertical else {name: WIND[name] for name in ("w_n", "w_e")}
    return {
        "bounds": {name: (w - half_width, w + half_width) for name, w in bounded.items()},
        "free": ["w_d"] if vertical else [],
        "fix": {**({} if vertical else {"w_d": 0.5}), **({} if offset else {"c_va": -0.6})},
    }


CASES = (
    Case(
        "scalar example 1",
        1,
        EXAMPLE_1,
        lambda rng: measure_wave(EXAMPLE_1, (1.0, 1.0, 0.1), rng),
        {},
        10,
        "27",
    ),
    Case(
        "scalar example 2",
        2,
        EXAMPLE_2,
        lambda rng: measure_wave(EXAMPLE_2, (1.0, 1.0, 0.05, 0.1), rng),
        {},
        50,
        "381",
    ),
    Case(
        "Pitot-static, w_d held, winds within 4 m/s",
        2,
        TUBE,
        measure_airspeed,
        tube_within(4.0, False, True),
        100,
        "",
    ),
    Case(
        "Pitot-static, winds within 1 m/s",
        3,
        TUBE,
        measure_airspeed,
        tube_within(1.0, True, True),
        100,
        "",
    ),
    Case(
        "Pitot-static, c_va held, winds within 1 m/s",
        3,
        TUBE,
        measure_airspeed,
        tube_within(1.0, True, False),
        100,
        "",
    ),
)


def prove(case: tuple[sepcal.Model, Data, FitWith], tolerance: float, boxes: int = 20000) -> Proof:
    """Fits and certifies; the time is the certificate's, on one thread."""
    model, data, fit_with = case
    options = {**fit_with, "coloured_errors": False, "threads": 1}
    fit = sepcal.fit(model, data, **options)
    began = perf_counter()
    proof = sepcal.certify(model, data, fit, tolerance=tolerance, boxes=boxes, **options)
    return Proof(proof.status, proof.boxes, perf_counter() - began, proof.lower / proof.cost)


def spread(values: Sequence[float], digits: int) -> str:
    """Median, least and most."""
    least, middle, most = np.quantile(values, [0.0, 0.5, 1.0])
    return f"{middle:.{digits}f} ({least:.{digits}f}-{most:.{digits}f})"


def time_cases(
    options: Options, report_progress: Progress
) -> tuple[Table, dict[str, Any], list[Finding]]:
    """Boxes and seconds."""
    jobs = [
        (case, tolerance, seed)
        for case in CASES
        for tolerance in TOLERANCES
        for seed in range(max(2, options.runs // case.one_in))
    ]

    def work(job: tuple[Case, float, int]) -> Proof:
        case, tolerance, seed = job
        data = case.measure(default_rng((options.seed, seed)))
        return prove((case.model, data, case.fit_with), tolerance)

    proofs = over(jobs, work, options, report_progress)
    rows, numbers, findings = [], {}, []
    for case in CASES:
        for tolerance in TOLERANCES:
            of = [
                proof
                for job, proof in zip(jobs, proofs, strict=True)
                if job[0] is case and job[1] == tolerance
            ]
            found = sum(proof.status == "global" for proof in of)
            boxes = [float(proof.boxes) for proof in of]
            seconds = [proof.seconds for proof in of]
            rows.append(
                [
                    case.name,
                    str(case.free),
                    f"{tolerance:g}",
                    f"{found} of {len(of)}",
                    spread(boxes, 0),
                    case.trial if tolerance == TOLERANCES[0] else "",
                    spread(seconds, 3),
                ]
            )
            name = f"{case.name}, tolerance {tolerance:g}"
            numbers[name] = {"draws": len(of), "global": found, "boxes": boxes, "seconds": seconds}
            figure = f"{found} of {len(of)}"
            findings.append(exact(f"{name}: certified", found == len(of), figure, "all"))
    table = Table(
        "What a certificate takes",
        [
            "problem",
            "n_2",
            "tolerance",
            "global",
            "boxes: median (least-most)",
            "the first trial's",
            "seconds, one thread",
        ],
        rows,
        f"{options.workers} at a time.",
    )
    return table, numbers, findings


def widen(
    options: Options, report_progress: Progress
) -> tuple[Table, dict[str, Any], list[Finding]]:
    """What wide bounds cost a tube."""
    kinds = {
        "two winds (w_d held)": (False, True),
        "two winds, c_va held": (False, False),
        "three winds": (True, True),
        "three winds, c_va held": (True, False),
    }
    data = measure_airspeed(default_rng(options.seed))
    jobs = [(name, half) for name in kinds for half in HALF_WIDTHS]

    def work(job: tuple[str, float]) -> Proof:
        name, half = job
        return prove((TUBE, data, tube_within(half, *kinds[name])), TOLERANCES[0], LIMIT)

    proofs = dict(zip(jobs, over(jobs, work, options, report_progress), strict=True))

    def cell(proof: Proof) -> str:
        taken = f"{proof.boxes} boxes, {proof.seconds:.1f} s"
        if proof.status == "global":
            return taken
        return f"{proof.status.replace('_', ' ')} in {taken}: J* >= {proof.lower:.2f} of it"

    table = Table(
        f"What wide bounds cost: a Pitot-static tube, at most {LIMIT} boxes, tolerance 1e-6",
        ["free", *(f"winds within {half:g} m/s" for half in HALF_WIDTHS)],
        [[name, *(cell(proofs[name, half]) for half in HALF_WIDTHS)] for name in kinds],
        "s_va is free in all. The model's own bounds are 100 m/s.",
    )
    numbers = {
        f"{name}, {half:g} m/s": {"status": proof.status, "boxes": proof.boxes}
        for (name, half), proof in proofs.items()
    }
    kept = all(proof.status != "not_certified" or proof.boxes >= LIMIT for proof in proofs.values())
    says = sum(proof.status == "not_certified" for proof in proofs.values())
    wrong = sum(proof.status == "elsewhere" for proof in proofs.values())
    return (
        table,
        numbers,
        [
            exact("wide bounds: not certified only where boxes ran out", kept, f"{says}", "those"),
            exact("wide bounds: refuted", wrong == 0, f"{wrong}", "0"),
        ],
    )


def profile(data: Data, b: Array, c: Array) -> Array:
    """J of example 2 with a and d at their best, R = 1: of a line through (cos, z)."""
    wave = np.cos(data["eta"] * (1.0 + b[..., np.newaxis]) + c[..., np.newaxis])
    wave -= wave.mean(axis=-1, keepdims=True)
    z = data["z"] - data["z"].mean()
    cost: Array = 0.5 * (z @ z - (wave @ z) ** 2 / np.sum(wave**2, axis=-1))
    return cost


@dataclass(frozen=True)
class Minima:
    """What a grid with descents finds: distinct minima, lowest first."""

    places: Array  # (M, 2)
    costs: Array  # (M,)


def search_grid(data: Data) -> Minima:
    """Descends from every grid point that is no higher than its eight neighbours."""
    b, c = (np.linspace(*WIDE[name], points) for name, points in zip("bc", GRID, strict=True))
    cost = profile(data, *np.meshgrid(b, c, indexing="ij"))
    padded = np.pad(cost, 1, constant_values=np.inf)
    around = [
        padded[1 + i : 1 + i + GRID[0], 1 + j : 1 + j + GRID[1]]
        for i in (-1, 0, 1)
        for j in (-1, 0, 1)
        if i or j
    ]
    ends = []
    for i, j in np.argwhere(cost <= np.min(around, axis=0)):
        descent = minimize(
            lambda x: float(profile(data, x[0], x[1])),
            (b[i], c[j]),
            bounds=[WIDE["b"], WIDE["c"]],
            method="L-BFGS-B",
            options={"ftol": 1e-14, "gtol": 1e-8},
        )
        ends.append((float(min(descent.fun, cost[i, j])), *descent.x))
    distinct: list[tuple[float, ...]] = []
    for end in sorted(ends):
        if all(np.hypot(end[1] - one[1], end[2] - one[2]) > 1e-2 for one in distinct):
            distinct.append(end)
    found = np.array(distinct)
    return Minima(found[:, 1:], found[:, 0])


@dataclass(frozen=True)
class Trial:
    """A fit among several minima, its certificate, and what the grid says."""

    sampled: bool  # else fitted from a random start
    data: Data
    proof: sepcal.Certificate
    minima: Minima

    @property
    def is_least(self) -> bool:
        """Whether the fit's cost is the grid's least."""
        return self.proof.cost <= self.least * (1.0 + 1.001 * SAME)

    @property
    def is_right(self) -> bool:
        """Whether the certificate says so; of a lower cost, that it is reached and the least."""
        if self.proof.status != "elsewhere":
            return self.proof.is_global and self.is_least
        there = self.proof.better
        reached = float(profile(self.data, np.array(there["b"]), np.array(there["c"])))
        told = self.proof.better_cost
        is_reached = reached <= told * (1.0 + 1e-9)
        return is_reached and told < self.proof.cost and told <= self.least * (1.0 + 1e-5)

    @property
    def least(self) -> float:
        """J by the grid."""
        return float(self.minima.costs[0])


def measure_weak_wave(rng: Generator) -> Data:
    """20 angles, a gain of half to two of the noise: several minima."""
    eta = np.sort(rng.uniform(0.0, 10.0, 20))
    b, c = (rng.uniform(*WIDE[name]) for name in "bc")
    z = rng.uniform(0.5, 2.0) * np.cos(eta * (1.0 + b) + c) + 1.0
    z += rng.standard_normal(eta.size)
    return {"eta": eta, "z": z}


def try_one(rng: Generator, sampled: bool) -> Trial:
    """A random problem, fitted well or from anywhere."""
    data = measure_weak_wave(rng)
    start = {name: rng.uniform(*WIDE[name]) for name in WIDE}
    how: FitWith = {"samples": 200} if sampled else {"start": start, "samples": 0}
    return certify_wave(data, how, sampled)


def certify_wave(data: Data, how: FitWith, sampled: bool = False) -> Trial:
    """Within the wide bounds, R = 1."""
    options = {
        **how,
        "bounds": WIDE,
        "noise": {"z": 1.0},
        "coloured_errors": False,
        "threads": 1,
    }
    fit = sepcal.fit(EXAMPLE_2, data, **options)
    proof = sepcal.certify(EXAMPLE_2, data, fit, boxes=MANY, **options)
    return Trial(sampled, data, proof, search_grid(data))


def judge(
    options: Options, report_progress: Progress
) -> tuple[Table, dict[str, Any], list[Finding]]:
    """Random problems against grids."""

    def work(k: int) -> Trial:
        return try_one(default_rng((options.seed, 1, k)), k % 2 == 0)

    trials = over(range(max(2, options.runs // 5)), work, options, report_progress)
    rows = []
    for name, sampled in (("200 samples", True), ("a random start", False)):
        of = [trial for trial in trials if trial.sampled is sampled]
        rows.append(
            [
                name,
                str(len(of)),
                spread([float(trial.minima.costs.size) for trial in of], 0),
                rate(sum(trial.is_least for trial in of), len(of)),
                *(
                    str(sum(trial.proof.status == status for trial in of))
                    for status in ("global", "elsewhere", "not_certified")
                ),
                rate(sum(trial.is_right for trial in of), len(of)),
                spread([float(trial.proof.boxes) for trial in of], 0),
            ]
        )
    table = Table(
        f"Several minima: example 2 with b in {WIDE['b']}, c in {WIDE['c']}, 20 angles, weak waves",
        [
            "fitted from",
            "problems",
            "minima of the grid: median (least-most)",
            "the fit is the least",
            "global",
            "elsewhere",
            "not certified",
            "certificate right",
            "boxes: median (least-most)",
        ],
        rows,
        f"Least: to 1e-6 of J. The grid has {GRID[0]} by {GRID[1]} points of the profile cost and "
        "a descent from each that is no higher than its neighbours. Where a record leaves "
        "parameters open, a fit may end some 1e-6 to 1e-5 above its minimum: elsewhere, too.",
    )
    right = sum(trial.is_right for trial in trials)
    fooled = sum(trial.proof.is_global and not trial.is_least for trial in trials)
    above = sum(trial.proof.lower > trial.least * (1.0 + 1e-12) for trial in trials)
    numbers = {
        "problems": len(trials),
        "right": right,
        "global where the grid is lower": fooled,
        "proven bounds above the grid": above,
        "fits that are the least": sum(trial.is_least for trial in trials),
    }
    figure = f"{right} of {len(trials)}"
    return (
        table,
        numbers,
        [
            exact("several minima: certificates right", right == len(trials), figure, "all"),
            exact("several minima: global where the grid is lower", fooled == 0, f"{fooled}", "0"),
            exact("several minima: proven bounds above the grid", above == 0, f"{above}", "0"),
        ],
    )


def refute(options: Options) -> tuple[Table, dict[str, Any], list[Finding]]:
    """Fits that are wrong on purpose."""
    data = measure_wave(EXAMPLE_2, (1.0, 1.0, 0.05, 0.1), default_rng(options.seed))
    starts = [{"b": b, "c": 0.0} for b in (-0.5, 0.0, 0.5, 0.8, 1.1)]
    trials = over(
        starts,
        lambda start: certify_wave(data, {"start": start, "samples": 0}),
        options,
        lambda _: None,
    )
    rows = []
    for start, trial in zip(starts, trials, strict=True):
        proof = trial.proof
        there = [f"{proof.better[name]:.4f}" if proof.better else "" for name in WIDE]
        rows.append(
            [
                f"b = {start['b']:g}, c = {start['c']:g}",
                figures(proof.cost),
                proof.status,
                *there,
                figures(proof.better_cost) if proof.better else "",
                *(figures(x) for x in trial.minima.places[0]),
                figures(trial.least),
            ]
        )
    wrong = [trial for trial in trials if not trial.is_least]
    told = sum(is_found(trial) for trial in wrong)
    table = Table(
        "Wrong on purpose: the paper's example 2 from starts of stage two, J with R = 1",
        ["start", "J of the fit", "certificate", "b there", "c there", "J there", *GRID_HEAD],
        rows,
    )
    figure = f"{told} of {len(wrong)}"
    holds = told == len(wrong) > 0 and all(trial.is_right for trial in trials)
    return (
        table,
        {"wrong": len(wrong), "told": told},
        [exact("wrong fits: told, and where the least is", holds, figure, "all")],
    )


GRID_HEAD = ("b of the grid's least", "c", "J")


def is_found(trial: Trial) -> bool:
    """Whether the certificate has the least cost where the grid has it."""
    if trial.proof.status != "elsewhere":
        return False
    there = np.array([trial.proof.better[name] for name in WIDE])
    return float(np.linalg.norm(there - trial.minima.places[0])) < 1e-3


def run(options: Options, report_progress: Progress) -> Result:
    """All four."""
    found = {
        "what it takes": time_cases(options, share_of(report_progress, 0, 3)),
        "wide bounds": widen(options, share_of(report_progress, 1, 3)),
        "several minima": judge(options, share_of(report_progress, 2, 3)),
        "wrong on purpose": refute(options),
    }
    return Result(
        [table for table, *_ in found.values()],
        {name: numbers for name, (_, numbers, _) in found.items()},
        findings=[finding for *_, findings in found.values() for finding in findings],
    )


PARTS = (Part("certificates", "what proofs of the least cost take, and that they are right", run),)
