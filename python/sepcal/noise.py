# SPDX-License-Identifier: BSD-3-Clause
"""The noise of a residual: fitted, whitened by, drawn from."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from sepcal import _core
from sepcal._core import NoiseFit, NoiseModel
from sepcal.arguments import checked
from sepcal.columns import Array
from sepcal.matrices import to_vector, to_whole_number

Segments = Sequence[tuple[int, int]]  # first row, row after the last


@checked
def fit_noise(
    e: ArrayLike,
    *,
    segments: Segments | None = None,
    order: int | None = None,
    max_order: int = 8,
    start: NoiseModel | None = None,
) -> NoiseFit:
    """phi(B) (1 - B)^d e = sigma w by maximum likelihood: white, pink, autoregressive, drifting.

        found = sepcal.fit_noise(residual)
        white = sepcal.whiten(found.model, residual)

    Args:
        e: (N,), zero in the mean unless it is slow.
        segments: (first row, row after the last) of each stretch, independent of the others; other
            rows are not read [one of all rows].
        order: Order of the autoregression [that of least AIC]; short segments allow no high one.
            Not of a start, which has its own.
        max_order: At most so high then.
        start: An earlier fit's model, whose order and freedom of the level are kept.

    Raises:
        Error: No rows, a segment that leaves e, what is not finite, an order below 0 or above what
            the segments allow.

    Example:
        >>> white = np.random.default_rng(0).normal(0.0, 2.0, 2000)
        >>> model = sepcal.fit_noise(white).model
        >>> round(model.sigma), abs(model.d) < 0.05
        (2, True)
    """
    wanted = None if order is None else to_whole_number("order", order)
    most = to_whole_number("max_order", max_order)
    found = _core.fit_noise(to_vector("e", e), _rows(segments), wanted, most, start)
    allowed = len(found.model.phi)
    if wanted is not None and start is None and allowed < wanted and found.model.sigma > 0.0:
        raise _core.Error(f"order is {wanted}; segments of these lengths allow {allowed}")
    return found


@checked
def whiten(model: NoiseModel, e: ArrayLike, *, segments: Segments | None = None) -> Array:
    """W e, white with unit variance where e is of the model, (N,); NaN outside the segments.

    Where the level is free each segment's first row becomes zero.

    Raises:
        Error: A model that isn't stationary or whose sigma is 0, a segment that leaves e.

    Example:
        >>> slow = np.cumsum(np.random.default_rng(0).normal(0.0, 0.1, 2000))
        >>> white = sepcal.whiten(sepcal.fit_noise(slow).model, slow)
        >>> round(float(np.std(white)), 1)
        1.0
    """
    if isinstance(model, NoiseFit):
        raise _core.Error("whiten() takes the fit's model; give found.model")
    return _core.whiten(model, to_vector("e", e), _rows(segments))


@checked
def simulate_noise(
    model: NoiseModel, rows: int | Sequence[int], *, draws: int = 1, seed: int = 0
) -> Array:
    """Draws of the noise, (N, draws).

    Args:
        model: The noise to draw.
        rows: N, or those of each segment, N in all.
        draws: Independent ones, a column each.
        seed: Seed of std::mt19937_64.

    Raises:
        Error: A model that isn't stationary, an empty segment.

    Example:
        >>> model = sepcal.fit_noise(np.random.default_rng(0).normal(0.0, 2.0, 2000)).model
        >>> drawn = sepcal.simulate_noise(model, 500, draws=3, seed=1)
        >>> drawn.shape, round(float(drawn.std()))
        ((500, 3), 2)
    """
    lengths = np.atleast_1d(np.asarray(rows, dtype=np.int64)).tolist()
    if min(lengths, default=0) < 1 or draws < 1:
        raise _core.Error(f"rows and draws must be above 0; they are {rows} and {draws}")
    return _core.simulate_noise(model, lengths, draws, seed)


def _rows(segments: Segments | None) -> list[tuple[str, int, int]] | None:
    if segments is None:
        return None
    for segment in segments:
        if not isinstance(segment, Sequence) or len(segment) != 2:
            raise _core.Error(f"the segment {segment!r} is no pair; it is (first, after last)")
        first, last = segment
        if not 0 <= first < last:
            raise _core.Error(
                f"the segment ({first}, {last}) has no rows; it is (first, after last)"
            )
    return [("", int(first), int(last)) for first, last in segments]
