# SPDX-License-Identifier: BSD-3-Clause
"""The words that every plot() takes; what draws is sepcal.plotting, imported when it is asked."""

from __future__ import annotations

from typing import Literal, TypeAlias

Backend: TypeAlias = Literal["plotly", "matplotlib"] | str
Theme: TypeAlias = Literal["light", "dark"] | str
