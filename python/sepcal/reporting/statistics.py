# SPDX-License-Identifier: BSD-3-Clause
"""Statistics that are drawn: autocorrelation, spectrum, quantiles, a smooth with its band."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from sepcal.columns import Array

KNOTS = 6  # of a smooth, even, as compare's
GRID = 80  # points of a drawn smooth
FEWEST = 5  # points whose mean is drawn
NEAR = 5  # of these points: farther from the data nothing is drawn
LONGEST = 4096  # rows of a stretch whose spectrum is taken


def autocovariance_sums(residual: Array, segments: list[slice], lags: int) -> tuple[Array, Array]:
    """Sums of e_k e_{k+lag} within segments, about the mean, and their number, (lags + 1,)."""
    e = residual - residual.mean()
    sums, pairs = np.zeros(lags + 1), np.zeros(lags + 1)
    for segment in segments:
        part = e[segment]
        size = min(lags + 1, part.size)
        length = 1 << int(2 * part.size - 1).bit_length()
        power = np.abs(np.fft.rfft(part, length)) ** 2
        sums[:size] += np.fft.irfft(power, length)[:size]
        pairs[:size] += part.size - np.arange(size)
    return sums, pairs


def autocorrelation(residual: Array, segments: list[slice]) -> tuple[Array, Array, Array]:
    """Lags from 1 [rows], correlations, and the 95 % limit of white noise at each lag.

    Up to a third of the longest segment; about evenly spaced on a logarithmic axis.
    """
    longest = max(segment.stop - segment.start for segment in segments)
    furthest = max(1, longest // 3)
    sums, pairs = autocovariance_sums(residual, segments, furthest)
    lags = np.unique(np.geomspace(1, furthest, 160).astype(int))
    variance = sums[0] / max(pairs[0], 1.0)
    if variance <= 0:
        return lags, np.full(lags.size, np.nan), np.full(lags.size, np.nan)
    # Mean products: a segment's ends count no less at long lags.
    return lags, sums[lags] / pairs[lags] / variance, 1.96 / np.sqrt(pairs[lags])


def spectrum(residual: Array, segments: list[slice], interval: float) -> tuple[Array, Array]:
    """Welch's power density [unit^2/Hz] of gap-free stretches, averaged into even decades.

    Hann windows that overlap by half; `interval` is the sampling's [s].
    """
    longest = max(segment.stop - segment.start for segment in segments)
    length = min(LONGEST, longest)
    window = np.hanning(length + 2)[1:-1]
    total, count = np.zeros(length // 2 + 1), 0
    for segment in segments:
        part = residual[segment] - residual.mean()
        for first in range(0, part.size - length + 1, max(1, length // 2)):
            total += np.abs(np.fft.rfft(window * part[first : first + length])) ** 2
            count += 1
    density = 2 * interval * total / (max(count, 1) * np.sum(window**2))
    frequency = np.fft.rfftfreq(length, interval)
    inner = slice(1, (length + 1) // 2)
    return average_bins(np.asarray(frequency[inner], dtype=np.float64), density[inner], 120)


def average_bins(x: Array, y: Array, bins: int) -> tuple[Array, Array]:
    """Means of positive x and y in bins that are even in log x."""
    if x.size == 0:
        return x, y
    edges = np.geomspace(x[0], x[-1] * (1 + 1e-12), bins + 1)
    place = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, bins - 1)
    number = np.bincount(place, minlength=bins)
    there = number > 0
    means = [np.bincount(place, v, bins)[there] / number[there] for v in (x, y)]
    return means[0], means[1]


def quantiles(residual: Array, points: int = 200) -> tuple[Array, Array]:
    """Of a normal distribution and of the residual, in their order."""
    size = min(points, residual.size)
    # More of them in the tails, where they matter.
    shares = 0.5 * (1 - np.cos(np.pi * (np.arange(size) + 0.5) / size))
    shares = np.clip(shares, 0.5 / residual.size, 1 - 0.5 / residual.size)
    normal = NormalDist()
    return np.array([normal.inv_cdf(share) for share in shares]), np.quantile(residual, shares)


@dataclass(frozen=True)
class Smooth:
    """A spline through a cloud of points, in GRID points; NaN where there are no data."""

    x: Array
    mean: Array
    half_width: Array  # 2 standard errors


def fit_smooth(x: Array, residual: Array) -> Smooth | None:
    """The natural spline of KNOTS even knots, and a band that allows for correlation.

    The band is that of the spline without an effect: the covariance of its coefficients is
    (B'B)^-1 B' S B (B'B)^-1 with S the autocovariance of what the spline leaves, tapered
    (Bartlett) to a quarter of the record. None where x does not vary.
    """
    there = np.isfinite(x) & np.isfinite(residual)
    low, high = (np.min(x[there]), np.max(x[there])) if there.any() else (0.0, 0.0)
    if not high > low:
        return None
    knots = np.linspace(0, 1, KNOTS)
    basis = natural_spline((np.where(there, x, low) - low) / (high - low), knots) * there[:, None]
    y = np.where(there, residual, 0.0)
    inverse = np.linalg.pinv(basis.T @ basis, rcond=1e-10, hermitian=True)
    coefficients = inverse @ (basis.T @ y)
    left = np.where(there, y - basis @ coefficients, 0.0)
    covariance = inverse @ _long_run_product(basis, left) @ inverse
    # In a stretch without data a spline says nothing.
    at = np.linspace(0, 1, GRID)
    place = np.clip(((x[there] - low) / (high - low) * (GRID - 1)).round().astype(int), 0, GRID - 1)
    number = np.bincount(place, minlength=GRID)
    near = np.convolve(number, np.ones(2 * NEAR + 1), mode="same") > 0
    drawn = natural_spline(at, knots)
    variance = np.maximum(np.einsum("ij,jk,ik->i", drawn, covariance, drawn), 0.0)
    mean = np.where(near, drawn @ coefficients, np.nan)
    return Smooth(low + at * (high - low), mean, np.where(near, 2 * np.sqrt(variance), np.nan))


def _long_run_product(basis: Array, left: Array) -> Array:
    """B' S B with S Toeplitz: the tapered autocovariance of `left` over all rows in a row."""
    size = left.size
    lags = max(1, size // 4)
    length = 1 << int(2 * size - 1).bit_length()
    covariance = np.fft.irfft(np.abs(np.fft.rfft(left, length)) ** 2, length)[: lags + 1] / size
    covariance *= 1 - np.arange(lags + 1) / (lags + 1)
    row = np.zeros(length)
    row[: lags + 1] = covariance
    row[length - lags :] = covariance[1:][::-1]
    filtered = np.fft.irfft(
        np.fft.rfft(basis, length, axis=0) * np.fft.rfft(row)[:, None], length, axis=0
    )[:size]
    product: Array = basis.T @ filtered
    return product


def natural_spline(x: Array, knots: Array) -> Array:
    """Values of the natural cubic splines on `knots`, (N, knots): 1, x and truncated cubes."""
    cubes = np.maximum(x[:, None] - knots, 0.0) ** 3
    last = knots[-1]
    d = (cubes[:, :-1] - cubes[:, -1:]) / (last - knots[:-1])
    return np.column_stack([np.ones(x.size), x, d[:, :-1] - d[:, -1:]])


def binned_means(x: Array, y: Array, bins: int = 14) -> tuple[Array, Array]:
    """Means of x and y in even bins of x that hold FEWEST points or more."""
    edges = np.linspace(np.min(x), np.max(x), bins + 1)
    place = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, bins - 1)
    number = np.bincount(place, minlength=bins)
    there = number >= FEWEST
    means = [np.bincount(place, values, bins)[there] / number[there] for values in (x, y)]
    return means[0], means[1]
