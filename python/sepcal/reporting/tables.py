# SPDX-License-Identifier: BSD-3-Clause
"""The report's tables as HTML."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from sepcal import _core
from sepcal._core import Combination, EffectFinding, HistoryEntry, Parameter
from sepcal.calibration import Calibration
from sepcal.comparison import Comparison
from sepcal.markup import Html, html, join
from sepcal.reporting.words import (
    MEANINGS,
    estimate,
    number,
    percent,
    probability,
    with_unit,
)
from sepcal.results import Fit

SHOWN = 10  # candidates; the others are folded away
COLLINEAR = 10  # pairs that are told
NEGLIGIBLE = 0.3  # standard errors: a shift that needs no table


def table(head: Sequence[tuple[str, bool]], rows: Sequence[Sequence[str]]) -> Html:
    """Columns (title, whether it holds numbers) and cells, text or Html."""
    kinds = [html(' class="n"') if numeric else "" for _, numeric in head]
    titles = zip(kinds, head, strict=True)
    top = join("", (html("<th{}>{}</th>", kind, title) for kind, (title, _) in titles))
    body = join("", (html("<tr>{}</tr>", _cells(kinds, row)) for row in rows))
    return html('<div class="table"><table><tr>{}</tr>{}</table></div>', top, body)


def _cells(kinds: Sequence[str], row: Sequence[str]) -> Html:
    cells = zip(kinds, row, strict=True)
    return join("", (html("<td{}>{}</td>", kind, cell) for kind, cell in cells))


def flag_status(status: str) -> Html:
    """A fit's status, red where it did not converge."""
    shown = html("{}", status.replace("_", " "))
    return shown if status == "converged" else html('<span class="flag">{}</span>', shown)


def list_facts(facts: Sequence[tuple[str, str]]) -> Html:
    """Values, each over what it is."""
    shown = (html("<div><b>{}</b><span>{}</span></div>", value, name) for value, name in facts)
    return html('<div class="facts">{}</div>', join("", shown))


def list_warnings(warnings: Sequence[str], notes: Sequence[str]) -> Html:
    """The status and notes on the data, folded away."""
    shown = join("", (html('<p class="warning">{}</p>', warning) for warning in warnings))
    if not notes:
        return shown
    folded = "{}<details><summary>notes on the data</summary>{}</details>"
    return html(folded, shown, bullets(notes))


def list_history(history: Sequence[HistoryEntry], unit: str) -> Html:
    """Promised next to achieved, a row an added effect."""
    rows = []
    for entry in history:
        achieved = drop(entry.rmse_before, entry.rmse_after)
        rows.append([
            html('<code class="name">{}</code>', entry.effect),
            html("{} → {}", number(entry.rmse_before), with_unit(entry.rmse_after, unit)),
            percent(entry.predicted_drop),
            percent(achieved),
            html("{} → {}", number(entry.held_out_before), number(entry.held_out_after))
            if not math.isnan(entry.held_out_after)
            else "–",
            percent(drop(entry.held_out_before, entry.held_out_after)),
        ])  # fmt: skip
    head = [("added", False), ("RMSE", True), ("promised drop", True), ("achieved drop", True),
            ("held-out RMSE", True), ("held-out drop", True)]  # fmt: skip
    return table(head, rows)


def drop(before: float, after: float) -> float:
    """1 - after / before."""
    return math.nan if before == 0 else 1 - after / before


def list_calibrations(
    chain: Sequence[Fit], files: Sequence[str], comparisons: Sequence[Comparison]
) -> Html:
    """RMSE of every calibration of the chain on this flight."""
    outputs = [misfit.output for misfit in comparisons[-1].overall]
    rows = []
    for i, calibration in enumerate(chain):
        effects = join(
            ", ", (html('<code class="name">{}</code>', at.name) for at in calibration.effects)
        )
        rows.append([
            files[i] if i < len(files) else f"{i + 1}",
            effects or "none",
            calibration.status.replace("_", " "),
            *(with_unit(misfit.rmse, misfit.unit) for misfit in comparisons[i].overall),
        ])  # fmt: skip
    head = [("calibration", False), ("effects in it", False), ("status", False)]
    return table([*head, *((f"RMSE {name}", True) for name in outputs)], rows)


def list_windows(comparison: Comparison) -> Html:
    """The worst stretches of the flight, worst first."""
    outputs = [misfit.output for misfit in comparison.overall]
    units = {misfit.output: misfit.unit for misfit in comparison.overall}
    rows = [
        [
            f"{window.first_s:.6g} to {window.last_s:.6g} s",
            f"{window.rows}",
            *(
                html(
                    "{} <small>mean {}</small>",
                    with_unit(window.rmse[at], units[at]),
                    number(window.mean[at], 2),
                )
                for at in outputs
            ),
        ]
        for window in comparison.windows
    ]
    head = [("worst windows", False), ("rows", True)]
    return table([*head, *((f"RMSE {name}", True) for name in outputs)], rows)


