# SPDX-License-Identifier: BSD-3-Clause
"""Where code compares something with a subject's name, outside that subject's own files.

A subject's own files give its name once, and a line registers it. The two apps of sensors are of
their probes, whose options they take, and a two-step fit's file has a path and coefficients.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

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


def sources(root: Path) -> Iterator[tuple[str, str]]:
    """Every source of the product: its name below `root`, and its text."""
    for pattern in ("cpp/**/*.[ch]pp", "apps/**/*.[ch]pp", "python/sepcal/**/*.py"):
        for file in sorted(root.glob(pattern)):
            yield str(file.relative_to(root)), file.read_text()


def find_comparisons(texts: Iterable[tuple[str, str]]) -> list[str]:
    """One line for each."""
    return [
        f"{name}: {match[0]}"
        for name, text in texts
        if not re.search(f"{OWN_FILES}|{SHAPES}", name)
        for match in COMPARED.finditer(text)
    ]
