# SPDX-License-Identifier: BSD-3-Clause
"""Files of schema version 2 are read, and mean what they meant: tests/schema_2 has two.

They are of 5d6693a, which wrote them, of flights of `simulate --rows` 200 and 300.
"""

from pathlib import Path
from typing import Any

import pytest

import sepcal
from apps import parse_json

HERE = Path(__file__).resolve().parent.parent / "schema_2"


def renamed(before: dict[str, Any]) -> dict[str, Any]:
    """What was written, under the names of now."""
    now = {**before, "schema_version": 3, "options": {**before["options"]}}
    for stage in ("stage_one", "stage_two"):
        now["options"][f"{stage}_segments"] = now["options"].pop(stage)
    assert "collinearity" not in now  # which is found of the correlation
    now["stage_two"] = {**before["stage_two"]}
    now["stage_two"]["second_stage"] = now["stage_two"].pop("method")
    return now


@pytest.mark.parametrize("name", ["tube", "aero"])
def test_it_is_what_it_was_under_the_names_of_now(name: str, tmp_path: Path) -> None:
    file = HERE / f"{name}.json"
    before = parse_json(file.read_text())
    fitted = sepcal.load(file)
    assert fitted.second_stage == before["stage_two"]["method"]
    told = parse_json(fitted.to_json())
    assert list(told.pop("collinearity")) == ["pairs", "directions"]
    assert told == renamed(before)
    fitted.save(tmp_path / "again.json")
    again = parse_json((tmp_path / "again.json").read_text())
    assert again.pop("collinearity")["pairs"] is not None
    assert again == renamed(before)
