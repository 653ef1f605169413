# SPDX-License-Identifier: BSD-3-Clause
"""The report of flight paths and aircraft: measured and modelled, states, innovations, noise."""

from __future__ import annotations

import hashlib
import os
import platform
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sepcal import _core
from sepcal.aircraft_fits import AircraftFit
from sepcal.columns import Array
from sepcal.comparison import Comparison
from sepcal.flight import Flight
from sepcal.markup import Html, html
from sepcal.printing import in_shell
from sepcal.reporting import advice, tables, words
from sepcal.reporting.figures_cause import draw_channels
from sepcal.reporting.figures_error import draw_heat_strip
from sepcal.reporting.figures_fit import Channel, Run, draw_overlay
from sepcal.reporting.figures_states import draw_beside_zero, draw_with_band
from sepcal.reporting.page import Figure, Grid, Page, Section
from sepcal.reporting.sections import show_collinearity
from sepcal.reporting.thin import Rows, say_thinned
from sepcal.smoothing import Smoothed

WIDTH = 420  # [px] of a small picture, at least


@dataclass(frozen=True)
class Flown:
    """The last fit of a chain on a flight; arrays of the N rows compared."""

    chain: list[AircraftFit]
    comparisons: list[Comparison]  # one a fit
    files: list[str]
    flight: Flight
    rows: Rows  # (N,) of the flight
    modelled: dict[str, Array]  # by output
    smoothed: Smoothed | None  # with process noise
    units: dict[str, str]  # of states, noises and outputs that are smoothed
    process_noise: dict[str, float]

    @property
    def last(self) -> AircraftFit:
        """The fit that the report is about."""
        return self.chain[-1]

    @property
    def comparison(self) -> Comparison:
        """The comparison of the last fit."""
        return self.comparisons[-1]

    @property
    def runs(self) -> list[Run]:
        """Label, first and last time [s] of each maneuver."""
        labels = self.flight.maneuvers
        if not labels:
            return []
        found: list[Run] = []
        for row, t in zip(self.rows.tolist(), self.comparison.time.tolist(), strict=True):
            if found and found[-1][0] == labels[row]:
                found[-1] = (labels[row], found[-1][1], t)
            else:
                found.append((labels[row], t, t))
        return found

    def read(self, name: str) -> Array | None:
        """A channel's values, (N,): "time", a header, or one without its unit."""
        if name == "time":
            return self.comparison.time
        for header in self.flight:
            if name in (header, header.rpartition("_")[0]):
                return np.asarray(self.flight[header][self.rows])
        return None


def gather_flown(
    chain: Sequence[AircraftFit],
    flight: Flight | None,
    files: list[str],
    process_noise: Mapping[str, float],
    report_progress: Callable[[str], None],
) -> Flown:
    """Compares, applies and smooths. Raises Error as those do."""
    last = chain[-1]
    models = sorted({fit.model for fit in chain})
    if len(models) > 1:
        raise _core.Error(f"the fits are of several models: {', '.join(models)}; give one")
    flight = last._or_fitted(flight, "report(..., flight=")
    process_noise = process_noise or _found_noise(last)
    report_progress("comparing")
    comparisons = [fit.compare(flight) for fit in chain]
    if process_noise:
        report_progress("smoothing")
    columns = last.apply(flight, process_noise=process_noise)
    outputs = [misfit.output for misfit in comparisons[-1].overall]
    rows = np.flatnonzero(np.isfinite(_column(columns, f"{outputs[0]}_model")))
    smoothed = last.smooth(process_noise, flight) if process_noise else None
    return Flown(
        chain=list(chain),
        comparisons=comparisons,
        files=files,
        flight=flight,
        rows=rows,
        modelled=dict(zip(outputs, comparisons[-1].modelled.T, strict=True)),
        smoothed=smoothed,
        units=_units(columns, smoothed, process_noise),
        process_noise=dict(process_noise),
    )


def _found_noise(fit: AircraftFit) -> dict[str, float]:
    """The process noises that filter error found, by the names of the model's table."""
    return {
        name.removeprefix("q_"): size.value
        for name, size in fit.noise_sizes.items()
        if name.startswith("q_") and size.value > 0
    }


def _column(columns: Mapping[str, Array], start: str) -> Array:
    """The column whose header is this, or this with a unit."""
    return columns[_header(columns, start)]


def _header(columns: Mapping[str, Array], start: str) -> str:
    return next(name for name in columns if name == start or name.startswith(f"{start}_"))


