# SPDX-License-Identifier: BSD-3-Clause
"""The same minimum as SciPy's least_squares with the oracle's analytic Jacobians.

At the same fixed R, every parameter to 1e-8 of the larger of its value and its standard error,
every white standard error to 1e-6; where a closed form exists, against that as well.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal
from oracle.cases import CASE_NAMES, Case, state_case
from oracle.closed_form import fit_field_map, fit_scalar_example_1
from oracle.magnetometer import compose
from oracle.maximum_likelihood import (
    Estimate,
    fit_at_fixed_noise,
    fit_with_loss,
    fit_with_noise,
)
from oracle.model import Array
from own_models import BUILT_IN


@pytest.fixture(scope="module", params=CASE_NAMES)
def case(request: pytest.FixtureRequest) -> Case:
    """Each problem in turn."""
    return state_case(request.param)


@pytest.fixture(scope="module")
def expected(case: Case) -> Estimate:
    """SciPy's answer at the noise that the record was simulated with."""
    return fit_at_fixed_noise(case.model, case.record, case.noise, case.truth)


@pytest.fixture(scope="module", params=["joint", "projected"])
def fit(request: pytest.FixtureRequest, case: Case) -> sepcal.Fit:
    """The answer of sepcal at the same noise, by both second stages."""
    return fit_case(case, request.param, case.noise_by_output)


def fit_case(case: Case, second_stage: str, noise: dict[str, float] | None) -> sepcal.Fit:
    """A fit that has to converge off its bounds, or SciPy's unbounded one is another problem."""
    fit = sepcal.fit(
        BUILT_IN[case.name],
        case.record,
        bounds=case.bounds,
        noise=noise,
        second_stage=second_stage,
        seed=0,
    )
    assert fit.status == "converged", fit.message
    assert fit.second_stage == second_stage
    assert not any(parameter.at_bound for parameter in fit.parameters.values())
    return fit


def assert_values_agree(actual: Array, expected: Array, standard_errors: Array) -> None:
    """To 1e-8 of the larger of a value and its standard error."""
    scale = np.maximum(np.abs(expected), standard_errors)
    assert_allclose(actual / scale, expected / scale, rtol=0, atol=1e-8)


def test_tables_agree(case: Case) -> None:
    """Both sides speak of the same quantities in the same order."""
    model = BUILT_IN[case.name]
    assert model.outputs == case.model.outputs
    assert model.linear == case.model.linear
    assert model.nonlinear == case.model.nonlinear
    assert set(model.inputs) | set(model.outputs) == set(case.record)


def test_values(fit: sepcal.Fit, expected: Estimate, case: Case) -> None:
    """Every parameter, in the array and by name."""
    assert tuple(fit.names) == case.model.parameters
    assert_values_agree(fit.values, expected.values, expected.standard_errors)
    by_name = [fit.parameters[name].value for name in case.model.parameters]
    assert_allclose(by_name, fit.values, rtol=0)


def test_standard_errors(fit: sepcal.Fit, expected: Estimate, case: Case) -> None:
    """White ones, unscaled since R is given."""
    white = [fit.parameters[name].standard_error_white for name in case.model.parameters]
    assert_allclose(white, expected.standard_errors, rtol=1e-6)


def test_covariance(fit: sepcal.Fit, expected: Estimate) -> None:
    """Every entry to 1e-6 of its two standard errors."""
    scale = np.outer(expected.standard_errors, expected.standard_errors)
    assert_allclose(fit.covariance_white / scale, expected.covariance / scale, rtol=0, atol=1e-6)


def test_cost_and_rmse(fit: sepcal.Fit, expected: Estimate, case: Case) -> None:
    """J of Eq. 6 without a constant, and the residual in the output's own unit."""
    assert fit.cost == pytest.approx(expected.cost, rel=1e-12)
    assert_allclose([fit.rmse[name] for name in case.model.outputs], expected.rmse, rtol=1e-9)
    assert fit.noise == pytest.approx(case.noise_by_output, rel=1e-15)


@pytest.mark.parametrize("second_stage", ["joint", "projected"])
def test_estimated_noise(case: Case, second_stage: str) -> None:
    """R = SSE_j / N at the end, the covariance scaled by M / (M - n).

    Two alternations stop at different turns: 1e-6 of a standard error is what they have in common.
    """
    fit = fit_case(case, second_stage, noise=None)
    expected = fit_with_noise(case.model, case.record, case.truth)
    measurements = expected.residual.size
    scale = np.sqrt(measurements / (measurements - expected.values.size))
    standard_errors = scale * expected.standard_errors

    assert np.all(np.abs(fit.values - expected.values) < 1e-6 * standard_errors)
    assert_allclose([fit.noise[name] for name in case.model.outputs], expected.noise, rtol=1e-6)
    white = [fit.parameters[name].standard_error_white for name in case.model.parameters]
    assert_allclose(white, standard_errors, rtol=1e-6)


@pytest.mark.parametrize(("loss", "width"), [("huber", 1.345), ("cauchy", 2.385), ("cauchy", 1.1)])
def test_losses(case: Case, loss: str, width: float) -> None:
    """The minimum of SciPy's own loss, f_scale being the width, on a record with outliers."""
    record = {name: np.array(column, dtype=float) for name, column in case.record.items()}
    for deviation, name in zip(case.noise, case.model.outputs, strict=True):
        record[name][3::25] += 12.0 * deviation
        record[name][14::25] -= 9.0 * deviation
    expected = fit_with_loss(case.model, record, case.noise, case.truth, loss, width)
    fit = sepcal.fit(
        BUILT_IN[case.name],
        record,
        bounds=case.bounds,
        noise=case.noise_by_output,
        loss=loss,
        loss_width=width,
        coloured_errors=False,
    )
    assert fit.status == "converged", fit.message
    assert fit.second_stage == "joint"
    standard_errors = np.sqrt(np.diag(expected.covariance))
    assert_values_agree(fit.values, expected.values, standard_errors)
    scale = np.outer(standard_errors, standard_errors)
    assert_allclose(fit.covariance_white / scale, expected.covariance / scale, rtol=0, atol=1e-6)
    assert_allclose(fit.covariance, fit.covariance_white)
    assert fit.cost == pytest.approx(expected.cost, rel=1e-12)


@pytest.mark.parametrize("second_stage", ["joint", "projected"])
def test_scalar_example_1_against_its_closed_form(second_stage: str) -> None:
    """Amplitude and phase of a sinusoid by linear regression."""
    case = state_case("scalar_1")
    fit = fit_case(case, second_stage, case.noise_by_output)
    standard_errors = np.sqrt(np.diag(fit.covariance_white))
    assert_values_agree(fit.values, fit_scalar_example_1(case.record), standard_errors)


@pytest.mark.parametrize("second_stage", ["joint", "projected"])
def test_magnetometer_against_its_closed_form(second_stage: str) -> None:
    """C recomposed from soft iron, misalignment and scale; C and n by linear regression.

    The regression's own standard errors set the scale, as they do for the parameters.
    """
    case = state_case("magnetometer")
    fit = fit_case(case, second_stage, case.noise_by_output)
    field_map = fit_field_map(case.record)
    standard_errors = np.outer(case.noise, np.sqrt(np.diag(field_map.unit_covariance)))
    assert_values_agree(compose(fit.values), field_map.matrix, standard_errors[:, :3])
    assert_values_agree(fit.values[3:6], field_map.bias, standard_errors[:, 3])
