# SPDX-License-Identifier: BSD-3-Clause
"""Studies that anyone can rerun: `python -m sepcal study hidden-effects`, `... intervals`."""

from sepcal.study.coverage import CoverageOptions, interval_coverage
from sepcal.study.coverage_write_up import write_coverage
from sepcal.study.experiments import StudyOptions, hidden_effects
from sepcal.study.write_up import write_up

__all__ = [
    "CoverageOptions",
    "StudyOptions",
    "hidden_effects",
    "interval_coverage",
    "write_coverage",
    "write_up",
]
