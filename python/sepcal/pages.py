# SPDX-License-Identifier: BSD-3-Clause
"""How a result shows itself: print() as the apps print it, repr() in a line, tables elsewhere."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from sepcal.markup import html, join
from sepcal.printing import in_line

Row = Mapping[str, object]


class Page:
    """A result that the apps print too. `text` is their page."""

    if TYPE_CHECKING:

        @property
        def text(self) -> str:
            """What print() shows: the app's page."""

    _shown: ClassVar[Sequence[str]] = ()  # columns of the small table, among those of _rows()

    def _summary(self) -> str:
        """What the one line of repr() says."""
        raise NotImplementedError

    def _rows(self) -> list[Row]:
        """The result's main table; "name" is its index where there is one."""
        raise NotImplementedError

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return in_line(f"<sepcal.{type(self).__name__} {self._summary()}>")

    def _repr_html_(self) -> str:
        """A small table, for notebooks."""
        head = join("", (html("<th>{}</th>", name.replace("_", " ")) for name in self._shown))
        rows = [
            html(
                "<tr>{}</tr>\n",
                join("", (html("<td>{}</td>", _cell(row[name])) for name in self._shown)),
            )
            for row in self._rows()
        ]
        return html(
            "<table><caption>{}</caption>\n<thead><tr>{}</tr></thead>\n<tbody>\n{}</tbody></table>",
            self._summary(),
            head,
            join("", rows),
        )

    def to_frame(self) -> Any:  # noqa: ANN401
        """The same as a pandas.DataFrame, with every number. Raises ImportError without pandas."""
        try:
            pandas = importlib.import_module("pandas")
        except ImportError:
            raise ImportError("to_frame() needs pandas: pip install pandas") from None
        frame = pandas.DataFrame([dict(row) for row in self._rows()])
        return frame.set_index("name") if "name" in frame.columns else frame


def _cell(value: object) -> str:
    if value is None or value != value:
        return "-"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
