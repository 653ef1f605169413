# SPDX-License-Identifier: BSD-3-Clause
"""Eqs. 17, 18 and 20: what the screens of stage one keep and cost, and when nesting loses nothing.

Both minima of Eq. 20 are the same wherever the inner one keeps xi1's bounds: a minimum over a
product of sets can be taken in any order.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from numpy.random import default_rng
from numpy.typing import NDArray
from scipy.optimize import lsq_linear, minimize_scalar

import sepcal
from sepcal.columns import Array
from studies.paper.parts import (
    ETA,
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

THRESHOLDS = (0.1, 0.5, 1.0, 2.0, 5.0)  # t_1 = t_2
SAMPLES = 500
ROWS = 150  # of a flight: second derivatives of every sample are dear
REPEATS = 5  # of a time
EXAMPLE = sepcal.ScalarExample1()
Mask = NDArray[np.bool]
Data = Mapping[str, Any]
Bounds = Mapping[str, tuple[float, float]]


@dataclass(frozen=True)
class Case:
    """A model, its records and the bounds of xi2 where they are not the model's."""

    name: str
    model: sepcal.Model
    measure: Callable[[int], Data]  # from a seed
    bounds: Bounds


@dataclass(frozen=True)
class Screened:
    """Stage one of a record: both conditions at all samples, and at the minimum."""

    trace_r: Array  # (S,)
    ratios: Array  # (2, S): of A, of b
    convex: Mask  # (2, S): Eq. 18 of A, of b; met where b doesn't depend on xi2
    ratios_there: Array  # (2,)
    convex_there: Mask  # (2,)


def flight(name: str) -> Callable[[int], Data]:
    """A simulated one."""
    return lambda seed: sepcal.simulate(name, rows=ROWS, seed=seed)


SECOND = sepcal.ScalarExample2()
CASES = (
    Case(
        "scalar example 1",
        EXAMPLE,
        lambda seed: measure_wave(EXAMPLE, (1.0, 1.0, 0.1), default_rng(seed)),
        {},
    ),
    Case(
        "scalar example 2",
        SECOND,
        lambda seed: measure_wave(SECOND, (1.0, 1.0, 0.05, 0.1), default_rng(seed)),
        {},
    ),
    Case(
        "five-hole probe",
        sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02)),
        flight("five-hole"),
        {},
    ),
    Case("magnetometer", sepcal.Magnetometer(), flight("magnetometer"), {}),
    Case(
        "Pitot-static, winds within 10 m/s",
        sepcal.PitotStatic(),
        flight("pitot-static"),
        {"w_n": (-10.0, 10.0), "w_e": (-10.0, 10.0)},
    ),
)


def fit_case(case: Case, data: Data, **options: Any) -> sepcal.Fit:  # noqa: ANN401
    """With one descent, on one thread."""
    settings = {"samples": SAMPLES, "descents": 1, "coloured_errors": False, "threads": 1}
    fit: sepcal.Fit = sepcal.fit(case.model, data, **{"bounds": case.bounds, **settings, **options})
    return fit


def conditions(stage_one: sepcal.StageOne) -> tuple[Array, Mask]:
    """The ratios of Eq. 17, and where Eq. 18 is met, each (2, S)."""
    found = stage_one.screens
    assert found is not None
    ratios = np.stack([found.ratio_a, found.ratio_b])
    curvatures = np.stack([found.curvature_a, found.curvature_b])
    return ratios, (curvatures > 0.0) | (ratios == 0.0)


def screen(case: Case, seed: int) -> Screened:
    """All samples, and some at the fit itself."""
    data = case.measure(seed)
    fit = fit_case(case, data, screens={}, seed=seed)
    ratios, convex = conditions(fit.stage_one)
    free = [name for name in case.model.nonlinear if not fit[name].fixed]
    at_fit = {name: (fit[name].value, 1e-9) for name in free}
    there = fit_case(case, data, screens={}, sampling_distribution=at_fit, samples=2)
    ratios_there, convex_there = conditions(there.stage_one)
    trace_r = np.asarray(fit.stage_one.trace_r)
    return Screened(trace_r, ratios, convex, ratios_there[:, 0], convex_there[:, 0])


