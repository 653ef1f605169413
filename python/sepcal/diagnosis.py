# SPDX-License-Identifier: BSD-3-Clause
"""Which physical effect is missing: candidates, ranked, with what each would bring."""

from __future__ import annotations

import json
from dataclasses import dataclass, fields
from typing import Any, Self

from sepcal import _core
from sepcal.pages import Page, Row

COLUMNS = (  # of the table, one number a candidate
    "name",
    "sentence",
    "status",
    "p_value",
    "p_adjusted",
    "p_listed",
    "partial_f",
    "sse_reduction",
    "pse",
    "predicted_drop",
    "held_out_gain",
    "visibility",
)


STANDS_OUT = ("found", "slow_change", "undecided")


@dataclass(frozen=True)
class EffectFinding:
    """What a flight says about one candidate; None where a number is undefined."""

    name: str  # what add() takes
    sentence: str  # in plain words
    drivers: list[str]  # channels
    estimate: dict[str, float | None]  # by coefficient, of one step from the fit, or of a fit
    standard_error: dict[str, float | None]  # in the noise model with the effect, or the fit's
    is_fitted: bool  # they are those of a fit with the effect
    unit: dict[str, str]
    shapes: dict[str, float]  # of a scan: {"bias_step.t0": 41.2}
    p_value: float  # for itself, corrected for its scan
    log10_p: float  # of the same, which may be too small for a float
    p_adjusted: float  # after Holm: for the verdict
    p_listed: float  # after Benjamini & Hochberg: for the list
    outputs: list[str]  # that it can reach: all where they share parameters
    # As stepwise regression has it, residuals taken for white: sums of squares over `outputs`, each
    # in units of its RMSE in the fit.
    partial_f: float | None
    sse: float | None  # without it
    sse_reduction: float | None  # by orthogonal functions: what it takes of sse
    pse: float | None  # predicted square error, SSE/N + 2 s2max p/N
    pse_without: float | None
    predicted_drop: float | None  # of the RMSE over these outputs, 1 - after / before
    held_out_gain: float | None  # the same on rows left out
    held_out_before: float | None  # RMSE of rows left out
    held_out_after: float | None
    held_out_passed: bool  # the mean gain of a block exceeds its standard error
    share_after_selection: float  # of the estimates, allowing for the effect's choice
    held_out_interleaved: bool  # blocks in between, not whole segments, were left out
    held_out_refitted: bool  # by real fits with it and without, not by one step
    excuse: float | None  # how many times too far noise would have to wander to look like it
    visibility: float  # below 0.05 the flight can't show at least a part of it
    absorbed_by: dict[str, float]  # how far ignoring it shifts each parameter
    status: str  # "found", "slow_change", "undecided", "not_seen", "cannot_be_seen"
    beside: str  # the first found: "equivalent", "fades", "counts"; "untried" of others

    @property
    def in_words(self) -> str:
        """The status as tables show it; "not held out" and "too small" are sure, yet refused."""
        if self.status == "not_seen" and self.p_adjusted < _core.SIGNIFICANT_BELOW:
            if not self.held_out_passed:
                return "not held out"
            if self.held_out_gain is not None and self.held_out_gain < _core.LEAST_GAIN:
                return "too small"
        return {
            "found": "found",
            "slow_change": "slow change",
            "undecided": "undecided",
            "not_seen": "not seen",
        }.get(self.status, "can't be seen")

    @property
    def beside_in_words(self) -> str:
        """What becomes of it beside the first found, as tables show it."""
        return {"equivalent": "as good instead", "fades": "fades", "counts": "counts too"}.get(
            self.beside, ""
        )


