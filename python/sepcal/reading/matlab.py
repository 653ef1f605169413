# SPDX-License-Identifier: BSD-3-Clause
"""MATLAB's .mat files: versions 5 to 7, and 7.3, which is HDF5.

Variables of one length are a table, a struct is a table or has some, and what MATLAB keeps in
objects of its own (table, timetable, timeseries, datetime) no one else can read.
"""

from __future__ import annotations

import re
from typing import Any, Literal

import numpy as np

from sepcal import _core
from sepcal.reading import hdf5
from sepcal.reading.extras import load
from sepcal.reading.matlab_5 import read_variables
from sepcal.reading.rates import join_tables
from sepcal.reading.table import Table
from sepcal.reading.trees import UNITS_OF, Tree, tables_in

MAGIC = b"MATLAB 5.0 MAT-file"
MAGIC_73 = b"MATLAB 7.3 MAT-file"
ORDERS_4: tuple[tuple[Literal["little", "big"], int], ...] = (("little", 0), ("big", 1000))
SPARSE_4 = 2  # the last digit of a matrix's kind; 0 numbers, 1 a text
NAME_4 = re.compile(rb"[A-Za-z]\w*\0")
INSTEAD = (
    "it holds objects of MATLAB alone (a table, timetable or timeseries); save plain arrays: "
    "s = table2struct(T, 'ToScalar', true); save('log.mat', '-struct', 's')"
)


def looks_like_version_4(start: bytes) -> bool:
    """Whether a file begins as those of version 4 do, which have no magic number.

    Five integers: the kind of the first matrix, its sizes, whether it is complex, its name's length
    with the NUL behind it; then the name.
    """
    name = NAME_4.match(start[20:])
    for order, machine in ORDERS_4:
        kind, _, _, is_complex, length = (
            int.from_bytes(start[at : at + 4], order) for at in range(0, 20, 4)
        )
        is_kind = machine <= kind < machine + 60 and kind % 10 <= SPARSE_4
        if is_kind and is_complex in (0, 1) and name is not None and len(name.group()) == length:
            return True
    return False


def read(file: str, chosen: str | None) -> Table:
    """The table. Raises Error for what is damaged, too large or holds none."""
    with open(file, "rb") as opened:
        start = opened.read(len(MAGIC))
    if start == MAGIC_73:
        tree, has_objects = _of_version_73(file)
    else:
        variables, has_objects = read_variables(file)
        tree = _plain(variables)
    tables = tables_in(tree)
    if not tables and has_objects:
        raise _core.Error(f"{file}: {INSTEAD}")
    return join_tables(file, tables, chosen)


def _plain(value: dict[str, Any]) -> Tree:
    """Structs and columns; single texts and numbers are none, but for units."""
    found: dict[str, np.ndarray | Tree] = {}
    for name, part in value.items():
        if isinstance(part, dict):
            found[name] = _plain(part)
        elif isinstance(part, str) and name.lower() in UNITS_OF:
            found[name] = np.array(part)
        elif isinstance(part, np.ndarray) and part.ndim in (1, 2):
            found[name] = part
    return found


def _of_version_73(file: str) -> tuple[Tree, bool]:
    h5py = load("h5py", file, "a .mat file of version 7.3")
    try:
        with h5py.File(file, "r") as opened:
            reader = hdf5.Reader(file, h5py)
            has_objects = "#subsystem#" in opened
            return _of_group(reader, opened, opened, 0), has_objects
    except _core.Error:
        raise
    except Exception as error:  # what h5py raises of damage is of any kind
        raise _core.Error(f"{file}: the .mat file is damaged or cut off: {error}") from error


def _of_group(reader: hdf5.Reader, root: Any, group: Any, depth: int) -> Tree:  # noqa: ANN401
    if depth > hdf5.DEEPEST:
        return {}
    found: dict[str, Any] = {}
    for name, node in reader.nodes_of(group):
        if name in ("#refs#", "#subsystem#") or "MATLAB_object_decode" in node.attrs:
            continue
        if isinstance(node, reader.h5py.Group):
            found[name] = _of_group(reader, root, node, depth + 1)
        elif (values := _of_dataset(reader, root, node)) is not None:
            found[name] = values
    return found


def _of_dataset(reader: hdf5.Reader, root: Any, dataset: Any) -> np.ndarray | None:  # noqa: ANN401
    """As MATLAB has it, whose rows and columns HDF5 has the other way round."""
    if dataset.attrs.get("MATLAB_empty", 0):
        return None
    if dataset.dtype.kind == "O" and reader.h5py.check_ref_dtype(dataset.dtype) is not None:
        if dataset.size > 100_000:
            return None
        texts = [_text(reader, root[one]) for one in dataset[()].T.ravel() if one]
        return np.array(texts, dtype=object) if all(t is not None for t in texts) else None
    if dataset.attrs.get("MATLAB_class") == b"char":
        is_unit = dataset.name.rpartition("/")[2].lower() in UNITS_OF
        return np.array(_text(reader, dataset)) if is_unit else None
    values = reader.values_of(dataset)
    return None if values is None else np.squeeze(values.T)


def _text(reader: hdf5.Reader, dataset: Any) -> object:  # noqa: ANN401
    """A cell's text or number; None of what is neither."""
    if dataset.attrs.get("MATLAB_class") == b"char":
        codes = reader.values_of(dataset)
        return None if codes is None else "".join(map(chr, codes.T.ravel().astype(int)))
    values = reader.values_of(dataset)
    return float(values.ravel()[0]) if values is not None and values.size == 1 else None
