# SPDX-License-Identifier: BSD-3-Clause
"""Eqs. 7 to 13: what one point of xi2 says about the least cost J* in a box.

A bound is refuted by a cost below it that some point of the box reaches. J* itself is not known:
the least cost that points, the truth and a fit reach is at or above it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any

import numpy as np
from numpy.random import Generator, default_rng

import sepcal
from sepcal.columns import Array
from studies.paper.parts import Options, Part, Result, Table, exact, figures, over, rate, share_of
from studies.study import Finding, Progress

POINTS = 10  # of the box, at random
WIDTHS = ((1e-4, 1e-3), (1e-3, 1e-2), (1e-2, 1e-1), (1e-1, 1.0))  # of the widest box
ROUNDING = 1e-12  # of a cost
Ranges = Mapping[str, tuple[float, float]]


PROBLEMS_A_RUN = 10  # of each model


@dataclass(frozen=True)
class Kind:
    """A model, and how its random problems are drawn."""

    name: str
    model: sepcal.Model
    draw_inputs: Callable[[Generator, int], dict[str, Array]]  # rows of them
    truths: Ranges
    half_widths: Mapping[str, float]  # of the widest box of xi2
    noise: float  # typical, in the outputs' unit
    free: Sequence[str] = ()


@dataclass(frozen=True)
class Problem:
    """A record, the box of xi2, that of xi1 where there is one, and the point asked about."""

    data: Mapping[str, Array]
    truth: Mapping[str, float]
    bounds: Ranges
    xi2p: Mapping[str, float]
    sigma: float
    width: float  # of the widest box
    xi1_bounded: bool


@dataclass(frozen=True)
class Outcome:
    """The bounds of a problem, and the least cost that was reached."""

    problem: Problem
    bound: sepcal.CostBound
    reached: float
    fitted: bool

    @property
    def above(self) -> bool:
        """Whether the bound that is said to hold does not."""
        return self.bound.lower > self.reached * (1.0 + ROUNDING)

    @property
    def paper_above(self) -> bool:
        """Whether Eq. 7's conclusion is refuted."""
        return self.bound.paper_lower > self.reached * (1.0 + ROUNDING)


def draw_angles(rng: Generator, rows: int) -> dict[str, Array]:
    """Of the scalar examples."""
    return {"eta": np.sort(rng.uniform(0.0, 10.0, rows))}


def draw_track(rng: Generator, rows: int) -> dict[str, Array]:
    """Ground velocities in turns, climbs and descents [m/s]."""
    heading = rng.uniform(-np.pi, np.pi, rows)
    speed = rng.uniform(15.0, 30.0, rows)
    return {
        "vn": speed * np.cos(heading),
        "ve": speed * np.sin(heading),
        "vd": rng.normal(0.0, 3.0, rows),
    }


def draw_air_data(rng: Generator, rows: int) -> dict[str, Array]:
    """Attitudes, rates and pressures of a five-hole probe."""
    density = np.full(rows, 1.1)
    dynamic = 0.5 * density * rng.uniform(15.0, 30.0, rows) ** 2
    static = np.full(rows, 95000.0)
    ranges = {"roll": 0.8, "pitch": 0.3, "yaw": np.pi, "p": 0.5, "q": 0.3, "r": 0.3}
    return {
        **{name: rng.uniform(-end, end, rows) for name, end in ranges.items()},
        "pt": static + dynamic,
        "ps": static,
        "dpa": 4.5 * dynamic * rng.uniform(-0.05, 0.2, rows),
        "dpb": 4.5 * dynamic * rng.uniform(-0.15, 0.15, rows),
        "rho": density,
    }


def draw_field(rng: Generator, rows: int) -> dict[str, Array]:
    """A field of 50 uT in all directions."""
    h = rng.standard_normal((rows, 3))
    h *= 50.0 / np.linalg.norm(h, axis=1, keepdims=True)
    return dict(zip(("hx", "hy", "hz"), h.T, strict=True))


def evenly(names: str, end: float) -> dict[str, tuple[float, float]]:
    """The same range about zero for each."""
    return dict.fromkeys(names.split(), (-end, end))


