# SPDX-License-Identifier: BSD-3-Clause
"""The oracle against facts that it does not contain: complex steps, closed forms, known values."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from oracle.cases import CASE_NAMES, Case, state_case
from oracle.closed_form import fit_field_map, fit_scalar_example_1
from oracle.five_hole_probe import FiveHoleProbe, rotate_to_navigation
from oracle.magnetometer import compose, compose_derivative
from oracle.maximum_likelihood import fit_at_fixed_noise, fit_with_noise
from oracle.model import Array
from oracle.residual_sampling import estimate_linear
from oracle.vane_boom import VaneBoom


@pytest.fixture(params=CASE_NAMES)
def case(request: pytest.FixtureRequest) -> Case:
    """Each problem in turn."""
    return state_case(request.param)


def test_jacobian_is_the_complex_step_derivative(case: Case) -> None:
    """Im f(xi + ih) / h has no cancellation: it is good to rounding, at any small h."""
    xi = case.truth + 0.03 * np.random.default_rng(7).standard_normal(case.truth.size)
    steps = 1e-30j * np.eye(xi.size)
    expected = np.stack(
        [case.model.predict(case.record, xi + step).imag / 1e-30 for step in steps], axis=-1
    )
    actual = case.model.jacobian(case.record, xi)
    assert_allclose(actual, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())


def test_prediction_is_affine_in_the_linear_parameters(case: Case) -> None:
    """A xi1 + b, read off the derivative at xi1 = 0, is the prediction at any xi1."""
    n_1 = len(case.model.linear)
    xi = case.truth + 0.5 * np.random.default_rng(8).standard_normal(case.truth.size)
    a, b = case.model.affine(case.record, xi[n_1:])
    assert_allclose(a @ xi[:n_1] + b, case.model.predict(case.record, xi), rtol=1e-12, atol=1e-11)


def test_attitude_is_the_321_sequence_of_scipy() -> None:
    """Yaw, pitch, roll about the moving axes; Eq. 39 as printed would fail here."""
    angles = np.random.default_rng(9).uniform(-1.5, 1.5, size=(3, 20))
    record = dict(zip(("yaw", "pitch", "roll"), angles, strict=True))
    expected = Rotation.from_euler("ZYX", angles.T).as_matrix()
    assert_allclose(rotate_to_navigation(record), expected, atol=1e-14)


def test_five_hole_probe_in_a_flight_worked_out_by_hand() -> None:
    """20 m/s, alpha = beta = 0, yawed east at 1 rad/s, the probe 0.5 m ahead, 3 m/s of wind."""
    model = FiveHoleProbe(k_alpha=4.0, k_beta=4.0, lever_arm=(0.5, 0.0, 0.0))
    values = {"yaw": np.pi / 2, "r": 1.0, "pt": 100_200.0, "ps": 100_000.0, "rho": 1.0}
    names = ("roll", "pitch", "yaw", "p", "q", "r", "pt", "ps", "dpa", "dpb", "rho")
    record = {name: np.array([values.get(name, 0.0)]) for name in names}
    xi = np.zeros(10)
    xi[2:5] = (3.0, 0.0, -1.0)
    # w x r = (0, 0.5, 0) in the body; its negative, 0.5 m/s to port, points north when flying east
    expected = np.array([[0.5 + 3.0], [20.0], [-1.0]])
    assert_allclose(model.predict(record, xi), expected, atol=1e-12)


@pytest.mark.parametrize(
    ("channel", "expected"),
    [("dpa", (0.8, 0.0, 0.6)), ("dpb", (0.8, 0.6, 0.0))],
)
def test_flow_angles_have_the_signs_of_the_pressures(
    channel: str, expected: tuple[float, float, float]
) -> None:
    """Level and heading north, atan2(3, 4) of alpha moves air along body z, of beta along y."""
    model = FiveHoleProbe(k_alpha=4.0, k_beta=4.0)
    names = ("roll", "pitch", "yaw", "p", "q", "r", "ps", "dpa", "dpb")
    record = {name: np.zeros(1) for name in names} | {"pt": np.array([0.5]), "rho": np.ones(1)}
    record[channel] = np.array([4.0 * 0.5 * np.arctan2(3, 4)])
    assert_allclose(model.predict(record, np.zeros(10))[:, 0], expected, atol=1e-15)


def test_vanes_point_along_the_air_that_they_meet() -> None:
    """Air of 3-4-12 over the axes: 13 m/s, the vanes at their angles in their own planes."""
    names = ("roll", "pitch", "yaw", "p", "q", "r")
    record = {name: np.zeros(1) for name in names} | {
        "airspeed": np.array([13.0]),
        "alpha": np.array([np.arctan2(4, 12)]),
        "beta": np.array([np.arctan2(-3, 12)]),
    }
    expected = np.array([[12.0], [-3.0], [4.0]])
    assert_allclose(VaneBoom().predict(record, np.zeros(10)), expected, atol=1e-13)


def test_small_soft_iron_and_misalignment_enter_with_their_signs() -> None:
    """To first order C = I + diag(lambda) + [eta x] + alpha; entry (3, 2) of Eq. A2 is +eta_x."""
    lambda_, eta, (xy, xz, yz) = (1e-6, 2e-6, 3e-6), (4e-6, 5e-6, 6e-6), (7e-6, 8e-6, 9e-6)
    xi = np.array([*lambda_, 0, 0, 0, *eta, xy, xz, yz])
    expected = np.eye(3) + np.array(
        [
            [lambda_[0], -eta[2] + xy, eta[1] + xz],
            [eta[2] + xy, lambda_[1], -eta[0] + yz],
            [-eta[1] + xz, eta[0] + yz, lambda_[2]],
        ]
    )
    assert_allclose(compose(xi), expected, rtol=0, atol=1e-9)


def test_probe_rolled_by_a_quarter_turn_exchanges_the_flow_angles() -> None:
    """At eps_phi = pi/2, C(eps) of Eq. 38 takes air along the probe's z to the body's y."""
    model = FiveHoleProbe(k_alpha=4.0, k_beta=4.0)
    names = ("roll", "pitch", "yaw", "p", "q", "r", "ps", "dpb")
    record = {name: np.zeros(1) for name in names} | {"pt": np.array([0.5]), "rho": np.ones(1)}
    record["dpa"] = np.array([4.0 * 0.5 * np.arctan2(3, 4)])
    xi = np.zeros(10)
    xi[-1] = np.pi / 2
    assert_allclose(model.predict(record, xi)[:, 0], (0.8, 0.6, 0.0), atol=1e-15)


def test_soft_iron_acts_on_the_misaligned_scaled_field() -> None:
    """C_alpha C_eta C_lambda multiplied by hand, alpha_xy = 0.5, eta_x = 0.2, lambda_z = 1."""
    xi = np.zeros(12)
    xi[[2, 6, 9]] = (1.0, 0.2, 0.5)
    assert_allclose(compose(xi), [[1, 0.5, -0.2], [0.5, 1, -0.4], [0, 0.2, 2]], atol=1e-15)


@pytest.mark.parametrize("method", ["trf", "lm"])
def test_fit_recovers_the_truth_from_clean_measurements(case: Case, method: str) -> None:
    """Without noise the minimum is the truth itself."""
    exact = case.model.predict(case.record, case.truth)
    record = case.record | dict(zip(case.model.outputs, exact, strict=True))
    estimate = fit_at_fixed_noise(case.model, record, case.noise, 0.8 * case.truth, method)
    assert_allclose(estimate.values, case.truth, rtol=1e-11)


def test_fit_is_stationary_and_its_covariance_the_inverse_hessian(case: Case) -> None:
    """The whitened gradient vanishes, whichever of SciPy's methods led there."""
    by_trf = fit_at_fixed_noise(case.model, case.record, case.noise, case.truth, "trf")
    by_lm = fit_at_fixed_noise(case.model, case.record, case.noise, case.truth, "lm")
    assert np.all(np.abs(by_trf.values - by_lm.values) < 1e-10 * by_trf.standard_errors)

    whitened = by_trf.residual / case.noise[:, np.newaxis]
    tangent = case.model.jacobian(case.record, by_trf.values)
    tangent = tangent / case.noise[:, np.newaxis, np.newaxis]
    gradient = np.einsum("jkp,jk->p", tangent, whitened)
    size = np.linalg.norm(tangent, axis=(0, 1)) * np.linalg.norm(whitened)
    assert np.all(np.abs(gradient) < 1e-12 * size)

    hessian = np.einsum("jkp,jkq->pq", tangent, tangent)
    assert_allclose(by_trf.covariance @ hessian, np.eye(case.truth.size), atol=1e-7)


