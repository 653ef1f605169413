# SPDX-License-Identifier: BSD-3-Clause
"""The rival estimators' oracles against closed forms, known truths and each other."""

import numpy as np
import pytest
from numpy.random import Generator
from numpy.testing import assert_allclose

from oracle.alonso_shuster import TwoStep, alonso_shuster, build_rows, square_and_slope, weights_at
from oracle.cases import Case, state_case
from oracle.closed_form import fit_scalar_example_1
from oracle.haupt_kasdin import (
    example_rows,
    example_states,
    first_step,
    quadric_rows,
    quadric_states,
    reduced_rows,
    reduced_states,
    second_step,
)
from oracle.magnetometer import soft_iron
from oracle.maximum_likelihood import fit_at_fixed_noise, fit_with_noise
from oracle.model import Array
from oracle.scalar_examples import ScalarExample1
from oracle.simulate import SCALAR_1_TRUTH, simulate_scalar
from oracle.single_stage import Solver, single_stage

STRENGTH = 53.0  # [uT]
# lambda_x..z, alpha_xy, alpha_xz, alpha_yz, n_x..z [uT]
ELLIPSOID = np.array([0.05, -0.04, 0.03, 0.02, -0.03, 0.01, 12.0, -7.0, 3.5])
MATRIX = soft_iron(ELLIPSOID[3:6]) @ np.diag(1 + ELLIPSOID[:3])
BIAS = ELLIPSOID[6:]
SOLVERS: tuple[Solver, ...] = ("trf", "slsqp")


def draw_directions(rng: Generator, rows: int) -> Array:
    """Unit vectors all over the sphere, shape (rows, 3)."""
    vectors = rng.standard_normal((rows, 3))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def read(
    strengths: float | Array, sigma: float, matrix: Array = MATRIX, rows: int = 200, seed: int = 3
) -> Array:
    """Readings C h + n + noise [uT], shape (rows, 3)."""
    rng = np.random.default_rng(seed)
    field = draw_directions(rng, rows) * np.reshape(strengths, (-1, 1))
    return np.asarray(field @ matrix.T + BIAS + sigma * rng.standard_normal((rows, 3)))


def draw_strengths(rows: int = 200) -> Array:
    """Field strengths between 30 and 60 uT, as along an orbit."""
    return np.random.default_rng(5).uniform(30.0, 60.0, rows)


@pytest.fixture(params=["scalar_1", "scalar_2", "five_hole", "magnetometer"])
def case(request: pytest.FixtureRequest) -> Case:
    """Problems of which some parameters are linear."""
    return state_case(request.param)


@pytest.fixture
def record() -> dict[str, Array]:
    """The paper's first example."""
    return simulate_scalar(ScalarExample1(), SCALAR_1_TRUTH, seed=11)


# The single stage


@pytest.mark.parametrize("solver", SOLVERS)
def test_single_stage_ends_at_the_maximum_likelihood_of_a_known_noise(
    case: Case, solver: Solver
) -> None:
    """From nearby and with bounds that do not bind."""
    expected = fit_at_fixed_noise(case.model, case.record, case.noise, case.truth)
    start, wide = 0.9 * case.truth, np.full(case.truth.size, 100.0)
    found = single_stage(case.model, case.record, start, -wide, wide, case.noise, solver)
    assert found.converged
    assert np.all(np.abs(found.xi - expected.values) < 1e-3 * expected.standard_errors)
    assert_allclose(found.cost, expected.cost, rtol=1e-7)
    assert_allclose(found.noise, case.noise)


@pytest.mark.parametrize("solver", SOLVERS)
def test_single_stage_estimates_the_noise_in_turn(case: Case, solver: Solver) -> None:
    """At a tight tolerance that is the joint minimum of Eq. 6."""
    expected = fit_with_noise(case.model, case.record, case.truth)
    wide = np.full(case.truth.size, 100.0)
    found = single_stage(case.model, case.record, case.truth, -wide, wide, None, solver, 1e-6)
    assert found.converged
    assert np.all(np.abs(found.xi - expected.values) < 1e-3 * expected.standard_errors)
    assert_allclose(found.noise, expected.noise, rtol=1e-5)


