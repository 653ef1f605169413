# SPDX-License-Identifier: BSD-3-Clause
"""Runs a flight program on the target and here, and reads what it wrote."""

from __future__ import annotations

import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
KINDS = {"double": np.float64, "float": np.float32}

EMULATOR = [
    "qemu-system-arm",
    "-machine",
    "mps2-an500",
    "-nographic",
    "-monitor",
    "none",
    "-serial",
    "null",
    "-semihosting-config",
    "enable=on,target=native",
    "-icount",
    "shift=6",
    "-kernel",
]
HEAP_AND_EXCEPTIONS = (
    "malloc",
    "_malloc_r",
    "free",
    "_sbrk",
    "_Znwj",
    "_Znaj",
    "_ZdlPv",
    "_ZdaPv",
    "__cxa_throw",
    "__cxa_allocate_exception",
    "_Unwind_Resume",
    "__gxx_personality_v0",
)


@dataclass(frozen=True)
class Answer:
    """What a program wrote, in order, and the deepest stack (bytes; 0 on this machine)."""

    numbers: Array
    stack: int


class Reader:
    """Takes an answer's numbers one after another."""

    def __init__(self, answer: Answer) -> None:
        self._numbers = answer.numbers
        self._next = 0

    def one(self) -> float:
        """The next number."""
        return float(self.many(1)[0])

    def many(self, count: int) -> Array:
        """The next numbers, (count,)."""
        self._next += count
        assert self._next <= self._numbers.size, "the program wrote too little"
        return self._numbers[self._next - count : self._next]

    def square(self, n: int) -> Array:
        """The next matrix, (n, n), written column by column."""
        return self.many(n * n).reshape((n, n), order="F")

    def end(self) -> None:
        """Checks that all was taken."""
        assert self._next == self._numbers.size, "the program wrote too much"


stacks: dict[str, int] = {}  # bytes, by program


class Checks:
    """What held and what didn't, a line each."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.failed = 0

    def hold(self, what: str, holds: bool) -> None:
        """Adds a line, and counts it where it doesn't hold."""
        self.lines.append(f"  {'ok    ' if holds else 'FAILED'}  {what}")
        self.failed += not holds


def run_program(folder: Path, name: str, numbers: Array, *, expect_trap: str = "") -> Answer:
    """Runs a program in a folder of its own. Raises RuntimeError where it fails otherwise."""
    on_board = folder.name == "cortex-m7"
    with tempfile.TemporaryDirectory() as scratch:
        numbers.astype("<f8").tofile(Path(scratch) / "in.bin")
        program = [str(folder / name)]
        done = subprocess.run(
            [*EMULATOR, *program] if on_board else program,
            cwd=scratch,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        said = (done.stdout + done.stderr).strip()
        if expect_trap:
            if done.returncode == 0 or expect_trap not in said:
                raise RuntimeError(f"{name} should have been trapped; it said: {said}")
            return Answer(np.empty(0), 0)
        if done.returncode != 0:
            raise RuntimeError(f"{name} in {folder.name} failed: {said}")
        written = np.fromfile(Path(scratch) / "out.bin", dtype="<f8")
    if on_board:
        stacks[name] = int(written[-1])
    return Answer(written[:-1], int(written[-1]))


def run_both(folder: Path, name: str, numbers: Array) -> tuple[Answer, Answer]:
    """On the target and here, side by side."""
    with ThreadPoolExecutor(2) as pool:
        here = pool.submit(run_program, folder / "host", name, numbers)
        board = pool.submit(run_program, folder / "cortex-m7", name, numbers)
        return board.result(), here.result()


def symbols(program: Path) -> set[str]:
    """The names in an image."""
    listed = subprocess.run(
        ["arm-none-eabi-nm", str(program)], capture_output=True, text=True, check=True
    )
    return {line.split()[-1] for line in listed.stdout.splitlines()}


def sizes(program: Path) -> tuple[int, int, int]:
    """Bytes of code with constants, of initialised data, of zeroed data."""
    listed = subprocess.run(
        ["arm-none-eabi-size", str(program)], capture_output=True, text=True, check=True
    )
    text, data, bss = (int(word) for word in listed.stdout.splitlines()[1].split()[:3])
    return text, data, bss


def last_digits(board: Array, here: Array) -> float:
    """The largest difference in units of the last place of the larger number."""
    both = np.isfinite(board) & np.isfinite(here)
    assert np.array_equal(np.isfinite(board), np.isfinite(here))
    if not both.any():
        return 0.0
    place = np.spacing(np.maximum(np.abs(board[both]), np.abs(here[both])))
    return float(np.max(np.abs(board[both] - here[both]) / place))
