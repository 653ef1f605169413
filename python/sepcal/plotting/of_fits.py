# SPDX-License-Identifier: BSD-3-Clause
"""Pictures that plot() draws of calibrations and of their verbs' results."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sepcal import _core
from sepcal.comparison import Comparison
from sepcal.markup import html
from sepcal.plotting.drawings import (
    BEYOND,
    RANKED,
    Span,
    draw_correlation,
    draw_ranking,
    draw_spans,
    name_bands,
)
from sepcal.reporting import words
from sepcal.reporting.figures_cause import draw_channels
from sepcal.reporting.figures_cost import draw_ellipses, draw_landscape
from sepcal.reporting.figures_error import Step, draw_heat_strip, draw_waterfall, steps_of
from sepcal.reporting.figures_fit import draw_fit
from sepcal.reporting.figures_noise import draw_noise
from sepcal.reporting.figures_states import draw_beside_zero, draw_with_band
from sepcal.reporting.page import Figure
from sepcal.reporting.sections_flight import draw_coverage
from sepcal.reporting.trajectory import draw_flown, draw_smoothed, gather_flown

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sepcal.aircraft_fits import AircraftFit
    from sepcal.calibration import Calibration
    from sepcal.diagnosis import Diagnosis
    from sepcal.flight import Flight
    from sepcal.intervals import Intervals, Prediction
    from sepcal.results import Fit
    from sepcal.stepwise import Stepwise


def picture_fit(fit: Fit, what: str = "correlation") -> list[Figure]:
    """Pictures of any fit: the correlation of estimates that have an error."""
    if what == "ellipses":
        return draw_ellipses(fit)
    if what == "stage one":
        return picture_stage_one(fit)
    known = [i for i, at in enumerate(fit.parameters.values()) if at.standard_error > 0]
    names = [fit.names[i] for i in known]
    return [draw_correlation(names, fit.correlation[np.ix_(known, known)])] if names else []


def picture_stage_one(fit: Fit, landscape: _core.CostLandscape | None = None) -> list[Figure]:
    """Tr[R] over the nonlinear parameters: on a flight, or at the samples that a fit kept."""
    one = fit.stage_one
    minima = [minimum.xi2 for minimum in one.minima]
    estimate = {name: parameter.value for name, parameter in fit.parameters.items()}
    if landscape is not None and landscape.names:
        names, units = landscape.names, landscape.units
        return draw_landscape(names, units, landscape.points, landscape.trace_r, minima, estimate)
    names = list(one.best)
    if not names or one.samples.size == 0:
        raise _core.Error(
            "stage one sampled nothing: no nonlinear parameter was free within finite bounds, or "
            "the fit began at a start"
        )
    units = [fit.parameters[name].unit for name in names]
    return draw_landscape(names, units, one.samples, one.trace_r, minima, estimate)


def picture_calibration(
    calibration: Calibration, what: str, core: _core.Calibration, flight: Flight
) -> list[Figure]:
    """Pictures of a calibration on a flight; `core` is the calibration there."""
    if what == "stage one":
        return picture_stage_one(calibration, _core.cost_landscape(core, flight._core))
    comparison = Comparison(core.compare(flight._core))
    figures = _core.gather_figures(core, flight._core)
    if what == "fit":
        return [draw_fit(comparison, figures, calibration.noise)]
    if what == "channels":
        return draw_channels(comparison, figures.channel)
    if what == "coverage":
        return draw_coverage(calibration, flight, figures)[0]
    outputs = [misfit.output for misfit in comparison.overall]
    sizes = [calibration.noise[output] for output in outputs]
    units = [misfit.unit for misfit in comparison.overall]
    return draw_noise(
        outputs, units, comparison.residuals, figures.runs, figures.interval[1], sizes,
        np.array(sizes),
    )  # fmt: skip


def picture_steps(calibration: Calibration) -> list[Figure]:
    """The share of the error that each added effect removed."""
    steps = steps_of(calibration.history)
    if not steps:
        raise _core.Error("there are no steps: nothing was added yet; add(effect) makes one")
    return [draw_waterfall(steps, math.nan, calibration.core.unit)]


def picture_aircraft(
    fit: AircraftFit, what: str, flight: Flight, process_noise: Mapping[str, float]
) -> list[Figure]:
    """Pictures of a flight path or an aircraft on a flight."""
    flown = gather_flown([fit], flight, [], process_noise, lambda _: None)
    if what == "fit":
        return [draw_flown(flown)]
    if what == "channels":
        return draw_channels(flown.comparison, flown.read)
    if flown.smoothed is None:
        raise _core.Error(
            f"{what} needs process noise: plot({what!r}, process_noise={{...}}), as of smooth()"
        )
    return draw_smoothed(flown, what)


def picture_comparison(comparison: Comparison, what: str) -> list[Figure]:
    """Where a model fails."""
    outputs = [misfit.output for misfit in comparison.overall]
    if what == "where":
        known = comparison.noise
        per = "noise of the fit" if known else "RMSE overall"
        sizes = [known.get(misfit.output, misfit.rmse) for misfit in comparison.overall]
        return [draw_heat_strip(comparison.where, outputs, sizes, per, _title(comparison.where))]
    if what == "references":
        return _picture_references(comparison)
    sizes = [misfit.rmse for misfit in comparison.overall]
    drawn = [
        draw_beside_zero(
            f"residual of {misfit.output}", misfit.unit, comparison.time,
            comparison.residuals[:, i], np.full(comparison.time.size, sizes[i]), [],
        )
        for i, misfit in enumerate(comparison.overall)
    ]  # fmt: skip
    return name_bands(drawn, "2 RMSE to either side")


def _picture_references(comparison: Comparison) -> list[Figure]:
    """Calibrated readings less each reference, over time."""
    if not comparison.references:
        raise _core.Error('there is no reference: compare(reference="COLUMN") names one')
    drawn = [
        draw_beside_zero(
            f"difference of {at.calibrated} to {at.reference}", at.unit, at.time, at.difference,
            np.full(at.time.size, at.rms), [],
        )
        for at in comparison.references
    ]  # fmt: skip
    return name_bands(drawn, "2 rms to either side")


def _title(where: Sequence[_core.Misfit]) -> str:
    """The meaning of a heat strip's numbers."""
    units = {misfit.unit for misfit in where}
    if len(units) > 1:
        return "RMSE by stretch of the flight, each output in its own unit"
    return words.titled("RMSE by stretch of the flight", *units)


