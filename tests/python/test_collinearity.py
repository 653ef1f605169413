# SPDX-License-Identifier: BSD-3-Clause
"""Correlated pairs, condition indices, variance proportions and ellipses, again in NumPy."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats

import sepcal
from apps import Bench
from refusals import refuse


class Cubic:
    """Four columns, of which the last is nearly a sum of the second and third."""

    inputs: ClassVar = {"x": "1", "w": "1"}
    outputs: ClassVar = {"z": "1"}
    linear: ClassVar = {"a": "1", "b": "1", "c": "1", "d": "1"}
    nonlinear: ClassVar[dict[str, str]] = {}

    def at(self, u: Any, xi2: Any) -> Any:
        """A (N, n_z, n_1) and b (N, n_z)."""
        return columns(u.x, u.w)[:, None, :], np.zeros((len(u.x), 1))


def columns(x: np.ndarray, w: np.ndarray) -> np.ndarray:
    return np.stack([np.ones_like(x), x, x**2, x + x**2 + 0.01 * w], axis=1)


@pytest.fixture(scope="module")
def record() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(3)
    x, w = np.linspace(0.0, 1.0, 200), rng.standard_normal(200)
    z = columns(x, w) @ [1.0, 2.0, 3.0, 4.0] + 0.1 * rng.standard_normal(200)
    return {"x": x, "w": w, "z": z}


@pytest.fixture(scope="module")
def fit(record: dict[str, np.ndarray]) -> sepcal.Fit:
    return sepcal.fit(Cubic(), record, coloured_errors=False)


def test_diagnostics_are_those_of_the_scaled_columns(
    fit: sepcal.Fit, record: dict[str, np.ndarray]
) -> None:
    """Belsley, Kuh and Welsch's own recipe, by NumPy's SVD."""
    X = columns(record["x"], record["w"])
    _, s, vt = np.linalg.svd(X / np.linalg.norm(X, axis=0), full_matrices=False)
    phi = (vt.T / s) ** 2
    found = fit.collinearity
    assert found.names == ["a", "b", "c", "d"]
    assert_allclose(found.condition_indices, s[0] / s, rtol=1e-6)
    assert_allclose(found.variance_proportions, (phi / phi.sum(axis=1, keepdims=True)).T, atol=1e-6)
    assert found.condition_indices[-1] > 30
    assert np.all(found.variance_proportions[-1, 1:] > 0.5)


def test_pairs_are_those_above_nine_tenths(fit: sepcal.Fit, record: dict[str, np.ndarray]) -> None:
    X = columns(record["x"], record["w"])
    P = np.linalg.inv(X.T @ X)
    R = P / np.sqrt(np.outer(np.diag(P), np.diag(P)))
    names = "abcd"
    expected = {
        (names[i], names[j]): R[i, j]
        for i in range(4)
        for j in range(i + 1, 4)
        if abs(R[i, j]) > 0.9
    }
    found = {(at.first, at.second): at.correlation for at in fit.collinearity.pairs}
    assert found.keys() == expected.keys()
    for pair, value in expected.items():
        assert_allclose(found[pair], value, rtol=1e-6)
    strengths = [abs(at.correlation) for at in fit.collinearity.pairs]
    assert strengths == sorted(strengths, reverse=True)
    assert "correlation above 0.9: " in fit.text
    assert "condition index" in fit.explained


@pytest.mark.parametrize("level", [0.5, 0.95])
def test_ellipse_is_chi_squared(fit: sepcal.Fit, level: float) -> None:
    around = fit.ellipse("b", "d", level=level, points=37)
    assert around.shape == (37, 2)
    assert_allclose(around[0], around[-1])
    places = [fit.names.index(name) for name in ("b", "d")]
    P = fit.covariance[np.ix_(places, places)]
    off = around - fit.values[places]
    distance = np.einsum("ij,jk,ik->i", off, np.linalg.inv(P), off)
    assert_allclose(distance, stats.chi2.ppf(level, 2), rtol=1e-6)


def test_ellipse_refuses_what_has_none(fit: sepcal.Fit, record: dict[str, np.ndarray]) -> None:
    refuse(lambda: fit.ellipse("a", "a"), "'a' is named twice")
    refuse(lambda: fit.ellipse("a", "nothing"), "nothing")
    refuse(lambda: fit.ellipse("a", "b", level=1.0), "between 0 and 1")
    refuse(lambda: fit.ellipse("a", "b", points=3), "four or more")
    held = sepcal.fit(Cubic(), record, fix={"d": 4.0})
    refuse(lambda: held.ellipse("a", "d"), "'d' has no standard error")
    assert held.collinearity.names == ["a", "b", "c"]


def test_loaded_calibration_has_the_same(tmp_path: Path) -> None:
    base = sepcal.fit(sepcal.PitotStatic(), sepcal.datasets.load("pitot"))
    base.save(tmp_path / "base.json")
    loaded = sepcal.load(tmp_path / "base.json")
    assert_allclose(loaded.collinearity.condition_indices, base.collinearity.condition_indices)
    assert_allclose(loaded.ellipse("s_va", "c_va"), base.ellipse("s_va", "c_va"))
    told = base.to_dict()["collinearity"]
    pairs = [(at.first, at.second) for at in base.collinearity.pairs]
    assert [(at["first"], at["second"]) for at in told["pairs"]] == pairs
    large = [float(at) for at in base.collinearity.condition_indices if at > 10]
    assert_allclose([at["condition_index"] for at in told["directions"]], large[::-1])


def test_app_says_it(pitot: Bench) -> None:
    fitted = pitot.run("fit", "flight.csv", *pitot.options, "--json")
    assert fitted.code == 0, fitted.err
    assert set(fitted.result["collinearity"]) == {"pairs", "directions"}


def test_ellipses_are_drawn(fit: sepcal.Fit) -> None:
    drawn = fit.plot("ellipses")
    assert len(drawn.data) == 2 * len(fit.collinearity.pairs)
