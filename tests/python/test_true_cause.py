# SPDX-License-Identifier: BSD-3-Clause
"""What drifts with the cause passes for it: a battery falls, a sensor warms, the wind turns.

A small aircraft in turbulence with scales of 1 to 30 s, legs and turns, a board that warms up and a
battery that falls.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from apps import Outcome, run
from faults import write

Array = npt.NDArray[np.float64]

TUBE = ("--probe", "pitot-static")
ROWS = 3000
STEP = 0.2  # [s]
SEEDS = (11, 12, 13)


def wander(draw: np.random.Generator, size: float, time: float) -> Array:
    """A Gauss-Markov process."""
    keep = np.exp(-STEP / time)
    pushes = draw.normal(0, size * np.sqrt(1 - keep**2), ROWS)
    values = np.empty(ROWS)
    value = draw.normal(0, size)
    for row, push in enumerate(pushes):
        value = keep * value + push
        values[row] = value
    return values


def smooth(commanded: Array, time: float) -> Array:
    """What follows a command with a time constant."""
    values = np.empty(ROWS)
    value = commanded[0]
    for row, wanted in enumerate(commanded):
        value += (wanted - value) * STEP / (time + STEP)
        values[row] = value
    return values


def fly(
    seed: int,
    gusts: float,
    zero: float = 0.0,
    front: tuple[float, float] = (0.0, 0.0),
    propeller: float = 0.0,
) -> dict[str, Array]:
    """A tube with a factor of 0.96 whose zero goes by so many Pa as the board warms.

    The wind is (3, -4) m/s before a front, which changes it within a minute. A propeller blows on
    the tube by so many m/s at full throttle, from 45 % on.
    """
    draw = np.random.default_rng(seed)
    time = STEP * np.arange(ROWS)
    share = time / time[-1]
    leg = (time // 43).astype(int)
    speed = smooth(np.array([18.0, 15.0, 21.0, 24.0, 16.0])[leg % 5], 5)
    turning = (time % 43 > 30) * np.array([0.24, -0.12, 0.36])[leg % 3]
    heading = 0.4 + np.cumsum(smooth(turning, 1)) * STEP
    altitude = 150 + smooth(60 * np.array([0.0, 1.0, 1.5, 0.5])[(leg // 2) % 4], 20)
    passing = 1 / (1 + np.exp(-(time - 0.58 * time[-1]) / 13))
    wind = [3 + front[0] * passing, -4 + front[1] * passing]
    gust = [
        sum((wander(draw, part * gusts, scale) for part, scale in ((0.5, 1), (0.7, 6), (0.5, 30))))
        for _ in range(2)
    ]
    along, across = np.cos(heading), np.sin(heading)
    true = np.hypot(speed + gust[0] * along + gust[1] * across, gust[1] * along - gust[0] * across)
    density = 1.2 * np.exp(-altitude / 9500)
    board = 22 + 18 * (1 - np.exp(-time / 210)) + wander(draw, 0.3, 60)
    pressure = 0.5 * density * true**2 / 0.96**2
    pressure += zero * (board - board.mean()) / np.ptp(board) + draw.normal(0, 1.2, ROWS)
    throttle = np.clip(0.2 + 0.0009 * speed**2 + draw.normal(0, 0.02, ROWS), 0, 1)
    drawn = np.cumsum(throttle) / np.sum(throttle)
    airspeed = np.sqrt(np.maximum(2 * pressure / density, 1.0))
    airspeed += propeller * np.maximum(throttle - 0.45, 0) / 0.55
    return {
        "time_s": time,
        "vn_mps": speed * along + wind[0] + wander(draw, 0.07, 120) + draw.normal(0, 0.04, ROWS),
        "ve_mps": speed * across + wind[1] + wander(draw, 0.07, 120) + draw.normal(0, 0.04, ROWS),
        "vd_mps": np.zeros(ROWS),
        "airspeed_mps": np.round(airspeed, 2),
        "board_degc": np.round(board, 1),
        "battery_v": np.round(16.6 - 1.7 * drawn - 0.4 * throttle + draw.normal(0, 0.015, ROWS), 2),
        "altitude_m": np.round(altitude + wander(draw, 1, 60), 1),
        "throttle": np.round(throttle, 2),
        "current_a": np.round(1 + smooth(24 * throttle**1.4, 0.4) + draw.normal(0, 0.3, ROWS), 1),
        "cpu_degc": np.round(52 + 8 * share + wander(draw, 1.2, 8)),
    }


@pytest.fixture
def diagnosed(tmp_path: Path) -> Callable[[dict[str, Array]], Outcome]:
    """Fits a flight and diagnoses it."""

    def diagnose(columns: dict[str, Array]) -> Outcome:
        write(columns, tmp_path / "flight.csv")
        run("sepcal-pitot", "fit", "flight.csv", "-o", "base.json", *TUBE, folder=tmp_path)
        return run("sepcal-pitot", "diagnose", "flight.csv", "base.json", "--json", folder=tmp_path)

    return diagnose


@pytest.mark.parametrize("seed", SEEDS)
def test_a_zero_that_warms_up_follows_the_board(
    diagnosed: Callable[[dict[str, Array]], Outcome], seed: int
) -> None:
    """A line along its temperature: no levels of it, and nothing that the battery drives."""
    diagnosis = diagnosed(fly(seed, gusts=0.4, zero=40))
    assert diagnosis.code == 3
    first = diagnosis.result["effects"][0]["name"]
    assert first in {f"{port}[board_degc]" for port in ("pressure_offset", "airspeed_bias")}


@pytest.mark.parametrize("seed", SEEDS)
def test_a_front_is_no_matter_of_the_battery(
    diagnosed: Callable[[dict[str, Array]], Outcome], seed: int
) -> None:
    """What drives the wind is the time, though battery and board go with it."""
    diagnosis = diagnosed(fly(seed, gusts=0.4, front=(2.2, -1.4)))
    assert diagnosis.code == 3
    first = diagnosis.result["effects"][0]["name"]
    assert first.startswith("wind[")
    assert "time" in first


@pytest.mark.parametrize("seed", SEEDS)
def test_a_propeller_is_no_matter_of_the_current(
    diagnosed: Callable[[dict[str, Array]], Outcome], seed: int
) -> None:
    """A line stands for the curve along its own channel, and not for that along another."""
    diagnosis = diagnosed(fly(seed, gusts=0.3, propeller=6))
    assert diagnosis.code == 3
    assert "[" in (first := diagnosis.result["effects"][0]["name"])
    assert "throttle" in first


@pytest.mark.parametrize("seed", SEEDS)
def test_what_the_wander_hides_is_among_what_would_do_as_well(
    diagnosed: Callable[[dict[str, Array]], Outcome], seed: int
) -> None:
    """A zero that warms by little more than a velocity wanders, in a set that is worth reading."""
    diagnosis = diagnosed(fly(seed, gusts=0.3, zero=30))
    assert diagnosis.result["verdict"] in ("slow_change", "effect_missing")
    effects = diagnosis.result["effects"]
    equivalent = [effect for effect in effects[1:] if effect["beside"] == "equivalent"]
    told = [effects[0], *(effect for effect in equivalent if effect["status"] != "not_seen")]
    assert any(effect["name"].endswith("[board_degc]") for effect in told)
    assert len(told) <= 5


@pytest.mark.parametrize("gusts", [0.3, 0.6, 0.9])
@pytest.mark.parametrize("seed", SEEDS)
def test_rough_air_is_no_effect(
    diagnosed: Callable[[dict[str, Array]], Outcome], seed: int, gusts: float
) -> None:
    """Nothing is found in turbulence that is louder than a sensor wanders."""
    diagnosis = diagnosed(fly(seed, gusts))
    assert diagnosis.result["verdict"] != "effect_missing"
    assert diagnosis.result["error_budget"]["gusts"]["size"] >= 0.35
