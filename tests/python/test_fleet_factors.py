# SPDX-License-Identifier: BSD-3-Clause
"""What triangles of flights say together, against NumPy on all rows, SciPy and statsmodels."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import minimize
from scipy.stats import binom, kstest

import sepcal
from fleet_factors import Array, Asked, draw_fleet, make_factor
from sepcal import _core

P = 3


def rows_of(asked: list, rows: list, vehicle: str) -> tuple[Array, Array, Array]:
    """All rows of a vehicle."""
    own = [row for (_, name, *_), row in zip(asked, rows, strict=True) if name == vehicle]
    return tuple(np.concatenate(part) for part in zip(*own, strict=True))  # type: ignore[return-value]


def test_vehicles_are_least_squares_of_all_their_rows() -> None:
    asked, _, rows = draw_fleet(np.random.default_rng(1), vehicles=4)
    for fit in _core.fit_vehicles(asked):
        J, _, z = rows_of(asked, rows, fit.vehicle)
        expected, square, *_ = np.linalg.lstsq(J, z, rcond=None)
        covariance = np.linalg.inv(J.T @ J)
        errors = np.sqrt(np.diag(covariance))
        assert_allclose(np.asarray(fit.values), expected, rtol=0, atol=1e-9 * errors.min())
        assert_allclose(np.asarray(fit.covariance), covariance, rtol=1e-9)
        assert fit.misfit == pytest.approx(square[0], rel=1e-9)
        without = []
        own = [row for (_, name, *_), row in zip(asked, rows, strict=True) if name == fit.vehicle]
        for left in range(len(own)):
            others = [row for k, row in enumerate(own) if k != left]
            J, _, z = (np.concatenate(part) for part in zip(*others, strict=True))
            without.append(np.linalg.lstsq(J, z, rcond=None)[0])
        n = len(own)
        jackknife = (n - 1) * np.cov(np.array(without).T, bias=True)
        assert_allclose(np.asarray(fit.jackknife), jackknife, rtol=1e-7)


def test_what_flights_do_not_tell_is_no_number() -> None:
    rng = np.random.default_rng(2)
    asked = []
    for number in range(3):
        J = rng.standard_normal((20, 3))
        J[:, 2] = J[:, 1]  # a sum alone
        z = J @ [1.0, 2.0, 3.0] + 0.1 * rng.standard_normal(20)
        asked.append((f"f{number}", "v", make_factor(J, np.zeros((20, 0)), z, np.zeros(3)), {}))
    (fit,) = _core.fit_vehicles(asked)
    assert fit.values[0] == pytest.approx(1.0, abs=0.1)
    assert np.isnan(fit.values[1:]).all()


def restricted(rows: list[tuple[Array, Array]], x: Array, scale: float = 1.0) -> float:
    """-2 times the restricted likelihood of random effects with standard deviations exp(x)."""
    spread = np.diag(np.exp(2.0 * x))
    A, b, square, log = np.zeros((P, P)), np.zeros(P), 0.0, 0.0
    for J, z in rows:
        H = scale * np.eye(len(z)) + J @ spread @ J.T
        inverse = np.linalg.inv(H)
        A += J.T @ inverse @ J
        b += J.T @ inverse @ z
        square += z @ inverse @ z
        log += np.linalg.slogdet(H)[1]
    return float(log + np.linalg.slogdet(A)[1] + square - b @ np.linalg.solve(A, b))


def test_a_population_is_the_maximum_of_its_restricted_likelihood() -> None:
    spread = np.array([0.5, 1.0, 0.2])
    asked, _, rows = draw_fleet(
        np.random.default_rng(3), spread=spread, vehicles=9, flights=3, rows=10
    )
    whole = [rows_of(asked, rows, f"v{v}")[::2] for v in range(9)]
    best = minimize(
        lambda x: restricted(whole, x), np.log(spread), method="Nelder-Mead",
        options={"xatol": 1e-9, "fatol": 1e-12, "maxiter": 4000},
    )  # fmt: skip
    found = _core.fit_population(asked, False, np.ones(P))
    assert found.converged
    assert_allclose(np.sqrt(np.diag(np.asarray(found.spread))), np.exp(best.x), rtol=2e-5)
    S = np.diag(np.exp(2.0 * best.x))
    A, b = np.zeros((P, P)), np.zeros(P)
    for J, z in whole:
        inverse = np.linalg.inv(np.eye(len(z)) + J @ S @ J.T)
        A += J.T @ inverse @ J
        b += J.T @ inverse @ z
    mean = np.linalg.solve(A, b)
    assert_allclose(np.asarray(found.mean), mean, rtol=1e-5)
    assert_allclose(np.asarray(found.mean_covariance), np.linalg.inv(A), rtol=1e-4)
    J, z = whole[5]
    shrunken = mean + S @ J.T @ np.linalg.solve(np.eye(len(z)) + J @ S @ J.T, z - J @ mean)
    assert_allclose(np.asarray(found.shrunken)[:, 5], shrunken, rtol=1e-4, atol=1e-6)


def test_a_population_is_that_of_statsmodels() -> None:
    models = pytest.importorskip("statsmodels.regression.mixed_linear_model")
    asked, _, rows = draw_fleet(
        np.random.default_rng(4), vehicles=15, p=2, spread=np.array([0.7, 1.2])
    )
    J = np.concatenate([row[0] for row in rows])
    z = np.concatenate([row[2] for row in rows])
    groups = np.repeat([name for _, name, *_ in asked], 40)
    model = models.MixedLM(z, J, groups, exog_re=J)
    fitted = model.fit(reml=True, method=["bfgs", "lbfgs"], gtol=1e-9)
    found = _core.fit_population(asked, True, np.full(2, fitted.scale))
    assert_allclose(np.asarray(found.spread), np.asarray(fitted.cov_re), rtol=2e-3, atol=2e-3)
    assert_allclose(np.asarray(found.mean), fitted.fe_params, rtol=1e-3, atol=1e-4)
    assert_allclose(np.sqrt(np.diag(np.asarray(found.mean_covariance))), fitted.bse_fe, rtol=2e-3)


def test_no_spread_is_found_where_vehicles_are_alike() -> None:
    asked, _, _ = draw_fleet(np.random.default_rng(5), spread=0.0, vehicles=20)
    found = _core.fit_population(asked, False, np.ones(P))
    errors = np.sqrt(np.diag(np.asarray(_core.fit_vehicles(asked)[0].covariance)))
    assert (np.sqrt(np.diag(np.asarray(found.spread))) < 0.6 * errors).all()


def test_a_population_holds_what_it_says() -> None:
    """95 % intervals of means and of each vehicle, over 60 fleets with flights that scatter."""
    hits = {"mean": 0, "vehicle": 0}
    counts = {"mean": 0, "vehicle": 0}
    for seed in range(60):
        rng = np.random.default_rng([6, seed])
        asked, thetas, _ = draw_fleet(
            rng, vehicles=25, flights=8, spread=np.array([0.1, 0.3, 0.05]), wander=0.1
        )
        found = _core.fit_population(asked, False, np.zeros(0))
        error = np.sqrt(np.diag(np.asarray(found.mean_covariance)))
        hits["mean"] += int((np.abs(np.asarray(found.mean)) < 1.96 * error).sum())
        counts["mean"] += P
        off = np.abs(np.asarray(found.shrunken) - np.array(thetas).T)
        hits["vehicle"] += int((off < 1.96 * np.asarray(found.shrunken_errors)).sum())
        counts["vehicle"] += off.size
    assert 0.90 < hits["mean"] / counts["mean"] < 0.99
    assert 0.92 < hits["vehicle"] / counts["vehicle"] < 0.97


def test_what_is_hidden_everywhere_is_found_and_nothing_else() -> None:
    asked, _, rows = draw_fleet(np.random.default_rng(7), vehicles=20, gamma={2: 0.1}, wander=0.05)
    found = sepcal.FleetDiagnosis(_core.diagnose_fleet(asked, 0.01, 8))
    assert [(one.effect, one.cause) for one in found.found] == [("e2", "everywhere")]
    estimate, error, unit = found.found[0].coefficients["e2"]
    assert abs(estimate - 0.1) < 3.0 * error
    assert unit == "m"
    # The estimate is least squares of all rows, each vehicle having parameters of its own.
    blocks = []
    for v in range(20):
        J, G, z = rows_of(asked, rows, f"v{v}")
        left = np.column_stack([G[:, 2], z])
        blocks.append(left - J @ np.linalg.lstsq(J, left, rcond=None)[0])
    column, z = np.concatenate(blocks).T
    assert estimate == pytest.approx(column @ z / (column @ column), rel=1e-9)
    assert found.exit_code == 3
    assert "e2, in the whole fleet" in str(found)


def test_vehicles_with_an_effect_are_named() -> None:
    hidden = {3: {1: 0.8}, 11: {1: -0.8}}
    asked, _, _ = draw_fleet(np.random.default_rng(8), vehicles=25, of_vehicles=hidden, wander=0.05)
    found = sepcal.FleetDiagnosis(_core.diagnose_fleet(asked, 0.01, 8))
    assert sorted(found.named_vehicles) == ["v11", "v3"]
    assert {one.effect for one in found.found} == {"e1"}


def test_an_effect_that_differs_between_vehicles() -> None:
    rng = np.random.default_rng(9)
    hidden = {v: {0: 0.3 * rng.standard_normal()} for v in range(25)}
    asked, _, _ = draw_fleet(rng, vehicles=25, of_vehicles=hidden)
    found = _core.diagnose_fleet(asked, 0.01, 8).found
    assert found[0].effect == "e0"
    differs = [one for one in found if one.cause == "differs"]
    assert [one.effect for one in differs] == ["e0"]
    assert differs[0].spread[0] == pytest.approx(0.3, rel=0.4)


def test_a_parameter_that_ages_is_told() -> None:
    asked, _, _ = draw_fleet(np.random.default_rng(10), vehicles=20, ages={1: 0.004})
    found = _core.diagnose_fleet(asked, 0.01, 8).found
    assert [(one.effect, one.cause) for one in found] == [("p1[age_days]", "grows")]
    estimate, error, unit = found[0].coefficients["p1[age_days]"]
    assert abs(estimate - 0.004) < 3.0 * error
    assert unit == "m/age_days"


def test_nothing_is_found_in_noise_that_wanders() -> None:
    """In 1 of 100 fleets at most, by its level: 5 of 200 happen in 1 of 1,000 runs."""
    false = 0
    for seed in range(200):
        rng = np.random.default_rng([11, seed])
        asked, _, _ = draw_fleet(rng, vehicles=10, flights=5, wander=0.3 * (seed % 2))
        false += bool(_core.diagnose_fleet(asked, 0.01, 8).found)
    assert binom.sf(false - 1, 200, 0.01) > 1e-3


def draw_alike(seed: int) -> list[Asked]:
    """Six vehicles of four flights, eight candidates of three causes, and what is none of these."""
    rng = np.random.default_rng([20, seed])
    mix = rng.standard_normal((3, 8))
    asked = []
    for v in range(6):
        theta = rng.standard_normal(2)
        for f in range(4):
            J = np.column_stack([rng.standard_normal((60, 2))[:, 0], np.ones(60)])
            causes = rng.standard_normal((60, 3))
            G = causes @ mix + 0.15 * rng.standard_normal((60, 8))
            z = J @ theta + causes**2 @ [0.3, 0.3, 0.1] + rng.standard_normal(60)
            z += 0.5 * causes[:, 0] * (1.0 + 0.5 * rng.standard_normal())
            z += 0.09 * G @ rng.standard_normal(8)
            asked.append((f"f{v}-{f}", f"v{v}", make_factor(J, G, z, np.zeros(2)), {}))
    return asked


def test_causes_that_are_alike_end_the_search() -> None:
    """One takes another's place, which explains nothing then: it must not come back for ever."""
    for seed in range(60):
        assert len(_core.diagnose_fleet(draw_alike(seed), 0.01, 8).found) <= 8


