# SPDX-License-Identifier: BSD-3-Clause
"""Sec. III: both scalar examples, three kinds of estimator, two protocols (Tables 1-4, Figs. 2-5).

The paper draws one realisation of the noise and starts 1,000 times; an estimate within 0.1 of the
truth is "correct". The honest protocol draws the noise anew each time, and an estimate is right
where it is the least cost within the bounds, which a certificate proves.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.random import Generator, default_rng

import sepcal
from sepcal import rivals
from sepcal.columns import Array
from studies.paper.parts import (
    ETA,
    SIGMA,
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

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NEAR = 0.1  # the paper's "correct": 2-norm from the truth
SHOWN = 100  # runs in a figure
Values = dict[str, float]
Bounds = Mapping[str, tuple[float, float]]
Fitted = tuple[Array, bool]  # estimates in the model's order, whether it says it converged
Method = Callable[[Mapping[str, Array], Values, Bounds], Fitted]


@dataclass(frozen=True)
class Example:
    """One of the two; what the paper says of it is beside."""

    name: str
    model: sepcal.Model
    truth: Values
    bounds: Bounds  # the paper's constraints
    starts: Values  # standard deviations of random starts, about zero
    methods: Mapping[str, Method]
    paper_correct: Mapping[str, str]
    paper_estimate: Mapping[str, tuple[str, str]]  # estimate, standard deviation
    paper_variance: tuple[str, str]  # R of the noise that was drawn, and its estimate

    def predict(self, xi: Array) -> Array:
        """The output without noise, (N,)."""
        n_1 = len(self.model.linear)
        A, b = self.model.evaluate({"eta": ETA}, xi[n_1:])
        prediction: Array = A[:, 0] @ xi[:n_1] + b[:, 0]
        return prediction

    @property
    def at_truth(self) -> Array:
        """The truth in the model's order."""
        return np.array([self.truth[name] for name in self.model.parameters])

    def errors_at_papers(self) -> Array:
        """Standard errors (n,) by the tangent at the paper's estimates and its R."""
        xi = np.array([float(self.paper_estimate[name][0]) for name in self.model.parameters])
        n_1 = len(self.model.linear)
        A, _, D = self.model.evaluate({"eta": ETA}, xi[n_1:], xi[:n_1])
        J = np.concatenate([A[:, 0], D[:, 0]], axis=1)
        errors: Array = np.sqrt(float(self.paper_variance[1]) * np.diag(np.linalg.inv(J.T @ J)))
        return errors

    def measure(self, rng: Generator) -> dict[str, Array]:
        """A realisation of the noise."""
        return measure_wave(self.model, self.at_truth, rng)

    def draw_start(self, rng: Generator) -> Values:
        """Normal about zero, as the paper draws it."""
        return {name: sd * rng.standard_normal() for name, sd in self.starts.items()}


def two_stage(model: sepcal.Model, data: Mapping[str, Array], _: Values, bounds: Bounds) -> Fitted:
    """The paper's estimator: it needs no start."""
    fit = fit_two_stage(model, data, bounds)
    return fit.values, fit.status == "converged"


def fit_two_stage(model: sepcal.Model, data: Mapping[str, Array], bounds: Bounds) -> sepcal.Fit:
    """With the white noise that it meets."""
    fit: sepcal.Fit = sepcal.fit(
        model, data, bounds=bounds, samples=100, coloured_errors=False, threads=1
    )
    return fit


def single_stage(
    model: sepcal.Model,
    options: Mapping[str, Any],
    data: Mapping[str, Array],
    start: Values,
    bounds: Bounds,
) -> Fitted:
    """Benchmark 1."""
    fit = rivals.fit_single_stage(model, data, start, bounds=bounds, threads=1, **options)
    return fit.estimates, fit.converged


def haupt_kasdin(
    problem: rivals.BuiltInProblem, data: Mapping[str, Array], start: Values, _: Bounds
) -> Fitted:
    """Benchmark 2, which the paper gives no bounds."""
    fit = rivals.fit_haupt_kasdin(problem, data, start)
    return fit.estimates, fit.converged


def singles(model: sepcal.Model) -> dict[str, Method]:
    """Benchmark 1 by each solver."""
    kinds = {
        "single stage, Levenberg-Marquardt": {},
        "single stage, SLSQP": {"solver": "slsqp"},
        "single stage, SLSQP of the summed cost": {"solver": "slsqp", "cost": "sum"},
    }
    return {name: partial(single_stage, model, options) for name, options in kinds.items()}


