# SPDX-License-Identifier: BSD-3-Clause
"""Rows as a Parquet file's bytes, and numbers as its cells and JSON have them."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from sepcal import _core


def table_bytes(rows: Sequence[Mapping[str, Any]]) -> bytes:
    """A row each; a column that one of them lacks is empty there. Raises Error without pyarrow."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise _core.Error("pyarrow is not installed: pip install sepcal[fleet]") from None
    names = dict.fromkeys(name for row in rows for name in row)
    table = pyarrow.table({name: [row.get(name) for row in rows] for name in names})
    content = io.BytesIO()
    parquet.write_table(table, content)
    return content.getvalue()


def or_none(value: float) -> float | None:
    """None where a number is not defined."""
    return float(value) if np.isfinite(value) else None
