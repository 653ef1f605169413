# SPDX-License-Identifier: BSD-3-Clause
"""Errors of constants beside coloured residuals, and Klein and Morelli's formula for them."""

import numpy as np
import pytest
from numpy.typing import NDArray

import sepcal
from studies import constants
from studies import moment_flights as flights

Array = NDArray[np.float64]

SEEDS = 60


def constant_alone(noise: Array) -> sepcal.AircraftFit:
    """Cm = Cm_0 and noise."""
    flown = flights.maneuver(1, noise.size)
    model = sepcal.Aero(flights.AIRCRAFT, equations={"Cm": ["1"]})
    return sepcal.fit(model, flights.fly(flown, 0.03 + noise), threads=1)


def errors_over_truth(draw: constants.Kind) -> tuple[Array, Array]:
    """Root mean square of a mean's errors over either standard error, sepcal's and by the formula.

    The mean of N rows of noise; SEEDS records.
    """
    ours, theirs, errors = [], [], []
    one = np.ones((constants.ROWS, 1))
    for seed in range(SEEDS):
        noise = 0.002 * draw.draw(np.random.default_rng([seed, 3]))
        errors.append(noise.mean())
        ours.append(constant_alone(noise)["Cm_0"].standard_error)
        theirs.append(constants.by_autocorrelation(one, noise - noise.mean())[0])
    true = np.std(errors)
    return np.median(ours) / true, np.median(theirs) / true


@pytest.mark.parametrize("kind", constants.KINDS[:2], ids=lambda kind: kind.name)
def test_the_residuals_own_autocorrelation_is_a_third_of_a_constants_variance(
    kind: constants.Kind,
) -> None:
    """2 E(integral of a Brownian bridge's square) = 1/3, whatever the noise, if it forgets."""
    ours, theirs = errors_over_truth(kind)
    assert theirs == pytest.approx(np.sqrt(1 / 3), rel=0.3)
    assert ours == pytest.approx(1.0, rel=0.3)


def test_of_what_swings_both_say_the_same() -> None:
    """Within a factor of 1.5, where the record spans ninety correlation times."""
    kind = constants.KINDS[1]
    for seed in range(20):
        record = constants.measure(kind, seed)
        ratio = record.theirs[1:] / record.ours[1:]
        assert np.all((ratio > 1 / 1.5) & (ratio < 1.5)), seed
        assert not record.is_lower_bound


def test_a_record_that_is_too_short_says_so() -> None:
    """A drift of 5 s in 20 s."""
    kind = constants.KINDS[4]
    said = [constants.measure(kind, seed).is_lower_bound for seed in range(20)]
    assert sum(said) >= 14