def list_candidates(effects: Sequence[EffectFinding]) -> Html:
    """The ranking: the first in sight, the others folded away."""
    first = _rank(effects[:SHOWN], 1)
    if len(effects) <= SHOWN:
        return first
    others = _rank(effects[SHOWN:], SHOWN + 1)
    folded = "{}<details><summary>the other {} candidates</summary>{}</details>"
    return html(folded, first, len(effects) - SHOWN, others)


def _rank(effects: Sequence[EffectFinding], first: int) -> Html:
    has_beside = any(effect.beside_in_words for effect in effects)
    rows = []
    for i, effect in enumerate(effects, first):
        name = html('<b class="effect">{}</b><small>{}</small>', effect.name, effect.sentence)
        if not all(at in effect.name or at in effect.sentence for at in effect.drivers):
            name = html("{}<br><small>driven by {}</small>", name, ", ".join(effect.drivers))
        kind = "found" if effect.status == "found" else "pill"
        held = percent(effect.held_out_gain)
        seen = number(effect.visibility, 2)
        if effect.visibility < _core.VISIBLE_FROM:
            seen = html('<span class="flag">{}</span>', seen)
        rows.append([
            f"{i}",
            name,
            html('<span class="{}">{}</span>', kind, effect.in_words),
            _coefficients(effect),
            probability(effect.p_adjusted),
            percent(effect.predicted_drop),
            held,
            seen,
            number(effect.partial_f, 3),
            percent(drop(effect.pse_without, effect.pse)),
            percent(math.nan if effect.sse == 0 else effect.sse_reduction / effect.sse),
            *([effect.beside_in_words] if has_beside else []),
        ])  # fmt: skip
    head: list[tuple[str, bool]] = [
        ("", True), ("candidate", False), ("status", False), ("estimate ± standard error", False),
        (html("p,<br>adjusted"), True), (html("predicted<br>drop"), True),
        (html("held-out<br>gain"), True), (html("visi-<br>bility"), True),
        (html("partial<br>F"), True), (html("PSE<br>falls by"), True),
        (html("SSE<br>falls by"), True),
    ]  # fmt: skip
    if has_beside:
        head.append((html("beside<br>the first"), False))
    return table(head, rows)


def _coefficients(effect: EffectFinding, most: int = 4) -> Html:
    lines = []
    for name, value in list(effect.estimate.items())[:most]:
        short = name.removeprefix(effect.name).lstrip(".") or name
        unit = effect.unit.get(name, "")
        shown = estimate(value, effect.standard_error.get(name), unit)
        lines.append(html('<span class="pill"><small>{}</small> {}</span>', short, shown))
    left = len(effect.estimate) - most
    if left > 0:
        lines.append(html("<small>and {} more coefficients</small>", left))
    lines += [
        html(
            "<small>{} = {}</small>",
            name.removeprefix(effect.name).lstrip("."),
            number(value, 4),
        )
        for name, value in effect.shapes.items()
    ]
    return join("<br>", lines)


def list_absorbed(effect: EffectFinding, calibration: Calibration, most: int = 5) -> Html:
    """How far ignoring an effect shifts the parameters, those that are off most first."""
    shifts = []
    for name, shift in effect.absorbed_by.items():
        if name not in calibration.parameters:
            continue
        parameter = calibration[name]
        ratio = abs(shift) / parameter.standard_error if parameter.standard_error > 0 else 0.0
        shifts.append((ratio, parameter, shift))
    shifts.sort(key=lambda entry: -entry[0])
    rows = [
        [
            html("<b>{}</b>", parameter.name),
            html('<small class="meaning">{}</small>', meaning(parameter, calibration)),
            with_unit(shift, parameter.unit, 2),
            number(ratio, 2),
        ]
        for ratio, parameter, shift in shifts[:most]
    ]
    if not rows:
        return html("")
    if shifts[0][0] < NEGLIGIBLE:
        return html(
            "<p>Ignoring <code>{}</code> shifts no parameter by more than {} of its standard "
            "error.</p>",
            effect.name,
            number(shifts[0][0], 1),
        )
    head = [("parameter", False), ("", False), ("off by", True), ("in standard errors", True)]
    title = "<h3>What ignoring <code>{}</code> does to the parameters</h3>{}"
    return html(title, effect.name, table(head, rows))


