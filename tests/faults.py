# SPDX-License-Identifier: BSD-3-Clause
"""What loggers and sensors do to a column, for tests to plant: codes, glitches, frozen rows."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Columns = dict[str, NDArray[np.float64]]
Spoil = Callable[[NDArray[np.float64]], None]

ROWS = 1500


def write(columns: Columns, file: Path) -> None:
    """As a CSV file."""
    table = np.column_stack(list(columns.values()))
    np.savetxt(file, table, fmt="%.6f", delimiter=",", header=",".join(columns), comments="")


def one_cell(values: NDArray[np.float64]) -> None:
    values[417] = 9999


def twenty_codes(values: NDArray[np.float64]) -> None:
    values[np.random.default_rng(3).choice(ROWS, 20, replace=False)] = -9999


def burst(values: NDArray[np.float64]) -> None:
    values[600:610] += 10 * values.std()


def minute(values: NDArray[np.float64]) -> None:
    values[700:1000] = values[700]


FAULTS: dict[str, Spoil] = {
    "one cell": one_cell,
    "twenty codes": twenty_codes,
    "burst": burst,
    "frozen minute": minute,
}
