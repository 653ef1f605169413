# SPDX-License-Identifier: BSD-3-Clause
"""fit_many(): several flights jointly, here, on threads and on processes."""

from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest
from scipy.optimize import least_squares

import sepcal
from fleet_flights import (
    PROBE,
    WIND,
    Interrupted,
    check_same,
    simulate_flight,
    write_fleet,
    write_log,
)
from own_models import WindBox
from sepcal import many_workers


def waves(count=4, rows=60):
    """Another c in each flight of (1 + a) cos(eta + b) + c."""
    generator = np.random.default_rng(3)
    flights = {}
    for index in range(count):
        eta = generator.uniform(-3, 3, rows + 10 * index)
        z = 1.3 * np.cos(eta + 0.2) + index + 0.1 * generator.normal(size=eta.size)
        flights[f"wave {index}"] = {"eta": eta, "z": z}
    return flights


def test_a_joint_fit_is_scipys_of_the_stacked_problem():
    flights = waves()
    fit = sepcal.fit_many(sepcal.ScalarExample1(), flights, own=["c"])
    assert fit.status == "converged"

    def residuals(x):
        return np.concatenate(
            [
                wave["z"] - (1 + x[0]) * np.cos(wave["eta"] + x[1]) - x[2 + index]
                for index, wave in enumerate(flights.values())
            ]
        )

    found = least_squares(residuals, [0.0, 0.0, 0, 1, 2, 3], xtol=1e-15, ftol=1e-15, gtol=1e-15)
    rows, n = found.fun.size, found.x.size
    covariance = np.linalg.inv(found.jac.T @ found.jac) * (found.fun @ found.fun) / (rows - n)
    errors = np.sqrt(np.diag(covariance))
    estimates = [fit["a"], fit["b"], *(flight["c"] for flight in fit.flights.values())]
    assert [one.value for one in estimates] == pytest.approx(found.x, abs=1e-7 * errors.min())
    assert [one.standard_error_white for one in estimates] == pytest.approx(errors, rel=1e-6)
    assert fit.covariance_white == pytest.approx(covariance[:2, :2], rel=1e-6)
    assert fit.rows == rows
    assert fit.rmse["z"] == pytest.approx(np.sqrt(np.mean(found.fun**2)), rel=1e-9)


def test_files_flights_and_columns_give_the_same(tmp_path):
    files = write_fleet(tmp_path, 4)
    expected = sepcal.fit_many(PROBE, files, own=WIND)
    assert expected.status == "converged"
    assert list(expected.flights) == [str(file) for file in files]
    for index, flight in enumerate(expected.flights.values()):
        truth = simulate_flight(index).truth
        for name in WIND:
            assert abs(flight[name].value - truth[name]) < 5 * flight[name].standard_error
    names = list(expected.flights)
    loaded = {name: sepcal.read_csv(name) for name in names}
    check_same(sepcal.fit_many(PROBE, loaded, own=WIND), expected)
    check_same(sepcal.fit_many(PROBE, list(loaded.values()), own=WIND), expected)
    arrays = [sepcal.Flight(dict(simulate_flight(i))) for i in range(4)]
    in_memory = dict(zip(names, arrays, strict=True))
    check_same(sepcal.fit_many(PROBE, in_memory, own=WIND, threads=1), expected)
    assert not many_workers.PREPARED._flights


def test_threads_and_processes_give_the_same_as_one(tmp_path):
    flights = {file.name: file for file in write_fleet(tmp_path, 6)}
    in_memory = {name: sepcal.read_csv(file) for name, file in flights.items()}
    expected = sepcal.fit_many(PROBE, flights, own=WIND, threads=1)
    check_same(sepcal.fit_many(PROBE, flights, own=WIND, threads=3), expected)
    with ThreadPoolExecutor(2) as threads:
        check_same(sepcal.fit_many(PROBE, flights, own=WIND, executor=threads), expected)
    with ProcessPoolExecutor(2) as processes:
        check_same(sepcal.fit_many(PROBE, flights, own=WIND, executor=processes), expected)
        check_same(sepcal.fit_many(PROBE, in_memory, own=WIND, executor=processes), expected)


