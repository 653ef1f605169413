# SPDX-License-Identifier: BSD-3-Clause
"""An effect of your own in Python: a function of the record that returns columns."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from sepcal import _core
from sepcal.arguments import Misuse, checked, shown
from sepcal.columns import NUMBERS, Array

Function: TypeAlias = Callable[[Mapping[str, Array]], ArrayLike | Mapping[str, ArrayLike]]

# As C++ takes one: name, port, unit, and the function of the columns (N,) and n_z.
CoreEffect: TypeAlias = tuple[
    str, str | None, str, Callable[[dict[str, Array], int], Array | list[tuple[str, Array]]]
]


@checked
@dataclass(frozen=True)
class Effect:
    """A physical effect that sepcal doesn't know; fit(..., effects=[effect]) adds it to a model.

        motor = sepcal.Effect("motor", lambda log: log["current_a"] ** 2, port="bias")
        vortex = sepcal.Effect("vortex", lambda log: {"s": swirl(log["alpha"])}, unit="m/s")

    It is evaluated again on every flight that the calibration meets; what it takes from a flight,
    a mean say, would mean something else on the next.

    Attributes:
        name: Letters, digits and "_"; its parameters are called name.component.
        function: Takes a read-only mapping of the record's columns, each of shape (N,): the model's
            inputs and outputs, a flight's quantities in SI units and fields in uT under names
            without a unit ("time", "alpha"), other columns under their headers. With a port it
            gives the driver, (N,), which each of the port's components follows with a coefficient
            of its own; without one, {component: column of the outputs (N, n_z)}, or (N,) where
            there is one output. Exceptions reach the caller as they are.
        port: Where it enters, as in `port[driver]`: "wind", "bias"; of a model that is no probe,
            any linear parameter or input. None: on the outputs.
        unit: Unit of a coefficient.

    Raises:
        Error: A name that is none, or a function that can't be called; when it is used, a port that
            there isn't, a name that is taken, columns of another shape or not finite.

    Example:
        >>> flight = sepcal.datasets.load("pitot")
        >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
        >>> gust = sepcal.Effect("gust", lambda log: np.sin(log["time"]), port="wind")
        >>> added = base.add(gust)
        >>> abs(added["gust.n"].value) < 3 * added["gust.n"].standard_error  # there is none
        True
    """

    name: str
    function: Function
    port: str | None = None
    unit: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.isidentifier():
            raise _core.Error(
                f"{self.name!r} can't name an effect; use letters, digits and '_', as in 'motor'"
            )
        if not callable(self.function):
            raise _core.Error(
                f"effect {self.name}: {self.function!r} is no function; give one of the record"
            )

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        """Itself: nothing in it changes."""
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        try:
            pickle.dumps(self.function)
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            raise _core.Error(
                f"effect {self.name}: its function can't be pickled; define it with def at the top "
                "of a module"
            ) from error
        return partial(Effect, self.name, self.function, port=self.port, unit=self.unit), ()

    def _evaluate(self, columns: dict[str, Array], n_z: int) -> Array | list[tuple[str, Array]]:
        """The driver (N,) or, without a port, the outputs' columns (N, n_z) by component."""
        rows = len(next(iter(columns.values())))
        answer = self.function(_Record(columns))
        if self.port is not None:
            return self._to_array("its function gives", answer, [(rows,)])
        if not isinstance(answer, Mapping) or not answer:
            raise _core.Error(
                f"effect {self.name}: its function gives {type(answer).__name__}; without a port "
                "it gives {component: columns of the outputs}"
            )
        shapes: list[tuple[int, ...]] = [(rows, n_z)]
        if n_z == 1:
            shapes.append((rows,))
        for component in answer:
            if not isinstance(component, str) or not component:
                raise _core.Error(
                    f"effect {self.name}: {component!r} can't name a component; use a text, as 's'"
                )
        return [
            (component, self._to_array(f"component '{component}' is", values, shapes))
            for component, values in answer.items()
        ]

    def _to_array(self, what: str, values: object, shapes: list[tuple[int, ...]]) -> Array:
        """The values as float64 of the first of these shapes. Raises Error where it is none."""
        array = np.asarray(values)
        if array.dtype.kind not in NUMBERS:
            kind = type(values).__name__ if array.dtype.kind == "O" else array.dtype
            raise _core.Error(
                f"effect {self.name}: {what} {kind}, not numbers; give an array of real numbers"
            )
        if array.shape not in shapes:
            wanted = "rows by outputs" if len(shapes[0]) > 1 else "one value a row"
            raise _core.Error(
                f"effect {self.name}: {what} an array of shape {array.shape}; this record takes "
                f"{shapes[0]}, {wanted}"
            )
        return array.astype(np.float64).reshape(shapes[0])


class _Record(Mapping[str, Array]):
    """The arguments that an effect's function gets."""

    def __init__(self, columns: dict[str, Array]) -> None:
        self._columns = columns

    def __getitem__(self, name: str) -> Array:
        if name not in self._columns:
            known = ", ".join(self._columns)
            raise KeyError(f"column '{name}' is missing; the record has: {known}")
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)


def to_core_effects(effects: Sequence[str | Effect]) -> list[CoreEffect]:
    """Those of the caller's own as C++ takes them."""
    return [
        (effect.name, effect.port, effect.unit, effect._evaluate)
        for effect in effects
        if isinstance(effect, Effect)
    ]


def given_effects(options: Mapping[str, Any]) -> Sequence[str | Effect]:
    """Those of a fit's options; none where none are given."""
    effects = options.get("effects")
    return () if effects is None else effects


def name_effects(effects: Sequence[str | Effect]) -> list[str]:
    """Their names. Raises Error for what has none."""
    is_list = isinstance(effects, Iterable) and not isinstance(effects, str | Mapping)
    if not is_list or not all(isinstance(effect, str | Effect) for effect in effects):
        raise Misuse(
            f"fit() can't take effects={shown(effects)}; give a list of names and sepcal.Effect"
        )
    return [effect.name if isinstance(effect, Effect) else effect for effect in effects]
