# SPDX-License-Identifier: BSD-3-Clause
"""Work on a worker: the function on a few items. Its exceptions travel as answers.

So an exception of a future is the executor's own, and says that work was lost.
"""

from __future__ import annotations

import pickle
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from sepcal._core import Error

Item = TypeVar("Item")
Result = TypeVar("Result")


@dataclass(frozen=True)
class Answer(Generic[Result]):
    """The results up to the first item that failed, and how it did."""

    results: list[Result]
    error: Exception | None
    traceback: str


def call_all(
    function: Callable[[Item], Result], items: Sequence[Item], ticket: int
) -> Answer[Result]:
    """The function of every item; the ticket makes the call different from any other.

    A function with a method together() takes the items at once.
    """
    del ticket
    if (together := getattr(function, "together", None)) is not None:
        return Answer(together(items), None, "")
    results: list[Result] = []
    for item in items:
        try:
            results.append(function(item))
        except Exception as error:
            return Answer(results, _to_travel(error), traceback.format_exc())
    return Answer(results, None, "")


def call_pickled(call: bytes, ticket: int) -> Answer[Any]:
    """call_all() of a pickled function and its items."""
    function, items = pickle.loads(call)
    return call_all(function, items, ticket)


def raise_again(answer: Answer[Result]) -> None:
    """Raises the function's exception, if there is one, with the worker's traceback as a note."""
    if answer.error is None:
        return
    if answer.error.__traceback__ is None:  # it was pickled
        answer.error.add_note(f"on the worker:\n{answer.traceback}")
    raise answer.error


def _to_travel(error: Exception) -> Exception:
    """The exception, or an Error that says the same where it doesn't survive pickling."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return Error(f"{type(error).__name__}: {error}")
    return error
