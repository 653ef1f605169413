# SPDX-License-Identifier: BSD-3-Clause
"""A model of your own in Python: four tables and at(), z = A(u, xi2) xi1 + b(u, xi2) + v."""

import hashlib
import inspect
import math
import os
from collections import namedtuple
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from sepcal import _core
from sepcal.columns import Array
from sepcal.models import Model

Unit: TypeAlias = str
Bounded: TypeAlias = tuple[Unit, float | None, float | None]  # unit, lower, upper; None: open
Table: TypeAlias = (
    Mapping[str, Unit | Bounded]
    | Sequence[tuple[str, Unit] | tuple[str, Unit, float | None, float | None]]
)
Row: TypeAlias = tuple[str, str, float, float]  # name, unit, lower, upper

TABLES = ("inputs", "outputs", "linear", "nonlinear")
OPEN = (-math.inf, math.inf)


class SeparableModel(Protocol):
    """The interface of a model of your own, which sepcal.fit() takes.

        >>> class WindBox:
        ...     inputs = {"v": "m/s", "psi": "rad"}
        ...     outputs = {"vn": "m/s", "ve": "m/s"}
        ...     linear = {"k": "1", "w_n": "m/s", "w_e": "m/s"}
        ...     nonlinear = {"delta": ("rad", -0.5, 0.5)}
        ...
        ...     def at(self, u, xi2):
        ...         A = np.zeros((len(u.v), 2, 3))
        ...         A[:, 0, 0] = u.v * np.cos(u.psi + xi2[0])
        ...         A[:, 1, 0] = u.v * np.sin(u.psi + xi2[0])
        ...         A[:, 0, 1] = A[:, 1, 2] = 1.0
        ...         return A, np.zeros((len(u.v), 2))
        ...
        >>> psi = np.linspace(0.0, 6.0, 40)
        >>> data = {"v": np.full(40, 20.0), "psi": psi}
        >>> data |= {"vn": 20.0 * np.cos(psi + 0.1) + 3.0, "ve": 20.0 * np.sin(psi + 0.1)}
        >>> fit = sepcal.fit(WindBox(), data, noise={"vn": 0.1, "ve": 0.1})
        >>> round(fit["delta"].value, 6), round(fit["w_n"].value, 6)
        (0.1, 3.0)

    The tables are {name: unit}, and {name: (unit, lower, upper)} for a parameter with bounds, which
    every nonlinear parameter that is sampled needs (None: open); or lists of (name, unit) and
    (name, unit, lower, upper). Columns of the data go by the names of inputs and outputs. A table
    of parameters may be empty.

    Where the model has a method derivatives(u, xi2), it gives dA (N, n_z, n_1, n_2) and
    db (N, n_z, n_2), the derivatives of A and b with respect to xi2; the first fit compares them
    with the values. Without it sepcal takes differences of fourth order: four calls of at() more
    a nonlinear parameter.
    """

    @property
    def inputs(self) -> Table:
        """u, n_u > 0 of them."""

    @property
    def outputs(self) -> Table:
        """z, n_z > 0."""

    @property
    def linear(self) -> Table:
        """xi1, n_1."""

    @property
    def nonlinear(self) -> Table:
        """xi2, n_2."""

    def at(self, u: Any, xi2: Array, /) -> tuple[ArrayLike, ArrayLike]:  # noqa: ANN401
        """A and b of N rows, some block of the data: a function of these rows and xi2 alone.

        It must not keep anything from one call to the next: blocks are asked for in any order, by
        several threads. Its exceptions end the fit and reach its caller.

        Args:
            u: A named tuple of the inputs' columns, each of shape (N,): u.v, u[0], v, psi = u. A
                name that is no Python identifier has its place alone.
            xi2: The nonlinear parameters, (n_2,), in the table's order.

        Returns:
            A (N, n_z, n_1) and b (N, n_z), real numbers. NaN where a sample has no answer at this
            xi2; that point is then avoided.
        """


