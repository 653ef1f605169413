# SPDX-License-Identifier: BSD-3-Clause
"""Where the model fails: residuals by maneuver and output."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any, Self

from sepcal import _core
from sepcal.columns import Array

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


@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """A calibration against a flight. `print(comparison)` shows the table."""

    status: str  # of the calibration, repeated
    message: str
    overall: list[Misfit]  # one an output
    where: list[Misfit]  # maneuver by maneuver, outputs within, in the flight's order
    time: Array  # (N,) [s], of every row used
    residuals: Array  # (N, n_z), z - model
    notes: list[str]  # one line each, for people
    json: str

    @classmethod
    def _of(cls, described: _core.ComparisonDescription) -> Self:
        fields: dict[str, Any] = {**described}
        for name in ("overall", "where"):
            fields[name] = [Misfit(**misfit) for misfit in fields[name]]
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
        return "\n".join([*lines, f"the calibration: {self.status}", *self.notes])

    def __repr__(self) -> str:
        return f"<Comparison\n{self}>"
