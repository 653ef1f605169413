# SPDX-License-Identifier: BSD-3-Clause
"""Headers of calibrations whose effects follow columns with hostile names, many in one program.

It is compiled strictly as C99 or C++20 under sanitizers, and runs the headers' self-tests.
"""

from __future__ import annotations

import re
import resource
import shutil
import subprocess
from collections.abc import Hashable
from pathlib import Path

from mutation import check_message, input_of, main, words_of
from spoilt_calibration import FIELD, with_columns

import sepcal
from headers import STRICT
from hostile import hostile_words

COUNT = 12  # headers in a program
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
COMPILERS = [  # in turn, those that are there
    (target, standard, compiler)
    for target, standard, names in (
        ("c", "c99", ("gcc", "clang", "clang-16")),
        ("cpp", "c++20", ("g++", "clang++", "clang++-16")),
    )
    for compiler in names
    if shutil.which(compiler)
]
EFFECTS = ("bias[{}]", "scale[{}]", "bias[{}^2]", "axis_scale[{}]")


def export_all(words: list[str], to: str) -> list[str]:
    """Headers' files; what is refused says so in a line and has none."""
    files = []
    for number, word in enumerate(words):
        file = f"header_{number}.h"
        effect = EFFECTS[number % len(EFFECTS)].format(word)
        try:
            flight = with_columns("field", [word], name=word)
            base = sepcal.fit(sepcal.Magnetometer(field=FIELD), flight, effects=[effect])
            sepcal.export(base, file, to, sensor=number, force=True)
        except sepcal.Error as error:
            check_message(str(error))
            continue
        files.append(file)
    return files


def build(files: list[str], to: str, standard: str, compiler: str) -> Path:
    """A program that runs every header's self-test."""
    tests = []
    for file in files:
        number = re.findall(r"\d+", file)[0]
        prefix = f"sepcal_magnetometer_{number}"
        tests.append(prefix + ("::self_test" if to == "cpp" else "_self_test"))
    includes = "".join(f'#include "{file}"\n' for file in files)
    sums = "".join(f"  failed += {test}() != 0;\n" for test in tests)
    main_file = Path(f"main.{to}")
    main_file.write_text(
        f"{includes}int main(void) {{\n  int failed = 0;\n{sums}  return failed;\n}}\n"
    )
    for old in Path().glob("program*"):
        old.unlink()
    options = (f"-std={standard}", *STRICT, "-O1", *SANITIZERS, "-lm")
    built = subprocess.run(
        [compiler, "-o", "program", main_file, *options],
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stderr[-3000:]
    return Path("program").resolve()


def take_memory() -> None:
    """AddressSanitizer reserves far more than this process may have."""
    resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))


def target(data: bytes) -> Hashable:
    """Which compiler took how many headers."""
    to, standard, compiler = COMPILERS[len(data) % len(COMPILERS)]
    for old in Path().glob("header_*.h"):
        old.unlink()
    files = export_all([*dict.fromkeys(filter(None, words_of(data, COUNT)))], to)
    if not files:
        return 0
    program = build(files, to, standard, compiler)
    ran = subprocess.run(
        [program], capture_output=True, text=True, check=False, preexec_fn=take_memory
    )
    assert ran.returncode == 0, (ran.returncode, ran.stderr[-3000:])
    assert [*Path().glob("program*")] == [Path("program")]
    return to, standard, compiler, len(files)


SEEDS = [input_of(hostile_words(500, seed)[-COUNT:]) + b"~" * (seed % 4) for seed in range(12)]

if __name__ == "__main__":
    main(target, SEEDS)
