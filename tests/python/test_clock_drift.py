# SPDX-License-Identifier: BSD-3-Clause
"""A sensor whose clock drifts: from in time to late, found, fitted and undone.

The flights are made here, each reading that of the moment to which it belongs.
"""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from apps import Log, run
from recorded import find_case

Array = NDArray[np.float64]
WIND = np.array([-3.8, 2.4])
FIELD = np.array([19.7, -1.4, 49.4])
SPAN = 200.0  # [s]


def write(file: Path, columns: dict[str, Array]) -> None:
    table = np.column_stack(list(columns.values()))
    np.savetxt(file, table, "%.10g", ",", header=",".join(columns), comments="")


def fly_tube(file: Path, tau: float, seed: int, late: float = 0.0) -> Array:
    """At 20 Hz; the true airspeed at the rows' times."""
    draw = np.random.default_rng(seed)
    t = np.arange(0.0, SPAN, 0.05)

    def airspeed(at: Array) -> Array:
        return 20.0 + 3.0 * np.sin(2 * np.pi * at / 31.0) + np.sin(2 * np.pi * at / 3.1)

    course = 2 * np.pi * t / 53.0
    ground = airspeed(t)[:, np.newaxis] * np.column_stack([np.cos(course), np.sin(course)]) + WIND
    read = 0.95 * airspeed(t - late - tau * t / t[-1]) - 0.6 + draw.normal(0.0, 0.1, t.size)
    zero = np.zeros(t.size)
    north, east = ground.T
    columns = {"time_s": t, "vn_mps": north, "ve_mps": east, "vd_mps": zero, "airspeed_mps": read}
    write(file, columns)
    return airspeed(t)


@pytest.mark.parametrize(("tau", "seed"), [(0.3, 1), (-0.2, 2), (0.12, 3)])
def test_a_tube(tmp_path: Path, tau: float, seed: int):
    speed = fly_tube(tmp_path / "flight.csv", tau, seed)
    app = "sepcal-pitot"
    assert run(app, "fit", "flight.csv", "-o", "base.json", folder=tmp_path).code == 0
    diagnosed = run(app, "diagnose", "flight.csv", "base.json", "--json", folder=tmp_path).result
    names = [one["name"] for one in diagnosed["effects"]]
    by_name = {one["name"]: one for one in diagnosed["effects"]}
    assert by_name["clock_drift"]["sentence"] == "the sensor's clock drifts"
    assert names.index("clock_drift") < names.index("time_offset")
    added = run(
        app, "add", "flight.csv", "base.json", "clock_drift", "--json", "-o", "next.json",
        folder=tmp_path,
    )  # fmt: skip
    assert added.code == 0, added.err
    found = added.result["parameters"]["clock_drift.tau"]
    assert abs(found["value"] - tau) < 4.5 * found["standard_error"]
    assert found["standard_error"] < 0.05 * abs(tau)
    assert added.result["rmse"]["airspeed"] == pytest.approx(0.1, rel=0.05)
    assert added.result["options"]["effects"][0]["span"] == pytest.approx([0.0, SPAN - 0.05])
    assert run(
        app, "apply", "flight.csv", "next.json", "-o", "applied.csv", folder=tmp_path
    ).code == 0  # fmt: skip
    log = Log(tmp_path / "applied.csv")
    at = log.index("airspeed_cal_mps")
    corrected = np.array([float(row[at] or "nan") for row in log.rows])
    assert np.count_nonzero(np.isnan(corrected)) < 20  # beside what lies beyond the log
    assert np.sqrt(np.nanmean((corrected - speed) ** 2)) < 0.12


def test_a_delay_beside_a_drift(tmp_path: Path):
    fly_tube(tmp_path / "flight.csv", 0.2, 4, late=0.1)
    effects = ("--effect", "time_offset+clock_drift", "--json")
    fitted = run("sepcal-pitot", "fit", "flight.csv", *effects, folder=tmp_path)
    assert fitted.code == 0, fitted.err
    for name, value in (("time_offset.tau", 0.1), ("clock_drift.tau", 0.2)):
        found = fitted.result["parameters"][name]
        assert abs(found["value"] - value) < 4.5 * found["standard_error"] < 0.05


def test_a_steady_delay_is_no_drift(tmp_path: Path):
    """The pool has both, and the steady one explains it all."""
    fly_tube(tmp_path / "flight.csv", 0.0, 5, late=0.15)
    app = "sepcal-pitot"
    run(app, "fit", "flight.csv", "-o", "base.json", folder=tmp_path)
    diagnosed = run(app, "diagnose", "flight.csv", "base.json", "--json", folder=tmp_path).result
    assert diagnosed["effects"][0]["name"] in ("time_offset", "pneumatic_lag")
    assert diagnosed["effects"][0]["status"] == "found"


def test_a_magnetometer(tmp_path: Path):
    draw = np.random.default_rng(6)
    t = np.arange(0.0, SPAN, 0.1)

    def attitude(at: Array) -> Rotation:
        angles = [np.pi * np.sin(0.4 * at + 2), 1.2 * np.sin(0.7 * at + 1), 2.5 * np.sin(0.9 * at)]
        return Rotation.from_euler("ZYX", np.column_stack(angles))

    h = attitude(t - 0.15 * t / t[-1]).inv().apply(FIELD)
    m = h * [1.05, 0.95, 1.1] + [10.0, -5.0, 7.0] + draw.normal(0.0, 0.2, (t.size, 3))
    yaw, pitch, roll = attitude(t).as_euler("ZYX").T
    names = ("mx_ut", "my_ut", "mz_ut")
    columns = {"time_s": t, **dict(zip(names, m.T, strict=True))}
    write(tmp_path / "flight.csv", columns | {"roll_rad": roll, "pitch_rad": pitch, "yaw_rad": yaw})
    options = ("--field", "19.7,-1.4,49.4", "--effect", "clock_drift", "--json")
    fitted = run("sepcal-mag", "fit", "flight.csv", *options, folder=tmp_path)
    assert fitted.code == 0, fitted.err
    found = fitted.result["parameters"]["clock_drift.tau"]
    assert abs(found["value"] - 0.15) < 4.5 * found["standard_error"] < 0.02


def test_no_vehicle_undoes_it(tmp_path: Path):
    """It follows the time since that flight began."""
    fly_tube(tmp_path / "flight.csv", 0.3, 7)
    app = "sepcal-pitot"
    run(app, "fit", "flight.csv", "--effect", "clock_drift", "-o", "e.json", folder=tmp_path)
    done = run(app, "export", "e.json", "--to", "c", "-o", "tube.h", folder=tmp_path)
    assert done.code == 2
    assert "clock_drift can't be exported" in done.err


def test_the_case_of_a_tube(tmp_path: Path):
    """From 0 to 0.3 s late."""
    case = find_case("air_late_drift.csv")
    options = ("--effect", "clock_drift", "--json")
    fitted = run("sepcal-pitot", "fit", case, *options, folder=tmp_path)
    assert fitted.code == 0, fitted.err
    found = fitted.result["parameters"]["clock_drift.tau"]
    assert found["value"] == pytest.approx(0.3, abs=0.02)
