# SPDX-License-Identifier: BSD-3-Clause
"""What is proven of a cost, from Python and by the app."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from scipy.optimize import lsq_linear

import sepcal
from apps import Bench
from own_models import WindBox, simulate_wind_box

POINT = {"b": 0.05, "c": 0.1}


def waves(seed: int = 3) -> dict[str, np.ndarray]:
    """The paper's second example: 100 angles from 1 to 10 rad, noise of 0.3."""
    rng = np.random.default_rng(seed)
    eta = np.linspace(1, 10, 100)
    return {
        "eta": eta,
        "z": 2 * np.cos(eta * 1.05 + 0.1) + 1 + 0.3 * rng.standard_normal(eta.size),
    }


def profile(data: dict[str, np.ndarray], b: float, c: float) -> float:
    """J with a and d at their best there, R = 1."""
    wave = np.cos(data["eta"] * (1 + b) + c)
    columns = np.column_stack([wave, np.ones_like(wave)])
    left = data["z"] - wave
    return 0.5 * float(np.linalg.lstsq(columns, left, rcond=None)[1][0])


def test_the_second_example_is_certified() -> None:
    data, model = waves(), sepcal.ScalarExample2()
    fit = sepcal.fit(model, data)
    proof = sepcal.certify(model, data, fit)
    assert proof.is_global
    assert str(proof).startswith("proven: ")
    grid = [profile(data, b, c) for b in np.linspace(-0.5, 0.5, 81) for c in np.linspace(-1, 1, 41)]
    noise = fit.noise["z"]
    assert proof.lower * noise**2 <= min(grid)
    assert proof.cost * noise**2 == pytest.approx(
        profile(data, fit["b"].value, fit["c"].value), rel=1e-9
    )
    lower, upper = proof.region["b"]
    assert lower <= fit["b"].value <= upper
    assert pickle.loads(pickle.dumps(proof)).boxes == proof.boxes


def test_a_minimum_that_is_not_the_lowest_is_refuted() -> None:
    data, model = waves(), sepcal.ScalarExample2()
    options = {"fix": {"b": -0.3}}
    held = sepcal.fit(model, data, **options)
    assert sepcal.certify(model, data, held, **options).is_global  # of what is free
    freed = sepcal.fit(model, data, bounds={"b": (0.3, 0.5)})
    narrow = sepcal.certify(model, data, freed, bounds={"b": (0.3, 0.5)})
    assert narrow.is_global  # within its bounds


def test_few_boxes_prove_nothing_and_say_so() -> None:
    data, model = waves(), sepcal.ScalarExample2()
    proof = sepcal.certify(model, data, sepcal.fit(model, data), boxes=3)
    assert proof.status == "not_certified"
    assert "not proven within" in proof.message
    assert proof.lower <= proof.cost


def test_the_paper_s_bound_beside_the_one_that_holds() -> None:
    data, model = waves(), sepcal.ScalarExample2()
    bounds = {"b": (0.04, 0.06), "c": (0.08, 0.12)}
    bound = sepcal.bound_cost(model, data, POINT, bounds=bounds)
    assert bound.cost == pytest.approx(profile(data, **POINT), rel=1e-9)
    rng = np.random.default_rng(1)
    reached = [profile(data, rng.uniform(0.04, 0.06), rng.uniform(0.08, 0.12)) for _ in range(200)]
    assert 0 < bound.lower <= min(reached)
    assert bound.paper_lower < bound.lower  # Eq. 13 is far from tight here
    assert bound.l_2 == pytest.approx(np.hypot(0.01, 0.02))


