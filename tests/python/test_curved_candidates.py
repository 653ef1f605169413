# SPDX-License-Identifier: BSD-3-Clause
"""Curves and levels of a channel that the residual itself asks for, and none where it does not.

The flights are made here. What is judged is the pool: which candidates are tried, and that the true
one takes most of the error on rows held out.
"""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from apps import run
from recorded import find_case

Array = NDArray[np.float64]
FIELD = np.array([19.7, -1.4, 49.4])
WIND = np.array([-3.8, 2.4])
RHO = 1.15  # [kg/m^3]
ASKED_FOR = re.compile(r"\[(spline|levels)\(")
CATALOGUED = re.compile(r"\[spline\((time|altitude_m),")


def wander(draw: np.random.Generator, rows: int, low: float, high: float) -> Array:
    """Up and down between two values, the more often the longer."""
    t = np.linspace(0, 1, rows)
    swing = np.sin(2 * np.pi * (draw.uniform(2, 4) * t + draw.uniform()))
    return low + (high - low) * (0.5 + 0.5 * swing)


def write(file: Path, columns: dict[str, Array]) -> None:
    table = np.column_stack(list(columns.values()))
    np.savetxt(file, table, "%.9g", ",", header=",".join(columns), comments="")


def fly_tube(
    folder: Path,
    seed: int,
    *,
    wind: Callable[[dict[str, Array]], Array] = lambda _: np.zeros(2),
    pressure: Callable[[dict[str, Array]], Array] = lambda _: np.zeros(1),
    noise: float = 1.5,
) -> dict[str, Any]:
    """A tube in circles; what diagnose says of it."""
    rows = 1500
    draw = np.random.default_rng(seed)
    t = np.arange(rows) / 5.0
    channels = {
        "altitude_m": wander(draw, rows, 900.0, 1700.0),
        "temp_degc": wander(draw, rows, 0.0, 40.0),
        "flap": np.floor(3 * np.mod(t / draw.uniform(40, 60), 1.0)) / 2,
    }
    speed = 20.0 + 4.0 * np.sin(2 * np.pi * t / 83.0)
    course = 2 * np.pi * t / 37.0
    air = speed[:, np.newaxis] * np.column_stack([np.cos(course), np.sin(course)])
    ground = air + WIND + wind(channels)
    dp = RHO * speed**2 / 2 / 1.05 + pressure(channels) + draw.normal(0.0, noise, rows)
    columns = {
        "time_s": t,
        "vn_mps": ground[:, 0],
        "ve_mps": ground[:, 1],
        "vd_mps": np.zeros(rows),
        "dp_pa": dp,
        "rho_kgpm3": np.full(rows, RHO),
        **channels,
    }
    write(folder / "flight.csv", columns)
    return diagnose("sepcal-pitot", folder)


def fly_magnetometer(folder: Path, seed: int, bias: Callable[[Array], Array]) -> dict[str, Any]:
    rows = 1200
    draw = np.random.default_rng(seed)
    t = np.arange(rows) / 10.0
    angles = np.column_stack(
        [2.5 * np.sin(0.9 * t), 1.2 * np.sin(0.7 * t + 1), np.pi * np.sin(0.4 * t + 2)]
    )
    temp = wander(draw, rows, 10.0, 35.0)
    h = Rotation.from_euler("ZYX", angles[:, ::-1]).inv().apply(FIELD)
    m = h * [1.05, 0.95, 1.1] + [10.0, -5.0, 7.0] + bias(temp) + draw.normal(0, 0.2, (rows, 3))
    roll, pitch, yaw = angles.T
    names = ("mx_ut", "my_ut", "mz_ut")
    columns = {"time_s": t, **dict(zip(names, m.T, strict=True))}
    columns |= {"roll_rad": roll, "pitch_rad": pitch, "yaw_rad": yaw, "temp_degc": temp}
    write(folder / "flight.csv", columns)
    return diagnose("sepcal-mag", folder, "--field", "19.7,-1.4,49.4")


def diagnose(app: str, folder: Path, *options: str) -> dict[str, Any]:
    fitted = run(app, "fit", "flight.csv", *options, "-o", "base.json", folder=folder)
    assert fitted.code in (0, 5), fitted.err
    return run(app, "diagnose", "flight.csv", "base.json", "--json", folder=folder).result


