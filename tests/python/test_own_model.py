# SPDX-License-Identifier: BSD-3-Clause
"""Models written in Python: the same engine as sepcal's own, their tables, and memory."""

# ruff: noqa: RUF012

import gc
import weakref
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.optimize import least_squares

import sepcal
from oracle.cases import CASE_NAMES, state_case
from own_models import BOX, BUILT_IN, Twin, WindBox, simulate_wind_box

# --- the same engine


@pytest.mark.parametrize("second_stage", ["joint", "projected"])
@pytest.mark.parametrize("name", CASE_NAMES)
def test_a_twin_in_python_is_the_model_in_cpp(name: str, second_stage: str) -> None:
    """Estimates to 1e-9 standard errors, R estimated; D by differences against dual numbers."""
    case = state_case(name)
    options = {"bounds": case.bounds, "second_stage": second_stage, "samples": 50}
    compiled = sepcal.fit(BUILT_IN[name], case.record, **options)
    twin = sepcal.fit(Twin(case), case.record, **options)
    assert type(twin) is sepcal.Fit
    assert (
        (twin.status, twin.second_stage)
        == (compiled.status, second_stage)
        == ("converged", second_stage)
    )
    assert twin.names == compiled.names
    errors = np.sqrt(np.diag(compiled.covariance))
    assert_allclose(twin.values / errors, compiled.values / errors, rtol=0, atol=1e-9)
    assert_allclose(np.sqrt(np.diag(twin.covariance)), errors, rtol=1e-9)
    assert twin.cost == pytest.approx(compiled.cost, rel=1e-12)
    assert twin.noise == pytest.approx(compiled.noise, rel=1e-12)
    assert_allclose(twin.stage_one.samples, compiled.stage_one.samples, rtol=0)
    assert_allclose(twin.stage_one.trace_r, compiled.stage_one.trace_r, rtol=1e-9)
    assert [twin[one].unit for one in twin.names] == [compiled[one].unit for one in twin.names]


@pytest.mark.parametrize("second_stage", ["joint", "projected"])
def test_scipy_finds_the_same(second_stage: str) -> None:
    fit = sepcal.fit(WindBox(), BOX, noise={"vn": 0.3, "ve": 0.3}, second_stage=second_stage)

    def residual(xi: np.ndarray) -> np.ndarray:
        k, w_n, w_e, delta = xi
        vn = k * BOX["v"] * np.cos(BOX["psi"] + delta) + w_n
        ve = k * BOX["v"] * np.sin(BOX["psi"] + delta) + w_e
        return np.concatenate([BOX["vn"] - vn, BOX["ve"] - ve]) / 0.3

    tight = {"ftol": 1e-15, "xtol": 1e-15, "gtol": 1e-15}
    found = least_squares(residual, [1.0, 0.0, 0.0, 0.0], jac="3-point", **tight)
    errors = np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac)))
    assert fit.status == "converged"
    assert_allclose(fit.values / errors, found.x / errors, rtol=0, atol=1e-5)  # SciPy's own stop
    white = [fit[name].standard_error_white for name in fit.names]
    assert_allclose(white, errors, rtol=1e-6)


def test_threads_do_not_change_a_bit() -> None:
    record = simulate_wind_box(9000)
    one, two = (sepcal.fit(WindBox(), record, samples=60, threads=n) for n in (1, 2))
    assert_array_equal(one.values, two.values)
    assert_array_equal(one.covariance, two.covariance)
    assert_array_equal(one.stage_one.trace_r, two.stage_one.trace_r)


def test_options_and_segments_are_those_of_every_model() -> None:
    labels = ["first"] * 300 + ["second"] * 300
    half = {name: values[:300] for name, values in BOX.items()}
    whole = sepcal.fit(
        WindBox(),
        {**BOX, "maneuver": labels},
        stage_one_segments="first",
        stage_two_segments="first",
    )
    assert_array_equal(whole.values, sepcal.fit(WindBox(), half).values)
    held = sepcal.fit(WindBox(), BOX, fix={"delta": 0.06, "w_n": -3.8}, samples=0)
    assert held["delta"].fixed
    assert (held["delta"].value, held["w_n"].value) == (0.06, -3.8)
    assert abs(held["k"].value - 1.05) < 5 * held["k"].standard_error


def test_no_nonlinear_parameter() -> None:
    class Line:
        inputs = {"x": "1"}
        outputs = {"z": "1"}
        linear = {"slope": "1", "offset": "1"}
        nonlinear = {}

        def at(self, u, xi2):
            assert xi2.shape == (0,)
            return np.stack([u.x, np.ones_like(u.x)], axis=-1)[:, np.newaxis], 0 * u.x[
                :, np.newaxis
            ]

    x = np.linspace(0, 1, 40)
    z = 2 * x + 3 + 0.1 * np.random.default_rng(0).standard_normal(40)
    fit = sepcal.fit(Line(), {"x": x, "z": z})
    assert fit.status == "converged"
    assert_allclose(fit.values, np.polyfit(x, z, 1), rtol=1e-12)


