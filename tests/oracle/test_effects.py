# SPDX-License-Identifier: BSD-3-Clause
"""The oracle's probes and effects against facts that they do not contain."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from oracle import drivers
from oracle.attitude_independent_magnetometer import AttitudeIndependentMagnetometer
from oracle.effect_cases import (
    ATTITUDE_INDEPENDENT,
    FIVE_HOLE,
    MAGNETOMETER,
    PITOT_STATIC,
    VANE_BOOM,
    EffectCase,
)
from oracle.effect_records import (
    Hidden,
    hide_in_five_hole,
    hide_in_magnetometer,
    hide_in_norm,
    hide_in_pitot_static,
    hide_in_vane_boom,
)
from oracle.maximum_likelihood import fit_at_fixed_noise
from oracle.model import Array, Model, Record
from oracle.pitot_static import PitotStatic

ALL = [
    *((hide_in_five_hole, case) for case in FIVE_HOLE),
    *((hide_in_vane_boom, case) for case in VANE_BOOM),
    *((hide_in_pitot_static, case) for case in PITOT_STATIC),
    *((hide_in_magnetometer, case) for case in MAGNETOMETER),
    *((hide_in_norm, case) for case in ATTITUDE_INDEPENDENT),
]


IN_TIME = ("time_offset", "vane_time_offset", "pneumatic_lag", "vane_lag", "sensor_lag")


@pytest.fixture(params=ALL, ids=lambda pair: f"{pair[0].__name__[8:]}-{pair[1].name}")
def hidden(request: pytest.FixtureRequest) -> Hidden:
    """Each effect on each probe in turn."""
    hide: Callable[[EffectCase], Hidden] = request.param[0]
    return hide(request.param[1])


# --- the probes


def assert_jacobian(model: Model, record: Record, xi: Array) -> None:
    """Against a complex step, which is good to rounding."""
    steps = 1e-30j * np.eye(xi.size)
    expected = np.stack([model.predict(record, xi + s).imag / 1e-30 for s in steps], axis=-1)
    actual = model.jacobian(record, xi)
    assert_allclose(actual, expected, rtol=1e-11, atol=1e-12 * np.abs(expected).max())


def test_jacobian_of_a_pitot_static_tube() -> None:
    rng = np.random.default_rng(1)
    record = dict(zip(("vn", "ve", "vd"), rng.normal(20, 5, (3, 40)), strict=True))
    xi = np.array([0.95, 0.4, 2.0, -1.0, 0.3])
    assert_jacobian(PitotStatic(), record, xi)
    driven = {"airspeed_scale": 0.1, "airspeed_bias": 2.0, "pressure_offset": 30.0, "rho": 0.2}
    record |= {name: size * rng.uniform(0.5, 1, 40) for name, size in driven.items()}
    assert_jacobian(PitotStatic(), record, xi)


def test_a_tube_in_a_flight_worked_out_by_hand() -> None:
    """5 m/s of 3, 4 over ground against the wind; the tube reads 2 % less and 1 m/s more."""
    record = {"vn": np.array([4.0]), "ve": np.array([2.0]), "vd": np.array([0.5])}
    xi = np.array([0.98, 1.0, 1.0, -2.0, 0.5])
    assert_allclose(PitotStatic().predict(record, xi), [[0.98 * 5.0 + 1.0]])
    record |= {"airspeed_scale": np.array([0.25]), "airspeed_bias": np.array([-5.0])}
    assert_allclose(PitotStatic().predict(record, xi), [[0.98 * 8.0 + 1.0]])
    record |= {"pressure_offset": np.array([14.0]), "rho": np.array([1.0])}
    assert_allclose(PitotStatic().predict(record, xi), [[0.98 * 6.0 + 1.0]])


def test_jacobian_of_a_magnetometer_of_known_strength() -> None:
    rng = np.random.default_rng(2)
    record = dict(zip(("mx", "my", "mz"), rng.normal(0, 40, (3, 40)), strict=True))
    xi = np.array([0.1, -0.2, 0.15, 0.05, -0.1, 0.08, 4.0, -3.0, 2.0])
    for noise in (0.0, 5.0):
        assert_jacobian(AttitudeIndependentMagnetometer(50.0, noise), record, xi)
    record |= {"scale": rng.normal(0, 0.1, 40), "axis_scale_y": rng.normal(0, 0.1, 40)}
    assert_jacobian(AttitudeIndependentMagnetometer(50.0, 5.0), record, xi)


def test_strength_residuals_are_white_noise_of_the_sensor() -> None:
    """Mean zero and deviation sigma over a million readings: what mu and the gain are for.

    Without mu the mean would be off by tens of its standard errors. Four standard errors are
    exceeded with probability 6e-5.
    """
    rng = np.random.default_rng(3)
    rows, strength, sigma = 1_000_000, 50.0, 2.0
    direction = rng.standard_normal((3, rows))
    field = strength * direction / np.linalg.norm(direction, axis=0)
    xi = np.array([0.2, -0.1, 0.1, 0.1, -0.05, 0.15, 12.0, -7.0, 3.0])
    soft = np.array([[1, 0.1, -0.05], [0.1, 1, 0.15], [-0.05, 0.15, 1]])
    reading = soft @ np.diag([1.2, 0.9, 1.1]) @ field + np.array([[12.0], [-7.0], [3.0]])
    reading = reading + sigma * rng.standard_normal((3, rows))
    record = dict(zip(("mx", "my", "mz"), reading, strict=True))
    residual = -AttitudeIndependentMagnetometer(strength, sigma).predict(record, xi)
    assert abs(residual.mean()) < 4 * sigma / np.sqrt(rows)
    assert residual.std() == pytest.approx(sigma, rel=2e-3)
    without = -AttitudeIndependentMagnetometer(strength, 0.0).predict(record, xi)
    assert abs(without.mean()) > 20 * sigma / np.sqrt(rows)


# --- drivers


def test_natural_spline_is_that_of_scipy_between_and_a_line_beyond_the_knots() -> None:
    knots, values = np.array([0.0, 1.0, 3.0, 4.0]), np.array([0.0, 2.0, -1.0, 3.0])
    d = np.linspace(0, 4, 50)
    phi = drivers.spline("d", knots).function({"d": d}, np.empty(0))
    assert_allclose(values[1:] @ phi, CubicSpline(knots, values, bc_type="natural")(d), atol=1e-14)
    outside = drivers.spline("d", knots).function({"d": np.array([-1.0, 4, 5, 6])}, np.empty(0))
    below, at_end, one, two = values[1:] @ outside
    assert two - one == pytest.approx(one - at_end)
    slope = CubicSpline(knots, values, bc_type="natural")(0.0, 1)
    assert below == pytest.approx(-slope)


def test_an_interpolated_sine_is_shifted_and_differentiated() -> None:
    time = 0.05 * np.arange(400)
    inside = slice(40, -40)  # away from the ends, where a natural spline has no curvature
    shifted = drivers.interpolate(time, np.sin(time), 0.13)
    assert_allclose(shifted[inside], np.sin(time + 0.13)[inside], atol=1e-7)
    slope = drivers.interpolate(time, np.sin(time), 0.0, derivative=1)
    assert_allclose(slope[inside], np.cos(time)[inside], atol=1e-6)
    by_shift = drivers.interpolate(time, np.sin(time), 0.13 + 1e-30j).imag / 1e-30
    assert_allclose(by_shift[inside], np.cos(time + 0.13)[inside], atol=1e-4)


def test_a_lag_solves_its_differential_equation() -> None:
    """Against SciPy's integration of tau dz/dt + z = sin t."""
    time, tau = 0.05 * np.arange(300), 0.4
    solved = solve_ivp(
        lambda t, z: (np.sin(t) - z) / tau,
        (0, time[-1]),
        [0.0],
        t_eval=time,
        rtol=1e-10,
        atol=1e-12,
    )
    assert_allclose(drivers.lag(time, np.sin(time), tau)[150:-20], solved.y[0][150:-20], atol=1e-6)


