# SPDX-License-Identifier: BSD-3-Clause
"""Records that are no start: ten rows at one heading."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from target_checks.machines import Array, Checks, run_both
from target_checks.probe_rows import K


def bad_record(draws: np.random.Generator, rows: int) -> Array:
    """Ten rows at one heading, and what instruments do beside: steps, jumps, zeros, lost values."""
    record = np.zeros((rows, 17))
    pressure = 10.0 ** draws.uniform(0.5, 3.5)
    wander = 10.0 ** draws.uniform(-12.0, 0.0, size=17)
    record[:, :3] = draws.uniform(-3.2, 3.2, size=3) * np.array([0.2, 0.2, 1.0])
    record[:, 6] = pressure
    record[:, 8:10] = pressure * draws.normal(0.0, 0.3, size=2)
    record[:, 10] = draws.uniform(0.4, 1.3)
    record[:, 14:] = draws.normal(0.0, 30.0, size=3)
    record += wander * record * draws.normal(size=record.shape)
    record[:, 14:] += 10.0 ** draws.uniform(-6.0, 2.0) * draws.normal(size=(rows, 3))
    kind = draws.integers(0, 8)
    if kind == 0:
        record[draws.integers(0, rows), 14:] = np.nan
    elif kind == 1:
        record[draws.integers(0, rows), draws.integers(0, 17)] *= 1e6
    elif kind == 2:
        record[:, draws.integers(0, 17)] = 0.0
    elif kind == 3:
        record[draws.integers(0, rows), draws.integers(0, 14)] = np.nan
    elif kind == 4:
        record[:, 6] *= -1.0
    elif kind == 5:
        record = np.round(record, 1)
    elif kind == 6:
        record[:] = record[0]
    return record


def check_bad_records(folder: Path, checks: Checks) -> list[str]:
    """A thousand records that are no start: each ends, in no more calls than promised."""
    draws = np.random.default_rng(20)
    count, rows = 1000, 10
    records = [np.concatenate([[0.2], bad_record(draws, rows).ravel()]) for _ in range(count)]
    numbers = np.concatenate([[K, K, count], *records])
    board, here = run_both(folder, "bad_records", numbers)
    ended = board.numbers.reshape(count, 5)
    names = ("collecting", "working", "done", "not converged", "not determined", "refused")
    tally = {name: int(np.sum(ended[:, 0] == k)) for k, name in enumerate(names)}
    checks.hold(
        f"{count} records of {rows} rows at one heading each end in a status: "
        + ", ".join(f"{many} {name}" for name, many in tally.items() if many),
        tally["collecting"] == tally["working"] == 0 and bool(np.all(ended[:, 1] <= ended[:, 2])),
    )
    same = np.mean(ended[:, 0] == here.numbers.reshape(count, 5)[:, 0])
    checks.hold(
        f"  {100 * same:.1f} % end alike here (what rounds decides the others)", same > 0.95
    )
    return [
        f"two-stage start, {count} bad records: worst call {int(ended[:, 4].max())} instructions, "
        f"most calls {int(ended[:, 1].max())} of {int(ended[0, 2])}, worst start "
        f"{int(ended[:, 3].max())} trial steps"
    ]