def kept_row(found: Sequence[Screened], kept: Sequence[Mask], there: Sequence[bool]) -> list[str]:
    """How far the best that is kept is from the best, and whether that and the minimum are."""
    best = [int(np.argmin(one.trace_r)) for one in found]
    farther = [
        float(np.min(one.trace_r[some]) / np.min(one.trace_r))
        for one, some in zip(found, kept, strict=True)
        if np.any(some)
    ]
    return [
        f"{len(found) - len(farther)} of {len(found)}",
        figures(median(farther), 3) if farther else "-",
        f"{sum(bool(some[at]) for some, at in zip(kept, best, strict=True))} of {len(found)}",
        f"{sum(there)} of {len(found)}",
    ]


KEPT = ("records left with none", "best kept / best Tr[R]", "best sample kept", "minimum kept")


def both(met: Mask) -> Mask:
    """A's and b's condition, (S,)."""
    together: Mask = met[0] & met[1]
    return together


def share(conditions: Sequence[Mask]) -> str:
    """Of all samples of all records."""
    every = np.concatenate(conditions)
    return f"{100 * float(np.mean(every)):.1f} %"


def ratio_table(found: Mapping[str, Sequence[Screened]]) -> Table:
    """Eq. 17 at each threshold."""
    rows = []
    for name, records in found.items():
        for limit in THRESHOLDS:
            within = [one.ratios <= limit for one in records]
            rows.append(
                [
                    name,
                    f"{limit:g}",
                    share([of[0] for of in within]),
                    share([of[1] for of in within]),
                    share([both(of) for of in within]),
                    *kept_row(
                        records,
                        [both(of) for of in within],
                        [bool(np.all(one.ratios_there <= limit)) for one in records],
                    ),
                ]
            )
    return Table(
        f"Eq. 17: {SAMPLES} samples, l_2 to the farthest corner of the bounds",
        ["model", "T_1 = T_2", "A's keeps", "b's keeps", "both keep", *KEPT],
        rows,
        "Pitot-static has b = 0, whose ratio 0/0 counts as zero. 'Minimum': the fit's xi2.",
    )


def convex_table(found: Mapping[str, Sequence[Screened]]) -> Table:
    """Eq. 18."""
    rows = [
        [
            name,
            share([one.convex[0] for one in records]),
            share([one.convex[1] for one in records]),
            share([both(one.convex) for one in records]),
            *kept_row(
                records,
                [both(one.convex) for one in records],
                [bool(np.all(one.convex_there)) for one in records],
            ),
        ]
        for name, records in found.items()
    ]
    return Table(
        f"Eq. 18: {SAMPLES} samples",
        ["model", "A's keeps", "b's keeps", "both keep", *KEPT],
        rows,
    )


def time_case(case: Case, seed: int) -> tuple[float, float]:
    """Medians of whole fits without and with screens, in turn [s]."""
    data = case.measure(seed)
    times: dict[bool, list[float]] = {False: [], True: []}
    for _ in range(REPEATS):
        for asked in times:
            began = perf_counter()
            fit_case(case, data, **({"screens": {}} if asked else {}))
            times[asked].append(perf_counter() - began)
    return median(times[False]), median(times[True])


def time_table(times: Mapping[str, tuple[float, float]]) -> Table:
    """What the screens cost."""
    return Table(
        f"What screens cost: whole fits, {SAMPLES} samples, one descent, one thread",
        ["model", "rows", "without [ms]", "with [ms]", "ratio"],
        [
            [
                name,
                str(ETA.size if name.startswith("scalar") else ROWS),
                f"{1e3 * without:.1f}",
                f"{1e3 * screened:.1f}",
                f"{screened / without:.1f}",
            ]
            for name, (without, screened) in times.items()
        ],
        f"Medians of {REPEATS}, in turn.",
    )