def list_parameters(
    calibration: Fit,
    derived: Mapping[str, _core.Derived] | None = None,
    leave_out: Collection[str] = (),
) -> Html:
    """Estimates with both standard errors, flags, and the most correlated partner."""
    rows = []
    for i, parameter in enumerate(calibration.parameters.values()):
        if parameter.name in leave_out:
            continue
        partner, r = find_partner(calibration, i)
        strong = abs(r) >= 0.9
        told = html("{} {}", partner, number(r, 3 if abs(r) > 0.95 else 2)) if partner else "–"
        rows.append([
            html("<b>{}</b>", parameter.name),
            html('<small class="meaning">{}</small>', meaning(parameter, calibration)),
            with_unit(parameter.value, parameter.unit, 6),
            number(parameter.standard_error, 2),
            number(parameter.standard_error_white, 2),
            html('<span class="flag">{}</span>', told) if strong else told,
            _flag(parameter),
        ])  # fmt: skip
    head = [("parameter", False), ("", False), ("value", True), ("standard error", True),
            ("if white", True), ("most correlated with", True), ("", False)]  # fmt: skip
    for follows in (derived or {}).values():
        rows.append([
            html("<b>{}</b>", follows.name),
            html(
                '<small class="meaning">follows from the others: {}</small>',
                MEANINGS.get(follows.name, ""),
            ),
            with_unit(follows.value, follows.unit, 6),
            number(follows.standard_error, 2),
            number(follows.standard_error_white, 2),
            "",
            "",
        ])  # fmt: skip
    return table(head, rows)


def list_restated(restated: Mapping[str, Mapping[str, Any]]) -> Html:
    """Estimates in other words, a line each; empty where there are none."""
    told = {name: entry["sentence"].replace("+-", "±") for name, entry in restated.items()}
    lines = [html("<b>{}</b>: {}", name, sentence) for name, sentence in told.items()]
    return html("<h3>In other words</h3>{}", bullets(lines)) if lines else html("")


def meaning(parameter: Parameter, calibration: Fit) -> str:
    """In a few words; an effect's coefficient is named after the effect."""
    name, _, flight = parameter.name.partition("@")
    if flight:
        return f"{MEANINGS.get(name, name)}, of {flight}"
    for effect in calibration.effects:
        if parameter.name.startswith(f"{effect.name}."):
            return "of the added effect"
    return MEANINGS.get(parameter.name, "")


def _flag(parameter: Parameter) -> Html:
    if not parameter.remark:
        return html("")
    bounds = f" [{parameter.lower:.4g}, {parameter.upper:.4g}]" if parameter.at_bound else ""
    return html('<span class="flag">{}</span>{}', parameter.remark, bounds)


def find_partner(calibration: Fit, i: int) -> tuple[str, float]:
    """The parameter that parameter i is correlated with most, and how much; else ""."""
    row = np.array(calibration.correlation[i], dtype=float)
    row[i] = np.nan
    if not np.isfinite(row).any():
        return "", 0.0
    j = int(np.nanargmax(np.abs(row)))
    return calibration.names[j], float(row[j])


def list_directions(unobservable: Sequence[Combination], weak: Sequence[Combination]) -> Html:
    """Says what the flight leaves open."""
    lines = [
        html(
            "The flight can't show <code>{}</code>{}.",
            at.text,
            html(" (standard error {})", number(at.standard_error, 2))
            if np.isfinite(at.standard_error)
            else "",
        )
        for at in unobservable
    ]
    lines += [
        html(
            "Poorly determined: <code>{}</code>, standard error {}; its parameters are hard to "
            "tell apart.",
            at.text,
            number(at.standard_error, 2),
        )
        for at in weak
    ]
    if not lines:
        return html("<p>Every combination of the parameters is determined by this flight.</p>")
    return bullets(lines)


def list_collinear(fit: Fit, leave_out: Collection[str] = ()) -> Html:
    """Pairs that are correlated above 0.9, and directions whose condition index is above 10."""
    found = fit.collinearity
    lines = [
        html("<code>{}</code> and <code>{}</code> are correlated by {}.", at.first, at.second,
             number(at.correlation, 3))
        for at in found.pairs
        if not {at.first, at.second} & set(leave_out)
    ][:COLLINEAR]  # fmt: skip
    large = [k for k, index in enumerate(found.condition_indices) if index > 10]
    for k in reversed(large):
        shares = found.variance_proportions[k]
        named = [(n, s) for n, s in zip(found.names, shares, strict=True) if s > 0.5]
        if len(named) > 1 and len(lines) < 2 * COLLINEAR:
            told = ", ".join(f"{name} {share:.2f}" for name, share in named)
            lines.append(
                html("Condition index {}: it makes these shares of the variances: {}.",
                     number(float(found.condition_indices[k]), 2), told)
            )  # fmt: skip
    if not lines:
        return html("")
    return html("<h3>Estimates that go together</h3>{}", bullets(lines))


def bullets(lines: Sequence[str]) -> Html:
    """Lines, text or Html, as a list."""
    return html("<ul>{}</ul>", join("", (html("<li>{}</li>", line) for line in lines)))
