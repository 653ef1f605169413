# SPDX-License-Identifier: BSD-3-Clause
"""Advice on what to fly or log next, and how to make the page again."""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Iterable, Sequence
from typing import LiteralString

from sepcal import _core
from sepcal._core import EffectFinding
from sepcal.markup import Html, html, join
from sepcal.printing import in_shell
from sepcal.reporting import tables
from sepcal.reporting.gather import Material
from sepcal.reporting.words import number, with_unit
from sepcal.results import Fit

BEYOND_ALL = 1e6  # of a port's unit: nothing that would have shown is so large
DEPARTS = 0.01  # of p
TWINS = 4  # effects that would do as well, or pairs, that are named


def code(names: Iterable[str], between: LiteralString = ", ") -> Html:
    """Names in a line, as code."""
    return join(between, (html("<code>{}</code>", name) for name in names))


def warn(last: Fit, section: int) -> list[str]:
    """The sentences of the fit's status, a line each; its whole message where it failed.

    `section` has the parameters.
    """
    lines: list[str] = []
    if last.status != "converged":
        lines.append(html("<b>{}:</b> {}", last.status.replace("_", " "), last.message))
    elif last.weak:
        count = len(last.weak)
        lines.append(
            html(
                '{} poorly determined by this flight; <a href="#s{}">section {}</a> has them.',
                "One combination of the parameters is"
                if count == 1
                else f"{count} combinations of the parameters are",
                section,
                section,
            )
        )
    if last.at_bound:
        lines.append(html("At a bound, so the true value may lie beyond: {}.", code(last.at_bound)))
    return lines


def advise(material: Material) -> Html:
    """Bullets, the most useful first."""
    last, found = material.last, material.diagnosis
    lines: list[str] = []
    if found.missing_channels:
        lines.append(
            html(
                "<b>Log</b> what this flight lacks and what could explain more of the error: {}.",
                code(found.missing_channels),
            )
        )
    instead = found.list_beside("equivalent")
    if instead:
        more = f" and {len(instead) - TWINS} more" if len(instead) > TWINS else ""
        lines.append(
            html(
                "<b>Fly</b> so that their drivers vary one without the other: added instead of "
                "<code>{}</code>, {}{} would do as well.",
                found.effects[0].name,
                ", ".join(instead[:TWINS]),
                more,
            )
        )
    if found.pairs:
        more = f" and {len(found.pairs) - TWINS} more" if len(found.pairs) > TWINS else ""
        lines.append(
            html(
                "<b>Fly</b> so that channels vary one by one: it may be two causes at once, and "
                "this flight can't say which: {}{}.",
                code(found.pairs[:TWINS], "; "),
                more,
            )
        )
    for effect in found.found[:1]:
        if effect.visibility < _core.VISIBLE_FROM:
            lines.append(
                html(
                    "<b>Fly</b> more variety before trusting the parameters beside "
                    "<code>{}</code>: on this flight they can do most of what at least a part of "
                    "it does (visibility {}), and will be poorly determined once it is added.",
                    effect.name,
                    number(effect.visibility, 2),
                )
            )
    lines += advise_on_open(last)
    for at in last.weak:
        lines.append(
            html(
                "<b>Fly</b> more of what separates {}: they are poorly told apart.",
                ", ".join(at.parameters[:TWINS]),
            )
        )
    for name in last.at_bound:
        lines.append(
            html(
                "<b>Check</b> <code>{}</code>: it stopped at its bound. A sign, a unit or a "
                "sensitivity may be wrong; else widen it, <code>--bounds {}=LO,HI</code>.",
                name,
                name,
            )
        )
    hidden = [at.name for at in found.effects if at.status == "cannot_be_seen"]
    if hidden:
        lines.append(
            "These could be there unseen, because the parameters absorb them on this flight: "
            f"{', '.join(hidden)}."
        )
    return tables.bullets(lines) if lines else html("<p>Nothing stands out.</p>")


def advise_on_open(last: Fit) -> list[str]:
    """Says what to do about each combination that the flight leaves open."""
    lines: list[str] = []
    absent = []
    for at in last.unobservable:
        names = ", ".join(at.parameters)
        if not set(at.parameters) <= set(last.parameters):
            absent.append(names)
        elif len(at.parameters) == 1:
            lines.append(
                html(
                    "<b>Fly</b> what shows {}, or hold it with <code>--fix {}=VALUE</code>.",
                    names,
                    names,
                )
            )
        else:
            lines.append(
                html(
                    "<b>Fly</b> what separates {}, or hold one of them with "
                    "<code>--fix NAME=VALUE</code>: their combination <code>{}</code> is open.",
                    names,
                    at.text,
                )
            )
    if absent:
        lines.append(f"No flight shows {', '.join(absent)} to this model, which lacks them.")
    return lines


