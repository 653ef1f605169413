# SPDX-License-Identifier: BSD-3-Clause
"""Recorded flights, from $SEPCAL_FIXTURES, by default ../shared/data beside the checkout."""

import os
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).parents[1]
FIXTURES = Path(os.environ.get("SEPCAL_FIXTURES", CHECKOUT.parent / "shared" / "data"))
CASES = FIXTURES.parent / "cases" / "verdicts"


def find_fixture(name: str) -> Path:
    """The file; a test that asks for one that isn't there is skipped."""
    file = FIXTURES / name
    if not file.is_file():
        pytest.skip(f"no recorded flight {file}; set SEPCAL_FIXTURES to its folder")
    return file.resolve()


def find_case(name: str) -> Path:
    """One of the reduced logs beside the recorded flights, skipped likewise."""
    file = CASES / name
    if not file.is_file():
        pytest.skip(f"no reduced log {file}; set SEPCAL_FIXTURES to the folder beside its cases")
    return file.resolve()