def test_alternation_ends_at_the_likelihood_of_the_noise(case: Case) -> None:
    """R = SSE_j / N there, and no other R close by has a smaller J."""
    estimate = fit_with_noise(case.model, case.record, case.truth)
    assert_allclose(estimate.noise, estimate.rmse, rtol=1e-12)
    for factor in (0.99, 1.01):
        other = fit_at_fixed_noise(
            case.model, case.record, factor * estimate.noise, estimate.values
        )
        assert other.cost > estimate.cost


def test_scalar_example_1_agrees_with_its_closed_form() -> None:
    """A sinusoid's amplitude and phase are a linear regression on cosine and sine."""
    case = state_case("scalar_1")
    estimate = fit_at_fixed_noise(case.model, case.record, case.noise, case.truth)
    assert_allclose(estimate.values, fit_scalar_example_1(case.record), rtol=1e-11)


def test_magnetometer_agrees_with_its_closed_form() -> None:
    """C and n are a linear regression of each output, values and covariances alike."""
    case = state_case("magnetometer")
    estimate = fit_at_fixed_noise(case.model, case.record, case.noise, case.truth)
    field_map = fit_field_map(case.record)
    assert_allclose(compose(estimate.values), field_map.matrix, atol=1e-12)
    assert_allclose(estimate.values[3:6], field_map.bias, rtol=1e-11)

    # dC/dxi carries the covariance of xi over to that of C, row i of which has its own noise
    by_matrix = np.moveaxis(compose_derivative(estimate.values), 0, -1).reshape(9, 9)
    matrix_parameters = np.r_[0:3, 6:12]
    covariance = estimate.covariance[np.ix_(matrix_parameters, matrix_parameters)]
    expected = np.kron(np.diag(case.noise**2), field_map.unit_covariance[:3, :3])
    size = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    actual: Array = by_matrix @ covariance @ by_matrix.T
    assert np.all(np.abs(actual - expected) < 1e-10 * size)