KINDS = (
    Kind(
        "scalar example 1",
        sepcal.ScalarExample1(),
        draw_angles,
        {"a": (-0.5, 1.5), "c": (-1.0, 1.0), "b": (-0.4, 0.4)},
        {"b": 0.5},
        0.3,
    ),
    Kind(
        "scalar example 2",
        sepcal.ScalarExample2(),
        draw_angles,
        {"a": (-0.5, 1.5), "d": (-1.0, 1.0), "b": (-0.4, 0.4), "c": (-0.8, 0.8)},
        {"b": 0.5, "c": 1.0},
        0.3,
    ),
    Kind(
        "Pitot-static, three winds",
        sepcal.PitotStatic(),
        draw_track,
        {"s_va": (0.8, 1.2), **evenly("c_va w_d", 1.0), **evenly("w_n w_e", 6.0)},
        {"w_n": 10.0, "w_e": 10.0, "w_d": 10.0},
        0.5,
        free=("w_d",),
    ),
    Kind(
        "five-hole probe",
        sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02)),
        draw_air_data,
        {
            **evenly("lambda_va eps_phi", 0.2),
            **evenly("b_va w_d", 1.0),
            **evenly("w_n w_e", 6.0),
            **evenly("lambda_alpha lambda_beta", 0.3),
            **evenly("b_alpha b_beta", 0.08),
        },
        {
            "lambda_alpha": 0.5,
            "b_alpha": 0.1745,
            "lambda_beta": 0.5,
            "b_beta": 0.1745,
            "eps_phi": 0.2618,
        },
        0.9,
    ),
    Kind(
        "magnetometer",
        sepcal.Magnetometer(),
        draw_field,
        {
            **evenly("lambda_x lambda_y lambda_z", 0.1),
            **evenly("n_x n_y n_z", 15.0),
            **evenly("eta_x eta_y eta_z alpha_xy alpha_xz alpha_yz", 0.1),
        },
        dict.fromkeys(("eta_x", "eta_y", "eta_z", "alpha_xy", "alpha_xz", "alpha_yz"), 0.5),
        0.5,
    ),
)


def at_random(rng: Generator, ranges: Ranges) -> dict[str, float]:
    """A point within."""
    return {name: rng.uniform(*ends) for name, ends in ranges.items()}


def around(rng: Generator, value: float, half_width: float) -> tuple[float, float]:
    """A range that has the value in it, anywhere."""
    lower = value - 2.0 * half_width * rng.uniform()
    return lower, lower + 2.0 * half_width


def draw_problem(kind: Kind, rng: Generator) -> Problem:
    """Half of them have a box for xi1."""
    data = kind.draw_inputs(rng, int(rng.integers(8, 31)))
    truth = at_random(rng, kind.truths)
    sigma = kind.noise * 10.0 ** rng.uniform(-1.5, 0.5)
    A, b = kind.model.evaluate(data, [truth[name] for name in kind.model.nonlinear])
    z = A @ [truth[name] for name in kind.model.linear] + b
    data |= dict(zip(kind.model.outputs, (z + sigma * rng.standard_normal(z.shape)).T, strict=True))
    width = 10.0 ** rng.uniform(np.log10(WIDTHS[0][0]), 0.0)
    box = {
        name: around(rng, truth[name], width * widest * rng.uniform(0.3, 1.0))
        for name, widest in kind.half_widths.items()
    }
    xi2p = at_random(rng, box)
    xi1_bounded = bool(rng.integers(2))
    if xi1_bounded:
        for name in kind.model.linear:
            size = max(abs(end) for end in kind.truths[name])
            lower, upper = around(rng, truth[name], size * 10.0 ** rng.uniform(-2.0, 0.0))
            box[name] = max(lower, kind.model.bounds[name][0]), upper
    return Problem(data, truth, box, xi2p, sigma, width, xi1_bounded)


def cost_at(kind: Kind, problem: Problem, xi2: Mapping[str, float], xi1: Array | None) -> float:
    """J there; without xi1 at the least squares, taken into xi1's limits."""
    A, b = kind.model.evaluate(problem.data, [xi2[name] for name in kind.model.nonlinear])
    z = np.stack([problem.data[name] for name in kind.model.outputs], axis=1)
    A, left = A.reshape(-1, len(kind.model.linear)), (z - b).ravel()
    if xi1 is None:
        xi1 = np.asarray(np.linalg.lstsq(A, left, rcond=None)[0], float)
    limits = [problem.bounds.get(name, kind.model.bounds[name]) for name in kind.model.linear]
    residual = (left - A @ np.clip(xi1, *np.transpose(limits))) / problem.sigma
    return 0.5 * float(residual @ residual)


