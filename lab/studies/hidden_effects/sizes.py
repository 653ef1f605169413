# SPDX-License-Identifier: BSD-3-Clause
"""Is an effect of s sigmas as large as that?

The drop of chi-squared by the effect itself is noncentral: mean s^2 + q, variance 4 s^2 + 2 q, q
the effect's coefficients.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sepcal.fitting import fit
from studies.hidden_effects.cases import CASES, NOISE, OUTPUTS, PROBES, Case, factor_for, fly
from studies.study import Finding

SIGMAS = 5.0
FREEDOM = {  # q
    ("five-hole", "wind[altitude_m]"): 2,
    ("five-hole", "heading_bias"): 1,
    ("magnetometer", "bias[current_a]"): 3,
}
SIZED = tuple(case for case in CASES if (case.probe, case.effect) in FREEDOM)


def check_size(case: Case, flights: Sequence[int]) -> Finding:
    """At four standard errors of the mean drop: one false alarm in 16,000 cases."""
    hide = {case.effect: case.sizes(factor_for(case, SIGMAS))}
    mean = float(np.mean([_drop(case, hide, seed) for seed in flights]))
    freedom = FREEDOM[case.probe, case.effect]
    expected = SIGMAS**2 + freedom
    off = 4.0 * float(np.sqrt((4.0 * SIGMAS**2 + 2.0 * freedom) / len(flights)))
    what = f"{case.probe} {case.effect}: drop of chi-squared at {SIGMAS:g} sigmas"
    limits = f"{expected - off:.1f} to {expected + off:.1f}"
    return Finding(what, f"{mean:.1f}", limits, abs(mean - expected) < off)


def _drop(case: Case, hide: dict[str, list[float]], seed: int) -> float:
    noise = dict.fromkeys(OUTPUTS[case.probe], NOISE[case.probe])
    flight = fly(case.probe, hide, seed, case.rows)

    def square(effects: Sequence[str]) -> float:
        fitted = fit(PROBES[case.probe], flight, noise=noise, effects=effects, threads=1)
        return sum(rmse**2 for rmse in fitted.rmse.values()) * case.rows / NOISE[case.probe] ** 2

    return square([]) - square(flight.effects)
