# SPDX-License-Identifier: BSD-3-Clause
"""Where the model fails: residuals by maneuver and output, against every channel, by window."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any, Self

from sepcal import _core
from sepcal.columns import Array

WORTH_A_LINE = 0.01  # of the residual's variance: a channel that explains less is not printed
ROUNDING = 1e-9  # of the rmse: a mean below it is printed as zero


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

    @property
    def is_white(self) -> bool:
        """Whether lag_one is within 2 / sqrt(rows): noise alone is, nineteen times in twenty."""
        return bool(abs(self.lag_one) <= 2 / math.sqrt(self.rows))

    @property
    def verdict(self) -> str:
        """In words whether the residuals are noise."""
        if math.isnan(self.lag_one):
            return "too few rows to tell"
        if self.is_white:
            return "white, as noise alone would be"
        how = "correlate" if self.lag_one > 0 else "alternate"
        limit = 2 / math.sqrt(self.rows)
        return (
            f"not white: neighbouring residuals {how} "
            f"({self.lag_one:.3f}, noise alone within {limit:.2g})"
        )


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

    def __str__(self) -> str:
        return (
            f"{self.output} against {self.driver}: a line explains {self.share_line:.1%}, a smooth "
            f"curve {self.share_smooth:.1%}; slope {self.slope:.4g} +- {self.slope_error:.2g} "
            f"{self.unit}"
        )


@dataclass(frozen=True)
class Window:
    """A stretch of about a twentieth of the rows."""

    first_s: float  # time of its first and last row
    last_s: float
    rows: int
    rmse: dict[str, float]  # by output
    mean: dict[str, float]  # by output, of z - model

    def __str__(self) -> str:
        errors = ", ".join(f"{output} {error:.4g}" for output, error in self.rmse.items())
        return f"{self.first_s:.6g}:{self.last_s:.6g} s, {self.rows} rows: rmse {errors}"


@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """A calibration against a flight. `print(comparison)` shows the table."""

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

    def __str__(self) -> str:
        width = max(len("segment"), *(len(misfit.segment) for misfit in self.where))
        head = f"{'segment':<{width}}  output    rows        rmse        mean  lag-one  unit"
        lines = [head]
        for misfit in [*self.where, *self.overall]:
            mean = 0.0 if abs(misfit.mean) < ROUNDING * misfit.rmse else misfit.mean
            lines.append(
                f"{misfit.segment or 'all':<{width}}  {misfit.output:<6}{misfit.rows:>8}"
                f"{misfit.rmse:>12.4g}{mean:>12.4g}{misfit.lag_one:>9.2f}  {misfit.unit}"
            )
        lines += [f"{misfit.output}: {misfit.verdict}" for misfit in self.overall]
        telling: list[ChannelMisfit] = []
        for misfit in self.overall:
            telling += [at for at in self.channels if at.output == misfit.output][:3]
        shown = [channel for channel in telling if channel.share_smooth >= WORTH_A_LINE]
        lines += map(str, shown)
        if not shown:
            lines.append("no channel explains a hundredth of an output's residual")
        lines += [f"worst at {window}" for window in self.windows]
        return "\n".join([*lines, f"the calibration: {self.status}", *self.notes])

    def __repr__(self) -> str:
        return f"<Comparison\n{self}>"