def test_a_worker_that_forgot_everything_prepares_again(tmp_path, monkeypatch):
    flights = write_fleet(tmp_path, 3)
    expected = sepcal.fit_many(PROBE, flights, own=WIND)
    monkeypatch.setattr(many_workers, "MOST_CELLS", 1)
    check_same(sepcal.fit_many(PROBE, flights, own=WIND), expected)
    in_memory = {str(file): sepcal.read_csv(file) for file in flights}
    check_same(sepcal.fit_many(PROBE, in_memory, own=WIND), expected)


def test_a_log_that_changes_on_the_way_is_noticed(tmp_path, monkeypatch):
    flights = write_fleet(tmp_path, 3)
    monkeypatch.setattr(many_workers, "MOST_CELLS", 1)

    def change():
        flights[1].write_text(flights[1].read_text().replace("0.5", "0.6"))

    with (
        ThreadPoolExecutor(1) as threads,
        pytest.raises(sepcal.Error, match=r"001.csv' was changed while it was being fitted"),
    ):
        sepcal.fit_many(PROBE, flights, own=WIND, executor=Interrupted(threads, 5, change))


def test_a_bad_log_is_named_or_left_out(tmp_path):
    flights = write_fleet(tmp_path, 4)
    bad = tmp_path / "bad.csv"
    bad.write_text(flights[0].read_text().replace("pt_pa", "pt_q", 1))
    missing = tmp_path / "missing.csv"
    with pytest.raises(
        sepcal.Error, match=r"flight '.*bad\.csv' can't be used: .*pt.* \(leave_out\)$"
    ):
        sepcal.fit_many(PROBE, [*flights, bad], own=WIND)
    with pytest.raises(sepcal.Error, match=r"and 1 more of 6"):
        sepcal.fit_many(PROBE, [*flights, bad, missing], own=WIND)
    fit = sepcal.fit_many(PROBE, [bad, *flights, missing], own=WIND, leave_out=True)
    assert list(fit.left_out) == [str(bad), str(missing)]
    assert "pt" in fit.left_out[str(bad)]
    assert "bad.csv is left out: " in str(fit)
    without = sepcal.fit_many(PROBE, flights, own=WIND)
    assert fit.covariance.tobytes() == without.covariance.tobytes()
    assert list(fit.flights) == list(without.flights)


def test_a_departed_vehicle_is_found():
    flights = {f"vehicle {i}": simulate_flight(i, 200) for i in range(12)}
    fit = sepcal.fit_many(PROBE, flights, own=WIND)
    assert fit.departed() == []
    size = 6 * fit.flights["vehicle 7"].departure.standard_error["b_alpha"]
    bent = flights["vehicle 7"].truth["b_alpha"] + size
    flights["vehicle 7"] = simulate_flight(7, 200, b_alpha=bent)
    fit = sepcal.fit_many(PROBE, flights, own=WIND)
    assert fit.departed() == ["vehicle 7"]
    departure = fit.flights["vehicle 7"].departure
    assert departure.largest == "b_alpha"
    assert abs(departure.difference["b_alpha"] - size) < 4 * departure.standard_error["b_alpha"]
    assert "vehicle 7 departs from the others: p" in str(fit)


def wind_flights(count=3):
    flights = []
    for index in range(count):
        generator = np.random.default_rng(index)
        v, psi = generator.uniform(15, 30, 80), generator.uniform(-3, 3, 80)
        noise = 0.1 * generator.normal(size=(2, 80))
        flights.append(
            {
                "v": v,
                "psi": psi,
                "vn": 1.1 * v * np.cos(psi + 0.1) + index + noise[0],
                "ve": 1.1 * v * np.sin(psi + 0.1) - index + noise[1],
            }
        )
    return flights


def test_a_model_in_python():
    fit = sepcal.fit_many(WindBox(), wind_flights(), own=["w_n", "w_e"])
    assert fit.status == "converged"
    assert list(fit.flights) == ["flight 0", "flight 1", "flight 2"]
    assert fit["k"].value == pytest.approx(1.1, abs=0.005)
    assert fit.flights["flight 2"]["w_e"].value == pytest.approx(-2, abs=0.1)


