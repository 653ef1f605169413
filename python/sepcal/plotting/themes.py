# SPDX-License-Identifier: BSD-3-Clause
"""A figure in the light colours that it is made in, or in dark ones."""

from __future__ import annotations

from typing import Any

from sepcal.reporting.colours import DARK
from sepcal.reporting.page import Figure

THEMES = ("light", "dark")


def recolour(figure: Figure, theme: str) -> Figure:
    """The figure in the colours of a theme, one of THEMES."""
    if theme == "light":
        return figure
    return Figure(_swap(figure.data), _swap(figure.layout), figure.name)


def _swap(value: Any) -> Any:  # noqa: ANN401
    """The same, colours exchanged; keys named text are left, whatever they say."""
    if isinstance(value, dict):
        return {key: at if key == "text" else _swap(at) for key, at in value.items()}
    if isinstance(value, list):
        return [_swap(at) for at in value]
    return DARK.get(value, value) if isinstance(value, str) else value