PROPOSED = "two stages (proposed)"
FIRST, SECOND = sepcal.ScalarExample1(), sepcal.ScalarExample2()
EXAMPLES = (
    Example(
        "1",
        FIRST,
        {"a": 1.0, "c": 1.0, "b": 0.1},
        {"b": (0.0, 0.2)},
        {"a": 1.0, "c": 1.0, "b": 0.1},
        {
            PROPOSED: partial(two_stage, FIRST),
            **singles(FIRST),
            "Haupt/Kasdin, the paper's five states": partial(
                haupt_kasdin, rivals.ExampleInFiveStates()
            ),
            "Haupt/Kasdin, three states": partial(haupt_kasdin, rivals.ExampleInThreeStates()),
        },
        {
            PROPOSED: "100",
            "single stage, Levenberg-Marquardt": "",
            "single stage, SLSQP": "100",
            "single stage, SLSQP of the summed cost": "",
            "Haupt/Kasdin, the paper's five states": "lost in our copy",
            "Haupt/Kasdin, three states": "",
        },
        {"a": ("0.9512", "0.0507"), "b": ("0.0812", "0.0182"), "c": ("0.9415", "0.0360")},
        ("0.1237", "0.1199"),
    ),
    Example(
        "2",
        SECOND,
        {"a": 1.0, "d": 1.0, "b": 0.05, "c": 0.1},
        {"b": (0.0, 0.5), "c": (0.0, 1.0)},
        {"a": 1.0, "d": 1.0, "b": 0.1, "c": 0.1},
        {PROPOSED: partial(two_stage, SECOND), **singles(SECOND)},
        {
            PROPOSED: "100",
            "single stage, Levenberg-Marquardt": "",
            "single stage, SLSQP": "97.8",
            "single stage, SLSQP of the summed cost": "",
        },
        {
            "a": ("0.9980", "0.0474"),
            "b": ("0.0546", "0.0059"),
            "c": ("0.0895", "0.0351"),
            "d": ("0.9897", "0.0333"),
        },
        ("0.1016", "0.1008"),
    ),
)


@dataclass(frozen=True)
class Verdict:
    """How a run ended: where, whether it said so, and what the least cost is."""

    estimates: Array
    converged: bool
    near: bool  # the paper's measure
    kind: str  # "least": the least cost within the bounds; "twin": its cost, elsewhere; "worse"


def judge(example: Example, data: Mapping[str, Array], least: Array, fitted: Fitted) -> Verdict:
    """Against the certified minimum `least`."""
    estimates, converged = fitted

    def squares(xi: Array) -> float:
        return float(np.sum((data["z"] - example.predict(xi)) ** 2))

    off = float(np.linalg.norm(estimates - example.at_truth))
    same_cost = squares(estimates) <= squares(least) * (1.0 + 1e-6)
    same_place = float(np.linalg.norm(estimates - least)) < 1e-3
    kind = "least" if same_place else "twin" if same_cost else "worse"
    return Verdict(estimates, converged, off <= NEAR, kind)


@dataclass(frozen=True)
class Problem:
    """A realisation, its two-stage fit within bounds, and the least cost where it is proven."""

    data: Mapping[str, Array]
    bounds: Bounds
    fit: sepcal.Fit
    least: Array
    certified: bool
    boxes: int


@dataclass(frozen=True)
class Run:
    """All methods on a problem, from one start."""

    problem: Problem
    verdicts: Mapping[str, Verdict]


def prove(example: Example, data: Mapping[str, Array], bounds: Bounds) -> Problem:
    """With the certificate of the two-stage fit."""
    fit = fit_two_stage(example.model, data, bounds)
    proof = sepcal.certify(
        example.model, data, fit, bounds=bounds, coloured_errors=False, threads=1
    )
    least = fit.values
    if proof.status == "elsewhere":
        least = np.array([proof.better[name] for name in example.model.parameters])
    certified = proof.is_global or proof.status == "elsewhere"
    return Problem(data, bounds, fit, least, certified, proof.boxes)


def run_all(example: Example, problem: Problem, start: Values) -> Run:
    """Every method from one start."""
    data, bounds = problem.data, problem.bounds
    verdicts = {
        name: judge(example, data, problem.least, method(data, start, bounds))
        for name, method in example.methods.items()
    }
    return Run(problem, verdicts)


def run_one_noise(example: Example, options: Options, report_progress: Progress) -> list[Run]:
    """The paper's protocol: one realisation, whose every run is another start."""
    problem = prove(example, example.measure(default_rng(options.seed)), example.bounds)

    def work(run: int) -> Run:
        rng = default_rng([options.seed, run])
        return run_all(example, problem, example.draw_start(rng))

    return over(range(options.runs), work, options, report_progress)


