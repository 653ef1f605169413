# SPDX-License-Identifier: BSD-3-Clause
"""The paper's flight, simulated, and every way to fit it (Sec. IV).

The flight data of the paper are not public. Flights here come from a simulator that shares no code
with the model, in Table 5's maneuvers, with Table 6's parameters and Table 7's noise.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, radians
from typing import Any

import numpy as np
from numpy.random import Generator

import sepcal
from sepcal import rivals
from sepcal.columns import Array

PROBE = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
Bounds = Mapping[str, tuple[float, float]]

# Table 6: estimate, its standard deviation, constraints, unit.
TABLE_6: Mapping[str, tuple[float, float, tuple[float, float], str]] = {
    "lambda_va": (-0.1748, 0.0739, (-0.5, 0.5), "1"),
    "b_va": (4.3553, 1.2672, (-5.0, 5.0), "m/s"),
    "w_n": (-3.8038, 0.8704, (-6.0, 6.0), "m/s"),
    "w_e": (-2.4137, 0.9956, (-6.0, 6.0), "m/s"),
    "w_d": (-0.7168, 0.9952, (-2.0, 2.0), "m/s"),
    "lambda_alpha": (0.2982, 0.3228, (-0.5, 0.5), "1"),
    "b_alpha": (-2.4854, 0.5603, (-5.0, 5.0), "deg"),
    "lambda_beta": (-0.2673, 0.2379, (-0.5, 0.5), "1"),
    "b_beta": (-1.2980, 0.5164, (-5.0, 5.0), "deg"),
    "eps_phi": (-0.1380, 0.2699, (-0.2618, 0.2618), "rad"),
}
# Table 7: root mean square error, estimated standard deviation [m/s].
TABLE_7 = {"vn": (1.2564, 0.9875), "ve": (1.1028, 0.8645), "vd": (0.8321, 0.9207)}
STAGE_ONE = "wind_circle_1,wind_circle_2,popu"
STAGE_TWO = (
    "multisine_1,multisine_2,multisine_3,multisine_4,pitch_chirp_1,yaw_chirp,pitch_chirp_2,"
    "rudder_doublet"
)


def in_si(name: str, value: float) -> float:
    """Of Table 6, whose biases of flow angles are in degrees."""
    return radians(value) if TABLE_6[name][3] == "deg" else value


def in_table(name: str, value: float) -> float:
    """The reverse."""
    return float(np.degrees(value)) if TABLE_6[name][3] == "deg" else value


TRUTH = {name: in_si(name, row[0]) for name, row in TABLE_6.items()}
PAPER_BOUNDS: Bounds = {
    name: (in_si(name, low), in_si(name, high)) for name, (_, _, (low, high), _) in TABLE_6.items()
}
NOISE = {name: sigma for name, (_, sigma) in TABLE_7.items()}
# The paper's N(0, 2^2): degrees for the biases, 1 for the scale errors; 20 deg for eps_phi.
SAMPLED = {
    "lambda_alpha": (0.0, 2.0),
    "b_alpha": (0.0, radians(2.0)),
    "lambda_beta": (0.0, 2.0),
    "b_beta": (0.0, radians(2.0)),
    "eps_phi": (0.0, 0.3491),
}


def columns_of(flight: sepcal.Flight) -> dict[str, Any]:
    """The model's inputs and outputs, time and labels of a flight."""
    wanted = {*PROBE.inputs, *PROBE.outputs, "time"}
    taken: dict[str, Any] = {
        name: flight[header] for header in flight if (name := header.rsplit("_", 1)[0]) in wanted
    }
    taken["maneuver"] = flight.maneuvers
    return taken


def fly(
    seed: int,
    parameters: Mapping[str, float] = TRUTH,
    noise: Mapping[str, float] = NOISE,
    **how: Any,  # noqa: ANN401
) -> dict[str, Any]:
    """A flight's columns; `how`: rows, rate and excitation, as sepcal.simulate() has them."""
    return columns_of(sepcal.simulate(PROBE, parameters=parameters, noise=noise, seed=seed, **how))


@dataclass(frozen=True)
class Ending:
    """Where a method ended."""

    cost: float  # J of Eq. 6
    converged: bool  # as it says
    open: bool = False  # as it says: the record leaves parameters open


@dataclass(frozen=True)
class Question:
    """Data, the rows of each stage, and the bounds."""

    data: Mapping[str, Any]
    bounds: Bounds
    stage_one: str = ""
    stage_two: str = ""


def two_stages(question: Question, second_stage: str = "auto") -> tuple[sepcal.Fit | None, Ending]:
    """The proposed estimator. None where it refuses the data."""
    try:
        fit: sepcal.Fit = sepcal.fit(
            PROBE,
            question.data,
            bounds=question.bounds,
            stage_one_segments=question.stage_one,
            stage_two_segments=question.stage_two,
            second_stage=second_stage,
            coloured_errors=False,
            threads=1,
        )
    except sepcal.Error:
        return None, Ending(inf, False)
    left_open = fit.status == "not_identifiable"
    return fit, Ending(fit.cost, fit.status == "converged", left_open)


def one_stage(
    question: Question, start: Mapping[str, float], solver: rivals.Solver
) -> tuple[rivals.SingleStageFit, Ending]:
    """Benchmark 1, with R to the last digit."""
    fit = rivals.fit_single_stage(
        PROBE,
        question.data,
        start,
        bounds=question.bounds,
        segments=question.stage_two,
        solver=solver,
        noise_tolerance=1e-8,
        threads=1,
    )
    return fit, Ending(fit.cost, fit.converged)


def random_start(bounds: Bounds, rng: Generator) -> dict[str, float]:
    """Anywhere within them."""
    return {name: rng.uniform(*ends) for name, ends in bounds.items()}


METHODS = (
    "two stages",
    "two stages, xi2 alone",
    "two stages, joint",
    "single stage from zero, Levenberg-Marquardt",
    "single stage from zero, SLSQP",
    "single stage from random, Levenberg-Marquardt",
    "single stage from random, SLSQP",
)
SAME = 0.01  # of J: no record tells such costs apart


def try_all(
    question: Question, rng: Generator, starts: int
) -> tuple[sepcal.Fit | None, dict[str, list[Ending]]]:
    """The proposed fit, and the ends of every method, those from random starts so many times."""
    solvers: Sequence[tuple[str, rivals.Solver]] = (
        ("Levenberg-Marquardt", "levenberg_marquardt"),
        ("SLSQP", "slsqp"),
    )
    drawn = [random_start(question.bounds, rng) for _ in range(starts)]
    fit, ending = two_stages(question)
    endings = {
        "two stages": [ending],
        "two stages, xi2 alone": [two_stages(question, "projected")[1]],
        "two stages, joint": [two_stages(question, "joint")[1]],
    }
    for name, solver in solvers:
        endings[f"single stage from zero, {name}"] = [one_stage(question, {}, solver)[1]]
        endings[f"single stage from random, {name}"] = [
            one_stage(question, start, solver)[1] for start in drawn
        ]
    return fit, endings


def least_of(endings: Mapping[str, Sequence[Ending]]) -> float:
    """The least cost that anything reached: the search is exhaustive, not certified."""
    return min(ending.cost for ends in endings.values() for ending in ends)


def airspeed_of(data: Mapping[str, Array], xi: Mapping[str, float]) -> Array:
    """The calibrated airspeed [m/s], (N,) (Eq. 36)."""
    read = np.sqrt(2.0 * (data["pt"] - data["ps"]) / data["rho"])
    airspeed: Array = (1.0 + xi["lambda_va"]) * read + xi["b_va"]
    return airspeed