class Wave:
    """z = sign a cos(eta + b) + c, of a column whose sign is a matter of taste."""

    inputs = {"eta": "rad"}  # noqa: RUF012
    outputs = {"z": "1"}  # noqa: RUF012
    linear = {"a": "1", "c": "1"}  # noqa: RUF012
    nonlinear = {"b": ("rad", -1.5, 1.5)}  # noqa: RUF012

    def __init__(self, sign: float) -> None:
        self.sign = sign

    def at(self, u: Any, xi2: Array) -> tuple[Array, Array]:  # noqa: ANN401
        """A (N, 1, 2), and b = 0."""
        A = np.ones((u.eta.size, 1, 2))
        A[:, 0, 0] = self.sign * np.cos(u.eta + xi2[0])
        return A, np.zeros((u.eta.size, 1))


def fit_wave(sign: float, data: Data, **screens: float) -> sepcal.Fit:
    """By the model in Python."""
    fit: sepcal.Fit = sepcal.fit(
        Wave(sign),
        data,
        screens=screens,
        samples=SAMPLES,
        noise={"z": 0.3},
        descents=1,
        coloured_errors=False,
        threads=1,
    )
    return fit


@dataclass(frozen=True)
class Mirrored:
    """Fits of one record with the column and with its negative."""

    fits: tuple[sepcal.Fit, sepcal.Fit]
    passes_17: bool  # b = 0 at a threshold of 1e-12

    @property
    def curvatures(self) -> Array:
        """Of A, (2, S)."""
        found = [fit.stage_one.screens for fit in self.fits]
        return np.stack([one.curvature_a for one in found if one is not None])

    @property
    def apart(self) -> float:
        """How far the two fits are from each other, a's sign allowed for."""
        first, second = (fit.values * [sign, 1.0, 1.0] for fit, sign in zip(self.fits, SIGNS))  # noqa: B905
        return float(np.max(np.abs(first - second)))


SIGNS = (1.0, -1.0)


def mirror(seed: int) -> Mirrored:
    """One record."""
    data = measure_wave(EXAMPLE, (1.0, 1.0, 0.1), default_rng(seed))
    first, second = (fit_wave(sign, data) for sign in SIGNS)
    screened = fit_wave(1.0, data, t_2=1e-12).stage_one.screens
    assert screened is not None
    passes = bool(np.all(screened.accepted) and np.all(screened.ratio_b == 0.0))
    return Mirrored((first, second), passes)


def sign_table(found: Sequence[Mirrored]) -> tuple[Table, list[Finding]]:
    """Eq. 18 of a column and of its negative."""
    positive = [[one.curvatures[k] > 0.0 for one in found] for k in (0, 1)]
    flipped = sum(
        bool(
            np.allclose(
                one.curvatures[0], -one.curvatures[1], atol=1e-4 * np.abs(one.curvatures).max()
            )
        )
        for one in found
    )
    apart = max(one.apart for one in found)
    costs = max(abs(one.fits[0].cost - one.fits[1].cost) for one in found)
    passes = sum(one.passes_17 for one in found)
    rows = [
        [
            f"a {'' if sign > 0 else '(-1) '}cos(eta + b) + c",
            share(positive[k]),
            figures(median([one.fits[k]["a"].value for one in found])),
            figures(median([one.fits[k]["b"].value for one in found])),
            figures(median([one.fits[k].cost for one in found])),
        ]
        for k, sign in enumerate(SIGNS)
    ]
    table = Table(
        f"Eq. 18 of the same model with a column negated, {len(found)} records",
        ["model", "A's keeps", "a, median", "b, median", "J, median"],
        rows,
        "A model in Python with b within 1.5 rad and b(xi2) = 0, which passes Eq. 17 at any T_2.",
    )
    of = len(found)
    return table, [
        exact("Eq. 18 flips with a column's sign", flipped == of, f"{flipped} of {of}", "all"),
        exact(
            "and the fit does not",
            apart < 1e-6 and costs < 1e-6,
            f"{apart:.1e} apart, J {costs:.1e}",
            "1e-6",
        ),
        exact("b = 0 passes Eq. 17 at T_2 = 1e-12", passes == of, f"{passes} of {of}", "all"),
    ]