@pytest.mark.parametrize("second_stage", ["joint", "projected"])
def test_no_linear_parameter(second_stage: str) -> None:
    class Decay:
        inputs = {"t": "s"}
        outputs = {"z": "1"}
        linear = {}
        nonlinear = {"rate": ("1/s", 0.0, 5.0)}

        def at(self, u, xi2):
            return np.zeros((len(u.t), 1, 0)), np.exp(-xi2[0] * u.t)[:, np.newaxis]

    t = np.linspace(0, 2, 50)
    z = np.exp(-1.3 * t) + 0.01 * np.random.default_rng(0).standard_normal(50)
    fit = sepcal.fit(Decay(), {"t": t, "z": z}, second_stage=second_stage)
    found = least_squares(
        lambda x: z - np.exp(-x * t),
        [1.0],
        jac=lambda x: (t * np.exp(-x * t))[:, np.newaxis],
        ftol=1e-15,
        xtol=1e-15,
        gtol=1e-15,
    )
    assert fit.status == "converged"
    assert_allclose(fit.values, found.x, rtol=1e-8)


# --- tables


def test_tables_as_lists_and_open_bounds() -> None:
    class Listed(WindBox):
        inputs = [("v", "m/s"), ("psi", "rad")]
        outputs = (("vn", "m/s"), ("ve", "m/s"))
        linear = [("k", "1", None, 1.2), ("w_n", "m/s"), ("w_e", "m/s")]
        nonlinear = [("delta", "rad", -0.5, 0.5)]

    model = sepcal.OwnModel(Listed())
    assert model.inputs == ("v", "psi")
    assert model.parameters == ("k", "w_n", "w_e", "delta")
    assert model.units["psi"] == "rad"
    assert model.bounds["k"] == (-np.inf, 1.2)
    assert model.bounds["w_n"] == (-np.inf, np.inf)
    assert model.bounds["delta"] == (-0.5, 0.5)
    assert_array_equal(sepcal.fit(model, BOX).values, sepcal.fit(WindBox(), BOX).values)


def test_columns_by_place_and_by_name() -> None:
    seen = []

    class Named(WindBox):
        inputs = {"air speed": "m/s", "psi": "rad"}

        def at(self, u, xi2):
            v, psi = u
            assert psi is u.psi is u[1]
            seen.append(v)
            return super().at(sepcal_columns(v, psi), xi2)

    def sepcal_columns(v, psi):
        return type("U", (), {"v": v, "psi": psi})

    record = {"air speed" if name == "v" else name: values for name, values in BOX.items()}
    assert_array_equal(sepcal.fit(Named(), record).values, sepcal.fit(WindBox(), BOX).values)
    gc.collect()
    assert all(np.isin(column, BOX["v"]).all() for column in seen)  # its own memory, still there


# --- memory


def test_a_fit_lets_its_model_go() -> None:
    model = WindBox()
    alive = weakref.ref(model)
    fit = sepcal.fit(model, BOX, samples=8)
    del model
    gc.collect()
    assert alive() is None
    assert fit.status == "converged"


def test_what_at_changes_is_its_own() -> None:
    class Careless(WindBox):
        def at(self, u, xi2):
            answer = super().at(u, xi2)
            u.v[:] = 0.0
            xi2[:] = 0.0
            return answer

    before = BOX["v"].copy()
    assert_array_equal(sepcal.fit(Careless(), BOX).values, sepcal.fit(WindBox(), BOX).values)
    assert_array_equal(BOX["v"], before)


def test_an_own_model_tells_what_it_is() -> None:
    assert repr(sepcal.OwnModel(WindBox())).startswith("OwnModel(<")
    assert isinstance(sepcal.OwnModel(WindBox()), sepcal.Model)


class NearlyAlike:
    """Two columns that differ by `part` of one."""

    inputs = {"x": "1"}
    outputs = {"z": "1"}
    linear = {"a": "1", "b": "1", "c": "1"}
    nonlinear = {"k": ("1", -2.0, 2.0)}

    def __init__(self, part: float) -> None:
        self.part = part

    def at(self, u: Any, xi2: Any) -> tuple[np.ndarray, np.ndarray]:
        """A (N, 1, 3) and b (N, 1)."""
        A = np.zeros((len(u.x), 1, 3))
        A[:, 0] = np.column_stack([np.ones_like(u.x), u.x, u.x + self.part * np.sin(3 * u.x)])
        return A, np.sin(xi2[0] * u.x)[:, None]


@pytest.mark.parametrize("part", [1e-4, 1e-6, 3.6e-8])
def test_columns_nearly_alike_are_told_apart(part: float) -> None:
    """A condition of up to 1e8 costs no more digits than the singular values say."""
    x = np.linspace(-1.0, 1.0, 2000)
    model = NearlyAlike(part)
    A = model.at(type("Inputs", (), {"x": x}), [0.8])[0][:, 0]
    z = A @ [1.0, 2.0, 3.0] + np.sin(0.8 * x)
    fit = sepcal.fit(model, {"x": x, "z": z}, fix={"k": 0.8}, noise={"z": 1e-10})
    assert fit.status == "converged"
    expected = np.linalg.lstsq(A, z - np.sin(0.8 * x), rcond=None)[0]
    found = [fit[name].value for name in "abc"]
    assert found == pytest.approx(expected, rel=1e-6)
