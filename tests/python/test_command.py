# SPDX-License-Identifier: BSD-3-Clause
"""`sepcal`: one command, native and of the Python package, which share code, help and messages."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

import sepcal
from apps import APPS

NATIVE = [str(APPS / "sepcal")]
OF_PYTHON = [sys.executable, "-m", "sepcal"]
BOTH = pytest.mark.parametrize("command", [NATIVE, OF_PYTHON], ids=["native", "python"])


def call(command: Sequence[str], *words: object, folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs the command with these words."""
    paths = os.pathsep.join(path for path in sys.path if path)
    return subprocess.run(
        [*command, *map(str, words)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a short flight of a magnetometer, of a tube and of an aircraft."""
    folder = tmp_path_factory.mktemp("flown")
    for words in (
        ["mag", "simulate", "--rows", "300", "-o", "mag.csv"],
        ["pitot", "simulate", "--probe", "pitot-static", "--rows", "400", "-o", "tube.csv"],
        ["aircraft", "simulate", "--rows", "300", "-o", "aircraft.csv"],
    ):
        assert call(NATIVE, *words, folder=folder).returncode == 0
    return folder


def test_one_help(tmp_path: Path) -> None:
    """Both say the same, in lines that a terminal of 80 columns takes."""
    native, python = (call(each, "--help", folder=tmp_path) for each in (NATIVE, OF_PYTHON))
    assert native.returncode == python.returncode == 0
    assert native.stdout == python.stdout
    assert max(map(len, native.stdout.splitlines())) <= 80
    for command in ("mag", "pitot", "aircraft", "model", "fleet", "log", "report", "validate"):
        assert f"\n  {command} " in native.stdout


@BOTH
@pytest.mark.parametrize("instrument", ["mag", "pitot", "aircraft"])
def test_a_command_is_its_program(command: list[str], instrument: str, flown: Path) -> None:
    """Byte for byte; only the name before messages is the one that was typed."""
    for words in (
        ["effects"],
        ["effects", "--json"],
        ["--version"],
        ["nonsense"],
        ["fit", "nothing.csv"],
        ["check", "mag.csv", *(["--model", "path"] if instrument == "aircraft" else [])],
    ):
        program = call([str(APPS / f"sepcal-{instrument}")], *words, folder=flown)
        told = call(command, instrument, *words, folder=flown)
        assert (told.returncode, told.stdout) == (program.returncode, program.stdout)
        assert told.stderr == program.stderr.replace(f"sepcal-{instrument}", f"sepcal {instrument}")


@BOTH
def test_a_calibration_of_the_command_is_the_program_s(
    command: list[str], flown: Path, tmp_path: Path
) -> None:
    program = call([str(APPS / "sepcal-mag")], "fit", flown / "mag.csv", "--json", folder=tmp_path)
    told = call(command, "mag", "fit", flown / "mag.csv", "--json", folder=tmp_path)
    assert told.returncode == program.returncode == 0
    assert told.stdout == program.stdout


@BOTH
@pytest.mark.parametrize(
    ("file", "sensor", "names"),
    [
        ("mag.csv", "a magnetometer", "sepcal mag check"),
        ("tube.csv", "a Pitot-static tube", "sepcal pitot check"),
        ("aircraft.csv", "an aircraft", "sepcal aircraft check"),
    ],
)
def test_check_names_the_instrument(
    command: list[str], file: str, sensor: str, names: str, flown: Path
) -> None:
    told = call(command, "check", file, folder=flown)
    assert told.returncode == 0, told.stderr
    assert f"{file} is taken for the log of {sensor}" in told.stderr
    assert names in told.stderr
    assert file in told.stdout.splitlines()[0]


@BOTH
def test_check_of_no_sensor(command: list[str], tmp_path: Path) -> None:
    (tmp_path / "prices.csv").write_text("time_s,price\n0,1\n1,2\n")
    told = call(command, "check", "prices.csv", folder=tmp_path)
    assert told.returncode == 2
    assert told.stderr.count("\n") == 1
    assert "no sensor's columns" in told.stderr


def test_what_the_native_command_lacks(tmp_path: Path) -> None:
    """One line that says how to get it."""
    for word in ("model", "fleet", "log", "report", "field", "validate"):
        told = call(NATIVE, word, folder=tmp_path)
        assert (told.returncode, told.stdout) == (2, "")
        assert told.stderr == (
            f"sepcal {word}: is in the Python package: pip install sepcal, then python -m sepcal "
            f"{word}\n"
        )


@BOTH
@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ([], "a command is missing; the commands are: mag, pitot"),
        (["nonsense"], "'nonsense' is no command; the commands are: mag, pitot"),
        (["fit", "a.csv"], "name the instrument first: sepcal mag fit, sepcal pitot fit"),
        (["track", "a.csv"], "name the instrument first: sepcal aircraft track"),
        (["check"], "name a file"),
    ],
)
def test_bad_usage(command: list[str], words: list[str], expected: str, tmp_path: Path) -> None:
    told = call(command, *words, folder=tmp_path)
    assert (told.returncode, told.stdout) == (2, "")
    assert told.stderr.count("\n") == 1
    assert expected in told.stderr


def test_a_model_of_your_own_with_and_without_its_command(tmp_path: Path) -> None:
    """`model` may be left out before a verb with --model, as `python -m sepcal` had it."""
    words = ["effects", "--model", "sepcal:Accelerometer", "--json"]
    with_it, without = (
        call(OF_PYTHON, *before, *words, folder=tmp_path) for before in (["model"], [])
    )
    assert with_it.returncode == without.returncode == 0, with_it.stderr
    assert with_it.stdout == without.stdout != ""


def test_a_reader_of_python_serves_the_command(flown: Path, tmp_path: Path) -> None:
    """What read_foreign_files() is given reads files of other forms for every program."""
    script = tmp_path / "reads.py"
    script.write_text(
        "import sys\n"
        "import sepcal.__main__\n"
        "from sepcal import _core, states_module\n"
        "def read(file, form):\n"
        "    raise _core.Error(f'{file}: read by Python')\n"
        "_core.read_foreign_files(read)\n"
        "states_module.states_module()\n"
        "sys.exit(sepcal.__main__.main(sys.argv[1:]))\n"
    )
    log = tmp_path / "log.bin"
    log.write_bytes(b"\xa3\x95\x80\x80" + bytes(100))
    for words in (["mag", "fit"], ["aircraft", "fit", "--model", "path"]):
        told = call([sys.executable, str(script)], *words, log, folder=tmp_path)
        if "read by Python" not in told.stderr:
            pytest.skip("read_csv() does not ask for a reader yet")
        assert told.returncode == 2
        assert told.stderr == f"sepcal {words[0]}: {log}: read by Python\n"


def test_signals_are_python_s_again(flown: Path) -> None:
    """A program that runs within Python leaves its handlers and the streams as they were."""
    script = (
        "import signal, sys, os\n"
        "import sepcal.__main__\n"
        "before = [signal.getsignal(s) for s in (signal.SIGINT, signal.SIGPIPE, signal.SIGXFSZ)]\n"
        f"assert sepcal.__main__.main(['check', {str(flown / 'mag.csv')!r}]) == 0\n"
        "print('after')\n"
        "os.kill(os.getpid(), signal.SIGINT)\n"
    )
    told = call([sys.executable, "-c", script], folder=flown)
    assert told.stdout.endswith("after\n")
    assert told.stderr.rstrip().endswith("KeyboardInterrupt")


def test_the_version(tmp_path: Path) -> None:
    for command in (NATIVE, OF_PYTHON):
        told = call(command, "--version", folder=tmp_path)
        assert told.stdout == f"sepcal {sepcal.__version__}\n"
