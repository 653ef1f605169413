# SPDX-License-Identifier: BSD-3-Clause
"""Other channels at the stamps of the sensor that is measured.

A channel at least twice as fast is averaged over the interval around each stamp: the mean of the
straight lines between its samples, so that no uneven count of samples shifts it in time. Any other
is interpolated. Neither crosses a gap, a step of more than five of the channel's usual intervals.
"""

from __future__ import annotations

import numpy as np

from sepcal.columns import Array
from sepcal.logs.recording import Channel

GAP = 5.0  # usual intervals


def usual_interval(times: Array) -> float:
    """The median step [s]; of stamps in bursts, whose mean is far larger, the 95th percentile."""
    steps = np.diff(times)
    median = float(np.median(steps))
    return median if steps.mean() <= 2 * median else float(np.percentile(steps, 95))


def bring(channel: Channel, stamps: Array, hold: bool) -> tuple[Array, str]:
    """The channel at the stamps.

    Args:
        channel: n samples of k values.
        stamps: Shape (N,), increasing [s].
        hold: Whether the first and the last sample stand for up to an interval beyond them.

    Returns:
        Values (N, k), NaN where the channel has a gap, and in words how they came.
    """
    interval = usual_interval(channel.times)
    base = usual_interval(stamps) if stamps.size > 1 else interval
    if channel.times.size == stamps.size and np.array_equal(channel.times, stamps):
        return channel.values.copy(), "as logged, at the same stamps"
    values = _interpolate(channel, stamps, interval)
    how = f"interpolated from {1 / interval:.3g} Hz"
    if interval <= base / 2:
        mean = _average(channel, stamps, base, interval)
        values = np.where(np.isnan(mean), values, mean)
        how = f"averaged over {base:.3g} s from {1 / interval:.3g} Hz"
    if hold:
        for end, at in ((0, stamps < channel.times[0]), (-1, stamps > channel.times[-1])):
            near = at & (np.abs(stamps - channel.times[end]) <= interval)
            values[near] = channel.values[end]
    return values, how


def label_at(times: Array, names: tuple[str, ...], stamps: Array) -> list[str]:
    """The name that holds at each stamp; before the first one, the first."""
    at = np.clip(np.searchsorted(times, stamps, side="right") - 1, 0, None)
    return [names[i] for i in at]


def _interpolate(channel: Channel, stamps: Array, interval: float) -> Array:
    right = np.clip(np.searchsorted(channel.times, stamps), 1, channel.times.size - 1)
    left, start = right - 1, channel.times[right - 1]
    step = channel.times[right] - start
    share = ((stamps - start) / step)[:, None]
    values = (1 - share) * channel.values[left] + share * channel.values[right]
    outside = (stamps < channel.times[0]) | (stamps > channel.times[-1])
    values[outside | (step > GAP * interval)] = np.nan
    return values


def _average(channel: Channel, stamps: Array, width: float, interval: float) -> Array:
    """The mean over `width` around each stamp; NaN where that has a gap or leaves the channel.

    The integral of the lines is a sum of trapezoids up to the sample before, and a piece of one.
    """
    times, values = channel.times, channel.values - channel.values[0]
    steps = np.diff(times)
    whole = np.vstack(
        (np.zeros(values.shape[1]), np.cumsum(steps[:, None] * (values[1:] + values[:-1]) / 2, 0))
    )

    def integral(at: Array) -> Array:
        left = np.clip(np.searchsorted(times, at, side="right") - 1, 0, times.size - 2)
        inside = (at - times[left])[:, None]
        slope = (values[left + 1] - values[left]) / steps[left][:, None]
        return np.asarray(whole[left] + inside * (values[left] + slope * inside / 2))

    start, end = stamps - width / 2, stamps + width / 2
    mean = (integral(end) - integral(start)) / width + channel.values[0]
    gaps = np.append(0, np.cumsum(steps > GAP * interval))
    first = np.clip(np.searchsorted(times, start, side="right") - 1, 0, None)
    last = np.clip(np.searchsorted(times, end), None, times.size - 1)
    mean[(start < times[0]) | (end > times[-1]) | (gaps[last] > gaps[first])] = np.nan
    return np.asarray(mean)