@pytest.mark.parametrize("solver", SOLVERS)
def test_single_stage_stays_within_its_bounds(record: dict[str, Array], solver: Solver) -> None:
    """With b held below its optimum the others are the linear regression at that b."""
    upper = np.array([10.0, 10.0, 0.02])
    found = single_stage(
        ScalarExample1(), record, np.zeros(3), -10 * np.ones(3), upper, np.array([0.3]), solver
    )
    assert fit_scalar_example_1(record)[2] > 0.03
    phase = record["eta"] + 0.02
    design = np.stack([np.cos(phase), np.ones_like(phase)], axis=-1)
    gain, c = np.linalg.lstsq(design, record["z"], rcond=None)[0]
    assert_allclose(found.xi, [gain - 1, c, 0.02], atol=1e-5)


# Haupt and Kasdin


def test_states_and_rows_of_the_example_are_its_prediction(record: dict[str, Array]) -> None:
    """H f(xi) = z, in both changes of variables, at any xi."""
    for xi in np.random.default_rng(1).uniform(-2, 2, (5, 3)):
        z = ScalarExample1().predict(record, xi)[0]
        assert_allclose(example_rows(record["eta"]) @ example_states(xi), z, atol=1e-13)
        assert_allclose(reduced_rows(record["eta"]) @ reduced_states(xi), z, atol=1e-13)


def test_reduced_states_lead_to_the_closed_form(record: dict[str, Array]) -> None:
    """As many states as parameters: a = hypot - 1, b = atan2, c as it is, at no cost."""
    first = first_step(reduced_rows(record["eta"]), record["z"])
    assert first.rank == 3
    p, q, c = first.y
    second = second_step(first, reduced_states, np.array([0.2, 0.1, 0.3]))
    assert_allclose(second.xi, [np.hypot(p, q) - 1, c, np.arctan2(q, p)], atol=1e-9)
    assert_allclose(second.xi, fit_scalar_example_1(record), atol=1e-9)
    assert second.cost < 1e-15


def test_second_step_has_the_covariance_of_the_likelihood(record: dict[str, Array]) -> None:
    """With the information as weight nothing is lost between the steps."""
    first = first_step(reduced_rows(record["eta"]), record["z"], 0.3)
    second = second_step(first, reduced_states, np.array([0.2, 0.1, 0.3]))
    expected = fit_at_fixed_noise(ScalarExample1(), record, [0.3], SCALAR_1_TRUTH)
    assert_allclose(second.covariance, expected.covariance, rtol=1e-6)


@pytest.mark.parametrize("rows", [5, 20, 1000])
def test_five_states_of_the_example_have_rank_three(rows: int) -> None:
    """Whatever the length; the paper blames short records alone. The fit is of least norm."""
    eta = np.linspace(1.0, 10.0, rows)
    xi = np.array([0.7, -0.4, 0.3])
    first = first_step(example_rows(eta), ScalarExample1().predict({"eta": eta}, xi)[0], 1.0)
    assert first.rank == 3
    gain = (1 + xi[0]) * np.array([np.cos(xi[2]), np.sin(xi[2])]) / 2
    assert_allclose(first.y, [*gain, *gain, xi[1]], atol=1e-12)


def test_second_cost_of_the_five_states_is_the_likelihood(record: dict[str, Array]) -> None:
    """With H' H / sigma^2 as weight it is twice Eq. 6 less a constant, at any xi."""
    first = first_step(example_rows(record["eta"]), record["z"], 0.3)
    differences = []
    for xi in np.random.default_rng(2).uniform(-3, 3, (20, 3)):
        misfit = first.y - example_states(xi)
        residual = record["z"] - ScalarExample1().predict(record, xi)[0]
        differences.append(misfit @ first.information @ misfit - residual @ residual / 0.3**2)
    assert_allclose(differences, differences[0], rtol=1e-11)

    second = second_step(first, example_states, np.array([0.2, 0.1, 0.3]))
    assert_allclose(second.xi, fit_scalar_example_1(record), atol=1e-8)
    assert np.all(np.isfinite(second.covariance))


def test_first_step_estimates_the_noise_of_its_residual(record: dict[str, Array]) -> None:
    """The root of SSE / M, which is the rmse of the likelihood's own fit."""
    first = first_step(example_rows(record["eta"]), record["z"])
    expected = fit_with_noise(ScalarExample1(), record, SCALAR_1_TRUTH)
    assert_allclose(first.sigma, expected.noise[0], rtol=1e-9)
    assert_allclose(
        first.information,
        first_step(example_rows(record["eta"]), record["z"], 1.0).information / first.sigma**2,
    )


