# SPDX-License-Identifier: BSD-3-Clause
"""CONTRIBUTING.md against the tree: its paths are there, and what its lists promise holds."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import sepcal
from sepcal.catalogue import PROBES
from sepcal.options import LOG_CHOICE, FitOptions
from studies import effect_coverage

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "CONTRIBUTING.md").read_text()
ALIASES = {"bias_drift", "propwash", "wind_drift", "wind_shear"}  # of a port and its driver
PATHS = sorted(set(re.findall(r"`((?:cpp|python|apps|tests|scripts|docs)/[\w./]*)`", TEXT)))


def test_paths_are_there() -> None:
    """Every folder and file that it names."""
    assert len(PATHS) > 25
    assert not [path for path in PATHS if not (ROOT / path).exists()]


def test_one_test_runs_as_shown() -> None:
    """The files of the two commands that run one."""
    for shown in re.findall(r"-R (\w+)", TEXT):
        assert list((ROOT / "tests" / "cpp").rglob(f"{shown}.cpp"))
    for shown in re.findall(r"pytest (\S+\.py)", TEXT):
        assert (ROOT / shown).exists()


def test_every_room_is_on_its_map() -> None:
    """The rooms that it names are some of rooms.toml."""
    rooms = re.findall(
        r'^\["?([\w/]+)"?\]', (ROOT / "cpp" / "rooms.toml").read_text(), re.MULTILINE
    )
    row = next(line for line in TEXT.splitlines() if line.startswith("| `cpp/src/` |"))
    for name in re.findall(r"`(\w+)`", row.split("|")[2]):
        assert name in rooms


@pytest.mark.parametrize("option", FitOptions.__annotations__)
def test_an_option_stands_where_it_says(option: str) -> None:
    """In each file of the list; of a log beside that of a fit."""
    of_log = option in (*LOG_CHOICE, "effects", "free")  # of a calibration
    home = "detail/flight/log_choice" if option in LOG_CHOICE else "flight/calibration"
    header = f"cpp/include/sepcal/{home if of_log else 'options'}.hpp"
    spelled = {"effects": "effect", "from_time": "from", "to_time": "to"}
    for file, word in (
        (header, option),
        ("cpp/src/bindings/options.cpp", option),
        ("python/sepcal/options.py", option),
    ):
        assert re.search(rf"\b{word}\b", (ROOT / file).read_text()), (file, word)
    typed = "--" + spelled.get(option, option).replace("_", "-")
    apps = "".join(file.read_text() for file in (ROOT / "apps").glob("*.cpp"))
    in_python_alone = {
        "coloured_errors", "descents", "iterations", "noise_iterations", "sampling_distribution",
        "screens",
    }  # fmt: skip
    if option not in in_python_alone:
        assert typed in apps, typed


@pytest.mark.parametrize("probe", PROBES)
def test_an_effect_stands_where_it_says(probe: str) -> None:
    """Each that is called without a driver is in docs/effects.md, and is flown somewhere."""
    told = (ROOT / "docs" / "effects.md").read_text()
    cases = (ROOT / "tests" / "oracle" / "effect_cases.py").read_text()
    flown = {case.effect for case in effect_coverage.CASES}
    named = {effect.name for effect in sepcal.effects(probe) if "[" not in effect.name} - ALIASES
    assert not {name for name in named if f"`{name}`" not in told}
    assert not {name for name in named if name not in flown and f'"{name}"' not in cases}
