# SPDX-License-Identifier: BSD-3-Clause
"""Sec. IV: 200 simulated flights of the paper's calibration, Tables 5 to 7, Figs. 6 to 8."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.random import default_rng

import sepcal
from sepcal.columns import Array
from studies.paper.parts import Options, Part, Result, Table, exact, figures, over, rate
from studies.paper.probe_flights import (
    METHODS,
    PAPER_BOUNDS,
    PROBE,
    SAME,
    SAMPLED,
    STAGE_ONE,
    STAGE_TWO,
    TABLE_6,
    TABLE_7,
    TRUTH,
    Ending,
    Question,
    airspeed_of,
    fly,
    in_table,
    least_of,
    try_all,
    two_stages,
)
from studies.study import Progress

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RATE = 10.0  # rows a second
STARTS = 10  # random ones a flight
FLIGHTS_A_RUN = 5  # 1,000 runs are 200 flights


@dataclass(frozen=True)
class Flown:
    """A flight, fitted in every way, and compared over the whole of it."""

    fit: sepcal.Fit
    endings: dict[str, list[Ending]]
    rmse: Array  # (3,), of the whole flight [m/s]
    airspeed_rmse: float  # of the whole flight, against the true airspeed [m/s]
    unique_in_fig_6: bool  # whether stage one sees one minimum, sampling as the paper does


def fly_and_fit(seed: int) -> Flown:
    """Stage one on the circles and the pushover-pullup, stage two on the rest."""
    data = fly(seed, rate=RATE)
    question = Question(data, PAPER_BOUNDS, STAGE_ONE, STAGE_TWO)
    fit, endings = try_all(question, default_rng([seed, 7]), STARTS)
    assert fit is not None
    off = residuals_of(data, fit)
    airspeed = airspeed_of(data, values_of(fit)) - airspeed_of(data, TRUTH)
    return Flown(
        fit,
        endings,
        np.sqrt(np.mean(off**2, axis=0)),
        float(np.sqrt(np.mean(airspeed**2))),
        sample_as_paper(data).stage_one.unique_minimum,
    )


def values_of(fit: sepcal.Fit) -> dict[str, float]:
    """The estimates by name."""
    return {name: one.value for name, one in fit.parameters.items()}


def residuals_of(data: dict[str, Any], fit: sepcal.Fit) -> Array:
    """Of every row of the flight [m/s], (N, 3)."""
    n_1 = len(PROBE.linear)
    A, b = PROBE.evaluate(data, fit.values[n_1:])
    measured = np.stack([data[name] for name in PROBE.outputs], axis=-1)
    residuals: Array = measured - A @ fit.values[:n_1] - b
    return residuals


def run(options: Options, report_progress: Progress) -> Result:
    """Tables 6 and 7, and how each method ends."""
    flights = max(2, options.runs // FLIGHTS_A_RUN)
    flown = over(range(options.seed, options.seed + flights), fly_and_fit, options, report_progress)
    same = [
        all(
            end.cost < least_of(one.endings) + SAME for ends in one.endings.values() for end in ends
        )
        for one in flown
    ]
    found = sum(one.endings["two stages"][0].cost < least_of(one.endings) + SAME for one in flown)
    return Result(
        [parameters_table(flown), errors_table(flown), methods_table(flown)],
        {
            "flights": len(flown),
            "every start ends in the same minimum": sum(same),
            "stage one sees a unique minimum": sum(
                one.fit.stage_one.unique_minimum for one in flown
            ),
            "parameters": {name: summary_of(name, flown) for name in PROBE.parameters},
            "airspeed rmse": float(np.mean([one.airspeed_rmse for one in flown])),
        },
        {
            "figure-6": partial(draw_samples, options.seed),
            "figure-7": partial(draw_velocity, options.seed),
            "figure-8": partial(draw_airspeed, options.seed),
        },
        [
            exact(
                "probe: two stages end at the least cost that was found",
                found == len(flown),
                f"{found} of {len(flown)}",
                "all",
            )
        ],
    )


def summary_of(name: str, flown: list[Flown]) -> dict[str, float]:
    """Bias, spread, mean standard error and coverage over the flights that determine it."""
    inside = [one for one in flown if np.isfinite(one.fit[name].standard_error)]
    values = np.array([one.fit[name].value for one in flown])
    errors = np.array([one.fit[name].standard_error for one in inside])
    holds = [
        abs(one.fit[name].value - TRUTH[name]) <= 1.96 * one.fit[name].standard_error
        for one in inside
    ]
    return {
        "mean": float(np.mean(values)),
        "spread": float(np.std(values, ddof=1)),
        "standard error": float(np.mean(errors)) if inside else float("nan"),
        "holds": sum(holds),
        "of": len(inside),
    }


def parameters_table(flown: list[Flown]) -> Table:
    """Table 6."""
    rows = []
    for name in PROBE.parameters:
        estimate, deviation, bounds, unit = TABLE_6[name]
        seen = summary_of(name, flown)
        first = flown[0].fit[name]
        rows.append(
            [
                f"{name} [{unit}]",
                f"{estimate} ({deviation})",
                f"{bounds[0]:g} to {bounds[1]:g}",
                f"{figures(in_table(name, first.value))} "
                f"({figures(in_table(name, first.standard_error))})",
                figures(in_table(name, seen["mean"] - TRUTH[name])),
                figures(in_table(name, seen["spread"])),
                figures(in_table(name, seen["standard error"])),
                rate(int(seen["holds"]), int(seen["of"])),
            ]
        )
    head = [
        "parameter",
        "paper (standard deviation), here the truth",
        "constraints",
        "a flight (standard error)",
        "bias",
        "spread",
        "mean standard error",
        "95 % hold",
    ]
    note = (
        "An estimate at a constraint has no standard error and is not counted in the last column."
    )
    return Table(f"Five-hole probe, {len(flown)} flights (Table 6)", head, rows, note)


def errors_table(flown: list[Flown]) -> Table:
    """Table 7."""
    rows = []
    for j, name in enumerate(PROBE.outputs):
        rmse, sigma = TABLE_7[name]
        rows.append(
            [
                name,
                f"{rmse}",
                f"{sigma}",
                figures(float(np.mean([one.rmse[j] for one in flown]))),
                figures(float(np.mean([one.fit.noise[name] for one in flown]))),
            ]
        )
    airspeed = float(np.mean([one.airspeed_rmse for one in flown]))
    rows.append(["airspeed", "0.1241", "-", figures(airspeed), "-"])
    head = [
        "output [m/s]",
        "paper: rmse",
        "paper: standard deviation, here the truth",
        "rmse of the whole flight",
        "standard deviation of stage two's rows",
    ]
    return Table("Errors of the outputs, mean over the flights (Table 7, Fig. 8)", head, rows)


def methods_table(flown: list[Flown]) -> Table:
    """Which ends at the least cost that was found."""
    rows = []
    for name in METHODS:
        ends = [(end, least_of(one.endings)) for one in flown for end in one.endings[name]]
        reached = sum(end.cost < least + SAME for end, least in ends)
        false = sum(end.converged and end.cost >= least + SAME for end, least in ends)
        rows.append([name, str(len(ends)), rate(reached, len(ends)), rate(false, len(ends))])
    head = ["method", "fits", "the least cost found", "another one, and says converged"]
    unique = sum(one.fit.stage_one.unique_minimum for one in flown)
    wide = sum(one.unique_in_fig_6 for one in flown)
    note = (
        f"Stage one sees one minimum and no flat direction in {unique} of {len(flown)} flights "
        f"within the constraints, and in {wide} with the samples of Fig. 6."
    )
    return Table("Five-hole probe, the paper's constraints: how the methods end", head, rows, note)


def sample_as_paper(data: dict[str, Any]) -> sepcal.Fit:
    """500 samples of the paper's distribution, within ten of its standard deviations."""
    wide = {name: (-10.0 * sd, 10.0 * sd) for name, (_, sd) in SAMPLED.items()}
    fit: sepcal.Fit = sepcal.fit(
        PROBE,
        data,
        bounds=wide,
        stage_one_segments=STAGE_ONE,
        stage_two_segments=STAGE_TWO,
        samples=500,
        sampling_distribution=SAMPLED,
        coloured_errors=False,
        threads=1,
    )
    return fit


