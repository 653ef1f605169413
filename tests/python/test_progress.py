# SPDX-License-Identifier: BSD-3-Clause
"""What long work shows is one thing everywhere: a line, tqdm's bar, or the caller's function."""

import io
import sys
import types
import warnings
from pathlib import Path

import pytest

import sepcal
from refusals import refuse
from sepcal.progress import show_engine, show_progress


class Terminal(io.StringIO):
    """Standard error that says it is a terminal."""

    def isatty(self) -> bool:
        """It is one."""
        return True


def open_terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    return terminal


def write_report(file: Path, progress: object = None) -> None:
    flight = sepcal.simulate("pitot-static", rows=100)
    base = sepcal.fit(sepcal.PitotStatic(), flight)
    found = base.diagnose(only=["time_offset"], simulations=2)
    sepcal.report(base, file, diagnosis=found, progress=progress)  # type: ignore[arg-type]


def test_a_terminals_line_is_written_anew_and_wiped(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = open_terminal(monkeypatch)
    with show_progress("sepcal work") as report:
        report("first", 0.0)
        report("first", 0.0)
        report("second", 0.5)
    wiped = "\r\033[K"
    half = "[" + 20 * "#" + 20 * "." + "]  50 %"
    lines = f"{wiped}sepcal work: first{wiped}sepcal work: second {half}{wiped}"
    assert terminal.getvalue() == lines


def test_nothing_steers_the_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = open_terminal(monkeypatch)
    with show_progress("work") as report:
        report("a\x1b[2Jb\nc", 0.0)
    assert "\x1b[2J" not in terminal.getvalue()
    assert "\n" not in terminal.getvalue()


def test_off_a_terminal_nothing_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    with show_progress("sepcal work") as report:
        report("first", 0.5)
    assert capsys.readouterr().err == ""


def test_without_standard_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", None)
    for shown in (None, True):
        with show_progress("sepcal work", shown, every=0.01) as report:
            report("first", 0.5)


def test_a_report_says_what_it_does(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    terminal = open_terminal(monkeypatch)
    pytest.importorskip("plotly")
    write_report(tmp_path / "r.html")
    assert "sepcal report: drawing" in terminal.getvalue()
    assert terminal.getvalue().endswith("\r\033[K")
    steps: list[str] = []
    write_report(tmp_path / "r.html", steps.append)
    assert steps[-1] == "drawing"
    before = terminal.getvalue()
    write_report(tmp_path / "r.html", progress=False)
    assert terminal.getvalue() == before


def test_the_engine_tells_what_it_does(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = open_terminal(monkeypatch)
    flight = sepcal.datasets.load("pitot")
    with show_engine("sepcal model fit"):
        sepcal.fit(sepcal.PitotStatic(), flight)
    assert "sepcal model fit: stage one, 0 s" in terminal.getvalue()


def test_tqdms_bar(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("tqdm", reason="pip install sepcal[progress]")
    sepcal.monte_carlo(lambda rng: 1.0, 4, progress="tqdm")
    assert "100%" in capsys.readouterr().err


def test_tqdms_bar_has_the_words(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    pytest.importorskip("tqdm", reason="pip install sepcal[progress]")
    pytest.importorskip("plotly")
    write_report(tmp_path / "r.html", progress="tqdm")
    assert "drawing" in capsys.readouterr().err


def test_a_notebook_has_tqdms(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("tqdm", reason="pip install sepcal[progress]")
    kernel = type("ZMQInteractiveShell", (), {})()
    shell = types.SimpleNamespace(get_ipython=lambda: kernel, version_info=(0,))
    monkeypatch.setitem(sys.modules, "IPython", shell)  # type: ignore[arg-type]
    with warnings.catch_warnings():  # of tqdm, where ipywidgets is not installed
        warnings.simplefilter("ignore")
        sepcal.monte_carlo(lambda rng: 1.0, 4)
    sepcal.monte_carlo(lambda rng: 1.0, 4, progress=False)
    assert "100%" in capsys.readouterr().err


def test_without_tqdm(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    refuse(
        lambda: sepcal.monte_carlo(lambda rng: 1.0, 4, progress="tqdm"),
        "tqdm is not installed: pip install sepcal[progress]",
    )
