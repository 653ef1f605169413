# SPDX-License-Identifier: BSD-3-Clause
"""A subject is asked, never named: code that looks at a name knows what that subject should say.

A subject's own files give its name once, and a line registers it. The two apps of sensors are of
their probes, whose options they take, and a two-step fit's file has a path and coefficients.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NAMES = (
    "five-hole", "five_hole", "vane-boom", "vane_boom", "pitot-static", "pitot_static",
    "magnetometer", "magnetometer-norm", "magnetometer_norm", "path", "longitudinal", "lateral",
    "six-dof", "aero", "sepcal-pitot", "sepcal-mag", "sepcal-aircraft",
)  # fmt: skip
NAME = rf"[\"'](?:{'|'.join(NAMES)})[\"'](?:sv)?"
COMPARED = re.compile(
    rf"(?:==|!=)\s*{NAME}|{NAME}\s*(?:==|!=)"
    rf"|(?:starts_with|ends_with|startswith|endswith|compare|contains|strcmp)\([^()]*{NAME}"
    rf"|\bin \(?{NAME}(?:, {NAME})+|\bcase {NAME}"
)
OWN_FILES = r"^apps/sepcal_(pitot|mag)\.cpp$|^cpp/src/flight/aircraft/"
SHAPES = r"^python/sepcal/(aircraft|logs/recording)\.py$"  # "axes" of an aircraft, not its name


def sources() -> Iterator[tuple[str, str]]:
    for pattern in ("cpp/**/*.[ch]pp", "apps/**/*.[ch]pp", "python/sepcal/**/*.py"):
        for file in sorted(ROOT.glob(pattern)):
            yield str(file.relative_to(ROOT)), file.read_text()


def find_comparisons(texts: Iterator[tuple[str, str]]) -> list[str]:
    return [
        f"{name}: {match[0]}"
        for name, text in texts
        if not re.search(f"{OWN_FILES}|{SHAPES}", name)
        for match in COMPARED.finditer(text)
    ]


def test_no_subject_is_named() -> None:
    assert not find_comparisons(sources())


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
    assert find_comparisons(iter([("cpp/src/flight/verbs/compare.cpp", planted)]))