def run_fresh_noise(
    example: Example, bounds: Bounds, options: Options, report_progress: Progress
) -> list[Run]:
    """The honest one: noise and start are drawn anew.

    Without the paper's bounds starts are drawn within the model's own.
    """

    def work(run: int) -> Run:
        rng = default_rng([options.seed, 1, run])
        data, start = example.measure(rng), example.draw_start(rng)
        if bounds is not example.bounds:
            start |= {name: rng.uniform(*ends) for name, ends in bounds.items()}
        return run_all(example, prove(example, data, bounds), start)

    return over(range(options.runs), work, options, report_progress)


def success_table(example: Example, title: str, runs: Sequence[Run], paper: bool) -> Table:
    """Shares of the runs with their binomial limits."""
    rows = []
    for name in example.methods:
        ends = [run.verdicts[name] for run in runs]
        of = len(ends)
        rows.append(
            [
                name,
                *([example.paper_correct[name]] if paper else []),
                rate(sum(end.near for end in ends), of),
                rate(sum(end.kind == "least" for end in ends), of),
                rate(sum(end.kind == "twin" for end in ends), of),
                rate(sum(end.kind == "worse" for end in ends), of),
                rate(sum(end.kind == "worse" and end.converged for end in ends), of),
            ]
        )
    head = [
        "method",
        *(["paper: correct, %"] if paper else []),
        "within 0.1 of the truth",
        "the least cost",
        "its cost, other parameters",
        "a worse minimum",
        "of these: says converged",
    ]
    return Table(title, head, rows)


def estimate_table(example: Example, run: Run, fresh: Sequence[Run]) -> Table:
    """Tables 2 and 4, and what becomes of them with other noise."""
    names = example.model.parameters
    estimates = np.array([one.problem.fit.values for one in fresh])
    errors = np.array([[one.problem.fit[name].standard_error for name in names] for one in fresh])
    at_papers = example.errors_at_papers()
    rows = []
    for k, name in enumerate(names):
        truth = example.truth[name]
        holds = np.abs(estimates[:, k] - truth) <= 1.96 * errors[:, k]
        inside = np.isfinite(errors[:, k])
        rows.append(
            [
                name,
                f"{truth:g}",
                *example.paper_estimate[name],
                figures(at_papers[k]),
                figures(run.problem.fit[name].value),
                figures(run.problem.fit[name].standard_error),
                figures(float(np.mean(estimates[:, k])) - truth),
                figures(float(np.std(estimates[:, k], ddof=1))),
                figures(float(np.nanmean(errors[:, k]))),
                rate(int(np.sum(holds & inside)), int(np.sum(inside))),
            ]
        )
    variances = [one.problem.fit.noise["z"] ** 2 for one in fresh]
    rows.append(
        [
            "R",
            f"{SIGMA**2:g}",
            f"{example.paper_variance[1]} (drawn: {example.paper_variance[0]})",
            "-",
            "-",
            figures(run.problem.fit.noise["z"] ** 2),
            "-",
            figures(float(np.mean(variances)) - SIGMA**2),
            figures(float(np.std(variances, ddof=1))),
            "-",
            "-",
        ]
    )
    head = [
        "parameter",
        "truth",
        "paper: estimate",
        "paper: standard deviation",
        "by the tangent there",
        "estimate",
        "standard error",
        "bias",
        "spread",
        "mean standard error",
        "95 % hold",
    ]
    title = f"Example {example.name}: estimates (Table {'2' if example.name == '1' else '4'})"
    note = (
        "Estimate and standard error are of the first protocol's noise; bias, spread and the last "
        "columns of the second one's runs. A run that ends at a bound has no standard error there."
    )
    return Table(title, head, rows, note)


def run_example(example: Example, options: Options, report_progress: Progress) -> Result:
    """Both protocols, and a third one without the paper's help in bounds and starts."""
    third = [share_of(report_progress, i, 3) for i in range(3)]
    same = run_one_noise(example, options, third[0])
    fresh = run_fresh_noise(example, example.bounds, options, third[1])
    wide = {name: example.model.bounds[name] for name in example.model.nonlinear}
    anywhere = run_fresh_noise(example, wide, options, third[2])
    number = "1" if example.name == "1" else "3"
    box = ", ".join(f"{name} in [{low:g}, {high:g}]" for name, (low, high) in wide.items())
    tables = [
        success_table(
            example,
            f"Example {example.name}, the paper's protocol (Table {number}): one realisation, "
            f"{options.runs} starts",
            same,
            True,
        ),
        success_table(
            example,
            f"Example {example.name}, fresh noise in each of {options.runs} runs",
            fresh,
            False,
        ),
        success_table(
            example,
            f"Example {example.name}, fresh noise, starts and bounds over {box}",
            anywhere,
            False,
        ),
        estimate_table(example, same[0], fresh),
    ]
    return Result(
        tables,
        {
            "one realisation": numbers_of(example, same),
            "fresh noise": numbers_of(example, fresh),
            "wide": numbers_of(example, anywhere),
        },
        {
            f"figure-{'2' if example.name == '1' else '4'}": partial(draw_trace, example, same[0]),
            f"figure-{'3' if example.name == '1' else '5'}": partial(draw_outputs, example, fresh),
        },
        findings_of(example, [*fresh, *anywhere], same),
    )


