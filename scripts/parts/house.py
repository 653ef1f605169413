# SPDX-License-Identifier: BSD-3-Clause
"""How large the house is, of any checkout, so that one before a change stands beside one after.

Usage: house.py CHECKOUT...   folders and lines of cpp/src, public headers, the longest functions,
                              where density_error stands, the compile time of a user's file with one
                              model and one fit, the calls from main to at() of sepcal-pitot fit,
                              and then a table with a column a checkout
       house.py --sizes CHECKOUT...   the table alone, within seconds
The calls need gdb and CHECKOUT/build/apps; only calls that the optimiser left are counted. The
table counts in the sources, and has "-" for what isn't there. Whether a verb refuses a subject that
its command line takes it can't see.
"""

from __future__ import annotations

import re
import resource
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path

from named_subjects import find_comparisons, sources
from rooms import INCLUDE, functions

FACT = "density_error"
USER = """
#include <sepcal/sepcal.hpp>
struct TiltTable {
  static constexpr std::array inputs{sepcal::Quantity{"theta", "rad"}};
  static constexpr std::array outputs{sepcal::Quantity{"acceleration", "m/s^2"}};
  static constexpr std::array linear{sepcal::Quantity{"s", "1"}, sepcal::Quantity{"bias", "m/s^2"}};
  static constexpr std::array nonlinear{sepcal::Quantity{"delta", "rad", -0.3, 0.3}};
  template <class U, class X>
  sepcal::Affine<X, 1, 2> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    using std::sin;
    sepcal::Affine<X, 1, 2> z;
    z.A << 9.80665 * sin(u[0] + xi2[0]), X(1.0);
    z.b.setZero();
    return z;
  }
};
double fit(const sepcal::Record& record) { return sepcal::fit(TiltTable{}, record)["s"].value; }
"""
FLAGS = ["-std=c++20", "-O2", "-isystem", "/usr/include/eigen3"]
NOTHING = "-"
LOOP = ("check", "fit", "compare", "diagnose", "add", "intervals", "apply", "report", "save")
AIRCRAFT = "apps/sepcal_aircraft.cpp"
OWN = "python/sepcal/own_commands.py"
OWN_STATES = "own, with a state"
COMMANDS = {  # of each subject: the file whose verbs it has
    "probes": "apps/sepcal_pitot.cpp",
    **dict.fromkeys(("path", "longitudinal", "lateral", "six-dof", "aero"), AIRCRAFT),
    "own, static": OWN,
    OWN_STATES: OWN,
}
VERB = re.compile(r"""(?:add_subcommand\(|add_later_verb\(|_add\(commands,)\s*"([\w-]+)\"""")
SUBJECTS = {
    "boom with vanes": "vane.?boom",
    "five-hole probe": "five.?hole",
    "Pitot-static tube": "pitot.?static",
}
KINDS = ("own", "registration", "docs", "tests", "lab and scripts", "others")
# Written by hand; rivals have options of their own.
PRODUCT = ("cpp", "apps", "python", ":!*.pyi", ":!*/fit_options.py", ":!*rivals*")
STANDS = {
    "option `noise_tolerance`": r"\bnoise[_-]tolerance\b",
    "choice `jacobian`": r"ProjectedJacobian|\"(--)?jacobian\"|options\(\)\.jacobian|^ +jacobian:",
    "result field `held_out_gain`": r"\bheld_out_gain\b",
    "result field `standard_error_blocks`": r"\bstandard_error_blocks\b",
    "effect `upwash`": r"\bupwash\b",
}
WING = (
    "cpp/src/flight/aircraft/*.?pp",
    "cpp/include/sepcal/flight/aircraft.hpp",
    "cpp/src/bindings/aircraft.cpp",
    AIRCRAFT,
    "python/sepcal/aircraft_fits.py",
    "python/sepcal/reporting/trajectory.py",
)
PLUMBING = (
    "cpp/src/flight/json/*.?pp",
    "cpp/src/flight/aircraft/aircraft_json.cpp",
    "cpp/src/bindings/*.?pp",
)


def folders(root: Path) -> str:
    """Files and lines of every folder of sources."""
    files: Counter[str] = Counter()
    lines: Counter[str] = Counter()
    source = root / "cpp/src"
    for file in source.rglob("*.?pp"):
        folder = str(file.parent.relative_to(source))
        files[folder] += 1
        lines[folder] += len(file.read_text().splitlines())
    return "\n".join(
        f"  {name:<18} {files[name]:>4} files {lines[name]:>6} lines" for name in sorted(files)
    )


def longest(root: Path, most: int = 5) -> str:
    """The longest functions of the library and the apps."""
    files = [file for part in ("cpp", "apps") for file in (root / part).rglob("*.?pp")]
    found = [(*entry, file.name) for file in files for entry in functions(file)]
    found.sort(key=lambda entry: -entry[0])
    return "\n".join(f"  {length:>3} lines, {file}: {line}" for length, line, file in found[:most])


