# SPDX-License-Identifier: BSD-3-Clause
"""Stage one's cost over the nonlinear parameters, against NumPy's least squares at each point."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal
from oracle.pitot_static import PitotStatic
from oracle.residual_sampling import estimate_linear
from refusals import refuse
from sepcal import _core
from sepcal.reporting.figures_cost import find_least

BOUNDS = {"w_n": (-20.0, 20.0), "w_e": (-15.0, 15.0), "w_d": (-3.0, 3.0)}


@pytest.fixture(scope="module")
def flight() -> sepcal.SimulatedFlight:
    return sepcal.simulate("pitot-static", rows=300, seed=2)


def fit_with(flight: sepcal.SimulatedFlight, **held: float) -> sepcal.Calibration:
    bounds = {name: at for name, at in BOUNDS.items() if name not in held}
    free = [] if "w_d" in held else ["w_d"]  # which a tube holds by itself
    return sepcal.fit(sepcal.PitotStatic(), flight, bounds=bounds, fix=held, free=free, samples=200)


@pytest.mark.parametrize(
    "held", [{"w_e": 2.0, "w_d": 0.0}, {"w_d": 0.0}, {}], ids=["curve", "map", "pairs"]
)
def test_cost_is_that_of_lstsq(flight: sepcal.SimulatedFlight, held: dict[str, float]) -> None:
    fit = fit_with(flight, **held)
    seen = _core.cost_landscape(fit.core, flight._core)
    free = [name for name in BOUNDS if name not in held]
    assert seen.names == free
    assert seen.points.shape == (seen.trace_r.size, len(free))
    for k, name in enumerate(free):
        assert seen.points[:, k].min() >= BOUNDS[name][0]
        assert seen.points[:, k].max() <= BOUNDS[name][1]
        assert np.ptp(seen.points[:, k]) > 0.98 * (BOUNDS[name][1] - BOUNDS[name][0])
    record = {
        "vn": flight["vn_mps"], "ve": flight["ve_mps"], "vd": flight["vd_mps"],
        "airspeed": flight["airspeed_mps"],
    }  # fmt: skip
    some = np.random.default_rng(1).choice(seen.trace_r.size, 25, replace=False)
    for at in some:
        values = dict(zip(free, seen.points[at], strict=True)) | held
        xi2 = np.array([values[name] for name in BOUNDS])
        expected = estimate_linear(PitotStatic(), record, xi2).trace_r
        assert_allclose(seen.trace_r[at], expected, rtol=1e-8)
    assert seen.trace_r.min() >= 0.999 * fit.stage_one.minima[0].trace_r


def test_parameters_of_effects_are_held(flight: sepcal.SimulatedFlight) -> None:
    """The landscape stays that of the probe's own parameters."""
    fit = fit_with(flight).add("time_offset")
    seen = _core.cost_landscape(fit.core, flight._core)
    assert seen.names == list(BOUNDS)


def test_least_of_cells_is_numpys() -> None:
    rng = np.random.default_rng(4)
    x, y, z = rng.uniform(0, 1, 900), rng.uniform(-2, 2, 900), rng.uniform(0, 1, 900)
    across, up, least = find_least(x, y, z, grid=False)
    assert least.shape == (up.size, across.size)
    for (i, j), value in np.ndenumerate(least):
        half_x, half_y = 0.5 * (across[1] - across[0]), 0.5 * (up[1] - up[0])
        inside = (abs(x - across[j]) <= half_x + 1e-12) & (abs(y - up[i]) <= half_y + 1e-12)
        assert_allclose(value, z[inside].min() if inside.any() else np.nan)


@pytest.mark.parametrize(
    ("held", "figures"), [({"w_e": 2.0, "w_d": 0.0}, 1), ({"w_d": 0.0}, 1), ({}, 3)]
)
def test_landscape_is_drawn_and_reported(
    flight: sepcal.SimulatedFlight, held: dict[str, float], figures: int, tmp_path: Path
) -> None:
    fit = fit_with(flight, **held)
    drawn = fit.plot("stage one")
    maps = [trace for trace in drawn.data if trace.type == "heatmap"]
    assert len(maps) == (0 if len(held) == 2 else figures)
    assert fit.fit.plot("stage one", backend="matplotlib") is not None
    fit.report(tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "What stage one saw" in page


def test_nothing_sampled_is_said() -> None:
    eta = np.linspace(-3.0, 3.0, 40)
    data = {"eta": eta, "z": 1.3 * np.cos(eta + 0.2) + 1.0 + 0.01 * np.sin(50.0 * eta)}
    fit = sepcal.fit(sepcal.ScalarExample1(), data, samples=0)
    refuse(lambda: fit.plot("stage one"), "stage one sampled nothing")
    sampled = sepcal.fit(sepcal.ScalarExample1(), data)
    assert len(sampled.plot("stage one").data) >= 1
