# SPDX-License-Identifier: BSD-3-Clause
"""Recipes of package managers against CMakeLists.txt and one another, and what hosts read."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

yaml = pytest.importorskip("yaml")  # Conan brings it

ROOT = Path(__file__).resolve().parents[2]
PACKAGING = ROOT / "packaging"
CMAKE = (ROOT / "CMakeLists.txt").read_text()
VERSION = re.search(r"project\(\s*sepcal\s+VERSION\s+([0-9.]+)", CMAKE)[1]

# By CMake's names: what Debian, vcpkg, Conan, conda-forge and Homebrew call it.
NAMES = {
    "Eigen3": ("libeigen3-dev", "eigen3", "eigen", "eigen", "eigen"),
    "Ceres": ("libceres-dev", "ceres", "ceres-solver", "ceres-solver", "ceres-solver"),
    "NLopt": ("libnlopt-dev libnlopt-cxx-dev", "nlopt", "nlopt", "nlopt", "nlopt"),
    "fmt": ("libfmt-dev", "fmt", "fmt", "fmt", "fmt"),
    "SEPCAL_XSIMD_INCLUDE_DIR": ("libxsimd-dev", "xsimd", "xsimd", "xsimd", "xsimd"),
    "nlohmann_json": (
        "nlohmann-json3-dev", "nlohmann-json", "nlohmann_json", "nlohmann_json", "nlohmann-json"
    ),
    "ZLIB": ("zlib1g-dev", "zlib", "zlib", "zlib", "zlib"),
    "zstd": ("libzstd-dev", "zstd", "zstd", "zstd", "zstd"),
    "CLI11": ("libcli11-dev", None, None, "cli11", "cli11"),
    "SEPCAL_TOML_INCLUDE_DIR": ("libtomlplusplus-dev", None, None, "tomlplusplus", "tomlplusplus"),
}  # fmt: skip
MANAGERS = ("debian", "vcpkg", "conan", "conda", "homebrew")
TOOLS = {  # what builds, and is in no binary
    "debian": {"build-essential", "ccache", "cmake", "debhelper-compat", "ninja-build"}
    | {"python3-dev", "python3-venv"},
    "conda": {"cmake", "ninja", "pip", "python", "pybind11", "scikit-build-core"},
    "homebrew": {"bash", "ccache", "cmake", "coreutils", "doctest", "ninja", "pkgconf"}
    | {"python@3.13", "shellcheck"},
}
PROGRAMS = {"CLI11", "SEPCAL_TOML_INCLUDE_DIR"}


def looked_for() -> dict[str, set[str]]:
    """CMake's names by the part that needs them."""
    packages = CMAKE[CMAKE.index("include(GNUInstallDirs)") :]
    core, engine, flight = re.split(r"^if\(SEPCAL_BUILD_(?:ENGINE|FLIGHT)\)", packages, flags=re.M)[
        :3
    ]
    flight = flight.partition("\nendif()")[0]
    find = re.compile(r"find_(?:package|path)\((\w+)")
    return {
        "core": set(find.findall(core)),
        "engine": set(find.findall(engine)) - {"Threads"},
        "flight": set(find.findall(flight)),
        "programs": PROGRAMS,
    }


def named(manager: str, *parts: str) -> set[str]:
    """What a manager calls what these parts need."""
    at = MANAGERS.index(manager)
    told = (NAMES[name][at] for part in parts for name in looked_for()[part])
    return {word for name in told if name for word in name.split()}


def least() -> dict[str, str]:
    """The oldest version that CMake accepts, by its names."""
    asked = r"find_package\((\w+) (\d[\d.]*)|(\w+)_VERSION VERSION_LESS (\d[\d.]*)"
    return {name or other: old or least for name, old, other, least in re.findall(asked, CMAKE)}


def debian_control() -> list[dict[str, str]]:
    """The paragraphs of debian/control."""
    paragraphs = (PACKAGING / "debian" / "control").read_text().strip().split("\n\n")
    fields = re.compile(r"^([\w-]+):((?:.*)(?:\n .*)*)", re.M)
    return [dict(fields.findall(paragraph)) for paragraph in paragraphs]


def debian_list(field: str) -> dict[str, str]:
    """{package: version asked for, or nothing} of a field with a package a line."""
    entries = [entry.strip() for entry in field.split(",") if entry.strip()]
    found = [re.match(r"(\S+)(?: \((?:>?=) (.+)\))?$", entry) for entry in entries]
    return {one[1]: one[2] or "" for one in found}


def apt_packages(name: str) -> set[str]:
    """Of a file of scripts/."""
    lines = (ROOT / "scripts" / name).read_text().splitlines()
    return {line for line in lines if line and not line.startswith("#")}