def _units(
    columns: Mapping[str, Array], smoothed: Smoothed | None, process_noise: Mapping[str, float]
) -> dict[str, str]:
    """Units from the headers, "m/s^2" from "mps2"; "1" without one."""
    if smoothed is None:
        return {}

    def unit(start: str) -> str:
        spelled = _header(columns, start)[len(start) + 1 :] or "1"
        return re.sub(r"ps(\d?)$", lambda at: "/s^" + at[1] if at[1] else "/s", spelled)

    return (
        {f"state {name}": unit(f"{name}_smooth") for name in smoothed.states}
        | {f"noise {name}": unit(f"w_{name}_sd") for name in process_noise}
        | {f"output {name}": unit(f"{name}_innovation") for name in smoothed.outputs}
    )


def compose_flown(flown: Flown, file: str) -> Page:
    """The whole page but for Plotly; `file` is where it will stand."""
    before = [
        show_steps(flown),
        show_overlay(flown),
        show_where(flown),
        show_channels(flown),
        *show_states(flown),
    ]
    sections = [*before, show_parameters(flown), show_provenance(flown, file)]
    title = os.path.basename(flown.flight.name) or flown.flight.name
    verdict = show_verdict(flown, title, len(before) + 1)
    return Page(f"{title}: sepcal report", verdict, sections)


def show_verdict(flown: Flown, title: str, parameters: int) -> Html:
    """Says what was fitted and how, the errors left, and what the intervals lack.

    `parameters` is the number of their section.
    """
    last = flown.last
    facts: list[tuple[str, str]] = [
        (words.with_unit(misfit.rmse, misfit.unit), f"RMSE left, {misfit.output}")
        for misfit in flown.comparison.overall[:5]
    ]
    facts.append((tables.flag_status(last.status), "status of the fit"))
    lagging = [m.output for m in flown.comparison.overall if not m.is_white]
    what = "innovations" if flown.comparison.method == "filter-error" else "residuals"
    verdict = (
        f"{what.capitalize()} of {', '.join(lagging)} follow one another: something is missing "
        "from the model, or from the noise. Look where, and what they go with, below."
        if lagging
        else f"The {what} are noise as far as their neighbours tell."
    )
    kind = "unexplained" if lagging else "adequate"
    tag = "Not all is noise" if lagging else "Noise is left"
    warnings = [*advice.warn(last, parameters), *([last.warning] if last.warning else [])]
    notes = list(dict.fromkeys([*last.notes, *flown.comparison.notes]))
    effects = ", ".join(at.name for at in last.effects)
    return html(
        '<h1><b>{}</b> · {} by {}{}</h1><div class="verdict {}"><span class="tag">{}</span>'
        "<p>{}</p></div>{}{}",
        title,
        last.model,
        last.method,
        f" with {effects}" if effects else "",
        kind,
        tag,
        verdict,
        tables.list_facts(facts),
        tables.list_warnings(warnings, notes),
    )


def show_steps(flown: Flown) -> Section:
    """The error of each output after every regressor that was added."""
    rows = [
        [
            html("<code>{}</code>", entry.effect),
            output,
            html("{} → {}", words.number(before), words.number(entry.rmse_after[output])),
            words.percent(tables.drop(before, entry.rmse_after[output])),
        ]
        for entry in flown.last.history
        for output, before in entry.rmse_before.items()
    ]
    head = [("added", False), ("output", False), ("RMSE", True), ("drop", True)]
    blocks: list[str | Figure | Grid] = [tables.table(head, rows)] if rows else []
    blocks.append(tables.list_calibrations(flown.chain, flown.files, flown.comparisons))
    lead = "The error of every output, and what each regressor that was added took off it."
    return Section("The error, step by step", lead, blocks)


def show_overlay(flown: Flown) -> Section:
    """Every output over time."""
    comparison = flown.comparison
    blocks: list[str | Figure | Grid] = [draw_flown(flown)]
    if note := say_thinned(comparison.time.size):
        blocks.append(html('<p class="note">{}</p>', note))
    by_filter = comparison.method == "filter-error"
    says = "the filter foretold from the rows before" if by_filter else "the integrated model says"
    lead = (
        f"Grey is what was measured, blue what {says}, the blue band its 2-sigma "
        f"band. Below each, the {'innovation' if by_filter else 'residual'} between its 2-sigma "
        "lines: what leaves them for long is not noise."
    )
    return Section("Measured and modelled", lead, blocks)


