# SPDX-License-Identifier: BSD-3-Clause
"""No string leaves but through the function of its target language: a look at the code itself.

C++ pages are of a type that no std::string turns into; what compilers can't hold is held here.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
REPORTING = ROOT / "python" / "sepcal" / "reporting"

# Files that may write to a stream, and nothing else in apps/ or the library.
WRITERS = {"apps/terminal.cpp", "apps/interrupt.cpp"}
STREAM = re.compile(
    r"fmt::print\(|std::cout|std::cerr|std::clog|\bstd::fputs\(|\bstd::puts\(|\bstd::v?f?printf\("
    r"|\bstd::fwrite\([^;]*std(out|err)|::write\(STD"
)
PAGES = ("cpp/src/flight/text/*.cpp", "cpp/src/flight/*/*_text.cpp")


def cpp_sources(*patterns: str) -> Iterator[tuple[str, str]]:
    for pattern in patterns:
        for file in sorted(ROOT.glob(pattern)):
            yield str(file.relative_to(ROOT)), file.read_text()


def find_streams(sources: Iterator[tuple[str, str]]) -> list[str]:
    """Places that write to the terminal by themselves."""
    return [
        f"{name}: {match[0]}"
        for name, text in sources
        if name not in WRITERS
        for match in STREAM.finditer(text)
    ]


def find_unescaped_pages(sources: Iterator[tuple[str, str]]) -> list[str]:
    """Pages that are put together without base::page()."""
    return [
        f"{name}: {match[0]}"
        for name, text in sources
        for match in re.finditer(r"fmt::(format|join)\(|std::to_string\(|ostringstream", text)
        if not name.endswith("header_text.cpp")  # C, not a page
    ]


def find_unescaped_comments(sources: Iterator[tuple[str, str]]) -> list[str]:
    """Statements that put something into a comment of C, or of a parameter file, as it is."""
    found = []
    for name, text in sources:
        for statement in re.split(r";\s*\n", text):
            opens = re.search(r'"[^"\n]*(/\*|# )[^"\n]*\{\}', statement)
            if opens and not re.search(r"in_c_comment\(|in_line\(", statement):
                found.append(f"{name}: {opens[0]}")
    return found


def python_trees(folder: Path) -> Iterator[tuple[str, ast.Module]]:
    for file in sorted(folder.rglob("*.py")):
        yield file.name, ast.parse(file.read_text())


def is_literal(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def literal_names(tree: ast.AST) -> set[str]:
    """Names that only ever stand for literals, and parameters that are declared as literals."""
    names: set[str] = set()
    other: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign):
            for target in node.targets:
                if isinstance(target, ast.Name):
                    (names if is_literal(node.value) else other).add(target.id)
        elif isinstance(node, ast.arg) and "LiteralString" in ast.dump(node):
            names.add(node.arg)
    return names - other


def find_raw_html(trees: Iterator[tuple[str, ast.Module]]) -> list[str]:
    """Markup that isn't made by html() or join() of a literal."""
    found = []
    for name, tree in trees:
        if name in ("markup.py", "page.py"):  # where it is made; the frame of the page
            continue
        for function in [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]:
            known = literal_names(function)
            for node in ast.walk(function):
                if isinstance(node, ast.JoinedStr):
                    parts = [str(at.value) for at in node.values if isinstance(at, ast.Constant)]
                    if any(re.search(r"</?[a-z]|&[a-z]+;", part) for part in parts):
                        found.append(f"{name}:{node.lineno}: markup in an f-string")
                if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name):
                    continue
                if node.func.id == "Html":
                    found.append(f"{name}:{node.lineno}: Html() outside markup.py")
                if node.func.id in ("html", "join"):
                    first = node.args[0]
                    named = isinstance(first, ast.Name) and first.id in known
                    if not named and not is_literal(first):
                        found.append(f"{name}:{node.lineno}: {node.func.id}() of no literal")
    return found


def find_prints(trees: Iterator[tuple[str, ast.Module]]) -> list[str]:
    """Places in the package that write to the terminal by themselves."""
    found = []
    for name, tree in trees:
        if name in ("printing.py", "progress.py"):
            continue
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and ast.unparse(node.func) in (
                "print", "sys.stdout.write", "sys.stderr.write", "shlex.quote", "shlex.join",
            ):  # fmt: skip
                found.append(f"{name}:{node.lineno}: {ast.unparse(node.func)}()")
    return found


def test_the_terminal_is_written_in_one_place() -> None:
    assert find_streams(cpp_sources("apps/*.cpp", "cpp/src/**/*.cpp", "cpp/src/**/*.hpp")) == []


def test_pages_are_made_by_page() -> None:
    assert find_unescaped_pages(cpp_sources(*PAGES)) == []


def test_comments_are_escaped() -> None:
    assert find_unescaped_comments(cpp_sources("cpp/src/flight/export/*.cpp")) == []


def test_markup_is_made_of_literals() -> None:
    assert find_raw_html(python_trees(REPORTING)) == []


def test_the_package_prints_in_one_place() -> None:
    assert find_prints(python_trees(ROOT / "python" / "sepcal")) == []


PLANTED_CPP = [
    (find_streams, 'fmt::print(stderr, "{}\\n", name);'),
    (find_streams, "std::cout << name;"),
    (find_unescaped_pages, 'text += fmt::format("{}\\n", name);'),
    (find_unescaped_comments, 'text += fmt::format("/* {} */\\n", effect);\n'),
    (find_unescaped_comments, 'text += fmt::format("# {}\\n", line);\n'),
]
PLANTED_PYTHON = [
    (find_raw_html, 'def f(x): return f"<b>{x}</b>"'),
    (find_raw_html, "def f(x): return Html(x)"),
    (find_raw_html, 'def f(x): return html("<b>" + x + "</b>")'),
    (find_raw_html, 'def f(x):\n    t = "<b>" + x\n    return html(t)'),
    (find_prints, "def f(x): print(x)"),
]


@pytest.mark.parametrize(("find", "line"), PLANTED_CPP)
def test_a_planted_write_in_cpp_is_found(
    find: Callable[[Iterator[tuple[str, str]]], list[str]], line: str
) -> None:
    assert find(iter([("cpp/src/flight/text/planted.cpp", line)]))


@pytest.mark.parametrize(("find", "line"), PLANTED_PYTHON)
def test_a_planted_write_in_python_is_found(
    find: Callable[[Iterator[tuple[str, ast.Module]]], list[str]], line: str
) -> None:
    assert find(iter([("planted.py", ast.parse(line))]))
