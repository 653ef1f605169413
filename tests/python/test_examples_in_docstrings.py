# SPDX-License-Identifier: BSD-3-Clause
"""Every public function, class and method has an example in its docstring, and all of them run."""

from __future__ import annotations

import doctest
import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import sepcal
from flown_logs import LOGS

pytest.importorskip("plotly", reason="examples draw: pip install sepcal[report]")
pytest.importorskip("matplotlib", reason="examples draw: pip install sepcal[plot]")
pytest.importorskip("pandas", reason="an example makes a frame: pip install sepcal[files]")
pytest.importorskip("scipy", reason="an example asks SciPy: pip install scipy")
pytest.importorskip("pyulog", reason="examples read a log: pip install sepcal[logs]")
pytest.importorskip("pygeomag", reason="an example has the Earth's field: pip install sepcal[logs]")

LOG = "flight.ulg"  # of an autopilot: examples that name it find it in `folder`
# No example is possible, or one would say nothing: an exception is raised and not called; what is
# written for C++ to call; functions that a protocol names and somebody else writes.
WITHOUT = {
    "sepcal.Error",
    "sepcal.reading.read_foreign",
    "sepcal.SeparableModel.at",
    "sepcal.StateModel.at",
    "sepcal.rivals.TwoStepProblem.at",
    "sepcal.rivals.TwoStepProblem.rows",
    "sepcal.triads.Factor.matrix",
    "sepcal.triads.Reference.at",
}


def collect() -> Iterator[doctest.DocTest]:
    """Of every module, each example with numpy, sepcal and a folder."""
    finder = doctest.DocTestFinder(exclude_empty=True)
    for module in list_modules():
        globs = {"np": np, "sepcal": sepcal}
        found = finder.find(module, module.__name__, module, globs)
        yield from (one for one in found if one.examples)


def list_modules() -> Iterator[ModuleType]:
    """All of the package that can be loaded here."""
    for found in pkgutil.walk_packages(sepcal.__path__, "sepcal."):
        if found.name.endswith("__main__"):
            continue
        try:
            yield importlib.import_module(found.name)
        except ImportError:  # of an extra that is not installed
            continue


def list_public() -> dict[str, Any]:
    """By its dotted name each function, class and method that an `__all__` of Python names."""
    public: dict[str, Any] = {}
    seen: set[int] = set()
    modules = [sepcal, *(one for one in list_modules() if "__all__" in vars(one))]
    for module in modules:
        for name in module.__all__:
            at = getattr(module, name)
            is_own = getattr(at, "__module__", "").startswith("sepcal")
            if not (inspect.isclass(at) or inspect.isfunction(at)) or id(at) in seen or not is_own:
                continue
            if at.__module__ in ("sepcal._core", "sepcal._states") and at is not sepcal.Error:
                continue  # what a call gives, compiled: shown where it is given
            seen.add(id(at))
            public[f"{module.__name__}.{name}"] = at
            methods = vars(at) if inspect.isclass(at) else {}
            for method, found in methods.items():
                function = getattr(found, "__func__", found)
                if not method.startswith("_") and inspect.isfunction(function):
                    public[f"{module.__name__}.{name}.{method}"] = function
    return public


PUBLIC = list_public()


@pytest.mark.parametrize("example", [pytest.param(one, id=one.name) for one in collect()])
def test_an_example_says_what_comes_of_it(example: doctest.DocTest, tmp_path: Path) -> None:
    example.globs["folder"] = tmp_path
    if LOG in (example.docstring or ""):
        (tmp_path / LOG).write_bytes(LOGS["new.ulg"]().data())
    runner = doctest.DocTestRunner(verbose=False, optionflags=doctest.NORMALIZE_WHITESPACE)
    said: list[str] = []
    failed, tried = runner.run(example, out=said.append)
    assert tried > 0
    assert failed == 0, "".join(said)


@pytest.mark.parametrize("name", sorted(PUBLIC.keys() - WITHOUT))
def test_what_is_public_has_an_example(name: str) -> None:
    assert ">>>" in (inspect.getdoc(PUBLIC[name]) or "")


def test_what_has_none_is_public() -> None:
    assert PUBLIC.keys() >= WITHOUT
