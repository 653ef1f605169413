# SPDX-License-Identifier: BSD-3-Clause
"""What to fly or log next, and how to make the page again."""

from __future__ import annotations

import hashlib
import json
import platform
import shlex
from html import escape

from sepcal import _core
from sepcal.diagnosis import EffectFinding
from sepcal.reporting import tables
from sepcal.reporting.gather import Material
from sepcal.reporting.words import number, with_unit
from sepcal.results import Fit

BEYOND_ALL = 1e6  # of a port's unit: nothing that would have shown is so large
DEPARTS = 0.01  # of p
TWINS = 4  # effects that would do as well, or pairs, that are named


def warn(last: Fit, section: int) -> list[str]:
    """What to know of the fit before reading on, HTML lines; its whole message where it failed.

    `section` has the parameters.
    """
    lines = []
    if last.status != "converged":
        lines.append(f"<b>{escape(last.status.replace('_', ' '))}:</b> {escape(last.message)}")
    elif last.weak:
        count = len(last.weak)
        lines.append(
            f"{'One combination' if count == 1 else f'{count} combinations'} of the parameters "
            f"{'is' if count == 1 else 'are'} poorly determined by this flight; "
            f'<a href="#s{section}">section {section}</a> has them.'
        )
    if last.at_bound:
        names = ", ".join(f"<code>{escape(name)}</code>" for name in last.at_bound)
        lines.append(f"At a bound, so the true value may lie beyond: {names}.")
    return lines


def advise(material: Material) -> str:
    """Bullets, the most useful first."""
    last, found = material.last, material.diagnosis
    lines: list[str] = []
    if found.missing_channels:
        names = ", ".join(f"<code>{escape(name)}</code>" for name in found.missing_channels)
        lines.append(
            f"<b>Log</b> what this flight lacks and what could explain more of the error: {names}."
        )
    instead = [escape(name) for name in found.list_beside("equivalent")]
    if instead:
        more = f" and {len(instead) - TWINS} more" if len(instead) > TWINS else ""
        lines.append(
            f"<b>Fly</b> so that their drivers vary one without the other: added instead of "
            f"<code>{escape(found.effects[0].name)}</code>, {', '.join(instead[:TWINS])}{more} "
            "would do as well."
        )
    if found.pairs:
        pairs = "; ".join(f"<code>{escape(pair)}</code>" for pair in found.pairs[:TWINS])
        more = f" and {len(found.pairs) - TWINS} more" if len(found.pairs) > TWINS else ""
        lines.append(
            f"<b>Fly</b> so that channels vary one by one: it may be two causes at once, "
            f"and this flight can't say which: {pairs}{more}."
        )
    for effect in found.found[:1]:
        if effect.visibility < _core.VISIBLE_FROM:
            lines.append(
                f"<b>Fly</b> more variety before trusting the parameters beside "
                f"<code>{escape(effect.name)}</code>: on this flight they can do most of what at "
                f"least a part of it does (visibility {number(effect.visibility, 2)}), and will be "
                "poorly determined once it is added."
            )
    lines += advise_on_open(last)
    for at in last.weak:
        lines.append(
            f"<b>Fly</b> more of what separates {escape(', '.join(at.parameters[:TWINS]))}: they "
            "are poorly told apart."
        )
    for name in last.at_bound:
        lines.append(
            f"<b>Check</b> <code>{escape(name)}</code>: it stopped at its bound. A sign, a unit or "
            "a sensitivity may be wrong; else widen it, "
            f"<code>--bounds {escape(name)}=LO,HI</code>."
        )
    hidden = [escape(at.name) for at in found.effects if at.status == "cannot_be_seen"]
    if hidden:
        lines.append(
            "These could be there unseen, because the parameters absorb them on this flight: "
            f"{', '.join(hidden)}."
        )
    return tables.bullets(lines) if lines else "<p>Nothing stands out.</p>"


def advise_on_open(last: Fit) -> list[str]:
    """What to do about each combination that the flight leaves open."""
    lines = []
    absent = []
    for at in last.unobservable:
        names = escape(", ".join(at.parameters))
        if not set(at.parameters) <= set(last.parameters):
            absent.append(names)
        elif len(at.parameters) == 1:
            lines.append(
                f"<b>Fly</b> what shows {names}, or hold it with <code>--fix {names}=VALUE</code>."
            )
        else:
            lines.append(
                f"<b>Fly</b> what separates {names}, or hold one of them with "
                "<code>--fix NAME=VALUE</code>: their combination "
                f"<code>{escape(at.text)}</code> is open."
            )
    if absent:
        lines.append(f"No flight shows {', '.join(absent)} to this model, which lacks them.")
    return lines


