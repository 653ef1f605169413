# SPDX-License-Identifier: BSD-3-Clause
"""The study's rates as Markdown tables, and the power curve as a picture."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from sepcal._core import Error
from sepcal.quantiles import upper_limit
from studies.hidden_effects.experiments import StudyOptions

Row = dict[str, Any]


def write_up(rows: dict[str, list[Row]], options: StudyOptions, file: Path) -> None:
    """Writes `file` (Markdown) and, beside it, the power curve as an SVG of the same name.

    Raises:
        Error: matplotlib is missing, or a file can't be written.
    """
    picture = file.with_suffix(".svg")
    sections = [
        _head(options, picture.name),
        _power(rows["power"]),
        _nulls(rows["null"]),
        _others(rows),
        _promises(rows["power"]),
    ]
    try:
        file.write_text("\n\n".join(sections) + "\n", encoding="utf-8")
        _draw(rows["power"], picture)
    except OSError as error:
        raise Error(f"{file} can't be written: {error.strerror}") from error


def _table(head: Sequence[str], body: Iterable[Sequence[str]]) -> str:
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    return "\n".join([*lines, *(f"| {' | '.join(cells)} |" for cells in body)])


def _rate(rows: list[Row], is_one: Callable[[Row], bool]) -> str:
    return f"{sum(is_one(row) for row in rows)} of {len(rows)}" if rows else "-"


def _head(options: StudyOptions, picture: str) -> str:
    command = (
        f"scripts/study hidden-effects --seeds {options.seeds} "
        f"--null-seeds {options.null_seeds} -o docs/hidden-effects.md"
    )
    return f"""# Hidden effects: what is found, and what isn't

Written by

    {command}

