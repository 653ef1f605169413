# SPDX-License-Identifier: BSD-3-Clause
"""DataFrames in HDF5 as pandas' to_hdf() lays them, "fixed" or "table": blocks of columns."""

from __future__ import annotations

import io
import pickle
import re
from typing import Any, NoReturn, Protocol

import numpy as np

DATES = re.compile(r"datetime64(?:\[(s|ms|us|ns))?")


class Reader(Protocol):
    """The function that reads a dataset (sepcal.reading.hdf5)."""

    def values_of(self, dataset: Any) -> np.ndarray | None:  # noqa: ANN401
        """Its values."""


def pandas_frame(reader: Reader, group: Any) -> dict[str, Any]:  # noqa: ANN401
    """The columns of a "fixed" group by name, dates of the index as "time"."""
    found: dict[str, Any] = {}
    index = reader.values_of(group["axis1"])
    if index is not None:
        found |= _index_of(index, group["axis1"].attrs.get("kind", b""))
    number = 0
    while f"block{number}_values" in group:
        items = reader.values_of(group[f"block{number}_items"])
        values = reader.values_of(group[f"block{number}_values"])
        if items is not None and values is not None and values.ndim == 2:
            found |= dict(zip(map(_text, items.ravel()), values.T, strict=False))
        number += 1
    return found


def pandas_table(reader: Reader, dataset: Any) -> dict[str, Any]:  # noqa: ANN401
    """The same of a "table", whose blocks' names stand in attributes."""
    found: dict[str, Any] = {}
    values = reader.values_of(dataset)
    for name in dataset.dtype.names or () if values is not None else ():
        column = values[name]  # type: ignore[index]
        kind = dataset.attrs.get(f"{name}_kind", b"")
        if name == "index":
            found |= _index_of(column, kind)
        elif column.ndim == 2:
            names = _names_in(kind, column.shape[1])
            found |= {
                names[i] if names else f"{name}[{i}]": part for i, part in enumerate(column.T)
            }
        else:
            found[name] = column
    return found


def _index_of(index: np.ndarray, kind: object) -> dict[str, np.ndarray]:
    """Dates as "time", another index as such, and none that pandas counts itself."""
    dates = DATES.search(_text(kind))
    if dates and index.dtype.kind == "i":
        return {"time": index.astype(np.int64).view(f"M8[{dates[1] or 'ns'}]")}
    counted = np.array_equal(index, np.arange(len(index)))
    return {} if counted or index.dtype.kind not in "fiu" else {"index": index}


def _text(value: object) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


class _ListsAlone(pickle.Unpickler):
    """Reads lists of texts, and refuses to load anything that could run."""

    def find_class(self, module: str, name: str) -> NoReturn:
        raise pickle.UnpicklingError(f"{module}.{name} is no list of names")


def _names_in(pickled: object, count: int) -> list[str]:
    """The names of a block's columns; none where there are not as many texts."""
    if not isinstance(pickled, bytes):
        return []
    try:
        names = _ListsAlone(io.BytesIO(pickled)).load()
    except Exception:  # of damage, anything
        return []
    is_such = isinstance(names, list) and all(isinstance(name, str) for name in names)
    return names if is_such and len(names) == count else []