def draw_flown(flown: Flown) -> Figure:
    """Every output over time, measured over modelled."""
    comparison = flown.comparison
    channels = [
        Channel(
            misfit.output,
            misfit.unit,
            flown.modelled[misfit.output] + comparison.residuals[:, i],
            flown.modelled[misfit.output],
            comparison.residuals[:, i],
            flown.last.noise.get(misfit.output, misfit.rmse),
        )
        for i, misfit in enumerate(comparison.overall)
    ]
    gaps = (np.flatnonzero(np.diff(flown.rows) > 1) + 1).tolist()
    return draw_overlay(comparison.time, channels, flown.runs, gaps)


def show_where(flown: Flown) -> Section:
    """The heat strip and the worst windows."""
    comparison, noise = flown.comparison, flown.last.noise
    outputs = [misfit.output for misfit in comparison.overall]
    floors = [noise.get(misfit.output, misfit.rmse) for misfit in comparison.overall]
    lead = (
        "RMSE by maneuver or stretch of time [s] and output, in the output's unit; the colour is "
        "how many times the fit's noise it is."
    )
    strip = draw_heat_strip(comparison.where, outputs, floors, "noise of the fit")
    return Section("Where it fails", lead, [strip, tables.list_windows(comparison)])


def show_channels(flown: Flown) -> Section:
    """The channels that the residual follows most."""
    figures = draw_channels(flown.comparison, flown.read)
    lead = html(
        "Residual against each logged channel, in the output where a smooth curve explains the "
        "most of it. A curve that leaves its band about zero names a regressor to try: "
        "<code>add FLIGHT.csv FIT.json 'Cm[alpha^2]'</code>."
    )
    blocks: list[str | Figure | Grid] = [Grid(figures, 320)] if figures else [html("<p>None.</p>")]
    return Section("Residual against the channels", lead, blocks)


def show_states(flown: Flown) -> list[Section]:
    """Shows the smoother's states with bands, innovations and process noise."""
    smoothed = flown.smoothed
    if smoothed is None:
        said = (
            html(
                "<p>Give process noise to have the states with their bands, the innovations of the "
                "filter and the noise that drives the states, given all of the flight: "
                "<code>--process-noise NAME=SD</code>.</p>"
            )
            if flown.last.method == "output-error"
            else html("<p>Equation error has no states.</p>")
        )
        return [Section("States", blocks=[said])]
    given = ", ".join(f"{name} {sd:g}" for name, sd in flown.process_noise.items())
    states = Section(
        "States",
        "Given all of the flight, with 2 standard deviations to either side, the errors of the "
        "parameters among them; process noise: "
        f"{given}.",
        [Grid(draw_smoothed(flown, "states"), WIDTH)],
    )
    scaled = smoothed.innovations[flown.rows] / smoothed.innovation_sd[flown.rows]
    table = [
        [
            name,
            words.number(float(np.nanstd(scaled[:, j]))),
            words.number(_lag_one(scaled[:, j]), 2),
        ]
        for j, name in enumerate(smoothed.outputs)
    ]
    head = [("output", False), ("standard deviation", True), ("lag-one correlation", True)]
    innovations = Section(
        "Innovations",
        "Each reading less the filter's prediction of it, in a band of 2 of "
        "the filter's own standard deviations. Scaled by them they should have standard deviation "
        "1 and no correlation with their neighbours; else the process noise is too small or too "
        "large, or the model is wrong.",
        [
            tables.table(head, table),
            Grid(draw_smoothed(flown, "innovations"), WIDTH),
        ],
    )  # fmt: skip
    noise = Section(
        "Process noise",
        "The noise that must have driven the states, w(k|N), with 2 standard deviations to either "
        "side. Where its band leaves zero for long, a force or an error is missing from the model: "
        "it says when.",
        [
            *list_disturbances(flown.comparison),
            Grid(draw_smoothed(flown, "process noise"), WIDTH),
        ],
    )
    return [states, innovations, noise]


def draw_smoothed(flown: Flown, what: str) -> list[Figure]:
    """The states, the innovations or the process noise, each with its band; there is a smoother."""
    smoothed = flown.smoothed
    assert smoothed is not None
    return draw_record(smoothed, what, flown.comparison.time, flown.rows, flown.runs, flown.units)


