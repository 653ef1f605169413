# SPDX-License-Identifier: BSD-3-Clause
"""Each effect, hidden in eight flights and added; `scripts/study effect-coverage` flies 60.

A parameter's interval that holds 95 % of the time covers fewer than 4 of 8 once in 65,000. All
parameters of a probe together are held against four standard errors of their count.
"""

import pytest

from studies import effect_coverage
from studies.effect_coverage import CASES, Cover, cover, together

FLIGHTS = range(8)
SCANNED = (
    "bias_step",
    "water_blockage",
    "sensor_lag",
    "pneumatic_lag",
    "time_offset",
    "clock_drift",
)  # half of it


@pytest.mark.slow
@pytest.mark.parametrize("probe", effect_coverage.PROBES)
def test_intervals_of_added_effects_cover(probe):
    covers = [
        cover(case, FLIGHTS[:4] if case.effect in SCANNED else FLIGHTS, workers=1)
        for case in CASES
        if case.probe == probe
    ]
    findings = [finding for one in covers for finding in one.findings]
    assert [one for one in [*findings, together(covers)] if not one.holds] == []


def test_every_effect_of_the_catalogue_is_flown():
    assert len(CASES) == 59


def test_few_flights_together_show_what_one_parameter_does_not():
    short = [Cover(case, 8, {"a": 6, "b": 7}, []) for case in CASES]
    assert not together(short).holds
    right = [Cover(case, 8, {"a": 8, "b": 7}, []) for case in CASES]
    assert together(right).holds
