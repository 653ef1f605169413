# SPDX-License-Identifier: BSD-3-Clause
"""Do intervals hold the truth? Eight draws a case; `scripts/study intervals` takes 2,000."""

from dataclasses import replace

import pytest

from studies.intervals.coverage import CoverageOptions, interval_coverage
from studies.intervals.promises import promises
from studies.intervals.write_up import write_coverage

SEEDS = 8


@pytest.fixture(scope="module")
def coverage():
    """Of the tube, which takes long and has half the draws of the others, eight as well."""
    cases = ("short", "at_bound", "near_bound", "curved", "coloured")
    rows = interval_coverage(CoverageOptions(seeds=SEEDS, cases=cases, processes=1))
    tube = CoverageOptions(seeds=2 * SEEDS, cases=("weak",), processes=1)
    return rows + interval_coverage(tube)


def test_eight_draws_keep_the_promises(coverage):
    """Counts within the binomial's limits, every end found, lengths of both kinds alike."""
    findings = promises(coverage)
    assert [one for one in findings if not one.holds] == []
    assert {row.seeds for row in coverage} == {SEEDS}
    assert len(findings) == 6 + 3 + 2 + 4 + 9 + 8 + 1


def test_a_long_side_makes_profiles_longer(coverage):
    """Of s u / (K + u) the parabola's ends are too near on one side."""
    curved = [row for row in coverage if row.name == "curved"]
    assert len(curved) == 2
    assert all(row.profile_length > 1.3 * row.gaussian_length for row in curved)


@pytest.mark.parametrize(
    "wrong",
    [
        {"profile_holds": 3},
        {"profile_holds": 6},  # of each parameter: all together they show
        {"profile_given": 7},
        {"gaussian_holds": 3, "gaussian_given": 8},
    ],
    ids=str,
)
def test_what_breaks_a_promise_is_found(coverage, wrong):
    findings = promises([replace(row, **wrong) for row in coverage])
    assert any(not one.holds for one in findings)


def test_limits_of_the_whole_study(coverage):
    """Those of 200 draws as they always were: SciPy's binom.interval(0.9999, 200, 0.95)."""
    row = replace(coverage[0], seeds=200, profile_holds=175)
    assert promises([row])[0].limits == "176 to 199"
    assert not promises([row])[0].holds


def test_the_study_does_not_depend_on_its_processes(tmp_path):
    one = CoverageOptions(seeds=5, processes=1, cases=("short", "curved"))
    two = CoverageOptions(seeds=5, processes=2, cases=("short", "curved"))
    rows = interval_coverage(one)
    assert interval_coverage(two) == rows
    file = tmp_path / "intervals.md"
    write_coverage(rows, one, file)
    text = file.read_text(encoding="utf-8")
    assert "--seeds 5" in text
    assert text.count("\n| a wave, 12 rows | 5 | `a` |") == 1
    assert text.startswith("# Intervals\n\n## How often they hold the truth\n")
    file.write_text(f"# Mine\n\n{text.partition(chr(10) * 2)[2]}and more", encoding="utf-8")
    write_coverage(rows, one, file)
    assert file.read_text(encoding="utf-8") == text.replace("# Intervals", "# Mine", 1)