@dataclass(frozen=True)
class Injection:
    """An effect that was put into the measurements, to see whether it would have been found."""

    effect: str
    sizes: list[float]
    found: bool  # itself, or it would do as well as what was
    rank: int | None  # from 1, the first where it would do as well; None: the flight can't show it
    p_adjusted: float
    estimate: dict[str, float | None]


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis(Page):
    """A verdict and the ranked candidates. `print(diagnosis)` shows the table."""

    _shown = (
        *("name", "status", "p_adjusted", "predicted_drop", "held_out_gain", "visibility"),
        *("partial_f", "pse"),
    )

    verdict: str  # "adequate", "effect_missing", "slow_change", "unexplained"
    advice: dict[str, Any]  # effect to add, None where none; withheld: why not another one
    pairs: list[str]  # two causes at once that explain it as well as anything, best first
    sentence: str  # the verdict in one sentence
    rmse: float | None  # over all outputs, in their unit
    noise_floor: float | None  # innovations alone
    correlation_time: float  # over which the residual goes together [s]
    wanders: dict[str, dict[str, Any]]  # how far errors were let wander: size, unit
    work: dict[str, int]  # candidates screened, tested, calibrated; models refitted
    left_undone: list[str]  # steps for which there was no time
    pse: str  # what bounds the noise of the effects' pse: "sidpac" var(z)/2, "classic" var(z)
    effects: list[EffectFinding]  # best first
    residual: dict[str, dict[str, Any]]  # by output: rmse, lag_one, ljung_box_p, noise, floor
    where: list[dict[str, Any]]  # by segment and output
    unexplained: dict[str, Any]  # of offsets: p_value, p_adjusted, significant, where, windows
    unlogged: list[dict[str, Any]]  # causes that follow no channel: kind, sentence, outputs, when
    limits: dict[str, dict[str, Any]]  # by port: the smallest slow effect that would have shown
    missing_channels: list[str]  # not logged, and could explain what is left
    injected: Injection | None
    status: str  # of the calibration, repeated
    message: str
    notes: list[str]  # one line each, for people
    json: str
    text: str  # what print() shows: the app's page
    explained: str  # the same with the whole message, as by the apps' --explain

    @classmethod
    def _of(cls, diagnosed: _core.Diagnosed) -> Self:
        read = json.loads(diagnosed.json)
        names = {field.name for field in fields(cls)}
        values = {name: value for name, value in read.items() if name in names}
        values["effects"] = [EffectFinding(**effect) for effect in read["effects"]]
        injected = read.get("injected")
        values["injected"] = Injection(**injected) if injected else None
        return cls(
            **values,
            notes=diagnosed.notes,
            json=diagnosed.json,
            text=diagnosed.text,
            explained=diagnosed.explained,
        )

    @property
    def found(self) -> list[EffectFinding]:
        """Those of the effects that were found, best first."""
        return [effect for effect in self.effects if effect.status == "found"]

    @property
    def explanations(self) -> list[str]:
        """What stands first and what would do as well instead; none where nothing stands out."""
        first = [e.name for e in self.effects[:1] if e.status in STANDS_OUT]
        return [*first, *self.list_beside("equivalent")]

    def list_beside(self, beside: str) -> list[str]:
        """The names of those that stand so beside the first: "equivalent", "fades" or "counts"."""
        return [effect.name for effect in self.effects if effect.beside == beside]

    def __getitem__(self, name: str) -> EffectFinding:
        """The candidate of that name. Raises Error where it was not tried."""
        for effect in self.effects:
            if effect.name == name:
                return effect
        raise _core.Error(f"there is no candidate '{name}' in this diagnosis")

    def to_json(self) -> str:
        """The JSON that the app's diagnose writes."""
        return self.json

    def to_dict(self) -> dict[str, Any]:
        """The same as a dictionary; None where a number is undefined."""
        read: dict[str, Any] = json.loads(self.json)
        return read

    def _summary(self) -> str:
        names = ", ".join(effect.name for effect in self.found)
        return f"{self.verdict}{': ' * bool(names)}{names}, {len(self.effects)} candidates"

    def _rows(self) -> list[Row]:
        return [{name: getattr(effect, name) for name in COLUMNS} for effect in self.effects]
