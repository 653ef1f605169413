# SPDX-License-Identifier: BSD-3-Clause
"""(b): recursive least squares on the target, and the batch's triangular factor."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from target_checks.machines import Checks, Reader, run_both
from target_checks.probe_rows import LINEAR, NONLINEAR, K, fly_probe, linear_rows, probe_rows


def check_recursion(folder: Path, checks: Checks) -> list[str]:
    """(b): row by row on the target, and the batch's triangular factor here by numpy's QR."""
    flight = fly_probe(5)
    rows = probe_rows(flight)[:4000]
    xi2 = np.array([flight.truth[name] for name in NONLINEAR])
    nominal = np.round([flight.truth[name] for name in LINEAR], 1)
    noise = 0.2
    numbers = np.concatenate([[K, K], xi2, nominal, [noise, rows.shape[0]], rows.ravel()])
    A, rest = linear_rows(rows, xi2)
    T = np.linalg.qr(np.column_stack([A, rest - A @ nominal]) / noise, mode="r")
    T *= np.sign(np.diag(T))[:, None]
    batch = np.linalg.solve(T[:5, :5], T[:5, 5])
    error = np.linalg.norm(np.linalg.inv(T[:5, :5]), axis=1)
    lines = []
    for scalar, promised, kept in (("double", 1e-12, 1e-6), ("float", 0.01, 1.0)):
        board, here = (Reader(one) for one in run_both(folder, f"recursion_{scalar}", numbers))
        refused, refused_here = board.many(3), here.many(3)
        triangle, triangle_here = board.square(6), here.square(6)
        ends = [board.many(5) for _ in range(3)]
        root, information, covariance = (float(np.max(np.abs(end - batch) / error)) for end in ends)
        units = np.linalg.norm(T, axis=0)
        checks.hold(
            f"recursive least squares, {scalar}, {rows.shape[0]} rows: information root within "
            f"{root:.1e} standard errors of the batch, its triangle within "
            f"{np.max(np.abs(triangle - T) / units):.1e} of its columns' lengths of the batch's, "
            f"{np.max(np.abs(triangle - triangle_here) / units):.1e} of this machine's",
            not refused[0] and not refused_here[0] and root <= promised,
        )
        squared = f"within {information:.1e}" if not refused[1] else "refuses rows"
        checks.hold(
            f"  from a start of 1000 units, {scalar}: the covariance's recursion within "
            f"{covariance:.1e}, the information's, which is squared, {squared}",
            not refused[2]
            and covariance <= kept
            and (scalar == "float" or (information <= kept and not refused[1])),
        )
        lines.append(
            f"information root, a row of 3 and 5, {scalar}: {board.one():.0f} instructions"
        )
        lines.append(f"covariance recursion, the same, {scalar}: {board.one():.0f} instructions")
        board.end()
    return lines
