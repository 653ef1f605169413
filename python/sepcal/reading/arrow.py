# SPDX-License-Identifier: BSD-3-Clause
"""Parquet, and Arrow's files and streams (Feather), by pyarrow; Arrow's tables in memory."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

import numpy as np

from sepcal import _core
from sepcal.reading.arrow_sizes import check_buffers
from sepcal.reading.extras import load
from sepcal.reading.limits import Budget
from sepcal.reading.table import Table
from sepcal.reading.units import with_unit

PARQUET, ARROW_FILE, ARROW_STREAM = b"PAR1", b"ARROW1", b"\xff\xff\xff\xff"
BATCH = 65_536


def read_parquet(file: str, _: str | None) -> Table:
    """The table. Raises Error for what is damaged or too large."""
    parquet = load("pyarrow.parquet", file, "Parquet")
    pa = load("pyarrow", file, "Parquet")
    budget = Budget(file)
    try:
        with parquet.ParquetFile(file) as opened:
            schema = opened.schema_arrow
            names = [f.name for f in schema if _is_taken(pa, f.type)]
            texts = [f.name for f in schema if f.name in names and pa.types.is_string(f.type)]
            budget.take(8 * len(names) * opened.metadata.num_rows, "the table")
        with parquet.ParquetFile(file, read_dictionary=texts) as opened:
            for group in range(opened.metadata.num_row_groups):
                for column in range(opened.metadata.num_columns):
                    part = opened.metadata.row_group(group).column(column)
                    if part.path_in_schema in names:
                        Budget(file).take(part.total_uncompressed_size, f"'{part.path_in_schema}'")
            batches = opened.iter_batches(BATCH, columns=names, use_threads=False)
            return of_batches(pa, schema, _counted(batches, Budget(file)))
    except _core.Error:
        raise
    except Exception as error:  # what pyarrow raises of damage is of many kinds
        raise _core.Error(
            f"{file}: the Parquet file is damaged or cut off: {_say(error)}"
        ) from error


def read_arrow(file: str, _: str | None) -> Table:
    """The table of an IPC file (Feather) or stream. Raises Error as read_parquet() does."""
    pa = load("pyarrow", file, "Arrow")
    budget = Budget(file)
    with open(file, "rb") as opened:
        is_file = opened.read(len(ARROW_FILE)) == ARROW_FILE
    try:
        check_buffers(file, budget)
        with pa.OSFile(file) as opened:
            if is_file:
                reader = pa.ipc.open_file(opened)
                batches = [reader.get_batch(i) for i in range(reader.num_record_batches)]
            else:
                reader = pa.ipc.open_stream(opened)
                batches = list(reader)
        for batch in batches:
            batch.validate(full=True)
        return of_batches(pa, reader.schema, batches)
    except _core.Error:
        raise
    except Exception as error:
        raise _core.Error(f"{file}: the Arrow file is damaged or cut off: {_say(error)}") from error


def of_table(table: Any) -> Table:  # noqa: ANN401
    """Reads a pyarrow Table or RecordBatch in memory."""
    pa = load("pyarrow", "flight", "an Arrow table")
    if isinstance(table, pa.RecordBatch):
        table = pa.Table.from_batches([table])
    return of_batches(pa, table.schema, table.to_batches())


def of_batches(pa: Any, schema: Any, batches: Iterable[Any]) -> Table:  # noqa: ANN401
    """Columns of all batches together; a field's metadata may tell its unit."""
    every = list(batches)
    found = Table()
    for field in schema:
        if not _is_taken(pa, field.type):
            found.left_out.append(field.name)
            continue
        parts = [_values(pa, batch.column(field.name)) for batch in every]
        values = np.concatenate(parts) if parts else np.empty(0)
        told = field.metadata or {}
        unit = next((told[key] for key in (b"unit", b"units") if key in told), "")
        found.add(with_unit(_name(field.name, schema), unit), values)
    return found


def _name(name: str, schema: Any) -> str:  # noqa: ANN401
    """Pandas' unnamed index of dates is the time."""
    return "time" if name == "__index_level_0__" and _is_index(name, schema) else name


def _is_index(name: str, schema: Any) -> bool:  # noqa: ANN401
    try:
        told = json.loads((schema.metadata or {}).get(b"pandas", b"{}"))
        return isinstance(told, dict) and name in told.get("index_columns", ())
    except (ValueError, RecursionError, TypeError):
        return False


def _is_taken(pa: Any, kind: Any) -> bool:  # noqa: ANN401
    """Numbers, dates, spans, and texts, which may hold either."""
    types = pa.types
    if types.is_dictionary(kind):
        kind = kind.value_type
    return any(
        is_such(kind)
        for is_such in (
            *(types.is_integer, types.is_floating, types.is_boolean, types.is_decimal),
            *(types.is_timestamp, types.is_date, types.is_duration),
            *(types.is_string, types.is_large_string, types.is_string_view, types.is_time),
        )
    )


def _values(pa: Any, column: Any) -> np.ndarray:  # noqa: ANN401
    """A batch's column, NaN or NaT where it is null."""
    kind = column.type
    if pa.types.is_dictionary(kind):
        words = _values(pa, column.dictionary)
        at = column.indices.to_numpy(zero_copy_only=False)
        missing = np.isnan(at) if at.dtype.kind == "f" else np.zeros(len(at), dtype=bool)
        if not len(words):
            return np.full(len(at), None, dtype=object)
        taken = words[np.where(missing, 0, at).astype(np.int64)]
        if missing.any():
            taken = taken.astype(object)
            taken[missing] = None
        return np.asarray(taken)
    if pa.types.is_decimal(kind) or pa.types.is_float16(kind):
        column = column.cast(pa.float64())
    elif pa.types.is_time(kind):
        unit = kind.unit
        whole = column.cast(pa.int64() if unit in ("us", "ns") else pa.int32())
        values = np.asarray(whole.to_numpy(zero_copy_only=False), dtype=np.float64)
        return values * {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[unit]
    elif pa.types.is_timestamp(kind) or pa.types.is_date(kind):
        column = column.cast(pa.timestamp("ns"))
    elif pa.types.is_boolean(kind):
        column = column.cast(pa.uint8())
    return np.asarray(column.to_numpy(zero_copy_only=False))


def _counted(batches: Iterable[Any], budget: Budget) -> Iterable[Any]:
    """The size that was in fact unpacked, whatever had been declared."""
    for batch in batches:
        budget.take(batch.nbytes, "the table")
        yield batch


def _say(error: Exception) -> str:
    return " ".join(str(error).split())[:200]
