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
PACKAGE = ROOT / "python" / "sepcal"

# Files that may write to a stream, and nothing else in apps/ or the library.
WRITERS = r"^apps/(terminal|starting|interrupt)\.cpp$"
STREAM = re.compile(
    r"fmt::print\(|std::cout|std::cerr|std::clog|\bstd::fputs\(|\bstd::puts\(|\bstd::v?f?printf\("
    r"|\bstd::fwrite\([^;]*std(out|err)|::write\(STD"
)
FILE_WRITERS = r"^(cpp/src/(flight/files/output_file|base/spool)|apps/manners)\.cpp$"
PAGES = ("cpp/src/flight/text/*.cpp", "cpp/src/flight/*/*_text.cpp")


def cpp_sources(*patterns: str) -> Iterator[tuple[str, str]]:
    for pattern in patterns:
        for file in sorted(ROOT.glob(pattern)):
            yield str(file.relative_to(ROOT)), file.read_text()


def places(
    sources: Iterator[tuple[str, str]], pattern: str | re.Pattern[str], exempt: str = ""
) -> list[str]:
    """Where the pattern stands, in files whose names do not match the other one."""
    return [
        f"{name}: {match[0]}"
        for name, text in sources
        if not (exempt and re.search(exempt, name))
        for match in re.finditer(pattern, text)
    ]


def statements(sources: Iterator[tuple[str, str]], opens: str, safe: str) -> list[str]:
    """What opens a statement's text where nothing in the statement makes that safe."""
    return [
        f"{name}: {match[0]}"
        for name, text in sources
        for statement in re.split(r";\s*\n", text)
        if (match := re.search(opens, statement)) and not re.search(safe, statement)
    ]


def find_streams(sources: Iterator[tuple[str, str]]) -> list[str]:
    """Places that write to the terminal by themselves."""
    return places(sources, STREAM, WRITERS)


def find_unescaped_pages(sources: Iterator[tuple[str, str]]) -> list[str]:
    """Pages that are put together without base::page(); a header's text is C, not a page."""
    made = r"fmt::(format|join)\(|std::to_string\(|ostringstream"
    return places(sources, made, r"header_text\.cpp$")


def find_unescaped_comments(sources: Iterator[tuple[str, str]]) -> list[str]:
    """Statements that put something into a comment of C, or of a parameter file, as it is."""
    comment = r'"(?:[^"\n]*(?:/\*|# )[^"\n]*| \* )\{\}'
    return statements(sources, comment, r"in_c_comment\(|in_line\(")


def find_joined_comments(sources: Iterator[tuple[str, str]]) -> list[str]:
    """The same by +, +=, << and append()."""
    comment = r'"[^"\n]*(?:/\* ?|# | \* )"'
    between = r"(?:\s*(?:\)|\+|<<|;\s*\w+\s*(?:\+=|<<)))+\s*"
    return places(sources, comment + between + r"(?!(?:base::)?in_(?:c_comment|line)\()[A-Za-z_]")


def find_own_files(sources: Iterator[tuple[str, str]]) -> list[str]:
    """Files that are written by themselves, not as an OutputFile."""
    writing = (
        r"std::w?o?fstream|fmt::output_file|fopen\([^;]*\"[wa][^;]*;|\bopen\([^;]*O_(WRONLY|RDWR)"
    )
    return places(sources, writing, FILE_WRITERS)


def find_json_by_hand(sources: Iterator[tuple[str, str]]) -> list[str]:
    """JSON in a literal, but for a message's: its library writes it, which escapes."""
    written = places(sources, r'"[^"\n]*\\": ?(?:\\"|\{\}|")[^\n]*')
    return [place for place in written if "give a JSON object" not in place]


def find_unquoted_commands(sources: Iterator[tuple[str, str]]) -> list[str]:
    """Statements that show a command with something in it that the shell would read."""
    return statements(sources, r'"[^"\n]*next: [^"\n]*\{\}', r"in_shell\(")


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
            if function.name == "__repr__":  # "<sepcal.Fit ...>"
                continue
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


