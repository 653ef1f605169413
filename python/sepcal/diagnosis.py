# SPDX-License-Identifier: BSD-3-Clause
"""Which physical effect is missing: candidates, ranked, with what each would bring."""

from __future__ import annotations

import json
from typing import Any, Literal

from sepcal import _core
from sepcal._core import EffectFinding
from sepcal.arguments import checked
from sepcal.pages import Page, Row
from sepcal.plots import Backend, Theme

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


@checked
class Diagnosis(Page, _core.Diagnosis):
    """A verdict and the ranked candidates. `print(diagnosis)` shows the table.

    Example:
        >>> flight = sepcal.datasets.load("pitot")
        >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
        >>> found = base.diagnose()
        >>> found["wind[altitude_m]"].status, found.verdict
        ('found', 'effect_missing')
    """

    _shown = (
        *("name", "status", "p_adjusted", "predicted_drop", "held_out_gain", "visibility"),
        *("partial_f", "pse"),
    )

    @property
    def found(self) -> list[EffectFinding]:
        """Those of the effects that were found, best first."""
        return [effect for effect in self.effects if effect.status == "found"]

    @property
    def explanations(self) -> list[str]:
        """The first effect and those that would do as well; none if nothing stands out."""
        first = [e.name for e in self.effects[:1] if e.status in STANDS_OUT]
        return [*first, *self.list_beside("equivalent")]

    def list_beside(self, beside: str) -> list[str]:
        """The names of those that stand so beside the first: "equivalent", "fades" or "counts".

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> found = base.diagnose()  # what depends on altitude looks much the same here
            >>> "airspeed_bias[altitude_m]" in found.list_beside("equivalent")
            True
        """
        return [effect.name for effect in self.effects if effect.beside == beside]

    def __getitem__(self, name: str) -> EffectFinding:
        """The candidate of that name. Raises Error where it was not tried."""
        for effect in self.effects:
            if isinstance(name, str) and effect.name == name:
                return effect
        raise _core.Error(f"there is no candidate '{name}' in this diagnosis")

    def to_json(self) -> str:
        """The JSON that the app's diagnose writes.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> base.diagnose().to_json().startswith("{")
            True
        """
        return self.json

    def to_dict(self) -> dict[str, Any]:
        """The same as a dictionary; None where a number is undefined.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> base.diagnose().to_dict()["verdict"]
            'effect_missing'
        """
        read: dict[str, Any] = json.loads(self.json)
        return read

    def plot(
        self,
        what: Literal["candidates", "where"] | str = "candidates",
        *,
        backend: Backend = "plotly",
        theme: Theme = "light",
    ) -> Any:  # noqa: ANN401
        """Draws the first twelve candidates, or where the model fails.

        Args:
            what: "candidates", what each takes off the error; "where", the error by stretch of the
                flight and output.
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; the library is not installed.

        Example:
            >>> flight = sepcal.datasets.load("pitot")
            >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
            >>> drawn = base.diagnose().plot(backend="matplotlib")
            >>> drawn.savefig(folder / "candidates.png")
        """
        from sepcal.plotting import as_figure, choose
        from sepcal.plotting.of_fits import picture_diagnosis

        choose(what, ("candidates", "where"))
        return as_figure(picture_diagnosis(self, what), backend, theme)

    def _summary(self) -> str:
        names = ", ".join(effect.name for effect in self.found)
        return f"{self.verdict}{': ' * bool(names)}{names}, {len(self.effects)} candidates"

    def _rows(self) -> list[Row]:
        return [{name: getattr(effect, name) for name in COLUMNS} for effect in self.effects]