def places(root: Path) -> str:
    """Where the name of one effect stands."""
    parts = [root / part for part in ("cpp", "apps", "python")]
    files = [
        file
        for part in parts
        for file in part.rglob("*.*")
        if file.suffix in (".cpp", ".hpp", ".py")
    ]
    counts = {file.relative_to(root): file.read_text().count(f'"{FACT}') for file in sorted(files)}
    return ", ".join(f"{file} {number}" for file, number in counts.items() if number)


def compile_seconds(root: Path) -> float:
    """CPU time of the compiler on a user's file, the least of three."""
    listed = (root / "cpp/CMakeLists.txt", *(root / "cpp").glob("*.cmake"))
    cmake = "".join(file.read_text() for file in listed)
    defined = [f"-D{one}" for one in re.findall(r"\bEIGEN_MAX\w*ALIGN_BYTES=\d+", cmake)]
    include = ["-I", str(root / "cpp/include")]
    spent = []
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "user.cpp").write_text(USER)
        for _ in range(3):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run(
                [
                    "g++",
                    *FLAGS,
                    *defined,
                    *include,
                    "-c",
                    f"{folder}/user.cpp",
                    "-o",
                    f"{folder}/user.o",
                ],
                check=True,
            )
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            spent.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(spent)


def calls(root: Path) -> list[str]:
    """From main to the model of the five-hole probe, in the tenth of its calls."""
    app = root / "build/apps/sepcal-pitot"
    if shutil.which("gdb") is None or not app.is_file():
        return []
    symbols = subprocess.run(["nm", str(app)], capture_output=True, text=True, check=True).stdout
    model = re.search(r"\S*StaticModel\S*FiveHoleProbe\S*8evaluate\S*", symbols)
    if model is None:
        return []
    with tempfile.TemporaryDirectory() as folder:
        log = f"{folder}/log.csv"
        subprocess.run(
            [str(app), "simulate", "-o", log, "--rows", "400"], capture_output=True, check=True
        )
        steps = [f"break {model[0]}", "ignore 1 30", "run", "bt"]
        told = subprocess.run(
            ["gdb", "-q", "-batch", *(word for step in steps for word in ("-ex", step)), "--args",
             str(app), "fit", log, "--k-alpha", "4.5", "--k-beta", "4.5", "--threads", "1"],
            capture_output=True, text=True, check=True,
        ).stdout  # fmt: skip
    frames = re.findall(r"^#\d+ +(?:0x[0-9a-f]+ in )?(.*)$", told, re.MULTILINE)
    return [
        re.sub(r"\(anonymous namespace\)::", "", frame).split("(")[0].strip() for frame in frames
    ]


def verbs(root: Path, subject: str) -> set[str]:
    """Those of the loop that a command line offers for a subject, by the sources."""
    command = root / COMMANDS[subject]
    text = command.read_text() if command.is_file() else ""
    if subject == OWN_STATES and "own_state_model" not in text:
        return set()
    if '"instrument.hpp"' in text:  # the command line that apps share
        text += (root / "apps/command_line.cpp").read_text()
    found = set(VERB.findall(text))
    page = root / "python/sepcal/reporting/command.py"
    if found and page.is_file() and (COMMANDS[subject] != OWN or "add_model(" in page.read_text()):
        found.add("report")
    if "--output" in text:
        found.add("save")
    return found & set(LOOP)


def loop(root: Path, subject: str) -> str:
    """What a subject lacks of the loop."""
    offered = verbs(root, subject)
    lacking = [verb for verb in LOOP if verb not in offered]
    return ("all but " + ", ".join(lacking) if lacking else "all") if offered else NOTHING


def whole_loops(root: Path) -> str:
    """How many subjects have all of it."""
    return f"{sum(verbs(root, name) == set(LOOP) for name in COMMANDS)} of {len(COMMANDS)}"


