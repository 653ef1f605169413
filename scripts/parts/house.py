# SPDX-License-Identifier: BSD-3-Clause
"""How large the house is, of any checkout, so that one before a change stands beside one after.

Usage: house.py CHECKOUT...   folders and lines of cpp/src, public headers, the longest functions,
                              where density_error stands, the compile time of a user's file with one
                              model and one fit, and the calls from main to at() of sepcal-pitot fit
The calls need gdb and CHECKOUT/build/apps; only calls that the optimiser left are counted.
"""

from __future__ import annotations

import re
import resource
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

from rooms import functions

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
    cmake = (root / "cpp/CMakeLists.txt").read_text()
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


def main(roots: list[str]) -> int:
    """Prints a page for each checkout."""
    for name in roots:
        root = Path(name)
        print(f"{name}\n\nfolders of cpp/src:\n{folders(root)}")
        headers = list((root / "cpp/include").rglob("*.hpp"))
        hidden = sum("detail" in header.parts for header in headers)
        print(f"public headers: {len(headers) - hidden}, and {hidden} in detail/")
        print(f"longest functions:\n{longest(root)}")
        print(f'"{FACT}" stands in: {places(root)}')
        print(f"a user's file with one model and one fit: {compile_seconds(root):.1f} s of CPU")
        chain = calls(root)
        print(f"from main to the model: {len(chain) - 1} calls: {' < '.join(chain)}\n")
    return 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit((__doc__ or "").strip())
    sys.exit(main(sys.argv[1:]))
