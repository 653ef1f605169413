# SPDX-License-Identifier: BSD-3-Clause
"""The report's tables as HTML. Every name from a file is escaped."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from html import escape
from typing import Any

import numpy as np

from sepcal import _core
from sepcal._core import Combination, HistoryEntry, Parameter
from sepcal.calibration import Calibration
from sepcal.comparison import Comparison
from sepcal.diagnosis import EffectFinding
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
NEGLIGIBLE = 0.3  # standard errors: a shift that needs no table


def table(head: Sequence[tuple[str, bool]], rows: Sequence[Sequence[str]]) -> str:
    """Columns (title, whether it holds numbers) and cells, both HTML."""
    kinds = [' class="n"' if numeric else "" for _, numeric in head]
    top = "".join(f"<th{kind}>{title}</th>" for kind, (title, _) in zip(kinds, head, strict=True))
    body = "".join(
        "<tr>"
        + "".join(f"<td{kind}>{cell}</td>" for kind, cell in zip(kinds, row, strict=True))
        + "</tr>"
        for row in rows
    )
    return f'<div class="table"><table><tr>{top}</tr>{body}</table></div>'


def list_history(history: Sequence[HistoryEntry], unit: str) -> str:
    """Promised next to achieved, a row an added effect."""
    rows = []
    for entry in history:
        achieved = drop(entry.rmse_before, entry.rmse_after)
        rows.append([
            f"<code>{escape(entry.effect)}</code>",
            f"{number(entry.rmse_before)} → {with_unit(entry.rmse_after, unit)}",
            percent(entry.predicted_drop),
            percent(achieved),
            f"{number(entry.held_out_before)} → {number(entry.held_out_after)}"
            if entry.held_out_after is not None
            else "–",
            percent(drop(entry.held_out_before, entry.held_out_after)),
        ])  # fmt: skip
    head = [("added", False), ("RMSE", True), ("promised drop", True), ("achieved drop", True),
            ("held-out RMSE", True), ("held-out drop", True)]  # fmt: skip
    return table(head, rows)


def drop(before: float | None, after: float | None) -> float | None:
    """1 - after / before."""
    return None if before is None or after is None or before == 0 else 1 - after / before


def list_calibrations(
    chain: Sequence[Fit], files: Sequence[str], comparisons: Sequence[Comparison]
) -> str:
    """RMSE of every calibration of the chain on this flight."""
    outputs = [misfit.output for misfit in comparisons[-1].overall]
    rows = []
    for i, calibration in enumerate(chain):
        effects = ", ".join(f"<code>{escape(at.name)}</code>" for at in calibration.effects)
        rows.append([
            escape(files[i]) if i < len(files) else f"{i + 1}",
            effects or "none",
            escape(calibration.status.replace("_", " ")),
            *(with_unit(misfit.rmse, misfit.unit) for misfit in comparisons[i].overall),
        ])  # fmt: skip
    head = [("calibration", False), ("effects in it", False), ("status", False)]
    return table([*head, *((f"RMSE {escape(name)}", True) for name in outputs)], rows)


def list_windows(comparison: Comparison) -> str:
    """The worst stretches of the flight, worst first."""
    outputs = [misfit.output for misfit in comparison.overall]
    units = {misfit.output: misfit.unit for misfit in comparison.overall}
    rows = [
        [
            f"{window.first_s:.6g} to {window.last_s:.6g} s",
            f"{window.rows}",
            *(
                f"{with_unit(window.rmse[at], units[at])} <small>mean {number(window.mean[at], 2)}"
                "</small>"
                for at in outputs
            ),
        ]
        for window in comparison.windows
    ]
    head = [("worst windows", False), ("rows", True)]
    return table([*head, *((f"RMSE {escape(name)}", True) for name in outputs)], rows)


def list_candidates(effects: Sequence[EffectFinding]) -> str:
    """The ranking: the first in sight, the others folded away."""
    first = _rank(effects[:SHOWN], 1)
    if len(effects) <= SHOWN:
        return first
    others = _rank(effects[SHOWN:], SHOWN + 1)
    left = len(effects) - SHOWN
    return f"{first}<details><summary>the other {left} candidates</summary>{others}</details>"


def _rank(effects: Sequence[EffectFinding], first: int) -> str:
    rows = []
    for i, effect in enumerate(effects, first):
        name = f"<b>{escape(effect.name)}</b><br><small>{escape(effect.sentence)}</small>"
        if not all(at in effect.name or at in effect.sentence for at in effect.drivers):
            name += f"<br><small>driven by {escape(', '.join(effect.drivers))}</small>"
        status = effect.in_words
        held = percent(effect.held_out_gain)
        seen = number(effect.visibility, 2)
        if effect.visibility < _core.VISIBLE_FROM:
            seen = f'<span class="flag">{seen}</span>'
        rows.append([
            f"{i}",
            name,
            _coefficients(effect),
            probability(effect.p_adjusted),
            percent(effect.predicted_drop),
            held,
            seen,
            number(effect.partial_f, 3),
            percent(drop(effect.pse_without, effect.pse)),
            percent(_share(effect.sse_reduction, effect.sse)),
            effect.beside_in_words,
            f'<span class="{"found" if effect.status == "found" else "pill"}">{status}</span>',
        ])  # fmt: skip
    head = [("", True), ("candidate", False), ("estimate ± standard error", False),
            ("p,<br>adjusted", True), ("predicted<br>drop", True), ("held-out<br>gain", True),
            ("visi-<br>bility", True), ("partial<br>F", True), ("PSE<br>falls by", True),
            ("SSE<br>falls by", True), ("beside<br>the first", False),
            ("status", False)]  # fmt: skip
    return table(head, rows)


def _share(part: float | None, whole: float | None) -> float | None:
    return None if part is None or whole is None or whole == 0 else part / whole


def _coefficients(effect: EffectFinding, most: int = 4) -> str:
    lines = []
    for name, value in list(effect.estimate.items())[:most]:
        short = name.removeprefix(effect.name).lstrip(".") or name
        unit = effect.unit.get(name, "")
        shown = estimate(value, effect.standard_error.get(name), unit)
        lines.append(f'<span class="pill"><small>{escape(short)}</small> {shown}</span>')
    left = len(effect.estimate) - most
    if left > 0:
        lines.append(f"<small>and {left} more coefficients</small>")
    lines += [
        f"<small>{escape(name.removeprefix(effect.name).lstrip('.'))} = {number(value, 4)}</small>"
        for name, value in effect.shapes.items()
    ]
    return "<br>".join(lines)


def list_absorbed(effect: EffectFinding, calibration: Calibration, most: int = 5) -> str:
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
            f"<b>{escape(parameter.name)}</b>",
            f"<small>{escape(meaning(parameter, calibration))}</small>",
            with_unit(shift, parameter.unit, 2),
            number(ratio, 2),
        ]
        for ratio, parameter, shift in shifts[:most]
    ]
    if not rows:
        return ""
    if shifts[0][0] < NEGLIGIBLE:
        return (
            f"<p>Ignoring <code>{escape(effect.name)}</code> shifts no parameter by more than "
            f"{number(shifts[0][0], 1)} of its standard error.</p>"
        )
    head = [("parameter", False), ("", False), ("off by", True), ("in standard errors", True)]
    title = f"<h3>What ignoring <code>{escape(effect.name)}</code> does to the parameters</h3>"
    return title + table(head, rows)


def list_parameters(
    calibration: Fit,
    derived: Mapping[str, _core.Derived] | None = None,
    leave_out: Collection[str] = (),
) -> str:
    """Estimates with both standard errors, flags, and the most correlated partner."""
    rows = []
    for i, parameter in enumerate(calibration.parameters.values()):
        if parameter.name in leave_out:
            continue
        partner, r = find_partner(calibration, i)
        strong = abs(r) >= 0.9
        told = f"{escape(partner)} {number(r, 3 if abs(r) > 0.95 else 2)}" if partner else "–"
        rows.append([
            f"<b>{escape(parameter.name)}</b>",
            f"<small>{escape(meaning(parameter, calibration))}</small>",
            with_unit(parameter.value, parameter.unit, 6),
            number(parameter.standard_error, 2),
            number(parameter.standard_error_white, 2),
            f'<span class="flag">{told}</span>' if strong else told,
            _flag(parameter),
        ])  # fmt: skip
    head = [("parameter", False), ("", False), ("value", True), ("standard error", True),
            ("if white", True), ("most correlated with", True), ("", False)]  # fmt: skip
    for follows in (derived or {}).values():
        rows.append([
            f"<b>{escape(follows.name)}</b>",
            f"<small>follows from the others: {MEANINGS.get(follows.name, '')}</small>",
            with_unit(follows.value, follows.unit, 6),
            number(follows.standard_error, 2),
            number(follows.standard_error_white, 2),
            "",
            "",
        ])  # fmt: skip
    return table(head, rows)


def list_restated(restated: Mapping[str, Mapping[str, Any]]) -> str:
    """Estimates in other words, a line each; empty where there are none."""
    lines = [
        f"<b>{escape(name)}</b>: {escape(str(entry['sentence']))}"
        for name, entry in restated.items()
    ]
    return f"<h3>In other words</h3>{bullets(lines)}" if lines else ""


def meaning(parameter: Parameter, calibration: Fit) -> str:
    """In a few words; an effect's coefficient is named after the effect."""
    name, _, flight = parameter.name.partition("@")
    if flight:
        return f"{MEANINGS.get(name, name)}, of {flight}"
    for effect in calibration.effects:
        if parameter.name.startswith(f"{effect.name}."):
            return "of the added effect"
    return MEANINGS.get(parameter.name, "")