def fitted_cost(kind: Kind, problem: Problem, seed: int) -> float:
    """What a fit within the box reaches; infinite where it refuses."""
    try:
        fit = sepcal.fit(
            kind.model,
            problem.data,
            bounds=problem.bounds,
            noise=dict.fromkeys(kind.model.outputs, problem.sigma),
            free=kind.free,
            samples=20,
            descents=2,
            seed=seed,
            coloured_errors=False,
            threads=1,
        )
    except sepcal.Error:
        return inf
    values = {name: fit[name].value for name in kind.model.parameters}
    inside = {name: float(np.clip(values[name], *problem.bounds[name])) for name in problem.xi2p}
    return cost_at(kind, problem, inside, np.array([values[name] for name in kind.model.linear]))


def solve(kind: Kind, seeds: Sequence[int]) -> Outcome:
    """The bounds of a random problem, and every cost that refutes one."""
    rng = default_rng(seeds)
    problem = draw_problem(kind, rng)
    bound = sepcal.bound_cost(
        kind.model,
        problem.data,
        problem.xi2p,
        bounds=problem.bounds,
        noise=dict.fromkeys(kind.model.outputs, problem.sigma),
    )
    xi2 = {name: problem.bounds[name] for name in problem.xi2p}
    truth = np.array([problem.truth[name] for name in kind.model.linear])
    reached = [cost_at(kind, problem, at_random(rng, xi2), None) for _ in range(POINTS)]
    reached += [cost_at(kind, problem, problem.truth, xi1) for xi1 in (None, truth)]
    at_fit = fitted_cost(kind, problem, seeds[-1])
    return Outcome(problem, bound, min(*reached, at_fit), isfinite(at_fit))


def solve_all(
    at: int, kind: Kind, options: Options, report_progress: Progress
) -> Sequence[Outcome]:
    """So many problems of a model."""
    return over(
        range(PROBLEMS_A_RUN * options.runs),
        lambda k: solve(kind, (options.seed, at, k)),
        options,
        report_progress,
    )


def the_counterexample() -> sepcal.CostBound:
    """One measurement z = 2 of b(xi2) = xi2 in [0, 1], J* = 1/2 at xi2 = 1.

    Of a Pitot-static tube that is far too fast, so that its norm is straight in w_n: it reads
    far + 2, and far + 2 - |-far - w_n| = 2 - w_n.
    """
    zero, far = np.zeros(1), 1e6
    data = {"vn": zero - far, "ve": zero, "vd": zero, "airspeed": zero + far + 2.0}
    held = {"s_va": (1.0, 1.0), "c_va": (0.0, 0.0), "w_e": (0.0, 0.0), "w_d": (0.0, 0.0)}
    return sepcal.bound_cost(
        sepcal.PitotStatic(),
        data,
        {"w_n": 0.0, "w_e": 0.0, "w_d": 0.0},
        bounds={**held, "w_n": (0.0, 1.0)},
    )


def counterexample_table(bound: sepcal.CostBound) -> Table:
    """Where Eq. 7 fails by hand."""
    return Table(
        "One measurement z = 2 of b(xi2) = xi2, xi2 in [0, 1], seen from xi2p = 0",
        ["J(xi2p)", "E (Eq. 13)", "J* at least, by Eq. 7", "J* at least, proven", "J*"],
        [
            [
                *(figures(x) for x in (bound.cost, bound.paper_error)),
                *(figures(x) for x in (bound.paper_lower, bound.lower)),
                "0.5000",
            ]
        ],
        "Of a PitotStatic whose norm is straight; tests/cpp/certificate/certificate_test.cpp has "
        "b(xi2) = xi2.",
    )


def refutation_table(found: Mapping[str, Sequence[Outcome]]) -> Table:
    """Both bounds against costs that were reached."""
    rows = []
    for name, outcomes in found.items():
        of = len(outcomes)
        refuted = [one for one in outcomes if one.paper_above]
        excess = [one.bound.paper_lower / one.reached - 1.0 for one in refuted]
        rows.append(
            [
                name,
                str(of),
                str(sum(one.above for one in outcomes)),
                rate(sum(one.bound.lower > 0.0 for one in outcomes), of),
                rate(len(refuted), of),
                f"{100 * np.median(excess):.3g} % ({100 * max(excess):.3g})" if excess else "-",
                rate(sum(one.bound.paper_lower > 0.0 for one in outcomes), of),
                rate(len(refuted), sum(one.bound.paper_lower > 0.0 for one in outcomes)),
            ]
        )
    return Table(
        "Bounds of J* against costs reached in the same box",
        [
            "model",
            "problems",
            "proven bound above one",
            "proven bound above 0",
            "Eq. 7 above one",
            "by, median (most)",
            "Eq. 7 above 0",
            "of these: above a reached cost",
        ],
        rows,
        f"Reached: the least of {POINTS} random points of the box, the truth and a fit. "
        "Any of them is at or above J*.",
    )