def asked_for(diagnosed: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """The candidates beyond the catalogue's, by name."""
    return {
        one["name"]: one
        for one in diagnosed["effects"]
        if ASKED_FOR.search(one["name"]) and not CATALOGUED.search(one["name"])
    }


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_bias_that_swings_with_temperature(tmp_path: Path, seed: int):
    found = fly_magnetometer(
        tmp_path, seed, lambda temp: np.sin(temp / 3)[:, np.newaxis] * [1.5, -1.0, 0.8]
    )
    (spline,) = (name for name in asked_for(found) if name.startswith("bias[spline(temp_degc,"))
    assert asked_for(found)[spline]["held_out_gain"] > 0.6


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_zero_that_depends_on_temperature_in_steps(tmp_path: Path, seed: int):
    """A compensation by a table: -25 Pa below 10 degC, 25 above 30."""
    found = fly_tube(
        tmp_path,
        seed,
        pressure=lambda at: 25.0 * (at["temp_degc"] > 30) - 25.0 * (at["temp_degc"] < 10),
    )
    (levels,) = (n for n in asked_for(found) if n.startswith("pressure_offset[levels(temp_degc,"))
    thresholds = [float(text) for text in re.findall(r",([-\d.]+)", levels)]
    assert min(abs(one - 10.0) for one in thresholds) < 0.5
    assert min(abs(one - 30.0) for one in thresholds) < 0.5
    assert asked_for(found)[levels]["held_out_gain"] > 0.6


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_wind_above_an_inversion(tmp_path: Path, seed: int):
    found = fly_tube(
        tmp_path,
        seed,
        wind=lambda at: np.outer(at["altitude_m"] > 1300, [4.0, 0.0]),
    )
    (levels,) = (name for name in asked_for(found) if name.startswith("wind[levels(altitude_m,"))
    thresholds = [float(text) for text in re.findall(r",([-\d.]+)", levels)]
    assert min(abs(one - 1300.0) for one in thresholds) < 15.0
    assert asked_for(found)[levels]["held_out_gain"] > 0.6


@pytest.mark.parametrize("seed", [1, 2])
def test_a_flap_that_is_off_at_one_setting(tmp_path: Path, seed: int):
    """Of few values each is a level; a line through three of them is not what it is."""
    found = fly_tube(tmp_path, seed, pressure=lambda at: 20.0 * (at["flap"] == 0.5))
    name = next(iter(asked_for(found)))
    assert re.fullmatch(r"\w+\[levels\(flap,0\.\d+,0\.\d+\)\]", name)
    assert asked_for(found)[name]["held_out_gain"] > 0.5


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_no_port_follows_a_curve_with_more_knots_than_another(tmp_path: Path, seed: int):
    """A scale that swings with the altitude: six knots of a zero would beat four of the scale."""

    def swing(at: dict[str, Array]) -> Array:
        speed = 20.0 + 4.0 * np.sin(2 * np.pi * np.arange(1500) / 5.0 / 83.0)
        phase = 2 * np.pi * 1.2 * (at["altitude_m"] - 900.0) / 800.0
        return 0.03 * np.sin(phase) * RHO * speed**2

    found = fly_tube(tmp_path, seed, pressure=swing)
    knots: dict[str, set[str]] = {}
    for one in found["effects"]:
        if one["name"].startswith("wind"):  # whose splines are the catalogue's
            continue
        for channel, count in re.findall(r"\[spline\((\w+),(\d)\)\]", one["name"]):
            knots.setdefault(channel, set()).add(count)
    assert len(knots["altitude_m"]) == 1
    first = found["effects"][0]["name"]
    assert re.fullmatch(r"airspeed_scale\[spline\(altitude_m,\d\)\]", first)


def test_where_a_line_will_do_no_curve_stands_first(tmp_path: Path):
    found = fly_tube(tmp_path, 5, pressure=lambda at: 1.5 * (at["temp_degc"] - 20.0))
    assert found["effects"][0]["name"] == "pressure_offset[temp_degc]"


@pytest.mark.parametrize("seed", range(4))
def test_noise_asks_for_none(tmp_path: Path, seed: int):
    assert asked_for(fly_tube(tmp_path, seed)) == {}
    assert asked_for(fly_magnetometer(tmp_path, seed, lambda _: np.zeros(3))) == {}


def test_levels_travel_with_the_calibration(tmp_path: Path):
    """Added, saved, applied and exported as any other effect."""
    name = "pressure_offset[levels(temp_degc,10,30)]"
    fly_tube(tmp_path, 1, pressure=lambda at: 25.0 * (at["temp_degc"] > 30))
    app = "sepcal-pitot"
    added = run(app, "add", "flight.csv", "base.json", name, "-o", "next.json", folder=tmp_path)
    assert added.code == 0, added.err
    compared = run(app, "compare", "flight.csv", "next.json", "--json", folder=tmp_path).result
    assert compared["rmse"]["airspeed"] < 0.11
    applied = run(app, "apply", "flight.csv", "next.json", "-o", "applied.csv", folder=tmp_path)
    assert applied.code == 0, applied.err
    done = run(app, "export", "next.json", "--to", "c", "-o", "tube.h", folder=tmp_path)
    assert done.code == 0, done.err
    outside = "airspeed_bias[levels(temp_degc,90)]"
    refused = run(app, "add", "flight.csv", "base.json", outside, "-o", "no.json", folder=tmp_path)
    assert refused.code == 2
    assert "its thresholds are not within the values of 'temp_degc'" in refused.err


CASES = [
    ("mag_temp_sin.csv", "sepcal-mag", r"bias\[spline\(temp_degc,\d\)\]", 0.6),
    ("dp_temp_cycle.csv", "sepcal-pitot", r"pressure_offset\[levels\(temp_degc,.*\)\]", 0.6),
    ("inversion.csv", "sepcal-pitot", r"wind\[levels\(altitude_m,1\d{3}\)\]", 0.6),
]


@pytest.mark.parametrize(("case", "app", "name", "held_out"), CASES)
def test_the_cases(tmp_path: Path, case: str, app: str, name: str, held_out: float):
    options = ("--field", "19.7,-1.4,49.4") if app == "sepcal-mag" else ()
    (tmp_path / "flight.csv").write_bytes(find_case(case).read_bytes())
    found = diagnose(app, tmp_path, *options)
    (asked,) = (one for one in asked_for(found).values() if re.fullmatch(name, one["name"]))
    assert asked["held_out_gain"] > held_out