class Broken(WindBox):
    """Raises in one of the flights."""

    def at(self, u, xi2):
        """As WindBox's."""
        if len(u.v) == 79:
            raise RuntimeError("broken at 79 rows")
        return super().at(u, xi2)


def test_an_exception_of_a_model_in_python_passes_as_it_is():
    flights = wind_flights()
    flights[1] = {name: column[:79] for name, column in flights[1].items()}
    with pytest.raises(RuntimeError, match="broken at 79 rows"):
        sepcal.fit_many(Broken(), flights, own=["w_n", "w_e"])


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"own": ["wind"]}, "own: there is no parameter 'wind'; the model has: a, c, b"),
        ({"own": "c"}, r"own is 'c'; give a list of names, \['c'\]"),
        ({"own": ["c", "c"]}, "own: 'c' stands there twice"),
        ({"own": ["a", "b", "c"]}, "nothing joins the flights"),
        ({"own": ["c"], "fix": {"c": 1.0}}, "own 'c' is fixed"),
        ({"flights": []}, "there are no flights to fit"),
        ({"flights": "a.csv"}, "flights is one flight"),
        ({"flights": 3}, "flights is a int"),
        ({"flights": [{"eta": [0.0] * 9}]}, "flight 'flight 0' can't be used: .*'z' is missing"),
        ({"flights": ["a.csv"]}, "a.csv"),
        ({"effects": ["a[eta]"]}, "fit_many.. takes no effects"),
        ({"executor": 3}, "executor is a int"),
        ({"free": ["b"]}, "free is for sepcal's own probes"),
    ],
)
def test_misuse_is_refused(change, text):
    arguments = {"model": sepcal.ScalarExample1(), "flights": waves(), "own": ["c"], **change}
    with pytest.raises(sepcal.Error, match=text):
        sepcal.fit_many(**arguments)


def test_a_pool_that_was_shut_down_is_said_to_be():
    with ThreadPoolExecutor(1) as pool:
        pass
    with pytest.raises(sepcal.Error, match="was shut down before the work was done"):
        sepcal.fit_many(sepcal.ScalarExample1(), waves(), own=["c"], executor=pool)


def test_options_that_there_are_not():
    with pytest.raises(TypeError, match="has no option 'sample'"):
        sepcal.fit_many(sepcal.ScalarExample1(), waves(), own=["c"], sample=3)


def test_names_that_there_are_not():
    fit = sepcal.fit_many(sepcal.ScalarExample1(), waves(), own=["c"])
    with pytest.raises(KeyError, match="no shared parameter 'c'; the fit has: a, b"):
        fit["c"]
    with pytest.raises(KeyError, match="no own parameter 'a'; the flight has: c"):
        fit.flights["wave 0"]["a"]


def test_a_probe_that_depends_on_its_own_noise_is_refused():
    flight = sepcal.simulate("magnetometer", rows=200)
    with pytest.raises(sepcal.Error, match="depends on its own noise"):
        sepcal.fit_many(sepcal.Magnetometer(field_strength=50.0), [flight, flight])


def test_what_a_probe_holds_stays_held_unless_freed():
    flights = [
        sepcal.simulate("pitot-static", rows=300, seed=seed, parameters={"w_n": 2.0 * seed})
        for seed in range(3)
    ]
    fit = sepcal.fit_many(sepcal.PitotStatic(), flights, own=["w_n", "w_e"])
    assert fit["w_d"].fixed
    with pytest.raises(sepcal.Error, match="own 'w_d' is fixed"):
        sepcal.fit_many(sepcal.PitotStatic(), flights, own=WIND)
    for seed, flight in enumerate(fit.flights.values()):
        assert flight["w_n"].value == pytest.approx(2.0 * seed, abs=1.0)


def test_duplicate_names_in_a_list(tmp_path):
    file = write_log(simulate_flight(0), tmp_path / "a.csv")
    with pytest.raises(sepcal.Error, match=r"two flights are called '.*a\.csv'"):
        sepcal.fit_many(PROBE, [file, file], own=WIND)
