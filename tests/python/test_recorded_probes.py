# SPDX-License-Identifier: BSD-3-Clause
"""Recorded flights of tubes and of a magnetometer without attitude, each beside SciPy's answer.

recorded.py says where they are; skipped where they are not.
"""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import OptimizeResult, least_squares

from apps import Log, Outcome, run
from oracle.attitude_independent_magnetometer import AttitudeIndependentMagnetometer
from oracle.pitot_static import PitotStatic
from recorded import find_fixture

TUBE = ("s_va", "c_va", "w_n", "w_e")


def fit_tube(name: str, folder: Path) -> tuple[dict[str, Any], OptimizeResult]:
    """The app's fit and SciPy's, w_d held at zero in both."""
    file = find_fixture(name)
    fitted = run("sepcal-pitot", "fit", file, "--json", folder=folder)
    assert fitted.code == 0, fitted.err
    log = Log(file)
    record = {header: log.column(f"{header}_mps") for header in ("vn", "ve", "vd", "airspeed")}

    def residual(xi: np.ndarray) -> np.ndarray:
        return record["airspeed"] - PitotStatic().predict(record, np.append(xi, 0.0))[0]

    def jacobian(xi: np.ndarray) -> np.ndarray:
        return -PitotStatic().jacobian(record, np.append(xi, 0.0))[0, :, :4]

    tight = 1e-15
    expected = least_squares(
        residual, [1.0, 0.0, 0.0, 0.0], jacobian, xtol=tight, ftol=tight, gtol=tight
    )
    return fitted.result, expected


def standard_errors(expected: OptimizeResult) -> np.ndarray:
    variance = 2 * expected.cost / (expected.fun.size - expected.x.size)
    return np.sqrt(variance * np.diag(np.linalg.inv(expected.jac.T @ expected.jac)))


@pytest.mark.parametrize(
    ("name", "rmse"),
    [
        ("uav_pitot_static_2022_05_07_11.csv", 0.853),  # [m/s]; an independent trial saw 0.85
        ("airliner_mode_s.csv", 4.62),  # a constant wind leaves 4.6 m/s, said the trial
        ("rv_deceleration_stall.csv", 0.265),
    ],
)
def test_a_tube_is_scipys(tmp_path: Path, name: str, rmse: float):
    result, expected = fit_tube(name, tmp_path)
    errors = standard_errors(expected)
    for parameter, value, error in zip(TUBE, expected.x, errors, strict=True):
        entry = result["parameters"][parameter]
        assert abs(entry["value"] - value) < 1e-4 * error  # SciPy stops that far from the minimum
        assert entry["standard_error_white"] == pytest.approx(error, rel=1e-5)
    assert result["rmse"]["airspeed"] == pytest.approx(rmse, rel=2e-3)
    assert result["stage_one"]["minima"][0]["xi2"]["w_n"] == pytest.approx(
        result["parameters"]["w_n"]["value"], abs=1e-6
    )


def test_one_heading_names_what_is_hard_to_tell_apart(tmp_path: Path):
    """A deceleration to the north: the wind along the track, w_n, against scale and bias."""
    result, expected = fit_tube("rv_deceleration_stall.csv", tmp_path)
    columns = expected.jac / np.linalg.norm(expected.jac, axis=0)
    assert np.linalg.cond(columns) > 50  # 174: what sepcal calls weak
    assert [set(entry["parameters"]) for entry in result["weak"]] == [{"w_n", "c_va", "s_va"}]
    assert "w_n, c_va and s_va are hard to tell apart" in result["message"]


def fit_strength(name: str, strength: float, folder: Path) -> Outcome:
    options = ("--field-strength", str(strength), "--json", "-o", "norm.json")
    return run("sepcal-mag", "fit", find_fixture(name), *options, folder=folder)


def test_a_bench_without_attitude(tmp_path: Path):
    """Turned by hand through the sphere: 0.8 % of the strength is left; the minimum is SciPy's."""
    fitted = fit_strength("bench_tilt_sphere_mag.csv", 48, tmp_path)
    assert fitted.code == 0
    assert [line.split(": ")[2].split(";")[0] for line in fitted.err.splitlines()] == [
        "time_s comes in bursts"
    ]
    result = fitted.result
    assert result["status"] == "converged"
    log = Log(find_fixture("bench_tilt_sphere_mag.csv"))
    record = {f"m{axis}": 100 * log.column(f"m{axis}_gauss") for axis in "xyz"}
    model = AttitudeIndependentMagnetometer(48, result["options"]["field_noise"])
    start = np.zeros(9)
    start[6:] = [np.mean([record[name].max(), record[name].min()]) for name in record]
    tight = 1e-15
    expected = least_squares(
        lambda xi: -model.predict(record, xi)[0],
        start,
        lambda xi: -model.jacobian(record, xi)[0],
        xtol=tight,
        ftol=tight,
        gtol=tight,
        x_scale="jac",
    )
    errors = standard_errors(expected)
    for parameter, value, error in zip(model.nonlinear, expected.x, errors, strict=True):
        entry = result["parameters"][parameter]
        assert abs(entry["value"] - value) < 1e-4 * error
        assert entry["standard_error_white"] == pytest.approx(error, rel=1e-4)
    assert model.noise == pytest.approx(result["noise"]["field"], rel=1e-9)

    applied = run(
        "sepcal-mag", "apply", find_fixture("bench_tilt_sphere_mag.csv"), "norm.json",
        "-o", "out.csv", folder=tmp_path,
    )  # fmt: skip
    assert applied.code == 0
    corrected = Log(tmp_path / "out.csv")
    strength = np.linalg.norm([corrected.column(f"m{axis}_cal_ut") for axis in "xyz"], axis=0)
    assert np.sqrt(np.mean((strength / 48 - 1) ** 2)) == pytest.approx(0.008, rel=0.05)


@pytest.mark.parametrize("mount", ["internal", "external"])
def test_a_flight_near_level_is_no_calibration(tmp_path: Path, mount: str):
    """Within 16 deg of level the strength alone determines next to nothing, and sepcal says so."""
    fitted = fit_strength(f"octocopter_{mount}_mag.csv", 53.25, tmp_path)
    assert fitted.code in (4, 5)
    assert len(fitted.result["unobservable"]) >= 3
    # Open, or where the minimisation ends without a minimum, on three bounds, weak.
    assert re.search("can't be told apart|hard to tell apart", fitted.result["message"])


@pytest.mark.parametrize(("strength", "code"), [(0.48, 2), (4800, 2), (100, 4)])
def test_a_strength_that_does_not_fit_the_readings(tmp_path: Path, strength: float, code: int):
    """100 uT is within the bounds on average and beyond them for one axis."""
    refused = fit_strength("bench_tilt_sphere_mag.csv", strength, tmp_path)
    assert refused.code == code
    if code == 2:
        assert "check the unit in the headers" in refused.err
        assert list(tmp_path.iterdir()) == []
    else:
        assert "only the bound of lambda_y" in refused.result["message"]


def test_an_effect_in_time_leaves_out_the_rows_that_stand_alone(tmp_path: Path):
    """The airliner's log has 247 gaps, and lone rows between some of them."""
    flight = find_fixture("airliner_mode_s.csv")
    fitted = run(
        "sepcal-pitot", "fit", flight, "--effect", "time_offset", "--json", folder=tmp_path
    )
    assert fitted.code == 0, fitted.err
    assert "time_offset.tau" in fitted.result["parameters"]
