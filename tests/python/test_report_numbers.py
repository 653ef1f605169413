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
from sepcal import _core
from sepcal.reporting import words
from sepcal.reporting.figures_flight import covered_cells, project
from sepcal.reporting.page import encode_array
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
    lags, found, limit = _core.autocorrelation(e, [("", 0, 120), ("", 120, 300)])
    assert (lags[0], lags[-1]) == (1, 60)
    centred = e - e.mean()
    for lag, value, bound in zip(lags.astype(int), found, limit, strict=True):
        products = np.concatenate([
            centred[at][lag:] * centred[at][: max(0, at.stop - at.start - lag)] for at in segments
        ])  # fmt: skip
        assert value == pytest.approx(np.mean(products) / np.mean(centred**2), abs=1e-12)
        assert bound == pytest.approx(1.96 / np.sqrt(products.size))


def test_spectrum_is_welchs() -> None:
    e = signal.lfilter([1], [1, -0.8], RNG.normal(size=9000))
    frequency, density = _core.spectrum(e, [("", 0, e.size)], 0.02)
    f, p = signal.welch(
        e - e.mean(), 50, window=np.hanning(4098)[1:-1], nperseg=4096, noverlap=2048, detrend=False
    )
    inner = slice(1, 2048)
    edges = np.geomspace(f[1], f[2047] * (1 + 1e-12), 121)
    expected = stats.binned_statistic(f[inner], p[inner], "mean", edges)[0]
    assert_allclose(density, expected[np.isfinite(expected)], rtol=1e-9)
    assert np.all(np.diff(frequency) > 0)


def test_spectrum_of_runs() -> None:
    """Of an odd number of rows, from both runs and from no window across them."""
    e = RNG.normal(size=101 + 160)
    frequency, density = _core.spectrum(e, [("", 0, 160), ("", 160, 261)], 2.0)
    assert frequency[0] == pytest.approx(1 / (160 * 2.0))
    f, p = signal.periodogram(e[:160] - e.mean(), 0.5, window=np.hanning(162)[1:-1], detrend=False)
    edges = np.geomspace(f[1], f[79] * (1 + 1e-12), 121)
    expected = stats.binned_statistic(f[1:80], p[1:80], "mean", edges)[0]
    assert_allclose(density, expected[np.isfinite(expected)], rtol=1e-9)


