# SPDX-License-Identifier: BSD-3-Clause
"""The study's rates as Markdown tables, and the power curve as a picture."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from measured import measured_line
from sepcal._core import Error
from sepcal.quantiles import upper_limit
from studies.hidden_effects.experiments import StudyOptions

Row = dict[str, Any]
ROOMS = (
    "diagnosis", "effects", "estimation", "noise", "simulation", "flight/catalogue", "flight/verbs",
    "lab/studies/hidden_effects",
)  # fmt: skip
VERDICTS = ("unexplained", "effect_missing", "slow_change", "adequate")


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

{measured_line(ROOMS)}

This page says how often `diagnose` finds a physical effect that the model lacks, and how often it
names one that isn't there. Read it to judge a verdict. This command writes the page:

    {command}

Every row counts simulated flights of two minutes, 400 to 1,200 rows. The simulator shares no code
with the effects. It hides an effect in the flight, a fit without that effect calibrates the probe,
and `diagnose` looks for what is missing. Seeds count from {options.first_seed}.

- **Size.** For an effect of s sigmas, the best fit without it leaves a sum of squares of s^2 times
  the noise variance, in a flight without noise.
- **First.** The true effect ranks first, or `diagnose` names it as an equally good alternative.
- **Found.** The true effect is among those found (p after Holm's correction below 0.05, confirmed
  on rows held out), or is such an alternative.

An effect that changes as slowly as instruments drift, and by less, doesn't count as found at any
size ([how far they drift](diagnosis.md#how-far-instruments-drift)).

![share of flights against size]({picture})"""


def _sizes(rows: list[Row]) -> list[float]:
    return sorted({row["sigmas"] for row in rows})


def _power(rows: list[Row]) -> str:
    sizes = _sizes(rows)
    kinds = sorted({(row["probe"], row["effect"]) for row in rows})

    def cells(chosen: list[Row]) -> list[str]:
        at = [[row for row in chosen if row["sigmas"] == size] for size in sizes]
        return [f"{_share(some, 'first')}/{_share(some, 'found')}" for some in at]

    body = [
        [probe, f"`{effect}`", *cells([r for r in rows if (r["probe"], r["effect"]) == kind])]
        for kind in kinds
        for probe, effect in [kind]
    ]
    body.append(["all", "", *cells(rows)])
    head = ["probe", "hidden", *(f"{size:g} sigmas" for size in sizes)]
    what = "Per cent of the flights in which the effect ranks first / is found, by its size."
    return f"## One effect\n\n{what}\n\n{_table(head, body)}"


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
    head = ["noise", "effect found", "99 % upper limit of its rate", "unexplained"]
    what = "The model is complete, so every effect that is found is a false alarm."
    return f"## Nothing hidden\n\n{what}\n\n{_table(head, body)}"


def _others(rows: dict[str, list[Row]]) -> str:
    def by(experiment: str, key: str) -> Iterable[tuple[str, list[Row]]]:
        for value in dict.fromkeys(row[key] for row in rows[experiment]):
            yield value, [row for row in rows[experiment] if row[key] == value]

    body = []
    for effects, chosen in by("pairs", "effects"):
        what = f"two effects at 30 sigmas: {effects}"
        both = _rate(chosen, lambda row: row["both"] and not row["third"])
        body.append([what, "both added, no third", both])
    decoys = rows["decoys"]
    chosen_decoys = _rate(decoys, lambda row: row["decoys"] > 0)
    body.append(["five decoy channels, nothing hidden", "a decoy found", chosen_decoys])
    for effect, chosen in by("invisible", "effect"):
        what = f"`{effect}`, absorbed by the model"
        body.append([what, "found", _rate(chosen, lambda r: r["status"] == "found")])
        said = _rate(chosen, lambda row: row["status"] == "cannot_be_seen")
        body.append([what, "called invisible", said])
    proxy = rows["proxy"]
    what = "`bias[current_a]` at 10 sigmas, and a voltage that sags with it"
    said = _rate(proxy, lambda row: row["true_stands_first"])
    body.append([what, "the current ranks first or is as good", said])
    body.append([what, "the voltage found", _rate(proxy, lambda row: row["proxy_found"])])
    for effect, chosen in by("unmeasured", "effect"):
        counts = [sum(row["verdict"] == verdict for row in chosen) for verdict in VERDICTS]
        what = f"`{effect}` at 20 sigmas, its channel not logged"
        split = "/".join(map(str, counts))
        body.append([what, f"verdict {'/'.join(VERDICTS)}", f"{split} of {len(chosen)}"])
    slow = rows["slow"]
    what = "a wind that changes by 2 m/s in 250 s, noise 0.15 m/s"
    body.append([what, "first", _rate(slow, lambda row: row["first"])])
    body.append([what, "found", _rate(slow, lambda row: row["found"])])
    return "## Harder questions\n\n" + _table(["flown", "outcome", "flights"], body)


def _promises(rows: list[Row]) -> str:
    kept = [row for row in rows if row.get("promised") is not None]
    if not kept:
        return ""

    def near(row: Row) -> bool:
        return bool(abs(row["promised"] - row["achieved"]) <= 0.05 * abs(row["achieved"]))

    judged = [row for row in kept if row["held_out_before"] is not None]
    body = [
        ["the error falls by the predicted amount, within 5 % of it", _rate(kept, near)],
        [
            "the error on rows held out falls",
            _rate(judged, lambda row: row["held_out_after"] < row["held_out_before"]),
        ],
        [
            "the worst parameter, in standard errors, comes nearer to the truth",
            _rate(kept, lambda row: row["worst_error_after"] < row["worst_error_before"]),
        ],
        [
            "neighbouring residuals correlate less",
            _rate(kept, lambda row: row["lag_one_after"] < row["lag_one_before"]),
        ],
    ]
    what = "`add` was run if the effect that ranked first was the hidden one."
    return f"## After `add`, at 10 sigmas\n\n{what}\n\n{_table(['', 'flights'], body)}"


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
