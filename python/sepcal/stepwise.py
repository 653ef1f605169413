# SPDX-License-Identifier: BSD-3-Clause
"""Diagnosis step by step: what is advised is added, all is fitted and asked again."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from sepcal import _core
from sepcal._core import StepwiseStep
from sepcal.arguments import checked
from sepcal.diagnosis import Diagnosis
from sepcal.options import to_names
from sepcal.pages import Page, Row
from sepcal.plots import Backend, Theme

if TYPE_CHECKING:
    from sepcal import _states

Fitted = TypeVar("Fitted")


@checked
class Stepwise(Page, Generic[Fitted]):
    """Effects added one after another until nothing passed. `print()` shows the steps.

    Attributes:
        fitted: The last fit, with all of them: a Calibration or an AircraftFit.
        steps: In the order in which they were added.
        end: Why no more was: "nothing_found", "most_added", "withheld" (of what passes nothing is
            to be added, as real fits have it), "fit_failed" (that of the next one).
        reason: The same in a sentence.
        diagnosis: The last fit's diagnosis.

    Example:
        >>> flight = sepcal.datasets.load("pitot")
        >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
        >>> steps = base.diagnose(auto=True)
        >>> steps.effects, steps.end
        (['wind[altitude_m]'], 'nothing_found')
    """

    _shown = ("name", "p_adjusted", "partial_f", "predicted_drop", "found_drop", "rmse_after")

    def __init__(self, fitted: Fitted, core: _core.SteppedCalibration | _states.SteppedFit) -> None:
        self.fitted = fitted
        self.steps: list[StepwiseStep] = core.steps
        self.end: str = core.end
        self.reason: str = core.reason
        self.diagnosis = Diagnosis(core.last)
        self.json: str = core.json
        self.explained: str = core.explained
        self._text: str = core.text

    @property
    def text(self) -> str:
        """The app's page, as print() shows it."""
        return self._text

    @property
    def effects(self) -> list[str]:
        """The effects that were added and not dropped, in order."""
        kept: list[str] = []
        for step in self.steps:
            kept = [*(name for name in kept if name not in step.dropped), step.effect]
        return kept

    def to_json(self) -> str:
        """The JSON that the app's diagnose --auto writes with -o: the fit, with the steps.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> base.diagnose(auto=True, most=1).to_json().startswith("{")
            True
        """
        return self.json

    def to_dict(self) -> dict[str, Any]:
        """The same as a dictionary; None where a number is undefined.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> base.diagnose(auto=True, most=1).to_dict()["status"]
            'converged'
        """
        read: dict[str, Any] = json.loads(self.json)
        return read

    def plot(self, *, backend: Backend = "plotly", theme: Theme = "light") -> Any:  # noqa: ANN401
        """Draws the error after every effect that was added, and what was promised as a tick.

        Args:
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; the library is not installed.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> drawn = base.diagnose(auto=True, most=1).plot(backend="matplotlib")
        """
        from sepcal.plotting import as_figure
        from sepcal.plotting.of_fits import picture_stepwise

        return as_figure(picture_stepwise(self), backend, theme)

    def _summary(self) -> str:
        return f"{', '.join(self.effects) or 'nothing'} added; {self.reason}"

    def _rows(self) -> list[Row]:
        return [{"name": step.effect, **step._asdict()} for step in self.steps]


def diagnosis_options(
    *,
    auto: bool,
    most: int | None,
    only: Sequence[str],
    simulations: int,
    seed: int,
    pse: str,
    rule: str,
    error_budget: Mapping[str, float] | None,
    within: float | None,
) -> _core.DiagnosisOptions:
    """Raises Error for choices of diagnose() that can't be, or not together."""
    if simulations < 2 or seed < 0:
        raise _core.Error("simulations must be at least 2, and seed not negative")
    if most is not None and not auto:
        raise _core.Error("most is of auto=True; give both, or leave it out")
    if most is not None and most < 0:
        raise _core.Error(f"most {most} is negative; give at least 1, or leave it out for no limit")
    if within is not None and not within > 0:
        raise _core.Error(f"within {within} is no number of seconds above 0")
    sizes = {str(name): float(size) for name, size in (error_budget or {}).items()}
    for name, size in sizes.items():
        if not 0.0 <= size < math.inf:
            raise _core.Error(f"error_budget: the size of '{name}' is {size}; it must be 0 or more")
    return _core.DiagnosisOptions(
        simulations=simulations,
        seed=seed,
        pse=pse,
        rule=rule,
        only=to_names("only", only),
        error_budget=sizes,
        within=math.inf if within is None else within,
    )


def to_injected(
    inject: Mapping[str, float | Sequence[float]] | None, *, auto: bool
) -> tuple[str, list[float]] | None:
    """The effect that diagnose() injects. Raises Error for several, and together with auto."""
    if inject is not None and not isinstance(inject, Mapping):
        raise _core.Error(f"inject is {inject!r}; give {{effect: size}}")
    try:
        hidden = [
            (name, np.ravel(np.asarray(size, dtype=float)).tolist())
            for name, size in (inject or {}).items()
        ]
    except (TypeError, ValueError):
        raise _core.Error(
            f"inject is {inject!r}; a size is a number, or one a coefficient"
        ) from None
    if any(not math.isfinite(size) for _, sizes in hidden for size in sizes):
        raise _core.Error(f"inject is {inject!r}; sizes must be finite")
    if len(hidden) > 1:
        raise _core.Error("inject takes one effect at a time")
    if hidden and auto:
        raise _core.Error("inject and auto exclude each other: it is not in the flight")
    return hidden[0] if hidden else None