def list_limits(material: Material) -> str:
    """The smallest slow effect of each port that would have shown."""
    limits = material.diagnosis.limits
    if not limits:
        return ""
    rows = [
        [
            f"<b>{escape(port)}</b>",
            with_unit(limit["size"], limit["unit"])
            if limit["size"] is not None and limit["size"] < BEYOND_ALL
            else "none",
        ]
        for port, limit in limits.items()
    ]
    head = [("enters at", False), ("smallest slow effect that would have shown", True)]
    return f"<h3>How small an effect this flight could show</h3>{tables.table(head, rows)}"


def list_flights(material: Material) -> str:
    """Of a joint fit: whether each flight agrees with the others; empty of one flight."""
    departures = material.last.departures
    if not departures:
        return ""
    rows = []
    for label, one in departures.items():
        off = f"{number(one.difference, 3)} ± {number(one.standard_error, 2)}"
        told = f"{escape(one.parameter)} by {off}" if one.parameter else ""
        departs = "departs" if one.p < DEPARTS else ""
        rows.append([f"<b>{escape(label)}</b>", number(one.p, 2), told, departs])
    head = [("flight", False), ("p", True), ("most different", False), ("", False)]
    return (
        "<h3>Does a flight depart from the others?</h3><p>Its own estimate of what all share, "
        "against that of the others; p is of a larger difference by chance, adjusted for the "
        f"number of flights.</p>{tables.table(head, rows)}"
    )


def advised(material: Material) -> EffectFinding | None:
    """The effect to add next, which a fit bears out."""
    name = material.diagnosis.advice["effect"]
    return material.diagnosis[name] if name else None


def next_command(material: Material, file: str) -> str:
    """The shell command that adds the effect that is advised; empty where none is."""
    effect = advised(material)
    if effect is None or not file or not material.flight.sha256:
        return ""
    app = "sepcal-mag" if material.model.startswith("magnetometer") else "sepcal-pitot"
    words = [app, "add", *material.flight_files, file, effect.name]
    return f"{shlex.join(words)} -o NEXT.json"


def report_command(material: Material, file: str) -> str:
    """What makes this page again."""
    if material.files and material.flight.sha256:
        flights = material.flight_files
        words = ["python", "-m", "sepcal", "report", *flights, *material.files]
        return shlex.join([*words, "-o", file])
    return f"sepcal.report(calibrations, {file!r}, flight)"


def list_provenance(material: Material, file: str) -> str:
    """Inputs, version, seed, options."""
    flight, inputs = material.flight, material.description["inputs"]
    used = material.figures.rows.size
    rows = [
        ["flight", f"{escape(flight.name)}, {flight.rows:,} rows, {used:,} used"],
        ["sha256 of the flight", f"<code>{flight.sha256 or 'none: arrays, not a file'}</code>"],
    ]
    for i, calibration in enumerate(material.chain):
        name = material.files[i] if i < len(material.files) else f"calibration {i + 1}"
        digest = hashlib.sha256(calibration.to_json().encode()).hexdigest()
        rows.append([f"sha256 of {escape(name)}", f"<code>{digest}</code>"])
    if not material.is_fitted_flight:
        rows.append(["fitted on", f"{escape(inputs['file'])}, <code>{inputs['sha256']}</code>"])
    rows += [
        ["model", escape(material.model)],
        ["sepcal", f"{escape(_core.__version__)}, Python {platform.python_version()}"],
        ["seed of stage one", f"{material.options.get('seed', 0)}"],
        ["status of the fit", escape(f"{material.last.status.replace('_', ' ')}, "
                                     f"{material.last.method}, cost "
                                     f"{number(material.last.cost, 6)}")],
    ]  # fmt: skip
    options = escape(json.dumps(material.options, indent=None))
    shown = tables.table([("", False), ("", False)], rows)
    return (
        f"{shown}<p>This page again:</p><pre>{escape(report_command(material, file))}</pre>"
        f"<details><summary>all options of the fit</summary><pre>{options}</pre></details>"
    )
