# SPDX-License-Identifier: BSD-3-Clause
"""Certified values of NIST's 27 nonlinear regression sets, from both starts, nothing sampled.

The models are checked against NIST's numbers and complex steps first, so that what the fits are
compared with is independent of them.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal
from oracle import nist
from oracle.nist import NistSet
from oracle.nist_model import ValuesAlone

AIM = {"lower": 8.0, "average": 8.0, "higher": 6.0}  # digits of parameters and their deviations
AT_ROUNDING = {"Lanczos1": 3.0}  # its residuals of 1e-13 have no more digits, nor their deviations

both_starts = pytest.mark.parametrize("start", nist.STARTS)


@pytest.fixture(scope="module", params=nist.NAMES)
def given(request: pytest.FixtureRequest) -> NistSet:
    """Each set in turn."""
    return nist.state_set(request.param)


def test_model_has_the_certified_residuals(given: NistSet) -> None:
    """At the certified parameters, to the digits that these have."""
    residual = given.y - given.model.predict(given.inputs, given.certified)
    rounding = 1e-9 * np.max(np.abs(given.y))  # of parameters that are written with 11 digits
    assert np.sum(residual**2) == pytest.approx(
        given.residual_square, rel=1e-9, abs=residual.size * rounding**2
    )


def test_model_has_the_derivatives_of_its_values(given: NistSet) -> None:
    """A and b at complex parameters: Im f(xi + ih) / h, good to rounding."""
    xi2 = given.certified[len(given.model.linear) :]
    _, slopes = given.model.formula(given.inputs, xi2)
    for i in range(xi2.size):
        step = np.zeros(xi2.size, complex)
        step[i] = 1e-30j
        columns, _ = given.model.formula(given.inputs, xi2 + step)
        for column, of_column in zip(columns, slopes, strict=True):
            numeric, slope = np.broadcast_arrays(np.imag(column) / 1e-30, of_column[i])
            assert_allclose(slope, numeric, rtol=1e-11, atol=1e-11 * np.abs(numeric).max())


def test_model_has_its_symmetries(given: NistSet) -> None:
    """What counts as another way to write the curve gives the same one."""
    expected = given.model.predict(given.inputs, given.certified)
    for order, sign in given.model.list_equivalents():
        same = given.model.predict(given.inputs, given.certified[order] * sign)
        assert_allclose(same, expected, rtol=1e-12)


def assert_certified(given: NistSet, fit: sepcal.Fit) -> None:
    """The aim of its level, and nothing left open."""
    assert fit.status == "converged", fit.message
    digits = nist.digits_of(given, fit)
    assert digits.parameters >= AIM[given.level], digits
    assert digits.standard_deviations >= AT_ROUNDING.get(given.name, AIM[given.level]), digits
    assert digits.residual_square >= AT_ROUNDING.get(given.name, AIM[given.level]) - 1.0, digits


@both_starts
@pytest.mark.parametrize("second_stage", ["auto", "projected"])
def test_certified_digits(given: NistSet, start: int, second_stage: str) -> None:
    """27 of 27, from the far and from the near start."""
    assert_certified(given, nist.fit(given, start, second_stage))


@both_starts
def test_certified_digits_with_the_whole_jacobian(given: NistSet, start: int) -> None:
    """Golub and Pereyra's instead of Kaufman's: the same where nothing is linear."""
    assert_certified(given, nist.fit(given, start, "projected", jacobian="golub_pereyra"))


@both_starts
def test_certified_digits_jointly(given: NistSet, start: int) -> None:
    """Over all parameters at once; from MGH10's far start that takes thousands of iterations."""
    if (given.name, start) == ("MGH10", 0):
        stopped = nist.fit(given, start, "joint")
        assert stopped.status == "not_identifiable"
        assert "can't be told apart" in stopped.message
        assert_certified(given, nist.fit(given, start, "joint", iterations=20_000))
    else:
        assert_certified(given, nist.fit(given, start, "joint"))


def test_hahn1_by_differences_in_other_units() -> None:
    """With x in hundreds of kelvins: b7 is then of order 0.1, and the digits are all there."""
    given = nist.state_set("Hahn1")
    power = np.array([0, 1, 2, 3, 1, 2, 3])  # of x, by b1 ... b7
    for start in given.starts:
        scaled = start * 100.0**power
        fit = sepcal.fit(
            ValuesAlone(given.model),
            {"x": given.inputs[0] / 100.0, "y": given.y},
            start=dict(zip(given.model.nonlinear, scaled[4:].tolist(), strict=True)),
            coloured_errors=False,
        )
        assert fit.status == "converged", fit.message
        assert_allclose(fit.values / 100.0**power, given.certified, rtol=1e-8)


BY_DIFFERENCES = {"Lanczos1": 2.0}  # digits of the standard deviations, where AT_ROUNDING has 3


@both_starts
def test_certified_digits_by_differences(given: NistSet, start: int) -> None:
    """26 of 27 without derivatives of their own; Hahn1's b7 of 1e-7 is too small for the steps."""
    if given.name == "Hahn1":
        if start == 0:
            assert nist.fit(given, start, derivatives=False).status != "converged"
        else:
            with pytest.raises(sepcal.Error, match="derivative of output 'y' with respect to 'b7'"):
                nist.fit(given, start, derivatives=False)
        return
    fit = nist.fit(given, start, derivatives=False)
    assert fit.status == "converged", fit.message
    digits = nist.digits_of(given, fit)
    least = BY_DIFFERENCES.get(given.name, AIM[given.level])
    assert digits.parameters >= AIM[given.level], digits
    assert digits.standard_deviations >= least, digits


@pytest.mark.parametrize("iterations", [5, 10])
def test_auto_falls_back_to_joint_where_projected_fails(iterations: int) -> None:
    """MGH09's far start takes projected more steps than these; joint with a prior gets there."""
    given = nist.state_set("MGH09")
    fit = nist.fit(given, 0, iterations=iterations)
    assert fit.second_stage == "joint"
    assert fit.message.startswith("projected fell back to joint, because it did not converge")
    assert_certified(given, fit)


def test_start_belongs_to_nonlinear_parameters() -> None:
    """A linear parameter needs none; the error says which have one."""
    given = nist.state_set("Misra1a")
    with pytest.raises(sepcal.Error, match=r"only these have a start\) 'b1'.*has: b2"):
        sepcal.fit(given.model, given.columns, start={"b1": 250.0})
    with pytest.raises(TypeError, match="can't take start=250"):
        sepcal.fit(given.model, given.columns, start=250.0)
