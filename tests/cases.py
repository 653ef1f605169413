# SPDX-License-Identifier: BSD-3-Clause
"""Cases of a test with parameters, of which each takes long."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def but_first_slow(cases: Iterable[Any]) -> list[Any]:
    """The first as it is, the others with the mark `slow`."""
    first, *others = cases
    values = [case if isinstance(case, tuple) else (case,) for case in others]
    return [first, *(pytest.param(*value, marks=pytest.mark.slow) for value in values)]