def list_limits(material: Material) -> Html:
    """The smallest slow effect of each port that would have shown."""
    limits = material.diagnosis.limits
    if not limits:
        return html("")
    rows = [
        [
            html("<b>{}</b>", port),
            with_unit(limit.size, limit.unit) if limit.size < BEYOND_ALL else "none",
        ]
        for port, limit in limits.items()
    ]
    head = [("enters at", False), ("smallest slow effect that would have shown", True)]
    return html("<h3>How small an effect this flight could show</h3>{}", tables.table(head, rows))


def list_flights(material: Material) -> Html:
    """Says whether each flight of a joint fit agrees with the others; empty for one flight."""
    departures = material.last.departures
    if not departures:
        return html("")
    rows = []
    for label, one in departures.items():
        told = html(
            "{} by {} ± {}",
            one.parameter,
            number(one.difference, 3),
            number(one.standard_error, 2),
        )
        departs = "departs" if one.p < DEPARTS else ""
        rows.append(
            [html("<b>{}</b>", label), number(one.p, 2), told if one.parameter else "", departs]
        )
    head = [("flight", False), ("p", True), ("most different", False), ("", False)]
    return html(
        "<h3>Does a flight depart from the others?</h3><p>Its own estimate of what all share, "
        "against that of the others; p is of a larger difference by chance, adjusted for the "
        "number of flights.</p>{}",
        tables.table(head, rows),
    )


def advised(material: Material) -> EffectFinding | None:
    """The effect to add next, which a fit bears out."""
    name = material.diagnosis.advice.effect
    return material.diagnosis[name] if name else None


def next_command(material: Material, file: str) -> str:
    """The shell command that adds the effect that is advised; empty where none is."""
    effect = advised(material)
    if effect is None or not file or not material.flight.sha256:
        return ""
    words = [*material.flight_files, file, effect.name]
    return f"{material.last.core.command('add')} {in_shell(words)} -o NEXT.json"


def report_command(material: Material, file: str) -> str:
    """The command that makes this page again."""
    if material.files and material.flight.sha256:
        flights = material.flight_files
        own = material.last.own_model is not None
        command = material.last.core.command("report") if own else "python -m sepcal report"
        return f"{command} {in_shell([*flights, *material.files, '-o', file])}"
    return f"sepcal.report(calibrations, {file!r}, flight)"


def list_provenance(material: Material, file: str) -> Html:
    """Inputs, version, seed, options."""
    flight, inputs = material.flight, material.description["inputs"]
    used = material.figures.rows.size
    rows: list[list[str]] = [
        ["flight", f"{flight.name}, {flight.rows:,} rows, {used:,} used"],
        ["sha256 of the flight", code([flight.sha256 or "none: arrays, not a file"])],
    ]
    for i, calibration in enumerate(material.chain):
        name = material.files[i] if i < len(material.files) else f"calibration {i + 1}"
        digest = hashlib.sha256(calibration.to_json().encode()).hexdigest()
        rows.append([f"sha256 of {name}", code([digest])])
    if not material.is_fitted_flight:
        rows.append(["fitted on", html("{}, {}", inputs["file"], code([inputs["sha256"]]))])
    rows += [
        ["model", material.model],
        ["sepcal", f"{_core.__version__}, Python {platform.python_version()}"],
        ["seed of stage one", f"{material.options.get('seed', 0)}"],
        ["status of the fit", html("{}, {}, cost {}", material.last.status.replace("_", " "),
                                   material.last.method, number(material.last.cost, 6))],
    ]  # fmt: skip
    return list_origin(rows, report_command(material, file), material.options)


def list_origin(rows: Sequence[Sequence[str]], again: str, options: object) -> Html:
    """Where a page comes from, what makes it again, and the fit's options."""
    return html(
        "{}<p>This page again:</p><pre>{}</pre><details><summary>all options of the fit</summary>"
        "<pre>{}</pre></details>",
        tables.table([("", False), ("", False)], rows),
        again,
        json.dumps(options),
    )