def draw_samples(seed: int, figure: Figure) -> None:
    """Fig. 6: Tr[R] at those samples."""
    fit = sample_as_paper(fly(seed, rate=RATE))
    samples = np.asarray(fit.stage_one.samples).copy()
    for k, name in enumerate(PROBE.nonlinear):
        samples[:, k] = [in_table(name, value) for value in samples[:, k]]
    axes = figure.subplots()
    axes.plot(
        np.linalg.norm(samples, axis=1), fit.stage_one.trace_r, ".", markersize=4, rasterized=True
    )
    axes.set_xlabel("norm of xi2, biases in deg, scale errors in 1, eps_phi in rad")
    axes.set_ylabel("Tr[R] [(m/s)^2]")
    axes.set_title("Stage one of the five-hole probe")


def draw_velocity(seed: int, figure: Figure) -> None:
    """Fig. 7: measured and reconstructed velocity, and the error with two standard deviations."""
    data = fly(seed, rate=RATE)
    fit, _ = two_stages(Question(data, PAPER_BOUNDS, STAGE_ONE, STAGE_TWO))
    assert fit is not None
    off = residuals_of(data, fit)
    panels = figure.subplots(3, 2, sharex=True)
    for j, name in enumerate(PROBE.outputs):
        left, right = panels[j]
        left.plot(data["time"], data[name], linewidth=0.5, label="measured", rasterized=True)
        left.plot(
            data["time"],
            data[name] - off[:, j],
            linewidth=0.5,
            label="reconstructed",
            rasterized=True,
        )
        left.set_ylabel(f"{name} [m/s]")
        right.plot(data["time"], off[:, j], linewidth=0.3, rasterized=True)
        for side in (-2.0, 2.0):
            right.axhline(side * fit.noise[name], color="black", linestyle="--", linewidth=0.8)
        right.set_ylabel(f"error of {name} [m/s]")
    panels[0][0].legend(fontsize=7)
    for panel in panels[-1]:
        panel.set_xlabel("time [s]")


def draw_airspeed(seed: int, figure: Figure) -> None:
    """Fig. 8: the calibrated airspeed beside the true one."""
    data = fly(seed, rate=RATE)
    fit, _ = two_stages(Question(data, PAPER_BOUNDS, STAGE_ONE, STAGE_TWO))
    assert fit is not None
    true, found = airspeed_of(data, TRUTH), airspeed_of(data, values_of(fit))
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.plot(data["time"], true, linewidth=0.8, label="true", rasterized=True)
    upper.plot(
        data["time"],
        found,
        "--",
        linewidth=0.8,
        label="five-hole probe, calibrated",
        rasterized=True,
    )
    upper.set_ylabel("airspeed [m/s]")
    upper.legend(fontsize=7)
    lower.plot(data["time"], found - true, linewidth=0.6, rasterized=True)
    lower.set_ylabel("error [m/s]")
    lower.set_xlabel("time [s]")


PARTS = (
    Part(
        "probe",
        "the five-hole probe: Tables 5, 6 and 7, Figs. 6, 7 and 8, on simulated flights",
        run,
    ),
)
