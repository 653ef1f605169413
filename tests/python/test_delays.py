# SPDX-License-Identifier: BSD-3-Clause
"""The delay of a sensor beside a receiver whose velocity is noisy: right wherever it falls.

An interpolated velocity has less noise between two rows than on them, so that a cost with a delay
in it would be least midway, whatever the delay is.
"""

import numpy as np
import pytest
from scipy.stats import chi2

import sepcal

SEEDS = range(12)


def fit_delay(late: float, noise: float, seed: int) -> tuple[float, float]:
    """Error of the delay that is fitted, and its standard error [s]."""
    flown = sepcal.simulate("pitot-static", noise={"airspeed": 1e-9}, rate=50, seed=seed)
    then = np.array(flown["time_s"])
    draw = np.random.default_rng([seed, round(1000 * late)])
    time = np.arange(then[0] + 1.0, then[-1] - 1.0, 0.1)
    airspeed = np.interp(time - late, then, flown["airspeed_mps"])
    log = {"time_s": time, "airspeed_mps": airspeed + draw.normal(0.0, 0.1, time.size)}
    for axis in "ned":
        velocity = np.interp(time, then, flown[f"v{axis}_mps"])
        log[f"v{axis}_mps"] = np.round(velocity + draw.normal(0.0, noise, time.size), 3)
    fit = sepcal.fit(sepcal.PitotStatic(), sepcal.Flight(log), effects=["time_offset"])
    tau = fit["time_offset.tau"]
    return tau.value - late, tau.standard_error


@pytest.mark.slow
@pytest.mark.parametrize("noise", [0.02, 0.1])
def test_a_delay_of_whole_rows(noise: float):
    """Squared errors over squared standard errors, 36 of each noise; 1 in 1,000 by chance."""
    errors = np.array([fit_delay(late, noise, s) for late in (0.0, 0.1, 0.25) for s in SEEDS])
    ratios = errors[:, 0] / errors[:, 1]
    low, high = chi2.ppf([0.0005, 0.9995], ratios.size)
    assert low < np.sum(ratios**2) < high, ratios