def findings_of(example: Example, fresh: Sequence[Run], same: Sequence[Run]) -> list[Finding]:
    """Known answers: the proposed estimator finds what is proven to be the least."""
    of = len(fresh)
    proven = sum(run.problem.certified for run in fresh)
    found = sum(run.verdicts[PROPOSED].kind == "least" for run in fresh)
    name = f"example {example.name}"
    return [
        exact(f"{name}: least costs that are certified", proven == of, f"{proven} of {of}", "all"),
        exact(f"{name}: two stages end there", found == of, f"{found} of {of}", "all"),
        exact(
            f"{name}: two stages do not depend on the start",
            len({tuple(run.verdicts[PROPOSED].estimates) for run in same}) == 1,
            "1 estimate" if same else "-",
            "1",
        ),
    ]


def numbers_of(example: Example, runs: Sequence[Run]) -> dict[str, Any]:
    """For JSON."""
    return {
        "runs": len(runs),
        "certified": sum(run.problem.certified for run in runs),
        "mean boxes": float(np.mean([run.problem.boxes for run in runs])),
        "methods": {
            name: {
                "near": sum(run.verdicts[name].near for run in runs),
                **{
                    kind: sum(run.verdicts[name].kind == kind for run in runs)
                    for kind in ("least", "twin", "worse")
                },
                "converged": sum(run.verdicts[name].converged for run in runs),
            }
            for name in example.methods
        },
    }


def draw_trace(example: Example, run: Run, figure: Figure) -> None:
    """Figs. 2 and 4: Tr[R] at samples of xi2."""
    stage_one = sepcal.fit(
        example.model, run.problem.data, bounds=example.bounds, samples=2000, threads=1
    ).stage_one
    axes = figure.subplots()
    samples = np.asarray(stage_one.samples).T
    if len(example.model.nonlinear) == 1:
        axes.plot(samples[0], stage_one.trace_r, ".", markersize=3, rasterized=True)
        axes.set_xlabel("b [rad]")
        axes.set_ylabel("Tr[R] [1]")
    else:
        seen = axes.tricontourf(samples[0], samples[1], stage_one.trace_r, 24)
        seen.set_rasterized(True)
        figure.colorbar(seen, label="Tr[R] [1]")
        axes.set_xlabel("b [1]")
        axes.set_ylabel("c [rad]")
    axes.set_title(f"Example {example.name}: residuals of stage one")


def draw_outputs(example: Example, runs: Sequence[Run], figure: Figure) -> None:
    """Figs. 3 and 5: what a hundred estimates of each method predict."""
    axes = figure.subplots(len(example.methods), 1, sharex=True, sharey=True)
    for panel, name in zip(axes, example.methods, strict=True):
        for run in runs[:SHOWN]:
            verdict = run.verdicts[name]
            worse = verdict.kind == "worse"
            colour = {"least": "tab:blue", "twin": "tab:orange", "worse": "tab:red"}[verdict.kind]
            panel.plot(
                ETA,
                example.predict(verdict.estimates),
                color=colour,
                linewidth=1.0 if worse else 0.4,
                zorder=3 if worse else 2,
                rasterized=True,
            )
        panel.plot(ETA, example.predict(example.at_truth), "k--", linewidth=1.0, zorder=4)
        panel.set_title(name, fontsize=8)
        panel.set_ylabel("z [1]")
    axes[-1].set_xlabel("eta [rad]")
    figure.suptitle(
        "blue: the least cost, orange: its cost by other parameters, red: worse, dashed: truth",
        fontsize=8,
    )


PARTS = tuple(
    Part(
        f"example-{example.name}",
        f"scalar example {example.name}: Tables {'1 and 2' if example.name == '1' else '3 and 4'}, "
        f"Figs. {'2 and 3' if example.name == '1' else '4 and 5'}",
        partial(run_example, example),
    )
    for example in EXAMPLES
)
