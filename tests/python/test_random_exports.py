# SPDX-License-Identifier: BSD-3-Clause
"""Two dozen of tests/random_exports.py's exports; and that it finds what is planted."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import random_exports
from random_exports import Draw, Found, Header


def need_compilers() -> None:
    missing = [one for one in ("gcc", "g++") if shutil.which(one) is None]
    if missing:
        pytest.skip(f"{' and '.join(missing)} are not on this machine")


@pytest.mark.slow
def test_two_dozen_random_exports(tmp_path: Path) -> None:
    need_compilers()
    found = random_exports.run(24, 20, tmp_path)
    assert found.findings == []
    assert found.exports == 24
    assert found.rows > 24 * 2 * random_exports.ROWS
    assert 0 < found.worst[False] < 1e-12
    assert 1e-9 < found.worst[True] < 1e-6  # the float headers are in float


def headers_of(seed: int, folder: Path) -> list[Header]:
    """Of the first case from that seed on that has a driver's range and outputs."""
    while True:
        case = random_exports.make_case(1, seed)
        seed += 1
        if case is None or "driver_ranges" not in case.calibration.to_dict():
            continue
        if (case.outside == 1).any() and np.isfinite(case.expected).all():
            return random_exports.export_all(case, folder)


def findings_of(batch: list[Header], folder: Path) -> list[str]:
    found = Found()
    random_exports.check_batch(batch, "c", "c99", folder, found)
    return found.findings


@pytest.fixture
def batch(tmp_path: Path) -> list[Header]:
    """The C headers of one case."""
    need_compilers()
    batch = [header for header in headers_of(31, tmp_path) if header.target == "c"]
    assert findings_of(batch, tmp_path) == []
    return batch


def test_another_digit_is_found(batch: list[Header], tmp_path: Path) -> None:
    """Of the double header by 2e-12, of the float header by 2e-6 of the largest reading."""
    case = batch[0].case
    case.expected[5] += 2e-12 * case.sizes
    assert any("of the largest reading off" in line for line in findings_of(batch[:1], tmp_path))
    assert findings_of(batch[1:], tmp_path) == []
    case.expected[5] += 2e-6 * case.sizes
    assert any("of the largest reading off" in line for line in findings_of(batch[1:], tmp_path))


def test_a_guard_that_is_off_is_found(batch: list[Header], tmp_path: Path) -> None:
    case = batch[0].case
    row = int(np.flatnonzero(case.outside == 1)[0])
    case.outside[row] = 0.0
    assert any(f"row {row}: status 3" in line for line in findings_of(batch, tmp_path))


def test_what_does_not_compile_is_found(batch: list[Header], tmp_path: Path) -> None:
    file = tmp_path / batch[0].name
    file.write_text(batch[0].text.replace("*/", "*/ escaped", 1))
    assert any("error" in line for line in findings_of(batch, tmp_path))


def test_an_overflow_is_found(batch: list[Header], tmp_path: Path) -> None:
    """By the sanitizers: an array that is written one too far."""
    file = tmp_path / batch[0].name
    spoilt = batch[0].text.replace("  return 0;\n}", "  at[row] = 1.0;\n  return 0;\n}")
    assert spoilt != batch[0].text
    file.write_text(spoilt)
    assert any(
        "stack-buffer-overflow" in line or "index" in line for line in findings_of(batch, tmp_path)
    )


@pytest.mark.slow
def test_draws_are_of_every_probe_and_shape() -> None:
    """So that two dozen are no two dozen of the same."""
    drawn = [random_exports.make_case(1, seed) for seed in range(100)]
    cases = [case for case in drawn if case is not None]
    assert {case.probe for case in cases} == set(random_exports.PORTS)
    text = " ".join(effect for case in cases for effect in case.effects)
    for shape in ("spline(", "levels(", "^n]", "^2]", "^3]", "*abs(", "cubic", "compressibility"):
        assert shape in text
    columns = [np.ptp(Draw(seed).column(200)) for seed in range(50)]
    assert min(columns) < 0.1 < 100 < max(columns)
