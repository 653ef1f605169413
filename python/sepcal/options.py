# SPDX-License-Identifier: BSD-3-Clause
"""The keyword arguments of fit(). Their defaults are the engine's own and stand nowhere else."""

import inspect
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, TypeAlias, TypeVar

from sepcal import _core
from sepcal.arguments import Misuse, shown
from sepcal.fit_options import FitOptions

ROWS = {row.name: row for row in _core.option_rows()}
# How a value of a type is written.
SHAPES = {
    "Mapping[str, tuple[float | None, float | None]]": "{name: (lower, upper)}",
    "Mapping[str, tuple[float, float]]": "{name: (mean, standard deviation)}",
    "Mapping[str, str]": "{header: column}",
}
# Of the programs' --effect, ...
APP_NAMES = {
    flag[2:]: row.name for row in ROWS.values() for flag in row.flags
    if flag[2:].replace("-", "_") != row.name
}  # fmt: skip
# Options that choose of a flight's columns and rows.
LOG_CHOICE = tuple(row.name for row in ROWS.values() if row.is_of_log)

Bounds: TypeAlias = Mapping[str, tuple[float | None, float | None]]
Function = TypeVar("Function", bound=Callable[..., Any])


def spelled_out(*, without: Collection[str] = ()) -> Callable[[Function], Function]:
    """A decorator: help() shows every option in the place of **options, with its default.

    Where the docstring's whole entry of **options is FitOptions.__doc__ by name, it becomes what
    FitOptions says of each.
    """

    def spell_out(function: Function) -> Function:
        signature = inspect.signature(function)
        kept = [at for at in signature.parameters.values() if at.kind is not at.VAR_KEYWORD]
        options = [
            inspect.Parameter(
                name, inspect.Parameter.KEYWORD_ONLY, default=default_of(name), annotation=kind
            )
            for name, kind in FitOptions.__annotations__.items()
            if name not in without
        ]
        spelled = signature.replace(parameters=[*kept, *options])
        function.__signature__ = spelled  # type: ignore[attr-defined]
        if function.__doc__ and FitOptions.__doc__:  # none under python -OO
            of_options = inspect.getdoc(FitOptions) or ""
            each = of_options.partition("Attributes:\n")[2].partition("\n\nExample:\n")[0]
            text = inspect.cleandoc(function.__doc__)
            function.__doc__ = text.replace("    **options: FitOptions.", each)
        return function

    return spell_out


def default_of(name: str) -> Any:  # noqa: ANN401
    """The engine's own; None where nothing is set."""
    default = getattr(_core.Options(), name, None)
    return None if isinstance(default, str | Mapping | list) and not default else default


def to_core(options: Mapping[str, Any]) -> _core.Options:
    """The options as C++ takes them. Raises TypeError for an unknown name or a wrong kind."""
    core = _core.Options()
    for name, value in options.items():
        if name not in FitOptions.__annotations__:
            known = ", ".join(FitOptions.__annotations__)
            hint = f"--{name} of the apps is {APP_NAMES[name]}; " if name in APP_NAMES else ""
            raise Misuse(f"fit() has no option '{name}'; {hint}it has: {known}")
        if value is None:
            continue
        try:
            setattr(core, name, dict(value) if isinstance(value, Mapping) else value)
        except _core.Error:
            raise
        except (TypeError, ValueError, OverflowError):
            shape = f"give {form}; " if (form := _shape(ROWS[name])) else ""
            raise Misuse(
                f"fit() can't take {name}={shown(value)}; {shape}help(sepcal.FitOptions) says what "
                "it takes"
            ) from None
    return core


def _shape(row: _core.OptionRow) -> str:
    """How a value is written; empty where any word or number is one."""
    if row.type.startswith("Sequence"):
        return f"[{row.form.partition('[')[0].lower()}, ...]"
    return SHAPES.get(row.type, "")


def open_ends(bounds: Bounds | None) -> dict[str, tuple[float, float]]:
    """(lower, upper) by name, infinite where None."""
    return {
        name: (-math.inf if lower is None else lower, math.inf if upper is None else upper)
        for name, (lower, upper) in (bounds or {}).items()
    }


def log_choices(options: Mapping[str, Any]) -> list[str]:
    """The options given that choose of a flight."""
    nothing: tuple[object, ...] = (None, False, "", [], {}, ())
    given = {name: options.get(name) for name in LOG_CHOICE}
    return [name for name, v in given.items() if v not in nothing or isinstance(v, float)]


def refuse_log_choice(options: Mapping[str, Any]) -> None:
    """Raises Error for an option that chooses of a flight, where there is none."""
    for name in log_choices(options):
        raise _core.Error(f"{name} is for flights; give the data as a sepcal.Flight")


def to_names(argument: str, names: Sequence[str]) -> list[str]:
    """The names. Raises Error for one alone, which would be taken letter by letter."""
    if isinstance(names, str):
        raise _core.Error(f"{argument} is '{names}'; give a list of names, ['{names}']")
    return list(names)