def test_what_can_not_be_proven_is_refused() -> None:
    data, model = waves(), sepcal.ScalarExample2()
    fit = sepcal.fit(model, data)
    with pytest.raises(sepcal.Error, match="parameters are not the model's"):
        sepcal.certify(sepcal.ScalarExample1(), data, fit)
    with pytest.raises(sepcal.Error, match="plain least squares"):
        sepcal.certify(model, data, fit, loss="huber")
    with pytest.raises(sepcal.Error, match="bounds of 'b' are not those of the fit"):
        sepcal.certify(model, data, fit, bounds={"b": (0.0, 0.1)})
    part = sepcal.fit(model, data | {"maneuver": ["x"] * 60 + ["y"] * 40}, stage_two_segments="x")
    with pytest.raises(sepcal.Error, match="the fit is of 60 rows, its options select 100"):
        sepcal.certify(model, data, part)
    with pytest.raises(sepcal.Error, match="'c' has no value"):
        sepcal.bound_cost(model, data, {"b": 0.0})
    with pytest.raises(sepcal.Error, match="'b' is outside of its bounds"):
        sepcal.bound_cost(model, data, {"b": 3.0, "c": 0.0})
    flown = sepcal.simulate("five-hole", rows=300)
    probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
    flight = sepcal.Flight({name: flown[name] for name in flown.columns})
    calibration = sepcal.fit(probe, flight)
    with pytest.raises(sepcal.Error, match=r"at most 3 nonlinear parameters, .* 5 are free; hold"):
        calibration.certify()
    with pytest.raises(sepcal.Error, match="can't be enclosed"):
        sepcal.bound_cost(WindBox(), simulate_wind_box(20), {"delta": 0.0})


def test_a_probe_whose_other_angles_are_known_is_certified() -> None:
    """What depends on the inputs alone, attitude and pressures, is rounded outwards too."""
    probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
    flown = sepcal.simulate(probe, rows=60, seed=1)
    flight = sepcal.Flight({name: flown[name] for name in flown.columns})
    held = {name: flown.truth[name] for name in probe.nonlinear if name != "eps_phi"}
    calibration = sepcal.fit(probe, flight, fix=held)
    proof = calibration.certify()
    assert proof.is_global
    lower, upper = proof.region["eps_phi"]
    assert lower <= calibration["eps_phi"].value <= upper
    assert upper - lower < 0.02


def test_the_app_says_it_of_a_pitot_static_tube(pitot: Bench) -> None:
    made = pitot.run(
        "simulate", "-o", "tube.csv", "--probe", "pitot-static", "--rows", "120", "--seed", "2"
    )
    assert made.code == 0
    held = ("--fix", "w_d=0", "--fix", "c_va=0", "--bounds", "w_n=-8,8", "--bounds", "w_e=-8,8")
    fitted = pitot.run("fit", "tube.csv", "--probe", "pitot-static", *held, "--certify")
    assert fitted.code == 0
    assert "note: certificate: proven: " in fitted.err


def test_a_bound_of_a_linear_parameter_is_kept_in_both_proofs() -> None:
    """J(xi2p) is the least within the bounds of xi1, and a certificate succeeds with one active."""
    eta = np.linspace(0.0, 6.0, 40)
    noise = 0.1 * np.random.default_rng(2).standard_normal(40)
    data = {"eta": eta, "z": 1.5 * np.cos(eta + 0.4) + 0.3 + noise}
    bounds = {"a": (-0.2, 0.1)}
    model = sepcal.ScalarExample1()
    at = {"b": 0.3}
    found = sepcal.bound_cost(
        model, data, at, bounds=bounds | {"b": (0.25, 0.35)}, noise={"z": 0.1}
    )
    wave = np.cos(eta + 0.3)
    solved = lsq_linear(
        np.column_stack([wave, np.ones(40)]), data["z"] - wave, ([-0.2, -np.inf], [0.1, np.inf])
    )
    assert found.cost == pytest.approx(solved.cost / 0.1**2, rel=1e-9)
    exact = sepcal.bound_cost(model, data, at, bounds=bounds | {"b": (0.3, 0.3)}, noise={"z": 0.1})
    assert exact.lower == pytest.approx(found.cost, rel=1e-9)
    fit = sepcal.fit(model, data, bounds=bounds, noise={"z": 0.1})
    assert fit.at_bound == ["a"]
    proof = sepcal.certify(model, data, fit, bounds=bounds, noise={"z": 0.1})
    assert proof.is_global
    assert proof.boxes < 200
