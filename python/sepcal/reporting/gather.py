# SPDX-License-Identifier: BSD-3-Clause
"""All that a report shows, computed once: the engine's verdicts, and the rows they are about."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sepcal import _core
from sepcal._core import EffectFinding
from sepcal.calibration import Calibration
from sepcal.columns import Array
from sepcal.comparison import Comparison
from sepcal.diagnosis import Diagnosis
from sepcal.flight import Flight
from sepcal.reporting.figures_fit import Run, runs_of

TRIED = 3  # of the ranked candidates: so many are added, to show what each explains


@dataclass(frozen=True)
class Trial:
    """A candidate that was added for the picture alone."""

    finding: EffectFinding
    explained: Array  # (N, n_z), old minus new residual; NaN in a row that the new fit lacks


@dataclass(frozen=True)
class Material:
    """The last calibration of a chain on a flight. N is the number of rows compared."""

    chain: list[Calibration]
    comparisons: list[Comparison]  # one a calibration
    files: list[str]  # of the calibrations; empty where they have none
    flight: Flight
    diagnosis: Diagnosis
    description: dict[str, Any]  # Calibration.to_dict() of the last
    figures: _core.FlightFigures  # of the last on the flight
    landscape: _core.CostLandscape  # stage one's, of the last on the flight
    trials: list[Trial]
    notes: list[str]

    @property
    def last(self) -> Calibration:
        """The calibration that the report is about."""
        return self.chain[-1]

    @property
    def comparison(self) -> Comparison:
        """The comparison of the last calibration."""
        return self.comparisons[-1]

    @property
    def maneuvers(self) -> list[Run]:
        """Label, first and last time [s] of each; none where the log has no labels."""
        return runs_of(self.comparison.time, self.figures.segments)

    @property
    def flight_files(self) -> list[str]:
        """The flight's file, or those of a joint fit's flights."""
        if not self.last.flights or not self.is_fitted_flight:
            return [self.flight.name]
        return [str(flight["file"]) for flight in self.description["joint"]["flights"]]

    @property
    def title(self) -> str:
        """The flight's name without its folder; of several, all of them."""
        return " + ".join(os.path.basename(file) or file for file in self.flight_files)

    @property
    def model(self) -> str:
        """five-hole, pitot-static, magnetometer, magnetometer-norm."""
        return str(self.description["model"])

    @property
    def options(self) -> dict[str, Any]:
        """The options of the last calibration's fit."""
        return dict(self.description["options"])

    @property
    def outputs(self) -> list[str]:
        """Their names, in the order of the residuals' columns."""
        return [misfit.output for misfit in self.comparison.overall]

    @property
    def units(self) -> list[str]:
        """The units of the outputs."""
        return [misfit.unit for misfit in self.comparison.overall]

    @property
    def noise(self) -> Array:
        """The outputs' noise on the fitted flight, from which the 2-sigma bands are made."""
        return np.array([self.last.noise[output] for output in self.outputs])

    @property
    def floors(self) -> list[float]:
        """The rms of the outputs' innovations on this flight; the RMSE where that isn't known."""
        told = self.diagnosis.residual
        return [told[misfit.output].floor or misfit.rmse for misfit in self.comparison.overall]

    @property
    def is_fitted_flight(self) -> bool:
        """Whether the last was fitted on this flight; arrays have no hash to tell by."""
        if not self.flight.sha256:
            return self.last.flight is self.flight
        fitted = self.description["inputs"]["sha256"]
        return bool(fitted == self.flight.sha256)


def gather(
    chain: Sequence[Calibration],
    flight: Flight | None,
    diagnosis: Diagnosis | None,
    files: list[str],
    report_progress: Callable[[str], None],
) -> Material:
    """Compares, diagnoses and tries the first candidates. Raises Error as those do."""
    last = chain[-1]
    described = [calibration.to_dict() for calibration in chain]
    models = sorted({str(description["model"]) for description in described})
    if len(models) > 1:
        raise _core.Error(f"the calibrations are of several models: {', '.join(models)}; give one")
    if flight is None:
        flight = last.flight
    if flight is None:
        raise _core.Error(
            "a loaded calibration has no flight; give one: "
            f"report(..., flight=sepcal.read({last.core.file!r}))"
        )
    report_progress("comparing")
    comparisons = [calibration.compare(flight) for calibration in chain]
    if diagnosis is None:
        report_progress("diagnosing, which may take a minute")
    found = diagnosis if diagnosis is not None else last.diagnose(flight)
    notes: list[str] = []
    return Material(
        chain=list(chain),
        comparisons=comparisons,
        files=files,
        flight=flight,
        diagnosis=found,
        description=described[-1],
        figures=_core.gather_figures(last.core, flight._core),
        landscape=_core.cost_landscape(last.core, flight._core),
        trials=try_candidates(last, flight, comparisons[-1], found, notes, report_progress),
        notes=list(dict.fromkeys([*last.notes, *found.notes, *comparisons[-1].notes, *notes])),
    )


def try_candidates(
    calibration: Calibration,
    flight: Flight,
    comparison: Comparison,
    diagnosis: Diagnosis,
    notes: list[str],
    report_progress: Callable[[str], None],
) -> list[Trial]:
    """The part that each first candidate explains once every parameter has taken its share."""
    trials: list[Trial] = []
    for finding in diagnosis.effects:
        if len(trials) == TRIED:
            break
        if finding.status == "cannot_be_seen":
            continue
        report_progress(f"trying {finding.name}")
        try:
            tried = calibration.core.compare(flight._core, finding.name)
        except _core.Error as error:
            notes.append(f"{finding.name} can't be drawn: {error}")
            continue
        place = {at: row for row, at in enumerate(tried.time.tolist())}
        there = [place.get(at, -1) for at in comparison.time.tolist()]
        left = np.vstack([tried.residuals, np.full((1, tried.residuals.shape[1]), np.nan)])
        trials.append(Trial(finding, comparison.residuals - left[there]))
    return trials
