# SPDX-License-Identifier: BSD-3-Clause
"""One recorded flight through check, fit, compare, diagnose, add, and its halves, in print."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import sepcal
from sepcal.fit_options import FitOptions
from sepcal.models import Model

NEXT_AT_MOST = 4  # steps of advice that are followed
WAYS = (
    "standard_error",
    "standard_error_white",
    "standard_error_noise_model",
    "standard_error_blocks",
)


@dataclass(frozen=True)
class Study:
    """A file, how it is fitted, and effects that are added though no `next:` names them."""

    title: str
    file: str
    model: Model
    unit: str = ""
    options: FitOptions = field(default_factory=lambda: FitOptions())
    extra: Sequence[str] = ()


@dataclass(frozen=True)
class Step:
    """An effect added: RMSE of rows held out, and of the half that a fit of the other predicts."""

    effect: str
    advised: bool
    held_out: tuple[float, float]  # before, after
    other_half: tuple[float, float]

    @property
    def harmed(self) -> bool:
        """Whether rows held out, by the gate's blocks or by the halves, got worse."""
        return any(after > before for before, after in (self.held_out, self.other_half))


@dataclass
class Told:
    """What came of a study."""

    steps: list[Step] = field(default_factory=list)
    diagnoses: int = 0
    withheld: int = 0


def examine(study: Study, folder: Path) -> Told:
    """Prints everything of one recording; what its advice came to. A refusal is printed."""
    print(f"\n=== {study.title}: {study.file}")
    told = Told()
    try:
        flight = sepcal.read_csv(folder / study.file)
    except sepcal.Error as error:
        print(f"refused: {tell(error, folder)}")
        return told
    checked = sepcal.check(study.model, flight)
    for note in checked.notes:
        print(f"check, {note.concern}: {note.found}\n    so: {note.effect}\n    do: {note.advice}")
    if checked.refused:
        print(f"refused: {tell(checked.refused, folder)}")
        return told
    base = sepcal.fit(study.model, flight, **study.options)
    print_fit(base)
    print_comparison(base)
    print_halves(study, flight)
    first = follow_advice(study, base, told)
    followed = [step.effect for step in told.steps]
    for effect in dict.fromkeys([*first, *study.extra]):
        if effect not in followed:
            add(study, base, effect, told, advised=False)
    return told


def tell(message: object, folder: Path) -> str:
    """A message without the folder's name."""
    return str(message).replace(f"{folder}/", "")


def print_fit(fitted: sepcal.Calibration) -> None:
    """The status in sentences, and every estimate with its standard errors by three ways."""
    print(f"fit of {fitted.rows} rows: {fitted.status}, RMSE {rmse(fitted):.4g}")
    for sentence in filter(None, fitted.message.split("; ")):
        print(f"    {sentence}")
    for name in fitted.names:
        parameter = fitted[name]
        if not parameter.fixed:
            errors = (getattr(parameter, way) for way in WAYS)
            believed, white, noise_model, blocks = (f"{error:.2g}" for error in errors)
            print(
                f"    {name:9} {parameter.value:10.4g} +- {believed:8} (white {white}, noise model "
                f"{noise_model}, blocks {blocks}) {parameter.unit} {parameter.remark}"
            )


def rmse(fitted: sepcal.Calibration, flight: sepcal.Flight | None = None) -> float:
    """Over all outputs, of the flight fitted or of another, in the outputs' unit."""
    return float(np.sqrt(np.mean(fitted.compare(flight).residuals ** 2)))


def print_comparison(base: sepcal.Calibration) -> None:
    """Neighbouring residuals, and the three channels that explain most of them."""
    compared = base.compare()
    lags = ", ".join(f"{whole.output} {whole.lag_one:.2f}" for whole in compared.overall)
    print(f"compare: neighbouring residuals correlate: {lags}")
    for channel in compared.channels[:3]:
        shares = 100 * channel.share_line, 100 * channel.share_smooth
        print(
            f"    {channel.driver} of {channel.output}: %.0f %% a line, %.0f %% a spline" % shares
        )


