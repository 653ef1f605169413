# SPDX-License-Identifier: BSD-3-Clause
"""What every verb takes: streams in place of files, quiet and loud, colours, widths, help."""

import fcntl
import json
import os
import pty
import re
import shlex
import struct
import subprocess
import termios
from pathlib import Path

import pytest

from apps import APPS, run

VERBS = {
    "mag": "check fit compare intervals diagnose add apply track export simulate effects residuals",
    "pitot": "check fit compare intervals diagnose add apply track export simulate effects "
    "residuals",
    "aircraft": "check fit two-step compare intervals diagnose add apply track simulate effects "
    "residuals response design",
}
EVERY_VERB = [(app, verb) for app, verbs in VERBS.items() for verb in verbs.split()]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A flight of a magnetometer, its calibration and another flight."""
    place = tmp_path_factory.mktemp("manners")
    for words in (
        ["simulate", "-o", "flight.csv", "--rows", "400"],
        ["simulate", "-o", "another.csv", "--rows", "400", "--seed", "5"],
        ["fit", "flight.csv", "-o", "base.json", "--samples", "50"],
    ):
        assert run("sepcal-mag", *words, folder=place).code == 0
    return place


def piped(command: str, folder: Path) -> subprocess.CompletedProcess[bytes]:
    """A line of shell in which sepcal is the native command."""
    return subprocess.run(
        ["bash", "-o", "pipefail", "-c", command],
        cwd=folder,
        env={**os.environ, "PATH": f"{APPS}{os.pathsep}{os.environ['PATH']}"},
        capture_output=True,
        check=False,
        timeout=120,
    )


def on_terminal(command: list[str], folder: Path, columns: int, **environment: str) -> str:
    """What a command prints on a terminal of so many columns."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 40, columns, 0, 0))
    unset = {name: value for name, value in os.environ.items() if name != "NO_COLOR"}
    with subprocess.Popen(
        command, cwd=folder, stdout=theirs, stderr=theirs, stdin=theirs,
        env={**unset, "TERM": "xterm", **environment},
    ) as process:  # fmt: skip
        os.close(theirs)
        parts = []
        while True:
            try:
                part = os.read(ours, 65536)
            except OSError:  # Linux: nobody has the other end any more
                break
            if not part:
                break
            parts.append(part)
        process.wait(timeout=60)
    os.close(ours)
    return b"".join(parts).decode().replace("\r\n", "\n")


@pytest.mark.parametrize(("app", "verb"), EVERY_VERB)
def test_help(app: str, verb: str, tmp_path: Path) -> None:
    """It fits 80 columns, has groups and two examples, and no option twice."""
    told = run(f"sepcal-{app}", verb, "--help", folder=tmp_path)
    assert (told.code, told.err) == (0, "")
    lines = told.out.splitlines()
    # Usage and examples are to be copied, and stay in a line.
    assert max(len(line) for line in lines if " sepcal-" not in line) <= 80
    assert "Result and messages:" in lines
    examples = [line for line in lines[lines.index("Examples:") + 1 :] if line]
    assert len(examples) == 2
    for option in ("-h, --help", "-q, --quiet", "-v, --verbose", "--exit-zero", "--version"):
        assert sum(line.startswith(f"  {option} ") for line in lines) == 1, option
    assert "-j, --json" in told.out or verb == "residuals"
    assert run(f"sepcal-{app}", verb, "--version", folder=tmp_path).out.startswith("sepcal ")


@pytest.mark.parametrize("app", ["mag", "pitot"])
def test_examples_of_join_run(app: str, tmp_path: Path) -> None:
    """The sensor at 10 Hz, the receiver at 2 Hz and 0.2 s late."""
    rows = [f"{i / 10},{20 + i % 7}\n" for i in range(300)]
    (tmp_path / "sensor.csv").write_text("time_s,airspeed_mps\n" + "".join(rows))
    rows = [f"{i / 2},{i % 5},{i % 3},0\n" for i in range(60)]
    (tmp_path / "receiver.csv").write_text("time_s,vn_mps,ve_mps,vd_mps\n" + "".join(rows))
    told = run(f"sepcal-{app}", "join", "--help", folder=tmp_path)
    examples = told.out.partition("Examples:\n")[2].splitlines()
    assert len(examples[:2]) == 2
    for line in [line for line in examples if line.startswith("  sepcal-")]:
        done = piped(line, tmp_path)
        assert done.returncode == 0, (line, done.stderr)
        assert "vn_mps" in (tmp_path / "flight.csv").read_text().splitlines()[0]


