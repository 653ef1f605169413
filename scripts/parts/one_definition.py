# SPDX-License-Identifier: BSD-3-Clause
"""Finds types of one full name that are defined in two files: code of one then works on the other.

Neither compiler nor linker sees it: both instantiate std::vector<Name> under one symbol, and the
linker keeps either. Types in unnamed namespaces and in other types are left alone.

Usage: one_definition.py FILE...
"""

from __future__ import annotations

import re
import sys
from collections import defaultdict
from pathlib import Path

TEXT_WITHOUT_CODE = re.compile(
    r"""//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])'""", re.DOTALL
)
SCOPE = re.compile(
    r"\bnamespace\s*(?P<namespace>[\w:]*)\s*\{"
    r"|\b(?:struct|class|union|enum(?:\s+class)?)\s+(?P<type>\w+)(?:\s+final)?\s*"
    r"(?::(?!:)[^;{()]*)?\{"
    r"|(?P<brace>[{}])"
)


def types_of(source: str) -> set[str]:
    """Full names of the types that `source` defines in named namespaces."""
    found: set[str] = set()
    scopes: list[str | None] = []  # a namespace's name; None: a body, or a namespace without name
    for match in SCOPE.finditer(TEXT_WITHOUT_CODE.sub(" ", source)):
        if match["brace"] == "}":
            if scopes:
                scopes.pop()
        elif match["brace"]:
            scopes.append(None)
        elif match["type"]:
            if None not in scopes:
                found.add("::".join([*filter(None, scopes), match["type"]]))
            scopes.append(None)
        else:
            scopes.append(match["namespace"] or None)
    return found


def main(paths: list[str]) -> int:
    """Prints what stands twice; returns the exit status."""
    files = defaultdict(list)
    for path in paths:
        for name in types_of(Path(path).read_text()):
            files[name].append(path)
    twice = {name: where for name, where in files.items() if len(where) > 1}
    for name, where in sorted(twice.items()):
        print(f"{name} is defined in {' and in '.join(where)}; rename one", file=sys.stderr)
    return 1 if twice else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
