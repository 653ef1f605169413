# SPDX-License-Identifier: BSD-3-Clause
"""The new probes, and every effect on every probe, at the minimum that SciPy finds.

The oracle's models with effects are NumPy written from the equations; least_squares fits them from
the truth. Values agree to 1e-8 of the larger of value and standard error, white standard errors to
1e-6; where sepcal averages over a lag by three nodes, to the case's own tolerance.
"""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal
from oracle.attitude_independent_magnetometer import AttitudeIndependentMagnetometer
from oracle.cases import K_ALPHA, K_BETA, LEVER_ARM
from oracle.effect_cases import (
    ATTITUDE_INDEPENDENT,
    FIVE_HOLE,
    LONGEST,
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
from oracle.maximum_likelihood import Estimate, fit_at_fixed_noise
from oracle.model import Model

NO_EFFECT = EffectCase("", lambda *_: (), ())
HIDING = {
    "five-hole": (hide_in_five_hole, FIVE_HOLE),
    "vane-boom": (hide_in_vane_boom, VANE_BOOM),
    "pitot-static": (hide_in_pitot_static, (NO_EFFECT, *PITOT_STATIC)),
    "magnetometer": (hide_in_magnetometer, MAGNETOMETER),
    "norm": (hide_in_norm, (NO_EFFECT, *ATTITUDE_INDEPENDENT)),
}
ALL = [(probe, case) for probe, (_, cases) in HIDING.items() for case in cases]


def make_model(probe: str, hidden: Hidden) -> sepcal.Model:
    """What sepcal calls the probe."""
    if probe == "five-hole":
        return sepcal.FiveHoleProbe(k_alpha=K_ALPHA, k_beta=K_BETA, lever_arm=LEVER_ARM)
    if probe == "vane-boom":
        return sepcal.VaneBoom(lever_arm=LEVER_ARM)
    if probe == "pitot-static":
        return sepcal.PitotStatic()
    if probe == "magnetometer":
        return sepcal.Magnetometer()
    assert isinstance(hidden.base, AttitudeIndependentMagnetometer)
    return sepcal.Magnetometer(field_strength=hidden.base.field_strength)


def fit_hidden(probe: str, hidden: Hidden, second_stage: str) -> sepcal.Fit:
    """A fit that has to converge off its bounds."""
    case = hidden.case
    bounds = dict.fromkeys(case.delays, (-LONGEST, LONGEST))
    bounds |= dict.fromkeys(case.lags, (0.0, LONGEST))
    if probe == "norm":
        bounds |= dict.fromkeys(("n_x", "n_y", "n_z"), (-100.0, 100.0))
    fit = sepcal.fit(
        make_model(probe, hidden),
        hidden.record,
        effects=[name for name in case.name.split("+") if name],
        bounds=bounds,
        fix=hidden.held,
        noise=dict(zip(hidden.base.outputs, map(float, hidden.noise), strict=True)),
        second_stage=second_stage,
        samples=None if probe == "norm" else 100,  # a strength begins at the ellipsoid
        seed=0,
    )
    assert fit.status == "converged", fit.message
    assert not any(parameter.at_bound for parameter in fit.parameters.values())
    return fit


def find_times(fit: sepcal.Fit, case: EffectCase) -> dict[str, float] | None:
    """The t0 of a step that sepcal's scan found and held, for the oracle to hold as well."""
    if not case.start_time:
        return None
    parameter = fit.parameters[case.start_time]
    assert parameter.fixed
    return {case.start_time: parameter.value}


def assert_same_minimum(
    fit: sepcal.Fit, expected: Estimate, model: Model, tolerance: float
) -> None:
    """Values, white standard errors, correlation, cost and rmse."""
    values = np.array([fit.parameters[name].value for name in model.parameters])
    errors = expected.standard_errors
    scale = np.maximum(np.abs(expected.values), errors) if tolerance < 1e-6 else errors
    assert_allclose(values / scale, expected.values / scale, rtol=0, atol=tolerance)
    exact = tolerance < 1e-6
    white = [fit.parameters[name].standard_error_white for name in model.parameters]
    assert_allclose(white, errors, rtol=1e-6 if exact else 1e-2)
    places = [fit.names.index(name) for name in model.parameters]
    product = np.outer(errors, errors)
    assert_allclose(
        fit.covariance_white[np.ix_(places, places)] / product,
        expected.covariance / product,
        rtol=0,
        atol=1e-6 if exact else 1e-2,
    )
    assert fit.cost == pytest.approx(expected.cost, rel=1e-11 if exact else 1e-3)
    rmse = [fit.rmse[name] for name in model.outputs]
    assert_allclose(rmse, expected.rmse, rtol=1e-9 if exact else 1e-3)


@pytest.mark.parametrize("second_stage", ["joint", "projected"])
@pytest.mark.parametrize(("probe", "case"), ALL, ids=lambda value: getattr(value, "name", value))
def test_the_same_minimum(probe: str, case: EffectCase, second_stage: str) -> None:
    """By both second stages; parameters by the names that sepcal gives them."""
    hide: Callable[[EffectCase], Hidden] = HIDING[probe][0]
    hidden = hide(case)
    fit = fit_hidden(probe, hidden, second_stage)
    times = find_times(fit, case)
    model = hidden.model(times)
    free = {name for name, parameter in fit.parameters.items() if not parameter.fixed}
    assert free == set(model.parameters)
    expected = fit_at_fixed_noise(model, hidden.record, hidden.noise, hidden.start)
    assert_same_minimum(fit, expected, model, case.tolerance)
    assert fit.rows == np.count_nonzero(model.model.rows_used(hidden.record))
    if times is not None:
        assert abs(times[case.start_time] - hidden.times[case.start_time]) < 2.0


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 2, 1, 0), (1, 3, 0, 2)])
def test_the_order_of_effects_changes_nothing(order: tuple[int, ...]) -> None:
    """Four effects of different kinds on one probe."""
    case = FIVE_HOLE[-1]
    names = case.name.split("+")
    hidden = hide_in_five_hole(case)
    fits = [
        sepcal.fit(
            make_model("five-hole", hidden),
            hidden.record,
            effects=[names[k] for k in each],
            noise=dict(zip(hidden.base.outputs, map(float, hidden.noise), strict=True)),
            samples=100,
        )
        for each in (range(4), order)
    ]
    first, second = ({n: p.value for n, p in fit.parameters.items()} for fit in fits)
    assert second == pytest.approx(first, rel=1e-9, abs=1e-12)


