# SPDX-License-Identifier: BSD-3-Clause
"""Multisines and 3-2-1-1: what numpy.fft says of them."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import apps
import sepcal
from refusals import refuse

Array = NDArray[np.float64]
SIZES = {"elevator_rad": 0.05, "aileron_rad": 0.08, "rudder_rad": 0.1}


def peak_factor(values: Array) -> float:
    return float(np.ptp(values) / (2 * np.sqrt(2) * np.sqrt(np.mean(values**2))))


def test_multisines_are_orthogonal_and_of_their_band() -> None:
    made = sepcal.multisines(SIZES, band=(0.1, 2.0), duration=20.0, rate=100.0)
    assert made.time[0] == 0.0
    assert made.time[-1] == 20.0
    columns = np.column_stack([made.signals[name] for name in SIZES])
    assert np.all(columns[[0, -1]] == 0.0)
    assert_allclose(np.abs(columns).max(axis=0), list(SIZES.values()), rtol=2e-3)
    period = columns[:-1]
    correlation = np.corrcoef(period.T) - np.eye(3)
    assert np.abs(correlation).max() < 1e-12
    # Harmonics 2 to 40, dealt in turn, all of one power.
    power = np.abs(np.fft.rfft(period, axis=0)) ** 2
    for i, name in enumerate(SIZES):
        own = np.arange(2 + i, 41, 3)
        assert_allclose(made.frequencies[name], own / 20.0)
        assert_allclose(power[own, i], power[own[0], i], rtol=1e-9)
        assert np.delete(power[:, i], own).max() < 1e-18 * power[own[0], i]
        assert made.peak_factors[name] == pytest.approx(peak_factor(period[:, i]), rel=5e-3)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_peaks_are_lower_than_schroeders(count: int) -> None:
    sizes = dict(list(SIZES.items())[:count])
    best = sepcal.multisines(sizes)
    plain = sepcal.multisines(sizes, optimised=False)
    for name in sizes:
        assert best.peak_factors[name] < min(1.13, plain.peak_factors[name] - 0.05)


def test_schroeders_phases_are_schroeders() -> None:
    """His formula of a level spectrum, but for the shift to where the sum rises through zero."""
    made = sepcal.multisines({"elevator_rad": 1.0}, optimised=False, rate=400.0)
    k = np.arange(2, 41)
    m = np.arange(1, len(k) + 1)
    t = np.linspace(0.0, 1.0, 200001)[:-1]
    u = np.sin(2 * np.pi * np.outer(t, k) - np.pi * m * (m - 1) / len(k)).sum(axis=1)
    assert made.peak_factors["elevator_rad"] == pytest.approx(peak_factor(u), rel=2e-3)


def relative_peak_factor(harmonics: Array, phases: Array) -> float:
    """Of sines of one power, by 64 points a period of the highest."""
    t = np.arange(64 * int(harmonics[-1])) / (64 * harmonics[-1])
    return peak_factor(np.sin(2 * np.pi * np.outer(t, harmonics) + phases).sum(axis=1))


def newman(count: int) -> Array:
    """D. J. Newman's phases pi (m - 1)^2 / n (S. Boyd, IEEE Trans. Circuits Syst. 33, 1986)."""
    return np.asarray(np.pi * np.arange(count) ** 2 / count)


def schroeder(count: int) -> Array:
    """-pi m (m - 1) / n (M. R. Schroeder, IEEE Trans. Inf. Theory 16, 1970) of a level spectrum."""
    m = np.arange(1, count + 1)
    return np.asarray(-np.pi * m * (m - 1) / count)


@pytest.mark.parametrize("count", [8, 16, 31])
def test_peaks_lie_below_published_formulas(count: int) -> None:
    made = sepcal.multisines({"u": 1.0}, band=(0.1, 0.1 * count), duration=10.0, rate=100.0)
    harmonics = np.arange(1, count + 1)
    assert_allclose(made.frequencies["u"], harmonics / 10.0)
    published = [relative_peak_factor(harmonics, way(count)) for way in (schroeder, newman)]
    assert min(published) > 1.15
    assert made.peak_factors["u"] < min(published) - 0.1


