# SPDX-License-Identifier: BSD-3-Clause
"""Two sections about the flight itself: what its noise is like, and what it covered."""

from __future__ import annotations

from html import escape

import numpy as np

from sepcal.columns import Array
from sepcal.reporting import tables, words
from sepcal.reporting.channels import airspeed, density, flow_angle, heading, impact_pressure
from sepcal.reporting.figures_flight import (
    covered_cells,
    draw_histogram,
    draw_map,
    draw_rose,
    draw_sphere,
)
from sepcal.reporting.figures_noise import draw_autocorrelation, draw_quantiles, draw_spectrum
from sepcal.reporting.gather import Material
from sepcal.reporting.page import Figure, Grid, Section

INSIDE = 1.959964  # standard deviations: 95 % of a normal distribution
UNEVEN = 0.1  # share of the median interval: sampling that varies by more is uneven


def show_noise(material: Material) -> Section:
    """Autocorrelation, spectrum, Q-Q, and how often the 95 % band holds."""
    residuals, time = material.comparison.residuals, material.comparison.time
    outputs, segments = material.outputs, _stretches(material)
    steps = np.diff(time)
    interval = float(np.median(steps)) if steps.size else 1.0
    figures = [
        draw_autocorrelation(outputs, residuals, segments, interval),
        draw_spectrum(outputs, material.units[0], residuals, segments, interval, material.floors),
        draw_quantiles(outputs, residuals, material.noise),
    ]
    spread = np.quantile(steps, [0.1, 0.9]) if steps.size else np.zeros(2)
    lead = (
        "Noise alone keeps its autocorrelation inside the grey band, its spectrum flat on the "
        "dotted line and its quantiles on the dashed one."
    )
    key = (
        '<p class="note">Ljung-Box: the probability of such correlations in white noise. d and AR '
        "order: the noise model, a fractional difference (0 white, 0.5 pink, 1 a random walk) and "
        "an autoregression; its innovations are the noise floor.</p>"
    )
    blocks: list[str | Figure | Grid] = [Grid(figures, 320), _coverage_table(material), key]
    if spread[1] - spread[0] > UNEVEN * interval:
        blocks.append(
            f'<p class="note">The sampling is uneven ({words.number(spread[0])} to '
            f"{words.number(spread[1])} s between most rows): lags and frequencies are counted in "
            f"rows of {words.number(interval)} s.</p>"
        )
    return Section("Is the rest noise?", lead, blocks)


def _stretches(material: Material) -> list[slice]:
    """Gap-free stretches whatever their label: noise does not end with a maneuver."""
    joined: list[slice] = []
    time = material.comparison.time
    steps = np.diff(time)
    limit = 5 * float(np.median(steps)) if steps.size else np.inf
    for at in material.segments:
        if joined and time[at.start] - time[joined[-1].stop - 1] <= limit:
            joined[-1] = slice(joined[-1].start, at.stop)
        else:
            joined.append(at)
    return joined


def _coverage_table(material: Material) -> str:
    """By output: the share of rows inside the 95 % band, and the whiteness of the rest."""
    rows = []
    for i, misfit in enumerate(material.comparison.overall):
        inside = np.abs(material.comparison.residuals[:, i]) <= INSIDE * material.noise[i]
        told = material.diagnosis.residual.get(misfit.output, {})
        model = told.get("noise") or {}
        rows.append([
            f"<b>{escape(misfit.output)}</b>",
            words.percent(float(np.mean(inside))),
            words.with_unit(misfit.rmse, misfit.unit),
            words.with_unit(told.get("floor"), misfit.unit),
            words.number(misfit.lag_one, 2),
            words.probability(told.get("ljung_box_p")),
            words.number(model.get("d"), 2),
            f"{len(model.get('phi', []))}",
        ])  # fmt: skip
    head = [("output", False), ("rows in the 95 % band", True), ("RMSE", True),
            ("noise floor", True), ("lag-one correlation", True), ("p, Ljung-Box", True),
            ("d", True), ("AR order", True)]  # fmt: skip
    return tables.table(head, rows)


def show_coverage(material: Material) -> Section:
    """Directions or flow angles, heading, speed."""
    if material.model.startswith("magnetometer"):
        figures, told = _cover_field(material)
    else:
        figures, told = _cover_air(material), ""
    lead = (
        "What was never flown can't be calibrated: directions all over the sphere separate the "
        "errors of a magnetometer's axes from its hard iron."
        if material.model.startswith("magnetometer")
        else "What was never flown can't be calibrated: a full turn separates the wind from "
        "airspeed errors, a range of airspeeds a scale from a bias."
    )
    blocks: list[str | Figure | Grid] = [Grid(figures, 320)]
    if told:
        blocks.insert(0, told)
    return Section("What the flight covered", lead, blocks)


def _heading_figures(material: Material) -> list[Figure]:
    found = heading(material.flight)
    if found is None:
        return []
    degrees, name = found
    return [draw_rose(f"{name.capitalize()} [deg]", degrees[material.rows])]


def _cover_field(material: Material) -> tuple[list[Figure], str]:
    applied = list(material.last.apply(material.flight).values())
    vectors = np.stack(applied, axis=-1)[material.rows]
    vectors = vectors[np.isfinite(vectors).all(axis=1)]
    visited, cells = covered_cells(vectors)
    figures = [draw_sphere("Direction of the calibrated field in body axes", vectors)]
    figures += _heading_figures(material)
    strength = np.linalg.norm(vectors, axis=1)
    figures.append(draw_histogram("Strength of the calibrated field", strength, "|h| [uT]"))
    told = f"<p>The field came from {visited} of {cells} equal parts of the sphere.</p>"
    return figures, told


def _cover_air(material: Material) -> list[Figure]:
    flight, figures = material.flight, []
    speed = airspeed(flight) if airspeed(flight) is not None else _five_hole_speed(material)
    alpha, beta = (flow_angle(flight, name, material.options) for name in ("alpha", "beta"))
    rows = material.rows
    if alpha is not None and beta is not None:
        a, b = np.degrees(alpha[rows]), np.degrees(beta[rows])
        figures.append(draw_map("Flow angles as read", b, a, "beta [deg]", "alpha [deg]"))
    elif speed is not None and (found := heading(flight)) is not None:
        x, name = found[0][rows], found[1]
        title = f"Airspeed over {name}"
        figures.append(draw_map(title, x, speed[rows], f"{name} [deg]", "airspeed [m/s]"))
    figures += _heading_figures(material)
    if speed is not None:
        figures.append(draw_histogram("Airspeed as read", speed[rows], "airspeed [m/s]"))
    return figures


def _five_hole_speed(material: Material) -> Array | None:
    pressure, rho = impact_pressure(material.flight), density(material.flight)
    if pressure is None or rho is None:
        return None
    return np.sqrt(2 * np.where(pressure > 0, pressure, np.nan) / rho)
