# SPDX-License-Identifier: BSD-3-Clause
"""How a result shows itself: print() as the apps print it, repr() in a line, tables elsewhere."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from sepcal.arguments import NotInstalled
from sepcal.printing import in_line
from sepcal.tables import table_of

Row = Mapping[str, object]


class Page:
    """A result that the apps print too. `text` is their page."""

    if TYPE_CHECKING:

        @property
        def text(self) -> str:
            """The app's page, as print() shows it."""

    _shown: ClassVar[Sequence[str]] = ()  # columns of the small table, among those of _rows()

    def _summary(self) -> str:
        """The words of repr()'s one line."""
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
        return table_of(self._summary(), self._shown, self._rows())

    def to_frame(self) -> Any:  # noqa: ANN401
        """The same as a pandas.DataFrame, with every number. Raises Error without pandas."""
        try:
            pandas = importlib.import_module("pandas")
        except ImportError:
            raise NotInstalled("to_frame() needs pandas: pip install pandas") from None
        frame = pandas.DataFrame([dict(row) for row in self._rows()])
        return frame.set_index("name") if "name" in frame.columns else frame
