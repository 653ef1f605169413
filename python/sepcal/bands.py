# SPDX-License-Identifier: BSD-3-Clause
"""A band of frequencies as functions take it."""

from __future__ import annotations

from collections.abc import Sequence

from sepcal import _core

RIGID = (0.1, 2.0)  # Hz, what a rigid aircraft does


def to_band(band: object, spacing: float = 0.0) -> tuple[float, float, float]:
    """(low, high, spacing) [Hz]. Raises Error for what is no pair of numbers."""
    if not isinstance(band, Sequence) or isinstance(band, str) or len(band) != 2:
        raise _core.Error(f"band is {band!r}; give (low, high) in Hz, (0.1, 2)")
    try:
        return float(band[0]), float(band[1]), float(spacing)
    except (TypeError, ValueError):
        raise _core.Error(f"band is {band!r}; give two numbers in Hz, (0.1, 2)") from None
