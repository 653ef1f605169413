# SPDX-License-Identifier: BSD-3-Clause
"""Derivatives of models in Python: supplied, or by differences that find their step and side."""

# ruff: noqa: RUF012

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import sepcal
from oracle.cases import CASE_NAMES, state_case
from own_models import BOX, BUILT_IN, Twin, WindBox, WithDerivatives


def test_supplied_derivatives_are_those_of_differences() -> None:
    point = [0.1], [1.05, -3.8, 2.4]
    A, b, by_differences = sepcal.OwnModel(WindBox()).evaluate(BOX, *point)
    supplied_A, supplied_b, supplied = sepcal.OwnModel(WithDerivatives()).evaluate(BOX, *point)
    assert_array_equal(A, supplied_A)
    assert_array_equal(b, supplied_b)
    expected = np.stack([-np.sin(BOX["psi"] + 0.1), np.cos(BOX["psi"] + 0.1)], axis=-1)
    expected *= 1.05 * BOX["v"][:, np.newaxis]
    assert_allclose(supplied[..., 0], expected, rtol=1e-14, atol=1e-14)
    assert_allclose(by_differences[..., 0], expected, rtol=0, atol=1e-11 * np.abs(expected).max())
    fits = [sepcal.fit(model, BOX, samples=50) for model in (WindBox(), WithDerivatives())]
    errors = [fits[0][name].standard_error for name in fits[0].names]
    assert np.all(np.abs(fits[0].values - fits[1].values) < 1e-9 * np.array(errors))


def test_derivatives_are_asked_instead_of_differences() -> None:
    calls = {"at": 0, "derivatives": 0}

    class Counting(WithDerivatives):
        def at(self, u, xi2):
            calls["at"] += 1
            return super().at(u, xi2)

        def derivatives(self, u, xi2):
            calls["derivatives"] += 1
            return super().derivatives(u, xi2)

    sepcal.OwnModel(Counting()).evaluate(BOX, [0.1], [1.0, 0.0, 0.0])
    assert calls == {"at": 1, "derivatives": 1}


class OneColumn:
    """z = b(x, p), whatever `curve` is; p within [lower, upper]."""

    inputs = {"x": "1"}
    outputs = {"z": "1"}
    linear = {}

    def __init__(self, curve, lower, upper):
        self.curve = curve
        self.nonlinear = {"p": ("1", lower, upper)}

    def at(self, u, xi2):
        """A without columns, and b."""
        return np.zeros((len(u.x), 1, 0)), self.curve(u.x, xi2[0])[:, np.newaxis]


def differentiate(model: OneColumn, x: np.ndarray, p: float) -> np.ndarray:
    """dz/dp by sepcal's differences, (N,)."""
    return sepcal.OwnModel(model).evaluate({"x": x}, [p], [])[2][:, 0, 0]


@pytest.mark.parametrize("p", [0.0, 1e-9, 0.5, 1.0 - 1e-9, 1.0])
def test_differences_stay_within_the_bounds(p: float) -> None:
    def curve(x, p):
        assert 0.0 <= p <= 1.0
        return np.exp(x * p)

    x = np.linspace(-1.0, 1.0, 9)
    actual = differentiate(OneColumn(curve, 0.0, 1.0), x, p)
    assert_allclose(actual, x * np.exp(x * p), rtol=0, atol=1e-11)


@pytest.mark.parametrize("p", [0.3, 0.3 + 1e-9, 0.5, 0.7 - 1e-9, 0.7])
def test_differences_turn_away_from_nan(p: float) -> None:
    """There is an answer for 0.3 <= p <= 0.7 alone, which the bounds don't say."""

    def curve(x, p):
        return np.exp(x * p) if 0.3 <= p <= 0.7 else np.full_like(x, np.nan)

    x = np.linspace(-1.0, 1.0, 9)
    actual = differentiate(OneColumn(curve, -10.0, 10.0), x, p)
    assert_allclose(actual, x * np.exp(x * p), rtol=0, atol=1e-11)


def test_differences_of_a_few_rows_turn_away_from_nan() -> None:
    x = np.array([0.5, 1.0, 2.0])

    def curve(x, p):  # sqrt(x - p), where there is one
        return np.sqrt(np.where(x >= p, x - p, np.nan))

    actual = differentiate(OneColumn(curve, -10.0, 10.0), x, 0.9999)
    assert np.isnan(actual[0])
    assert_allclose(actual[2], -0.5 / np.sqrt(x[2] - 0.9999), rtol=1e-10)


@pytest.mark.parametrize(("lower", "upper"), [(0.0, 1.0), (-1e6, 1e6), (None, None)])
def test_differences_find_their_step(lower: float | None, upper: float | None) -> None:
    """A frequency times a time of up to 1e4: it bends over 1e-4 of what the bounds say."""
    t = np.linspace(0.0, 1e4, 50)
    model = OneColumn(lambda t, p: np.sin(p * t), lower, upper)
    expected = t * np.cos(0.013 * t)
    actual = differentiate(model, t, 0.013)
    assert_allclose(actual, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


def test_the_derivative_of_nothing_is_nothing() -> None:
    x = np.linspace(1.0, 2.0, 5)
    assert_array_equal(differentiate(OneColumn(lambda x, p: x, 0.0, 1.0), x, 0.3), 0.0)


@pytest.mark.parametrize("name", CASE_NAMES)
def test_differences_by_inputs_are_the_dual_numbers_of_cpp(name: str) -> None:
    """What an effect on an input takes: pressures near 1e5 Pa, angles and rates near zero."""
    case = state_case(name)
    columns = {column: case.record[column] for column in BUILT_IN[name].inputs}
    n_1, places = len(case.model.linear), list(range(len(columns)))
    point = case.truth[n_1:], case.truth[:n_1], places
    expected = BUILT_IN[name]._core.input_tangent(columns, *point)
    actual = sepcal.OwnModel(Twin(case))._core.input_tangent(columns, *point)
    scale = np.abs(expected).max(axis=0)
    assert np.all(scale > 0)
    assert_allclose(actual / scale, expected / scale, rtol=0, atol=1e-9)
