# SPDX-License-Identifier: BSD-3-Clause
"""sepcal.toml: what is known of a project's instruments."""

from pathlib import Path

import pytest

from apps import Outcome, run


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A folder of two days, with a flight of a tube and of a magnetometer in each."""
    for day in ("day_1", "day_2"):
        (tmp_path / day).mkdir()
        for app, file in (("mag", "mag.csv"), ("pitot", "probe.csv")):
            made = run(
                f"sepcal-{app}", "simulate", "-o", f"{day}/{file}", "--rows", "300", folder=tmp_path
            )
            assert made.code == 0
    return tmp_path


def fit(project: Path, text: str, *words: str, app: str = "sepcal-mag") -> Outcome:
    """A fit of the first day's flight, with this project."""
    (project / "sepcal.toml").write_text(text)
    flight = "day_1/mag.csv" if app == "sepcal-mag" else "day_1/probe.csv"
    return run(app, "fit", flight, *words, folder=project)


def test_what_is_known_is_typed_once(project: Path) -> None:
    """The same numbers as from the command line, and a note that names the file."""
    options = ["--field=19.7,-1.4,49.4", "--samples=60", "--bounds=eta_x=-0.2,0.2"]
    typed = fit(project, "", *options, "--json")
    known = fit(
        project,
        "[mag]\nfield = [19.7, -1.4, 49.4]\nsamples = 60\nbounds = { eta_x = [-0.2, 0.2] }\n",
        "--json",
    )
    assert known.code == 0
    assert known.out == typed.out
    said = known.err.splitlines()[0]
    assert said.startswith("note: sepcal.toml says ")
    assert set(said.removeprefix("note: sepcal.toml says ").split()) == set(options)


def test_the_command_line_wins(project: Path) -> None:
    text = (
        "[mag]\nfield = [10, 0, 20]\nsamples = 60\nfix = { eta_x = 0.1, eta_y = 0.02 }\n"
        "drop-invalid = true\n"
    )
    told = fit(
        project, text, "--field", "19.7,-1.4,49.4", "--samples", "70", "--fix", "eta_x=0", "--json"
    )
    options = told.result["options"]
    assert options["samples"] == 70
    assert options["fix"] == {"eta_x": 0, "eta_y": 0.02}
    assert options["drop_invalid"] is True
    assert options["field"] == [19.7, -1.4, 49.4]


def test_a_strength_that_is_typed_takes_the_field_s_place(project: Path) -> None:
    told = fit(project, "[mag]\nfield = [19.7, -1.4, 49.4]\n", "--field-strength", "53.2", "--json")
    assert told.result["model"] == "magnetometer-norm"


def test_a_probe_has_a_section_of_its_kind(project: Path) -> None:
    text = "[pitot]\nsamples = 60\n[five-hole]\nk_alpha = 4.5\nk-beta = 4.5\n"
    text += "lever-arm = [0.35, 0, -0.02]\n"
    told = fit(project, text, "--json", app="sepcal-pitot")
    assert told.code == 0, told.err
    assert told.result["options"]["lever_arm"] == [0.35, 0, -0.02]
    assert told.result["options"]["samples"] == 60
    both = fit(project, text + "[pitot-static]\nfree = ['w_d']\n", app="sepcal-pitot")
    assert both.code == 2
    assert (
        both.err
        == "sepcal-pitot: sepcal.toml: has five-hole, pitot-static; say which with --probe\n"
    )
    chosen = fit(
        project,
        text + "[pitot-static]\nfree = ['w_d']\n",
        "--probe",
        "five-hole",
        "-j",
        app="sepcal-pitot",
    )
    assert chosen.code == 0


def test_the_nearest_file_is_used(project: Path) -> None:
    (project / "day_1" / "sepcal.toml").write_text("[mag]\nsamples = 30\n")
    told = fit(project, "[mag]\nsamples = 60\n", "--json")
    assert told.result["options"]["samples"] == 30
    assert "day_1/sepcal.toml says" in told.err
    (project / "other.toml").write_text("[mag]\nsamples = 40\n")
    named = fit(project, "", "--project", "other.toml", "--json")
    assert named.result["options"]["samples"] == 40


def test_later_verbs_have_it_of_the_calibration(project: Path) -> None:
    assert fit(project, "[mag]\nsamples = 60\n", "-o", "base.json").code == 0
    told = run("sepcal-mag", "compare", "day_1/mag.csv", "base.json", folder=project)
    assert (told.code, told.err) == (0, "")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            "[mag]\nfeild = [1, 2, 3]\n",
            "[mag] feild: there is no such option; did you mean 'field'?",
        ),
        ("[mga]\nfield = [1, 2, 3]\n", "'mga' is no section; did you mean 'mag'?"),
        ("field = [1, 2, 3]\n", "'field' is no section"),
        ("[mag]\nfield = \n", "line 2 is no TOML"),
        ("[mag]\nfield = [[1], 2]\n", "[mag] field: no option takes such a value"),
        ("[mag]\nsamples = true\n", "[mag] samples: no option takes such a value"),
        ("[mag]\nsamples = 'many'\n", "--samples: 'many' is not a whole number"),
        ("[mag]\noutput = 'base.json'\n", "[mag] output: there is no such option"),
    ],
)
def test_bad_projects(text: str, expected: str, project: Path) -> None:
    """One line that names the file and the culprit."""
    told = fit(project, text)
    assert (told.code, told.out) == (2, "")
    assert told.err.count("\n") == 1
    assert told.err.startswith("sepcal-mag: sepcal.toml: ")
    assert expected in told.err


def test_no_such_project(project: Path) -> None:
    told = fit(project, "", "--project", "none.toml")
    assert told.code == 2
    assert "none.toml" in told.err
