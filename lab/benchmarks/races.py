# SPDX-License-Identifier: BSD-3-Clause
"""All races by name, in the order in which they are run and shown."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any

Run = Callable[..., Any]
RACES = {  # functions run(folder, rounds, longest) that yield results
    "limits": "limits.run",
    "samples": "stage_one.run",
    "stage-one": "stage_one.run_whole",
    "stage-two": "stage_two.run",
    "fit": "whole_fit.run",
    "long-fit": "whole_fit.run_long",
    "fit-with-effects": "whole_fit.run_with_effects",
    "small-fits": "small_fits.run",
    "growth": "growth.run",
    "stream": "streaming.run",
    "reading": "reading.run",
    "output-error": "output_error.run",
    "filter-error": "filter_error.run",
    "smoother": "smoother.run",
}
BASELINE = "baseline"  # against an older commit, where one is named


def find_run(name: str) -> Run:
    """The race's function."""
    module, function = RACES[name].split(".")
    run: Run = getattr(importlib.import_module(f"benchmarks.{module}"), function)
    return run
