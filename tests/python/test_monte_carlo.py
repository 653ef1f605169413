# SPDX-License-Identifier: BSD-3-Clause
"""Stated uncertainties in eight flights of two sensors; `scripts/study monte-carlo` flies 2,000.

Together eight flights show errors that are a third too small, and any larger fault.
"""

import pytest

import sepcal
from studies import monte_carlo

FLIGHTS = 8
SENSORS = ["five-hole", "magnetometer"]


@pytest.fixture(scope="module")
def studies() -> dict[str, sepcal.MonteCarlo]:
    return monte_carlo.fly_sensors(range(FLIGHTS), workers=1)


@pytest.mark.parametrize("sensor", SENSORS)
def test_eight_flights_keep_the_limits(studies, sensor):
    """Coverage of every parameter, bias, and the squared error in the covariance's metric."""
    findings = monte_carlo.check(sensor, studies[sensor])
    assert [one for one in findings if not one.holds] == []
    names = studies[sensor].names
    assert len(findings) == 2 * len(names) + 2


@pytest.mark.parametrize("sensor", SENSORS)
def test_a_truth_that_is_two_standard_errors_off_shows(studies, sensor):
    flown = studies[sensor]
    truth = flown.truth[0] + 2.0 * flown.standard_errors[0]
    off = sepcal.MonteCarlo(flown.trials, dict(zip(flown.names, truth, strict=True)))
    assert [one for one in monte_carlo.check(sensor, off) if not one.holds] != []


def test_limits_of_the_whole_study():
    """As they always were: 93 to 97 %, 4.1 sigma, 6 %."""
    lowest, highest = monte_carlo.coverage_limits(2000)
    assert (lowest, highest) == pytest.approx((0.93, 0.97), abs=5e-5)
    assert monte_carlo.bias_limit(2000) == 4.1
    assert monte_carlo.coverage_limits(8) == (4 / 8, 1)
