# SPDX-License-Identifier: BSD-3-Clause
"""What is calibrated against an independent sensor's column, again in NumPy and SciPy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.linalg import toeplitz
from scipy.signal import lfilter

import sepcal
from apps import Bench
from refusals import refuse

Array = NDArray[np.float64]
KNOT = 1852 / 3600  # [m/s]
RHO = 0.9  # of the difference from row to row
SIZE = 0.4  # of the difference [m/s]
SCALE, OFFSET = 1.04, -1.5  # of calibrated = OFFSET + SCALE * reference


def coloured(rows: int, seed: int) -> Array:
    """A stationary autoregression of first order."""
    w = np.random.default_rng(seed).standard_normal(rows)
    w[1:] *= np.sqrt(1 - RHO**2)
    return np.asarray(SIZE * lfilter([1.0], [1.0, -RHO], w))


def with_column(flight: sepcal.Flight, **columns: Array) -> sepcal.Flight:
    return sepcal.Flight({**dict(flight.items()), **columns})


@pytest.fixture(scope="module")
def tube() -> sepcal.Calibration:
    flight = sepcal.simulate("pitot-static", rows=1500, seed=3)
    return sepcal.fit(sepcal.PitotStatic(), flight, samples=50)


@pytest.fixture(scope="module")
def calibrated(tube: sepcal.Calibration) -> Array:
    assert tube.flight is not None
    return tube.apply(tube.flight)["airspeed_cal_mps"]


def reference_of(calibrated: Array, seed: int = 1) -> Array:
    return (calibrated - coloured(calibrated.size, seed) - OFFSET) / SCALE


def test_numbers_are_numpys(tube: sepcal.Calibration, calibrated: Array) -> None:
    reference = reference_of(calibrated)
    flight = with_column(tube.flight, airspeed_2_kt=reference / KNOT)
    found = tube.compare(flight, reference="airspeed_2_kt").references[0]
    assert (found.quantity, found.unit, found.calibrated, found.reference) == (
        "airspeed", "m/s", "airspeed_cal_mps", "airspeed_2_kt",
    )  # fmt: skip
    difference = calibrated - reference
    assert found.rows == difference.size
    assert_allclose(found.time, flight["time_s"])
    assert_allclose(found.difference, difference, atol=1e-9)
    assert_allclose(found.against, reference, rtol=1e-12)
    slope, constant = np.polyfit(reference, calibrated, 1)
    about = difference - difference.mean()
    expected = {
        "bias": difference.mean(),
        "rms": np.sqrt(np.mean(difference**2)),
        "sd": difference.std(),
        "scale": slope,
        "offset": constant,
        "scale_reversed": 1 / np.polyfit(calibrated, reference, 1)[0],
        "lag_one": np.sum(about[1:] * about[:-1]) / np.sum(about**2),
    }
    for name, value in expected.items():
        assert_allclose(getattr(found, name), value, rtol=1e-7, err_msg=name)


def test_errors_are_those_of_least_squares_in_that_colour(
    tube: sepcal.Calibration, calibrated: Array
) -> None:
    """The sandwich with the covariance that the noise was drawn from, far from white."""
    found = []
    for seed in range(8):
        flight = with_column(tube.flight, airspeed_2_mps=reference_of(calibrated, seed))
        found.append(tube.compare(flight, reference=["airspeed_2_mps"]).references[0])
    reference = (calibrated - OFFSET) / SCALE
    X = np.column_stack([np.ones_like(reference), reference])
    sigma = SIZE**2 * toeplitz(RHO ** np.arange(reference.size))
    inverse = np.linalg.inv(X.T @ X)
    offset_error, scale_error = np.sqrt(np.diag(inverse @ X.T @ sigma @ X @ inverse))
    white = SIZE * np.sqrt(inverse[1, 1])
    assert scale_error > 2.5 * white
    assert_allclose(np.mean([one.scale_error for one in found]), scale_error, rtol=0.2)
    assert_allclose(np.mean([one.offset_error for one in found]), offset_error, rtol=0.2)
    off = [(one.scale - SCALE) / one.scale_error for one in found]
    assert np.max(np.abs(off)) < 3.5


def test_error_of_the_mean_is_that_of_its_colour(
    tube: sepcal.Calibration, calibrated: Array
) -> None:
    reference = calibrated - coloured(calibrated.size, 5)
    flight = with_column(tube.flight, airspeed_2_mps=reference)
    found = tube.compare(flight, reference="airspeed_2_mps").references[0]
    n = calibrated.size
    sigma = toeplitz(SIZE**2 * RHO ** np.arange(n))
    assert_allclose(found.bias_error, np.sqrt(sigma.sum()) / n, rtol=0.3)
    assert abs(found.bias) < 3 * found.bias_error


def test_rows_without_a_reading_take_no_part(tube: sepcal.Calibration, calibrated: Array) -> None:
    """A slow sensor: a number in every fifth row."""
    reference = reference_of(calibrated)
    reference[np.arange(reference.size) % 5 != 0] = np.nan
    flight = with_column(tube.flight, tas_backup_mps=reference)
    found = tube.compare(flight, reference="tas_backup_mps").references[0]
    difference = (calibrated - reference)[::5]
    assert found.rows == difference.size
    assert_allclose(found.difference, difference, atol=1e-9)
    assert_allclose(found.bias, difference.mean(), rtol=1e-9)


def test_name_that_says_nothing_is_told(tube: sepcal.Calibration, calibrated: Array) -> None:
    flight = with_column(tube.flight, **{"ADC 2": reference_of(calibrated) / KNOT})
    refuse(
        lambda: tube.compare(flight, reference="ADC 2"),
        "reference 'ADC 2' is in no unit of what is calibrated",
        "airspeed_mps=ADC 2",
    )
    found = tube.compare(flight, reference="airspeed_kt=ADC 2").references[0]
    assert_allclose(found.difference, calibrated - reference_of(calibrated), atol=1e-9)
    refuse(
        lambda: tube.compare(flight, reference="airspeed_2_mps"),
        "there is no column 'airspeed_2_mps' to compare with",
    )
    empty = with_column(tube.flight, airspeed_2_mps=np.full(calibrated.size, np.nan))
    refuse(
        lambda: tube.compare(empty, reference="airspeed_2_mps"),
        "reference 'airspeed_2_mps' has a number in 0 of the",
    )


def test_angles_are_compared_within_a_turn() -> None:
    """Of a five-hole probe, whose angles a name must tell apart."""
    probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5)
    flight = sepcal.simulate(probe, rows=600, seed=2)
    fit = sepcal.fit(probe, flight, samples=50)
    made = fit.apply(flight)
    alpha = np.degrees(made["alpha_cal_rad"]) - 0.5
    alpha[::2] += 360
    logged = with_column(flight, vane_deg=alpha, aoa_left_deg=alpha, ss_deg=alpha)
    refuse(lambda: fit.compare(logged, reference="vane_deg"), "may be of several quantities")
    for name in ("alpha_deg=vane_deg", "aoa_left_deg"):
        found = fit.compare(logged, reference=name).references[0]
        assert found.quantity == "alpha"
        assert_allclose(found.difference, np.radians(0.5), atol=1e-9)


def test_magnetometer_against_another_and_against_a_strength() -> None:
    field = (19.7, -1.4, 49.4)
    flight = sepcal.simulate("magnetometer", rows=600, seed=4)
    fit = sepcal.fit(sepcal.Magnetometer(field), flight, samples=0)
    made = fit.apply(flight)
    strength = np.sqrt(sum(made[f"{axis}_cal_ut"] ** 2 for axis in ("mx", "my", "mz")))
    logged = with_column(
        flight, proton_field_nt=1000 * (strength - 0.25), mx_2_ut=made["mx_cal_ut"] - 1
    )
    total, axis = fit.compare(logged, reference=["proton_field_nt", "mx_2_ut"]).references
    assert (total.quantity, total.calibrated, axis.quantity) == ("field", "field_cal_ut", "mx")
    assert_allclose(total.difference, 0.25, atol=1e-8)
    assert_allclose([axis.bias, axis.sd, axis.scale], [1, 0, 1], atol=1e-8)


def test_flight_path_against_another_vane() -> None:
    flight = sepcal.datasets.load("aircraft")
    path = sepcal.fit(sepcal.FlightPath(), flight)
    vane = flight["alpha_rad"] - np.radians(0.5)
    logged = with_column(flight, alpha_2_deg=np.degrees(vane))
    made = path.apply(logged)  # from initial states of its own
    found = path.compare(logged, reference="alpha_2_deg").references[0]
    assert found.calibrated == "alpha_cal_rad"
    assert_allclose(found.difference, made["alpha_cal_rad"] - vane, atol=1e-9)


def test_app_writes_the_same(pitot: Bench, tmp_path: Path) -> None:
    applied = pitot.run("apply", "flight.csv", "base.json", "-o", "applied.csv")
    assert applied.code == 0, applied.err
    flight = sepcal.read_csv(pitot.folder / "applied.csv")
    calibrated = flight["airspeed_cal_mps"]
    columns = dict(flight.items())
    columns["TAS 2 [kt]"] = (calibrated - 0.5) / KNOT
    for name in ("airspeed_cal_mps", "alpha_cal_rad", "beta_cal_rad"):
        del columns[name]
    text = ",".join(columns) + "\n"
    text += "\n".join(
        ",".join(map(repr, map(float, row))) for row in zip(*columns.values(), strict=True)
    )
    (pitot.folder / "two.csv").write_text(text + "\n")
    asked = ("compare", "two.csv", "base.json", "--reference", "TAS 2 [kt]")
    told = pitot.run(*asked, "--json").result["references"][0]
    assert told["reference"] == "TAS 2 [kt]"
    assert_allclose(told["difference"], 0.5, atol=1e-6)
    assert len(told["time_s"]) == told["rows"]
    page = pitot.run(*asked)
    assert page.code == 0
    assert "airspeed_cal_mps against TAS 2 [kt]" in page.out
    refused = pitot.run("compare", "two.csv", "base.json", "--reference", "nonsense")
    assert refused.code == 2
    assert "there is no column 'nonsense' to compare with" in refused.err


def test_difference_is_drawn(tube: sepcal.Calibration, calibrated: Array) -> None:
    flight = with_column(tube.flight, airspeed_2_mps=reference_of(calibrated))
    compared = tube.compare(flight, reference="airspeed_2_mps")
    drawn = compared.plot("references")
    assert "airspeed_2_mps" in drawn.to_json()
    refuse(lambda: tube.compare().plot("references"), 'compare(reference="COLUMN")')
