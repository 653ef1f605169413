# SPDX-License-Identifier: BSD-3-Clause
"""Parameters that jump in flight: found on the target as here, and followed over a band."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from target_checks.machines import Answer, Array, Checks, Reader, run_both, run_program

RATE, ROWS, AT = 50, 2500, 1500  # Hz; the jump's row
AIRSPEED = 60.0
NAMES = ("b_alpha", "b_q", "b_az", "Za", "Ma", "Mq", "Zd", "Md")
TRUTH = np.array([0.003, -0.004, 0.1, -1.2, -6.0, -1.8, -0.12, -9.0])
START = np.array([0.001, 0.001, 0.02, 0.01, 0.05, 0.03, 0.01, 0.05])  # standard deviations
NOISE = np.array([0.005, 0.01, 0.15])
DENSITY = np.array([0.005, 0.02])


def fly() -> Array:
    """time, elevator, airspeed, alpha, q, az of a short period whose Ma and Md halve, (rows, 6)."""
    draw = np.random.default_rng(12)
    time = np.arange(ROWS) / RATE
    elevator = 0.04 * np.sign(np.sin(2.1 * time)) * (np.sin(0.5 * time) > 0)
    x = np.zeros(2)
    rows = np.empty((ROWS, 6))
    for k in range(ROWS):
        _, _, _, Za, Ma, Mq, Zd, Md = TRUTH
        if k > AT:
            Ma, Md = Ma / 2, Md / 2
        force = AIRSPEED * (Za * x[0] + Zd * elevator[k])
        z = np.array([x[0], x[1], force]) + TRUTH[:3] + NOISE * draw.standard_normal(3)
        rows[k] = time[k], elevator[k], AIRSPEED, *z
        ahead = elevator[min(k + 1, ROWS - 1)]
        for part in range(20):
            dt = 1.0 / RATE / 20
            e = elevator[k] + (ahead - elevator[k]) * (part + 0.5) / 20
            rate = np.array([Za * x[0] + x[1] + Zd * e, Ma * x[0] + Mq * x[1] + Md * e])
            x = x + dt * rate + np.sqrt(dt) * DENSITY * draw.standard_normal(2)
    return rows


@dataclass(frozen=True)
class Changed:
    """What a run found, and how its filter ended."""

    refused: int
    found: int
    rows: int
    size: Array
    deviation: Array
    end: Array
    root: Array
    plain: int
    tested: int


def read_changed(answer: Answer) -> Changed:
    """The first jump, and the instructions of the worst row."""
    reader = Reader(answer)
    refused, found, rows = (int(reader.one()) for _ in range(3))
    size, deviation, end, root = reader.many(8), reader.many(8), reader.many(10), reader.square(10)
    plain, tested = int(reader.one()), int(reader.one())
    reader.end()
    return Changed(refused, found, rows, size, deviation, end, root, plain, tested)


def check_changing(folder: Path, checks: Checks) -> list[str]:
    """Target against this machine, and both against the truth."""
    rng = np.random.default_rng(5)
    start = np.concatenate([[0.0, 0.0], TRUTH + START * rng.standard_normal(8)])
    deviation = np.concatenate([[0.01, 0.02], START])
    rows = fly()
    numbers = np.concatenate([start, deviation, DENSITY, NOISE, [ROWS], rows.ravel()])
    board, here = (read_changed(one) for one in run_both(folder, "changing_double", numbers))
    apart = float(np.max(np.abs(board.end - here.end) / np.linalg.norm(here.root, axis=0)))
    named = [name for name, size in zip(NAMES, here.size, strict=True) if size != 0.0]
    right = np.array([0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 4.5])
    z = (here.size - right)[[4, 7]] / here.deviation[[4, 7]]
    late = here.found - here.rows - AT
    checks.hold(
        f"Ma and Md halve at row {AT}: {' and '.join(named)} named {here.found - AT} rows later, "
        f"onset {late:+d} rows off, sizes {z[0]:+.1f} and {z[1]:+.1f} standard errors; target and "
        f"this machine {apart:.1e} standard errors apart at the end",
        named == ["Ma", "Md"]
        and board.found == here.found
        and board.rows == here.rows
        and here.found - AT <= 5 * RATE
        and abs(late) <= 50
        and float(np.max(np.abs(z))) < 4.0
        and board.refused == here.refused == 0
        and apart <= 1e-6,
    )
    coarse = read_changed(run_program(folder / "cortex-m7", "changing_float", numbers))
    off = float(np.max(np.abs(coarse.end - here.end) / np.linalg.norm(here.root, axis=0)))
    checks.hold(
        f"  in float: found {coarse.found - here.found:+d} rows from double, "
        f"{off:.1e} standard errors apart at the end",
        coarse.refused == 0 and abs(coarse.found - here.found) <= 50 and off <= 1.0,
    )
    return [
        f"joint filter of a short period, {scalar}: {one.plain} instructions in the worst row, "
        f"{one.tested} with the test of changes, 12 onsets"
        for scalar, one in (("double", board), ("float", coarse))
    ]


FREQUENCIES = np.linspace(0.1, 2.0, 20)  # Hz
FORGETTING = 0.998


def solve_band(rows: Array) -> Array:
    """Ma, Mq, Md of q' = Ma alpha + Mq q + Md elevator + c over the band, (3,)."""
    time, elevator, alpha, q = rows[:, [0, 1, 3, 4]].T
    fade = FORGETTING ** (0.5 * np.arange(time.size)[::-1])
    since = time - time[0]
    jw = 2j * np.pi * FREQUENCIES
    wave = fade * np.exp(-np.outer(jw, since))
    columns = np.column_stack([alpha - alpha[0], q - q[0], elevator - elevator[0]])
    decay = -0.5 * np.log(FORGETTING) * RATE
    z = (jw - decay) * (wave @ columns[:, 1])
    ends = np.column_stack([wave @ np.ones(time.size), wave @ since, wave[:, -1], np.ones(20)])
    A = np.column_stack([wave @ columns, ends])
    parts = np.vstack([A.real, A.imag])
    unit = np.linalg.norm(parts, axis=0)
    found = np.linalg.lstsq(parts / unit, np.r_[z.real, z.imag], rcond=None)[0] / unit
    return np.asarray(found[:3])


def check_band(folder: Path, checks: Checks) -> list[str]:
    """The recursive Fourier transform on the target against NumPy's least squares of all rows."""
    rows = fly()
    flown = rows[:, [0, 3, 4, 1]]
    numbers = np.concatenate([FREQUENCIES, [FORGETTING, ROWS], flown.ravel()])
    here = solve_band(rows)
    lines = []
    for scalar, most in (("double", 1e-6), ("float", 0.5)):
        reader = Reader(run_program(folder / "cortex-m7", f"band_{scalar}", numbers))
        refused, xi, deviation = int(reader.one()), reader.many(4), reader.many(4)
        off = float(np.max(np.abs(xi[:3] - here) / deviation[:3]))
        checks.hold(
            f"recursive Fourier transform, {scalar}, {ROWS} rows: Ma, Mq, Md within {off:.1e} "
            "standard errors of NumPy's least squares over the band",
            refused == 0 and off <= most,
        )
        row, estimate = int(reader.one()), int(reader.one())
        reader.end()
        lines.append(
            f"recursive Fourier transform, 4 regressors, 20 frequencies, {scalar}: {row} "
            f"instructions a row, {estimate} an estimate"
        )
    return lines