BOXES: Mapping[str, Bounds] = {
    "a in [-0.5, 0.8], c in [0, 2]": {"a": (-0.5, 0.8), "c": (0.0, 2.0)},
    "a in [-0.5, 0.8], c in [1.2, 2]": {"a": (-0.5, 0.8), "c": (1.2, 2.0)},
    "a in [0, 2], c in [0, 2]": {"a": (0.0, 2.0), "c": (0.0, 2.0)},
}
B_RANGE = (-0.5, 0.5)


@dataclass(frozen=True)
class Nested:
    """Least costs within the same boxes, J with sigma = 0.3, by the order of the minima."""

    active: int  # bounds of xi1 that stop the joint fit
    joint: float
    nested: float  # inner least squares within the bounds
    xi2_alone: float  # sepcal's projected second stage
    clipped: float  # inner least squares without bounds, clipped at every b
    clipped_last: float  # the same, clipped only at the best b

    def excess(self, cost: float) -> float:
        """Over the joint one, relative."""
        return cost / self.joint - 1.0


def least_over_b(cost: Callable[[float], float]) -> tuple[float, float]:
    """Of a grid and a golden section about its least: b and the cost."""
    grid = np.linspace(*B_RANGE, 41)
    at = int(np.argmin([cost(b) for b in grid]))
    ends = (grid[max(at - 1, 0)], grid[min(at + 1, grid.size - 1)])
    found = minimize_scalar(cost, bounds=ends, method="bounded", options={"xatol": 1e-9})
    return float(found.x), float(found.fun)


def nest(bounds: Bounds, seed: int) -> Nested:
    """One record."""
    data = measure_wave(EXAMPLE, (1.0, 1.0, 0.1), default_rng(seed))
    lower, upper = np.transpose([bounds[name] for name in EXAMPLE.linear])

    def system(b: float) -> tuple[Array, Array]:
        wave = np.cos(ETA + b)
        return np.column_stack([wave, np.ones_like(wave)]) / 0.3, (data["z"] - wave) / 0.3

    def cost(b: float, xi1: Array) -> float:
        A, left = system(b)
        return 0.5 * float(np.sum((left - A @ xi1) ** 2))

    def unbounded(b: float) -> Array:
        return np.asarray(np.linalg.lstsq(*system(b), rcond=None)[0], float)

    def bounded(b: float) -> float:
        return float(lsq_linear(*system(b), bounds=(lower, upper), method="bvls").cost)

    def fitted(second_stage: str) -> tuple[float, int]:
        fit = sepcal.fit(
            EXAMPLE,
            data,
            bounds={**bounds, "b": B_RANGE},
            noise={"z": 0.3},
            samples=100,
            second_stage=second_stage,
            coloured_errors=False,
            threads=1,
        )
        at_bound = sum(fit[name].at_bound for name in EXAMPLE.linear)
        return cost(fit["b"].value, fit.values[:2]), at_bound

    joint, active = fitted("joint")
    best, _ = least_over_b(lambda b: cost(b, unbounded(b)))
    return Nested(
        active,
        joint,
        least_over_b(bounded)[1],
        fitted("projected")[0],
        least_over_b(lambda b: cost(b, np.clip(unbounded(b), lower, upper)))[1],
        cost(best, np.clip(unbounded(best), lower, upper)),
    )


def percent(shares: Sequence[float]) -> str:
    """Median, least and most; zero without a sign."""
    middle, least, most = (round(100.0 * of(shares), 2) + 0.0 for of in (median, min, max))
    return f"{middle:.2f} % ({least:.2f}-{most:.2f})"


