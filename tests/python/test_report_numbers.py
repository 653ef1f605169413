# SPDX-License-Identifier: BSD-3-Clause
"""What the report draws, again by SciPy or by hand."""

from __future__ import annotations

import base64

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy import signal, stats
from scipy.interpolate import CubicSpline
from scipy.linalg import toeplitz

import sepcal
from sepcal.reporting import channels, words
from sepcal.reporting.figures_flight import covered_cells, project
from sepcal.reporting.page import encode_array
from sepcal.reporting.statistics import (
    autocorrelation,
    binned_means,
    fit_smooth,
    natural_spline,
    quantiles,
    spectrum,
)
from sepcal.reporting.thin import keep_extremes

RNG = np.random.default_rng(20)


def test_extremes_are_kept() -> None:
    values = RNG.normal(size=100_000)
    values[[17, 54_321]] = [-40, 50]
    kept = keep_extremes(values, 2000)
    assert kept.size <= 2000
    assert np.all(np.diff(kept) > 0)
    assert {17, 54_321} <= set(kept.tolist())
    assert_array_equal(keep_extremes(values[:500], 2000), np.arange(500))


def test_autocorrelation_by_hand() -> None:
    """Two segments: no product crosses from one to the next."""
    e = np.cumsum(RNG.normal(size=300)) * 0.1
    segments = [slice(0, 120), slice(120, 300)]
    lags, found, limit = autocorrelation(e, segments)
    centred = e - e.mean()
    for lag, value, bound in zip(lags, found, limit, strict=True):
        products = np.concatenate([
            centred[at][lag:] * centred[at][: max(0, at.stop - at.start - lag)] for at in segments
        ])  # fmt: skip
        assert value == pytest.approx(np.mean(products) / np.mean(centred**2), abs=1e-12)
        assert bound == pytest.approx(1.96 / np.sqrt(products.size))


def test_spectrum_is_welchs() -> None:
    e = signal.lfilter([1], [1, -0.8], RNG.normal(size=9000))
    frequency, density = spectrum(e, [slice(0, e.size)], 0.02)
    f, p = signal.welch(
        e - e.mean(), 50, window=np.hanning(4098)[1:-1], nperseg=4096, noverlap=2048, detrend=False
    )
    inner = slice(1, 2048)
    edges = np.geomspace(f[1], f[2047] * (1 + 1e-12), 121)
    expected = stats.binned_statistic(f[inner], p[inner], "mean", edges)[0]
    assert_allclose(density, expected[np.isfinite(expected)], rtol=1e-9)
    assert np.all(np.diff(frequency) > 0)


def test_quantiles_against_scipy() -> None:
    normal, found = quantiles(RNG.normal(size=50_000))
    assert np.all(np.diff(normal) > 0)
    assert stats.norm.cdf(normal[0]) == pytest.approx(0.5 * (1 - np.cos(np.pi * 0.5 / 200)))
    assert_allclose(found[20:-20], normal[20:-20], atol=0.05)


def test_natural_splines_span_scipys() -> None:
    x, knots = np.linspace(0, 1, 200), np.linspace(0, 1, 6)
    theirs = CubicSpline(knots, np.eye(6), bc_type="natural")(x)
    ours = natural_spline(x, knots)
    assert_allclose(ours @ np.linalg.lstsq(ours, theirs, rcond=None)[0], theirs, atol=1e-9)


def test_a_smooth_and_its_band() -> None:
    """Least squares, and the sandwich written out with the whole matrix."""
    x = np.sort(RNG.uniform(2, 5, 400))
    r = np.sin(x) + signal.lfilter([1], [1, -0.7], RNG.normal(size=400))
    smooth = fit_smooth(x, r)
    assert smooth is not None
    knots = np.linspace(x.min(), x.max(), 6)
    spline = CubicSpline(knots, np.eye(6), bc_type="natural")
    basis = spline(x)
    inverse = np.linalg.inv(basis.T @ basis)
    coefficients = inverse @ basis.T @ r
    left = r - basis @ coefficients
    lags = np.arange(101)
    acov = np.array([left[lag:] @ left[: 400 - lag] for lag in lags]) / 400 * (1 - lags / 101)
    covariance = toeplitz(np.concatenate([acov, np.zeros(299)]))
    spread = inverse @ basis.T @ covariance @ basis @ inverse
    there = np.isfinite(smooth.mean)
    drawn = spline(smooth.x[there])
    assert_allclose(smooth.mean[there], drawn @ coefficients, atol=1e-8)
    expected = 2 * np.sqrt(np.einsum("ij,jk,ik->i", drawn, spread, drawn))
    assert_allclose(smooth.half_width[there], expected, rtol=1e-5)
    assert fit_smooth(np.ones(400), r) is None