def grep(root: Path, pattern: str, *paths: str) -> dict[str, int]:
    """Lines in which a pattern stands, by file, whatever its case."""
    done = subprocess.run(
        ["git", "-C", str(root), "grep", "-icIE", pattern, "--", *paths],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode > 1:
        sys.exit(f"{root}: {done.stderr.strip()}")
    found = (line.rpartition(":") for line in done.stdout.splitlines())
    return {file: int(lines) for file, _, lines in found}


def recipe() -> set[str]:
    """Names of the files that CONTRIBUTING.md tells a new subject to touch."""
    text = (Path(__file__).parents[2] / "CONTRIBUTING.md").read_text()
    section = text.partition("\n## A subject\n")[2].partition("\n## ")[0]
    return {Path(file).name for file in re.findall(r"[\w/]+\.(?:[ch]pp|pyi?|toml)\b", section)}


def kind(file: str, subject: str, registered: set[str]) -> str:
    """Which of KINDS a file is that names a subject."""
    if file.startswith("tests/"):
        return "tests"
    if file.endswith(".md") or file.startswith(("docs/", "examples/")):
        return "docs"
    if Path(file).name in {*registered, "_core.pyi"}:
        return "registration"
    if file.startswith(("lab/", "scripts/", "benchmarks/")):
        return "lab and scripts"
    return "own" if re.search(subject, file, re.IGNORECASE) else "others"


def subject_files(root: Path, subject: str) -> str:
    """How many files name a subject, and what they are."""
    registered = recipe()
    counts = Counter(kind(file, subject, registered) for file in grep(root, subject))
    told = ", ".join(f"{counts[name]} {name}" for name in KINDS if counts[name])
    return f"{counts.total()}: {told}" if counts else NOTHING


def stands(root: Path, pattern: str) -> str:
    """How often something is spelled by hand in the product."""
    found = grep(root, pattern, *PRODUCT)
    return f"{sum(found.values())} lines, {len(found)} files" if found else NOTHING


def comparisons(root: Path) -> str:
    """How often a subject is known by its name."""
    texts = list(sources(root))
    return str(len(find_comparisons(texts))) if texts else NOTHING


def headers(root: Path) -> tuple[int, int]:
    """How many are public, and how many lie below detail/."""
    found = list((root / "cpp/include").rglob("*.hpp"))
    hidden = sum("detail" in header.parts for header in found)
    return len(found) - hidden, hidden


def extent(root: Path, patterns: tuple[str, ...]) -> str:
    """Lines and files of what is there."""
    files = {file for pattern in patterns for file in root.glob(pattern)}
    lines = sum(len(file.read_text().splitlines()) for file in files)
    return f"{lines} lines, {len(files)} files" if files else NOTHING


def includes(root: Path) -> str:
    """How many a file of cpp/src has."""
    found = {file: INCLUDE.findall(file.read_text()) for file in root.glob("cpp/src/**/*.?pp")}
    if not found:
        return NOTHING
    most = max(sorted(found), key=lambda file: len(found[file]))
    mean = sum(map(len, found.values())) / len(found)
    return f"mean {mean:.1f}, most {len(found[most])} ({most.name})"


def rows() -> dict[str, Callable[[Path], str]]:
    """What the table tells of a checkout, by what is written before it."""
    return {
        "subjects with the whole loop": whole_loops,
        **{f"verbs of: {name}": partial(loop, subject=name) for name in COMMANDS},
        **{
            f"files that name the {name}": partial(subject_files, subject=pattern)
            for name, pattern in SUBJECTS.items()
        },
        **{name: partial(stands, pattern=pattern) for name, pattern in STANDS.items()},
        "comparisons with a subject's name outside its own files": comparisons,
        "public headers outside detail/": lambda root: str(headers(root)[0] or NOTHING),
        "headers in detail/": lambda root: str(headers(root)[1] or NOTHING),
        "the aircraft's wing": partial(extent, patterns=WING),
        "JSON and bindings": partial(extent, patterns=PLUMBING),
        "cpp/src": partial(extent, patterns=("cpp/src/**/*.?pp",)),
        "includes of a file of cpp/src": includes,
    }


def commit(root: Path) -> str:
    """What is checked out there."""
    asked = ["git", "-C", str(root), "describe", "--always", "--dirty", "--exclude=*"]
    done = subprocess.run(asked, capture_output=True, text=True, check=False)
    return done.stdout.strip() or root.resolve().name


def table(roots: list[Path]) -> str:
    """All rows in Markdown, with a column a checkout."""
    lines = [["", *map(commit, roots)], ["---"] * (len(roots) + 1)]
    lines += [[name, *(tell(root) for root in roots)] for name, tell in rows().items()]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def main(names: list[str], *, sizes: bool) -> int:
    """Prints a page for each checkout, and the table of all."""
    for name in [] if sizes else names:
        root = Path(name)
        print(f"{name}\n\nfolders of cpp/src:\n{folders(root)}")
        public, hidden = headers(root)
        print(f"public headers: {public}, and {hidden} in detail/")
        print(f"longest functions:\n{longest(root)}")
        print(f'"{FACT}" stands in: {places(root)}')
        print(f"a user's file with one model and one fit: {compile_seconds(root):.1f} s of CPU")
        chain = calls(root)
        print(f"from main to the model: {len(chain) - 1} calls: {' < '.join(chain)}\n")
    print(table([Path(name) for name in names]))
    return 0


if __name__ == "__main__":
    alone = sys.argv[1:2] == ["--sizes"]
    checkouts = sys.argv[2:] if alone else sys.argv[1:]
    if not checkouts:
        sys.exit((__doc__ or "").strip())
    sys.exit(main(checkouts, sizes=alone))
