# SPDX-License-Identifier: BSD-3-Clause
"""Partial F, PSE and the reduction of SSE against least squares of nested models, by NumPy."""

from typing import NamedTuple

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import sepcal
from studies import moment_flights as aero

ROWS = 500
STANDARD = ("1", "alpha", "q_hat", "elevator")
TRUTH = {"1": 0.03, "alpha": -0.9, "q_hat": -14.0, "elevator": -1.2, "alpha^2": -3.0}
FIELD = (19.7, -1.4, 49.4)


class Expected(NamedTuple):
    """Of a model with more columns beside one with fewer; readings of unit noise."""

    sse: float
    reduction: float
    partial_f: float
    pse: dict[str, float]


def compare_nested(
    fewer: NDArray[np.float64], added: NDArray[np.float64], z: NDArray[np.float64], variance: float
) -> Expected:
    """`variance`: the mean of the outputs', about their means."""
    more = np.hstack([fewer, added])
    sse = [
        float(np.sum((z - X @ np.linalg.lstsq(X, z, rcond=None)[0]) ** 2)) for X in (fewer, more)
    ]
    N, p, q = z.size, fewer.shape[1], added.shape[1]
    partial_f = (sse[0] - sse[1]) / q / (sse[1] / (N - p - q))
    pse = {
        bound: sse[1] / N + 2 * s2max * (p + q) / N
        for bound, s2max in {"sidpac": variance / 2, "classic": variance}.items()
    }
    return Expected(sse[0], sse[0] - sse[1], partial_f, pse)


@pytest.fixture(scope="module")
def channels() -> dict[str, NDArray[np.float64]]:
    return aero.maneuver(1, ROWS)


@pytest.fixture(scope="module")
def Cm(channels: dict[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    noise = 0.004 * np.random.default_rng(2).standard_normal(ROWS)
    return aero.pitching(channels, TRUTH) + noise


@pytest.fixture(scope="module")
def fit(channels: dict[str, NDArray[np.float64]], Cm: NDArray[np.float64]) -> sepcal.AircraftFit:
    flight = aero.fly(channels, Cm)
    return sepcal.fit(sepcal.Aero(aero.AIRCRAFT, "Cm"), flight)


@pytest.mark.parametrize("bound", ["sidpac", "classic"])
def test_regressors_of_a_coefficient(
    channels: dict[str, NDArray[np.float64]],
    Cm: NDArray[np.float64],
    fit: sepcal.AircraftFit,
    bound: str,
):
    diagnosis = fit.diagnose(pse=bound)
    assert diagnosis.pse == bound
    J = np.column_stack([aero.regressor(name, channels) for name in STANDARD])
    rmse = fit.rmse["Cm"]
    for name in ("alpha^2", "alpha^3", "alpha*elevator", "alpha*q_hat", "elevator^2"):
        G = aero.regressor(name, channels)[:, None]
        expected = compare_nested(J / rmse, G / rmse, Cm / rmse, float(np.var(Cm / rmse, ddof=1)))
        found = diagnosis[f"Cm[{name}]"]
        assert found.outputs == ["Cm"]
        assert_allclose(found.partial_f, expected.partial_f, rtol=1e-6)
        assert_allclose(found.sse, expected.sse, rtol=1e-9)
        assert_allclose(found.sse_reduction, expected.reduction, rtol=1e-6)
        assert_allclose(found.pse, expected.pse[bound], rtol=1e-9)
        T = np.linalg.qr(np.column_stack([J, G, Cm]) / rmse, mode="r")
        assert_allclose(found.sse_reduction, T[J.shape[1], -1] ** 2, rtol=1e-6)


def test_a_spline_beside_its_straight_line(
    channels: dict[str, NDArray[np.float64]], Cm: NDArray[np.float64], fit: sepcal.AircraftFit
):
    """The line is the equation's own: bends alone are asked, as SciPy's spline has them."""
    interpolate = pytest.importorskip("scipy.interpolate")
    found = fit.diagnose()["Cm[spline(alpha,5)]"]
    assert list(found.estimate) == [f"Cm[spline(alpha,5)].s_{j}" for j in (2, 3, 4)]
    alpha = channels["alpha"]
    knots = np.linspace(alpha.min(), alpha.max(), 5)
    cardinal = interpolate.CubicSpline(knots, np.eye(5), bc_type="natural")(alpha)
    J = np.column_stack([aero.regressor(name, channels) for name in STANDARD])
    expected = compare_nested(J, cardinal[:, 1:4], Cm, 1.0)
    assert_allclose(found.partial_f, expected.partial_f, rtol=1e-6)
    added = fit.add("Cm[spline(alpha,5)]")
    assert added.status == "converged"
    left = np.sqrt((expected.sse - expected.reduction) / ROWS)
    assert_allclose(added.rmse["Cm"], left, rtol=1e-9)
    assert added.compare().overall[0].rmse == pytest.approx(left, rel=1e-9)


def test_effects_on_several_outputs():
    """All outputs of a magnetometer at once, each in units of its RMSE."""
    model = sepcal.Magnetometer(field=FIELD)
    flight = sepcal.simulate(model, rows=300, seed=4, hide={"bias[current_a]": 0.03})
    held = {f"eta_{axis}": 0.0 for axis in "xyz"}
    held |= dict.fromkeys(("alpha_xy", "alpha_xz", "alpha_yz"), 0.0)
    fit = sepcal.fit(model, flight, fix=held)
    found = fit.diagnose()["bias[current_a]"]
    roll, pitch, yaw = (flight[f"{name}_rad"] for name in ("roll", "pitch", "yaw"))
    north, east, down = FIELD
    level = np.cos(yaw) * north + np.sin(yaw) * east, np.cos(yaw) * east - np.sin(yaw) * north
    forward = np.cos(pitch) * level[0] - np.sin(pitch) * down
    below = np.sin(pitch) * level[0] + np.cos(pitch) * down
    body = (
        forward,
        np.cos(roll) * level[1] + np.sin(roll) * below,
        np.cos(roll) * below - np.sin(roll) * level[1],
    )
    current = flight["current_a"]
    rmse = [fit.rmse[f"m{axis}"] for axis in "xyz"]
    zero = np.zeros(current.size)

    def stacked(columns: list[NDArray[np.float64]]) -> NDArray[np.float64]:
        """A column for each output, zero in the others."""
        rows = [
            [column / rmse[j] if i == j else zero for j, column in enumerate(columns)]
            for i in range(3)
        ]
        return np.vstack([np.column_stack(row) for row in rows])

    J = np.hstack([stacked(list(body)), stacked([zero + 1.0] * 3)])
    z = [flight[f"m{axis}_ut"] / rmse[j] for j, axis in enumerate("xyz")]
    variance = float(np.mean([np.var(output, ddof=1) for output in z]))
    expected = compare_nested(J, stacked([current] * 3), np.concatenate(z), variance)
    assert found.outputs == ["mx", "my", "mz"]
    assert_allclose(found.sse_reduction, expected.reduction, rtol=1e-5)
    assert_allclose(found.partial_f, expected.partial_f, rtol=1e-5)
    assert_allclose(found.pse, expected.pse["sidpac"], rtol=1e-8)


def test_an_unknown_bound_is_refused(fit: sepcal.AircraftFit):
    with pytest.raises(sepcal.Error, match="pse 'aic' is unknown; known: 'sidpac', 'classic'"):
        fit.diagnose(pse="aic")
