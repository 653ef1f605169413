# SPDX-License-Identifier: BSD-3-Clause
"""What is in the images, and how large they are."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from target_checks.machines import HEAP_AND_EXCEPTIONS, Checks, run_program, sizes, stacks, symbols


def check_images(folder: Path, checks: Checks) -> list[str]:
    """No heap and no exceptions in any image; what is planted is seen."""
    board = folder / "cortex-m7"
    programs = sorted(p for p in board.iterdir() if p.is_file() and os.access(p, os.X_OK))
    real = [program for program in programs if not program.name.startswith("planted")]
    found = {name.name: symbols(name) & set(HEAP_AND_EXCEPTIONS) for name in programs}
    checks.hold(
        f"no malloc, operator new or __cxa_throw in {len(real)} images",
        bool(real) and not any(found[program.name] for program in real),
    )
    checks.hold("  and a planted malloc is seen", bool(found["planted_heap"]))
    run_program(board, "planted_assertion", np.array([5.0]), expect_trap="trapped: index >= 0")
    checks.hold("no trap fired; a planted assertion's did", True)
    return []


def measure_images(folder: Path) -> list[str]:
    """Bytes of each program that was run."""
    lines = []
    for name, stack in sorted(stacks.items()):
        text, data, bss = sizes(folder / "cortex-m7" / name)
        lines.append(f"{name:22} text {text:6}, data {data:5}, bss {bss:6}, stack {stack:6} bytes")
    return lines
