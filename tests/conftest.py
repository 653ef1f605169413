# SPDX-License-Identifier: BSD-3-Clause
"""Which sepcal is tested, the installed one or else that of build/python; and the quick tests."""

import importlib.util
import sys
from pathlib import Path

import pytest

if importlib.util.find_spec("sepcal") is None:
    sys.path.insert(0, str(Path(__file__).parents[1] / "build" / "python"))

# Whole stories, each of many fits: read logs, write pages, start clusters, fly studies.
LONG = {
    "test_aircraft",
    "test_aircraft_app",
    "test_attitude_independent",
    "test_bad_outputs",
    "test_diagnose_api",
    "test_documented_runs",
    "test_documents",
    "test_effect_coverage",
    "test_fit_many_cluster",
    "test_hidden_effects_study",
    "test_interval_coverage",
    "test_monte_carlo",
    "test_monte_carlo_cluster",
    "test_own_state_model",
    "test_recorded_probes",
    "test_random_exports",
    "test_report",
    "test_same_diagnoses",
    "test_studies",
    "test_trust",
}


def pytest_report_header() -> str:
    """Where sepcal comes from."""
    import sepcal

    return f"sepcal: {sepcal.__path__[0]}"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds --quick."""
    parser.addoption(
        "--quick",
        action="store_true",
        help="no long stories; of a test with parameters the first case alone",
    )


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leaves out what --quick does not run."""
    if not config.getoption("--quick"):
        return
    chosen: dict[str, pytest.Item] = {}
    for item in items:
        marks = {mark.name for mark in item.iter_markers()}
        if item.path.stem not in LONG and not marks & {"long", "slow"}:
            chosen.setdefault(item.nodeid.partition("[")[0], item)
    kept = set(chosen.values())
    config.hook.pytest_deselected(items=[item for item in items if item not in kept])
    items[:] = [item for item in items if item in kept]