def nesting_table(found: Mapping[str, Sequence[Nested]]) -> Table:
    """Eq. 20 in numbers."""
    rows = []
    for name, draws in found.items():
        equal = sum(abs(one.excess(one.nested)) < 1e-6 for one in draws)
        rows.append(
            [
                name,
                str(len(draws)),
                *(rate(sum(one.active == n for one in draws), len(draws)) for n in (1, 2)),
                f"{equal} of {len(draws)}",
                f"{max(abs(one.excess(one.nested)) for one in draws):.1e}",
                f"{max(one.excess(one.xi2_alone) for one in draws):.1e}",
                *(
                    percent(excesses)
                    for excesses in (
                        [one.excess(one.clipped) for one in draws],
                        [one.excess(one.clipped_last) for one in draws],
                    )
                ),
            ]
        )
    return Table(
        "Eq. 20: scalar example 1, truth a = c = 1, b = 0.1; costs over that of the joint fit",
        [
            "box of xi1",
            "records",
            "one of xi1 at a bound",
            "both",
            "nested equal to 1e-6",
            "nested: at most",
            "sepcal, xi2 alone: at most",
            "clipped at every b",
            "clipped at the best b",
        ],
        rows,
        "Nested: bounded least squares in a search over b, by scipy. Clipped: least squares "
        "without bounds, then taken into them; median (least-most). With both of xi1 at bounds "
        "that is the same corner.",
    )


def nesting_findings(found: Mapping[str, Sequence[Nested]]) -> list[Finding]:
    """Equal where bounds are kept, and only there."""
    draws = [one for some in found.values() for one in some]
    active = [one for one in draws if one.active == 1]
    most = max(abs(one.excess(one.nested)) for one in draws)
    higher = sum(
        min(one.excess(one.clipped), one.excess(one.clipped_last)) > 1e-9 for one in active
    )
    return [
        exact("Eq. 20 is an equality within bounds", most < 1e-6, f"{most:.1e}", "1e-6"),
        exact(
            "clipped costs are higher where a bound stops one of xi1 and not the other",
            higher == len(active) > 0,
            f"{higher} of {len(active)}",
            "all",
        ),
    ]


def numbers_of(found: Mapping[str, Sequence[Screened]]) -> dict[str, Any]:
    """For JSON."""
    return {
        name: {
            "records": len(records),
            "eq 17": {
                f"{limit:g}": float(np.mean([both(one.ratios <= limit).mean() for one in records]))
                for limit in THRESHOLDS
            },
            "eq 18": float(np.mean([both(one.convex).mean() for one in records])),
        }
        for name, records in found.items()
    }


def run(options: Options, report_progress: Progress) -> Result:
    """All of it; times are taken alone."""
    seeds = range(options.seed, options.seed + max(1, options.runs // 100))
    draws = range(options.seed, options.seed + max(2, options.runs // 10))
    times = {case.name: time_case(case, options.seed) for case in CASES}
    found = {
        case.name: over(
            seeds,
            lambda seed, case=case: screen(case, seed),  # type: ignore[misc]
            options,
            share_of(report_progress, at, 8),
        )
        for at, case in enumerate(CASES)
    }
    mirrored = over(draws[: max(2, len(draws) // 5)], mirror, options, lambda _: None)
    nested = {
        name: over(
            draws,
            lambda seed, bounds=bounds: nest(bounds, seed),  # type: ignore[misc]
            options,
            share_of(report_progress, len(CASES) + at, 8),
        )
        for at, (name, bounds) in enumerate(BOXES.items())
    }
    signs, sign_findings = sign_table(mirrored)
    return Result(
        [ratio_table(found), convex_table(found), time_table(times), signs, nesting_table(nested)],
        {
            "screens": numbers_of(found),
            "seconds without, with": times,
            "nesting": {
                name: {
                    "one active": sum(one.active == 1 for one in some),
                    "nested, at most": max(abs(one.excess(one.nested)) for one in some),
                    "clipped, median": median(one.excess(one.clipped) for one in some),
                }
                for name, some in nested.items()
            },
        },
        findings=[*sign_findings, *nesting_findings(nested)],
    )


PARTS = (Part("screens", "Eqs. 17, 18 and 20: what screens keep and cost; nested minima", run),)