def print_halves(study: Study, flight: sepcal.Flight) -> None:
    """Both halves' estimates, and their differences over the standard errors by every way."""
    halves = [sepcal.fit(study.model, half, **study.options) for half in halve(flight)]
    print(f"halves: {halves[0].status} and {halves[1].status}")
    ratios: dict[str, list[float]] = {way: [] for way in WAYS}
    for name in halves[0].names:
        one, two = (half[name] for half in halves)
        if one.fixed:
            continue
        for way in WAYS:
            ratios[way].append(
                (one.value - two.value) / np.hypot(*(getattr(p, way) for p in (one, two)))
            )
        said = [f"{p.value:.4g} +- {p.standard_error:.2g} {p.remark}".rstrip() for p in (one, two)]
        print(f"    {name}: {said[0]} and {said[1]}: {abs(ratios[WAYS[0]][-1]):.1f} errors apart")
    for way, values in ratios.items():
        known = np.abs([value for value in values if np.isfinite(value)])
        if known.size:
            print(
                f"    over {way}: median {np.median(known):.2f}, largest {known.max():.2f}, "
                f"{np.sum(known < 1.96)} of {known.size} within 1.96"
            )


def halve(flight: sepcal.Flight) -> tuple[sepcal.Flight, sepcal.Flight]:
    """The first and the second half of the rows."""
    middle = flight.rows // 2

    def take(rows: slice) -> sepcal.Flight:
        columns = {header: flight[header][rows] for header in flight.columns}
        return sepcal.Flight(columns, flight.maneuvers[rows] or None, flight.name)

    return take(slice(middle)), take(slice(middle, None))


def follow_advice(study: Study, base: sepcal.Calibration, told: Told) -> list[str]:
    """Adds what `next:` names, and again; the effect that the first diagnosis puts first."""
    first: list[str] = []
    current = base
    for step in range(NEXT_AT_MOST):
        found = current.diagnose()
        told.diagnoses += 1
        print_diagnosis(found)
        told.withheld += len(found.advice.withheld)
        if step == 0:
            first = [effect.name for effect in found.found[:1]]
        effect = found.advice.effect
        if effect is None:
            break
        current = add(study, current, effect, told, advised=True)
    return first


def print_diagnosis(found: sepcal.Diagnosis) -> None:
    """The verdict, the candidates that matter, the groups, and what to add or why not."""
    print(f"diagnose: {found.verdict}: {found.sentence}")
    print(f"    {len(found.found)} found of {len(found.effects)}, floor {found.noise_floor:.3g}")
    for effect in found.effects[:6]:
        shares = [100 * share for share in (effect.predicted_drop, effect.held_out_gain)]
        print(
            f"    {effect.name}: {effect.in_words}, log10 p {effect.log10_p:.1f}, predicted "
            f"{shares[0]:.1f} %, held out {shares[1]:.1f} %, visibility {effect.visibility:.2f}"
        )
    for group in ("equivalent", "fades", "counts"):
        print(f"    {group}: {', '.join(found.list_beside(group)) or '-'}")
    print(f"    pairs: {', '.join(found.pairs) or '-'}")
    for reason in found.advice.withheld:
        print(f"    not to be added: {reason}")
    print(f"    next: {found.advice.effect or '-'}")


def add(
    study: Study, current: sepcal.Calibration, effect: str, told: Told, *, advised: bool
) -> sepcal.Calibration:
    """The calibration with the effect; prints and keeps what it came to."""
    better = current.add(effect)
    entry = better.history[-1]
    held_out = entry.held_out_before or np.nan, entry.held_out_after or np.nan
    before = [past.effect for past in current.history]
    other_half = (
        predict_halves(study, current, before),
        predict_halves(study, current, [*before, effect]),
    )
    print(
        f"add {effect} ({'advised' if advised else 'not advised'}): "
        f"{entry.rmse_before:.4g} -> {entry.rmse_after:.4g}, promised "
        f"{100 * (entry.predicted_drop or np.nan):.1f} %, held out {held_out[0]:.4g} -> "
        f"{held_out[1]:.4g}, other half {other_half[0]:.4g} -> {other_half[1]:.4g}; {better.status}"
    )
    for sentence in filter(None, better.message.split("; ")):
        print(f"    {sentence}")
    moved = [
        f"{name} {current[name].value:.4g} -> {better[name].value:.4g}" for name in current.names
    ]
    print(f"    {', '.join(moved)}")
    told.steps.append(Step(effect, advised, held_out, other_half))
    return better


def predict_halves(study: Study, of: sepcal.Calibration, effects: Sequence[str]) -> float:
    """RMSE of each half by the fit of the other, with these effects; NaN where a fit is refused."""
    assert of.flight
    one, two = halve(of.flight)
    options = study.options | FitOptions(effects=effects)
    try:
        errors = [
            rmse(sepcal.fit(study.model, a, **options), b) for a, b in ((one, two), (two, one))
        ]
    except sepcal.Error as error:
        print(f"    halves with {'+'.join(effects)}: {error}")
        return float("nan")
    return float(np.sqrt(np.mean(np.square(errors))))