MARKUP = re.compile(r"</?[a-z][^<]*>|&[a-z]+;")


def literal_of(node: ast.expr) -> str:
    return str(node.value) if is_literal(node) and isinstance(node, ast.Constant) else ""


def find_joined_html(trees: Iterator[tuple[str, ast.Module]]) -> list[str]:
    """Markup that is put together by +, %, format() or replace(), and escape() by hand."""
    found = []
    for name, tree in trees:
        if name in ("markup.py", "page.py"):
            continue
        for node in ast.walk(tree):
            if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Mod):
                if any(MARKUP.search(literal_of(side)) for side in (node.left, node.right)):
                    found.append(f"{name}:{node.lineno}: markup by an operator")
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                filled = node.func.attr in ("format", "join", "replace", "format_map")
                if filled and MARKUP.search(literal_of(node.func.value)):
                    found.append(f"{name}:{node.lineno}: markup by {node.func.attr}()")
            elif isinstance(node, ast.ImportFrom) and node.module == "html":
                found.append(f"{name}:{node.lineno}: html by hand")
    return found


def find_python_files(trees: Iterator[tuple[str, ast.Module]]) -> list[str]:
    """Files that are written by themselves, not by write_whole()."""
    found = []
    for name, tree in trees:
        if name == "whole_files.py":
            continue
        for node in ast.walk(tree):
            if not isinstance(node, ast.Call):
                continue
            called = ast.unparse(node.func)
            modes = [literal_of(at) for at in (*node.args[1:2], *(k.value for k in node.keywords))]
            opens = called.split(".")[-1] in ("open", "fdopen") and any(
                re.fullmatch(r"[rbt]*[wax+][rwabtx+]*", mode) for mode in modes
            )
            nowhere = "devnull" in ast.unparse(node)
            if (opens and not nowhere) or called.endswith((".write_text", ".write_bytes")):
                found.append(f"{name}:{node.lineno}: {called}()")
    return found


def find_python_json(trees: Iterator[tuple[str, ast.Module]]) -> list[str]:
    """JSON in a text that is filled in."""
    return [
        f"{name}:{node.lineno}: JSON by hand"
        for name, tree in trees
        for node in ast.walk(tree)
        if isinstance(node, ast.JoinedStr)
        and any(re.search(r'"\w+": ?', str(getattr(part, "value", ""))) for part in node.values)
    ]


def find_prints(trees: Iterator[tuple[str, ast.Module]]) -> list[str]:
    """Places in the package that write to the terminal by themselves."""
    found = []
    for name, tree in trees:
        if name in ("printing.py", "progress.py"):
            continue
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and ast.unparse(node.func) in (
                "print", "pprint.pprint", "shlex.quote", "shlex.join", "warnings.warn", "os.write",
                "sys.stdout.write", "sys.stdout.writelines", "sys.stdout.buffer.write",
                "sys.stderr.write", "sys.stderr.writelines", "sys.stderr.buffer.write",
            ):  # fmt: skip
                found.append(f"{name}:{node.lineno}: {ast.unparse(node.func)}()")
    return found


def test_the_terminal_is_written_in_one_place() -> None:
    assert find_streams(cpp_sources("apps/*.cpp", "cpp/src/**/*.cpp", "cpp/src/**/*.hpp")) == []


def test_pages_are_made_by_page() -> None:
    assert find_unescaped_pages(cpp_sources(*PAGES)) == []


def test_comments_are_escaped() -> None:
    assert find_unescaped_comments(cpp_sources("cpp/src/flight/export/*.cpp")) == []


EVERYWHERE = ("apps/*.cpp", "apps/*.hpp", "cpp/src/**/*.cpp", "cpp/src/**/*.hpp")