An effect is hidden in a simulated flight of two minutes, 400 to 1,200 rows, by a simulator that
shares no code with the effects; the probe is calibrated without it and the calibration diagnosed.
A size of s sigmas is a noncentrality of s^2: what the best fit without the effect leaves of a
flight without noise, in variances of the noise. "First": the true effect comes first, or would do
as well instead of what does. "Found": so, or among those found (Holm p < 0.05, held out). What
changes as slowly as an instrument's errors wander, and by less, is no finding, however many sigmas
it has: [how far that is](diagnosis.md#how-far-instruments-wander).
Seeds count from {options.first_seed}.

![share of flights against size]({picture})"""


def _sizes(rows: list[Row]) -> list[float]:
    return sorted({row["sigmas"] for row in rows})


def _power(rows: list[Row]) -> str:
    sizes = _sizes(rows)
    kinds = sorted({(row["probe"], row["effect"]) for row in rows})

    def cells(chosen: list[Row]) -> list[str]:
        at = [[row for row in chosen if row["sigmas"] == size] for size in sizes]
        return [f"{_share(some, 'first')} / {_share(some, 'found')}" for some in at]

    body = [
        [probe, f"`{effect}`", *cells([r for r in rows if (r["probe"], r["effect"]) == kind])]
        for kind in kinds
        for probe, effect in [kind]
    ]
    body.append(["all", "", *cells(rows)])
    head = ["probe", "hidden", *(f"{size:g} sigmas" for size in sizes)]
    return "## One effect: per cent first / found\n\n" + _table(head, body)


def _share(rows: list[Row], key: str) -> str:
    return f"{100 * sum(row[key] for row in rows) / len(rows):.0f}" if rows else "-"


def _nulls(rows: list[Row]) -> str:
    def is_alarm(row: Row) -> bool:
        return bool(row["verdict"] == "effect_missing")

    body = []
    for noise in dict.fromkeys(row["noise"] for row in rows):
        chosen = [row for row in rows if row["noise"] == noise]
        alarms = sum(is_alarm(row) for row in chosen)
        body.append(
            [
                noise,
                _rate(chosen, is_alarm),
                f"{100 * upper_limit(alarms, len(chosen)):.1f} %",
                _rate(chosen, lambda row: row["verdict"] == "unexplained"),
            ]
        )
    alarms = sum(is_alarm(row) for row in rows)
    limit = f"{100 * upper_limit(alarms, len(rows)):.1f} %"
    unexplained = _rate(rows, lambda row: row["verdict"] == "unexplained")
    body.append(["all", _rate(rows, is_alarm), limit, unexplained])
    head = ["noise", "an effect is called found", "99 % upper limit of the rate", "unexplained"]
    return "## Nothing hidden\n\n" + _table(head, body)


def _others(rows: dict[str, list[Row]]) -> str:
    def by(experiment: str, key: str) -> Iterable[tuple[str, list[Row]]]:
        for value in dict.fromkeys(row[key] for row in rows[experiment]):
            yield value, [row for row in rows[experiment] if row[key] == value]

    body = []
    for effects, chosen in by("pairs", "effects"):
        what = f"two at 30 sigmas: {effects}"
        both = _rate(chosen, lambda row: row["both"] and not row["third"])
        body.append([what, "both are added and no third", both])
    decoys = rows["decoys"]
    chosen_decoys = _rate(decoys, lambda row: row["decoys"] > 0)
    body.append(["five decoy channels, nothing hidden", "a decoy is called found", chosen_decoys])
    for effect, chosen in by("invisible", "effect"):
        what = f"`{effect}`, which the model absorbs"
        body.append([what, "it is called found", _rate(chosen, lambda r: r["status"] == "found")])
        said = _rate(chosen, lambda row: row["status"] == "cannot_be_seen")
        body.append([what, "said to be invisible", said])
    proxy = rows["proxy"]
    what = "`bias[current_a]` at 10 sigmas beside a voltage that sags with it"
    said = _rate(proxy, lambda row: row["true_stands_first"])
    body.append([what, "the current comes first or would do as well", said])
    body.append([what, "the voltage is found", _rate(proxy, lambda row: row["proxy_found"])])
    for effect, chosen in by("unmeasured", "effect"):
        what = f"`{effect}` at 20 sigmas, its channel not logged"
        for verdict in ("unexplained", "effect_missing", "adequate"):
            count = sum(row["verdict"] == verdict for row in chosen)
            body.append([what, verdict, f"{count} of {len(chosen)}"])
    slow = rows["slow"]
    what = "a wind that drifts by 2 m/s in 250 s, noise 0.15 m/s"
    body.append([what, "first", _rate(slow, lambda row: row["first"])])
    body.append([what, "found", _rate(slow, lambda row: row["found"])])
    return "## Harder questions\n\n" + _table(["what is flown", "how often", "flights"], body)


def _promises(rows: list[Row]) -> str:
    kept = [row for row in rows if row.get("promised") is not None]
    if not kept:
        return ""

    def near(row: Row) -> bool:
        return bool(abs(row["promised"] - row["achieved"]) <= 0.05 * abs(row["achieved"]))

    judged = [row for row in kept if row["held_out_before"] is not None]
    body = [
        ["the drop of the error is within 5 % of the promise", _rate(kept, near)],
        [
            "the error of rows held out falls",
            _rate(judged, lambda row: row["held_out_after"] < row["held_out_before"]),
        ],
        [
            "the furthest parameter is nearer to the truth",
            _rate(kept, lambda row: row["worst_error_after"] < row["worst_error_before"]),
        ],
        [
            "neighbouring residuals correlate less",
            _rate(kept, lambda row: row["lag_one_after"] < row["lag_one_before"]),
        ],
    ]
    return "## After `add`, at 10 sigmas\n\n" + _table(["", "flights"], body)


def _draw(rows: list[Row], file: Path) -> None:
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise Error("the power curve needs matplotlib: pip install matplotlib") from error
    sizes = _sizes(rows)
    figure = Figure(figsize=(6.4, 3.6), layout="constrained")
    axes = figure.add_subplot()
    for number, probe in enumerate(dict.fromkeys(row["probe"] for row in rows)):
        for key, style in (("first", "--"), ("found", "-")):
            chosen = [[r for r in rows if r["probe"] == probe and r["sigmas"] == s] for s in sizes]
            shares = [sum(row[key] for row in some) / len(some) for some in chosen]
            label = f"{probe}, {key}"
            axes.plot(sizes, shares, f"C{number}o{style}", markersize=3, label=label)
    axes.axhline(0.9, color="0.8", linewidth=0.8)
    axes.set(xlabel="size of the hidden effect [sigmas]", xscale="log", xticks=sizes)
    axes.set(xticklabels=[f"{size:g}" for size in sizes], ylabel="share of flights")
    axes.set(ylim=(0, 1.02))
    axes.minorticks_off()
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(file)