def draw_record(
    smoothed: Smoothed,
    what: str,
    time: Array,
    rows: Rows,
    runs: list[Run],
    units: Mapping[str, str],
    x_title: str = "time [s]",
) -> list[Figure]:
    """The same of any record; `units` by kind and name, "state u": what is not there is not drawn.

    Arrays are of the N rows that are drawn, but for those of the record itself.
    """
    s = smoothed
    kind, names, values, sd = {
        "states": ("state", s.states, s.x, s.standard_error),
        "innovations": ("output", s.outputs, s.innovations, s.innovation_sd),
        "process noise": ("noise", s.noises, s.w, s.w_standard_error),
    }[what]
    draw = draw_beside_zero if kind == "output" else draw_with_band
    return [
        draw(name, units[f"{kind} {name}"], time, values[rows, i], sd[rows, i], runs, x_title)
        for i, name in enumerate(names)
        if f"{kind} {name}" in units
    ]


def list_disturbances(comparison: Comparison) -> list[Html]:
    """Sizes that filter error found, and when each noise was more than noise; or nothing."""
    if not comparison.disturbances:
        return []
    rows = []
    for one in comparison.disturbances:
        when = (
            f"{one.first_s:.2f} to {one.last_s:.2f} s, {one.rows} rows, {one.peak:+.1f}"
            if one.rows
            else "none"
        )
        size = html(
            "{} ± {} {}{}",
            words.number(one.noise.value),
            words.number(one.noise.standard_error, 2),
            one.noise.unit,
            ", at its floor" if one.noise.at_floor else "",
        )
        rows.append(
            [
                one.noise.name,
                size,
                words.percent(one.share_beyond),
                when,
            ]
        )
    head = [
        ("process noise", False), ("size", True), ("beyond 3", True),
        ("longest stretch beyond 3 standard deviations", False),
    ]  # fmt: skip
    said = html(
        "<p>Beyond 3 of its standard deviations, as all of the flight tells it: noise alone is "
        "there in 0.27 % of the rows, a row or a few at a time. A long stretch says when the model "
        "fails.</p>"
    )
    return [tables.table(head, rows), said]


def _lag_one(values: Array) -> float:
    there = values[np.isfinite(values)]
    there = there - there.mean()
    return float(np.dot(there[1:], there[:-1]) / max(np.dot(there, there), 1e-300))


def show_parameters(flown: Flown) -> Section:
    """Estimates and errors; initial states folded away."""
    last, initial = flown.last, set(flown.last.initial_states)
    lead = (
        "The standard error allows for residuals whose neighbours correlate; beside it, what it "
        "would be if they were white. Neither covers a cause that the model lacks."
    )
    blocks: list[str | Figure | Grid] = [tables.list_parameters(last, leave_out=initial)]
    if initial:
        others = set(last.names) - initial
        folded = tables.list_parameters(last, leave_out=others)
        blocks.append(
            html("<details><summary>{} initial states</summary>{}</details>", len(initial), folded)
        )
    blocks.append(tables.list_directions(last.unobservable, last.weak))
    blocks += show_collinearity(last, sorted(initial))
    return Section("Parameters", lead, blocks)


def show_provenance(flown: Flown, file: str) -> Section:
    """Inputs, version, options, and what makes the page again."""
    flight, last = flown.flight, flown.last
    description = last.to_dict()
    rows: list[list[str]] = [
        ["flight", f"{flight.name}, {flight.rows:,} rows, {flown.rows.size:,} used"],
        ["sha256 of the flight", advice.code([flight.sha256 or "none: arrays, not a file"])],
    ]
    for i, fit in enumerate(flown.chain):
        name = flown.files[i] if i < len(flown.files) else f"fit {i + 1}"
        digest = hashlib.sha256(fit.to_json().encode()).hexdigest()
        rows.append([f"sha256 of {name}", advice.code([digest])])
    if flight.sha256 and description["inputs"]["sha256"] != flight.sha256:
        fitted = description["inputs"]
        at = html("{}, {}", fitted["file"], advice.code([fitted["sha256"]]))
        rows.append(["fitted on", at])
    rows += [
        ["model", f"{last.model}, {last.method}"],
        ["sepcal", f"{_core.__version__}, Python {platform.python_version()}"],
    ]
    again = f"sepcal.report(fits, {file!r}, flight)"
    if flown.files and flight.sha256:
        noise = [f"--process-noise={name}={sd:g}" for name, sd in flown.process_noise.items()]
        command = ["python", "-m", "sepcal", "report", flight.name, *flown.files, *noise]
        again = in_shell([*command, "-o", file])
    text = advice.list_origin(rows, again, description["options"])
    return Section("Where this comes from", blocks=[text])