def test_a_magnetometer_of_known_strength_on_a_flight() -> None:
    """Sigma is the residuals' own: the oracle fits in turn with it until it settles."""
    hidden = hide_in_norm(NO_EFFECT)
    assert isinstance(hidden.base, AttitudeIndependentMagnetometer)
    strength = hidden.base.field_strength
    headers = {"time": "time_s", "mx": "mx_ut", "my": "my_ut", "mz": "mz_ut"}
    flight = sepcal.Flight({header: hidden.record[name] for name, header in headers.items()})
    fit = sepcal.fit(sepcal.Magnetometer(field_strength=strength), flight)
    assert fit.status == "converged", fit.message

    sigma, values = 0.1, hidden.truth
    for _ in range(50):
        model = AttitudeIndependentMagnetometer(strength, sigma)
        estimate = fit_at_fixed_noise(model, hidden.record, [sigma], values)
        settled = abs(estimate.rmse[0] - sigma) < 1e-12 * sigma
        sigma, values = float(estimate.rmse[0]), estimate.values
        if settled:
            break
    errors = estimate.standard_errors
    found = np.array([fit.parameters[name].value for name in model.parameters])
    assert np.all(np.abs(found - estimate.values) < 1e-5 * errors)
    assert fit.noise["field"] == pytest.approx(sigma, rel=1e-7)
    scale = np.sqrt(estimate.residual.size / (estimate.residual.size - errors.size))
    white = [fit.parameters[name].standard_error_white for name in model.parameters]
    assert_allclose(white, scale * errors, rtol=1e-5)
