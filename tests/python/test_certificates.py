# SPDX-License-Identifier: BSD-3-Clause
"""What is proven of a cost, from Python and by the app."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import sepcal
from apps import Bench

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
    options = {"fixed": {"b": -0.3}}
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
    with pytest.raises(sepcal.Error, match="'c' has no value"):
        sepcal.bound_cost(model, data, {"b": 0.0})
    with pytest.raises(sepcal.Error, match="'b' is outside of its bounds"):
        sepcal.bound_cost(model, data, {"b": 3.0, "c": 0.0})
    flown = sepcal.simulate("five-hole", rows=300)
    probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
    flight = sepcal.Flight({name: flown[name] for name in flown.columns})
    calibration = sepcal.fit(probe, flight)
    with pytest.raises(sepcal.Error, match="can't be enclosed"):
        calibration.certify()


def test_the_app_says_it_of_a_pitot_static_tube(pitot: Bench) -> None:
    made = pitot.run(
        "simulate", "-o", "tube.csv", "--probe", "pitot-static", "--rows", "120", "--seed", "2"
    )
    assert made.code == 0
    held = ("--fix", "w_d=0", "--fix", "c_va=0", "--bounds", "w_n=-8,8", "--bounds", "w_e=-8,8")
    fitted = pitot.run("fit", "tube.csv", "--probe", "pitot-static", *held, "--certify")
    assert fitted.code == 0
    assert "note: certificate: proven: " in fitted.err
