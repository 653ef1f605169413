# SPDX-License-Identifier: BSD-3-Clause
"""Ctrl-C while something long runs: it ends, says so in one line, and leaves no file behind.

What is started here would take minutes; nothing is asserted of time but that it ends.
"""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from apps import APPS, FIVE_HOLE_OPTIONS, Bench
from sepcal.__main__ import main
from sepcal.reporting import command

PATIENCE = 60.0  # s, for a machine with much else to do
STOPPED = "sepcal-pitot: stopped by Ctrl-C"
TICKS = os.sysconf("SC_CLK_TCK")

BEGIN = """
import sys, time
from concurrent.futures import ProcessPoolExecutor
import numpy as np
import sepcal

def main():
    try:
        print("begins", flush=True)
        work()
    except KeyboardInterrupt:
        print("interrupted")
"""

FIT = """
def work():
    flight = sepcal.read_csv("flight.csv")
    open("at-work", "w").close()
    probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
    sepcal.fit(probe, flight, samples=300_000, threads=2)
main()
"""

OWN_MODEL = """
class Slow:
    inputs = {"t": "s"}
    outputs = {"z": "1"}
    linear = {"a": "1"}
    nonlinear = {"w": ("1/s", 0.5, 2.0)}

    def at(self, u, xi2):
        open("at-work", "w").close()
        time.sleep(0.05)
        return np.cos(xi2[0] * u.t)[:, None, None], np.zeros((len(u.t), 1))

def work():
    t = np.linspace(0.0, 5.0, 2000)
    sepcal.fit(Slow(), {"t": t, "z": np.cos(t)}, samples=5000, threads=2)
main()
"""

TRIALS = """
def wait(rng):
    open(f"trial-{rng.integers(1 << 62)}", "w").close()
    time.sleep(600)

def work():
    sepcal.monte_carlo(wait, trials=20, executor=lambda: ProcessPoolExecutor(2))

if __name__ == "__main__":
    main()
"""


def start(command: list[str | Path], folder: Path) -> subprocess.Popen[str]:
    """In a process of its own, which Ctrl-C reaches even where this one is told to ignore it."""
    return subprocess.Popen(
        [str(word) for word in command],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: (
            signal.signal(signal.SIGINT, signal.default_int_handler)
            and signal.signal(signal.SIGINT, signal.SIG_DFL)
        ),
    )


def processor_time(process: subprocess.Popen[str]) -> float:
    """User time in s."""
    fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) / TICKS


def wait_until(condition) -> None:
    """Fails where it doesn't come true."""
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def interrupt(process: subprocess.Popen[str]) -> tuple[int, str, str]:
    """Ctrl-C; the exit code and what it wrote."""
    process.send_signal(signal.SIGINT)
    try:
        out, err = process.communicate(timeout=PATIENCE)
    finally:
        process.kill()
    return process.returncode, out, err


@pytest.fixture
def long_flight(tmp_path: Path) -> Bench:
    """A flight that much can be asked of."""
    bench = Bench("sepcal-pitot", tmp_path, FIVE_HOLE_OPTIONS, None)
    assert bench.run("simulate", "-o", "flight.csv", "--rows", "5000").code == 0
    assert bench.run("fit", "flight.csv", "-o", "base.json", *FIVE_HOLE_OPTIONS).code == 0
    return bench


@pytest.mark.parametrize(
    "words",
    [
        ("fit", "flight.csv", "--samples", "300000", *FIVE_HOLE_OPTIONS),
        ("fit", "flight.csv", "--samples", "300000", "--threads", "1", *FIVE_HOLE_OPTIONS),
        ("diagnose", "flight.csv", "base.json"),
        ("simulate", "--rows", "2000000"),
    ],
)
def test_an_app_ends_and_writes_nothing(long_flight: Bench, words: tuple[str, ...]):
    folder = long_flight.folder
    before = sorted(folder.iterdir())
    (folder / "old.out").write_text("old")
    process = start([APPS / long_flight.app, *words, "-o", "old.out"], folder)
    wait_until(lambda: processor_time(process) > 0.3)
    code, out, err = interrupt(process)
    assert (code, out) == (130, "")
    # Where a piece of work takes more than a second, as on a busy machine, the app ends in it.
    assert err in (f"{STOPPED}; no file was written\n", f"{STOPPED}\n")
    assert (folder / "old.out").read_text() == "old"
    assert sorted(folder.iterdir()) == sorted([*before, folder / "old.out"])


def test_an_app_that_waits_for_a_pipe_ends_too(tmp_path: Path):
    os.mkfifo(tmp_path / "flight.csv")
    process = start([APPS / "sepcal-mag", "fit", "flight.csv", "-o", "out.json"], tmp_path)
    with open(tmp_path / "flight.csv", "w"):  # waits for the reader
        code, _, err = interrupt(process)
    assert code == 130
    assert err.startswith("sepcal-mag: stopped by Ctrl-C")
    assert len(err.splitlines()) == 1
    assert not (tmp_path / "out.json").exists()


def test_an_app_told_to_ignore_ctrl_c_does(tmp_path: Path):
    command = [APPS / "sepcal-mag", "simulate", "-o", "flight.csv", "--rows", "300000"]
    process = subprocess.Popen(
        command, cwd=tmp_path, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN)
    )
    wait_until(lambda: processor_time(process) > 0.1)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=10 * PATIENCE) == 0
    assert (tmp_path / "flight.csv").exists()


@pytest.mark.parametrize("script", [FIT, OWN_MODEL])
def test_python_raises_keyboard_interrupt(long_flight: Bench, script: str):
    process = start([sys.executable, "-c", BEGIN + script], long_flight.folder)
    wait_until((long_flight.folder / "at-work").exists)
    time.sleep(0.3)
    code, out, err = interrupt(process)
    assert (code, out, err) == (0, "begins\ninterrupted\n", "")


def test_worker_processes_end_at_once(tmp_path: Path):
    (tmp_path / "script.py").write_text(BEGIN + TRIALS)
    process = start([sys.executable, "script.py"], tmp_path)
    wait_until(lambda: len(list(tmp_path.glob("trial-*"))) == 2)
    code, out, _ = interrupt(process)
    assert (code, out) == (0, "begins\ninterrupted\n")


def test_the_report_says_it_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(command, "load", interrupted)
    page = tmp_path / "report.html"
    assert main(["report", "flight.csv", "base.json", "-o", str(page)]) == 130
    assert capsys.readouterr().err == "sepcal report: stopped by Ctrl-C; no file was written\n"
    assert not page.exists()
