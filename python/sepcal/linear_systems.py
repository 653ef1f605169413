# SPDX-License-Identifier: BSD-3-Clause
"""Linear systems over a step of time, and nonlinear ones by their linearisation."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sepcal import _core
from sepcal.arguments import checked
from sepcal.columns import Array
from sepcal.differences import CENTRAL, Fan, step_sizes
from sepcal.matrices import finite, to_covariance, to_matrix, to_number, to_vector
from sepcal.states_module import states_module

MOST_STEPS = 1e6  # the compiled code's limit


@checked
def matrix_exponential(A: ArrayLike) -> Array:
    """exp(A), (n, n), by scaling, a Pade approximant and squaring (S 3.9).

    Raises:
        Error: A is not square, or not finite, or exp(A) is beyond the range of numbers.

    Example:
        >>> sepcal.matrix_exponential([[0.0, 0.1], [0.0, 0.0]]).tolist()
        [[1.0, 0.1], [0.0, 1.0]]
    """
    exponential: Array = states_module().matrix_exponential(finite("A", to_matrix("A", A)))
    return _in_range("exp(A)", exponential)


@dataclass(frozen=True)
class Transition:
    """A step of a system with noise: what Filter.predict() is told.

    Attributes:
        Phi: (n, n), exp(F dt).
        Q: Covariance of the noise that the step adds to the state, (n, n).
        x: The state at its end, (n,); None of a linear system, where it is Phi x.

    Example:
        >>> step = sepcal.discretise([[0.0, 1.0], [0.0, 0.0]], np.zeros((2, 2)), 0.1)
        >>> step.Phi.tolist(), step.x is None
        ([[1.0, 0.1], [0.0, 1.0]], True)
    """

    Phi: Array
    Q: Array
    x: Array | None = None


@checked
def discretise(F: ArrayLike, density: ArrayLike, dt: float) -> Transition:
    """A step of x' = F x + w, exact (Van Loan 1978).

        step = sepcal.discretise(F, G @ Q @ G.T, dt)
        filter.predict(step.Phi, step.Q)

    Args:
        F: (n, n) [1/s].
        density: Density of w, G Q G', (n, n) [state^2/s].
        dt: [s].

    Raises:
        Error: Another shape, what is not finite, a density that is no covariance, a step back in
            time, or one so long that the result is beyond the range of numbers.

    Example:
        >>> step = sepcal.discretise([[0.0, 1.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 1.0]], 0.1)
        >>> step.Phi.tolist()
        [[1.0, 0.1], [0.0, 1.0]]
    """
    Phi, Q = states_module().discretise(
        finite("F", to_matrix("F", F)), to_covariance("density", density), _duration("dt", dt)
    )
    return Transition(_in_range("exp(F dt)", Phi), _in_range("Q", Q))


@dataclass(frozen=True)
class DiscreteInputs:
    """The share that inputs add to a state over a step of time.

    Attributes:
        held: (n_x, n_u): x(k+1) = Phi x(k) + held u(k).
        begin: (n_x, n_u), of inputs that are linear between samples:
        end: (n_x, n_u): x(k+1) = Phi x(k) + begin u(k) + end u(k+1).

    Example:
        >>> parts = sepcal.discretise_inputs([[0.0]], [[1.0]], 0.1)  # an integral
        >>> parts.held.round(9).tolist(), parts.begin.round(9).tolist(), parts.end.round(9).tolist()
        ([[0.1]], [[0.05]], [[0.05]])
    """

    held: Array
    begin: Array
    end: Array


@checked
def discretise_inputs(F: ArrayLike, B: ArrayLike, dt: float) -> DiscreteInputs:
    """The share of u in x' = F x + B u over a step. Held inputs lag linear ones by half of it.

    Args:
        F: (n_x, n_x) [1/s].
        B: (n_x, n_u).
        dt: [s].

    Raises:
        Error: Another shape, or what is not finite.

    Example:
        >>> sepcal.discretise_inputs([[-1.0]], [[1.0]], 0.1).held.round(4).tolist()  # 1 - exp(-0.1)
        [[0.0952]]
    """
    parts = states_module().discretise_inputs(
        finite("F", to_matrix("F", F)), finite("B", to_matrix("B", B)), _duration("dt", dt)
    )
    return DiscreteInputs(*(_in_range("what inputs add", part) for part in parts))


Rate = Callable[[Array, float], ArrayLike]


@checked
def propagate(
    rate: Rate,
    x: ArrayLike,
    Q: ArrayLike,
    begin: float,
    end: float,
    *,
    rate_jacobian: Rate | None = None,
    noise_input: Rate | None = None,
    longest_step: float = math.inf,
) -> Transition:
    """A step of x' = f(x, t) + G(x, t) w, for an extended filter (S 3.1 to 3.11).

        step = sepcal.propagate(fall, filter.x, Q, t[k], t[k + 1])
        filter.predict(step.Phi, step.Q, x=step.x)

    The state goes by Runge and Kutta's fourth order, Phi and Q by discretise() at the state
    half-way through each step.

    Args:
        rate: f(x, t), (n,). Inputs u(t) are its own business.
        x: The state at `begin`, (n,).
        Q: Density of w, (n_w, n_w) [unit^2 s].
        begin: [s].
        end: [s], not before `begin`.
        rate_jacobian: df/dx at (x, t), (n, n) [differences of fourth order].
        noise_input: G at (x, t), (n, n_w) [the identity].
        longest_step: [s]; the time between is cut into equal steps of at most that.

    Raises:
        Error: Another shape, or what is not finite, also of what the functions give.
        Exception: Whatever the functions raise.

    Example:
        >>> step = sepcal.propagate(lambda x, t: -x, [1.0], [[0.0]], 0.0, 0.1)
        >>> step.x.round(4).tolist(), step.Phi.round(4).tolist()  # exp(-0.1)
        ([0.9048], [[0.9048]])
    """
    state = finite("x", to_vector("x", x))
    identity = np.eye(len(state))
    if not to_number("longest_step", longest_step) > 0.0:
        raise _core.Error(f"longest_step is {longest_step}; it is a time above 0 [s]")
    duration = _duration("end - begin", to_number("end", end) - to_number("begin", begin))
    density = to_covariance("Q", Q)
    if noise_input is None and density.shape != identity.shape:
        raise _core.Error(f"Q has the shape {density.shape}; here it takes {identity.shape}")
    if duration / longest_step > MOST_STEPS:
        raise _core.Error(
            f"longest_step is {longest_step:g} s, which cuts {duration:g} s into more than "
            f"{MOST_STEPS:.0e} steps; give a longer one"
        )

    fan = Fan([CENTRAL] * len(state))

    def jacobian(at: Array, t: float) -> Array:
        if rate_jacobian is not None:
            return finite(
                "rate_jacobian(x, t)", to_matrix("rate_jacobian(x, t)", rate_jacobian(at, t))
            )
        steps = step_sizes(at)
        points = at[:, np.newaxis] + steps[:, np.newaxis] * fan.offsets
        rates = np.array([rate(point, t) for point in points.T])
        with np.errstate(invalid="ignore"):  # what is not finite is refused below
            return rates.T @ fan.weights / steps

    def input_of_noise(at: Array, t: float) -> Array:
        if noise_input is None:
            return identity
        return to_matrix("noise_input(x, t)", noise_input(at, t))

    moved, Phi, noise = states_module().propagate(
        lambda at, t: to_vector("rate(x, t)", rate(at, t)),
        jacobian,
        input_of_noise,
        state,
        density,
        float(begin),
        float(end),
        float(longest_step),
    )
    if not all(np.isfinite(part).all() for part in (moved, Phi, noise)):
        raise _core.Error(f"x is not finite on the way from {begin:g} to {end:g} s")
    return Transition(Phi, noise, moved)


def _duration(name: str, seconds: float) -> float:
    if not 0.0 <= to_number(name, seconds) < math.inf:
        raise _core.Error(f"{name} is {seconds}; it is a time, 0 or more [s]")
    return float(seconds)


def _in_range(name: str, result: Array) -> Array:
    if not np.isfinite(result).all():
        raise _core.Error(f"{name} is beyond the range of numbers; take a shorter step")
    return result
