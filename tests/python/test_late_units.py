# SPDX-License-Identifier: BSD-3-Clause
"""A late inertial unit along a path whose residual drifts, on flights by splines."""

import numpy as np
import pytest

import sepcal
from oracle import late_flight
from studies import late_units


@pytest.mark.parametrize("seed", range(3))
def test_a_late_unit_and_an_attitude_are_told_as_one_family(seed: int) -> None:
    late = 0.018  # s
    fit = late_units.fit_path(sepcal.Flight(late_flight.fly(seed, late=late)))
    diagnosis = fit.diagnose(only=late_units.POOL)
    assert diagnosis.verdict == "effect_missing"
    assert diagnosis.advice.effect in late_units.LAGS
    told = {effect.name: effect for effect in diagnosis.effects}
    (other,) = set(late_units.LAGS) - {diagnosis.advice.effect}
    assert told[other].beside == "equivalent"
    assert "one lag that this flight can't place" in diagnosis.sentence
    tau = fit.add("imu_late")["imu_late.tau"]
    assert abs(tau.value - late) < max(4 * tau.standard_error, 0.004)


@pytest.mark.parametrize("seed", range(100, 104))
def test_no_lag_is_found_where_none_is(seed: int) -> None:
    flight = sepcal.Flight(late_flight.fly(seed, gust=0.6, drift=2.0))
    assert late_units.find_lags(flight) == []


def test_what_is_simulated_is_what_a_unit_reads() -> None:
    """Rates integrate to the attitude, forces to the velocity: by trapezes, without noise."""
    draws = np.random.default_rng(5)
    motion = late_flight.Motion(draws, 1.0)
    t = np.linspace(0.0, 10.0, 20001)
    _, _, _, p, q, r = motion.unit(t)
    phi, theta, _ = motion.attitude(t).T
    dtheta = q * np.cos(phi) - r * np.sin(phi)
    dphi = p + np.tan(theta) * (q * np.sin(phi) + r * np.cos(phi))
    for angle, rate in ((theta, dtheta), (phi, dphi)):
        assert np.trapezoid(rate, t) == pytest.approx(angle[-1] - angle[0], abs=1e-6)
