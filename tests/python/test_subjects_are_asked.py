# SPDX-License-Identifier: BSD-3-Clause
"""A subject is asked, never named: code that looks at a name knows what that subject should say."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "parts"))

from named_subjects import find_comparisons, sources  # noqa: E402


def test_no_subject_is_named() -> None:
    assert not find_comparisons(sources(ROOT))


@pytest.mark.parametrize(
    "planted",
    [
        'if (probe.name() == "five-hole") return;',
        'return "pitot-static" != model ? 1 : 2;',
        'if (probe->app() == "sepcal-mag") {',
        'if model.startswith("magnetometer"):',
        'if model in ("path", "aero"):',
        "case 'magnetometer-norm':",
        'if (model == "aero"sv)',
    ],
)
def test_one_that_is_planted_is_found(planted: str) -> None:
    assert find_comparisons([("cpp/src/flight/verbs/compare.cpp", planted)])
