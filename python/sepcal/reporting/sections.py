# SPDX-License-Identifier: BSD-3-Clause
"""The report's sections, in the order in which a flight-test engineer asks."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sepcal import _core
from sepcal._core import HistoryEntry
from sepcal.markup import Html, html
from sepcal.reporting import advice, tables, words
from sepcal.reporting.figures_cause import (
    CHANNELS,
    best_channels,
    draw_added_variable,
    draw_channels,
)
from sepcal.reporting.figures_cost import draw_ellipses, draw_landscape
from sepcal.reporting.figures_error import Step, draw_heat_strip, draw_waterfall, steps_of
from sepcal.reporting.figures_fit import draw_fit
from sepcal.reporting.gather import Material
from sepcal.reporting.page import Figure, Grid, Page, Section
from sepcal.reporting.sections_flight import show_coverage, show_noise
from sepcal.reporting.thin import say_thinned
from sepcal.results import Fit

PARAMETERS = 8  # the section's number


def compose(material: Material, file: str) -> Page:
    """The whole page but for Plotly; `file` is where it will stand."""
    sections = [
        show_waterfall(material),
        show_overlay(material),
        show_where(material),
        show_candidates(material),
        show_channels(material),
        show_trials(material),
        show_noise(material),
        show_parameters(material),
        *show_landscape(material),
        show_coverage(material),
        Section(
            "What to fly or log next",
            blocks=[advice.advise(material), advice.list_limits(material)],
        ),
        Section("Where this comes from", blocks=[advice.list_provenance(material, file)]),
    ]
    return Page(f"{material.title}: sepcal report", show_verdict(material), sections)


def pooled_unit(material: Material) -> str:
    """The unit of the RMSE over all outputs; empty if they have several."""
    return material.units[0] if len(set(material.units)) == 1 else ""


def show_verdict(material: Material) -> Html:
    """The sentence on top, the numbers behind it, and what to type next."""
    found, last = material.diagnosis, material.last
    unit = pooled_unit(material)
    facts: list[tuple[str, str]] = [
        (words.with_unit(found.rmse, unit), "RMSE left, all outputs"),
        (words.with_unit(found.noise_floor, unit), "noise floor"),
    ]
    if not unit:
        share = found.noise_floor / found.rmse
        facts = [(words.percent(share), "of the error is what noise alone would leave")]
    if best := advice.advised(material):
        facts += [
            (words.percent(best.predicted_drop), f"less with {best.name}"),
            (words.percent(best.held_out_gain), "less on rows held out"),
        ]
    facts.append((tables.flag_status(last.status), "status of the fit"))
    effects = ", ".join(at.name for at in last.effects)
    kind = words.MODELS.get(material.model, material.model)
    with_effects = f" with {effects}" if effects else ""
    warnings = advice.warn(last, PARAMETERS)
    if not material.is_fitted_flight:
        fitted = material.description["inputs"]["file"]
        warnings.append(f"The calibration was fitted on another flight, {fitted}.")
    file = material.files[-1] if material.files else ""
    command = advice.next_command(material, file)
    tag = words.VERDICTS.get(found.verdict, found.verdict)
    if found.verdict == "adequate" and last.history:
        tag = words.NOTHING_ELSE
    return html(
        '<h1><b>{}</b> · {}{}</h1><div class="verdict {}"><span class="tag">{}</span><p>{}</p>'
        "</div>{}{}{}",
        material.title,
        kind,
        with_effects,
        found.verdict,
        tag,
        html(
            "{}{}",
            tell_added(last.history if material.is_fitted_flight else (), unit),
            found.sentence,
        ),
        tables.list_facts(facts),
        html("<p>To add it:</p><pre>{}</pre>", command) if command else "",
        tables.list_warnings(warnings, material.notes),
    )


def tell_added(history: Sequence[HistoryEntry], unit: str) -> Html:
    """What the added effects did to the error over all outputs; nothing where none was added."""
    if not history:
        return html("")
    names = " and ".join(entry.effect for entry in history)
    before, after = history[0].rmse_before, history[-1].rmse_after
    verb = "rose" if after > before else "fell"
    if unit:
        change = html("from {} to {}", words.number(before), words.with_unit(after, unit))
    else:
        change = html("by {}", words.percent(abs(tables.drop(before, after))))
    return html("With {} the error {} {}. ", names, verb, change)


def show_waterfall(material: Material) -> Section:
    """Fitted and held out after every step, and what was promised before it."""
    unit, history = pooled_unit(material), material.last.history
    found = material.diagnosis.found
    scale = history[-1].rmse_after if history and not unit else 1.0
    left, floor = scale * material.diagnosis.rmse, scale * material.diagnosis.noise_floor
    steps = steps_of(history)
    if not steps:
        held = found[0].held_out_before if found else math.nan
        steps.append(Step("this model", left, held, math.nan))
    best = advice.advised(material)
    promised = left * (1 - best.predicted_drop) if best else math.nan
    if best and not math.isnan(promised):
        label = f"next: + {best.name}"
        steps.append(Step(label, promised, scale * best.held_out_after, math.nan, is_next=True))
    blocks: list[str | Figure | Grid] = [draw_waterfall(steps, floor, unit)]
    if history:
        blocks.append(tables.list_history(history, unit))
    blocks.append(tables.list_calibrations(material.chain, material.files, material.comparisons))
    lead = (
        "One step an added effect. A step is worth keeping when the error falls on rows held out "
        "of the fit too; a short line is what was promised before, a pale bar what is promised "
        "next. The noise floor is estimated from what is left: while an effect is missing, it may "
        "be too high."
    )
    return Section("The error, step by step", lead, blocks)


def show_overlay(material: Material) -> Section:
    """Every output over time."""
    comparison, maneuvers = material.comparison, material.maneuvers
    overlay = draw_fit(comparison, material.figures, material.last.noise)
    blocks: list[str | Figure | Grid] = [overlay]
    lead = (
        "Grey is what was measured, blue what the calibrated model says, the blue band its 2-sigma "
        "band. Below each, the residual, measured minus modelled, between its 2-sigma lines: "
        "what leaves them for long is not noise."
    )
    if "field" in material.outputs:
        lead += (
            " The attitude is unknown here, so the strength of the calibrated field stands beside "
            "the given one; the residual is the given minus the calibrated."
        )
    if maneuvers:
        lead += " Maneuvers are shaded."
    if note := say_thinned(comparison.time.size):
        blocks.append(html('<p class="note">{}</p>', note))
    return Section("Measured and modelled", lead, blocks)


def show_where(material: Material) -> Section:
    """The heat strip and the worst windows."""
    comparison = material.comparison
    strip = draw_heat_strip(comparison.where, material.outputs, material.floors)
    lead = (
        f"RMSE by {'maneuver' if material.maneuvers else 'stretch of time [s]'} and output, in the "
        "output's unit; the colour is how many times the noise floor it is."
    )
    return Section("Where it fails", lead, [strip, tables.list_windows(comparison)])


def show_candidates(material: Material) -> Section:
    """The ranking of physical effects."""
    lead = html(
        "Physical effects that the model may lack, best first. <b>p</b> is corrected for their "
        "number; an effect is <b>found</b> when p is below {} and rows held out of the fit gain "
        "too. <b>Visibility</b> near 0: other parameters absorb the effect on this flight, which "
        "then can't show it.",
        f"{_core.SIGNIFICANT_BELOW:g}",
    )
    extra: list[str | Figure | Grid] = [tables.list_candidates(material.diagnosis.effects)]
    for effect in material.diagnosis.found[:1]:
        extra.append(tables.list_absorbed(effect, material.last))
    unexplained = material.diagnosis.unexplained
    for cause in material.diagnosis.unmeasured:
        extra.append(html("<p>In this flight, {}.</p>", cause.sentence))
    if unexplained.significant:
        extra.append(
            html(
                "<p>Structure that no candidate explains, p = {}: {}.</p>",
                words.probability(unexplained.p_adjusted),
                unexplained.where,
            )
        )
    return Section("Ranked candidates", lead, extra)


def show_channels(material: Material) -> Section:
    """The channels that the residual follows most, each with the output it shows in."""
    figures = draw_channels(material.comparison, material.figures.channel)
    others = best_channels(material.comparison)[CHANNELS:]
    blocks: list[str | Figure | Grid] = [Grid(figures, 320)]
    if others:
        most = max(channel.share_smooth for channel in others)
        blocks.append(
            html(
                '<p class="note">Not drawn, {} at most: {}.</p>',
                words.percent(most),
                ", ".join(channel.driver for channel in others),
            )
        )
    lead = (
        "Residual against each logged channel, in the output where a smooth curve explains the "
        "most of it. The curve means something where its band, 2 standard errors that allow for "
        "neighbouring residuals being correlated, leaves zero out. A few hundred of the rows are "
        "drawn as points; the curve is of all."
    )
    return Section("Residual against the channels", lead, blocks)


def show_trials(material: Material) -> Section:
    """The section on what the first candidates explain."""
    comparison = material.comparison
    figures = [
        draw_added_variable(
            trial.finding.name, trial.explained, comparison.residuals, material.noise,
            material.outputs,
        )
        for trial in material.trials
        if np.isfinite(trial.explained).any() and np.nanmax(np.abs(trial.explained)) > 0
    ]  # fmt: skip
    lead = (
        "Each of the first candidates was added and all parameters fitted again. Across: by how "
        "much that changes the modelled value, which is the effect without what the other "
        "parameters can do in its place. Up: the residual before. Both in standard deviations. "
        "Circles, the mean residual, on the dashed line of slope 1 show that the effect is at work "
        "at every size; where only the farthest points follow the line, look at those rows first."
    )
    if not material.diagnosis.found:
        lead += " None was found: this is what nothing looks like."
    blocks: list[str | Figure | Grid] = [Grid(figures, 320)] if figures else [html("<p>None.</p>")]
    return Section("What the first candidates explain", lead, blocks)


def shared_of_own(material: Material) -> list[str]:
    """Parameters in whose place each flight of a joint fit has its own."""
    return list(material.description.get("joint", {}).get("own", []))


def show_parameters(material: Material) -> Section:
    """Estimates, errors, what can't be told apart."""
    lead = (
        "The standard error allows for residuals whose neighbours correlate; beside it, what it "
        "would be if they were white. Neither covers a cause that the model lacks."
    )
    blocks: list[str | Figure | Grid] = [
        tables.list_parameters(material.last, material.last.derived, shared_of_own(material)),
        tables.list_restated(material.last.restated),
        advice.list_flights(material),
        tables.list_directions(material.last.unobservable, material.last.weak),
        *show_collinearity(material.last, shared_of_own(material)),
    ]
    return Section("Parameters", lead, blocks)


