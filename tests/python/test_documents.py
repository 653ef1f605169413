# SPDX-License-Identifier: BSD-3-Clause
"""The documents keep their word.

Quoted code is the examples', links and options exist, and the examples give back the truth that
their flight was simulated with.
"""

import ast
import builtins
import csv
import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import sepcal
from oracle.magnetometer import Magnetometer, compose, soft_iron

ROOT = Path(__file__).resolve().parents[2]
APPS = Path(os.environ.get("SEPCAL_APPS", ROOT / "build" / "apps"))
EXAMPLES = ROOT / "examples"
DOCUMENTS = sorted([ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").glob("*.md")])

BLOCK = re.compile(
    r"^(?:<!-- (?P<mark>.*?) -->\n)?```(?P<language>\w*)\n(?P<text>.*?)^```$", re.M | re.S
)
BLOCKS = [
    {"document": document.name, **match.groupdict(default="")}
    for document in DOCUMENTS
    for match in BLOCK.finditer(document.read_text())
]
QUOTED = [block for block in BLOCKS if block["mark"].startswith("from ")]
PYTHON = [block for block in BLOCKS if block["language"] == "python"]
WHOLE = [
    b for b in PYTHON if b["document"] in ("intervals.md", "many-flights.md", "monte-carlo.md")
]
TYPED = [block["text"] for block in BLOCKS if block["language"] == "sh"]
PRINTED = [block for block in BLOCKS if block["mark"].startswith("output of examples/")]
SHOWN_EXAMPLES = sorted({block["mark"].removeprefix("output of examples/") for block in PRINTED})

# How many lines of an example a document promises at most.
PROMISES = {"07_own_model.py": 15, "08_own_effect.py": 6, "09_own_effect.cpp": 11}

PROBE = ["--k-alpha", "4.5", "--k-beta", "4.5", "--lever-arm", "0.35,0,-0.02"]


def run(*command, cwd=None):
    """What a command prints; the apps are found, and a failure shows what it said."""
    path = f"{APPS}{os.pathsep}{os.environ['PATH']}"
    modules = f"{Path(sepcal.__file__).parents[1]}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        env={**os.environ, "PATH": path, "PYTHONPATH": modules},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def check_truth(base, truth):
    """Every parameter of a calibration is held at its truth or within four standard errors."""
    parameters = json.loads(base.read_text())["parameters"]
    for name, true in json.loads(truth.read_text())["parameters"].items():
        estimate = parameters[name]
        if estimate["standard_error"] is None:
            assert estimate["value"] == true, name
            continue
        assert abs(estimate["value"] - true) < 4 * estimate["standard_error"], name


@pytest.mark.parametrize("block", QUOTED, ids=[f"{b['document']} {b['mark']}" for b in QUOTED])
def test_quoted_code_stands_in_the_example(block):
    example = ROOT / block["mark"].removeprefix("from ")
    assert f"\n{block['text']}" in f"\n{example.read_text()}"


@pytest.mark.parametrize("block", WHOLE, ids=lambda block: block["document"])
def test_python_in_the_documents_defines_all_that_it_uses(block):
    known = set(dir(builtins)) | {"__name__"}
    used = set()
    for node in ast.walk(ast.parse(block["text"])):
        match node:
            case ast.Name(name, ast.Load()):
                used.add(name)
            case ast.Name(name) | ast.arg(name) | ast.FunctionDef(name):
                known.add(name)
            case ast.Import(names) | ast.ImportFrom(names=names):
                known |= {one.asname or one.name for one in names}
    assert used - known == set()


def test_readme_quotes_cpp_python_shell_and_a_whole_model():
    quoted = {block["mark"].removeprefix("from examples/") for block in QUOTED}
    assert {"01_own_model.cpp", "02_five_hole.cpp", "03_five_hole.py", "04_five_hole.sh"} <= quoted
    assert set(PROMISES) <= quoted


@pytest.mark.parametrize("name", ["02_five_hole.cpp", "03_five_hole.py", "04_five_hole.sh"])
def test_a_fit_takes_five_lines_at_most(name):
    block = next(block for block in QUOTED if block["mark"] == f"from examples/{name}")
    assert len(block["text"].splitlines()) <= 5


@pytest.mark.parametrize("name", PROMISES)
def test_own_models_and_effects_are_as_short_as_promised(name):
    block = next(block for block in QUOTED if block["mark"] == f"from examples/{name}")
    assert len(block["text"].splitlines()) <= PROMISES[name]


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
        for verb in (
            "fit",
            "compare",
            "intervals",
            "diagnose",
            "add",
            "apply",
            "simulate",
            "effects",
        ):
            known |= set(re.findall(r"--[a-z][a-z-]*", run(app, verb, "--help")))
    text = "\n".join(document.read_text() for document in DOCUMENTS)
    said = re.findall(r"`(--[a-z][a-z-]*)", text)
    for block in TYPED:
        for line in block.splitlines():
            if line.startswith("sepcal-"):
                said += re.findall(r"--[a-z][a-z-]*", line)
    assert said
    assert not set(said) - known - {"--help"}  # which is in every help, but not in its own list


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
    block = next(block for block in BLOCKS if block["mark"].startswith("output of the fit"))
    run("sepcal-pitot", "simulate", "-o", "flight.csv", "--seed", "1", cwd=tmp_path)
    printed = run("sepcal-pitot", "fit", "flight.csv", *PROBE, cwd=tmp_path).splitlines()
    assert [line for line in block["text"].splitlines() if line not in printed] == []


@pytest.fixture(scope="session")
def ran(tmp_path_factory):
    """Folder and output of each example whose output a document shows."""
    done = {}
    for name in SHOWN_EXAMPLES:
        folder = tmp_path_factory.mktemp(Path(name).stem)
        runs = "bash" if name.endswith(".sh") else sys.executable
        done[name] = (folder, run(runs, EXAMPLES / name, cwd=folder))
    return done


@pytest.mark.parametrize("name", SHOWN_EXAMPLES)
def test_shown_output_is_what_the_example_prints(name, ran):
    printed = ran[name][1].splitlines()
    shown = [block["text"] for block in PRINTED if block["mark"] == f"output of examples/{name}"]
    assert [line for line in "".join(shown).splitlines() if line not in printed] == []


def test_shell_example_finds_the_truth(tmp_path):
    run("bash", EXAMPLES / "04_five_hole.sh", cwd=tmp_path)
    check_truth(tmp_path / "base.json", tmp_path / "truth.json")
    assert (tmp_path / "corrected.csv").is_file()


def test_the_missing_effect_is_missed_and_found(ran):
    folder, _ = ran["11_missing_effect.sh"]
    scale = json.loads((folder / "base.json").read_text())["parameters"]["lambda_va"]
    assert scale["value"] - 0.05 > 10 * scale["standard_error_white"]
    assert scale["standard_error"] > 5 * scale["standard_error_white"]
    check_truth(folder / "next.json", folder / "truth.json")


def test_pitot_static_example_finds_the_truth(ran):
    folder, _ = ran["12_pitot_static.sh"]
    check_truth(folder / "base.json", folder / "truth.json")


def test_field_strength_example_finds_the_ellipsoid(tmp_path):
    """C C' and n are what a field's strength shows; C itself only up to a rotation."""
    run("bash", EXAMPLES / "13_field_strength.sh", cwd=tmp_path)
    truth = json.loads((tmp_path / "truth.json").read_text())["parameters"]
    found = json.loads((tmp_path / "base.json").read_text())["parameters"]
    values = {name: entry["value"] for name, entry in found.items()}
    errors = {name: entry["standard_error"] for name, entry in found.items()}
    hard_iron = ("n_x", "n_y", "n_z")
    assert all(abs(values[name] - truth[name]) < 4 * errors[name] for name in hard_iron)

    def matrix(parameters):
        order = (*Magnetometer.linear, *Magnetometer.nonlinear)
        C = compose(np.array([parameters.get(name, 0.0) for name in order]))
        return C @ C.T

    # d(C C') is 2 (1 + lambda) dlambda on the diagonal and (about) 2 dalpha beside it.
    alone = soft_iron([errors[f"alpha_{pair}"] for pair in ("xy", "xz", "yz")])
    np.fill_diagonal(alone, [errors[f"lambda_{axis}"] for axis in "xyz"])
    assert np.all(np.abs(matrix(values) - matrix(truth)) < 4 * 2.2 * alone)


def test_every_effect_of_the_catalogue_is_explained():
    text = (ROOT / "docs" / "effects.md").read_text()
    rows = re.findall(r"^\| (`.*?`) \|", text, re.M)
    explained = {name.split("[")[0] for row in rows for name in re.findall(r"`(\w+[^`]*)`", row)}
    catalogue = {
        effect["name"].split("[")[0]
        for app in ("sepcal-pitot", "sepcal-mag")
        for effect in json.loads(run(app, "effects", "--json"))["effects"]
    }
    assert catalogue <= explained


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
