# SPDX-License-Identifier: BSD-3-Clause
"""Which standard error is believed, beside a jackknife by SciPy, and what an exact fit is called.

The readings are drawn by NumPy here; recorded.py says where recorded ones are.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import sepcal
from apps import Log, run
from jackknife import delete_a_block
from oracle.attitude_independent_magnetometer import AttitudeIndependentMagnetometer
from oracle.pitot_static import PitotStatic
from recorded import find_case, find_fixture

Array = NDArray[np.float64]
STRENGTH = 48.0  # of the field [uT]
MATRIX = np.array([[0.83, 0.015, 0.01], [0.022, 0.56, 0.05], [0.006, 0.02, 1.24]])
BIAS = np.array([30.0, -12.0, 8.0])
LEAST, MOST = 0.6, 1.7  # of a jackknife's error


def tumble(rng: np.random.Generator, rows: int, rate: float) -> Array:
    """The field's direction in the axes of a body that turns at random, (rows, 3)."""
    attitude = Rotation.identity()
    directions = []
    for step in rng.normal(scale=rate, size=(rows, 3)):
        attitude = attitude * Rotation.from_rotvec(step)
        directions.append(attitude.inv().apply([0.0, 0.0, 1.0]))
    return np.array(directions)


def tumbled(seed: int, rows: int = 570, noise: float = 2.1) -> sepcal.Flight:
    """Readings far from a sphere, in white noise of a twentieth of the field."""
    rng = np.random.default_rng(seed)
    field = STRENGTH * tumble(rng, rows, 1.5)
    return as_flight(field @ MATRIX.T + BIAS + noise * rng.standard_normal((rows, 3)))


def as_flight(readings: Array, **others: Array) -> sepcal.Flight:
    columns = {f"m{axis}_ut": readings[:, at] for at, axis in enumerate("xyz")}
    return sepcal.Flight({"time_s": 0.8 * np.arange(len(readings)), **columns, **others})


def by_strength(readings: sepcal.Flight, **options: Any) -> sepcal.Calibration:
    return sepcal.fit(sepcal.Magnetometer(field_strength=STRENGTH), readings, **options)


@pytest.mark.parametrize("seed", range(5))
def test_white_noise_is_not_believed_to_be_slow(seed: int):
    """Columns made of noisy readings once made a likelihood see a level of 27 times the error."""
    flight = tumbled(seed)
    fit = by_strength(flight)
    assert fit.status == "converged"
    model = AttitudeIndependentMagnetometer(STRENGTH, fit.to_dict()["options"]["field_noise"])
    record = {f"m{axis}": np.array(flight[f"m{axis}_ut"]) for axis in "xyz"}
    start = np.array([fit[name].value for name in model.nonlinear])
    expected = delete_a_block(model, record, np.zeros((1, 570)), start, range(9), 20)
    stated = np.array([fit[name].standard_error for name in model.nonlinear])
    assert np.all((stated / expected > LEAST) & (stated / expected < MOST))


def test_a_recorded_tumble_is_determined(tmp_path: Path):
    file = find_case("f1_tumble_570rows.csv")
    fitted = run("sepcal-mag", "fit", file, "--field-strength", "1300", "--json", folder=tmp_path)
    assert fitted.code == 0
    result = fitted.result
    assert result["status"] == "converged"
    for name, centre in (("n_x", 6160.3), ("n_y", 249.6), ("n_z", 3446.9)):
        parameter = result["parameters"][name]
        assert abs(parameter["value"] - centre) < 2.0 * parameter["standard_error"]
        assert 0.6 * 5.8 < parameter["standard_error"] < 1.7 * 5.8


def test_a_recorded_tube_is_beside_its_jackknife(tmp_path: Path):
    file = find_fixture("uav_pitot_static_2022_05_07_11.csv")
    result = run("sepcal-pitot", "fit", file, "--json", folder=tmp_path).result
    log = Log(file)
    record = {header: log.column(f"{header}_mps") for header in ("vn", "ve", "vd", "airspeed")}
    names = ("s_va", "c_va", "w_n", "w_e")
    start = np.array([*(result["parameters"][name]["value"] for name in names), 0.0])
    readings = record["airspeed"][np.newaxis]
    expected = delete_a_block(PitotStatic(), record, readings, start, range(4), 20)
    for name, error in zip(names, expected, strict=True):
        assert LEAST < result["parameters"][name]["standard_error"] / error < MOST