def test_stage_one_gradient_is_the_slope_of_trace_r(case: Case) -> None:
    """Central differences of Tr[R] away from its minimum."""
    xi2 = case.truth[len(case.model.linear) :] + 0.05
    at_xi2 = estimate_linear(case.model, case.record, xi2)
    step = 1e-5
    numeric = [
        (
            estimate_linear(case.model, case.record, xi2 + step * axis).trace_r
            - estimate_linear(case.model, case.record, xi2 - step * axis).trace_r
        )
        / (2 * step)
        for axis in np.eye(xi2.size)
    ]
    assert_allclose(at_xi2.gradient, numeric, rtol=1e-6, atol=1e-6 * np.abs(numeric).max())


def test_stage_one_steps_end_where_the_fit_with_equal_noise_does(case: Case) -> None:
    """Repeated steps reach the xi2 and xi1 of the full problem at R = I."""
    n_1 = len(case.model.linear)
    whole = fit_at_fixed_noise(case.model, case.record, np.ones(case.noise.size), case.truth)
    xi2 = case.truth[n_1:]
    for _ in range(40):
        at_xi2 = estimate_linear(case.model, case.record, xi2)
        xi2 = xi2 - np.linalg.solve(at_xi2.curvature, at_xi2.gradient)
    last = estimate_linear(case.model, case.record, xi2)
    assert_allclose(np.concatenate([last.xi1, xi2]), whole.values, rtol=1e-9)
    assert last.trace_r == pytest.approx(np.sum(whole.rmse**2), rel=1e-12)
