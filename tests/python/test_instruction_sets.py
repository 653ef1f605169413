# SPDX-License-Identifier: BSD-3-Clause
"""One result on every instruction set that the processor takes; SEPCAL_ISA chooses."""

import numpy as np
import pytest

from apps import Bench, Outcome, list_instruction_sets, run, values_of


def fit_on(bench: Bench, instruction_set: str) -> Outcome:
    """The flight's fit with SEPCAL_ISA set."""
    command = ("fit", "flight.csv", "--json", *bench.options)
    return run(bench.app, *command, folder=bench.folder, instruction_set=instruction_set)


def known_sets(bench: Bench) -> list[str]:
    """The widest first."""
    command = ("fit", "flight.csv", "--json", *bench.options)
    return list_instruction_sets(bench.app, *command, folder=bench.folder)


def test_estimates_agree(bench: Bench):
    sets = known_sets(bench)
    assert sets[-1] == "baseline"
    results = [fit_on(bench, name).result for name in sets]
    errors = np.array(
        [entry["standard_error"] for entry in results[0]["parameters"].values()], dtype=float
    )
    for result in results[1:]:
        off = np.abs(values_of(result) - values_of(results[0]))
        assert np.all(off < 1e-9 * errors)
        assert np.all(off < 1e-12 * np.maximum(1.0, np.abs(values_of(results[0]))))
        assert result["cost"] == pytest.approx(results[0]["cost"], rel=1e-12)


def test_the_default_is_the_widest(bench: Bench):
    sets = known_sets(bench)
    assert fit_on(bench, sets[0]).result == fit_on(bench, "").result
