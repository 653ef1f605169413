# SPDX-License-Identifier: BSD-3-Clause
"""The core from C: what a program in C99 gives is what the same models give from C++."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from target_checks.calibrations import apply_all
from target_checks.machines import KINDS, Checks, Reader, run_program
from target_checks.probe_rows import K, fly_probe, probe_rows
from target_checks.streams import lay_out, read_stream

LINE = (0.0, 1.0, 0.9, 1.4)  # open, then determined; z = 1, 3, 2, 6 at t = 0 to 3


# Of offset and slope: S_tt = 5, the mean of t's squares 3.5.
LINE_ERRORS = (0.7**0.5, 0.2**0.5)


def check_from_c(folder: Path, checks: Checks) -> list[str]:
    """Corrections, a start and its filter, least squares: in C on the target, and in C++ there."""
    probes = apply_all()
    compass = probes[0]
    rows = lay_out(probe_rows(fly_probe(6)), 200, 20)[:1000]
    stream = np.concatenate([[0.2] * 3, [rows.shape[0]], rows.ravel()])
    everything = np.concatenate([probe.numbers for probe in probes])
    board = folder / "cortex-m7"
    for scalar in KINDS:
        in_c = Reader(run_program(board, f"from_c_{scalar}", np.r_[compass.numbers, stream]))
        in_cpp = Reader(run_program(board, f"corrections_{scalar}", everything))
        unset, known, unknown, nowhere = in_c.many(4)
        count, outputs = compass.answer.shape
        same = np.array_equal(in_c.many(count * (outputs + 1)), in_cpp.many(count * (outputs + 1)))
        checks.hold(
            f"from C, {scalar}: {count} rows of a magnetometer with three effects are those of C++ "
            "to the last digit, names that are none are refused",
            same and (unset, known, unknown, nowhere) == (1.0, 1.0, 0.0, -1.0),
        )
        expected = read_stream(
            run_program(board, f"probe_stream_{scalar}", np.r_[K, K, stream]), 10
        )
        early, status, calls, most_calls = in_c.many(4)
        places = tuple(in_c.many(3))
        start, end, errors = in_c.many(10), in_c.many(10), in_c.many(10)
        refused = in_c.one()
        deviations = np.linalg.norm(np.linalg.inv(expected.end_root), axis=1)
        far = float(np.max(np.abs(errors / deviations - 1.0)))
        checks.hold(
            f"  a two-stage start and its filter over {rows.shape[0]} rows likewise; standard "
            f"errors within {far:.1e} of numpy's",
            (early, status, refused) == (1.0, 2.0, expected.refused)
            and (calls, most_calls) == (expected.calls, expected.most_calls)
            and places == (1.0, 9.0, 10.0)
            and np.array_equal(start, expected.start)
            and np.array_equal(end, expected.end)
            and far <= (1e-9 if scalar == "double" else 1e-2),
        )
        digits = 1e-12 if scalar == "double" else 1e-6
        line = in_c.many(6)
        checks.hold(
            f"  a line by least squares is the one that can be written down, to {digits:.0e}",
            bool(np.allclose(line, [*LINE, *LINE_ERRORS], rtol=digits, atol=digits)),
        )
        in_c.end()
    return []