def test_a_parameter_without_effect_has_no_covariance(record: dict[str, Array]) -> None:
    """NaN rather than an error."""
    first = first_step(reduced_rows(record["eta"]), record["z"], 0.3)
    second = second_step(first, lambda xi: reduced_states(xi[:3]), np.array([0.2, 0.1, 0.3, 1.0]))
    assert np.all(np.isnan(second.covariance))
    assert_allclose(second.xi[:3], fit_scalar_example_1(record), atol=1e-8)


def test_quadric_recovers_the_truth_from_clean_readings() -> None:
    """Both steps, and the states are the truth's own."""
    H, z = quadric_rows(read(STRENGTH, 0.0))
    first = first_step(H, z, 1.0)
    assert first.rank == 9
    assert_allclose(first.y, quadric_states(ELLIPSOID, STRENGTH), rtol=1e-9)
    second = second_step(first, lambda xi: quadric_states(xi, STRENGTH), np.zeros(9))
    assert second.converged
    assert_allclose(second.xi, ELLIPSOID, rtol=1e-8)


def test_quadric_inverts_its_states_with_noise() -> None:
    """Nine states and nine parameters: f(xi) = y, at no cost; Q and n follow from y by hand."""
    H, z = quadric_rows(read(STRENGTH, 0.3))
    first = first_step(H, z)
    second = second_step(first, lambda xi: quadric_states(xi, STRENGTH), np.zeros(9))
    assert second.cost < 1e-12
    yy, zz, xy, xz, yz = first.y[:5]
    ratio = np.array([[1, xy, xz], [xy, yy, yz], [xz, yz, zz]])  # Q / Q_xx
    bias = np.linalg.solve(ratio, first.y[5:8])
    assert_allclose(second.xi[6:], bias, rtol=1e-8)
    square = (bias @ ratio @ bias - first.y[8]) / STRENGTH**2  # 1 / Q_xx
    matrix = soft_iron(second.xi[3:6]) @ np.diag(1 + second.xi[:3])
    assert_allclose(matrix @ matrix.T, square * np.linalg.inv(ratio), rtol=1e-8)


# Alonso and Shuster


@pytest.mark.parametrize("reweight", [0, 1])
def test_twostep_recovers_the_truth_from_clean_readings(reweight: int) -> None:
    """With |h| varying, step one does so by itself; mu is left nothing by a tiny sigma."""
    strengths = draw_strengths()
    found = alonso_shuster(read(strengths, 0.0), strengths, 1e-7, reweight=reweight)
    assert found.converged
    assert_allclose(found.bias, BIAS, rtol=1e-8)
    assert_allclose(found.shape, MATRIX @ MATRIX.T, atol=1e-9)
    assert_allclose(found.centred, found.theta, rtol=1e-7)


def test_bias_only_twostep_recovers_the_truth_from_clean_readings() -> None:
    """Where C is I."""
    found = alonso_shuster(read(STRENGTH, 0.0, np.eye(3)), STRENGTH, 1e-7, bias_only=True)
    assert found.converged
    assert_allclose(found.bias, BIAS, rtol=1e-10)
    assert_allclose(found.centred, BIAS, rtol=1e-10)
    assert_allclose(found.shape, np.eye(3))


def test_step_one_says_nothing_where_the_strength_is_constant() -> None:
    """E = -I, c = 0 fits the centred equations exactly; step two recovers from theta = 0."""
    found = alonso_shuster(read(STRENGTH, 0.3), STRENGTH, 0.3)
    assert_allclose(found.centred, [0, 0, 0, -1, -1, -1, 0, 0, 0], atol=1e-10)
    assert found.converged
    assert_allclose(found.bias, BIAS, atol=0.3)
    assert_allclose(found.shape, MATRIX @ MATRIX.T, atol=0.02)


def slope_of_cost(readings: Array, strengths: float | Array, weights: Array, theta: Array) -> Array:
    """The gradient of the uncentred cost over its root mean square terms, shape of theta."""
    rows = build_rows(readings, theta.size == 3)
    square, slope = square_and_slope(theta)
    z = np.sum(readings**2, axis=1) - np.broadcast_to(strengths, readings.shape[:1]) ** 2
    terms = (rows - slope) * (weights * (z + 3 * 0.3**2 - rows @ theta + square))[:, np.newaxis]
    return np.asarray(terms.sum(axis=0) / np.linalg.norm(terms, axis=0))


