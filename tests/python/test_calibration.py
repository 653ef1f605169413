# SPDX-License-Identifier: BSD-3-Clause
"""Calibrations in Python: fitted on a flight, compared, applied, saved; and simulated flights."""

import json
import pickle
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import sepcal

PROBE = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))


@pytest.fixture(scope="module")
def flight() -> sepcal.SimulatedFlight:
    """A short flight of the probe."""
    return sepcal.simulate(PROBE, rows=400, seed=1)


@pytest.fixture(scope="module")
def base(flight: sepcal.SimulatedFlight) -> sepcal.Calibration:
    """The probe fitted on it."""
    return sepcal.fit(PROBE, flight)


def test_options_stand_in_the_calibration(flight: sepcal.SimulatedFlight) -> None:
    """All at once, none at its default; `fixed` is the app's --fix."""
    options = {
        "effects": ["airspeed_scale[beta^2]", "heading_bias"],
        "bounds": {"b_va": (-5.0, 5.0)},
        "fix": {"w_d": 0.3},
        "noise": {"vn": 0.1, "ve": 0.2, "vd": 0.3},
        "prior": {"eps_phi": (0.01, 0.02), "b_va": (0.0, 3.0)},
        "start": {"eps_phi": 0.01},
        "search": "global",
        "screens": {"t_1": 1e3, "t_2": 1e4, "l_2": 2.0, "convex": False},
        "jacobian": "golub_pereyra",
        "loss": "huber",
        "loss_width": 1.5,
        "sampling_distribution": {"b_beta": (0.01, 0.02)},
        "stage_one_segments": "popu,wind_circle_1",
        "stage_two_segments": "0:100",
        "samples": 20,
        "sampling": "low_discrepancy",
        "seed": 2**64 - 1,
        "second_stage": "joint",
        "noise_tolerance": 0.05,
        "noise_iterations": 7,
        "iterations": 150,
        "descents": 3,
        "coloured_errors": False,
        "map": {"vn_mps": "vn_mps"},
        "ignore": ["altitude_m"],
        "where": "vn_mps < 1e3",
        "from_time": -1.0,
        "to_time": 1e5,
        "threads": 2,
        "free": ("w_n",),
        "drop_invalid": True,
        "drop_repeats": ("vn_mps",),
        "delimiter": ";",
        "decimal": ".",
        "join": "linear",
        "smooth_inputs": True,
    }
    of_states = {"process_noise", "method", "hessian"}  # tests/python/test_aircraft.py
    assert set(options) == set(sepcal.FitOptions.__annotations__) - of_states
    stored = sepcal.fit(PROBE, flight, **options).to_dict()["options"]
    stored["effects"] = [effect["name"] for effect in stored["effects"]]
    options["samples"] = 0  # with a start nothing is sampled
    for name, value in options.items():
        assert stored[name] == json.loads(json.dumps(value)), name


def test_a_calibration_finds_the_truth(
    base: sepcal.Calibration, flight: sepcal.SimulatedFlight
) -> None:
    """Within 4.5 standard errors: with other seeds wrong once in 15,000 flights of ten."""
    assert base.status == "converged"
    assert base.names == PROBE.parameters
    for name, truth in flight.truth.items():
        assert abs(base[name].value - truth) < 4.5 * base[name].standard_error


def test_a_calibration_is_its_fit(base: sepcal.Calibration) -> None:
    assert isinstance(base, sepcal.Fit)
    assert type(base.fit) is sepcal.Fit
    assert str(base.fit) == str(base)
    assert base.fit.parameters == base.parameters


def test_the_table_says_it_all(base: sepcal.Calibration) -> None:
    lines = str(base).splitlines()
    assert lines[:3] == ["five-hole: 400 of 400 rows of simulated flight", "status: converged", ""]
    assert lines[3].split() == ["parameter", "value", "std.", "error", "white", "unit", "bounds"]
    for line, parameter in zip(lines[4:], base.parameters.values(), strict=False):
        name, value, error, white, unit = line.partition("[")[0].split()
        assert (name, unit) == (parameter.name, parameter.unit)
        assert float(value) == pytest.approx(parameter.value, rel=1e-5)
        assert float(error) == pytest.approx(parameter.standard_error, rel=0.06)
        assert float(white) == pytest.approx(parameter.standard_error_white, rel=0.06)
    assert any(f"; stage two: {base.second_stage}, " in line for line in lines)
    assert lines[-1] == f"wind: {base.restated['wind']['sentence']}"


def test_a_calibration_saves_and_loads(base: sepcal.Calibration, tmp_path: Path) -> None:
    base.save(tmp_path / "base.json")
    loaded = sepcal.load(tmp_path / "base.json")
    assert (tmp_path / "base.json").read_text() == base.to_json() == loaded.to_json()
    assert base.to_dict() == json.loads(base.to_json())
    assert loaded.parameters == base.parameters
    assert loaded.flight is None
    assert_allclose(loaded.covariance, base.covariance, rtol=1e-12)
    white = np.diag(base.covariance_white)
    assert_allclose(np.diag(loaded.covariance_white), white, rtol=1e-12)
    assert np.isnan(loaded.covariance_white).sum() == len(white) * (len(white) - 1)
    assert pickle.loads(pickle.dumps(base)).to_json() == base.to_json()


