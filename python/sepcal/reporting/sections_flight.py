# SPDX-License-Identifier: BSD-3-Clause
"""Two sections about the flight itself: what its noise is like, and what it covered."""

from __future__ import annotations

import numpy as np

from sepcal._core import FlightFigures
from sepcal.calibration import Calibration
from sepcal.columns import Array
from sepcal.flight import Flight
from sepcal.markup import Html, html
from sepcal.models import Model
from sepcal.reporting import tables, words
from sepcal.reporting.figures_flight import (
    covered_cells,
    draw_histogram,
    draw_map,
    draw_rose,
    draw_sphere,
)
from sepcal.reporting.figures_noise import draw_noise
from sepcal.reporting.gather import Material
from sepcal.reporting.page import Figure, Grid, Section

FIELD = "uT"  # the unit of what a magnetometer reads
UNEVEN = 0.1  # share of the median interval: sampling that varies by more is uneven


def show_noise(material: Material) -> Section:
    """Autocorrelation, spectrum, Q-Q, and how often the 95 % band holds."""
    residuals, outputs, runs = (
        material.comparison.residuals, material.outputs, material.figures.runs,
    )  # fmt: skip
    shortest, interval, longest = material.figures.interval
    figures = draw_noise(
        outputs, material.units, residuals, runs, interval, material.floors, material.noise
    )
    lead = (
        "Noise alone keeps its autocorrelation inside the grey band, its spectrum flat on the "
        "dotted line and its quantiles on the dashed one."
    )
    key = html(
        '<p class="note">Ljung-Box: the probability of such correlations in white noise. d and AR '
        "order: the noise model, a fractional difference (0 white, 0.5 pink, 1 a random walk) and "
        "an autoregression; its innovations are the noise floor.</p>"
    )
    blocks: list[str | Figure | Grid] = [Grid(figures, 320), _coverage_table(material), key]
    if longest - shortest > UNEVEN * interval:
        blocks.append(
            html(
                '<p class="note">The sampling is uneven ({} to {} s between most rows): lags and '
                "frequencies are counted in rows of {} s.</p>",
                words.number(shortest),
                words.number(longest),
                words.number(interval),
            )
        )
    return Section("Is the rest noise?", lead, blocks)


def _coverage_table(material: Material) -> Html:
    """By output: the share of rows inside the 95 % band, and the whiteness of the rest."""
    rows = []
    for i, misfit in enumerate(material.comparison.overall):
        told = material.diagnosis.residual[misfit.output]
        rows.append([
            html("<b>{}</b>", misfit.output),
            words.percent(material.figures.within_95[i]),
            words.with_unit(misfit.rmse, misfit.unit),
            words.with_unit(told.floor, misfit.unit),
            words.number(misfit.lag_one, 2),
            words.probability(told.ljung_box_p),
            words.number(told.noise.d, 2),
            f"{len(told.noise.phi)}",
        ])  # fmt: skip
    head = [("output", False), ("rows in the 95 % band", True), ("RMSE", True),
            ("noise floor", True), ("lag-one correlation", True), ("p, Ljung-Box", True),
            ("d", True), ("AR order", True)]  # fmt: skip
    return tables.table(head, rows)


def show_coverage(material: Material) -> Section:
    """Directions or flow angles, heading, speed."""
    own = material.last.own_model
    figures, told = draw_coverage(material.last, material.flight, material.figures)
    if own is not None:
        lead = "Beyond the inputs that the flight covered, the model is extrapolated."
    elif material.last.core.unit == FIELD:
        lead = (
            "The flight must cover what is calibrated: directions all over the sphere separate the "
            "errors of a magnetometer's axes from its hard iron."
        )
    else:
        lead = (
            "The flight must cover what is calibrated: a full turn separates the wind from "
            "airspeed errors, a range of airspeeds a scale from a bias."
        )
    blocks: list[str | Figure | Grid] = [Grid(figures, 320)]
    if told:
        blocks.insert(0, told)
    return Section("What the flight covered", lead, blocks)


def draw_coverage(
    calibration: Calibration, flight: Flight, figures: FlightFigures
) -> tuple[list[Figure], Html]:
    """Figures of what a flight covered, and a sentence, which only a magnetometer has."""
    if calibration.own_model is not None:
        return _cover_inputs(figures, calibration.own_model), html("")
    if calibration.core.unit == FIELD:
        return _cover_field(calibration, flight, figures)
    return _cover_air(figures), html("")


def _find_heading(figures: FlightFigures) -> tuple[Array, str] | None:
    """In degrees, and what it is."""
    if figures.heading is None:
        return None
    name = "track over ground" if figures.heading_is_track else "heading"
    return np.degrees(figures.heading), name


def _heading_figures(figures: FlightFigures) -> list[Figure]:
    found = _find_heading(figures)
    return [draw_rose(f"{found[1].capitalize()} [deg]", found[0])] if found else []


def _cover_field(
    calibration: Calibration, flight: Flight, figures: FlightFigures
) -> tuple[list[Figure], Html]:
    applied = list(calibration.apply(flight).values())
    vectors = np.stack(applied, axis=-1)[figures.rows]
    vectors = vectors[np.isfinite(vectors).all(axis=1)]
    visited, cells = covered_cells(vectors)
    drawn = [draw_sphere("Direction of the calibrated field in body axes", vectors)]
    drawn += _heading_figures(figures)
    strength = np.linalg.norm(vectors, axis=1)
    drawn.append(draw_histogram("Strength of the calibrated field", strength, "|h| [uT]"))
    told = "<p>The field came from {} of {} equal parts of the sphere.</p>"
    return drawn, html(told, visited, cells)


def _cover_inputs(figures: FlightFigures, own: Model) -> list[Figure]:
    drawn = []
    for name in own.inputs:
        values = figures.channel(name)
        if values is not None:
            short = words.abbreviate(name, 24)
            axis = words.titled(short, own.units[name])
            drawn.append(draw_histogram(f"Input {short}", values, axis))
    return drawn


def _cover_air(figures: FlightFigures) -> list[Figure]:
    drawn: list[Figure] = []
    speed, found = figures.airspeed, _find_heading(figures)
    alpha, beta = (figures.channel(name) for name in ("alpha", "beta"))
    if alpha is not None and beta is not None:
        a, b = np.degrees(alpha), np.degrees(beta)
        drawn.append(draw_map("Flow angles as read", b, a, "beta [deg]", "alpha [deg]"))
    elif speed is not None and found is not None:
        degrees, name = found
        title, x_title = f"Airspeed by {name}", f"{name} [deg]"
        drawn.append(draw_map(title, degrees, speed, x_title, "airspeed [m/s]", compass=True))
    drawn += _heading_figures(figures)
    if speed is not None:
        drawn.append(draw_histogram("Airspeed as read", speed, "airspeed [m/s]"))
    return drawn