class OwnModel(Model):
    """A SeparableModel as one of sepcal's own: its tables, and evaluate() to try it out.

    sepcal.fit() makes it where it is given a SeparableModel.

    Args:
        definition: The model.

    Raises:
        Error: A table or at() is missing, a table is of another form, empty or has a name twice.

    Example:
        >>> class Line:
        ...     inputs, outputs = {"v": "m/s"}, {"z": "m/s"}
        ...     linear, nonlinear = {"k": "1"}, {}
        ...     def at(self, u, xi2):
        ...         return u.v[:, None, None], np.zeros((len(u.v), 1))
        ...
        >>> v = np.linspace(10.0, 20.0, 50)
        >>> model = sepcal.OwnModel(Line())
        >>> A, b = model.evaluate({"v": v}, {})
        >>> A.shape, b.shape
        ((50, 1, 1), (50, 1))
    """

    runs_in_python = True

    def __init__(self, definition: SeparableModel) -> None:
        self.definition = definition
        check_parts(definition, (*TABLES, "at"), "sepcal model", SeparableModel)
        tables = [to_rows(f"{self._owner}.{part}", getattr(definition, part)) for part in TABLES]
        _check_sizes(self._owner, *tables)
        names = [name for name, *_ in tables[0]]
        columns = namedtuple("Inputs", names, rename=True)  # type: ignore[misc]

        def try_at(u: object, xi2: Array) -> object:
            with np.errstate(all="ignore"):
                return definition.at(u, xi2)

        functions = _core.PythonFunctions(
            gather=columns._make,
            at=definition.at,
            try_at=try_at,
            derivatives=getattr(definition, "derivatives", None),
        )
        source = source_of(definition)
        super().__init__(_core.python_model(self._owner, tables, functions, source))

    @property
    def _owner(self) -> str:
        return type(self.definition).__name__

    def __reduce__(self) -> tuple[Any, ...]:
        return OwnModel, (self.definition,)

    def __repr__(self) -> str:
        return f"OwnModel({self.definition!r})"


def source_of(definition: object) -> tuple[str, str]:
    """FILE.py:CLASS as the command line takes it, and the file's SHA-256; empty where unknown."""
    kind = type(definition)
    if kind.__module__.partition(".")[0] == "sepcal":
        return f"sepcal:{kind.__name__}", ""
    try:
        file = inspect.getsourcefile(kind)
        if file is None or "<" in kind.__qualname__:
            return "", ""
        digest = hashlib.sha256(Path(file).read_bytes()).hexdigest()
    except (OSError, TypeError):  # typed at a prompt
        return "", ""
    path = os.path.relpath(file)
    return f"{os.path.basename(file) if path.startswith('..') else path}:{kind.__name__}", digest


def check_parts(
    definition: object, parts: Sequence[str], kind: str, protocol: type, module: str = "sepcal"
) -> None:
    """Raises Error for a class in place of an object, and for what is missing of a protocol."""
    if isinstance(definition, type):
        raise _core.Error(
            f"{definition.__name__} is a class; give an object of it, {definition.__name__}()"
        )
    missing = [part for part in parts if not hasattr(definition, part)]
    if missing:
        raise _core.Error(
            f"{type(definition).__name__} is no {kind}: it has no {', '.join(missing)}; "
            f"help({module}.{protocol.__name__}) says what one has"
        )


def _check_sizes(
    owner: str, inputs: list[Row], outputs: list[Row], linear: list[Row], nonlinear: list[Row]
) -> None:
    """Raises Error where nothing goes in, comes out or is estimated."""
    if not inputs:
        raise _core.Error(
            f"{owner} has no inputs; give one, by which at() sees how many rows it gets"
        )
    if not outputs:
        raise _core.Error(f"{owner} has no outputs; name what is measured")
    if not linear and not nonlinear:
        raise _core.Error(f"{owner} has no parameters; name what is estimated, linear or nonlinear")
    check_bounds_of(owner, [*inputs, *outputs])


def check_bounds_of(owner: str, rows: Sequence[Row]) -> None:
    """Raises Error where one of these, which are no parameters, has bounds."""
    for name, *_, lower, upper in rows:
        if (lower, upper) != OPEN:
            raise _core.Error(f"{owner}: '{name}' is no parameter and can't have bounds; drop them")


def to_rows(owner: str, table: Table) -> list[Row]:
    """The rows of a table. Raises Error naming the entry that is none."""
    entries: Any = table if isinstance(table, Sequence) else [table]
    if isinstance(table, Mapping):
        entries = [
            (name, *entry) if isinstance(entry, tuple | list) else (name, entry)
            for name, entry in table.items()
        ]
    return [_to_row(owner, entry) for entry in entries]


def _to_row(owner: str, entry: Sequence[object]) -> Row:
    lower, upper = OPEN
    match entry:
        case (str(name), str(unit)):
            pass
        case (str(name), str(unit), float() | int() | None as low, float() | int() | None as high):
            lower = lower if low is None else float(low)
            upper = upper if high is None else float(high)
        case _:
            raise _core.Error(
                f"{owner}: {entry!r} is no quantity; a table is {{name: unit}} or, for parameters, "
                "{name: (unit, lower, upper)}"
            )
    if not lower < upper:
        raise _core.Error(
            f"{owner}: the bounds of '{name}', {lower:g} and {upper:g}, leave no room; the lower "
            "must be below the upper"
        )
    return name, unit, lower, upper
