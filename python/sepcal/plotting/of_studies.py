# SPDX-License-Identifier: BSD-3-Clause
"""Pictures that plot() draws of many trials and of many flights."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.plotting.drawings import Span, draw_estimates, draw_pulls, draw_spans
from sepcal.reporting import words
from sepcal.reporting.page import Figure

if TYPE_CHECKING:
    from sepcal.many_results import ManyFit
    from sepcal.monte_carlo_results import MonteCarlo
    from sepcal.trial_fits import TrialFits


def picture_study(study: MonteCarlo, what: str | None) -> list[Figure]:
    """Draws each parameter's estimates, or their errors in standard errors."""
    if not study.names:
        raise _core.Error("the trials gave no estimates; nothing can be drawn")
    errors = (study.estimates - study.truth) / study.standard_errors
    is_known = np.atleast_1d(np.isfinite(errors).any(axis=0))
    if what is None:
        what = "errors" if is_known.any() else "estimates"
    if what == "errors":
        if not is_known.any():
            raise _core.Error('the errors aren\'t known: no truth was given; plot("estimates")')
        drawn = zip(study.names, errors.T, is_known, strict=True)
        return [draw_pulls(name, column) for name, column, known in drawn if known]
    return [
        draw_estimates(
            name, name, column, {"truth": float(np.mean(truth)), "mean": float(np.nanmean(column))}
        )
        for name, column, truth in zip(study.names, study.estimates.T, study.truth.T, strict=True)
        if _differs(column)
    ]


def picture_trials(fits: TrialFits) -> list[Figure]:
    """Draws each parameter's estimates."""
    return [
        draw_estimates(name, name, column, {"mean": float(np.nanmean(column))})
        for name, column in zip(fits.names, fits.estimates.T, strict=True)
        if _differs(column)
    ]


def _differs(estimates: Array) -> bool:
    """Whether a parameter was estimated: one that is held has the same value in every trial."""
    there = estimates[np.isfinite(estimates)]
    return there.size == 1 or bool(np.ptp(there)) if there.size else False


def picture_flights(fit: ManyFit, what: str) -> list[Figure]:
    """By flight its own parameters, or how it departs from the others, with 2 standard errors."""
    flights = list(fit.flights.values())
    if what == "own":
        names = list(flights[0].own) if flights else []
        if not names:
            raise _core.Error('no flight has parameters of its own: fit_many(..., own=["w_n"])')
        return [
            _by_flight(
                name,
                words.abbreviate(name, 24),
                flights[0].own[name].unit,
                {at.name: (at.own[name].value, at.own[name].standard_error) for at in flights},
            )
            for name in names
        ]
    names = [at.name for at in fit.shared.values() if not at.fixed]
    return [
        _by_flight(
            f"{name}, less that of the others",
            "difference",
            fit.shared[name].unit,
            {
                at.name: (at.departure.difference[name], at.departure.standard_error[name])
                for at in flights
                if name in at.departure.difference
            },
        )
        for name in names
        if any(name in at.departure.difference for at in flights)
    ]


def _by_flight(title: str, what: str, unit: str, found: dict[str, tuple[float, float]]) -> Figure:
    spans = [Span(value - 2 * error, value + 2 * error) for value, error in found.values()]
    x_title = words.titled(f"{what} with 2 standard errors", unit)
    middle = [value for value, _ in found.values()]
    return draw_spans(title, x_title, list(found), middle, {"2 standard errors": spans})