def _flag(parameter: Parameter) -> str:
    if not parameter.remark:
        return ""
    bounds = f" [{parameter.lower:.4g}, {parameter.upper:.4g}]" if parameter.at_bound else ""
    return f'<span class="flag">{escape(parameter.remark)}</span>{bounds}'


def find_partner(calibration: Fit, i: int) -> tuple[str, float]:
    """The parameter that parameter i is correlated with most, and how much; else ""."""
    row = np.array(calibration.correlation[i], dtype=float)
    row[i] = np.nan
    if not np.isfinite(row).any():
        return "", 0.0
    j = int(np.nanargmax(np.abs(row)))
    return calibration.names[j], float(row[j])


def list_directions(unobservable: Sequence[Combination], weak: Sequence[Combination]) -> str:
    """What the flight leaves open, in words."""
    lines = [
        f"The flight can't show <code>{escape(at.text)}</code>"
        + (
            f" (standard error {number(at.standard_error, 2)})."
            if np.isfinite(at.standard_error)
            else "."
        )
        for at in unobservable
    ]
    lines += [
        f"Poorly determined: <code>{escape(at.text)}</code>, standard error "
        f"{number(at.standard_error, 2)}; its parameters are hard to tell apart."
        for at in weak
    ]
    if not lines:
        return "<p>Every combination of the parameters is determined by this flight.</p>"
    return bullets(lines)


def bullets(lines: Sequence[str]) -> str:
    """HTML lines as a list."""
    return "<ul>" + "".join(f"<li>{line}</li>" for line in lines) + "</ul>"
