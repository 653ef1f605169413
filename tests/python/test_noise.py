# SPDX-License-Identifier: BSD-3-Clause
"""Noise models from Python: what SciPy draws is found, whitened, and drawn again."""

import pickle

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.signal import lfilter
from scipy.stats import kstest

import sepcal
from refusals import refuse

ROWS = 4000


def autoregression(seed: int = 5) -> np.ndarray:
    white = 0.3 * np.random.default_rng(seed).standard_normal(ROWS)
    return lfilter([1.0], [1.0, -0.8], white)


def test_an_autoregression_is_found() -> None:
    found = sepcal.fit_noise(autoregression(), order=1)
    assert found.converged
    # Standard error of phi: sqrt((1 - phi^2) / N) = 0.0095; of sigma: sigma / sqrt(2 N) = 0.0034.
    d, phi = found.model.d, found.model.phi
    assert abs(d) < 0.15
    assert abs(found.model.sigma - 0.3) < 4 * 0.0034
    assert abs(d + phi[0] - 0.8) < 0.15
    white = sepcal.fit_noise(autoregression(), order=0)
    assert found.minus_two_log_likelihood < white.minus_two_log_likelihood


def test_the_likelihood_of_white_noise_is_the_normals() -> None:
    """-2 ln L = N ln(2 pi sigma^2) + N, at sigma of most likelihood, where d = 0."""
    e = np.random.default_rng(2).standard_normal(500)
    start = sepcal.NoiseModel(d=0.0, sigma=1.0)
    found = sepcal.fit_noise(e, start=start)
    rms = np.sqrt(np.mean(e**2))
    least = 500 * np.log(2 * np.pi * rms**2) + 500
    assert found.informative_rows == 500
    assert least - 12.0 < found.minus_two_log_likelihood <= least + 1e-3


def test_whitening_undoes_the_recursion() -> None:
    e = autoregression()
    model = sepcal.NoiseModel(phi=[0.8], sigma=0.3)
    white = sepcal.whiten(model, e)
    assert_allclose(white[1:], (e[1:] - 0.8 * e[:-1]) / 0.3, rtol=1e-9)
    assert kstest(white, "norm").pvalue > 1e-3
    parts = sepcal.whiten(model, e, segments=[(0, 10), (20, 30)])
    assert np.isnan(parts[10:20]).all()
    assert np.isnan(parts[30:]).all()
    assert parts[20] == pytest.approx(e[20] * np.sqrt(1 - 0.8**2) / 0.3)


def test_draws_have_the_models_covariance() -> None:
    model = sepcal.NoiseModel(phi=[0.8], sigma=0.3)
    drawn = sepcal.simulate_noise(model, 6, draws=20_000, seed=4)
    lags = np.abs(np.subtract.outer(np.arange(6), np.arange(6)))
    expected = 0.09 / (1 - 0.64) * 0.8**lags
    assert_allclose(np.cov(drawn), expected, atol=5 * 0.25 * np.sqrt(2 / 20_000))
    assert_array_equal(drawn, sepcal.simulate_noise(model, 6, draws=20_000, seed=4))
    assert sepcal.simulate_noise(model, [4, 5]).shape == (9, 1)


def test_a_model_pickles() -> None:
    model = sepcal.NoiseModel(d=0.4, phi=[0.1, -0.2], sigma=2.0, free_level=True)
    again = pickle.loads(pickle.dumps(model))
    assert (again.d, again.sigma, again.free_level) == (0.4, 2.0, True)
    assert_array_equal(again.phi, [0.1, -0.2])


def test_what_is_refused() -> None:
    e = autoregression()
    refuse(lambda: sepcal.fit_noise([1.0, np.nan] * 20), "finite")
    refuse(lambda: sepcal.fit_noise(e, order=-1), "order")
    refuse(lambda: sepcal.fit_noise(e, order=1.5), "order is 1.5", "whole number")  # type: ignore[arg-type]
    refuse(lambda: sepcal.fit_noise(e[:60], order=50), "order is 50", "allow")
    refuse(lambda: sepcal.fit_noise(e[:8], order=3), "order is 3", "allow 0")
    refuse(lambda: sepcal.whiten(sepcal.fit_noise(e), e), "found.model")  # type: ignore[arg-type]
    refuse(lambda: sepcal.fit_noise(e, segments=[0, 100]), "0", "no pair")  # type: ignore[list-item]
    start = sepcal.fit_noise(e, order=1).model
    assert len(sepcal.fit_noise(e, order=3, start=start).model.phi) == 1
    refuse(lambda: sepcal.fit_noise(e, segments=[(0, ROWS + 1)]), str(ROWS))
    refuse(lambda: sepcal.fit_noise(e, segments=[(5, 5)]), "(5, 5)")
    refuse(lambda: sepcal.whiten(sepcal.NoiseModel(d=1.0), e), "d")
    refuse(lambda: sepcal.whiten(sepcal.NoiseModel(phi=[1.1]), e), "stationary")
    refuse(lambda: sepcal.simulate_noise(sepcal.NoiseModel(), 0), "rows", "0")