def test_a_change_is_dated_and_chance_is_none() -> None:
    rng = np.random.default_rng(12)
    asked, _, _ = draw_fleet(rng, vehicles=40, flights=8, wander=0.2)
    p = [10.0**one.log10_p for one in _core.follow_vehicles(asked)]
    assert min(p) > 1e-4
    changed = []
    for number in range(8):
        J = rng.standard_normal((40, P))
        theta = np.array([0.0, 1.5 * (number >= 5), 0.0])
        z = J @ (theta + 0.2 * rng.standard_normal(P)) + rng.standard_normal(40)
        factor = make_factor(J, np.zeros((40, 0)), z, np.zeros(P))
        changed.append((f"c{number}", "changed", factor, {}))
    (found,) = _core.follow_vehicles(changed)
    assert (found.change, found.parameter) == (5, "p1")
    assert abs(found.after - found.before - 1.5) < 4.0 * found.standard_error
    assert found.p_adjusted < 0.01


def test_where_nothing_changes_p_is_seldom_small() -> None:
    """Of the likeliest of three places, corrected for their number."""
    rng = np.random.default_rng(13)
    p = []
    for _ in range(300):
        asked, _, _ = draw_fleet(rng, vehicles=1, flights=4, rows=20, wander=0.3)
        p.append(10.0 ** _core.follow_vehicles(asked)[0].log10_p)
    assert np.mean(np.array(p) < 0.05) < 0.09
    assert kstest(p, "uniform", alternative="greater").pvalue > 1e-3


