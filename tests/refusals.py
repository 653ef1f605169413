# SPDX-License-Identifier: BSD-3-Clause
"""How sepcal says no: one line that names the culprit."""

from __future__ import annotations

from collections.abc import Callable

import pytest

import sepcal


def refuse(work: Callable[[], object], *words: str) -> None:
    """`work` raises sepcal.Error, one line with all of `words` in it."""
    with pytest.raises(sepcal.Error) as caught:
        work()
    message = str(caught.value)
    assert "\n" not in message
    for word in words:
        assert word in message
