# SPDX-License-Identifier: BSD-3-Clause
"""Checks arguments: one of the wrong kind is refused in one line that names it."""

from __future__ import annotations

import functools
import inspect
import numbers
import os
import re
import sys
import types
import typing
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any, Literal, TypeVar, Union

import numpy as np

from sepcal import _core
from sepcal.printing import in_line

Thing = TypeVar("Thing", bound=Callable[..., Any])

Found = TypeVar("Found")

SHOWN = 60  # characters of a value
OF_VALUES = (TypeError, ValueError, KeyError, AttributeError, IndexError, OverflowError)
INCOMPATIBLE = re.compile("incompatible (function|constructor) arguments")  # of the compiled
LISTS = (Sequence, Iterable, Collection, list)


class Misuse(_core.Error, TypeError):
    """An Error of an argument's kind or name: a TypeError too, as Python itself calls it."""


class NotInstalled(_core.Error, ImportError):
    """An Error of a library that isn't there: an ImportError too."""


class Missing(_core.Error, KeyError):
    """An Error of a name in brackets: a KeyError too, which mappings promise."""

    def __str__(self) -> str:
        return str(self.args[0])


def found_by(find: Callable[[str], Found], name: object) -> Found:
    """The value under a name. Raises Missing, as `find` says it by a KeyError."""
    if not isinstance(name, str):
        raise Missing(f"{shown(name)} is no name; give a text")
    try:
        return find(name)
    except KeyError as error:
        raise Missing(*error.args) from None


def checked(thing: Thing) -> Thing:
    """A decorator of a function, or of a class for its public methods and its construction.

    What is refused in its own words stays so. Where something else is raised, and an argument is
    not what the annotations say, that argument is to blame; else it is left as it is, as what a
    caller's own function raises.
    """
    if isinstance(thing, type):
        for name, method in list(vars(thing).items()):
            is_public = not name.startswith("_") or name == "__init__"
            if inspect.isfunction(method) and is_public:
                setattr(thing, name, _checked(method, thing.__name__))
        return thing
    return typing.cast(Thing, _checked(thing, ""))


def _checked(function: Callable[..., Any], owner: str) -> Callable[..., Any]:
    signature = inspect.signature(function)
    called = owner if function.__name__ == "__init__" else function.__name__

    @functools.wraps(function)
    def checking(*positional: object, **named: object) -> object:
        try:
            return function(*positional, **named)
        except _core.Error:
            raise
        except OF_VALUES as error:
            _blame(error, positional, named)
            raise

    def _blame(error: Exception, positional: tuple[object, ...], named: dict[str, object]) -> None:
        """Raises Misuse where an argument is to blame."""
        try:
            given = signature.bind(*positional, **named).arguments
        except TypeError as unbound:
            raise Misuse(f"{called}(): {unbound}") from None
        for name, value in given.items():
            parameter = signature.parameters[name]
            if parameter.kind in (parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL):
                continue
            hint = _resolve(function, parameter.annotation)
            if hint is not None and not fits(value, hint):
                raise Misuse(f"{called}(): {name} is {shown(value)}; give {words(hint)}") from error
        if INCOMPATIBLE.search(str(error)):
            plain = {name: at for name, at in given.items() if isinstance(at, int | float | str)}
            told = ", ".join(f"{name}={shown(at)}" for name, at in plain.items())
            raise Misuse(
                f"{called}(): one of these can't be taken: {told or 'what was given'}"
            ) from None

    return checking


def _resolve(function: Callable[..., Any], annotation: object) -> Any:  # noqa: ANN401
    """The type that an annotation means; None where it is of a module that isn't imported."""
    if not isinstance(annotation, str):
        return None if annotation is inspect.Parameter.empty else annotation
    try:
        return eval(annotation, vars(sys.modules[function.__module__]))
    except (NameError, TypeError):
        return None


def fits(value: object, hint: Any) -> bool:  # noqa: ANN401
    """Whether a value is of a kind, as far as can be told without looking at what is in it."""
    origin, within = typing.get_origin(hint), typing.get_args(hint)
    if hint is None or hint is type(None):
        return value is None
    if origin in (Union, types.UnionType):
        return any(fits(value, one) for one in within)
    if origin is Literal:
        return isinstance(value, str)
    if hint is bool:
        return isinstance(value, bool | np.bool_)
    if hint is int:
        return isinstance(value, numbers.Integral) and abs(int(value)) < 2**63
    if hint is float:
        is_number = isinstance(value, numbers.Real)
        return is_number or (isinstance(value, np.ndarray) and value.shape == ())
    if hint is str:
        return isinstance(value, str)
    if origin in LISTS:
        return _fits_list(value, within[0])
    if origin is tuple:
        is_any_length = within[-1] is Ellipsis
        fit = _fits_list(value, within[0])
        return fit and (is_any_length or len(value) == len(within))  # type: ignore[arg-type]
    if origin is Mapping:
        if not isinstance(value, Mapping):
            return False
        return all(fits(k, within[0]) and fits(v, within[1]) for k, v in value.items())
    if origin is os.PathLike or hint is os.PathLike:
        return isinstance(value, os.PathLike)
    if origin is Callable:
        return callable(value)
    return not _is_own(hint) or isinstance(value, hint)


def _is_own(hint: Any) -> bool:  # noqa: ANN401
    """A class of sepcal's results and models; who takes a flight says how one is made."""
    return (
        isinstance(hint, type)
        and hint.__module__.startswith("sepcal")
        and hint.__name__ != "Flight"
        and not getattr(hint, "_is_protocol", False)
    )


def _fits_list(value: object, kind: Any) -> bool:  # noqa: ANN401
    if isinstance(value, str | bytes | Mapping) or not isinstance(value, Iterable):
        return False
    if getattr(value, "ndim", 1) != 1:
        return False
    is_whole = isinstance(value, Sequence) or hasattr(value, "ndim")  # not eaten by a look
    return not is_whole or all(fits(one, kind) for one in value)


def words(hint: Any) -> str:  # noqa: ANN401
    """A kind as people call it."""
    origin, within = typing.get_origin(hint), typing.get_args(hint)
    if origin in (Union, types.UnionType):
        parts = [one for one in within if one is not type(None)]
        if any(one is os.PathLike or typing.get_origin(one) is os.PathLike for one in parts):
            return "the name of a file"
        choice = next((one for one in parts if typing.get_origin(one) is Literal), None)
        said = [words(choice)] if choice is not None else list(dict.fromkeys(map(words, parts)))
        return " or ".join(said)
    if origin is Literal:
        return "one of " + ", ".join(repr(word) for word in within)
    if origin is Mapping:
        return f"{{{words(within[0]).removeprefix('a ')}: {words(within[1]).removeprefix('a ')}}}"
    if origin in LISTS or (origin is tuple and within[-1] is Ellipsis):
        return f"a list, each {words(within[0])}"
    if origin is tuple:
        return f"({', '.join(words(one).removeprefix('a ') for one in within)})"
    named = {float: "a number", int: "a whole number", str: "a text", bool: "True or False"}
    if hint in named:
        return named[hint]
    if origin is Callable:
        return "a function"
    return f"a {getattr(hint, '__name__', str(hint))}"


def shown(value: object) -> str:
    """A value in a few characters: an array or a table by its kind."""
    if isinstance(value, np.ndarray) or hasattr(value, "shape"):
        return f"a {type(value).__name__} of the shape {getattr(value, 'shape', '')}"
    text = in_line(repr(value))
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."
