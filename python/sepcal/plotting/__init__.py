# SPDX-License-Identifier: BSD-3-Clause
"""The report's figures as figure objects of plotly or matplotlib: what plot() of a result gives."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sepcal import _core
from sepcal.arguments import shown
from sepcal.plots import Backend, Theme
from sepcal.plotting.arrange import arrange
from sepcal.plotting.themes import THEMES, recolour
from sepcal.reporting.page import Figure

EXTRAS = {"plotly": "report", "matplotlib": "plot"}  # by backend


def as_figure(figures: Sequence[Figure], backend: Backend, theme: Theme, columns: int = 2) -> Any:  # noqa: ANN401
    """One figure object that holds them all, `columns` a row.

    Args:
        figures: One at least.
        backend: "plotly", a plotly.graph_objects.Figure; "matplotlib", a matplotlib.figure.Figure.
        theme: "light", as on the report, or "dark".
        columns: Number of columns of the grid, if there are several pictures.

    Raises:
        Error: Nothing to draw; a backend or a theme that there isn't; its library is not installed.
    """
    _refuse("backend", backend, tuple(EXTRAS))
    _refuse("theme", theme, THEMES)
    if not figures:
        raise _core.Error("there is nothing to draw: no number in it is finite")
    figure = recolour(figures[0] if len(figures) == 1 else arrange(figures, columns), theme)
    try:
        if backend == "plotly":
            from sepcal.plotting.with_plotly import to_plotly

            return to_plotly(figure)
        from sepcal.plotting.with_matplotlib import to_matplotlib

        return to_matplotlib(figure)
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] != backend:
            raise
        instead = '; or give backend="matplotlib"' if backend == "plotly" else ""
        raise _core.Error(
            f"plot() needs {backend}, which is not installed: "
            f"pip install sepcal[{EXTRAS[backend]}]{instead}"
        ) from None


def _refuse(argument: str, given: object, known: Sequence[str]) -> None:
    """Raises Error for a word that is none of those known."""
    if not isinstance(given, str) or given not in known:
        raise _core.Error(f"{argument} is {shown(given)}; it is {_either(known)}")


def _either(words: Sequence[str]) -> str:
    quoted = [repr(word) for word in words]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} or {quoted[-1]}"


def choose(what: object, pictures: Sequence[str]) -> None:
    """Raises Error where plot() is asked for a picture that the result doesn't have."""
    _refuse("what", what, pictures)
