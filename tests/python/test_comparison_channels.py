# SPDX-License-Identifier: BSD-3-Clause
"""compare against every channel and by window: every number again in NumPy and SciPy."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

import sepcal
from apps import Bench

Array = NDArray[np.float64]

PROBE = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
ROWS = 2000
#: The record's names of what the log holds under others, by header.
NAMES = {
    "time_s": "time", "roll_rad": "roll", "pitch_rad": "pitch", "yaw_rad": "yaw", "p_radps": "p",
    "q_radps": "q", "r_radps": "r", "pt_pa": "pt", "ps_pa": "ps", "dpa_pa": "dpa", "dpb_pa": "dpb",
    "rho_kgpm3": "rho",
}  # fmt: skip


@pytest.fixture(scope="module")
def flight() -> sepcal.SimulatedFlight:
    return sepcal.simulate(PROBE, rows=ROWS, seed=5, hide={"wind[altitude_m]": (0.3, 0.1)})


@pytest.fixture(scope="module")
def comparison(flight: sepcal.SimulatedFlight) -> sepcal.Comparison:
    return sepcal.fit(PROBE, flight, samples=50).compare()


def smooth_share(x: Array, r: Array) -> float:
    """R^2 of the natural spline with six even knots, by least squares on cardinal splines."""
    knots = np.linspace(x.min(), x.max(), 6)
    basis = CubicSpline(knots, np.eye(6), bc_type="natural")(x)
    fitted = basis @ np.linalg.lstsq(basis, r, rcond=None)[0]
    return float(1 - np.sum((r - fitted) ** 2) / np.sum((r - r.mean()) ** 2))


def test_every_varying_channel_is_there_once_an_output(
    comparison: sepcal.Comparison, flight: sepcal.SimulatedFlight
) -> None:
    logged = {
        NAMES.get(header, header)
        for header, values in flight.items()
        if np.ptp(values) > 0 and header not in ("vn_mps", "ve_mps", "vd_mps")
    }
    found = [(channel.driver, channel.output) for channel in comparison.channels]
    assert len(found) == len(set(found)) == 3 * len({driver for driver, _ in found})
    drivers = {driver for driver, _ in found}
    assert drivers >= logged
    assert drivers - logged <= {"alpha", "beta", "rho", "temperature"}
    shares = [channel.share_smooth for channel in comparison.channels]
    assert shares == sorted(shares, reverse=True)


def test_shares_and_slopes(comparison: sepcal.Comparison, flight: sepcal.SimulatedFlight) -> None:
    by_name = {NAMES.get(header, header): values for header, values in flight.items()}
    compared = 0
    for channel in comparison.channels:
        if channel.driver not in by_name:
            continue
        x = by_name[channel.driver]
        r = comparison.residuals[:, PROBE.outputs.index(channel.output)]
        assert channel.share_line == pytest.approx(np.corrcoef(x, r)[0, 1] ** 2, abs=1e-9)
        slope = np.cov(x, r)[0, 1] / np.var(x, ddof=1)
        assert channel.slope == pytest.approx(slope, rel=1e-6, abs=1e-12)
        assert channel.share_smooth == pytest.approx(smooth_share(x, r), abs=1e-6)
        assert channel.slope_error > 0
        compared += 1
    assert compared > 30


def test_the_hidden_driver_comes_first(comparison: sepcal.Comparison) -> None:
    """By a straight line, beside the air's own quantities, which follow the altitude."""
    altitude = next(at for at in comparison.channels if at.driver == "altitude_m")
    assert altitude.output == "vn"
    assert altitude.share_line > 0.8
    best = max(channel.share_line for channel in comparison.channels)
    assert altitude.share_line == pytest.approx(best, rel=0.02)
    assert altitude.unit == "m/s per m"
    assert altitude.slope == pytest.approx(0.3, rel=0.3)  # the parameters took their share
    assert abs(altitude.slope) > 2 * altitude.slope_error
    rows = [line.split() for line in str(comparison).splitlines()]
    (row,) = [row for row in rows if row[:2] == ["altitude_m", "vn"]]
    assert float(row[2]) == pytest.approx(100 * altitude.share_line, abs=0.06)


def test_worst_windows(comparison: sepcal.Comparison) -> None:
    """Twenty windows of 100 rows; the noise of a fit with R estimated is its RMSE."""
    r = comparison.residuals.reshape(20, 100, 3)
    noise = np.sqrt(np.mean(comparison.residuals**2, axis=0))
    order = np.argsort(-np.mean((r / noise) ** 2, axis=(1, 2)))[:5]
    assert len(comparison.windows) == 5
    for window, i in zip(comparison.windows, order, strict=True):
        time = comparison.time[100 * i : 100 * (i + 1)]
        assert (window.first_s, window.last_s, window.rows) == (time[0], time[-1], 100)
        for j, output in enumerate(PROBE.outputs):
            assert window.rmse[output] == pytest.approx(np.sqrt(np.mean(r[i, :, j] ** 2)))
            assert window.mean[output] == pytest.approx(np.mean(r[i, :, j]), abs=1e-12)
        span = f"{window.first_s:.6g}:{window.last_s:.6g}"
        assert any(line.startswith(span) for line in str(comparison).splitlines())


def test_the_json_says_the_same(comparison: sepcal.Comparison) -> None:
    root = comparison.to_dict()
    assert root["channels"] == [channel._asdict() for channel in comparison.channels]
    assert root["windows"] == [window._asdict() for window in comparison.windows]


def test_the_app_says_the_same(bench: Bench) -> None:
    said = bench.run("compare", "flight.csv", "base.json", "--json").result
    calibration = sepcal.load(bench.folder / "base.json")
    root = calibration.compare(sepcal.read_csv(bench.flight)).to_dict()
    assert said["channels"] == root["channels"]
    assert said["windows"] == root["windows"]
    shown = bench.run("compare", "flight.csv", "base.json").out
    assert "worst windows [s]" in shown
    for window in root["windows"]:
        assert f"\n{window['first_s']:.6g}:{window['last_s']:.6g} " in shown
