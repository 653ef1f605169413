# SPDX-License-Identifier: BSD-3-Clause
"""Every public function of C++ has its twin in Python, or a line that says why not.

Public is what a header outside detail/ declares in namespace sepcal: functions, and classes that
have functions. A twin has the same name, in sepcal.__all__ or in a class there. docs/python.md
lists those that are called otherwise, and those without.
"""

import re
from collections.abc import Iterator
from operator import attrgetter
from pathlib import Path

import pytest

import sepcal

ROOT = Path(__file__).parents[2]
HEADERS = ROOT / "cpp" / "include" / "sepcal"
NO_FUNCTIONS = {"operator", "requires", "static_assert"}  # though a bracket follows them

PLANTED = """
#define TRAP(x) struct Trap { \\
  int trap() { return x; }
namespace sepcal {
class Later;
enum class Choice { one, two };
using Told = std::function<void(double)>;
inline constexpr double limit = std::max(1.0, 2.0);
struct Numbers { std::vector<int> n = {}; std::function<int(int)> f; };  // of data alone
// int commented(int x);
template <class M, int N = 2> requires Model<M, N>
[[nodiscard]] std::map<int, M> planted(const M& model, const Options& options = {}) {
  if (model.size() < N) return call("{", '}');
  return {};
}
int planted(int other);
class Planter { public: explicit Planter(int rows); };
template <class M> struct Specialised<Batch<M>> { int at(int row); };
template <class M> auto operator+(M model, int effect) { return model; }
int Planter::defined(int row) { return row; }
template <class M> concept Model = requires(const M& model) { model.at(); } && requires(M m) { m; };
namespace parts { int hidden(); }
namespace { int unnamed(); }
}  // namespace sepcal
namespace sepcal::lanes { int inner(); }
namespace Eigen { int foreign(); }
"""


def statements(text: str) -> Iterator[tuple[str, str]]:
    """At this level of a text: what comes before braces or a semicolon, and the body."""
    begin = opened = depth = rounds = 0
    for mark in re.finditer(r"[(){};]", text):
        rounds += {"(": 1, ")": -1}.get(mark[0], 0)
        if rounds:  # a default argument's braces
            continue
        if mark[0] == "{":
            opened = opened if depth else mark.end()
            depth += 1
        elif mark[0] == "}":
            depth -= 1
        if mark[0] in ";}" and depth == 0:
            closed = mark.start()
            bounds = (opened - 1, opened) if mark[0] == "}" else (closed, closed)
            yield text[begin : bounds[0]].strip(), text[bounds[1] : closed]
            begin = mark.end()


def named(text: str) -> Iterator[str]:
    """Functions, and classes that have some, of a namespace or a class."""
    for head, body in statements(text):
        bare = head
        while (inner := re.sub(r"<[^<>]*>", " ", bare)) != bare:
            bare = inner
        of_class = re.match(r"(?:template )?\s*(?:class|struct) (\w+)", bare)
        if of_class and any(named(body)) and f"{of_class[1]}<" not in head:
            yield of_class[1]
        found = re.match(r"[^=(]*?(?<!::)\b([a-zA-Z]\w*)\s*\(", bare)
        if found and not of_class and bare[0] != "&" and found[1] not in NO_FUNCTIONS:
            yield found[1]


def declared(text: str) -> set[str]:
    """The public names of a header."""
    text = re.sub(
        r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\])\'|/\*.*?\*/|//[^\n]*', " ", text, flags=re.S
    )
    text = re.sub(r"^ *#(?:.*\\\n)*.*", "", text, flags=re.M)
    spaces = [body for head, body in statements(text) if head == "namespace sepcal"]
    return {name for space in spaces for name in named(space)}


def lines(document: str, heading: str) -> list[tuple[list[str], str]]:
    """The table of a section: the names of C++ in a row, and what stands beside them."""
    section = (ROOT / "docs" / document).read_text().split(f"\n## {heading}\n")[1].split("\n## ")[0]
    rows = re.findall(r"^\| (`.*?) \| (.*) \|$", section, re.M)
    return [(re.findall(r"`(\w+)`", names), beside) for names, beside in rows]


PUBLIC = set().union(
    *(
        declared(header.read_text())
        for header in HEADERS.rglob("*.h*")
        if "detail" not in header.relative_to(HEADERS).parts
    )
)
CLASSES = [one for one in map(sepcal.__dict__.get, sepcal.__all__) if isinstance(one, type)]
OWN = [kind for one in CLASSES for kind in one.__mro__ if kind.__module__.startswith("sepcal")]
OTHER = {"calibrate"}  # C++ has another than Population.calibrate, with a fleet as its prior
SAME = set(sepcal.__all__).union(*map(vars, OWN)) - OTHER  # and nothing that is a dict's
RENAMED = lines("python.md", "C++ and Python names")
WITHOUT = lines("python.md", "In C++ only")
LISTED = [name for names, _ in RENAMED + WITHOUT for name in names]


def without_a_line(functions: set[str]) -> set[str]:
    """Those of which nobody knows what Python has."""
    return functions - SAME - set(LISTED)


def outdated(functions: set[str]) -> set[str]:
    """Lines of what there is no more, and of what needs none."""
    return set(LISTED) - (functions - SAME)


def test_functions_are_found_in_any_header():
    assert declared(PLANTED) == {"planted", "Planter"}
    assert {"fit", "compare", "read_csv", "propagate", "own_model", "Filter", "Probe"} <= PUBLIC
    assert len(PUBLIC) > 150


def test_every_function_has_a_twin_or_a_line():
    """Else name it in docs/python.md, or say there why not."""
    assert without_a_line(PUBLIC) == set()


def test_a_planted_function_is_named():
    assert without_a_line(PUBLIC | declared(PLANTED)) == {"planted", "Planter"}


def test_a_line_of_what_was_taken_away_is_named():
    assert outdated(PUBLIC - {"calibrate", "throw_within"}) == {"calibrate", "throw_within"}


def test_a_line_names_what_there_is_and_what_needs_one():
    assert outdated(PUBLIC) == set()
    assert len(LISTED) == len(set(LISTED))


@pytest.mark.parametrize("beside", [beside for _, beside in RENAMED])
def test_a_twin_is_there(beside: str):
    twins = re.findall(r"`sepcal\.([\w.]+)`", beside)
    assert twins
    for twin in twins:
        assert twin.split(".")[0] in sepcal.__all__
        attrgetter(twin)(sepcal)
