# SPDX-License-Identifier: BSD-3-Clause
"""CONTRIBUTING.md against the tree: its paths are there, and what its lists promise holds."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import sepcal
from sepcal.catalogue import PROBES
from sepcal.fit_options import FitOptions
from sepcal.options import LOG_CHOICE
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
def test_an_option_stands_in_two_places(option: str) -> None:
    """Its field and its row; of a few, code asks for them by name too."""
    home = {True: "detail/flight/log_choice", False: "options"}[option in LOG_CHOICE]
    if option in ("effects", "free"):
        home = "flight/calibration"
    header = (ROOT / "cpp" / "include" / "sepcal" / f"{home}.hpp").read_text()
    assert re.search(rf"\b{option}\b = |\b{option};|\b{option} =", header)
    table = (ROOT / "cpp" / "src" / "flight" / "schema" / "option_fields.hpp").read_text()
    assert table.count(f'option("{option}", ') == 1
    shells = (
        "apps/fit_arguments.cpp",
        "cpp/src/bindings/options.cpp",
        "cpp/src/flight/json/options_json.cpp",
        "python/sepcal/options.py",
    )
    asked_for = {"threads"}  # how many may be had
    for shell in shells:
        assert option in asked_for or f'"{option}"' not in (ROOT / shell).read_text(), shell


def told_rows() -> list[tuple[str, str]]:
    """(struct, field) of each row of result_fields.hpp."""
    text = (ROOT / "cpp" / "src" / "flight" / "schema" / "result_fields.hpp").read_text()
    parts = re.split(r"struct ResultFields<(\w+)>", text)
    return [
        (struct, field)
        for struct, body in zip(parts[1::2], parts[2::2], strict=True)
        for field in re.findall(r'row\("(\w+)"', body)
    ]


def test_a_field_of_a_result_stands_in_two_places() -> None:
    """Its member and its row: neither JSON nor bindings ask for it by name."""
    rows = told_rows()
    assert len(rows) > 80
    assert len(rows) == len(set(rows))
    shells = [*(ROOT / "cpp/src/flight/json").glob("*"), *(ROOT / "cpp/src/bindings").glob("*.?pp")]
    text = "".join(file.read_text() for file in shells)
    for field in ("held_out_gain", "share_after_selection", "slope_error", "ljung_box_p"):
        assert field in {name for _, name in rows}
        assert not re.search(rf"\b{field}\b", text), field


@pytest.mark.parametrize("probe", PROBES)
def test_an_effect_stands_where_it_says(probe: str) -> None:
    """Each that is called without a driver is in docs/effects.md, and is flown somewhere."""
    told = (ROOT / "docs" / "effects.md").read_text()
    cases = (ROOT / "tests" / "oracle" / "effect_cases.py").read_text()
    flown = {case.effect for case in effect_coverage.CASES}
    named = {effect.name for effect in sepcal.effects(probe) if "[" not in effect.name} - ALIASES
    assert not {name for name in named if f"`{name}`" not in told}
    assert not {name for name in named if name not in flown and f'"{name}"' not in cases}
