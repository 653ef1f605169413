# SPDX-License-Identifier: BSD-3-Clause
"""A figure as plotly's own object. Importing this imports plotly."""

from __future__ import annotations

import plotly.graph_objects as graph

from sepcal.reporting.page import Figure

# Plotly's own buttons are there but this one, which uploads the figure: a flight stays here.
WITHOUT = ["sendChartToCloud", "sendDataToCloud"]


class Drawn(graph.Figure):  # type: ignore[misc]
    """Needs no network where it shows itself: Plotly is in it, and not on a server elsewhere."""

    def _repr_html_(self) -> str:
        return str(self.to_html(full_html=False, include_plotlyjs=True))


def to_plotly(figure: Figure) -> Drawn:
    """A plotly.graph_objects.Figure."""
    # An empty template: plotly's own would colour what the figure leaves open.
    own = {"template": graph.layout.Template(), "modebar": {"remove": WITHOUT}}
    return Drawn(figure.data, figure.layout | own)
