# SPDX-License-Identifier: BSD-3-Clause
"""The arithmetic of scripts/coverage, on counts written by hand."""

import json
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "parts"))

import room_coverage as counts  # noqa: E402

# Two instances of one template in a header of core, an app, and a file of someone else's.
LINES = f"""\
SF:{ROOT}/cpp/include/sepcal/detail/rotation.hpp
DA:3,1
DA:4,0
DA:5,0
DA:6,0
DA:9,0
end_of_record
SF:{ROOT}/apps/running.cpp
DA:10,7
DA:11,2
end_of_record
SF:/usr/include/string
DA:1,0
end_of_record
SF:{ROOT}/cpp/include/sepcal/detail/rotation.hpp
DA:4,5
end_of_record
"""
BRANCHES = {
    "data": [
        {
            "files": [
                {
                    "filename": f"{ROOT}/cpp/include/sepcal/detail/rotation.hpp",
                    "branches": [
                        [3, 1, 3, 9, 4, 0, 0, 0, 4],
                        [3, 1, 3, 9, 0, 2, 0, 0, 4],
                        [6, 1, 6, 9, 0, 1, 0, 0, 4],
                    ],
                },
                {"filename": f"{ROOT}/apps/running.cpp", "branches": []},
            ]
        }
    ]
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """As a run leaves it."""
    (tmp_path / "lines.info").write_text(LINES)
    (tmp_path / "branches.json").write_text(json.dumps(BRANCHES))
    return tmp_path


def test_lines_and_branches_are_counted_by_room(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert counts.main(["table", str(folder)]) == 1
    told = capsys.readouterr()
    assert told.out.splitlines()[2:] == [
        "| core | 5 | 40.0 | 4 | 75.0 |",  # 3 and 4 of 5 ran; both ways at 3, one at 6
        "| apps | 2 | 100.0 | 0 | 100.0 |",
        "| all | 7 | 57.1 | 4 | 75.0 |",
    ]
    assert told.err == "below 90 % of lines: core\n"


def test_lines_that_nothing_ran_are_listed(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert counts.main(["lines", str(folder), "core"]) == 0
    assert capsys.readouterr().out == "cpp/include/sepcal/detail/rotation.hpp: 5-6, 9\n"
    with pytest.raises(SystemExit, match="no room cellar; there are core, apps"):
        counts.main(["lines", str(folder), "cellar"])