def test_peaks_of_three_interleaved_inputs_lie_below_published_formulas() -> None:
    made = sepcal.multisines(SIZES, band=(0.1, 2.0), duration=20.0)
    for name in SIZES:
        harmonics = np.round(made.frequencies[name] * 20.0)
        assert len(harmonics) == 13
        published = [relative_peak_factor(harmonics, way(13)) for way in (schroeder, newman)]
        assert made.peak_factors[name] < min(published) - 0.1
        assert made.peak_factors[name] < 1.13


def test_steps_put_most_of_their_energy_into_the_band() -> None:
    made = sepcal.three_two_one_one({"elevator_rad": 0.05}, band=(0.3, 0.9), rate=100.0)
    u = made.signals["elevator_rad"]
    assert u[0] == u[-1] == 0.0
    ones = round(made.step * 100)
    expected = np.repeat([0.05, -0.05, 0.05, -0.05], np.array([3, 2, 1, 1]) * ones)
    assert_allclose(u[100 : 100 + 7 * ones], expected)
    assert not np.any(u[100 + 7 * ones :])

    def share(step: float) -> float:
        rows = round(step * 1000)
        steps = np.repeat([1.0, -1.0, 1.0, -1.0], np.array([3, 2, 1, 1]) * rows)
        power = np.abs(np.fft.rfft(steps, 1 << 18)) ** 2
        f = np.fft.rfftfreq(1 << 18, 1e-3)
        return float(power[(f >= 0.3) & (f <= 0.9)].sum() / power.sum())

    assert made.share_in_band == pytest.approx(share(made.step), abs=2e-3)
    shares = [share(step) for step in np.arange(0.1, 3.0, 0.05)]
    assert made.share_in_band > max(shares) - 2e-3


def test_the_program_writes_them(tmp_path: Path) -> None:
    def run(*arguments: str) -> apps.Outcome:
        return apps.run("sepcal-aircraft", "design", *arguments, folder=tmp_path)

    two = ("--input", "elevator_rad=0.05", "--input", "aileron_rad=0.08")
    done = run(*two, "--duration", "10", "-o", "u.csv")
    assert done.code == 0, done.err
    assert "relative peak factor" in done.out
    made = sepcal.multisines({"elevator_rad": 0.05, "aileron_rad": 0.08}, duration=10.0)
    table = apps.Log(tmp_path / "u.csv")
    assert_allclose(table.column("time_s"), made.time)
    assert_allclose(table.column("aileron_rad"), made.signals["aileron_rad"], atol=1e-15)
    made.save(tmp_path / "same.csv")
    assert (tmp_path / "same.csv").read_text() == (tmp_path / "u.csv").read_text()
    steps = run("--signal", "3-2-1-1", "--input", "elevator_rad=0.05", "-o", "s.csv", "--json")
    assert steps.code == 0
    assert steps.result["inputs"]["elevator_rad"]["step"] == pytest.approx(
        sepcal.three_two_one_one({"elevator_rad": 0.05}).step
    )
    for wrong, word in (
        (("--signal", "sweep", *two), "choose multisine or 3-2-1-1"),
        (("--signal", "3-2-1-1", *two), "of one input"),
        (("--input", "elevator_rad"), "COLUMN=SIZE"),
        (("--input", "time_s=1"), "would stand twice"),
    ):
        refused = run(*wrong, "-o", "no.csv")
        assert refused.code == 2
        assert word in refused.err
        assert not (tmp_path / "no.csv").exists()


def test_what_can_not_be_flown_is_refused() -> None:
    refuse(lambda: sepcal.multisines({}), "no input is named")
    refuse(lambda: sepcal.multisines({"elevator_rad": -1.0}), "an amplitude of -1 is none")
    refuse(lambda: sepcal.multisines(SIZES, rate=5.0), "5 rows a second are too few for 2 Hz")
    refuse(lambda: sepcal.multisines(SIZES, duration=1.0), "need two each")
    refuse(lambda: sepcal.multisines(SIZES, duration=1e6), "at most 200000 rows")
    refuse(lambda: sepcal.three_two_one_one({"elevator_rad": 0.1}, after=-1.0), "0 or more")
