# SPDX-License-Identifier: BSD-3-Clause
"""A tube whose pressure sensor reads a constant too much: found, added, undone, put on board.

The flights are made here: circles at two speeds in a steady wind, dp = rho V^2 / 2 / ratio + zero.
"""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from apps import Bench, Log, run
from oracle import autopilots
from recorded import find_case

RHO = 1.15  # [kg/m^3]
WIND = np.array([-3.8, 2.4])
RATIO = 1.1  # of the pressure that the airspeed makes to the one that is read


def fly(file: Path, zero: float, seed: int, rows: int = 1200) -> NDArray[np.float64]:
    """Writes a flight at 5 Hz; the true airspeed, shape (rows,)."""
    draw = np.random.default_rng(seed)
    t = np.arange(rows) / 5.0
    speed = 18.0 + 6.0 * np.sin(2 * np.pi * t / 97.0) + 2.0 * np.sin(2 * np.pi * t / 13.0 + seed)
    course = 2 * np.pi * t / 41.0
    air = speed[:, np.newaxis] * np.column_stack([np.cos(course), np.sin(course)])
    ground = air + WIND
    dp = RHO * speed**2 / 2 / RATIO + zero + draw.normal(0.0, 1.5, rows)
    columns = {
        "time_s": t,
        "vn_mps": ground[:, 0],
        "ve_mps": ground[:, 1],
        "vd_mps": np.zeros(rows),
        "dp_pa": dp,
        "rho_kgpm3": np.full(rows, RHO),
        "temp_degc": 15.0 + t / 60.0,
    }
    np.savetxt(
        file,
        np.column_stack(list(columns.values())),
        "%.9g",
        ",",
        header=",".join(columns),
        comments="",
    )
    return speed


def bench_in(folder: Path) -> Bench:
    return Bench("sepcal-pitot", folder, (), None)  # type: ignore[arg-type]


@pytest.mark.parametrize(("zero", "seed"), [(30.0, 1), (-25.0, 2), (12.0, 3)])
def test_a_zero_is_found_and_added(tmp_path: Path, zero: float, seed: int):
    speed = fly(tmp_path / "flight.csv", zero, seed)
    bench = bench_in(tmp_path)
    assert bench.run("fit", "flight.csv", "-o", "base.json").code in (0, 5)
    diagnosed = bench.run("diagnose", "flight.csv", "base.json", "--json").result
    # A transducer that wanders by 0.2 m/s hides half of it.
    assert diagnosed["verdict"] in ("effect_missing", "slow_change")
    first = diagnosed["effects"][0]
    assert first["name"] == "pressure_offset"
    assert first["status"] in ("found", "slow_change")
    assert first["sentence"] == "the zero of the pressure difference is off"

    added = bench.run("add", "flight.csv", "base.json", "pressure_offset", "-o", "better.json")
    assert added.code == 0, added.err
    entries = bench.run("apply", "flight.csv", "better.json", "-o", "applied.csv")
    assert entries.code == 0, entries.err
    assert np.abs(Log(tmp_path / "applied.csv").column("airspeed_cal_mps") - speed).max() < 1.0
    better = bench.run(
        "fit", "flight.csv", "--effect", "pressure_offset", "--fix", "c_va=0", "--json"
    ).result["parameters"]
    # The effect is on the air's pressure: what is read too much is to be taken off.
    expected = {"s_va": RATIO**-0.5, "pressure_offset.s": -zero * RATIO}
    for name, value in expected.items():
        error = better[name]["standard_error"]
        assert abs(better[name]["value"] - value) < 4.5 * error
        assert error < 0.03 * abs(value)


def test_none_is_found_where_there_is_none(tmp_path: Path):
    fly(tmp_path / "flight.csv", 0.0, 4)
    bench = bench_in(tmp_path)
    assert bench.run("fit", "flight.csv", "-o", "base.json").code == 0
    diagnosed = bench.run("diagnose", "flight.csv", "base.json", "--json").result
    assert diagnosed["verdict"] == "adequate"
    (zero,) = (one for one in diagnosed["effects"] if one["name"] == "pressure_offset")
    assert zero["status"] != "found"


@pytest.mark.parametrize("target", ["ardupilot", "px4"])
def test_an_autopilot_holds_it(tmp_path: Path, target: str):
    """It is what they have room for, beside the scale: nothing has to be left out."""
    speed = fly(tmp_path / "flight.csv", 20.0, 5)
    bench = bench_in(tmp_path)
    fitted = bench.run("fit", "flight.csv", "--effect", "pressure_offset", "-o", "e.json")
    assert fitted.code in (0, 5), fitted.err
    done = bench.run("export", "e.json", "--to", target, "-o", "vehicle")
    assert done.code == 0, done.err
    log = bench.read_log()
    read, apply_to = {
        "ardupilot": (autopilots.read_ardupilot, autopilots.ardupilot_airspeed),
        "px4": (autopilots.read_px4, autopilots.px4_airspeed),
    }[target]
    found = apply_to(read(tmp_path / "vehicle"), log.column("dp_pa"), log.column("rho_kgpm3"))
    assert np.sqrt(np.mean((found - speed) ** 2)) < 0.15  # the noise of the pressure


def test_a_port_alone_is_no_effect(tmp_path: Path):
    """Where the model has the constant itself."""
    fly(tmp_path / "flight.csv", 0.0, 6, rows=100)
    done = bench_in(tmp_path).run("fit", "flight.csv", "--effect", "wind")
    assert done.code == 2
    assert "effect 'wind' needs a driver: write wind[time] or wind[COLUMN]" in done.err


def test_the_case_of_30_pa(tmp_path: Path):
    """A tube that reads 30 Pa too much, ratio 1.100."""
    options = ("--effect", "pressure_offset", "--fix", "c_va=0", "--json")
    fitted = run("sepcal-pitot", "fit", find_case("dp30.csv"), *options, folder=tmp_path).result
    found = fitted["parameters"]
    assert found["s_va"]["value"] == pytest.approx(0.9535, abs=3e-3)
    assert found["pressure_offset.s"]["value"] == pytest.approx(-33.0, abs=1.0)
