# SPDX-License-Identifier: BSD-3-Clause
"""A bar while something long runs: on standard error, or tqdm's in a notebook or where asked."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Literal

from sepcal import _core

WIDTH = 40


@contextmanager
def progress_bar(shown: bool | Literal["tqdm"] | None = None) -> Iterator[Callable[[float], None]]:
    """Gives a function of the fraction done.

    None: shown where standard error is a terminal, and in a notebook; "tqdm": tqdm.auto's, which is
    the notebook's too where it is installed. Raises Error for "tqdm" without tqdm.
    """
    in_notebook = _is_in_notebook()
    wants_bar = shown == "tqdm" or (in_notebook and shown is not False)
    bar = _tqdm() if wants_bar else None
    if shown == "tqdm" and bar is None:
        raise _core.Error("tqdm is not installed: pip install sepcal[progress]")
    if bar is not None:
        with bar(
            total=100, unit="%", bar_format="{l_bar}{bar}| {elapsed}<{remaining}"
        ) as shown_bar:
            yield lambda fraction: _move_to(shown_bar, fraction)
        return
    is_shown = sys.stderr is not None and (sys.stderr.isatty() if shown is None else bool(shown))
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


def _move_to(bar: Any, fraction: float) -> None:  # noqa: ANN401
    bar.update(round(100 * fraction, 1) - bar.n)


def _tqdm() -> Any:  # noqa: ANN401
    """tqdm.auto's bar; None where it is not installed."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    return tqdm


def _is_in_notebook() -> bool:
    """Whether the code runs in a notebook's kernel."""
    shell = sys.modules.get("IPython")
    running = shell.get_ipython() if shell is not None else None
    return type(running).__name__ == "ZMQInteractiveShell"