@pytest.mark.parametrize("bias_only", [False, True])
@pytest.mark.parametrize("varying", [False, True])
def test_twostep_ends_where_its_cost_is_stationary(bias_only: bool, varying: bool) -> None:
    """The cost written without centring, at the weights that were held."""
    strengths = draw_strengths() if varying else STRENGTH
    readings = read(strengths, 0.3, np.eye(3) if bias_only else MATRIX)
    found = alonso_shuster(readings, strengths, 0.3, bias_only=bias_only, reweight=0)
    weights = weights_at(readings, np.zeros(found.theta.size), 0.3)
    assert_allclose(slope_of_cost(readings, strengths, weights, found.theta), 0, atol=1e-8)

    found = alonso_shuster(readings, strengths, 0.3, bias_only=bias_only, reweight_at="theta")
    before = alonso_shuster(readings, strengths, 0.3, bias_only=bias_only, reweight=0)
    weights = weights_at(readings, before.theta, 0.3)
    assert_allclose(slope_of_cost(readings, strengths, weights, found.theta), 0, atol=1e-8)


def test_slope_of_the_square_is_its_complex_step_derivative() -> None:
    """|b|^2 = c' inv(I + E) c by each number of theta."""
    theta = np.array([10.0, -6.0, 3.0, 0.1, -0.05, 0.08, 0.03, -0.02, 0.04])

    def square(at: Array) -> Array:
        xx, yy, zz, xy, xz, yz = at[3:]
        matrix = np.array([[1 + xx, xy, xz], [xy, 1 + yy, yz], [xz, yz, 1 + zz]])
        return np.asarray(at[:3] @ np.linalg.solve(matrix, at[:3]))

    expected = [square(theta + step).imag / 1e-30 for step in 1e-30j * np.eye(9)]
    assert_allclose(square_and_slope(theta)[1], expected, rtol=1e-12)


def test_weights_are_those_of_the_calibrated_reading() -> None:
    """sigma_k^2 = 4 sigma^2 |(I + D) B - b|^2 + 6 sigma^4; at the truth (I + D) B - b has |h|."""
    inverse = np.linalg.inv(MATRIX @ MATRIX.T)  # I + E
    E = inverse - np.eye(3)
    theta = np.array([*(inverse @ BIAS), *np.diag(E), E[0, 1], E[0, 2], E[1, 2]])
    expected = 1 / (4 * 0.3**2 * STRENGTH**2 + 6 * 0.3**4)
    assert_allclose(weights_at(read(STRENGTH, 0.0), theta, 0.3), expected, rtol=1e-12)


def test_errors_of_the_bias_are_those_that_twostep_states() -> None:
    """Over 200 records, to within four standard errors of the mean square."""
    squares = []
    for seed in range(200):
        readings = read(STRENGTH, 0.3, np.eye(3), rows=100, seed=seed)
        found = alonso_shuster(readings, STRENGTH, 0.3, bias_only=True)
        error = found.bias - BIAS
        squares.append(error @ np.linalg.solve(found.covariance, error))
    assert abs(np.mean(squares) - 3) < 4 * np.sqrt(6 / 200)


@pytest.fixture(scope="module")
def noisy() -> dict[float, TwoStep]:
    """By the sign of mu: a long record with much noise, where C is I."""
    readings = read(STRENGTH, 3.0, np.eye(3), rows=300_000)
    return {
        sign: alonso_shuster(
            readings, STRENGTH, 3.0, mean_sign=sign, reweight=2, reweight_at="theta"
        )
        for sign in (-1.0, 1.0)
    }


def test_the_mean_of_the_noise_is_plus_the_trace(noisy: dict[float, TwoStep]) -> None:
    """At the truth |h + e|^2 - |h|^2 has the mean 3 sigma^2, not the papers' -3 sigma^2.

    Their sign makes E too small by 6 sigma^2 / |h|^2 and leaves the bias alone.
    """
    residual = np.sum((read(STRENGTH, 3.0, np.eye(3), 300_000) - BIAS) ** 2, axis=1) - STRENGTH**2
    assert abs(np.mean(residual) - 27) < 4 * np.std(residual) / np.sqrt(residual.size)
    shift = np.mean(noisy[-1.0].theta[3:6]) - np.mean(noisy[1.0].theta[3:6])
    assert_allclose(shift, -6 * 3.0**2 / STRENGTH**2, rtol=0.05)
    scale = np.mean(noisy[1.0].theta[3:6])
    assert abs(scale) < 0.2 * abs(shift)
    assert_allclose(noisy[-1.0].bias, noisy[1.0].bias, atol=1e-3)
