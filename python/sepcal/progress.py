# SPDX-License-Identifier: BSD-3-Clause
"""A bar on standard error while something long runs."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

WIDTH = 40


@contextmanager
def progress_bar(shown: bool | None = None) -> Iterator[Callable[[float], None]]:
    """Gives a function of the fraction done; None: shown where standard error is a terminal."""
    is_shown = sys.stderr is not None and (sys.stderr.isatty() if shown is None else shown)
    drawn = -1

    def report_progress(fraction: float) -> None:
        nonlocal drawn
        percent = int(100 * fraction)
        if not is_shown or percent == drawn:
            return
        drawn = percent
        filled = round(WIDTH * fraction)
        sys.stderr.write(f"\r[{'#' * filled}{'.' * (WIDTH - filled)}] {percent:3d} %")
        sys.stderr.flush()

    try:
        yield report_progress
    finally:
        if drawn >= 0:
            sys.stderr.write("\n")