def show_collinearity(fit: Fit, leave_out: Sequence[str] = ()) -> list[str | Figure | Grid]:
    """Estimates that go together, and the ellipses of those that do so most."""
    told = tables.list_collinear(fit, leave_out)
    if not told:
        return []
    figures = draw_ellipses(fit, leave_out)
    lead = html("<p>Each ellipse holds both true values in 95 % of records.</p>")
    return [told, lead, Grid(figures, 320)] if figures else [told]


def show_landscape(material: Material) -> list[Section]:
    """Stage one's cost; nothing where it had nothing to look for."""
    last, seen = material.last, material.landscape
    minima = [minimum.xi2 for minimum in last.stage_one.minima]
    estimate = {name: parameter.value for name, parameter in last.parameters.items()}
    figures = draw_landscape(
        seen.names, seen.units, seen.points, seen.trace_r, minima, estimate
    ) if seen.names else []  # fmt: skip
    if not figures:
        return []
    several = len(seen.names) > 2
    lead = (
        "Tr[R], the sum over outputs of the mean square of what is left, over the nonlinear "
        "parameters within their bounds; the linear ones are solved at each point"
        + (", and of each pair the least over all others is shown." if several else ".")
        + " A second minimum, or a valley in place of a point, means that the flight leaves "
        "something open."
    )
    return [Section("What stage one saw", lead, [Grid(figures, 320)])]
