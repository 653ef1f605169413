# SPDX-License-Identifier: BSD-3-Clause
"""From what a caller has (arrays, lists, a DataFrame's columns) to what C++ takes: float64 columns.

A C-contiguous float64 array passes as it is, uncopied; everything else is converted once.
"""

import os
from collections.abc import Collection, Iterable, Iterator
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sepcal import _core
from sepcal.arguments import shown
from sepcal.printing import as_utf8

Array: TypeAlias = NDArray[np.float64]

NUMBERS = "fiub"  # kinds of dtype


class Columns(Protocol):
    """Columns by name: a dict of arrays, a pandas DataFrame, a structured array, a Flight."""

    def __iter__(self) -> Iterator[str]:
        """The names."""

    def __getitem__(self, name: str, /) -> ArrayLike:
        """One column, shape (N,)."""


def by_name(data: Columns) -> Columns:
    """Columns by name: the fields of a structured array, else the data as they are.

    Raises Error for the name of a file, and for an array without names.
    """
    if isinstance(data, str | os.PathLike):
        raise _core.Error(f"'{os.fspath(data)}' is the name of a file; give sepcal.read(file)")
    if not isinstance(data, np.ndarray):
        if not hasattr(data, "__getitem__") or isinstance(data, list | tuple | bytes):
            raise _core.Error(f"{shown(data)} has no columns; give them by name, as a dict")
        return data
    if data.dtype.names is None:
        raise _core.Error(
            f"an array of the shape {data.shape} names no columns; give them by name, as a dict"
        )
    return {name: data[name] for name in data.dtype.names}


def to_column(owner: str, name: str, values: ArrayLike) -> Array:
    """The values as a C-contiguous float64 array of shape (N,); the same array where it is one.

    Masked entries become NaN. Raises Error for what is not one-dimensional or holds no numbers;
    `owner` opens the message.
    """
    if isinstance(values, np.ma.MaskedArray):
        array = np.ma.filled(values.astype(np.float64), np.nan)
    else:
        array = np.asarray(values)
    if array.ndim != 1:
        raise _core.Error(
            f"{owner}: column '{name}' has the shape {array.shape}; give one value a row, (N,)"
        )
    if array.dtype.kind not in NUMBERS:
        raise _core.Error(
            f"{owner}: column '{name}' holds {array.dtype}, not numbers; convert it or leave it out"
        )
    return np.require(array, dtype=np.float64, requirements=["C_CONTIGUOUS", "ALIGNED"])


def take_columns(owner: str, columns: Columns, names: Iterable[str]) -> dict[str, Array]:
    """The named columns. Raises Error for one that is missing, listing those that are there."""
    there = list(columns)
    taken = {}
    for name in names:
        if name not in there:
            known = ", ".join(map(str, there)) or "none"
            raise _core.Error(
                f"{owner}: column '{name}' is missing; the data have: {known}; name columns as the "
                "model does, or give a sepcal.Flight"
            )
        taken[name] = to_column(owner, name, columns[name])
    return taken


def take_drivers(
    owner: str, columns: Columns, taken: Collection[str], named: Collection[str]
) -> dict[str, Array]:
    """The columns beside `taken` that may drive an effect: those of numbers.

    Raises Error for one in `named` that holds something else.
    """
    drivers = {}
    for name in columns:
        if name in taken or name == "maneuver":
            continue
        values = np.asarray(columns[name])
        if name in named or (values.ndim == 1 and values.dtype.kind in NUMBERS):
            drivers[name] = to_column(owner, name, columns[name])
    return drivers


def to_labels(labels: Iterable[object]) -> list[str]:
    """One text a row. Raises Error for one that no UTF-8 is of."""
    if isinstance(labels, str) or not isinstance(labels, Iterable):
        raise _core.Error(f"maneuver is {shown(labels)}; give a label a row")
    texts = [str(label) for label in labels]
    for text in set(texts):
        as_utf8("the label", text)
    return texts


def labels_in(columns: Columns) -> list[str]:
    """The column "maneuver"; empty where there is none."""
    return to_labels(columns["maneuver"]) if "maneuver" in set(columns) else []  # type: ignore[arg-type]
