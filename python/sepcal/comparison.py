# SPDX-License-Identifier: BSD-3-Clause
"""Where the model fails: residuals by maneuver and output, against every channel, by window."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from typing import Any, Self

from sepcal import _core
from sepcal.columns import Array
from sepcal.pages import Page, Row


@dataclass(frozen=True)
class Misfit:
    """One output over one stretch of a flight; NaN where there are too few rows."""

    segment: str  # maneuver, or "120.0:180.5" [s] where there are no labels; empty: the whole
    output: str
    unit: str
    rows: int
    rmse: float
    mean: float  # of z - model: what a constant offset would explain
    lag_one: float  # correlation of neighbouring residuals, never across a segment's edge
    verdict: str  # in words whether the residuals are noise

    @property
    def is_white(self) -> bool:
        """Whether lag_one is within 2 / sqrt(rows): noise alone is, nineteen times in twenty."""
        return bool(abs(self.lag_one) <= 2 / math.sqrt(self.rows))


@dataclass(frozen=True)
class ChannelMisfit:
    """One output's residual against one channel of the flight."""

    driver: str  # "altitude_m"; "time", "alpha", "roll" for what the probe knows by itself
    output: str
    share_line: float  # of the residual's variance that a straight line would explain
    share_smooth: float  # the same of a natural spline of six even knots
    slope: float  # of the line
    slope_error: float  # its standard error in the residual's own noise, rather too large
    unit: str  # of the slope


@dataclass(frozen=True)
class Window:
    """A stretch of about a twentieth of the rows."""

    first_s: float  # time of its first and last row
    last_s: float
    rows: int
    rmse: dict[str, float]  # by output
    mean: dict[str, float]  # by output, of z - model


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Page):
    """A calibration against a flight. `print(comparison)` shows the table."""

    _shown = ("segment", "output", "rows", "rmse", "mean", "lag_one", "unit")

    model: str
    file: str  # of the flight
    status: str  # of the calibration, repeated
    message: str
    overall: list[Misfit]  # one an output
    where: list[Misfit]  # maneuver by maneuver, outputs within, in the flight's order
    channels: list[ChannelMisfit]  # by share_smooth, largest first
    windows: list[Window]  # the five worst in units of the fit's noise, worst first
    time: Array  # (N,) [s], of every row used
    residuals: Array  # (N, n_z), z - model
    notes: list[str]  # one line each, for people
    json: str
    text: str  # what print() shows: the app's page
    explained: str  # the same with the whole message, as by the apps' --explain

    @classmethod
    def _of(cls, described: _core.ComparisonDescription) -> Self:
        fields: dict[str, Any] = {**described}
        for name in ("overall", "where"):
            fields[name] = [Misfit(**misfit) for misfit in fields[name]]
        fields["channels"] = [ChannelMisfit(**channel) for channel in fields["channels"]]
        fields["windows"] = [Window(**window) for window in fields["windows"]]
        return cls(**fields)

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
        rows = [asdict(misfit) for misfit in (*self.where, *self.overall)]
        return [row | {"segment": row["segment"] or "all"} for row in rows]
