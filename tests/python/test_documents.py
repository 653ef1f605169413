# SPDX-License-Identifier: BSD-3-Clause
"""The documents keep their word.

Quoted code is the examples', links and options exist, and the examples give back the truth that
their flight was simulated with.
"""

import csv
import json
import math
import os
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
APPS = Path(os.environ.get("SEPCAL_APPS", ROOT / "build" / "apps"))
EXAMPLES = ROOT / "examples"
DOCUMENTS = sorted([ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").glob("*.md")])
README = (ROOT / "README.md").read_text()

BLOCK = re.compile(
    r"^(?:<!-- (?P<mark>.*?) -->\n)?```(?P<language>\w*)\n(?P<text>.*?)^```$", re.M | re.S
)
BLOCKS = [match.groupdict() for match in BLOCK.finditer(README)]
QUOTED = [block for block in BLOCKS if (block["mark"] or "").startswith("from ")]
TYPED = [block["text"] for block in BLOCKS if block["language"] == "sh"]

PROBE = ["--k-alpha", "4.5", "--k-beta", "4.5", "--lever-arm", "0.35,0,-0.02"]


def run(*command, cwd=None):
    """What a command prints; the apps are found, and a failure shows what it said."""
    path = f"{APPS}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def check_truth(base, truth):
    """Every parameter of a calibration lies within four standard errors of the truth."""
    parameters = json.loads(base.read_text())["parameters"]
    for name, true in json.loads(truth.read_text())["parameters"].items():
        estimate = parameters[name]
        assert abs(estimate["value"] - true) < 4 * estimate["standard_error"], name


@pytest.mark.parametrize("block", QUOTED, ids=[block["mark"] for block in QUOTED])
def test_quoted_code_stands_in_the_example(block):
    example = ROOT / block["mark"].removeprefix("from ")
    assert f"\n{block['text']}" in f"\n{example.read_text()}"


def test_readme_quotes_cpp_python_shell_and_a_whole_model():
    quoted = {block["mark"].removeprefix("from examples/") for block in QUOTED}
    assert {"01_own_model.cpp", "02_five_hole.cpp", "03_five_hole.py", "04_five_hole.sh"} <= quoted


@pytest.mark.parametrize("name", ["02_five_hole.cpp", "03_five_hole.py", "04_five_hole.sh"])
def test_a_fit_takes_five_lines_at_most(name):
    block = next(block for block in QUOTED if block["mark"] == f"from examples/{name}")
    assert len(block["text"].splitlines()) <= 5


def test_own_model_has_25_lines_at_most():
    assert len((EXAMPLES / "01_own_model.cpp").read_text().splitlines()) <= 25


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_resolve(document):
    for target in re.findall(r"\]\(([^)#]+)", document.read_text()):
        if not target.startswith("https://"):
            assert (document.parent / target).exists(), target


@pytest.mark.parametrize("file", [*DOCUMENTS, *sorted(EXAMPLES.iterdir())], ids=lambda p: p.name)
def test_no_path_of_a_machine(file):
    assert not re.search(r"/(work|tmp|home|root|Users|mnt)/", file.read_text())


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_documents_are_plain_text_without_emojis(document):
    assert document.read_text().isascii()


def test_every_option_in_the_documents_is_in_the_help():
    known = set()
    for app in ("sepcal-pitot", "sepcal-mag"):
        for verb in ("fit", "compare", "apply", "simulate", "effects"):
            known |= set(re.findall(r"--[a-z][a-z-]*", run(app, verb, "--help")))
    text = "\n".join(document.read_text() for document in DOCUMENTS)
    said = re.findall(r"`(--[a-z][a-z-]*)", text)
    for block in TYPED:
        for line in block.splitlines():
            if line.startswith("sepcal-"):
                said += re.findall(r"--[a-z][a-z-]*", line)
    foretold = {"--help", "--hide"}  # --help is in every help; --hide is said not to be there
    assert said
    assert not set(said) - known - foretold


def test_every_verb_in_the_documents_is_in_the_help():
    help_text = {app: run(app, "--help") for app in ("sepcal-pitot", "sepcal-mag")}
    commands = re.findall(r"^(sepcal-\w+) ([a-z]+)", "\n".join(TYPED), re.M)
    assert commands
    for app, verb in commands:
        assert re.search(rf"^  {verb} ", help_text[app], re.M), f"{app} {verb}"


def test_scripts_and_files_in_typed_commands_exist():
    scripts = re.findall(r"^\./(\S+)", "\n".join(TYPED), re.M)
    assert scripts
    assert all((ROOT / script).is_file() for script in scripts)


def test_readme_table_is_what_the_fit_prints(tmp_path):
    block = next(block for block in BLOCKS if (block["mark"] or "").startswith("output of"))
    run("sepcal-pitot", "simulate", "-o", "flight.csv", "--seed", "1", cwd=tmp_path)
    printed = run("sepcal-pitot", "fit", "flight.csv", *PROBE, cwd=tmp_path).splitlines()
    assert [line for line in block["text"].splitlines() if line not in printed] == []


def test_shell_example_finds_the_truth(tmp_path):
    run("bash", EXAMPLES / "04_five_hole.sh", cwd=tmp_path)
    check_truth(tmp_path / "base.json", tmp_path / "truth.json")
    assert (tmp_path / "corrected.csv").is_file()


def test_a_log_under_other_names_and_units_finds_the_truth(tmp_path):
    simulate = ["simulate", "-o", "simulated.csv", "--truth", "truth.json", "--rows", "400"]
    run("sepcal-pitot", *simulate, cwd=tmp_path)
    degrees, knots = math.degrees(1.0), 3600.0 / 1852.0
    columns = {
        "time_s": 1.0,
        **dict.fromkeys(("roll_rad", "pitch_rad", "yaw_rad"), degrees),
        **dict.fromkeys(("p_radps", "q_radps", "r_radps"), degrees),
        **dict.fromkeys(("vn_mps", "ve_mps", "vd_mps"), knots),
        **dict.fromkeys(("pt_pa", "ps_pa", "dpa_pa", "dpb_pa"), 0.01),
        "temp_k": 1.0,
    }
    with (tmp_path / "simulated.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    with (tmp_path / "mylog.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([f"channel {i}" for i in range(len(columns))])
        for row in rows:
            values = {name: float(row[name]) * factor for name, factor in columns.items()}
            values["temp_k"] -= 273.15
            writer.writerow(values.values())

    run("bash", EXAMPLES / "06_your_log.sh", cwd=tmp_path)
    check_truth(tmp_path / "base.json", tmp_path / "truth.json")
    with (tmp_path / "corrected.csv").open(newline="") as file:
        assert len(list(csv.reader(file))) == len(rows) + 1