def test_compare_measures_the_residuals(
    base: sepcal.Calibration, flight: sepcal.SimulatedFlight, tmp_path: Path
) -> None:
    """Against A xi1 + b of the model itself, and NumPy's means."""
    comparison = base.compare()
    names = {name: f"{name}_{unit}" for name, unit in [("rho", "kgpm3"), *UNITS_OF_INPUTS]}
    A, b = PROBE.evaluate({name: flight[header] for name, header in names.items()}, base.values[5:])
    z = np.column_stack([flight[f"{name}_mps"] for name in PROBE.outputs])
    residuals = z - A @ base.values[:5] - b
    assert_allclose(comparison.residuals, residuals, rtol=0, atol=1e-12)
    assert_array_equal(comparison.time, flight["time_s"])

    labels = np.array(flight.maneuvers)
    assert [misfit.output for misfit in comparison.overall] == list(PROBE.outputs)
    assert {misfit.segment for misfit in comparison.where} == set(labels)
    for misfit in comparison.where:
        at = residuals[labels == misfit.segment, PROBE.outputs.index(misfit.output)]
        assert misfit.rows == at.size
        assert misfit.unit == "m/s"
        assert misfit.rmse == pytest.approx(np.sqrt(np.mean(at**2)), rel=1e-9)
        assert misfit.mean == pytest.approx(np.mean(at), abs=1e-12)
    assert comparison.to_dict() == json.loads(comparison.to_json())
    table = str(comparison).splitlines()[3:]
    rows = [(*misfit.segment.split(), misfit.output) for misfit in comparison.where]
    for line, row in zip(table[1:], rows, strict=False):
        assert tuple(line.split()[: len(row)]) == row
    assert [line.split()[0] for line in table[1 + len(rows) :][:3]] == ["all"] * 3

    base.save(tmp_path / "base.json")
    elsewhere = sepcal.load(tmp_path / "base.json").compare(flight)
    assert_array_equal(elsewhere.residuals, comparison.residuals)


UNITS_OF_INPUTS = [
    *((name, "rad") for name in ("roll", "pitch", "yaw")),
    *((name, "radps") for name in ("p", "q", "r")),
    *((name, "pa") for name in ("pt", "ps", "dpa", "dpb")),
]


def test_apply_corrects_the_readings(
    base: sepcal.Calibration, flight: sepcal.SimulatedFlight
) -> None:
    """The corrected airspeed by the definition of lambda_va and b_va; all by header."""
    corrected = base.apply(flight)
    assert list(corrected) == ["airspeed_cal_mps", "alpha_cal_rad", "beta_cal_rad"]
    read = np.sqrt(2 * (flight["pt_pa"] - flight["ps_pa"]) / flight["rho_kgpm3"])
    expected = (1 + base["lambda_va"].value) * read + base["b_va"].value
    assert_allclose(corrected["airspeed_cal_mps"], expected, rtol=1e-14)


def test_apply_writes_a_file(base: sepcal.Calibration, tmp_path: Path) -> None:
    log, output = tmp_path / "log.csv", tmp_path / "corrected.csv"
    log.write_text("pt_pa,ps_pa,dpa_pa,dpb_pa,rho_kgpm3\n95180,95000,60,-9,1.2\n94000,95000,0,0,1.2\n"
                   + "95190,95000,60,9,1.2\n" * 8)  # fmt: skip
    applied = base.apply_to_file(log, output)
    assert (applied.rows, applied.rows_left_empty) == (10, 1)
    assert applied.headers == ["airspeed_cal_mps", "alpha_cal_rad", "beta_cal_rad"]
    written, corrected = sepcal.read_csv(output), base.apply(sepcal.read_csv(log))
    assert_array_equal(written["pt_pa"], sepcal.read_csv(log)["pt_pa"])
    for header, values in corrected.items():
        assert np.isnan(values).tolist() == [False, True] + [False] * 8
        assert_array_equal(written[header], values)


# --- simulation


def test_simulate_takes_truth_and_noise() -> None:
    flight = sepcal.simulate("five-hole", parameters={"w_n": 7.0}, noise={"vn": 1e-9}, rows=300)
    assert flight.truth["w_n"] == 7.0
    assert flight.truth["w_e"] == 2.4
    assert flight.rows == 300
    fit = sepcal.fit(PROBE, flight)
    assert fit["w_n"].value == pytest.approx(7.0, abs=0.1)
    assert fit.rmse["vn"] < fit.rmse["ve"]


def test_simulate_flies_the_probe_that_it_is_given() -> None:
    field = (25.0, 3.0, -40.0)
    flight = sepcal.simulate(sepcal.Magnetometer(field=field), rows=300)
    logged = [np.unique(flight[name]) for name in ("bn_ut", "be_ut", "bd_ut")]
    assert np.ravel(logged).tolist() == list(field)
    weak = sepcal.simulate(sepcal.FiveHoleProbe(k_alpha=2.25, k_beta=4.5), rows=300)
    strong = sepcal.simulate(sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5), rows=300)
    assert_allclose(strong["dpa_pa"], 2 * weak["dpa_pa"], rtol=1e-12)
    assert_array_equal(strong["dpb_pa"], weak["dpb_pa"])


def test_a_prior_of_an_effect() -> None:
    """Where stage one holds the coefficient, the prior waits for stage two."""
    flight = sepcal.simulate("pitot-static", rows=300, seed=3, hide={"pressure_offset": 30})
    known = sepcal.fit(
        sepcal.PitotStatic(), flight, effects=["pressure_offset"],
        prior={"pressure_offset.s": (30.0, 1e-3)},
    )["pressure_offset.s"]  # fmt: skip
    assert known.value == pytest.approx(30.0, abs=1e-5)  # a flight tells it to 11 Pa
    assert known.standard_error == pytest.approx(1e-3, rel=1e-3)
