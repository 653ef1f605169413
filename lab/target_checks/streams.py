# SPDX-License-Identifier: BSD-3-Clause
"""(c): a two-stage start on the first rows, and an iterated filter on the rest."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import sepcal
from target_checks.machines import Answer, Array, Checks, Reader, run_both, run_program
from target_checks.probe_rows import K, fly_probe, probe_rows


@dataclass(frozen=True)
class Streamed:
    """How a stream ended: the start's and the filter's parameters and information roots."""

    status: int
    calls: int
    most_calls: int
    iterations: int
    start: Array
    start_root: Array
    end: Array
    end_root: Array
    refused: int
    of_start: int
    of_update: int


def read_stream(answer: Answer, n: int) -> Streamed:
    """Of n parameters."""
    reader = Reader(answer)
    status, calls, most_calls, iterations = (int(reader.one()) for _ in range(4))
    start, start_root = reader.many(n), reader.square(n)
    end, end_root = reader.many(n), reader.square(n)
    refused, of_start, of_update = (int(reader.one()) for _ in range(3))
    reader.end()
    return Streamed(
        status,
        calls,
        most_calls,
        iterations,
        start,
        start_root,
        end,
        end_root,
        refused,
        of_start,
        of_update,
    )


def check_stream(
    folder: Path, checks: Checks, program: str, what: str, numbers: Array, n: int
) -> list[str]:
    """(c): start and filter on the target and here; in float against double."""
    board, here = (read_stream(one, n) for one in run_both(folder, f"{program}_double", numbers))
    apart = float(np.linalg.norm(here.end_root @ (board.end - here.end)))
    at_start = float(np.linalg.norm(here.start_root @ (board.start - here.start)))
    checks.hold(
        f"{what}: start done in {board.calls} calls of at most {board.most_calls}, worst start "
        f"{board.iterations} trial steps; target and this machine {at_start:.1e} standard errors "
        f"apart after the start, {apart:.1e} after the filter",
        board.status == here.status == 2
        and board.calls == here.calls <= board.most_calls
        and board.refused == 0
        and at_start <= 1e-9
        and apart <= 1e-9,
    )
    coarse = read_stream(run_program(folder / "cortex-m7", f"{program}_float", numbers), n)
    off = float(np.linalg.norm(here.end_root @ (coarse.end - here.end)))
    lost = float(np.max(np.abs(coarse.end_root - here.end_root)) / np.max(np.abs(here.end_root)))
    checks.hold(
        f"  in float: {off:.1e} standard errors from double after the filter, its information "
        f"within {lost:.1e}",
        coarse.status == 2 and coarse.refused == 0 and off <= 1.0 and lost <= 0.02,
    )
    return [
        f"two-stage start, {what}, double: {board.of_start} instructions in the worst call, "
        f"float: {coarse.of_start}",
        f"iterated update, {what}, double: {board.of_update} instructions in the worst row, "
        f"float: {coarse.of_update}",
    ]


def lay_out(rows: Array, start: int, every: int) -> Array:
    """Every so many rows for the start, and behind them what comes after the last of these."""
    return np.concatenate([rows[: start * every : every], rows[start * every :]])


def check_streams(folder: Path, checks: Checks) -> list[str]:
    """(c) of a simulated probe and of a recorded tube."""
    flight = fly_probe(6)
    rows = lay_out(probe_rows(flight), 200, 20)[:3000]
    numbers = np.concatenate([[K, K], [0.2] * 3, [rows.shape[0]], rows.ravel()])
    what = f"five-hole probe, {rows.shape[0]} simulated rows"
    lines = check_stream(folder, checks, "probe_stream", what, numbers, 10)

    recorded = Path(os.environ.get("SEPCAL_FIXTURES", "")) / "uav_pitot_static_2022_05_07_11.csv"
    if not recorded.is_file():
        missing = f"there is no {recorded.name} in $SEPCAL_FIXTURES"
        checks.lines.append(f"  skipped  a recorded flight: {missing}")
        return lines
    uav = sepcal.read_csv(str(recorded))
    columns = ("vn_mps", "ve_mps", "vd_mps", "airspeed_mps")
    rows = lay_out(np.column_stack([uav[column] for column in columns]), 300, 4)
    numbers = np.concatenate([[0.8], [rows.shape[0]], rows.ravel()])
    what = f"recorded UAV, {rows.shape[0]} rows"
    return lines + check_stream(folder, checks, "tube_stream", what, numbers, 4)
