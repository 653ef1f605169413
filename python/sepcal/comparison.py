# SPDX-License-Identifier: BSD-3-Clause
"""Where the model fails: residuals by maneuver and output, against every channel, by window."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Literal

from sepcal import _core
from sepcal.arguments import checked
from sepcal.pages import Page, Row
from sepcal.plots import Backend, Theme


@checked
class Comparison(Page, _core.Comparison):
    """A calibration against a flight. `print(comparison)` shows the table.

    Example:
        >>> flight = sepcal.datasets.load("pitot")
        >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
        >>> comparison = base.compare()
        >>> [(misfit.output, round(misfit.rmse, 2), misfit.unit) for misfit in comparison.overall]
        [('airspeed', 0.46, 'm/s')]
    """

    _shown = ("segment", "output", "rows", "rmse", "mean", "lag_one", "unit")
    noise: Mapping[str, float] = MappingProxyType({})  # of the fit, by output; pickled it is lost

    def __init__(self, core: _core.Comparison, noise: Mapping[str, float] | None = None) -> None:
        super().__init__(core)
        self.noise = noise or {}

    def to_json(self) -> str:
        """The JSON that the app's compare prints.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> base.compare().to_json().startswith("{")
            True
        """
        return self.json

    def to_dict(self) -> dict[str, Any]:
        """The same as a dictionary; None where a number is undefined.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> base.compare().to_dict()["model"]
            'pitot-static'
        """
        read: dict[str, Any] = json.loads(self.json)
        return read

    def plot(
        self,
        what: Literal["where", "residuals", "references"] | str = "where",
        *,
        backend: Backend = "plotly",
        theme: Theme = "light",
    ) -> Any:  # noqa: ANN401
        """Draws where the model fails; against the channels: Calibration.plot("channels").

        Args:
            what: "where", the error by stretch of the flight and output; "residuals", over time;
                "references", what is calibrated less the references over time.
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; no reference; the library is not installed.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> drawn = base.compare().plot("residuals", backend="matplotlib")
            >>> drawn.savefig(folder / "residuals.png")
        """
        from sepcal.plotting import as_figure, choose
        from sepcal.plotting.of_fits import picture_comparison

        choose(what, ("where", "residuals", "references"))
        return as_figure(picture_comparison(self, what), backend, theme, columns=1)

    def _summary(self) -> str:
        total = math.sqrt(sum(misfit.rmse**2 for misfit in self.overall) / len(self.overall))
        return f"{self.model} on {self.file}: rmse {total:.3g} {self.overall[0].unit}"

    def _rows(self) -> list[Row]:
        return [
            misfit._asdict() | {"segment": misfit.segment or "all", "verdict": misfit.verdict}
            for misfit in (*self.where, *self.overall)
        ]
