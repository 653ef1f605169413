# SPDX-License-Identifier: BSD-3-Clause
"""The estimators that the two-stage one is measured against, beside implementations of their own.

The oracle's are written from the literature, in NumPy and SciPy, and share nothing with these.
"""

from __future__ import annotations

import pickle
from typing import Any, ClassVar

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal
from oracle import alonso_shuster as twostep_oracle
from oracle import haupt_kasdin as two_step_oracle
from oracle.cases import state_case
from oracle.magnetometer import soft_iron
from oracle.single_stage import single_stage
from own_models import BUILT_IN
from sepcal import rivals

Array = np.ndarray

MAGNETOMETER = np.array([0.04, -0.03, 0.02, 0.02, -0.015, 0.01, 12.0, -7.0, 5.0])
STRENGTH = 53.0  # [uT]


def tumble(seed: int, sigma: float, rows: int = 200, spread: float = 0.0) -> dict[str, Array]:
    """Readings all round the sphere [uT]; the field's strength varies by `spread` of it."""
    rng = np.random.default_rng(seed)
    direction = rng.standard_normal((rows, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, np.newaxis]
    strength = STRENGTH * (1.0 + spread * np.sin(np.linspace(0.0, 9.0, rows)))
    C = soft_iron(MAGNETOMETER[3:6]) @ np.diag(1.0 + MAGNETOMETER[:3])
    m = (direction * strength[:, np.newaxis]) @ C.T + MAGNETOMETER[6:]
    m += sigma * rng.standard_normal((rows, 3))
    return {"mx": m[:, 0], "my": m[:, 1], "mz": m[:, 2], "field_change": strength - STRENGTH}


def stacked(record: dict[str, Array]) -> Array:
    return np.stack([record[name] for name in ("mx", "my", "mz")], axis=-1)


# --- the single stage


@pytest.mark.parametrize("name", ["scalar_1", "scalar_2", "five_hole", "magnetometer"])
@pytest.mark.parametrize("solver", ["levenberg_marquardt", "slsqp"])
def test_the_single_stage_ends_where_scipy_ends(name: str, solver: Any) -> None:
    """From a start a tenth off in every parameter, linear ones too."""
    case, model = state_case(name), BUILT_IN[name]
    start = case.truth * (1.0 + 0.1 * np.random.default_rng(3).standard_normal(case.truth.size))
    bounds = np.array([model.bounds[parameter] for parameter in model.parameters])
    expected = single_stage(
        case.model,
        case.record,
        start,
        bounds[:, 0],
        bounds[:, 1],
        None,
        "slsqp" if solver == "slsqp" else "trf",
        tolerance=1e-6,
    )
    data = dict(case.record) | dict(
        zip(model.outputs, case.model.measured(case.record), strict=True)
    )
    fit = rivals.fit_single_stage(
        model,
        data,
        dict(zip(model.parameters, start, strict=True)),
        solver=solver,
        noise_tolerance=1e-6,
    )
    assert fit.converged
    errors = np.array([one.standard_error for one in sepcal.fit(model, data).parameters.values()])
    assert np.max(np.abs(fit.estimates - expected.xi) / errors) < 1e-2
    assert fit.cost == pytest.approx(expected.cost, abs=1e-4)
    assert_allclose(list(fit.noise.values()), expected.noise, rtol=1e-4)


def test_a_single_stage_of_an_own_model_and_of_part_of_the_data() -> None:
    class Line:
        inputs: ClassVar = {"t": "s"}
        outputs: ClassVar = {"z": "1"}
        linear: ClassVar = {"k": "1"}
        nonlinear: ClassVar = {"n": ("1", 0.5, 3.0)}

        def at(self, u: Any, xi2: Array) -> tuple[Array, Array]:
            return (u.t ** xi2[0])[:, np.newaxis, np.newaxis], np.zeros((len(u.t), 1))

    t = np.linspace(0.1, 2.0, 50)
    data = {"t": t, "z": 1.5 * t**1.7, "maneuver": ["a"] * 30 + ["b"] * 20}
    fit = rivals.fit_single_stage(Line(), data, {"k": 1.0, "n": 1.0}, noise={"z": 0.1})
    assert fit.by_name() == pytest.approx({"k": 1.5, "n": 1.7}, abs=1e-6)
    part = rivals.fit_single_stage(
        Line(),
        data,
        {"k": 1.0, "n": 1.0},
        noise={"z": 0.1},
        segments="b",
        bounds={"k": (None, 1.2)},
    )
    assert part.by_name()["k"] == pytest.approx(1.2)
    assert pickle.loads(pickle.dumps(part)).names == ("k", "n")


def test_a_single_stage_refuses_what_it_does_not_know() -> None:
    data = dict(state_case("scalar_1").record)
    with pytest.raises(sepcal.Error, match="there is no parameter 'd'; there are: a, c, b"):
        rivals.fit_single_stage(sepcal.ScalarExample1(), data, {"d": 1.0})
    with pytest.raises(sepcal.Error, match="evaluations must be at least 1"):
        rivals.fit_single_stage(sepcal.ScalarExample1(), data, evaluations=0)
    with pytest.raises(sepcal.Error, match="column 'z' is missing"):
        rivals.fit_single_stage(sepcal.ScalarExample1(), {"eta": data["eta"]})
    with pytest.raises(sepcal.Error, match="solver: 'sqp' is unknown; known: levenberg_marquardt"):
        rivals.fit_single_stage(sepcal.ScalarExample1(), data, solver="sqp")  # type: ignore[arg-type]
    with pytest.raises(sepcal.Error, match="start: 'c' is fixed"):
        rivals.fit_single_stage(sepcal.ScalarExample1(), data, {"c": 1.0}, fix={"c": 0.5})


# --- Haupt and Kasdin


def example(seed: int, a: float = 0.4) -> dict[str, Array]:
    eta = np.linspace(1.0, 10.0, 100)
    noise = 0.3 * np.random.default_rng(seed).standard_normal(100)
    return {"eta": eta, "z": (1.0 + a) * np.cos(eta + 0.1) + 1.0 + noise}


@pytest.mark.parametrize("seed", range(5))
def test_two_steps_are_the_oracles(seed: int) -> None:
    """In the paper's five states, from a start of its kind; the order here is a, c, b."""
    data = example(seed)
    rng = np.random.default_rng(seed)
    start = np.array([rng.normal() * 0.3, rng.normal(), 0.1 * rng.normal()])
    first = two_step_oracle.first_step(two_step_oracle.example_rows(data["eta"]), data["z"])
    second = two_step_oracle.second_step(first, two_step_oracle.example_states, start)
    fit = rivals.fit_haupt_kasdin(
        rivals.ExampleInFiveStates(), data, dict(zip("acb", start, strict=True))
    )
    assert fit.converged
    assert fit.first.rank == first.rank == 3
    assert_allclose(fit.first.states, first.y, atol=1e-10)
    assert_allclose(fit.first.information, first.information, rtol=1e-9, atol=1e-9)
    assert_allclose(fit.estimates, second.xi, atol=1e-6)
    assert_allclose(fit.covariance, second.covariance, rtol=1e-5, atol=1e-9)
    assert fit.cost == pytest.approx(second.cost, abs=1e-8)


def test_a_two_step_problem_of_ones_own() -> None:
    class Tone:
        inputs: ClassVar = {"eta": "rad"}
        outputs: ClassVar = {"z": "1"}
        states: ClassVar = {"x": "1", "y": "1", "level": "1"}
        parameters: ClassVar = {"a": "1", "c": "1", "b": ("rad", -1.5, 1.5)}

        def rows(self, u: Any) -> Array:
            ones = np.ones_like(u.eta)
            return np.stack([np.cos(u.eta), -np.sin(u.eta), ones], axis=-1)[:, np.newaxis]

        def at(self, xi: Array) -> Array:
            a, c, b = xi
            return np.array([(1 + a) * np.cos(b), (1 + a) * np.sin(b), c])

    data = example(1)
    own = rivals.fit_haupt_kasdin(Tone(), data)
    built_in = rivals.fit_haupt_kasdin(rivals.ExampleInThreeStates(), data)
    assert_allclose(own.estimates, built_in.estimates, atol=1e-8)
    assert_allclose(own.standard_errors, built_in.standard_errors, rtol=1e-6)
    assert own.by_name()["b"] == pytest.approx(0.1, abs=0.1)

    class Wrong(Tone):
        def at(self, xi: Array) -> Array:
            return np.zeros(2)

    with pytest.raises(sepcal.Error, match="gives 2 states, the first step has 3"):
        rivals.fit_haupt_kasdin(Wrong(), data)
    with pytest.raises(
        sepcal.Error, match=r"has no inputs, .*; help\(sepcal.rivals.TwoStepProblem\)"
    ):
        rivals.fit_haupt_kasdin(object(), data)  # type: ignore[arg-type]


@pytest.mark.parametrize("sigma", [0.3, 3.0])
def test_the_magnetometers_quadric_is_the_oracles(sigma: float) -> None:
    record = tumble(4, sigma)
    H, z = two_step_oracle.quadric_rows(stacked(record))
    first = two_step_oracle.first_step(H, z)
    second = two_step_oracle.second_step(
        first, lambda xi: two_step_oracle.quadric_states(xi, STRENGTH), np.zeros(9)
    )
    fit = rivals.fit_haupt_kasdin(rivals.MagnetometerInNineStates(STRENGTH), record)
    assert fit.converged
    assert_allclose(fit.estimates, second.xi, rtol=1e-5, atol=1e-6)
    assert_allclose(fit.first.states, first.y, rtol=1e-7, atol=1e-7)


# --- Alonso and Shuster


@pytest.mark.parametrize("sigma", [0.3, 3.0])
@pytest.mark.parametrize("spread", [0.0, 0.2])
@pytest.mark.parametrize("bias_alone", [False, True])
@pytest.mark.parametrize("as_printed", [False, True])
def test_twostep_is_the_oracles(
    sigma: float, spread: float, bias_alone: bool, as_printed: bool
) -> None:
    record = tumble(7, sigma, spread=spread)
    expected = twostep_oracle.alonso_shuster(
        stacked(record),
        STRENGTH + record["field_change"],
        sigma,
        bias_only=bias_alone,
        reweight=1,
        reweight_at="theta",
        mean_sign=-1.0 if as_printed else 1.0,
    )
    fit = rivals.fit_alonso_shuster(
        record, STRENGTH, noise=sigma, bias_alone=bias_alone, mean_as_printed=as_printed
    )
    assert fit.converged
    assert_allclose(fit.theta, expected.theta, rtol=1e-7, atol=1e-8)
    assert_allclose(fit.bias, expected.bias, rtol=1e-7, atol=1e-8)
    assert_allclose(fit.shape, expected.shape, rtol=1e-7, atol=1e-8)
    assert fit.cost == pytest.approx(expected.cost, rel=1e-7)
    if bias_alone:
        assert_allclose(fit.covariance, expected.covariance, rtol=1e-6)
    else:
        C = soft_iron(fit.estimates[3:6]) @ np.diag(1.0 + fit.estimates[:3])
        assert_allclose(C @ C.T, fit.shape, atol=1e-10)


def test_the_printed_mean_of_twostep_has_the_wrong_sign() -> None:
    """Scale factors 3 sigma^2 / F^2 too large: 0.96 % at 3 uT of 53."""
    record = tumble(1, 3.0, rows=100_000)
    plain, mended = (
        rivals.fit_alonso_shuster(
            record, STRENGTH, noise=3.0, reweightings=2, mean_as_printed=as_printed
        )
        for as_printed in (True, False)
    )
    excess = plain.estimates[:3] - mended.estimates[:3]
    assert_allclose(excess, 3.0 * (3.0 / STRENGTH) ** 2, rtol=0.1)
    off = (mended.estimates[:3] - MAGNETOMETER[:3]) / mended.standard_errors[:3]
    assert np.max(np.abs(off)) < 6.0
    assert np.min((plain.estimates[:3] - MAGNETOMETER[:3]) / plain.standard_errors[:3]) > 10.0


def test_twostep_refuses_and_says_what_readings_leave_open() -> None:
    record = tumble(1, 0.3, rows=8)
    with pytest.raises(sepcal.Error, match="8 rows; TWOSTEP needs at least 10"):
        rivals.fit_alonso_shuster(record, STRENGTH, noise=0.3)
    with pytest.raises(sepcal.Error, match="column 'mz' is missing"):
        rivals.fit_alonso_shuster({"mx": [1.0], "my": [1.0]}, STRENGTH, noise=0.3)
    flat = tumble(1, 0.0) | {"mz": np.zeros(200)}
    fit = rivals.fit_alonso_shuster(flat, STRENGTH, noise=0.3)
    assert not fit.converged
    assert "leave parameters open" in fit.message
    assert np.isnan(fit.estimates).all()


# --- where the two stages must not do worse


@pytest.mark.parametrize(("seed", "noise"), [(2, 0.15), (3, 0.15), (0, 3.0), (2, 3.0)])
def test_along_bounds_and_flat_valleys_the_two_stages_end_as_low_as_any(
    seed: int, noise: float
) -> None:
    """A short flight on one heading: parameters at their bounds, others left open by the record.

    Levenberg-Marquardt alone, whose steps are clipped to the box, ends up to four of ln L above.
    """
    probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
    flight = sepcal.simulate(
        probe,
        parameters={"lambda_alpha": 0.2982, "lambda_beta": -0.2673, "eps_phi": -0.138},
        noise=dict.fromkeys(probe.outputs, noise),
        rows=400,
        excitation="poor",
        seed=seed,
    )
    wanted = {*probe.inputs, *probe.outputs}
    data = {n: flight[h] for h in flight if (n := h.rsplit("_", 1)[0]) in wanted}
    angles = dict.fromkeys(("b_alpha", "b_beta", "eps_phi"), (-0.5, 0.5))
    winds = dict.fromkeys(("w_n", "w_e", "w_d"), (-60.0, 60.0))
    scales = dict.fromkeys(("lambda_va", "lambda_alpha", "lambda_beta"), (-0.5, 0.5))
    bounds = {**angles, **winds, **scales, "b_va": (-10.0, 10.0)}
    fit = sepcal.fit(probe, data, bounds=bounds, coloured_errors=False)
    single = rivals.fit_single_stage(
        probe, data, bounds=bounds, solver="slsqp", noise_tolerance=1e-8
    )
    assert fit.cost <= single.cost + 0.01
    assert "did not converge" not in fit.message


def test_segments_may_be_spans_of_time() -> None:
    data = dict(state_case("scalar_1").record)
    data["time"] = np.arange(len(data["z"]), dtype=float)
    early = {name: column[:40] for name, column in data.items()}
    span = rivals.fit_single_stage(sepcal.ScalarExample1(), data, segments="0:39.5")
    alone = rivals.fit_single_stage(sepcal.ScalarExample1(), early)
    assert_allclose(span.estimates, alone.estimates, atol=1e-9)


def test_states_may_be_any_view_and_none_is_refused() -> None:
    class Tone:
        inputs: ClassVar = {"eta": "rad"}
        outputs: ClassVar = {"z": "1"}
        states: ClassVar = {"x": "1", "y": "1", "level": "1"}
        parameters: ClassVar = {"a": "1", "c": "1", "b": "rad"}

        def rows(self, u: Any) -> Array:
            ones = np.ones_like(u.eta)
            return np.stack([np.cos(u.eta), -np.sin(u.eta), ones], axis=-1)[:, np.newaxis]

        def at(self, xi: Array) -> Array:
            a, c, b = xi
            whole = np.array([c, (1 + a) * np.sin(b), (1 + a) * np.cos(b)])
            return whole[::-1]

    data = example(1)
    built_in = rivals.fit_haupt_kasdin(rivals.ExampleInThreeStates(), data)
    assert_allclose(rivals.fit_haupt_kasdin(Tone(), data).estimates, built_in.estimates, atol=1e-8)

    class Nothing(Tone):
        def at(self, xi: Array) -> Array:
            return np.array([])

    with pytest.raises(sepcal.Error, match="must give its states"):
        rivals.fit_haupt_kasdin(Nothing(), data)
    with pytest.raises(sepcal.Error, match="no rows"):
        rivals.fit_haupt_kasdin(rivals.ExampleInThreeStates(), {"eta": [], "z": []})


@pytest.mark.parametrize("noise", [np.inf, 1e160, 1e-200])
@pytest.mark.parametrize("bias_alone", [False, True])
def test_twostep_refuses_what_overflows(noise: float, bias_alone: bool) -> None:
    with pytest.raises(sepcal.Error, match=r"finite|overflow"):
        rivals.fit_alonso_shuster(tumble(1, 0.3), STRENGTH, noise=noise, bias_alone=bias_alone)


@pytest.mark.parametrize("solver", ["levenberg_marquardt", "slsqp"])
def test_every_end_of_a_single_stage_is_a_minimum(solver: Any) -> None:
    """Where it says that it converged, SciPy's trf finds nothing lower from there."""
    case = state_case("scalar_2")
    model, data = sepcal.ScalarExample2(), dict(case.record)
    rng = np.random.default_rng(5)
    bounds = {"a": (-0.5, 2.0), "d": (-1.0, 1.5), "b": (-0.5, 0.5), "c": (-1.0, 1.0)}
    lower, upper = np.array([bounds[name] for name in model.parameters]).T
    for _ in range(40):
        start = dict(zip(model.parameters, rng.uniform(lower, upper), strict=True))
        fit = rivals.fit_single_stage(
            model, data, start, bounds=bounds, solver=solver, noise={"z": 0.3}
        )
        if not fit.converged:
            continue
        inside = np.clip(fit.estimates, lower + 1e-9, upper - 1e-9)
        further = single_stage(
            case.model, case.record, inside, lower, upper, np.array([0.3]), "trf"
        )
        assert further.cost > fit.cost - 1e-3
