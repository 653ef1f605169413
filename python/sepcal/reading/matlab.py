# SPDX-License-Identifier: BSD-3-Clause
"""MATLAB's .mat files: version 5 to 7 by SciPy, 7.3, which is HDF5, by h5py.

Variables of one length are a table, a struct is a table or has some, and what MATLAB keeps in
objects of its own (table, timetable, timeseries, datetime) no one else can read.
"""

from __future__ import annotations

import zlib
from typing import Any

import numpy as np

from sepcal import _core
from sepcal.reading import hdf5
from sepcal.reading.extras import load
from sepcal.reading.limits import Budget
from sepcal.reading.rates import join
from sepcal.reading.table import Table
from sepcal.reading.trees import Tree, tables_in

MAGIC = b"MATLAB 5.0 MAT-file"
MAGIC_73 = b"MATLAB 7.3 MAT-file"
HEADER = 128
COMPRESSED = 15
CHUNK = 2**20
INSTEAD = (
    "it holds objects of MATLAB alone (a table, timetable or timeseries); save plain arrays: "
    "s = table2struct(T, 'ToScalar', true); save('log.mat', '-struct', 's')"
)


def read(file: str, chosen: str | None) -> Table:
    """The table. Raises Error for what is damaged, too large or holds none."""
    with open(file, "rb") as opened:
        start = opened.read(len(MAGIC))
    tree, has_objects = _of_version_73(file) if start == MAGIC_73 else _of_version_5(file)
    tables = tables_in(tree)
    if not tables and has_objects:
        raise _core.Error(f"{file}: {INSTEAD}")
    return join(file, tables, chosen)


def _of_version_5(file: str) -> tuple[Tree, bool]:
    scipy_io = load("scipy.io", file, "a .mat file")
    _check_sizes(file)
    try:
        found = scipy_io.loadmat(
            file, struct_as_record=True, squeeze_me=True, chars_as_strings=True
        )
    except MemoryError:
        raise
    except Exception as error:  # what SciPy raises of damage is of any kind
        raise _core.Error(f"{file}: the .mat file is damaged or cut off: {error}") from error
    objects = [v for v in found.values() if type(v).__name__ == "MatlabOpaque"]
    tree = {name: v for name, v in found.items() if not name.startswith("__")}
    return _plain(tree, 0), bool(objects) or "None" in found


def _check_sizes(file: str) -> None:
    """Unpacks each variable in pieces, which are counted and thrown away."""
    budget = Budget(file)
    with open(file, "rb") as opened:
        head = opened.read(HEADER)
        order = ">" if head[126:128] == b"MI" else "<"
        while len(tag := opened.read(8)) == 8:
            kind, size = np.frombuffer(tag, f"{order}u4")
            unpacker = zlib.decompressobj() if kind == COMPRESSED else None
            left = int(size)
            while left > 0 and (piece := opened.read(min(left, CHUNK))):
                left -= len(piece)
                if unpacker is None:
                    budget.take(len(piece), "a variable")
                    continue
                while piece:
                    try:
                        unpacked = unpacker.decompress(piece, CHUNK)
                    except zlib.error as error:
                        raise _core.Error(
                            f"{file}: the .mat file is damaged or cut off: {error}"
                        ) from error
                    budget.take(len(unpacked), "a variable")
                    piece = unpacker.unconsumed_tail


def _plain(value: Any, depth: int) -> Any:  # noqa: ANN401
    """Structs as mappings, columns as arrays; what is neither as an empty array."""
    if depth > hdf5.DEEPEST:
        return np.empty(0)
    if isinstance(value, dict):
        found = {name: _plain(part, depth + 1) for name, part in value.items()}
        return {name: part for name, part in found.items() if isinstance(part, dict) or part.size}
    if isinstance(value, np.void) and value.dtype.names:
        return _plain({name: value[name] for name in value.dtype.names}, depth)
    if type(value).__name__ in ("MatlabOpaque", "MatlabFunction", "spmatrix") or not isinstance(
        value, np.ndarray
    ):
        return np.empty(0)
    if value.dtype.names:
        if value.ndim == 0:
            return _plain({name: value[()][name] for name in value.dtype.names}, depth)
        if value.ndim == 1:  # an array of structs: a row each
            return _plain({name: _rows_of(value[name]) for name in value.dtype.names}, depth)
        return np.empty(0)
    if value.dtype.kind == "O" and value.ndim == 0:
        return _plain(value[()], depth)
    return value if value.dtype.kind in "fiubOUS" and value.ndim in (1, 2) else np.empty(0)


def _rows_of(cells: np.ndarray) -> np.ndarray:
    """One number or text a struct, of those that have it."""
    if all(np.size(cell) == 1 for cell in cells):
        return np.array([np.ravel(cell)[0] for cell in cells])
    return np.empty(0)


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
        return None
    values = reader.values_of(dataset)
    return None if values is None else np.squeeze(values.T)


def _text(reader: hdf5.Reader, dataset: Any) -> object:  # noqa: ANN401
    """A cell's text or number; None of what is neither."""
    if dataset.attrs.get("MATLAB_class") == b"char":
        codes = reader.values_of(dataset)
        return None if codes is None else "".join(map(chr, codes.T.ravel().astype(int)))
    values = reader.values_of(dataset)
    return float(values.ravel()[0]) if values is not None and values.size == 1 else None
