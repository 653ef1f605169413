# SPDX-License-Identifier: BSD-3-Clause
"""(a): calibrations with three effects each, applied on the target; exported headers there."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import sepcal
from target_checks.calibrations import apply_all
from target_checks.machines import KINDS, Checks, Reader, last_digits, run_both, run_program


def write_headers(folder: Path) -> None:
    """Exports the calibrations as C headers in double and float, for scripts/target to build."""
    folder.mkdir(parents=True, exist_ok=True)
    for probe in apply_all():
        stem = probe.name.replace(" ", "_").replace("-", "_").lower()
        for single, kind in ((False, ""), (True, "_float")):
            file = folder / f"{stem}{kind}.h"
            sepcal.export(probe.calibration, file, to="c", single=single, force=True)


def check_headers(folder: Path, checks: Checks) -> list[str]:
    """Every exported header's self-test, on the target."""
    lines = []
    for header in sorted((folder / "headers").glob("*.h")):
        reader = Reader(run_program(folder / "cortex-m7", f"header_{header.stem}", np.zeros(1)))
        checks.hold(f"exported header {header.name}: its self-test passes", reader.one() == 0.0)
        lines.append(f"self-test of {header.name}, three rows: {reader.one():.0f} instructions")
    return lines


def check_corrections(folder: Path, checks: Checks) -> list[str]:
    """(a): the target's corrections are this machine's, and apply()'s."""
    probes = apply_all()
    numbers = np.concatenate([probe.numbers for probe in probes])
    lines = []
    for scalar, promised in (("double", 1e-12), ("float", 2e-5)):
        board, here = (Reader(one) for one in run_both(folder, f"corrections_{scalar}", numbers))
        for probe in probes:
            rows, outputs = probe.answer.shape
            on_board = board.many(rows * (outputs + 1)).reshape(rows, -1)
            on_host = here.many(rows * (outputs + 1)).reshape(rows, -1)
            apart = last_digits(
                on_board[:, 1:].astype(KINDS[scalar]), on_host[:, 1:].astype(KINDS[scalar])
            )
            size = np.max(np.abs(probe.answer), axis=0)
            error = float(np.max(np.abs(on_board[:, 1:] - probe.answer) / size))
            well = not on_board[:, 0].any() and not on_host[:, 0].any()
            checks.hold(
                f"{probe.name}, three effects, {scalar}, {rows} rows: target and this machine "
                f"{apart:.0f} last places apart; from apply() {error:.1e} of the largest",
                well and apart <= 64 and error <= promised,
            )
            lines.append(f"correct, {probe.name}, {scalar}: {board.one():.0f} instructions a row")
            here.one()
        board.end()
    return lines
