# SPDX-License-Identifier: BSD-3-Clause
"""The shell's edges: closed streams, loops of links, no memory before main, numbers beyond use."""

import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest

import sepcal
from apps import APPS, OLD_OUTPUT, Bench, assert_one_line, read_folder

PROGRAMS = ("sepcal-pitot", "sepcal-mag", "sepcal-aircraft", "python -m sepcal")
CLOSED = ("2>&-", "1>&- 2>&-", "0<&- 1>&- 2>&-")
FIELD = "field --lat 48 --lon 11 --date 2026-01-01"


def command_of(program: str) -> str:
    """As a shell takes it."""
    return f"{sys.executable} -m sepcal" if program.startswith("python") else str(APPS / program)


def shell(command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs a line of shell."""
    paths = os.pathsep.join(path for path in sys.path if path)
    return subprocess.run(
        ["sh", "-c", command],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


@pytest.mark.parametrize("program", PROGRAMS)
@pytest.mark.parametrize("closed", CLOSED)
def test_closed_streams(program: str, closed: str, tmp_path: Path) -> None:
    """The exit code is the same as with open ones."""
    for arguments, code in (("--help", 0), ("--version", 0), ("", 2), ("nonsense", 2)):
        assert shell(f"{command_of(program)} {arguments} {closed}", tmp_path).returncode == code


@pytest.mark.parametrize("closed", CLOSED)
def test_what_python_writes_with_closed_streams(closed: str, pitot: Bench) -> None:
    """No output takes a closed stream's number, so nothing said goes into it."""
    command = f"{command_of('python -m sepcal')} report flight.csv base.json -o r.html"
    assert shell(command, pitot.folder).returncode == 0
    whole = (pitot.folder / "r.html").read_text()
    (pitot.folder / "r.html").unlink()
    assert shell(f"{command} {closed}", pitot.folder).returncode == 0
    assert (pitot.folder / "r.html").read_text() == whole
    refused = shell(
        f"{command_of('python -m sepcal')} report nothing.csv base.json {closed}", pitot.folder
    )
    assert refused.returncode == 2


@pytest.mark.parametrize("arguments", ["--help", "field --help", FIELD])
def test_a_full_standard_output_of_python(arguments: str, tmp_path: Path) -> None:
    pytest.importorskip("pygeomag")
    refused = shell(f"{command_of('python -m sepcal')} {arguments} >/dev/full", tmp_path)
    assert refused.returncode == 2
    assert refused.stderr.count("\n") == 1, refused.stderr
    assert "standard output can't be written" in refused.stderr


def make_loop(folder: Path) -> None:
    """Two links that lead to each other."""
    (folder / "output").symlink_to("round")
    (folder / "round").symlink_to("output")


def links(folder: Path) -> dict[str, str]:
    """Every link and where it leads."""
    return {entry.name: os.readlink(entry) for entry in folder.iterdir() if entry.is_symlink()}


def test_a_loop_of_links_as_an_output(bench: Bench) -> None:
    make_loop(bench.folder)
    before = links(bench.folder)
    for command in (
        ("fit", "flight.csv", *bench.options, "-o", "output"),
        ("apply", "flight.csv", "base.json", "-o", "output"),
        ("export", "base.json", "--to", "c", "-o", "output"),
        ("simulate", "--rows", "9", "-o", "output"),
        ("simulate", "--rows", "9", "-o", "new.csv", "--truth", "output"),
        ("check", "flight.csv", *bench.options, "-o", "output"),
    ):
        refused = bench.run(*command)
        assert_one_line(bench, refused, "output: is a loop of symbolic links; name a file")
        assert links(bench.folder) == before
        assert not (bench.folder / "new.csv").exists()


def test_a_loop_of_links_as_an_output_of_python(pitot: Bench) -> None:
    make_loop(pitot.folder)
    before = links(pitot.folder)
    for arguments in ("report flight.csv base.json -o output", "log flight.csv -o output"):
        refused = shell(f"{command_of('python -m sepcal')} {arguments}", pitot.folder)
        assert refused.returncode == 2
        assert refused.stderr.count("\n") == 1
        assert "output: is a loop of symbolic links; name a file" in refused.stderr
    calibration = sepcal.load(pitot.folder / "base.json")
    with pytest.raises(sepcal.Error, match="is a loop of symbolic links"):
        calibration.save(pitot.folder / "output")
    with pytest.raises(sepcal.Error, match="is a loop of symbolic links"):
        sepcal.report(calibration, pitot.folder / "output", sepcal.read_csv(pitot.flight))
    assert links(pitot.folder) == before


def test_python_writes_through_links_and_into_devices(pitot: Bench) -> None:
    """As the apps do: the link stays, and so do the file's permissions and a device."""
    (pitot.folder / "real.html").write_text(OLD_OUTPUT)
    (pitot.folder / "real.html").chmod(0o640)
    (pitot.folder / "link.html").symlink_to("real.html")
    calibration, flight = sepcal.load(pitot.folder / "base.json"), sepcal.read_csv(pitot.flight)
    sepcal.report(calibration, pitot.folder / "link.html", flight)
    assert (pitot.folder / "link.html").is_symlink()
    assert (pitot.folder / "real.html").read_text().startswith("<!")
    assert (pitot.folder / "real.html").stat().st_mode & 0o777 == 0o640
    sepcal.report(calibration, "/dev/null", flight)
    assert Path("/dev/null").is_char_device()


@pytest.mark.parametrize("program", PROGRAMS[:3])
def test_too_little_memory_to_start(program: str, tmp_path: Path) -> None:
    """From what takes the program itself to enough: one line, whoever says it, and no crash."""
    own = (APPS / program).stat().st_size >> 10  # KiB; with less the kernel ends it at once
    codes = []
    for kilobytes in [*range(own + 2048, 32 << 10, 4096), *range(32 << 10, 48 << 10, 512)]:

        def limit_memory(limit: int = kilobytes << 10) -> None:
            resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

        done = subprocess.run(
            [APPS / program, "effects"],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
            preexec_fn=limit_memory,
        )
        codes.append(done.returncode)
        assert done.returncode in (0, 2, 127), (kilobytes, done)
        if done.returncode != 0:
            assert done.stderr.count("\n") == 1, (kilobytes, done.stderr)
    assert codes[0] == 127  # the loader's
    assert codes[-1] == 0


@pytest.mark.parametrize("header", ["time_s", "pt_pa", "vn_mps", "yaw_rad"])
@pytest.mark.parametrize("line", [2, 200, 401])
@pytest.mark.parametrize("cell", ["1.8e308", "-1.8e308", "1.7e308", "1e151"])
def test_a_number_beyond_use_is_named_by_its_cell(
    pitot: Bench, header: str, line: int, cell: str
) -> None:
    """Beyond a double, or with a square that is: of no cell but its own."""
    log = pitot.read_log()
    log.put(line, header, cell)
    pitot.flight.write_text(log.text())
    shown = cell if "1.8e308" in cell else f"{float(cell):g}".replace("e+0", "e+")
    refused = pitot.fit()
    assert_one_line(pitot, refused, f"flight.csv line {line}: column '{header}' holds ", shown)
    dropped = pitot.fit("--drop-invalid")
    assert dropped.code == 0, dropped.err
    assert dropped.result["inputs"]["rows_used"] == len(log.rows) - 1


def test_a_number_that_can_just_be_used(pitot: Bench) -> None:
    """It is a reading like any other, and told as one that can't be."""
    log = pitot.read_log()
    log.put(200, "pt_pa", "1e149")
    pitot.flight.write_text(log.text())
    before = read_folder(pitot.folder)
    fitted = pitot.fit()
    assert "line 200" in fitted.err, fitted
    assert read_folder(pitot.folder) == before