@pytest.mark.parametrize("mount", ["internal", "external"])
def test_a_recorded_compass_is_beside_its_jackknife(mount: str):
    """Twenty blocks of a flight of 38 s, each left out in turn; what is at a bound has no error."""
    blocks = 20
    compass = sepcal.Magnetometer(field=(19.72, -1.41, 49.44))
    flight = sepcal.read_csv(find_fixture(f"octocopter_{mount}_mag.csv"))
    fit = sepcal.fit(compass, flight)
    names = [name for name in fit.parameters if not fit[name].at_bound]
    columns = {header: np.asarray(flight[header]) for header in flight}
    rows = len(columns["time_s"])
    estimates = []
    for left_out in np.array_split(np.arange(rows), blocks):
        rest = {header: np.delete(column, left_out) for header, column in columns.items()}
        again = sepcal.fit(compass, sepcal.Flight(rest))
        estimates.append([again[name].value for name in names])
    expected = np.std(estimates, axis=0) * np.sqrt(blocks - 1)
    stated = np.array([fit[name].standard_error for name in names])
    assert np.all((stated / expected > LEAST) & (stated / expected < MOST))


@pytest.mark.parametrize("seed", range(3))
def test_as_many_parameters_as_readings_are_not_identifiable(seed: int):
    fit = by_strength(tumbled(seed, rows=9, noise=0.2))
    assert fit.status == "not_identifiable"
    assert "9 measurements for 9 parameters leave nothing to judge the fit by" in fit.message
    assert "leave nothing" not in by_strength(tumbled(seed, rows=60, noise=0.2)).message


@pytest.mark.parametrize("seed", range(3))
def test_a_default_bound_does_not_decide(seed: int):
    """Semi-axes of 0.64 to 1.6 fields: lambda_z is bound to 0.5 by default."""
    rng = np.random.default_rng(seed)
    scale = np.array([0.97, 0.64, 1.61])
    field = STRENGTH * tumble(rng, 800, 0.5)
    flight = as_flight(field * scale + BIAS + 0.05 * rng.standard_normal((800, 3)))
    fit = by_strength(flight)
    assert fit.status == "converged"
    for name, value in zip(("lambda_x", "lambda_y", "lambda_z"), scale - 1.0, strict=True):
        assert abs(fit[name].value - value) < 4.0 * fit[name].standard_error
    assert "lambda_z ended at its default bound of 0.5" in fit.message
    given = by_strength(flight, bounds={"lambda_z": (-0.5, 2.5)})
    assert given["lambda_z"].value == pytest.approx(fit["lambda_z"].value, abs=1e-9)
    assert "default bound" not in given.message
    held = by_strength(flight, bounds={"lambda_z": (-0.5, 0.5)})  # a bound that was given is kept
    assert held["lambda_z"].at_bound


@pytest.mark.parametrize("seed", range(3))
def test_a_sensor_that_is_turned_far(seed: int):
    """By 35 degrees about z: eta_z becomes their tangent, which is beyond the default of 0.5."""
    rng = np.random.default_rng(seed)
    turn = np.radians(35.0)
    rows = 1500
    yaw = np.cumsum(0.03 * np.ones(rows)) + rng.uniform(0, 6)
    roll, pitch = (
        0.5 * np.sin(rate * np.arange(rows) + rng.uniform(0, 6)) for rate in (0.05, 0.07)
    )
    attitude = Rotation.from_euler("ZYX", np.stack([yaw, pitch, roll], axis=-1))
    field = np.array([19.7, -1.4, 49.4])
    mounting = Rotation.from_euler("z", turn)
    readings = mounting.inv().apply(attitude.inv().apply(field)) + BIAS
    readings += 0.2 * rng.standard_normal((rows, 3))
    flight = as_flight(
        readings, roll_rad=roll, pitch_rad=pitch, yaw_rad=np.arctan2(np.sin(yaw), np.cos(yaw))
    )
    fit = sepcal.fit(sepcal.Magnetometer(field=tuple(field)), flight)
    assert fit.status == "converged"
    assert max(fit.rmse.values()) < 0.22
    assert abs(fit["eta_z"].value) == pytest.approx(np.tan(turn), abs=0.005)
    assert "eta_z ended at its default bound" in fit.message