@pytest.mark.parametrize("rows", [0, 1, 2, 3, 7])
def test_curves_of_few_rows(rows: int) -> None:
    """Whatever there is of them, and never a crash."""
    e, runs = np.arange(float(rows)), [("", 0, rows)] if rows else []
    lags, values, limits = _core.autocorrelation(e, runs)
    assert lags.size == values.size == limits.size
    assert _core.spectrum(e, runs, 1.0)[0].size == max((rows + 1) // 2 - 1, 0)
    normal, found = _core.quantiles(e)
    assert_allclose(normal, -normal[::-1], atol=1e-12)
    assert found.size == rows
    assert _core.bin_means(e, e, 14)[0].size == 0
    assert (_core.smooth(e, e) is None) == (rows < 2)


def test_a_residual_of_zeros_has_no_correlation() -> None:
    assert np.isnan(_core.autocorrelation(np.zeros(9), [("", 0, 9)])[1]).all()


def test_runs_outside_the_rows_are_refused() -> None:
    with pytest.raises(sepcal.Error, match="segment"):
        _core.autocorrelation(np.zeros(9), [("", 0, 10)])


def test_quantiles_against_scipy() -> None:
    normal, found = _core.quantiles(RNG.normal(size=50_000))
    assert np.all(np.diff(normal) > 0)
    assert stats.norm.cdf(normal[0]) == pytest.approx(0.5 * (1 - np.cos(np.pi * 0.5 / 200)))
    assert_allclose(found[20:-20], normal[20:-20], atol=0.05)


def test_a_smooth_and_its_band() -> None:
    """Least squares, and the sandwich written out with the whole matrix."""
    x = np.sort(RNG.uniform(2, 5, 400))
    r = np.sin(x) + signal.lfilter([1], [1, -0.7], RNG.normal(size=400))
    smooth = _core.smooth(x, r)
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
    at, mean, half_width = smooth
    assert_allclose(at, np.linspace(x.min(), x.max(), 80))
    there = np.isfinite(mean)
    drawn = spline(at[there])
    assert_allclose(mean[there], drawn @ coefficients, atol=1e-10)
    expected = 2 * np.sqrt(np.einsum("ij,jk,ik->i", drawn, spread, drawn))
    assert_allclose(half_width[there], expected, rtol=1e-9)
    assert _core.smooth(np.ones(400), r) is None


def test_a_smooth_is_silent_where_nothing_was_flown() -> None:
    x = np.concatenate([RNG.uniform(0, 1, 300), RNG.uniform(9, 10, 300)])
    smooth = _core.smooth(x, RNG.normal(size=600))
    assert smooth is not None
    at, mean, _ = smooth
    assert np.isnan(mean[(at > 2.5) & (at < 7.5)]).all()
    assert np.isfinite(mean[[0, -1]]).all()


def test_rows_that_are_no_number_leave_a_smooth_as_it_was() -> None:
    x, r = RNG.uniform(size=300), RNG.normal(size=300)
    whole = _core.smooth(x, r)
    more = _core.smooth(np.append(x, [np.nan, 0.5]), np.append(r, [1.0, np.inf]))
    assert whole is not None
    assert more is not None
    assert_allclose(more[1], whole[1], atol=1e-12)
    assert _core.smooth(np.full(5, np.nan), np.ones(5)) is None


def test_binned_means() -> None:
    x = RNG.uniform(size=2000)
    at, means = _core.bin_means(x, 3 * x, 14)
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


def test_figures_of_a_tube_in_other_units() -> None:
    """From hPa, degC, knots and degrees, again by hand; the third row has no air."""
    flight = sepcal.Flight({
        "time_ms": np.arange(8) * 20.0, "temp_degc": [15.0] * 8, "ps_hpa": [1013.25] * 8,
        "dp_hpa": [1.0, 2, -1, 3, 4, 5, 6, 7], "vn_kt": np.linspace(10, 40, 8),
        "ve_kt": np.linspace(20, 5, 8) ** 2, "vd_mps": np.zeros(8),
        "yaw_deg": [-90.0, 0, 0, 450, 1, 2, 3, np.nan], "odd_thing": np.arange(8.0),
        "gappy": [np.nan, *range(7)],
    }, maneuver=list("aaaabbbb"))  # fmt: skip
    tube = sepcal.fit(sepcal.PitotStatic(), flight)
    figures = _core.gather_figures(tube.core, flight._core)
    kept = np.array([0, 1, 3, 4, 5, 6, 7])
    assert_array_equal(figures.rows, kept)
    assert figures.segments == [("a", 0, 3), ("b", 3, 7)]
    assert figures.runs == [("", 0, 7)]
    assert_allclose(figures.interval[:2], 0.02)
    rho = 101325 / (287.05287 * 288.15)
    assert_allclose(figures.channel("rho"), rho)
    assert_allclose(figures.airspeed, np.sqrt(2 * 100 * flight["dp_hpa"][kept] / rho))
    assert_allclose(np.degrees(figures.heading), (flight["yaw_deg"] % 360)[kept])
    assert_allclose(figures.measured[:, 0], figures.airspeed)
    assert_allclose(figures.channel("vn"), flight["vn_kt"][kept] * 1852 / 3600)
    residuals = tube.compare().residuals
    assert_allclose(figures.measured - figures.modelled, residuals, atol=1e-12)
    within = np.abs(residuals) <= stats.norm.ppf(0.975) * np.array(list(tube.noise.values()))
    assert_allclose(figures.within_95, within.mean(axis=0))
    assert_array_equal(figures.channel("odd_thing"), kept)
    for absent in ("alpha", "gappy", "none"):
        assert figures.channel(absent) is None


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        (words.number(0.2), "0.200"), (words.number(7.2149), "7.21"), (words.number(100), "100"),
        (words.number(None), "–"), (words.number(-3e-9), "−3.00·10<sup>−9</sup>"),
        (words.number(123456.0), "123456"), (words.percent(-0.0001), "0 %"),
        (words.percent(0.254), "25 %"), (words.percent(0.0254), "2.5 %"),
        (words.percent(0.0001), "< 0.1 %"), (words.probability(0.0312), "0.031"),
        (words.probability(2e-12), "2·10<sup>−12</sup>"),
        (words.estimate(0.0100123, 0.0000373, "m/s per m"), "0.010012 ± 0.000037 m/s per m"),
        (words.estimate(-1.2324, 0.0301, "1 per V"), "−1.232 ± 0.030 per V"),
        (words.estimate(1.5, None, "m/s"), "1.500 m/s"),
    ],
)  # fmt: skip
def test_words(said: str, expected: str) -> None:
    assert said == expected
