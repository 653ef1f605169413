# SPDX-License-Identifier: BSD-3-Clause
"""Exported headers at work: compiled by the machine's compilers, and run over rows of inputs."""

import re
import shutil
import struct
import subprocess
import zlib
from pathlib import Path

import numpy as np
import pytest

from oracle.model import Array

STRICT = ("-Wall", "-Wextra", "-Wconversion", "-Wpedantic", "-Werror")
STANDARDS = {"c": ("c99",), "cpp": ("c++17", "c++20")}
SUFFIX = {"c": "c", "cpp": "cpp"}

C_MAIN = """#include "{header}"
#include <stdio.h>
int main(void) {{
  double read;
  {kind} in[{inputs}];
  {kind} out[{outputs}];
  int k;
  if ({self_test}() != 0) return 3;
  for (;;) {{
    for (k = 0; k < {inputs}; ++k) {{
      if (scanf("%lf", &read) != 1) return 0;
      in[k] = ({kind})read;
    }}
    int status = {correct}({arguments});
    printf("%d", status);
    for (k = 0; k < {outputs}; ++k) {{
      printf(" %.17g", status == 0 || status == 3 ? (double)out[k] : (double)NAN);
    }}
    printf("\\n");
  }}
}}
"""


def compiler_of(target: str) -> str:
    """Either cc or c++; a test is skipped where there is none."""
    found = shutil.which("cc" if target == "c" else "c++")
    if found is None:
        pytest.skip(f"no compiler for {target} on this machine")
    return found


def kind_of(text: str) -> str:
    """What the correction computes in, "double" or "float"."""
    return "float" if re.search(r"^(static const|inline constexpr) float", text, re.M) else "double"


def origins_of(text: str) -> dict[str, float]:
    """What is taken away from drivers before they become floats, by the driver's argument."""
    found = re.findall(r"double (?:sepcal\w+?_)?origin_(\w+) = ([^;]+);", text)
    return {f"{name}_less_origin": float(value) for name, value in found}


def constants_crc(text: str) -> int:
    """The CRC-32 of the constants, by zlib."""
    definitions = r"^(?:static const|inline constexpr) (double|float) [^=]*= ([^;]*);"
    numbers = b"".join(
        struct.pack("<" + kind[0], float(value))
        for kind, values in re.findall(definitions, text, re.M)
        for value in re.findall(r"-?[0-9][0-9.e+-]*", values)
    )
    return zlib.crc32(numbers)


def arguments_of(text: str) -> list[tuple[str, int, bool]]:
    """Name, size and whether it is an output, of the correction's arguments in order."""
    heads = re.findall(r"^(?:static )?inline \w+ \w*correct\(([^{]*)\) \{$", text, re.MULTILINE)
    assert len(heads) == 1
    found = []
    for argument in re.split(r",\s+", heads[0].strip()):
        const, _, rest = argument.rpartition(f"{kind_of(text)} ")
        size = 3 if rest.endswith("[3]") else 1
        name = rest.removesuffix("[3]").removeprefix("*")
        found.append((name, size, rest.startswith("*") or (size == 3 and "const" not in const)))
    return found


def drivers_of(text: str) -> list[str]:
    """Arguments that are no outputs, an array by its name with 0, 1, 2."""
    names = []
    for name, size, is_output in arguments_of(text):
        if not is_output:
            names += [name] if size == 1 else [f"{name}{k}" for k in range(3)]
    return names


def build(header: Path, target: str, standard: str) -> Path:
    """Compiles a program that runs the header's self-test, then corrects what it reads."""
    text = header.read_text()
    names = re.findall(r"^(?:static )?inline \w+ (\w*)correct\(", text, re.MULTILINE)
    assert len(names) == 1
    space = re.findall(r"^namespace (sepcal\w+) \{$", text, re.MULTILINE)
    prefix = names[0] if target == "c" else f"{space[0]}::"
    inputs = outputs = 0
    arguments = []
    for _, size, is_output in arguments_of(text):
        if is_output:
            arguments.append(f"&out[{outputs}]")
            outputs += size
        else:
            arguments.append(f"in[{inputs}]" if size == 1 else f"&in[{inputs}]")
            inputs += size
    main = header.parent / f"main.{SUFFIX[target]}"
    main.write_text(
        C_MAIN.format(
            header=header.name,
            inputs=inputs,
            outputs=outputs,
            kind=kind_of(text),
            self_test=f"{prefix}self_test",
            correct=f"{prefix}correct",
            arguments=", ".join(arguments),
        )
    )
    program = header.parent / f"{header.stem}_{target}_{standard.replace('+', 'x')}"
    narrow = ("-Wdouble-promotion", "-Wfloat-conversion") if kind_of(text) == "float" else ()
    command = [compiler_of(target), f"-std={standard}", *STRICT, *narrow, "-O1"]
    done = subprocess.run(
        [*command, "-o", str(program), str(main), "-lm"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return program


def run_rows(program: Path, rows: Array) -> tuple[Array, Array]:
    """Status (N,) and outputs (N, n), NaN where the status is not 0, of inputs (N, m)."""
    text = "\n".join(" ".join(repr(float(value)) for value in row) for row in rows)
    done = subprocess.run([str(program)], input=text, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"self-test: {done.returncode}"
    table = np.array([[float(v) for v in line.split()] for line in done.stdout.splitlines()])
    return table[:, 0], table[:, 1:]