def test_a_smooth_is_silent_where_nothing_was_flown() -> None:
    x = np.concatenate([RNG.uniform(0, 1, 300), RNG.uniform(9, 10, 300)])
    smooth = fit_smooth(x, RNG.normal(size=600))
    assert smooth is not None
    assert np.isnan(smooth.mean[(smooth.x > 2.5) & (smooth.x < 7.5)]).all()


def test_binned_means() -> None:
    x = RNG.uniform(size=2000)
    at, means = binned_means(x, 3 * x)
    assert at.size == 14
    assert_allclose(means, 3 * at)


def test_the_sphere() -> None:
    """Mollweide: the poles, the rim, and 45 degrees of latitude from its equation."""
    x, y = project(np.array([0, np.pi, 0]), np.array([np.pi / 2, 0, np.pi / 4]))
    assert_allclose(x, [0, 2, 0], atol=1e-9)
    assert y[0] == pytest.approx(1, abs=1e-3)
    angle = np.arcsin(y[2])
    assert 2 * angle + np.sin(2 * angle) == pytest.approx(np.pi * np.sin(np.pi / 4))
    everywhere = RNG.normal(size=(20_000, 3))
    assert covered_cells(everywhere) == (72, 72)
    assert covered_cells(np.array([[0, 0, 1.0]]))[0] == 1


@pytest.mark.parametrize("values", [RNG.normal(size=50), 1.7e9 + np.arange(0, 5, 0.02)])
def test_arrays_survive_the_page(values: np.ndarray) -> None:
    """float32 where it will do, float64 where it won't: a Unix time in steps of 20 ms."""
    kind, _, text = encode_array(values).partition(":")
    read = np.frombuffer(base64.b64decode(text), dtype=f"<{kind}")
    assert kind == ("f8" if values[0] > 1e9 else "f4")
    assert_allclose(read, values, atol=1e-4 * np.ptp(values), rtol=0)


def test_columns_in_the_units_used_inside() -> None:
    flight = sepcal.Flight({
        "time_ms": [0.0, 20, 40], "temp_degc": [15.0, 15, 15], "ps_hpa": [1013.25] * 3,
        "dp_hpa": [1.0, 2.0, -1.0], "yaw_deg": [-90.0, 0, 450], "odd_thing": [1.0, 2, 3],
    })  # fmt: skip
    assert_allclose(channels.quantity(flight, "time"), [0, 0.02, 0.04])
    rho = channels.driver(flight, "rho", {})
    assert_allclose(rho, 1.225, rtol=1e-3)  # the standard atmosphere at sea level
    assert_allclose(channels.airspeed(flight)[:2], np.sqrt(2 * np.array([100, 200]) / rho[:2]))
    assert np.isnan(channels.airspeed(flight)[2])
    degrees, name = channels.heading(flight)
    assert name == "heading"
    assert_allclose(degrees, [270, 0, 90])
    assert_array_equal(channels.driver(flight, "odd_thing", {}), [1, 2, 3])
    assert channels.driver(flight, "alpha", {}) is None
    assert_array_equal(channels.find_rows(flight, np.array([0.02, 0.04])), [1, 2])


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        (words.number(0.2), "0.200"), (words.number(7.2149), "7.21"), (words.number(100), "100"),
        (words.number(None), "–"), (words.number(-3e-9), "−3.00·10<sup>−9</sup>"),
        (words.number(123456.0), "123456"), (words.percent(-0.0001), "0 %"),
        (words.percent(0.254), "25 %"), (words.percent(0.0254), "2.5 %"),
        (words.percent(0.0001), "&lt; 0.1 %"), (words.probability(0.0312), "0.031"),
        (words.probability(2e-12), "2·10<sup>−12</sup>"),
        (words.estimate(0.0100123, 0.0000373, "m/s per m"), "0.010012 ± 0.000037 m/s per m"),
        (words.estimate(-1.2324, 0.0301, "1 per V"), "−1.232 ± 0.030 per V"),
        (words.estimate(1.5, None, "m/s"), "1.500 m/s"),
    ],
)  # fmt: skip
def test_words(said: str, expected: str) -> None:
    assert said == expected
