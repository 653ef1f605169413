# SPDX-License-Identifier: BSD-3-Clause
"""Progress of long work: one line on standard error, or tqdm's bar in a notebook or on request."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Literal, TypeAlias

from sepcal import _core
from sepcal.printing import in_line

WIDTH = 40
Report: TypeAlias = Callable[[str, float], None]  # what is being done; of it, the fraction done
Shown: TypeAlias = bool | Literal["tqdm"] | None


@contextmanager
def show_progress(
    name: str = "", shown: Shown = None, *, every: float | None = None
) -> Iterator[Report]:
    """Gives a function of what is being done and of the fraction of it that is done, 0: unknown.

    On a terminal the line is written anew, and wiped at the end.

    Args:
        name: Who does it, "sepcal report".
        shown: None: where standard error is a terminal, and in a notebook; "tqdm": by tqdm.auto,
            which is the notebook's too where it is installed.
        every: Tells the seconds too, and off a terminal a line every so many of them.

    Raises:
        Error: "tqdm" without tqdm.
    """
    wants_bar = shown == "tqdm" or (shown is not False and _is_in_notebook())
    bar = _tqdm() if wants_bar else None
    if shown == "tqdm" and bar is None:
        raise _core.Error("tqdm is not installed: pip install sepcal[progress]")
    if bar is not None:
        with bar(total=100, unit="%", bar_format="{l_bar}{bar}| {elapsed}<{remaining}") as drawn:
            yield lambda task, fraction: _move_to(drawn, task, fraction)
        return
    line = _Line(name, shown, every)
    try:
        yield line.report
    finally:
        line.end()


@contextmanager
def show_steps(
    name: str, progress: Shown | Callable[[str], None] = None
) -> Iterator[Callable[[str], None]]:
    """The same of steps without a length: gives a function of words, the caller's own if it has."""
    if callable(progress):
        yield progress
        return
    with show_progress(name, progress) as report:
        yield lambda what: report(what, 0.0)


@contextmanager
def show_engine(name: str, every: float = 10.0) -> Iterator[None]:
    """The same of what the engine does meanwhile, as it tells it."""
    with show_progress(name, every=every) as report:
        _core.hear_progress(report)
        try:
            yield
        finally:
            _core.hear_progress(None)


class _Line:
    """The line, and the thread that tells the seconds."""

    def __init__(self, name: str, shown: Shown, every: float | None) -> None:
        self._name, self._task, self._fraction = name, "", 0.0
        self._begun, self._said = time.monotonic(), ""
        self._is_timed = every is not None
        self._is_terminal = sys.stderr is not None and sys.stderr.isatty()
        is_wanted = self._is_terminal if shown is None else bool(shown)
        self._is_drawn = sys.stderr is not None and is_wanted
        self._ended = threading.Event()
        if every is not None and sys.stderr is not None:
            tick = 1.0 if self._is_drawn else every
            threading.Thread(target=self._tell_on, args=(tick,), daemon=True).start()

    def report(self, task: str, fraction: float) -> None:
        """Shows what is being done, and how far it is."""
        if task != self._task:
            self._task, self._begun = task, time.monotonic()
        self._fraction = fraction
        if self._is_drawn:
            self._draw()

    def end(self) -> None:
        """Wipes the line of a terminal, and ends that of a file."""
        self._ended.set()
        if self._is_drawn and self._said:
            print("\r\033[K" if self._is_terminal else "\n", end="", file=sys.stderr, flush=True)

    def _tell_on(self, tick: float) -> None:
        while not self._ended.wait(tick):
            if self._is_drawn:
                self._draw()
            else:
                print(self._text(), file=sys.stderr, flush=True)

    def _draw(self) -> None:
        text = self._text()
        if text == self._said or self._ended.is_set():
            return
        self._said = text
        start = "\r\033[K" if self._is_terminal else "\r"
        print(f"{start}{text}", end="", file=sys.stderr, flush=True)

    def _text(self) -> str:
        task = in_line(self._task) or ("at work" if self._is_timed else "")
        text = ": ".join(filter(None, (self._name, task)))
        if self._is_timed:
            gone = time.monotonic() - self._begun
            text += f", {gone:.0f} s"
            if 0.02 < self._fraction < 1.0:
                text += f", about {gone * (1.0 / self._fraction - 1.0):.0f} s left"
        if self._fraction > 0.0:
            filled = round(WIDTH * self._fraction)
            bar = f"[{'#' * filled}{'.' * (WIDTH - filled)}] {int(100 * self._fraction):3d} %"
            text = f"{text} {bar}" if text else bar
        return text


def _move_to(bar: Any, task: str, fraction: float) -> None:  # noqa: ANN401
    if task:
        bar.set_description(in_line(task), refresh=False)
    bar.update(round(100 * fraction, 1) - bar.n)
    bar.refresh()


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
