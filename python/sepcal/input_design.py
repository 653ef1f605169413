# SPDX-License-Identifier: BSD-3-Clause
"""Inputs to be flown: multisines and 3-2-1-1."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from sepcal.arguments import checked
from sepcal.bands import RIGID, to_band
from sepcal.columns import Array
from sepcal.plots import Backend, Theme
from sepcal.states_module import states_module
from sepcal.whole_files import name_of

if TYPE_CHECKING:
    from sepcal import _states


@dataclass(frozen=True, repr=False)
class InputDesign:
    """Inputs over time.

    Attributes:
        kind: "multisine" or "3-2-1-1".
        time: (N,) [s], from zero.
        signals: {header: (N,)}; zero in the first row and in the last.
        frequencies: {header: (k,)} [Hz] of a multisine.
        peak_factors: {header: (max - min) / (2 sqrt(2) rms)} of a multisine, 1 of a single sine.
        step: For 3-2-1-1, how long a "1" lasts [s]; NaN for a multisine.
        share_in_band: For 3-2-1-1, the share of its energy in the band; NaN for a multisine.

    Example:
        >>> made = sepcal.multisines({"elevator_rad": 0.05}, duration=10)
        >>> len(made.frequencies["elevator_rad"]), made.peak_factors["elevator_rad"] < 1.1
        (20, True)
    """

    kind: str
    time: Array
    signals: dict[str, Array]
    frequencies: dict[str, Array]
    peak_factors: dict[str, float]
    step: float
    share_in_band: float
    _core: _states.Design = field(repr=False)

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes time_s and the signals as a CSV, whole or not at all.

        Raises:
            Error: The file can't be written.

        Example:
            >>> made = sepcal.three_two_one_one({"elevator_rad": 0.05})
            >>> made.save(folder / "steps.csv")
            >>> (folder / "steps.csv").read_text().splitlines()[0]
            'time_s,elevator_rad'
        """
        self._core.save(name_of(file))

    def plot(self, *, backend: Backend = "plotly", theme: Theme = "light") -> Any:  # noqa: ANN401
        """Draws every signal over time.

        Args:
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: The library is not installed.

        Example:
            >>> made = sepcal.multisines({"elevator_rad": 0.05}, duration=10)
            >>> drawn = made.plot(backend="matplotlib")
        """
        from sepcal.plotting import as_figure
        from sepcal.plotting.of_bands import picture_design

        return as_figure(picture_design(self), backend, theme)

    def __repr__(self) -> str:
        return self._core.to_text()


@checked
def multisines(
    amplitudes: Mapping[str, float],
    *,
    band: tuple[float, float] = RIGID,
    duration: float = 20.0,
    rate: float = 50.0,
    optimised: bool = True,
) -> InputDesign:
    """Sums of sines, one for each surface, orthogonal to each other, of little peak factor.

    Harmonics of one over the duration go to the inputs in turn, all of one power. Phases are those
    of the least relative peak factor, and every signal begins and ends at zero.

    Args:
        amplitudes: {header: largest deflection, in the header's unit}.
        band: (low, high) [Hz].
        duration: One period of them all [s].
        rate: Rows a second.
        optimised: False: phases by Schroeder's formula.

    Raises:
        Error: No such band, amplitude or rate; fewer than two harmonics an input.

    Example:
        >>> made = sepcal.multisines({"elevator_rad": 0.05, "aileron_rad": 0.1}, duration=10)
        >>> abs(float(made.signals["elevator_rad"] @ made.signals["aileron_rad"])) < 1e-9
        True
    """
    named = [(name, float(size)) for name, size in amplitudes.items()]
    made = states_module().multisines(
        named, to_band(band), float(duration), float(rate), bool(optimised)
    )
    return _design(made)


@checked
def three_two_one_one(
    amplitudes: Mapping[str, float],
    *,
    band: tuple[float, float] = RIGID,
    rate: float = 50.0,
    before: float = 1.0,
    after: float = 5.0,
) -> InputDesign:
    """Steps of three, two, one and one times a length, to the one side and the other.

    The length is that which puts most of the energy into the band, rounded to rows.

    Args:
        amplitudes: {header: deflection, in the header's unit} of one surface.
        band: (low, high) [Hz].
        rate: Rows a second.
        before: Rest before the steps [s].
        after: Rest after them [s].

    Raises:
        Error: No such band, amplitude or rate; several surfaces.

    Example:
        >>> sepcal.three_two_one_one({"elevator_rad": 0.05}, band=(0.3, 0.9)).step
        0.5
    """
    named = [(name, float(size)) for name, size in amplitudes.items()]
    made = states_module().three_two_one_one(
        named, to_band(band), float(rate), float(before), float(after)
    )
    return _design(made)


def _design(made: _states.Design) -> InputDesign:
    return InputDesign(
        kind=made.kind,
        time=np.asarray(made.time),
        signals={name: made.signals[:, i] for i, name in enumerate(made.inputs)},
        frequencies={
            name: np.asarray(values)
            for name, values in zip(made.inputs, made.frequencies, strict=False)
        },
        peak_factors=dict(zip(made.inputs, made.peak_factors, strict=False)),
        step=made.step,
        share_in_band=made.share,
        _core=made,
    )