def test_a_spread_is_that_of_its_likelihood() -> None:
    rng = np.random.default_rng(14)
    variances = rng.uniform(0.5, 2.0, 30)
    estimates = rng.normal(3.0, np.sqrt(variances + 1.0))

    def cost(x: Array) -> float:
        w = 1.0 / (variances + x[0] ** 2)
        mean = (w @ estimates) / w.sum()
        return float(-np.log(w).sum() + np.log(w.sum()) + w @ (estimates - mean) ** 2)

    best = minimize(cost, [1.0], method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-14})
    mean, error, variance = _core.find_spread(estimates.tolist(), variances.tolist())
    assert variance == pytest.approx(best.x[0] ** 2, rel=1e-5)
    w = 1.0 / (variances + variance)
    assert (mean, error) == pytest.approx(((w @ estimates) / w.sum(), w.sum() ** -0.5))


def test_misuse_is_one_line() -> None:
    asked, _, _ = draw_fleet(np.random.default_rng(15), vehicles=2, flights=1)
    with pytest.raises(sepcal.Error, match="fewer than three flights"):
        _core.diagnose_fleet(asked, 0.01, 8)
    with pytest.raises(sepcal.Error, match="at least three vehicles; this fleet has 2"):
        _core.fit_population(asked, False, np.zeros(0))
    with pytest.raises(sepcal.Error, match="two flights are called 'f0-0'"):
        _core.fit_vehicles([asked[0], asked[0]])
    other, _, _ = draw_fleet(np.random.default_rng(16), vehicles=1, flights=1, p=2)
    with pytest.raises(sepcal.Error, match="has other parameters than"):
        _core.fit_vehicles([asked[0], ("x", "v", *other[0][2:])])
    with pytest.raises(sepcal.Error, match="at least one flight"):
        _core.fit_vehicles([])