def test_examples_run(folder: Path, tmp_path: Path) -> None:
    """Those of the magnetometer, on short flights that are called as the examples have them."""
    for name in ("flight.csv", "another.csv", "base.json"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    for verb in VERBS["mag"].split():
        told = run("sepcal-mag", verb, "--help", folder=tmp_path)
        for line in told.out.partition("Examples:\n")[2].splitlines():
            if verb == "simulate" and "--rows" not in line:
                continue  # 16,000 rows in the place of the 400
            done = piped(line, tmp_path)
            # A reader that has enough, as head, ends the program before.
            assert done.returncode in (0, 3, 6, 141), (line, done.stderr)
            assert b"sepcal-mag:" not in done.stderr, (line, done.stderr)


def test_from_and_to_streams(folder: Path) -> None:
    file = run("sepcal-mag", "fit", "flight.csv", "-o", "of_file.json", folder=folder)
    assert file.code == 0
    told = json.loads((folder / "of_file.json").read_text())
    for line in (
        "sepcal mag fit flight.csv -o -",
        "cat flight.csv | sepcal mag fit - -o -",
        "sepcal mag fit - -o - < flight.csv",
        "cat flight.csv | sepcal mag fit - --json",
        "sepcal mag fit flight.csv -o - | cat",
        "sepcal mag fit flight.csv -o - > there.json; cat there.json",
    ):
        done = piped(line, folder)
        assert (done.returncode, done.stderr) == (0, b""), line
        assert json.loads(done.stdout)["parameters"] == told["parameters"], line


def test_what_is_applied_goes_to_a_stream(folder: Path) -> None:
    assert (
        run("sepcal-mag", "apply", "flight.csv", "base.json", "-o", "c.csv", folder=folder).code
        == 0
    )
    done = piped(
        "echo before > out.csv; cat flight.csv | sepcal mag apply - base.json -o - >> out.csv",
        folder,
    )
    assert (done.returncode, done.stdout) == (0, b"")
    assert (folder / "out.csv").read_text() == "before\n" + (folder / "c.csv").read_text()


def test_two_results_on_one_stream(folder: Path) -> None:
    told = run("sepcal-mag", "fit", "flight.csv", "-o", "-", "--json", folder=folder)
    assert (told.code, told.out) == (2, "")
    assert told.err == "sepcal-mag: -o - and --json would both print a result; leave one out\n"


def test_quiet_and_loud(folder: Path) -> None:
    words = ["fit", "flight.csv", "--field", "19.7,-1.4,49.4"]
    usual = run("sepcal-mag", *words, folder=folder)
    assert "note: " in usual.err
    quiet = run("sepcal-mag", *words, "-q", "-o", "quiet.json", folder=folder)
    assert (quiet.code, quiet.out, quiet.err) == (0, "", "")
    assert (folder / "quiet.json").exists()
    assert run("sepcal-mag", *words, "-q", "-j", folder=folder).result["status"] == "converged"
    loud = run("sepcal-mag", *words, "-v", folder=folder)
    assert re.search(r"^read flight.csv: 400 rows, \d+ columns, [\d.]+ s$", loud.err, re.M)
    assert re.search(r"^done in [\d.]+ s$", loud.err, re.M)
    assert loud.out == run("sepcal-mag", *words, "--explain", folder=folder).out


def test_exit_zero(tmp_path: Path) -> None:
    """Where there is a result; not for bad input."""
    made = ["simulate", "-o", "flight.csv", "--rows", "2000", "--hide", "time_offset=0.2"]
    assert run("sepcal-mag", *made, folder=tmp_path).code == 0
    assert run("sepcal-mag", "fit", "flight.csv", "-o", "base.json", folder=tmp_path).code == 0
    words = ["diagnose", "flight.csv", "base.json"]
    assert run("sepcal-mag", *words, folder=tmp_path).code == 3
    assert run("sepcal-mag", *words, "--exit-zero", folder=tmp_path).code == 0
    assert run("sepcal-mag", "fit", "none.csv", "--exit-zero", folder=tmp_path).code == 2


def test_colours_are_a_terminal_s(folder: Path) -> None:
    command = [str(APPS / "sepcal-mag"), "fit", "flight.csv", "--field", "19.7,-1.4,49.4"]
    assert "\x1b" not in run("sepcal-mag", *command[1:], folder=folder).out
    shown = on_terminal(command, folder, 200)
    assert "\x1b[32mstatus: converged\x1b[0m\n" in shown
    assert "\x1b[33mnote:\x1b[0m " in shown
    plain = on_terminal(command, folder, 200, NO_COLOR="1")
    assert "\x1b[32m" not in plain
    assert "\x1b[3" not in on_terminal(command, folder, 200, TERM="dumb")
    refused = on_terminal([*command[:2], "none.csv"], folder, 200)
    assert refused == "\x1b[31msepcal-mag:\x1b[0m none.csv: no such file\n"


@pytest.mark.parametrize("columns", [40, 60, 72])
def test_pages_are_as_wide_as_the_terminal(columns: int, folder: Path) -> None:
    command = [str(APPS / "sepcal-mag"), "fit", "flight.csv"]
    wide = run("sepcal-mag", "fit", "flight.csv", folder=folder).out
    shown = on_terminal(command, folder, columns, NO_COLOR="1")
    assert max(map(len, shown.splitlines())) <= columns
    assert shown.split() == wide.split()


def test_bash_completes(folder: Path) -> None:
    """A real bash with the completions that it is given."""
    script = (
        "source <(sepcal completion bash)\n"
        'try() { COMP_WORDS=("$@"); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); COMPREPLY=(); _sepcal;'
        ' echo "${COMPREPLY[*]}"; }\n'
        "complete -p sepcal sepcal-mag\n"
        "try sepcal ma\n"
        "try sepcal mag f\n"
        "try sepcal mag fit --fi\n"
        "try sepcal mag fit --search g\n"
        'try sepcal mag fit flight.csv --search ""\n'
        "try sepcal-pitot fit --k-\n"
        'try sepcal mag fit --field ""\n'
        "try sepcal mag fit fl\n"
        "try sepcal mag fit --join s\n"
        'try sepcal pitot fit --join ""\n'
        "try sepcal mag fit --effect bias_\n"
        "try sepcal aircraft fit --effect imu_\n"
        'try sepcal mag export base.json --to ""\n'
        "try sepcal mag export base.json --rotation k\n"
    )
    done = piped(script, folder)
    assert (done.returncode, done.stderr) == (0, b"")
    lines = done.stdout.decode().splitlines()
    assert lines[:2] == [
        f"complete -o bashdefault -o default -F _sepcal {name}" for name in ("sepcal", "sepcal-mag")
    ]
    assert lines[2:] == [
        "mag manual",
        "fit",
        "--field --field-strength --fix",
        "global",
        "sampling global",
        "--k-alpha --k-beta",
        "",
        "",
        "smooth",
        "smooth linear held",
        "bias_step bias_drift",
        "imu_late",
        "c cpp px4 ardupilot",
        "keep",
    ]


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_other_shells_read_their_completions(shell: str, tmp_path: Path) -> None:
    if piped(f"command -v {shell}", tmp_path).returncode != 0:
        pytest.skip(f"{shell} is not installed")
    check = {"zsh": "zsh -n", "fish": "fish --no-execute"}[shell]
    done = piped(f"sepcal completion {shell} > c; {check} c", tmp_path)
    assert (done.returncode, done.stderr) == (0, b"")


def test_fish_completes(tmp_path: Path) -> None:
    if piped("command -v fish", tmp_path).returncode != 0:
        pytest.skip("fish is not installed")
    asked = 'sepcal completion fish | source; complete -C "sepcal mag fit --fie"'
    done = piped(f"fish --no-config -c {shlex.quote(asked)}", tmp_path)
    assert [line.split("\t")[0] for line in done.stdout.decode().splitlines()] == [
        "--field",
        "--field-strength",
    ]


def test_another_shell_is_refused(tmp_path: Path) -> None:
    told = run("sepcal", "completion", "tcsh", folder=tmp_path)
    assert told.code == 2
    assert told.err == "sepcal: there are completions for bash, zsh and fish, not for 'tcsh'\n"


@pytest.mark.parametrize("page", ["sepcal", "sepcal-mag", "sepcal-pitot", "sepcal-aircraft"])
def test_manual_pages(page: str, tmp_path: Path) -> None:
    """Nothing that groff complains of, and every verb."""
    if piped("command -v groff", tmp_path).returncode != 0:
        pytest.skip("groff is not installed")
    done = piped(f"sepcal manual {page} | groff -man -ww -Tutf8 -P-c -P-b -P-u", tmp_path)
    assert (done.returncode, done.stderr) == (0, b"")
    shown = done.stdout.decode()
    assert "EXIT STATUS" in shown
    for verb in VERBS.get(page.removeprefix("sepcal-"), "").split():
        assert f"\n   {verb}\n" in shown