def tightness_table(found: Mapping[str, Sequence[Outcome]]) -> Table:
    """By the size of the box; those whose fit was not refused."""
    rows = []
    for name, outcomes in found.items():
        for low, high in WIDTHS:
            chosen = [one for one in outcomes if one.fitted and low <= one.problem.width < high]
            ratios = [one.bound.lower / one.reached for one in chosen] or [np.nan]
            refuted = sum(one.paper_above for one in chosen)
            rows.append(
                [
                    name,
                    f"{low:g} to {high:g}",
                    str(len(chosen)),
                    rate(sum(one.bound.lower > 0.0 for one in chosen), len(chosen)),
                    *(figures(float(np.quantile(ratios, q)), 3) for q in (0.1, 0.5, 0.9)),
                    rate(refuted, len(chosen)),
                ]
            )
    return Table(
        "How tight the proven bound is",
        [
            "model",
            "half width, of the widest",
            "problems",
            "above 0",
            "bound / reached: 10 %",
            "median",
            "90 %",
            "Eq. 7 above the fit's cost",
        ],
        rows,
        "Widest: "
        + "; ".join(
            f"{kind.name} {', '.join(f'{p} {w:g}' for p, w in kind.half_widths.items())}"
            for kind in KINDS
        )
        + ".",
    )


def linear_table(found: Mapping[str, Sequence[Outcome]]) -> Table:
    """With and without a box for xi1."""
    rows = []
    for name, outcomes in found.items():
        for bounded in (True, False):
            chosen = [one for one in outcomes if one.problem.xi1_bounded is bounded]
            wide = [one for one in chosen if one.problem.width >= WIDTHS[-1][0]]
            rows.append(
                [
                    name,
                    "given" if bounded else "proven, where it can be",
                    str(len(chosen)),
                    rate(sum(not isfinite(one.bound.joint_error) for one in chosen), len(chosen)),
                    rate(sum(not isfinite(one.bound.joint_error) for one in wide), len(wide)),
                    rate(sum(one.bound.lower > 0.0 for one in chosen), len(chosen)),
                ]
            )
    return Table(
        "What a box for xi1 does",
        [
            "model",
            "box of xi1",
            "problems",
            "no range of xi1: E' infinite",
            "of the widest boxes",
            "bound above 0",
        ],
        rows,
        "Without a range of xi1 both errors are infinite: Eq. 7 says nothing, the proven bound 0.",
    )


def findings_of(bound: sepcal.CostBound, found: Mapping[str, Sequence[Outcome]]) -> list[Finding]:
    """Known answers."""
    tight = 0.5 - 1e-6 < bound.lower <= 0.5
    return [
        exact("the counterexample's proven bound is J*", tight, f"{bound.lower:.9f}", "0.5"),
        exact(
            "the counterexample refutes Eq. 7",
            bound.paper_lower > 0.5,
            f"{bound.paper_lower:.9f} concluded",
            "above J* = 0.5",
        ),
        *(
            exact(
                f"{name}: proven bounds above a reached cost",
                not any(one.above for one in outcomes),
                f"{sum(one.above for one in outcomes)} of {len(outcomes)}",
                "0",
            )
            for name, outcomes in found.items()
        ),
    ]


def numbers_of(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """For JSON."""
    return {
        "problems": len(outcomes),
        "proven above": sum(one.above for one in outcomes),
        "proven positive": sum(one.bound.lower > 0.0 for one in outcomes),
        "paper above": sum(one.paper_above for one in outcomes),
        "paper positive": sum(one.bound.paper_lower > 0.0 for one in outcomes),
        "no range of xi1": sum(not isfinite(one.bound.joint_error) for one in outcomes),
        "fitted": sum(one.fitted for one in outcomes),
    }


def run(options: Options, report_progress: Progress) -> Result:
    """All models."""
    bound = the_counterexample()
    found = {
        kind.name: solve_all(at, kind, options, share_of(report_progress, at, len(KINDS)))
        for at, kind in enumerate(KINDS)
    }
    return Result(
        [
            counterexample_table(bound),
            refutation_table(found),
            tightness_table(found),
            linear_table(found),
        ],
        {
            "counterexample": {"paper": bound.paper_lower, "proven": bound.lower},
            **{name: numbers_of(outcomes) for name, outcomes in found.items()},
        },
        findings=findings_of(bound, found),
    )


PARTS = (Part("bounds", "Eqs. 7 to 13: what holds of the least cost, and what doesn't", run),)
