# SPDX-License-Identifier: BSD-3-Clause
"""A velocity with white noise beside an airspeed whose noise a filter has smoothed.

A model whose columns hold the velocity's noise could cancel it in the residual, by taking the model
away: the readings that are left are predicted well by their own past. Both errors are counted.
"""

import numpy as np
import pytest
from scipy.signal import lfilter

import sepcal
from studies.trust.asked import MODELS
from studies.trust.by_key import fly_key

STEP = 0.1  # [s]
ROWS = 1200
SEEDS = range(40, 46)
WIND = (-3.8, 2.4, 0.3)  # of simulated flights


def fly(seed: int, noise: float, of_throttle: float = 0.0) -> sepcal.Flight:
    """Turns at 13 to 25 m/s in a wind; airspeed = 1.05 V + 0.4 and so many m/s at full throttle."""
    draw = np.random.default_rng(seed)
    time = np.arange(ROWS) * STEP
    phase = draw.uniform(0, 6, 4)
    speed = 19 + 4 * np.sin(time / 17 + phase[0]) + 1.5 * np.sin(time / 5 + phase[1])
    course = time / 9 + 0.5 * np.sin(time / 13 + phase[2])
    climb = 0.5 * np.sin(time / 20 + phase[3])
    air = np.column_stack([speed * np.cos(course), speed * np.sin(course), climb])
    ground = air + np.array([4.0, -2.5, 0.0]) + draw.normal(0, 0.1, air.shape)
    throttle = 0.5 + 0.3 * np.sign(np.sin(time / 5 + phase[0]))
    keep = np.exp(-STEP / 1.0)  # a filter of one second
    smoothed = lfilter([1 - keep], [1, -keep], draw.normal(0, noise, ROWS))
    read = 1.05 * np.linalg.norm(air, axis=1) + 0.4 + of_throttle * throttle + smoothed
    return sepcal.Flight(
        {
            "time_s": time,
            "vn_mps": ground[:, 0],
            "ve_mps": ground[:, 1],
            "vd_mps": ground[:, 2],
            "airspeed_mps": read,
            "throttle": throttle,
            "temp_degc": 30 - 12 * np.exp(-time / 40),
        }
    )


@pytest.mark.parametrize("noise", [0.0, 0.1, 0.3])
def test_nothing_is_called_where_nothing_is_hidden(noise: float) -> None:
    verdicts = []
    for seed in SEEDS:
        flight = fly(seed, noise)
        found = sepcal.fit(sepcal.PitotStatic(), flight).diagnose(flight)
        verdicts.append(str(found.verdict))
    assert verdicts.count("adequate") >= len(SEEDS) - 1, verdicts
    assert set(verdicts) <= {"adequate", "slow_change"}


@pytest.mark.parametrize("noise", [0.0, 0.3])
def test_what_is_hidden_is_named(noise: float) -> None:
    """A zero that moves by 0.3 m/s with the throttle, which leaves 0.15 m/s beside 0.1 of noise."""
    for seed in SEEDS:
        flight = fly(seed, noise, of_throttle=0.5)
        found = sepcal.fit(sepcal.PitotStatic(), flight).diagnose(flight)
        assert str(found.verdict) == "effect_missing", seed
        assert found.effects[0].name == "airspeed_bias[throttle]", seed


def test_pairs_that_no_fit_bears_out_are_forgotten() -> None:
    """A flight of which one effect is withdrawn, then every pair of lines, then what is left."""
    _, flown = fly_key(("nothing", "five-hole", "inputs noisier than outputs", 0.0, 600, 57))
    found = sepcal.fit(MODELS["five-hole"], sepcal.Flight(flown.columns)).diagnose()
    assert str(found.verdict) == "adequate"
    assert not found.advice.effect
    assert not any("+" in effect.name for effect in found.effects)


IN_GUSTS = [(2400, 890000), (600, 890004), (1800, 890008)]  # upwash or a blockage was called found


@pytest.mark.parametrize(("rows", "seed"), IN_GUSTS)
def test_gusts_that_a_probe_reads_are_no_cause(rows: int, seed: int) -> None:
    """A five-hole probe's readings hold what the velocity lacks, and so do columns made of them."""
    _, flown = fly_key(("nothing", "five-hole", "gusts", 0.0, rows, seed))
    found = sepcal.fit(MODELS["five-hole"], sepcal.Flight(flown.columns)).diagnose()
    assert str(found.verdict) in ("adequate", "slow_change"), found.text


def test_what_is_hidden_is_named_in_gusts() -> None:
    """A bias that drifts by twice as much as the gusts."""
    cause = "five-hole: drift of airspeed_bias along time"
    _, flown = fly_key(("wander", cause, "gusts", 2.0, 1800, 890008))
    found = sepcal.fit(MODELS["five-hole"], sepcal.Flight(flown.columns)).diagnose()
    assert str(found.verdict) == "effect_missing"
    assert "airspeed_bias[time]" in found.explanations


@pytest.mark.parametrize("standing", [1, 5])
def test_rows_of_air_that_stands_take_no_cause_away(standing: int) -> None:
    """No reading of a probe makes such rows' velocity: they stay as they were read."""
    flown = sepcal.simulate(
        sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(1, 0, 0)), rate=10
    )
    columns = {name: np.array(flown[name]) for name in flown}
    for row in range(standing):  # hardly any air, and 0.4 m/s through it
        pitch, yaw = columns["pitch_rad"][row], columns["yaw_rad"][row]
        ahead = [np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), -np.sin(pitch)]
        for name, wind, along in zip(("vn", "ve", "vd"), WIND, ahead, strict=True):
            columns[f"{name}_mps"][row] = wind + 0.4 * along
        columns["pt_pa"][row] = columns["ps_pa"][row] + 1.0
        columns["dpa_pa"][row] = columns["dpb_pa"][row] = 0.0
    probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5)
    found = sepcal.fit(probe, sepcal.Flight(columns), samples=40).diagnose(only=["lever_arm"])
    assert found.effects[0].name == "lever_arm"
    assert found.effects[0].p_value < 1e-6
