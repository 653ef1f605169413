# SPDX-License-Identifier: BSD-3-Clause
"""Frequency responses from a flight, without a model."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sepcal.arguments import checked
from sepcal.bands import RIGID, to_band
from sepcal.columns import Array
from sepcal.flight import AnyFlight, to_flight
from sepcal.plots import Backend, Theme
from sepcal.states_module import states_module
from sepcal.whole_files import name_of

if TYPE_CHECKING:
    from sepcal import _states


@dataclass(frozen=True, repr=False)
class FrequencyResponse:
    """The result of frequency_response(); M frequencies, n inputs.

    Attributes:
        inputs: Headers, n.
        output: The header.
        frequencies: (M,) [Hz].
        response: (M, n) complex, the output's unit over the input's.
        coherence: (M, n), of each input with what the others leave of the output.
        coherence_all: (M,), of all inputs together.
        standard_error: (M, n), of the real and of the imaginary part.
        radius: (M, n): the truth lies within it of `response`, at the level.
        magnitude: (M, n), and its range `magnitude_low`, `magnitude_high`.
        phase: (M, n) [rad], unwrapped along the frequencies, and its range `phase_low`,
            `phase_high`, NaN where the circle of `radius` holds zero.
        window: That was averaged [s].
        windows: How many.
        averages: Independent windows that these are worth, as they overlap by half.
        notes: Notes on what was dropped, one line each.

    Example:
        >>> flight = sepcal.datasets.load("aircraft")
        >>> of, to = "elevator_rad", "q_radps"
        >>> found = sepcal.frequency_response(flight, of, to, window=2, band=(1, 3))
        >>> bool((found.magnitude_low <= found.magnitude).all())
        True
    """

    inputs: list[str]
    output: str
    frequencies: Array
    response: NDArray[np.complex128]
    coherence: Array
    coherence_all: Array
    standard_error: Array
    radius: Array
    magnitude: Array
    magnitude_low: Array
    magnitude_high: Array
    phase: Array
    phase_low: Array
    phase_high: Array
    window: float
    windows: int
    averages: float
    notes: list[str]
    _core: _states.Response = field(repr=False)

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes the table that `sepcal aircraft response` does, whole or not at all.

        Raises:
            Error: The file can't be written.

        Example:
            >>> flight = sepcal.datasets.load("aircraft")
            >>> of, to = "elevator_rad", "q_radps"
            >>> found = sepcal.frequency_response(flight, of, to, window=2, band=(1, 3))
            >>> found.save(folder / "response.csv")
            >>> (folder / "response.csv").read_text().split(",")[0]
            'frequency_hz'
        """
        self._core.save(name_of(file))

    def plot(self, *, backend: Backend = "plotly", theme: Theme = "light") -> Any:  # noqa: ANN401
        """Draws magnitude, phase and coherence of every input, with where the truth lies.

        Args:
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: The library is not installed.

        Example:
            >>> flight = sepcal.datasets.load("aircraft")
            >>> of, to = "elevator_rad", "q_radps"
            >>> found = sepcal.frequency_response(flight, of, to, window=2, band=(1, 3))
            >>> drawn = found.plot(backend="matplotlib")
        """
        from sepcal.plotting import as_figure
        from sepcal.plotting.of_bands import picture_response

        return as_figure(picture_response(self), backend, theme)

    def __repr__(self) -> str:
        return self._core.to_text()


@checked
def frequency_response(
    flight: AnyFlight,
    inputs: str | Sequence[str],
    output: str,
    *,
    band: tuple[float, float] = RIGID,
    spacing: float = 0.0,
    window: float = 0.0,
    level: float = 0.95,
) -> FrequencyResponse:
    """H of output = H inputs + noise over a band, by averages over windows.

    Windows overlap by half, are freed of their straight lines and tapered (Hann); none crosses a
    gap or a change of maneuver. Of several inputs each has what the others leave. What is sharper
    than one over the window is smeared, which the ranges don't know.

    Args:
        flight: With a time.
        inputs: One header or several, "elevator_rad".
        output: Another header, "q_radps".
        band: (low, high) [Hz].
        spacing: Step between the frequencies [Hz]; 0: one over the window.
        window: [s]; 0: a fifth of the longest segment, at least two periods of the band's low end.
        level: Confidence level of the ranges.

    Raises:
        Error: A column that is missing; a window that is too short for the band or too long for the
            flight.

    Example:
        >>> flight = sepcal.datasets.load("aircraft")
        >>> of, to = "elevator_rad", "q_radps"
        >>> found = sepcal.frequency_response(flight, of, to, window=2, band=(1, 3))
        >>> found.coherence.shape == found.response.shape
        True
    """
    names = [inputs] if isinstance(inputs, str) else list(inputs)
    core = states_module().frequency_response(
        to_flight(flight, "frequency_response(")._core,
        names,
        output,
        to_band(band, spacing),
        float(window),
        float(level),
    )
    magnitude, low, high, phase, phase_low, phase_high = core.polar()
    return FrequencyResponse(
        inputs=core.inputs,
        output=core.output,
        frequencies=np.asarray(core.frequencies),
        response=core.response,
        coherence=core.coherence,
        coherence_all=core.coherence_all,
        standard_error=core.standard_error,
        radius=core.radius,
        magnitude=magnitude,
        magnitude_low=low,
        magnitude_high=high,
        phase=phase,
        phase_low=phase_low,
        phase_high=phase_high,
        window=core.window,
        windows=core.windows,
        averages=core.averages,
        notes=core.notes,
        _core=core,
    )