def conda_outputs() -> dict[str, dict[str, Any]]:
    """The recipe's packages by name."""
    recipe = yaml.safe_load((PACKAGING / "conda-forge" / "recipe.yaml").read_text())
    return {output["package"]["name"]: output for output in recipe["outputs"]}


def conda_names(requirements: list[str]) -> set[str]:
    """Without versions and what a recipe computes."""
    return {one.split()[0] for one in requirements if not one.startswith("${{")}


def test_the_table_has_every_package_that_cmake_looks_for() -> None:
    text = "".join((ROOT / name / "CMakeLists.txt").read_text() for name in (".", "apps"))
    found = set(re.findall(r"^\s*find_(?:package|path)\((\w+)", text, re.M))
    assert found - {"Threads"} == set(NAMES)
    assert set().union(*looked_for().values()) == set(NAMES)


def test_debian_builds_with_what_the_scripts_install() -> None:
    source, programs, library = debian_control()
    asked = set(debian_list(source["Build-Depends"]))
    assert asked - TOOLS["debian"] == named("debian", "core", "engine", "flight", "programs")
    assert apt_packages("apt-packages.txt") - TOOLS["debian"] == asked - TOOLS["debian"]
    needed = named("debian", "core", "engine", "flight") - {"libxsimd-dev"}  # in no public header
    assert set(debian_list(library["Depends"])) - {"${misc:Depends}"} == needed
    assert programs["Package"].strip() == "sepcal"


def test_vcpkg_s_features_need_what_the_parts_do() -> None:
    port = json.loads((PACKAGING / "vcpkg" / "vcpkg.json").read_text())

    def names(entries: list[Any]) -> set[str]:
        told = [entry if isinstance(entry, dict) else {"name": entry} for entry in entries]
        return {one["name"] for one in told if not one.get("host")} - {"sepcal"}

    assert names(port["dependencies"]) == named("vcpkg", "core")
    for feature in ("engine", "flight"):
        assert names(port["features"][feature]["dependencies"]) == named("vcpkg", feature)


def test_conan_s_options_need_what_the_parts_do() -> None:
    recipe = (PACKAGING / "conan" / "conanfile.py").read_text()
    body = recipe[recipe.index("def requirements") : recipe.index("def generate")]
    parts = re.split(r"if self\.options\.(?:engine|flight):", body)
    for part, text in zip(("core", "engine", "flight"), parts, strict=True):
        assert set(re.findall(r'requires\("([\w-]+)/', text)) == named("conan", part)
    profile = (PACKAGING / "conan" / "system_libraries.profile").read_text()
    told = set(re.findall(r"^([\w-]+)/", profile, re.M))
    assert told == named("conan", "core", "engine", "flight")


def test_conda_s_outputs_need_what_the_parts_do() -> None:
    outputs = conda_outputs()
    library = outputs["libsepcal"]["requirements"]
    assert conda_names(library["host"]) == named("conda", "core", "engine", "flight")
    assert conda_names(library["run"]) == conda_names(library["host"]) - {"xsimd"}
    module = conda_names(outputs["sepcal"]["requirements"]["host"])
    assert module - TOOLS["conda"] == named("conda", "core", "engine", "flight", "programs")
    for output in outputs.values():
        assert conda_names(output["requirements"]["build"]) <= TOOLS["conda"]


def test_conda_s_module_needs_what_pyproject_says() -> None:
    project = (ROOT / "pyproject.toml").read_text()
    for name, where in (("pybind11", "host"), ("scikit-build-core", "host"), ("numpy", "run")):
        wanted = re.search(rf'"{name}(>=[\d.]+)"', project)[1]
        assert f"{name} {wanted}" in conda_outputs()["sepcal"]["requirements"][where]
    python = re.search(r'requires-python = "(.+)"', project)[1]
    assert f"python {python}" in conda_outputs()["sepcal"]["requirements"]["run"]


def test_homebrew_brings_what_the_scripts_need() -> None:
    brewfile = (PACKAGING / "homebrew" / "Brewfile").read_text()
    brought = set(re.findall(r'^brew "(.+)"$', brewfile, re.M))
    wanted = named("homebrew", "core", "engine", "flight", "programs")
    assert brought - TOOLS["homebrew"] == wanted


@pytest.mark.parametrize("name", least())
def test_the_oldest_version_is_cmake_s(name: str) -> None:
    """Where a manager's recipe names one."""
    wanted = least()[name]
    debian, _, _, conda, _ = NAMES[name]
    asked = debian_list(debian_control()[0]["Build-Depends"])
    for package in debian.split():
        assert asked[package] == wanted
    for output in conda_outputs().values():
        told = [one for one in output["requirements"]["host"] if one.split()[0] == conda]
        assert told[0].startswith(f"{conda} >={wanted}")


