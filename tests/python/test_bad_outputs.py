# SPDX-License-Identifier: BSD-3-Clause
"""Outputs that can't be written: one appears whole or not at all, and the old one survives."""

import ctypes
import os
import resource
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from apps import APPS, OLD_OUTPUT, Bench, assert_one_line, parse_json, read_folder


def test_an_output_folder_that_is_not_there(bench: Bench):
    before = read_folder(bench.folder)
    for command in (
        ("fit", "flight.csv", *bench.options),
        ("apply", "flight.csv", "base.json"),
        ("simulate",),
    ):
        refused = bench.run(*command, "-o", "results/output")
        assert_one_line(bench, refused, "results/output", "folder 'results' isn't there", "make it")
    assert read_folder(bench.folder) == before


def test_a_folder_for_an_output(bench: Bench):
    (bench.folder / "results").mkdir()
    refused = bench.run("fit", "flight.csv", *bench.options, "-o", "results")
    assert_one_line(bench, refused, "results: is a folder", "name a file in it")
    assert list((bench.folder / "results").iterdir()) == []


def limit_files() -> None:
    """No file may grow beyond 4 KiB: a calibration is about 10, the logs are more."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


def commands_that_write(bench: Bench) -> Iterator[tuple[str, ...]]:
    yield ("fit", "flight.csv", *bench.options)
    yield ("apply", "flight.csv", "base.json")
    yield ("simulate", "--rows", "500")


@pytest.mark.parametrize("verb", ["fit", "apply", "simulate"])
@pytest.mark.parametrize("old", [True, False])
def test_a_quota_that_is_used_up(bench: Bench, verb: str, old: bool):
    if old:
        (bench.folder / "output").write_text(OLD_OUTPUT)
    before = read_folder(bench.folder)
    (command,) = (one for one in commands_that_write(bench) if one[0] == verb)
    refused = bench.run(*command, "-o", "output", before=limit_files)
    assert_one_line(bench, refused, "output: writing failed: File too large")
    assert read_folder(bench.folder) == before


@pytest.fixture
def small_disc(tmp_path: Path) -> Iterator[Path]:
    """A file system of 8 KiB, where this user may mount one."""
    libc = ctypes.CDLL(None, use_errno=True)
    disc = tmp_path / "disc"
    disc.mkdir()
    if libc.mount(b"tmpfs", bytes(disc), b"tmpfs", 0, b"size=8k") != 0:
        pytest.skip(f"no small disc to fill: mount: {os.strerror(ctypes.get_errno())}")
    yield disc
    assert libc.umount(bytes(disc)) == 0


@pytest.mark.parametrize("verb", ["fit", "apply", "simulate"])
def test_a_disc_that_fills_up(bench: Bench, small_disc: Path, verb: str):
    """The old output survives, and nothing half written is left on the disc."""
    (small_disc / "output").write_text(OLD_OUTPUT)
    (command,) = (one for one in commands_that_write(bench) if one[0] == verb)
    refused = bench.run(*command, "-o", small_disc / "output")
    assert_one_line(bench, refused, f"{small_disc}/output: writing failed: No space left")
    assert read_folder(small_disc) == {"output": OLD_OUTPUT.encode()}


@pytest.mark.parametrize("verb", ["fit", "compare", "apply", "simulate", "effects"])
def test_a_standard_output_that_is_full(bench: Bench, verb: str):
    commands = {one[0]: one for one in commands_that_write(bench)}
    commands |= {"compare": ("compare", "flight.csv", "base.json"), "effects": ("effects",)}
    output = () if verb in ("compare", "effects") else ("-o", "output")

    def redirect() -> None:
        os.dup2(os.open("/dev/full", os.O_WRONLY), 1)

    refused = bench.run(*commands[verb], *output, before=redirect)
    assert_one_line(bench, refused, "standard output can't be written")


def test_the_log_is_not_the_output(bench: Bench):
    """A mistyped -o must not cost the only copy of a flight, under whatever name it goes."""
    (bench.folder / "alias.csv").symlink_to("flight.csv")
    before = read_folder(bench.folder)
    for output in ("flight.csv", "./flight.csv", "alias.csv"):
        for command in (
            ("fit", "flight.csv", *bench.options),
            ("apply", "flight.csv", "base.json"),
        ):
            assert_one_line(bench, bench.run(*command, "-o", output), output, "another")
            assert read_folder(bench.folder) == before


def test_the_calibration_is_not_the_output(bench: Bench):
    before = read_folder(bench.folder)
    refused = bench.run("apply", "flight.csv", "base.json", "-o", "base.json")
    assert_one_line(bench, refused, "base.json", "another")
    assert read_folder(bench.folder) == before


def test_the_truth_is_not_the_flight(bench: Bench):
    """Two results in one file would leave one of them."""
    before = read_folder(bench.folder)
    refused = bench.run("simulate", "-o", "output", "--truth", "output", "--rows", "5")
    assert_one_line(bench, refused, "output")
    assert read_folder(bench.folder) == before


@pytest.mark.parametrize(
    "command",
    [("simulate", "--rows", "10000000"), ("fit", "flight.csv", "--samples", "1000000000")],
)
def test_too_little_memory(bench: Bench, command: tuple[str, ...]):
    """Said in words, not in the name of a C++ exception."""

    def limit_memory() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (400 << 20, 400 << 20))

    before = read_folder(bench.folder)
    options = bench.options if command[0] == "fit" else ()
    refused = bench.run(*command, *options, "-o", "output", before=limit_memory)
    assert_one_line(bench, refused, "memory")
    assert read_folder(bench.folder) == before


def test_a_reader_that_leaves(bench: Bench):
    """Standard output into a pipe that nobody reads, as in `fit --json | head -1`."""
    reading, writing = os.pipe()
    os.close(reading)
    before = read_folder(bench.folder)
    command = ("fit", "flight.csv", "--json", *bench.options, "-o", "output")
    bench.run(*command, before=lambda: os.dup2(writing, 1))
    os.close(writing)
    left = read_folder(bench.folder)
    written = left.pop("output")  # before anything is printed, so nobody's leaving costs it
    assert written is not None
    assert parse_json(written.decode())["status"] == "converged"
    assert left == before


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupted_fit(bench: Bench, ending: signal.Signals):
    """Ctrl-C leaves the folder as it was, without a half-written file that only `ls -a` shows."""
    before = read_folder(bench.folder)
    heeds = ["env", "--default-signal"]  # even where the shell that runs the tests ignores signals
    fit = [APPS / bench.app, "fit", "flight.csv", *bench.options, "--samples", "2000000"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with subprocess.Popen([*heeds, *fit, "-o", "output"], cwd=bench.folder, **quiet) as process:
        for _ in range(500):
            if len(read_folder(bench.folder)) > len(before):
                break
            time.sleep(0.01)
        process.send_signal(ending)
        try:
            assert process.wait(timeout=60) != 0
        finally:
            process.kill()
    assert read_folder(bench.folder) == before