# --- the compositions


def test_an_effect_of_no_size_leaves_the_model_as_it_is(hidden: Hidden) -> None:
    """Its coefficients are zero; a shape alone does nothing."""
    model = hidden.model().model
    own = len(hidden.base.parameters)
    xi = hidden.truth.copy()
    shapes = tuple(f".{name}" for name in ("exponent", "tau", "t0"))
    for k, name in enumerate(model.parameters[own:]):
        in_time = hidden.case.name in IN_TIME
        if not name.endswith(shapes):
            xi[own + k] = 0.0
        elif in_time:
            xi[own + k] = 1e-9
    used = model.rows_used(hidden.record)
    expected = hidden.base.predict(hidden.record, xi[:own])[:, used]
    assert_allclose(model.predict(hidden.record, xi), expected, rtol=0, atol=1e-5)


def test_an_effect_of_its_size_changes_the_record_beyond_its_noise(hidden: Hidden) -> None:
    model = hidden.model().model
    own = len(hidden.base.parameters)
    without = hidden.base.predict(hidden.record, hidden.truth[:own])[
        :, model.rows_used(hidden.record)
    ]
    change = np.abs(model.predict(hidden.record, hidden.truth) - without)
    assert np.max(change / hidden.noise[:, np.newaxis]) > 1


def test_a_fit_finds_what_was_hidden(hidden: Hidden) -> None:
    """Every parameter within five standard errors, away from what the noise's own mu adds."""
    found = fit_at_fixed_noise(hidden.model(), hidden.record, hidden.noise, hidden.start)
    deviation = np.abs(found.values - hidden.start) / found.standard_errors
    assert np.max(deviation) < 5, dict(zip(hidden.model().parameters, deviation, strict=True))