def test_all_tell_the_same_version() -> None:
    port = json.loads((PACKAGING / "vcpkg" / "vcpkg.json").read_text())
    recipe = yaml.safe_load((PACKAGING / "conda-forge" / "recipe.yaml").read_text())
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    debian = (PACKAGING / "debian" / "changelog").read_text()
    told = {
        "vcpkg": port["version-semver"],
        "conda-forge": recipe["context"]["version"],
        "citation": citation["version"],
        "debian": re.match(r"sepcal \((.+)-\d+\)", debian)[1],
    }
    assert told == dict.fromkeys(told, VERSION)


def test_the_citation_has_what_its_format_asks_for() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert {"cff-version", "message", "title", "authors"} <= citation.keys()
    for reference in citation["references"]:
        assert {"type", "title", "authors"} <= reference.keys()
        assert reference["title"] in " ".join((ROOT / "docs" / "paper.md").read_text().split())


def test_debian_s_packages_hold_what_is_installed() -> None:
    """A list for each package of control, scripts that can be run, and LICENSE whole."""
    packages = {paragraph["Package"].strip() for paragraph in debian_control()[1:]}
    lists = {file.stem for file in (PACKAGING / "debian").glob("*.install")}
    assert lists == packages
    for name in ("rules", "tests/programs", "tests/library"):
        assert (PACKAGING / "debian" / name).stat().st_mode & 0o111
    copyright_file = (PACKAGING / "debian" / "copyright").read_text()
    licence = [line for line in (ROOT / "LICENSE").read_text().splitlines() if line.strip()]
    for line in licence[2:]:
        assert f" {line}\n" in copyright_file or line in copyright_file.splitlines()


# What hosts read, without which a file of theirs is not taken.

TEMPLATES = sorted((ROOT / ".github" / "ISSUE_TEMPLATE").glob("[!c]*.yml"))
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
needs_host = pytest.mark.skipif(not WORKFLOWS, reason="a source archive has no .github/")


@pytest.mark.parametrize("file", TEMPLATES, ids=lambda file: file.stem)
def test_an_issue_form_has_what_it_needs(file: Path) -> None:
    form = yaml.safe_load(file.read_text())
    assert {"name", "description", "body"} <= form.keys()
    ids = [field["id"] for field in form["body"] if field["type"] != "markdown"]
    assert len(ids) == len(set(ids))
    for field in form["body"]:
        assert field["type"] in {"markdown", "input", "textarea", "dropdown", "checkboxes"}
        assert "value" in field["attributes"] or "label" in field["attributes"]


@pytest.mark.parametrize("file", WORKFLOWS, ids=lambda file: file.stem)
def test_a_workflow_calls_scripts_and_has_no_logic(file: Path) -> None:
    workflow = yaml.safe_load(file.read_text())
    assert workflow[True]  # what YAML makes of `on`
    assert workflow["permissions"] == {"contents": "read"}
    for job in workflow["jobs"].values():
        assert job["timeout-minutes"] > 0
        assert "if" not in job
        for step in job["steps"]:
            assert "if" not in step
            assert ("uses" in step) != ("run" in step)
            if "run" in step:
                assert re.fullmatch(
                    r'\./scripts/[\w-]+( [\w-]+| "\$VERSION")*'
                    r"|brew bundle --file=packaging/homebrew/Brewfile",
                    step["run"],
                )
                assert "${{" not in step["run"]


@needs_host
def test_what_workflows_call_is_there() -> None:
    called = set(re.findall(r"\./scripts/([\w-]+)", "".join(f.read_text() for f in WORKFLOWS)))
    assert {"test", "docs", "wheel", "release"} <= called
    assert {name for name in called if not (ROOT / "scripts" / name).exists()} <= {"docs", "wheel"}


def test_the_hook_runs_the_quick_linters() -> None:
    (repository,) = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())["repos"]
    assert repository["repo"] == "local"
    (hook,) = repository["hooks"]
    assert {"id", "name", "entry", "language"} <= hook.keys()
    assert hook["entry"] == "scripts/lint --quick"
    assert hook["pass_filenames"] is False


def test_debian_s_changelog_is_read_by_its_own_program() -> None:
    """dpkg-parsechangelog, where it is there."""
    program = shutil.which("dpkg-parsechangelog")
    if program is None:
        pytest.skip("no dpkg-dev")
    asked = [program, "-l", PACKAGING / "debian" / "changelog", "-S", "Version"]
    told = subprocess.run(asked, capture_output=True, text=True, check=True).stdout
    assert told.strip() == f"{VERSION}-1"
