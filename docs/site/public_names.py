# SPDX-License-Identifier: BSD-3-Clause
"""The public names of Python and C++, and which of them nothing documents.

python docs/site/public_names.py XML, the folder that Doxygen wrote: prints those without a word and
ends with 1 where there are some. Public in Python is what a module's `__all__` names, with the
methods and properties of its classes; of what is compiled, a field's name and unit may say all. In
C++ it is what a header outside detail/ declares in namespace sepcal: classes, structs, enums,
functions, constants and other types.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import sepcal


@dataclass(frozen=True)
class Name:
    """A public name of Python."""

    module: str  # that offers it
    name: str
    kind: str  # of autodoc's directives: "class", "function", "data", "module"
    sentence: str
    members: tuple[str, ...] = ()  # of a module, what it offers

    @property
    def dotted(self) -> str:
        """As people write it."""
        return f"{self.module}.{self.name}"


def list_modules() -> Iterator[Any]:
    """The package, and what is public below it and can be loaded here."""
    yield sepcal
    for found in pkgutil.walk_packages(sepcal.__path__, "sepcal."):
        if found.name.endswith("__main__"):
            continue
        try:
            module = importlib.import_module(found.name)
        except ImportError:  # of an extra that is not installed
            continue
        if "__all__" in vars(module):
            yield module


def list_python() -> list[Name]:
    """Each once, under the first module that offers it; __version__ is not among them."""
    names: list[Name] = []
    seen: set[int] = set()
    for module in list_modules():
        for name in module.__all__:
            at = getattr(module, name)
            if id(at) in seen or name.startswith("__"):
                continue
            kind = kind_of(at)
            if kind != "data":
                seen.add(id(at))
            sentence = (
                (inspect.getdoc(at) or "").split("\n\n")[0] if kind != "data" else f"`{at!r}`"
            )
            members = tuple(at.__all__) if kind == "module" else ()
            names.append(Name(module.__name__, name, kind, " ".join(sentence.split()), members))
    return names


def kind_of(at: object) -> str:
    """By autodoc's words."""
    if inspect.ismodule(at):
        return "module"
    if inspect.isclass(at):
        return "class"
    return "function" if callable(at) else "data"


def undocumented_python() -> Iterator[str]:
    """Names, and methods and properties of classes, without a docstring."""
    for name in list_python():
        at = getattr(importlib.import_module(name.module), name.name)
        if name.kind != "data" and not inspect.getdoc(at):
            yield name.dotted
        if name.kind != "class" or at.__module__.startswith("sepcal._"):
            continue
        for member, found in vars(at).items():
            is_code = isinstance(found, property | classmethod | staticmethod) or callable(found)
            if not member.startswith("_") and is_code and not inspect.getdoc(found):
                yield f"{name.dotted}.{member}"


def is_documented(node: ET.Element) -> bool:
    """Whether Doxygen found a word on it."""
    told = (node.find(place) for place in ("briefdescription", "detaileddescription"))
    return any("".join(at.itertext()).strip() for at in told if at is not None)


def undocumented_cpp(xml: Path) -> Iterator[str]:
    """A function is documented where one of its overloads is."""
    index = ET.parse(xml / "index.xml").getroot()
    for compound in index:
        kind, name = compound.get("kind"), compound.findtext("name", "")
        if kind not in ("class", "struct") or not name.startswith("sepcal::") or "<" in name:
            continue
        file = xml / f"{compound.get('refid')}.xml"
        told = ET.parse(file).getroot()[0]
        if told.get("prot") == "public" and not is_documented(told):
            yield f"{kind} {name}"
    found: dict[str, bool] = {}
    for member in ET.parse(xml / "namespacesepcal.xml").getroot().iter("memberdef"):
        name = f"{member.get('kind')} sepcal::{member.findtext('name')}"
        found[name] = found.get(name, False) or is_documented(member)
    yield from (name for name, documented in found.items() if not documented)


if __name__ == "__main__":
    missing = [*undocumented_python(), *undocumented_cpp(Path(sys.argv[1]))]
    for name in missing:
        print(f"{name} has no documentation")
    sys.exit(bool(missing))
