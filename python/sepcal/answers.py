# SPDX-License-Identifier: BSD-3-Clause
"""Answers of a model in Python for N points: arrays, or nested lists of arrays and numbers."""

from __future__ import annotations

from collections import namedtuple
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sepcal import _core
from sepcal.columns import NUMBERS, Array


@dataclass(frozen=True)
class Layout:
    """A model's tables and options, as places and sizes."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    states: int
    linear: int
    bounds: Array  # (2, n_p), of p
    noises: int
    own_noise: tuple[int, ...] | None  # states that a noise is of; None: noise_input() says
    discrete: bool
    hold: bool
    substeps: int
    measured: tuple[int, ...]
    acts: NDArray[np.bool_]  # (n_z, n_1)
    from_start: tuple[int, ...]  # linear ones whose columns are counted from the start
    linear_dynamic: tuple[int, ...]  # places in p
    summed: bool  # trajectories are added up, as the model is linear in its state


class CheckedModel:
    """A state model's functions; what they give is an array of its own, of the shape asked for."""

    def __init__(self, owner: str, definition: Any, layout: Layout) -> None:  # noqa: ANN401
        self._owner, self._definition, self._layout = owner, definition, layout
        inputs: Any = namedtuple("Inputs", layout.inputs, rename=True)  # type: ignore[misc]
        outputs: Any = namedtuple("Outputs", layout.outputs, rename=True)  # type: ignore[misc]
        self._u, self._z = inputs._make, outputs._make

    def rate(self, x: Array, u: Array, p: Array) -> Array:
        """The rates x' (n_x, N), or x at the next row where time is discrete."""
        name = "next" if self._layout.discrete else "rate"
        answer = getattr(self._definition, name)(x, self._u(u), p)
        return fill(f"{self._owner}: {name}()", answer, x.shape, "(n_x, N)")

    def affine(self, x: Array, u: Array, p: Array) -> tuple[Array, Array]:
        """A (n_z, n_1, N), zero where a parameter doesn't act, and b (n_z, N)."""
        answer = self._definition.at(x, self._u(u), p)
        if not isinstance(answer, tuple) or len(answer) != 2:
            kind = type(answer).__name__
            raise _core.Error(f"{self._owner}: at() gives {kind}; return a tuple of A and b")
        shape = (len(self._layout.outputs), self._layout.linear, x.shape[1])
        A = fill(f"{self._owner}: A of at()", answer[0], shape, "(n_z, n_1, N)")
        b = fill(f"{self._owner}: b of at()", answer[1], (shape[0], shape[2]), "(n_z, N)")
        A[~self._layout.acts] = 0.0
        return A, b

    def noise_input(self, x: Array, u: Array, p: Array) -> Array:
        """G (n_x, n_w, N)."""
        shape = (self._layout.states, self._layout.noises, x.shape[1])
        if self._layout.own_noise is None:
            answer = self._definition.noise_input(x, self._u(u), p)
            return fill(f"{self._owner}: noise_input()", answer, shape, "(n_x, n_w, N)")
        G = np.zeros(shape)
        for column, state in enumerate(self._layout.own_noise):
            G[state, column] = 1.0
        return G

    def start(self, u: Array, z: Array) -> Array | None:
        """x(0), (n_x,), from the first row's u and z, NaN where missing; None: it isn't said."""
        if not hasattr(self._definition, "start"):
            return None
        answer = self._definition.start(self._u(u), self._z(z))
        return fill(f"{self._owner}: start()", answer, (self._layout.states,), "(n_x,)")


def fill(what: str, given: object, shape: tuple[int, ...], axes: str) -> Array:
    """`given` as float64 of `shape`, in its own memory: an array, or lists of numbers and of (N,).

    Raises Error for what has another length or is no real number; `what` opens the message.
    """
    out = np.empty(shape)
    _fill(out, given, f"{what} takes {shape}, {axes}")
    return out


def _fill(out: Array, given: Any, what: str) -> None:  # noqa: ANN401
    try:
        values = np.asarray(given)  # of lists all of whose entries have one shape, too
    except ValueError:
        values = np.empty(())
    if values.shape == out.shape or out.ndim <= 1:
        if values.dtype.kind not in NUMBERS:
            raise _core.Error(f"{what}; it was given {values.dtype}, not real numbers")
        if values.shape not in ((), out.shape):
            raise _core.Error(f"{what}; an entry has the shape {values.shape}")
        out[...] = values
        return
    try:
        length = len(given)
    except TypeError:
        raise _core.Error(f"{what}; it was given {type(given).__name__}") from None
    if length != len(out):
        raise _core.Error(f"{what}; it was given {length} in place of {len(out)}")
    for row, entry in zip(out, given, strict=True):
        _fill(row, entry, what)
