# SPDX-License-Identifier: BSD-3-Clause
"""R^2 and Theil's inequality coefficient of a comparison, again in NumPy."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal


def root_mean_square(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(x))))


@pytest.fixture(scope="module")
def path() -> sepcal.AircraftFit:
    return sepcal.fit(sepcal.FlightPath(), sepcal.datasets.load("aircraft"))


@pytest.fixture(scope="module")
def tube() -> sepcal.Calibration:
    return sepcal.fit(sepcal.PitotStatic(), sepcal.datasets.load("pitot"))


@pytest.mark.parametrize("subject", ["path", "tube"])
def test_figures_are_numpys(subject: str, request: pytest.FixtureRequest) -> None:
    fit: sepcal.AircraftFit | sepcal.Calibration = request.getfixturevalue(subject)
    compared = fit.compare()
    assert [one.output for one in compared.validation] == [one.output for one in compared.overall]
    for j, told in enumerate(compared.validation):
        y = compared.modelled[:, j]
        z = y + compared.residuals[:, j]
        square = np.mean((z - y) ** 2)
        assert_allclose(told.r_squared, 1 - square / np.var(z), rtol=1e-9)
        theil = root_mean_square(z - y) / (root_mean_square(z) + root_mean_square(y))
        assert_allclose(told.theil, theil, rtol=1e-9)
        parts = (
            (z.mean() - y.mean()) ** 2,
            (z.std() - y.std()) ** 2,
            2 * (1 - np.corrcoef(z, y)[0, 1]) * z.std() * y.std(),
        )
        found = (told.theil_bias, told.theil_variance, told.theil_covariance)
        assert_allclose(found, np.array(parts) / square, atol=1e-9)
        assert_allclose(sum(found), 1, rtol=1e-9)
        assert compared.to_dict()["validation"][told.output]["theil"] == told.theil
    assert "Theil U" in compared.text


def test_another_flight_is_followed_less(path: sepcal.AircraftFit) -> None:
    """A vane that is off: the means differ, and R^2 falls."""
    flight = sepcal.datasets.load("aircraft")
    spoilt = sepcal.Flight({**dict(flight.items()), "alpha_rad": flight["alpha_rad"] + 0.05})
    names = [one.output for one in path.compare().overall]
    alpha = names.index("alpha")
    before, after = (one.validation[alpha] for one in (path.compare(), path.compare(spoilt)))
    assert after.r_squared < before.r_squared
    assert after.theil_bias > before.theil_bias


def test_output_that_does_not_move_has_none() -> None:
    """The difference to a field's strength is zero by construction."""
    flight = sepcal.simulate("magnetometer-norm", rows=300, seed=1)
    fit = sepcal.fit(sepcal.Magnetometer(field_strength=53.2), flight, samples=0)
    told = fit.compare().validation[0]
    assert np.isnan(told.r_squared)
    assert np.isnan(told.theil)
