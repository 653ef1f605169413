# SPDX-License-Identifier: BSD-3-Clause
"""An autopilot's parameters in the course of a log."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from sepcal.columns import Array


class Parameters:
    """Values by name, each from the time on at which it was set; the first one from the start."""

    def __init__(self, settings: Iterable[tuple[float, str, float]]) -> None:
        """Takes (time [s], name, value), in the log's order."""
        self._settings: dict[str, list[tuple[float, float]]] = {}
        for time, name, value in settings:
            self._settings.setdefault(name, []).append((time, float(value)))

    def __contains__(self, name: str) -> bool:
        return name in self._settings

    def names(self) -> tuple[str, ...]:
        """All that were logged."""
        return tuple(self._settings)

    def first(self, name: str, default: float = 0.0) -> float:
        """The value at the start."""
        return self._settings[name][0][1] if name in self._settings else default

    def at(self, name: str, times: Array, default: float = 0.0) -> Array:
        """The value at each time, shape of `times`; the default where it isn't logged."""
        if name not in self._settings:
            return np.full(times.shape, default)
        set_at, values = np.array(self._settings[name]).T
        at = np.searchsorted(np.maximum.accumulate(set_at), times, side="right") - 1
        return np.asarray(values[np.clip(at, 0, None)])

    def stack(self, names: Iterable[str], times: Array, default: float = 0.0) -> Array:
        """Several of them side by side, shape (n, count)."""
        return np.stack([self.at(name, times, default) for name in names], axis=-1)
