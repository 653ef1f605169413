# SPDX-License-Identifier: BSD-3-Clause
"""Student's quantiles and the limits of a rate, against SciPy's."""

import math

import pytest
from scipy.stats import beta
from scipy.stats import t as student_t

from sepcal.quantiles import binomial_limits, student_quantile, upper_limit


@pytest.mark.parametrize("freedom", [1, 2, 3, 5, 12, 97, 590, 30_000, 3_000_000])
@pytest.mark.parametrize("probability", [0.6, 0.9, 0.975, 0.995])
def test_student_quantile(probability, freedom):
    expected = student_t.ppf(probability, freedom)
    assert student_quantile(probability, freedom) == pytest.approx(expected, rel=1e-7)


def test_no_degrees_of_freedom_no_quantile():
    assert math.isnan(student_quantile(0.975, 0))


@pytest.mark.parametrize(
    ("events", "trials"), [(0, 10), (10, 10), (1, 1), (950, 1000), (9_480, 10_000), (3, 100_000)]
)
@pytest.mark.parametrize("confidence", [0.68, 0.95, 0.99])
def test_binomial_limits_are_those_of_clopper_and_pearson(events, trials, confidence):
    tail = 0.5 * (1.0 - confidence)
    low = beta.ppf(tail, events, trials - events + 1) if events else 0.0
    high = beta.ppf(1.0 - tail, events + 1, trials - events) if events < trials else 1.0
    expected = pytest.approx((low, high), rel=1e-7, abs=1e-12)
    assert binomial_limits(events, trials, confidence) == expected
    one_sided = beta.ppf(0.99, events + 1, trials - events) if events < trials else 1.0
    assert upper_limit(events, trials) == pytest.approx(one_sided, rel=1e-7)


def test_no_trials_no_limits():
    assert all(math.isnan(limit) for limit in binomial_limits(0, 0))
