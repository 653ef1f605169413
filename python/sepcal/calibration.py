# SPDX-License-Identifier: BSD-3-Clause
"""A calibration: a probe fitted on a flight, to be compared, applied, saved and loaded."""

import json
import os
from dataclasses import dataclass, fields
from typing import Any, Self

from sepcal import _core
from sepcal.columns import Array
from sepcal.comparison import Comparison
from sepcal.flight import Flight
from sepcal.results import Fit, to_fields

Path = str | os.PathLike[str]


@dataclass(frozen=True)
class Applied:
    """What apply_to_file() did."""

    rows: int
    rows_left_empty: int  # nothing to calibrate: total below static pressure, or dropped
    headers: list[str]  # the columns added
    notes: list[str]  # one line each, for people


@dataclass(frozen=True, eq=False, repr=False)
class Calibration(Fit):
    """A Fit of a probe, with all that later verbs need: probe, options, and the flight fitted.

    It pickles as its JSON, without the flight and without stage one's samples.
    """

    notes: list[str]  # what was dropped or ignored, one line each, for people
    core: _core.Calibration
    flight: Flight | None  # that was fitted; None where the calibration was loaded

    @classmethod
    def _of(cls, core: _core.Calibration, flight: Flight | None = None) -> Self:
        return cls(**to_fields(core.fit), notes=core.notes, core=core, flight=flight)

    @property
    def fit(self) -> Fit:
        """The fit alone."""
        return Fit(**{field.name: getattr(self, field.name) for field in fields(Fit)})

    def compare(self, flight: Flight | None = None) -> Comparison:
        """Residuals on a flight, by default the fitted one, by maneuver and output.

        Raises:
            Error: Bad input, as in fit(); no flight given where the calibration was loaded.
        """
        flight = flight if flight is not None else self.flight
        if flight is None:
            raise _core.Error(
                "a loaded calibration has no flight; give one: "
                f"compare(sepcal.read_csv({self.core.file!r}))"
            )
        return Comparison._of(self.core.compare(flight._core))

    def apply(self, flight: Flight) -> dict[str, Array]:
        """The corrected readings of a flight by header, each of shape (rows,).

        Five-hole: airspeed_cal_mps, alpha_cal_rad, beta_cal_rad. Magnetometer: mx_cal_ut,
        my_cal_ut, mz_cal_ut, the field in body axes. NaN in a row that can't be calibrated.

        Raises:
            Error: Bad input, or a calibration that can't be inverted.
        """
        return self.core.apply(flight._core)

    def apply_to_file(self, file: Path, output: Path) -> Applied:
        """Copies a CSV log and adds the corrected columns; `output` appears whole or not at all.

        Raises:
            Error: Bad input, columns of those names that are there already, an output that can't be
                written.
        """
        return Applied(**self.core.apply_to_file(os.fspath(file), os.fspath(output)))

    def save(self, file: Path) -> None:
        """Writes to_json() to a file that appears whole or not at all; raises Error if it can't."""
        self.core.save(os.fspath(file))

    def to_json(self) -> str:
        """The JSON that the app's fit writes with -o."""
        return self.core.to_json()

    def to_dict(self) -> dict[str, Any]:
        """The same as a dictionary; None where a number is undefined."""
        read: dict[str, Any] = json.loads(self.to_json())
        return read

    def __reduce__(self) -> tuple[Any, ...]:
        return _parse, (self.to_json(),)


def load(file: Path) -> Calibration:
    """Reads what Calibration.save() or an app's fit wrote.

    Raises:
        Error: The file can't be read, is no calibration, or is of another schema version.
    """
    return Calibration._of(_core.read_calibration(os.fspath(file)))


def _parse(text: str) -> Calibration:
    return Calibration._of(_core.parse_calibration(text, "pickle"))
