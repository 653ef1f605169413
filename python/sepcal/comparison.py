# SPDX-License-Identifier: BSD-3-Clause
"""Where the model fails: residuals by maneuver and output, against every channel, by window."""

from __future__ import annotations

import json
import math
from typing import Any

from sepcal import _core
from sepcal.pages import Page, Row


class Comparison(Page, _core.Comparison):
    """A calibration against a flight. `print(comparison)` shows the table."""

    _shown = ("segment", "output", "rows", "rmse", "mean", "lag_one", "unit")

    def to_json(self) -> str:
        """The JSON that the app's compare prints."""
        return self.json

    def to_dict(self) -> dict[str, Any]:
        """The same as a dictionary; None where a number is undefined."""
        read: dict[str, Any] = json.loads(self.json)
        return read

    def _summary(self) -> str:
        total = math.sqrt(sum(misfit.rmse**2 for misfit in self.overall) / len(self.overall))
        return f"{self.model} on {self.file}: rmse {total:.3g} {self.overall[0].unit}"

    def _rows(self) -> list[Row]:
        return [
            misfit._asdict() | {"segment": misfit.segment or "all", "verdict": misfit.verdict}
            for misfit in (*self.where, *self.overall)
        ]