def test_comments_are_not_joined() -> None:
    assert find_joined_comments(cpp_sources("cpp/src/flight/export/*.cpp")) == []


def test_files_are_written_in_one_place() -> None:
    assert find_own_files(cpp_sources(*EVERYWHERE)) == []
    assert find_python_files(python_trees(PACKAGE)) == []


def test_json_is_written_by_its_library() -> None:
    assert find_json_by_hand(cpp_sources(*EVERYWHERE)) == []
    assert find_python_json(python_trees(PACKAGE)) == []


def test_commands_are_quoted() -> None:
    assert find_unquoted_commands(cpp_sources(*EVERYWHERE)) == []


def test_markup_is_made_of_literals() -> None:
    assert find_raw_html(python_trees(PACKAGE)) == []
    assert find_joined_html(python_trees(PACKAGE)) == []


def test_the_package_prints_in_one_place() -> None:
    assert find_prints(python_trees(PACKAGE)) == []


PLANTED_CPP = [
    (find_streams, 'fmt::print(stderr, "{}\\n", name);'),
    (find_streams, "std::cout << name;"),
    (find_unescaped_pages, 'text += fmt::format("{}\\n", name);'),
    (find_unescaped_comments, 'text += fmt::format("/* {} */\\n", effect);\n'),
    (find_unescaped_comments, 'text += fmt::format("# {}\\n", line);\n'),
    (find_unescaped_comments, 'for (auto& line : lines) text += fmt::format(" * {}\\n", line);\n'),
    (find_joined_comments, 'text += "/* " + effect + " */";'),
    (find_joined_comments, 'text += " * "; text += line;'),
    (find_joined_comments, 'text += std::string("# ") + line + "\\n";'),
    (find_joined_comments, 'out << "# " << line;'),
    (find_own_files, 'std::ofstream(file) << fmt::format("# {}\\n", name);'),
    (find_own_files, 'std::FILE* out = std::fopen(file.c_str(), "w");'),
    (find_own_files, "auto out = fmt::output_file(file);"),
    (find_streams, 'fmt::print(out, "# {}\\n", name);'),
    (find_streams, 'std::fprintf(out, "# %s", name.c_str());'),
    (find_json_by_hand, 'text += "{\\"name\\": \\"" + name + "\\"}";'),
    (find_json_by_hand, 'text += fmt::format("\\"name\\": {}", name);'),
    (find_unquoted_commands, 'text += page("next: sepcal-mag add {}\\n", file);\n'),
]
PLANTED_PYTHON = [
    (find_raw_html, 'def f(x): return f"<b>{x}</b>"'),
    (find_raw_html, "def f(x): return Html(x)"),
    (find_raw_html, 'def f(x): return html("<b>" + x + "</b>")'),
    (find_raw_html, 'def f(x):\n    t = "<b>" + x\n    return html(t)'),
    (find_joined_html, 'def f(x): return "<b>" + x'),
    (find_joined_html, 'def f(x): return x + "</td>"'),
    (find_joined_html, 'def f(x): return "<b>%s</b>" % x'),
    (find_joined_html, 'def f(x): return "<b>{}</b>".format(x)'),
    (find_joined_html, 'def f(x): return "<br>".join(x)'),
    (find_joined_html, "from html import escape"),
    (find_python_files, 'def f(x): open("report.html", "w").write(x)'),
    (find_python_files, 'def f(x): open("report.html", mode="a", encoding="utf-8").write(x)'),
    (find_python_files, 'def f(x): Path("report.html").write_text(x)'),
    (find_python_json, """def f(x): return f'{{"name": "{x}"}}'"""),
    (find_prints, "def f(x): print(x)"),
    (find_prints, "def f(x): print(x, file=sys.stderr)"),
    (find_prints, "def f(x): sys.stderr.write(x)"),
    (find_prints, "def f(x): warnings.warn(x)"),
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
