# SPDX-License-Identifier: BSD-3-Clause
"""A late inertial unit along a path whose residual drifts, on flights by splines."""

import numpy as np
import pytest

import sepcal
from cases import but_first_slow
from oracle import late_flight

LAGS = ("imu_late", "attitude_late")
POOL = (
    *LAGS,
    *("airdata_late", "alpha_late", "gyro_bias[time]", "accel_bias[time]", "wind[time]"),
    *("alpha_bias[time]", "attitude_bias[time]", "gyro_scale", "accel_scale"),
)
HELD = dict.fromkeys(("lambda_v", "b_theta", "b_ay", "b_p", "b_r"), 0.0)


def fit_path(flight: sepcal.Flight) -> sepcal.AircraftFit:
    """The longitudinal path by output error."""
    model = sepcal.FlightPath(measured=["v", "phi", "psi"], outputs=["airspeed", "alpha", "pitch"])
    return sepcal.fit(model, flight, fix=HELD, threads=1)


@pytest.mark.parametrize("seed", range(3))
def test_a_late_unit_and_an_attitude_are_told_as_one_family(seed: int) -> None:
    late = 0.018  # s
    fit = fit_path(sepcal.Flight(late_flight.fly(seed, late=late)))
    diagnosis = fit.diagnose(only=POOL)
    assert diagnosis.verdict == "effect_missing"
    assert diagnosis.advice.effect in LAGS
    told = {effect.name: effect for effect in diagnosis.effects}
    (other,) = set(LAGS) - {diagnosis.advice.effect}
    assert told[other].beside == "equivalent"
    assert "one lag that this flight can't place" in diagnosis.sentence
    tau = fit.add("imu_late")["imu_late.tau"]
    assert abs(tau.value - late) < max(4 * tau.standard_error, 0.004)


@pytest.mark.parametrize("seed", but_first_slow(range(100, 104)))
def test_no_lag_is_found_where_none_is(seed: int) -> None:
    flight = sepcal.Flight(late_flight.fly(seed, gust=0.6, drift=2.0))
    found = fit_path(flight).diagnose(only=POOL).effects
    assert not [e for e in found if e.status == "found" and e.name in LAGS]


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
