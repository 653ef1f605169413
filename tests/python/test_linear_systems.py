# SPDX-License-Identifier: BSD-3-Clause
"""Steps of linear and nonlinear systems from Python, against SciPy."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad_vec, solve_ivp
from scipy.linalg import expm
from scipy.signal import cont2discrete

import sepcal
from refusals import refuse

rng = np.random.default_rng(11)


@pytest.mark.parametrize("n", [1, 2, 5, 30])
@pytest.mark.parametrize("size", [0.0, 0.1, 3.0])
def test_the_exponential_is_scipys(n: int, size: float) -> None:
    A = size * rng.standard_normal((n, n))
    expected = expm(A)
    assert_allclose(sepcal.matrix_exponential(A), expected, atol=1e-13 * np.abs(expected).max())


def test_a_step_of_noise_is_its_integral() -> None:
    F, G = rng.standard_normal((4, 4)), rng.standard_normal((4, 2))
    density, dt = G @ np.diag([0.3, 2.0]) @ G.T, 0.7
    step = sepcal.discretise(F, density, dt)
    Q, _ = quad_vec(lambda s: expm(F * s) @ density @ expm(F * s).T, 0.0, dt, epsabs=1e-13)
    assert_allclose(step.Phi, expm(F * dt), rtol=1e-12)
    assert_allclose(step.Q, Q, rtol=1e-10, atol=1e-12)
    assert step.x is None


@pytest.mark.parametrize(("inputs", "method"), [("held", "zoh"), ("linear", "foh")])
def test_inputs_over_a_step_are_scipys(inputs: str, method: str) -> None:
    F, B, dt = rng.standard_normal((3, 3)), rng.standard_normal((3, 2)), 0.3
    step = sepcal.discretise_inputs(F, B, dt)
    if inputs == "held":
        assert_allclose(
            step.held, cont2discrete((F, B, np.eye(3), np.zeros((3, 2))), dt, method)[1]
        )
        return
    u = lambda t: np.array([1.0 + 2.0 * t, 3.0 - t])  # noqa: E731
    solved = solve_ivp(lambda t, x: F @ x + B @ u(t), (0, dt), np.zeros(3), rtol=1e-12, atol=1e-14)
    assert_allclose(step.begin @ u(0.0) + step.end @ u(dt), solved.y[:, -1], rtol=1e-9)


def pendulum(x: np.ndarray, _t: float) -> list[float]:
    return [x[1], -9.81 * np.sin(x[0]) - 0.2 * x[1]]


def test_a_nonlinear_system_goes_as_scipy_integrates_it() -> None:
    """x; Phi by moved starts; and Q by the variational equation along the way."""
    begin, end, Q = 0.3, 0.5, np.array([[0.4]])
    at = np.array([0.6, -1.0])
    step = sepcal.propagate(
        pendulum, at, Q, begin, end, noise_input=lambda *_: [[0.0], [1.0]], longest_step=0.002
    )

    def go(x: np.ndarray, t: float = begin) -> np.ndarray:
        return solve_ivp(lambda t, x: pendulum(x, t), (t, end), x, rtol=1e-12, atol=1e-13).y[:, -1]

    def slope(x: np.ndarray, t: float = begin) -> np.ndarray:
        h = 1e-5
        return np.column_stack([(go(x + h * e, t) - go(x - h * e, t)) / (2 * h) for e in np.eye(2)])

    assert_allclose(step.x, go(at), rtol=1e-9)
    assert_allclose(step.Phi, slope(at), atol=1e-5)
    way = solve_ivp(lambda t, x: pendulum(x, t), (begin, end), at, rtol=1e-11, dense_output=True)

    def brought(t: float) -> np.ndarray:
        noise = (slope(way.sol(t), t) @ [[0.0], [1.0]]) if t < end else np.array([[0.0], [1.0]])
        return 0.4 * noise @ noise.T

    expected, _ = quad_vec(brought, begin, end, epsabs=1e-9, limit=20)
    assert_allclose(step.Q, expected, rtol=1e-3, atol=1e-9)
    exact = sepcal.propagate(
        pendulum, at, Q, begin, end, noise_input=lambda *_: [[0.0], [1.0]], longest_step=0.002,
        rate_jacobian=lambda x, _t: [[0.0, 1.0], [-9.81 * np.cos(x[0]), -0.2]],
    )  # fmt: skip
    assert_allclose(step.Phi, exact.Phi, rtol=1e-9)
    filter = sepcal.Filter(at, np.eye(2))
    filter.predict(step.Phi, step.Q, x=step.x)
    assert_allclose(filter.x, step.x)


def test_what_is_refused() -> None:
    refuse(lambda: sepcal.matrix_exponential([[1.0, 2.0]]), "A", "(1, 2)", "(1, 1)")
    refuse(lambda: sepcal.matrix_exponential([[np.nan]]), "A", "not a finite")
    refuse(lambda: sepcal.discretise(np.eye(2), np.eye(3), 0.1), "density", "(3, 3)")
    refuse(lambda: sepcal.discretise(np.eye(2), np.eye(2), np.inf), "time")
    refuse(lambda: sepcal.discretise_inputs(np.eye(2), np.ones((3, 1)), 0.1), "B", "(3, 1)")
    refuse(lambda: sepcal.matrix_exponential(1e300 * np.eye(2)), "exp(A)", "range of numbers")
    refuse(lambda: sepcal.discretise(np.eye(2), np.eye(2), 1000), "range of numbers", "shorter")
    refuse(lambda: sepcal.discretise(np.eye(2), -np.eye(2), 0.1), "density is no covariance")
    refuse(lambda: sepcal.discretise(np.eye(2), np.eye(2), -0.1), "dt is -0.1")
    one = np.eye(1)
    refuse(lambda: sepcal.propagate(lambda x, t: 0.0, [0.0], one, 0, 1), "rate(x, t)", "()")
    refuse(lambda: sepcal.propagate(lambda x, t: -x, 1.0, one, 0, 1), "x", "()", "vector")
    refuse(lambda: sepcal.propagate(lambda x, t: -x, [1.0], one, 1, 0), "end - begin is -1")
    refuse(
        lambda: sepcal.propagate(lambda x, t: -x, [1.0], one, 0, 1, longest_step=1e-9),
        "longest_step is 1e-09",
        "a longer one",
    )
    refuse(lambda: sepcal.propagate(lambda x, t: [1.0, 2.0], [0.0], one, 0, 1), "rate(x, t)", "2")
    refuse(lambda: sepcal.propagate(lambda x, t: x + np.inf, [0.0], one, 0, 1), "not finite")
    refuse(
        lambda: sepcal.propagate(lambda x, t: x, [0.0], np.eye(2), 0, 1), "Q", "(2, 2)", "(1, 1)"
    )
    refuse(lambda: sepcal.discretise(one, one, None), "dt is None")  # type: ignore[arg-type]
    refuse(lambda: sepcal.propagate(pendulum, [0.0, 0.0], one, 0, 1), "Q", "(1, 1)", "(2, 2)")
    refuse(
        lambda: sepcal.propagate(pendulum, [0.0, 0.0], np.eye(2), 0, 1, longest_step=0),
        "longest_step",
    )
    with pytest.raises(ZeroDivisionError):
        sepcal.propagate(lambda x, t: 1 / 0, [0.0], one, 0, 1)
