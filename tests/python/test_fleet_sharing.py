# SPDX-License-Identifier: BSD-3-Clause
"""What vehicles share: common parameters, rates of growth, and a population's spread."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import minimize, minimize_scalar
from scipy.special import logsumexp
from scipy.stats import binom

import sepcal
from fleet_factors import Array, draw_fleet
from sepcal import _core
from sepcal.fleet.store import factor_of

NAMES = "{vehicle}_{date}.csv"


def columns_of(J: Array, vehicle: int, vehicles: int, common: list[int]) -> Array:
    """A flight's rows in the stacked problem: own parameters of each vehicle, then common ones."""
    own = [k for k in range(J.shape[1]) if k not in common]
    rows = np.zeros((len(J), vehicles * len(own) + len(common)))
    rows[:, vehicle * len(own) : (vehicle + 1) * len(own)] = J[:, own]
    rows[:, vehicles * len(own) :] = J[:, common]
    return rows


def test_a_common_parameter_is_that_of_the_stacked_rows() -> None:
    vehicles, flights = 5, 4
    asked, _, rows = draw_fleet(
        np.random.default_rng(1), vehicles=vehicles, flights=flights, spread=np.array([1, 0, 1.0])
    )
    A = [columns_of(J, i // flights, vehicles, [1]) for i, (J, *_) in enumerate(rows)]
    z = [row[2] for row in rows]
    x = np.linalg.lstsq(np.concatenate(A), np.concatenate(z), rcond=None)[0]
    covariance = np.linalg.inv(np.concatenate(A).T @ np.concatenate(A))
    without = []
    for v in range(vehicles):
        kept = [i for i in range(len(rows)) if i // flights != v]
        left = [np.concatenate([part[i] for i in kept]) for part in (A, z)]
        without.append(np.linalg.lstsq(left[0], left[1], rcond=None)[0][-1])
    jackknife = (vehicles - 1) * np.var(without)
    for v, fit in enumerate(_core.fit_vehicles(asked, ["p1"])):
        places = [2 * v, 2 * vehicles, 2 * v + 1]
        error = np.sqrt(covariance.diagonal().min())
        assert_allclose(np.asarray(fit.values), x[places], rtol=0, atol=1e-9 * error)
        assert_allclose(
            np.asarray(fit.covariance), covariance[np.ix_(places, places)], rtol=1e-8, atol=1e-15
        )
        assert np.asarray(fit.jackknife)[1, 1] == pytest.approx(jackknife, rel=1e-7)


def test_a_rate_is_that_of_the_stacked_rows() -> None:
    vehicles, flights = 4, 5
    asked, _, rows = draw_fleet(
        np.random.default_rng(2), vehicles=vehicles, flights=flights, ages={2: 0.05}
    )
    mean = np.mean([one[3]["age_days"] for one in asked])
    grown, A = [], []
    for i, ((name, vehicle, factor, known), (J, *_)) in enumerate(zip(asked, rows, strict=True)):
        distance = known["age_days"] - mean
        factor = _core.with_rate(factor, "p2", "age_days", distance)
        grown.append((name, vehicle, factor, known))
        with_rate = np.column_stack([J, distance * J[:, 2]])
        A.append(columns_of(with_rate, i // flights, vehicles, [3]))
    x = np.linalg.lstsq(np.concatenate(A), np.concatenate([r[2] for r in rows]), rcond=None)[0]
    for v, fit in enumerate(_core.fit_vehicles(grown, ["p2[age_days]"])):
        assert_allclose(np.asarray(fit.values), [*x[3 * v : 3 * v + 3], x[-1]], rtol=1e-9)
    assert x[-1] == pytest.approx(0.05, abs=0.01)
    found = _core.diagnose_fleet(grown, 0.01, 8, ["p2[age_days]"])
    assert found.found == []
    with pytest.raises(sepcal.Error, match="no parameter 'p7'"):
        _core.with_rate(asked[0][2], "p7", "age_days", 1.0)


def test_a_populations_common_parameter_has_no_spread() -> None:
    """Against the restricted likelihood of all rows."""
    vehicles, flights = 8, 3
    asked, _, rows = draw_fleet(
        np.random.default_rng(3), vehicles=vehicles, flights=flights, rows=10,
        spread=np.array([0.5, 0, 0.3]),
    )  # fmt: skip
    whole = [
        tuple(np.concatenate([rows[i][k] for i in range(v * flights, (v + 1) * flights)])
              for k in (0, 2))
        for v in range(vehicles)
    ]  # fmt: skip

    def restricted(x: Array) -> float:
        S = np.diag([np.exp(2 * x[0]), 0.0, np.exp(2 * x[1])])
        A, b, square, log = np.zeros((3, 3)), np.zeros(3), 0.0, 0.0
        for J, z in whole:
            H = np.eye(len(z)) + J @ S @ J.T
            A += J.T @ np.linalg.solve(H, J)
            b += J.T @ np.linalg.solve(H, z)
            square += z @ np.linalg.solve(H, z)
            log += np.linalg.slogdet(H)[1]
        return float(log + np.linalg.slogdet(A)[1] + square - b @ np.linalg.solve(A, b))

    best = minimize(restricted, np.log([0.5, 0.3]), method="Nelder-Mead",
                    options={"xatol": 1e-9, "fatol": 1e-12, "maxiter": 4000})  # fmt: skip
    found = _core.fit_population(asked, False, np.ones(3), ["p1"])
    spread = np.sqrt(np.diag(np.asarray(found.spread)))
    assert spread[1] == 0.0
    assert_allclose(spread[[0, 2]], np.exp(best.x), rtol=2e-5)
    assert np.ptp(np.asarray(found.shrunken)[1]) == 0.0


def test_a_vehicle_whose_common_parameter_differs_is_named() -> None:
    rng = np.random.default_rng(4)
    vehicles = 20
    spread = np.array([1.0, 1.0, 0.0])
    wrong, named = 0, 0
    for _ in range(20):
        asked, _, _ = draw_fleet(rng, vehicles=vehicles, spread=spread, wander=0.05)
        found = sepcal.FleetDiagnosis(_core.diagnose_fleet(asked, 0.01, 8, ["p2"]))
        wrong += found.exit_code != 0
        moved = []
        for name, vehicle, factor, known in asked:
            shift = 0.8 if vehicle == "v7" else 0.0
            values = np.asarray(factor.values).copy()
            values[2] += shift  # as if all readings had been taken with so much more of it
            made = factor_of(dict(factor._asdict()) | {"values": values})
            moved.append((name, vehicle, made, known))
        found = sepcal.FleetDiagnosis(_core.diagnose_fleet(moved, 0.01, 8, ["p2"]))
        named += found.named_vehicles == ["v7"] and found.found[0].effect == "p2"
    assert binom.sf(wrong - 1, 20, 0.01) > 1e-3
    assert named >= 19


def test_misuse_is_one_line() -> None:
    asked, _, _ = draw_fleet(np.random.default_rng(5), vehicles=4, flights=2)
    with pytest.raises(sepcal.Error, match="common: the fleet has no parameter 'p9'; it has: p0"):
        _core.fit_vehicles(asked, ["p9"])
    with pytest.raises(sepcal.Error, match="leave a parameter to the vehicles"):
        _core.diagnose_fleet(asked, 0.01, 8, ["p0", "p1", "p2"])


def write_logs(folder: Path, days: dict[str, int], rate: float = 0.0, **hide: float) -> None:
    """Logs of five vehicles on these days; the scale grows by `rate` a day."""
    for number in range(5):
        for k, (day, age) in enumerate(days.items()):
            rng = np.random.default_rng([6, number, k])
            parameters = {
                "s_va": 0.93 + 0.01 * number + rate * age,
                "w_n": rng.normal(0, 3),
                "w_e": rng.normal(),
            }
            flight = sepcal.simulate(
                "pitot-static", rows=240, seed=10 * number + k, parameters=parameters,
                hide=hide or None,
            )  # fmt: skip
            flight.to_csv(folder / f"V{number}_{day}.csv")


def test_gusts_bend_no_scale_and_are_told(tmp_path: Path) -> None:
    """Velocities have the gusts that the wind of the model has not: 0.4 m/s with 3 s of memory."""
    rng = np.random.default_rng(8)
    for vehicle in range(6):
        for k in range(4):
            flight = sepcal.simulate(
                "pitot-static", rows=900, seed=10 * vehicle + k,
                parameters={"s_va": 0.95, "w_n": rng.normal(0, 3), "w_e": rng.normal(0, 3)},
            )  # fmt: skip
            columns = {name: np.array(values) for name, values in flight.items()}
            step = np.median(np.diff(columns["time_s"]))
            for name in ("vn_mps", "ve_mps"):
                gust = np.zeros(flight.rows)
                for row in range(1, flight.rows):
                    gust[row] = np.exp(-step / 3.0) * gust[row - 1] + rng.normal(
                        0, 0.4 * np.sqrt(1 - np.exp(-2 * step / 3.0))
                    )
                columns[name] = columns[name] + gust
            sepcal.Flight(columns).to_csv(tmp_path / f"V{vehicle}_{k}.csv")
    fleet = sepcal.Fleet(tmp_path, sepcal.PitotStatic(), names="{vehicle}_*.csv")
    for flight in fleet.flights.values():
        T = np.asarray(flight.factor.triangle)
        alone = flight.factor.values + np.linalg.solve(T[:2, :2], T[:2, -1])
        fitted = json.loads(flight.calibration)["parameters"]
        assert alone[0] == pytest.approx(fitted["s_va"]["value"], abs=2e-3)
    scales = [fit.values[fleet.parameters.index("s_va")] for fit in fleet.vehicles.values()]
    assert np.mean(scales) == pytest.approx(0.95, abs=0.03)
    (note,) = fleet.diagnose().notes
    assert "where fast changes weigh more" in note
    assert note in str(fleet.diagnose())


@pytest.mark.parametrize(
    ("cause", "share", "is_noisy", "doubted"),
    [
        ("everywhere", 0.01, True, True),
        ("grows", 0.01, True, True),
        ("everywhere", 0.01, False, False),
        ("everywhere", 0.05, True, False),
        ("one-vehicle", 0.01, True, False),
    ],
)
def test_a_small_effect_beside_a_noisy_input_is_in_doubt(
    cause: str, share: float, is_noisy: bool, doubted: bool
) -> None:
    diagnosis: Any = SimpleNamespace(notes=["noise in an input pulls"] if is_noisy else ["another"])
    finding: Any = SimpleNamespace(cause=cause, share=share)
    assert ("IN DOUBT" in sepcal.FleetDiagnosis.doubt(diagnosis, finding)) == doubted


def test_where_inputs_are_sure_nothing_is_told_of_weights(tmp_path: Path) -> None:
    write_logs(tmp_path, DAYS)
    assert sepcal.Fleet(tmp_path, sepcal.PitotStatic(), names=NAMES).diagnose().notes == []


DAYS = {"2026-01-10": 0, "2026-03-11": 60, "2026-05-10": 120, "2026-07-09": 180}


def test_an_effect_of_the_whole_fleet(tmp_path: Path) -> None:
    """One coefficient, surer than each vehicle's, through every verb and back from its folder."""
    write_logs(tmp_path, DAYS, **{"wind[altitude_m]": 0.02})
    fleet = sepcal.Fleet(tmp_path, sepcal.PitotStatic(), names=NAMES)
    assert fleet.common == []
    each = fleet.add("wind[altitude_m]")
    shared = fleet.add("wind[altitude_m]", common=True)
    names = [name for name in shared.parameters if name.startswith("wind[")]
    assert shared.common == names
    (step,) = shared.added
    assert step["rmse_after"] < step["rmse_before"]
    for name in names:
        k = shared.parameters.index(name)
        values = [fit.values[k] for fit in shared.vehicles.values()]
        assert np.ptp(values) == 0.0
        errors = [
            np.mean([np.asarray(fit.covariance)[k, k] for fit in one.vehicles.values()])
            for one in (each, shared)
        ]
        assert errors[1] < 0.3 * errors[0]  # a fifth of it, were vehicles alike
    assert shared.diagnose().found == []
    assert set(shared.monitor().parameters) == {"s_va", "c_va"}
    population = shared.population()
    assert population.spread[names[0]] == 0.0
    assert "the same in all" in str(population)
    assert "The same in all vehicles: wind[" in str(shared)
    assert population.calibrate(sepcal.read(tmp_path / "V0_2026-01-10.csv").head(80)).success
    kept = tmp_path / "kept"
    shared.save(kept)
    assert sepcal.Fleet.load(kept).to_json() == shared.to_json()


def test_a_scale_that_ages_is_added(tmp_path: Path) -> None:
    write_logs(tmp_path, DAYS, rate=2e-4)
    fleet = sepcal.Fleet(tmp_path, sepcal.PitotStatic(), names=NAMES)
    found = fleet.diagnose().found
    assert found[0].effect in ("s_va[age_days]", "c_va[age_days]")
    grown = fleet.add("s_va[age_days]")
    (step,) = grown.added
    assert step["rmse_after"] < 0.9 * step["rmse_before"]
    k = grown.parameters.index("s_va[age_days]")
    fit = next(iter(grown.vehicles.values()))
    error = np.sqrt(max(np.asarray(fit.covariance)[k, k], np.asarray(fit.jackknife)[k, k]))
    assert abs(fit.values[k] - 2e-4) < 4 * error
    assert error < 2e-5
    assert grown.diagnose().found == []
    assert grown.monitor().changes == ()
    assert set(grown.population().prior) == {"s_va", "c_va"}
    with pytest.raises(sepcal.Error, match=r"has s_va\[age_days\] already"):
        grown.add("s_va[age_days]")
    kept = tmp_path / "kept"
    grown.save(kept)
    assert sepcal.Fleet.load(kept).to_json() == grown.to_json()


def test_a_spread_is_that_of_the_likelihood_of_all_rows(tmp_path: Path) -> None:
    """The model as it is, not linearised: c_va of each vehicle and all winds integrated out."""
    rng = np.random.default_rng(7)
    vehicles, each, sigma, s_va = 8, 3, 0.3, 0.95
    for v in range(vehicles):
        c_va = rng.normal(0.5, 0.15)
        for k in range(each):
            parameters = {
                "s_va": s_va, "c_va": c_va, "w_n": rng.normal(0, 6), "w_e": rng.normal(0, 6)
            }  # fmt: skip
            flight = sepcal.simulate(
                "pitot-static", rows=80, seed=100 * v + k, parameters=parameters,
                noise={"airspeed": sigma},
            )  # fmt: skip
            flight.to_csv(tmp_path / f"V{v}_{k}.csv")
    fleet = sepcal.Fleet(
        tmp_path, sepcal.PitotStatic(), names="{vehicle}_*.csv", candidates=[], tolerance=1e-6,
        fix={"s_va": s_va}, noise={"airspeed": sigma}, coloured_errors=False,
    )  # fmt: skip
    assert fleet.parameters == ["c_va"]
    c = np.linspace(-1.0, 2.0, 1501)
    of_vehicles = {name: np.zeros_like(c) for name in fleet.vehicles}
    nodes, weights = np.polynomial.hermite_e.hermegauss(21)
    for one in fleet.flights.values():
        flight = sepcal.read(one.log.file)
        velocity = np.array([flight[f"v{axis}_mps"] for axis in "ned"])
        centre = np.array([one.factor.own["w_n"], one.factor.own["w_e"]])
        air = velocity - np.array([*centre, 0.0])[:, None]
        slopes = -s_va * (air / np.linalg.norm(air, axis=0))[:2].T
        beyond = 1.0 - np.linalg.lstsq(slopes, np.ones(len(slopes)), rcond=None)[0] @ slopes.T
        scale = np.linalg.norm(beyond) / np.asarray(one.factor.triangle)[0, 0]
        root = np.linalg.cholesky(scale**2 * np.linalg.inv(slopes.T @ slopes)) * 1.5
        winds = centre + np.array([[i, j] for i in nodes for j in nodes]) @ root.T
        log_weight = np.log(np.outer(weights, weights)).ravel() + 0.5 * np.array(
            [i**2 + j**2 for i in nodes for j in nodes]
        )
        logs = []
        for wind in winds:
            speed = np.linalg.norm(velocity - np.array([*wind, 0.0])[:, None], axis=0)
            left = flight["airspeed_mps"] - s_va * speed
            squares = np.sum(left**2) - 2 * c * left.sum() + len(left) * c**2
            logs.append(-0.5 * squares / scale**2)
        of_vehicles[one.log.vehicle] += logsumexp(np.array(logs) + log_weight[:, None], axis=0)

    def restricted(log_tau: float) -> float:
        tau = np.exp(log_tau)
        kernel = -0.5 * ((c[:, None] - c) / tau) ** 2 - log_tau  # mean, c
        total = sum(logsumexp(log + kernel, axis=1) for log in of_vehicles.values())
        return -float(logsumexp(total))

    best = minimize_scalar(restricted, bounds=np.log([0.03, 1.0]), method="bounded")
    asked = [one.asked() for one in fleet.flights.values()]
    found = _core.fit_population(asked, False, np.ones(1))
    assert np.sqrt(np.asarray(found.spread)[0, 0]) == pytest.approx(np.exp(best.x), rel=2e-3)