def picture_diagnosis(diagnosis: Diagnosis, what: str) -> list[Figure]:
    """Candidates, or where the model fails."""
    if what == "where":
        outputs = list(dict.fromkeys(misfit.output for misfit in diagnosis.where))
        told = diagnosis.residual
        floors = [told[output].floor or told[output].rmse for output in outputs]
        return [draw_heat_strip(diagnosis.where, outputs, floors, title=_title(diagnosis.where))]
    shown = [at for at in diagnosis.effects if at.status != "cannot_be_seen"][:RANKED]
    if not shown:
        return []
    return [
        draw_ranking(
            [at.name for at in shown],
            100 * np.array([at.predicted_drop for at in shown]),
            100 * np.array([at.held_out_gain for at in shown]),
            [at.status == "found" for at in shown],
        )
    ]


def picture_stepwise(stepwise: Stepwise[Any]) -> list[Figure]:
    """The error after every effect that was added, by its own outputs."""
    if not stepwise.steps:
        return picture_diagnosis(stepwise.diagnosis, "candidates")
    first = stepwise.steps[0]
    steps = [Step("first model", first.rmse_before, math.nan, math.nan)]
    steps += [
        Step(f"+ {at.effect}", at.rmse_after, math.nan, at.rmse_before * (1 - at.predicted_drop))
        for at in stepwise.steps
    ]
    units = {at.unit for at in stepwise.diagnosis.where}
    return [draw_waterfall(steps, math.nan, units.pop() if len(units) == 1 else "")]


def picture_intervals(intervals: Intervals) -> list[Figure]:
    """Both kinds of interval, every parameter in half widths of its own Gaussian one."""
    rows: list[str] = []
    gaussian: list[Span] = []
    profile: list[Span] = []
    for at in intervals.parameters.values():
        half = 0.5 * (at.gaussian[1] - at.gaussian[0])
        if not half > 0:
            continue
        low, high = ((end - at.value) / half for end in at.profile)
        name = words.abbreviate(at.name, 34)
        rows.append(html("{}: {}", name, words.estimate(at.value, half, at.unit)))
        gaussian.append(Span(-1.0, 1.0))
        profile.append(Span(max(low, -BEYOND), min(high, BEYOND)))
    if not rows:
        return []
    title = f"Intervals of {100 * intervals.level:g} %"
    kinds = {"by standard errors": gaussian, "by the likelihood's profile": profile}
    x_title = "from the estimate [half widths by standard errors]"
    return [draw_spans(title, x_title, rows, [0.0] * len(rows), kinds)]


def picture_prediction(prediction: Prediction) -> list[Figure]:
    """Every output's value with the band of a new measurement."""
    time = prediction.time
    at = np.arange(len(prediction.value), dtype=float) if time is None else time
    x_title = "row" if time is None else "time [s]"
    level = prediction._level
    share = "" if level is None else f"{100 * level:g} % of "
    band = f"holds {share}new measurements"
    drawn = []
    for i in range(prediction.value.shape[1]):
        name = prediction.outputs[i] if prediction.outputs else f"output {i + 1}"
        half = 0.5 * prediction.quantile * prediction.measurement_error[:, i]
        unit = prediction.units.get(name, "1")
        drawn.append(draw_with_band(name, unit, at, prediction.value[:, i], half, [], x_title))
    return name_bands(drawn, band)
