# SPDX-License-Identifier: BSD-3-Clause
"""One result on every instruction set that the processor takes; SEPCAL_ISA chooses."""

import os
import re
import subprocess

import numpy as np
import pytest

from apps import APPS, Bench, parse_json, values_of


def fit_on(bench: Bench, instruction_set: str) -> subprocess.CompletedProcess[str]:
    """The flight's fit with SEPCAL_ISA set."""
    command = [str(APPS / bench.app), "fit", "flight.csv", "--json", *bench.options]
    environment = {**os.environ, "SEPCAL_ISA": instruction_set}
    return subprocess.run(
        command, cwd=bench.folder, env=environment, capture_output=True, text=True, check=False
    )


def known_sets(bench: Bench) -> list[str]:
    """What the refusal of an unknown one lists, the widest first."""
    refused = fit_on(bench, "abacus")
    assert refused.returncode == 2
    assert len(refused.stderr.splitlines()) == 1
    listed = re.search(r"SEPCAL_ISA is abacus; this processor takes (.*)$", refused.stderr)
    assert listed
    return listed.group(1).split(", ")


def test_estimates_agree(bench: Bench):
    sets = known_sets(bench)
    assert sets[-1] == "baseline"
    results = [parse_json(fit_on(bench, name).stdout) for name in sets]
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
    assert parse_json(fit_on(bench, sets[0]).stdout) == parse_json(fit_on(bench, "").stdout)
