# SPDX-License-Identifier: BSD-3-Clause
"""What the documents show is what comes out.

And the examples give back the truth that their flight was simulated with.
"""

import csv
import json
import math
import re
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from documents import BLOCKS, BUILT_EXAMPLES, EXAMPLES, ROOT, marked, missing_lines, run
from oracle.magnetometer import Magnetometer, compose, soft_iron

SHOWN = "output of examples/"
SHOWN_EXAMPLES = sorted(
    {b["mark"].removeprefix(SHOWN) for b in BLOCKS if b["mark"].startswith(SHOWN)}
)
EFFECT_MISSING = 3  # the exit code of diagnose


def read_parameters(file):
    """{name: entry} of a calibration or a truth file."""
    return json.loads(file.read_text())["parameters"]


def check_truth(base, truth):
    """Every parameter of a calibration is held at its truth or within four standard errors."""
    parameters = read_parameters(base)
    for name, true in read_parameters(truth).items():
        estimate = parameters[name]
        if estimate["standard_error"] is None:
            assert estimate["value"] == true, name
            continue
        assert abs(estimate["value"] - true) < 4 * estimate["standard_error"], name


def type_lines(text, folder):
    """Types a block's lines one after another; what they print."""
    return "".join(
        run(
            "bash",
            "-c",
            line,
            cwd=folder,
            codes=(0, EFFECT_MISSING) if "diagnose" in line else (0,),
        )
        for line in text.splitlines()
    )


@pytest.fixture(scope="module")
def loop(tmp_path_factory):
    """Folder and output of the loop in README."""
    folder = tmp_path_factory.mktemp("loop")
    block = next(b for b in BLOCKS if b["document"] == "README.md" and " diagnose " in b["text"])
    return folder, type_lines(block["text"], folder)


def test_the_loop_prints_what_readme_shows(loop):
    shown = marked("output of the loop", "README.md")
    assert shown
    assert missing_lines("".join(shown), loop[1]) == []


def test_the_loop_is_off_by_what_readme_says_and_then_right(loop):
    folder, _ = loop
    said = re.search(
        r"on an airspeed bias `b_va` of ([\d.]+) m/s. The truth is ([\d.]+) m/s",
        " ".join((ROOT / "README.md").read_text().split()),
    )
    wrong, true = map(float, said.groups())
    assert round(read_parameters(folder / "base.json")["b_va"]["value"], 1) == wrong
    simulate = ["simulate", "-o", "short.csv", "--hide", "propwash=40", "--rows", "200", "--json"]
    (folder / "truth.json").write_text(run("sepcal-pitot", *simulate, cwd=folder))
    assert read_parameters(folder / "truth.json")["b_va"] == true
    check_truth(folder / "better.json", folder / "truth.json")


def test_the_picture_is_of_the_loop(loop):
    """scripts/picture writes into the picture what it drew; README says it to who can't see it."""
    step = json.loads((loop[0] / "better.json").read_text())["history"][-1]
    picture = (ROOT / "docs" / "error.svg").read_text()
    drawn = (
        f"RMSE {step['rmse_before']:.3f} -&gt; {step['rmse_after']:.3f} m/s with {step['effect']}"
    )
    assert drawn in picture
    said = f"{step['rmse_before']:.3f} m/s after the fit, {step['rmse_after']:.3f} m/s with"
    assert said in (ROOT / "README.md").read_text()


def test_every_sensor_is_fitted_as_readme_says(tmp_path):
    (block,) = marked("one line a sensor", "README.md")
    rows = ("--rows", "400", "-o")
    run("sepcal-pitot", "simulate", *rows, "flight.csv", cwd=tmp_path)
    run("sepcal-pitot", "simulate", "--probe", "pitot-static", *rows, "tube.csv", cwd=tmp_path)
    run("sepcal-mag", "simulate", *rows, "turns.csv", cwd=tmp_path)
    printed = type_lines(block, tmp_path)
    assert printed.count("status: converged") == len(block.splitlines()) == 4


def test_the_programs_in_the_documents_run(tmp_path):
    programs = marked("a program")
    assert programs
    for program in programs:
        run(sys.executable, "-c", program, cwd=tmp_path)


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """Folder and output of an example, which runs once."""

    @cache
    def run_example(name):
        stem, kind = Path(name).stem, Path(name).suffix
        folder = tmp_path_factory.mktemp(stem)
        commands = {
            ".sh": ("bash", EXAMPLES / name),
            ".py": (sys.executable, EXAMPLES / name),
            ".cpp": (BUILT_EXAMPLES / stem,),
        }
        return folder, run(*commands[kind], cwd=folder)

    return run_example


@pytest.mark.parametrize("name", SHOWN_EXAMPLES)
def test_shown_output_is_what_the_example_prints(name, ran):
    shown = "".join(marked(SHOWN + name))
    assert shown.strip()
    assert missing_lines(shown, ran(name)[1]) == []


def test_shell_example_finds_the_truth(ran):
    folder, _ = ran("04_five_hole.sh")
    check_truth(folder / "base.json", folder / "truth.json")
    assert (folder / "corrected.csv").is_file()


def test_the_missing_effect_is_missed_and_found(ran):
    folder, _ = ran("11_missing_effect.sh")
    scale = read_parameters(folder / "base.json")["lambda_va"]
    assert scale["value"] - 0.05 > 10 * scale["standard_error_white"]
    assert scale["standard_error"] > 5 * scale["standard_error_white"]
    check_truth(folder / "next.json", folder / "truth.json")


def test_pitot_static_example_finds_the_truth(ran):
    folder, _ = ran("12_pitot_static.sh")
    check_truth(folder / "base.json", folder / "truth.json")


def test_field_strength_example_finds_the_ellipsoid(tmp_path):
    """C C' and n are what a field's strength shows; C itself only up to a rotation."""
    run("bash", EXAMPLES / "13_field_strength.sh", cwd=tmp_path)
    truth = read_parameters(tmp_path / "truth.json")
    found = read_parameters(tmp_path / "base.json")
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
