# SPDX-License-Identifier: BSD-3-Clause
"""Benches to try the apps on: simulated once a session, then copied for each test to spoil."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

pytest.register_assert_rewrite("apps", "refusals")

from apps import FIVE_HOLE_MODEL, FIVE_HOLE_OPTIONS, Bench  # noqa: E402
from oracle.magnetometer import Magnetometer  # noqa: E402

OPTIONS = {"sepcal-pitot": FIVE_HOLE_OPTIONS, "sepcal-mag": ()}
MODELS = {"sepcal-pitot": FIVE_HOLE_MODEL, "sepcal-mag": Magnetometer()}
ROWS = {"sepcal-pitot": 400, "sepcal-mag": 300}


@pytest.fixture(scope="session")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Bench]:
    """A bench for each app, not to be written to."""
    benches = {}
    for app, options in OPTIONS.items():
        bench = Bench(app, tmp_path_factory.mktemp(app), options, MODELS[app])
        simulated = bench.run("simulate", "-o", "flight.csv", "--rows", str(ROWS[app]))
        assert simulated.code == 0, simulated.err
        fitted = bench.run("fit", "flight.csv", "-o", "base.json", *options)
        assert fitted.code == 0, fitted.err
        benches[app] = bench
    return benches


def copy_bench(original: Bench, folder: Path) -> Bench:
    """The same bench in another folder."""
    for name in ("flight.csv", "base.json"):
        shutil.copy(original.folder / name, folder)
    return replace(original, folder=folder)


@pytest.fixture(params=list(OPTIONS))
def bench(request: pytest.FixtureRequest, prepared: dict[str, Bench], tmp_path: Path) -> Bench:
    """Each app in turn."""
    return copy_bench(prepared[request.param], tmp_path)


@pytest.fixture
def pitot(prepared: dict[str, Bench], tmp_path: Path) -> Bench:
    """sepcal-pitot alone."""
    return copy_bench(prepared["sepcal-pitot"], tmp_path)


@pytest.fixture
def magnetometer(prepared: dict[str, Bench], tmp_path: Path) -> Bench:
    """sepcal-mag alone."""
    return copy_bench(prepared["sepcal-mag"], tmp_path)
