# SPDX-License-Identifier: BSD-3-Clause
"""Each effect: hidden by the simulator, added to the fit, and do its intervals cover?

60 flights each, seeds 0 to 59, or as many as SEPCAL_SEEDS says (400 take ten minutes). A 95 %
interval that holds covers between 48 and 60 of 60, or 360 and 395 of 400, but for one parameter in
50,000 on either side (binomial): the 130 parameters here would fail a correct build with other
seeds 0.5 % of the time. The simulator shares no code with effects.
"""

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom
from scipy.stats import t as student_t

import sepcal
from sepcal.study import cases
from sepcal.study.cases import Case

SEEDS = int(os.environ.get("SEPCAL_SEEDS", "60"))
ERROR_RATE = 2e-5  # of one parameter, on either side

PROBES: dict[str, sepcal.Model] = {
    **cases.PROBES,
    "magnetometer-norm": sepcal.Magnetometer(field_strength=float(np.hypot(19.7, 49.4))),
}

# What the study hides, a fast effect of the five-hole probe in more rows; then what it leaves out.
CASES = [
    *(
        replace(case, rows=2400) if case.probe == "five-hole" and case.rows > 500 else case
        for case in cases.CASES
    ),
    Case("five-hole", "pressure_offset[current_a^n]", 4.0),
    Case("five-hole", "compressibility", 1.0),
    Case("pitot-static", "wind[spline(time,4)]", (1, 0.5, -1, 0.3, -0.4, 0.8)),
    Case("magnetometer", "bias[spline(time,4)]", 1.0),
    Case("magnetometer-norm", "bias[current_a]", (0.3, -0.2, 0.25)),
    Case("magnetometer-norm", "scale[temp_degc]", 0.003),
    Case("magnetometer-norm", "axis_scale[temp_degc]", (0.004, -0.003, 0.002)),
    Case("magnetometer-norm", "bias_step", (2.0, -1.5, 1.0)),
]

# The field's strength shows no rotation: without misalignment C is the same for both models.
STRAIGHT = {f"eta_{axis}": 0.0 for axis in "xyz"}


def fly_and_fit(case: Case, seed: int) -> tuple[sepcal.Calibration, dict[str, float]]:
    norm = case.probe == "magnetometer-norm"
    flight = sepcal.simulate(
        "magnetometer" if norm else PROBES[case.probe],
        parameters=STRAIGHT if norm else None,
        hide={case.effect: case.size},
        rows=case.rows,
        seed=seed,
    )
    fit = sepcal.fit(
        PROBES[case.probe],
        flight,
        effects=[case.effect],
        samples=16,
        descents=2,
        threads=1,
    )
    return fit, flight.truth


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.probe} {case.effect}")
def test_intervals_of_an_added_effect_cover(case: Case) -> None:
    """Every parameter of the effect, by the two-sided 95 % interval of Student's t."""
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        results = list(pool.map(lambda seed: fly_and_fit(case, seed), range(SEEDS)))
    assert {fit.status for fit, _ in results} == {"converged"}
    fewest, most = binom.ppf([ERROR_RATE, 1 - ERROR_RATE], SEEDS, 0.95)
    outside = {}
    for name in (name for name in results[0][0].names if name.startswith(case.effect + ".")):
        errors = np.array([fit[name].value - truth[name] for fit, truth in results])
        if results[0][0][name].fixed:  # a step's time, found by a scan: to a row, as a rule
            flight_time = {"five-hole": 120.0, "pitot-static": 120.0}.get(case.probe, 80.0)
            rows_off = np.abs(errors) * case.rows / flight_time
            assert np.mean(rows_off <= 1.0) > 0.9, name
            # A step across the field hardly shows in its strength.
            assert np.mean(rows_off <= 5.0) > 0.99, name
            continue
        degrees = case.rows * len(PROBES[case.probe].outputs) - len(results[0][0].names)
        widths = student_t.ppf(0.975, degrees) * np.array(
            [fit[name].standard_error for fit, _ in results]
        )
        covered = int(np.sum(np.abs(errors) < widths))
        if not fewest <= covered <= most:
            outside[name] = f"{covered} of {SEEDS}, mean error {errors.mean():.2g}"
    assert outside == {}
