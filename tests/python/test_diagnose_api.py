# SPDX-License-Identifier: BSD-3-Clause
"""diagnose from Python: the loop of diagnosing and adding, own effects, recorded flights."""

import json
from pathlib import Path

import numpy as np
import pytest

import sepcal
from recorded import find_fixture

MAGNETOMETER = sepcal.Magnetometer(field=(19.7, -1.4, 49.4))
OCTOCOPTER = sepcal.Magnetometer(field=(19.72, -1.41, 49.44))


@pytest.fixture(scope="module")
def bent() -> sepcal.Calibration:
    """A motor's current bends the field, and the fit doesn't know."""
    flight = sepcal.simulate(MAGNETOMETER, rows=400, seed=1, hide={"bias[current_a]": 0.06})
    return sepcal.fit(MAGNETOMETER, flight, samples=100)


def test_the_loop_closes(bent: sepcal.Calibration):
    """Diagnose, add, diagnose again: the README's promise."""
    diagnosis = bent.diagnose()
    assert diagnosis.injected is None
    first = diagnosis.found[0]
    assert diagnosis.effects[0] is first
    assert "bias[current_a]" in [first.name, *diagnosis.list_beside("equivalent")]
    assert diagnosis["bias[current_a]"].status == "found"
    assert first.sentence in str(diagnosis).splitlines()[1]
    assert first.name in repr(diagnosis)
    assert json.loads(diagnosis.to_json()) == diagnosis.to_dict()
    better = bent.add(first.name)
    assert better.history[-1].rmse_after < better.history[-1].rmse_before
    again = better.diagnose()
    assert again.verdict == "adequate"
    assert again.found == []
    with pytest.raises(sepcal.Error, match="no candidate 'lift'"):
        diagnosis["lift"]


def test_an_effect_of_ones_own(bent: sepcal.Calibration):
    """It ranks with the others, by its own driver, and can be added."""
    motor = sepcal.Effect("motor", lambda log: log["current_a"] ** 1.0, port="bias", unit="uT/A")
    lamp = sepcal.Effect("lamp", lambda log: np.cos(log["time"] * 3), port="bias", unit="uT")
    diagnosis = bent.diagnose(effects=[motor, lamp])
    built_in = diagnosis["bias[current_a]"]
    mine = diagnosis["motor"]
    assert mine.status == "found"
    assert mine.log10_p == pytest.approx(built_in.log10_p, rel=1e-6)
    assert list(mine.estimate) == ["motor.x", "motor.y", "motor.z"]
    assert set(mine.unit.values()) == {"uT/A"}
    # One of the two is told as a fit has it, the other as one step has.
    assert list(mine.estimate.values()) == pytest.approx(list(built_in.estimate.values()), rel=0.03)
    as_good = [diagnosis.effects[0].name, *diagnosis.list_beside("equivalent")]
    assert {"motor", "bias[current_a]"} <= set(as_good)
    assert diagnosis["lamp"].status == "not_seen"
    better = bent.add(motor)
    drop = 1 - better.history[-1].rmse_after / better.history[-1].rmse_before
    assert mine.predicted_drop == pytest.approx(drop, rel=0.05)
    assert "motor" not in [effect.name for effect in better.diagnose().effects]


def test_inject_from_python(bent: sepcal.Calibration):
    diagnosis = bent.diagnose(inject={"scale[temp_degc]": 0.01}, simulations=49)
    assert diagnosis.injected is not None
    assert diagnosis.injected.found
    assert diagnosis.injected.sizes == [0.01]


def test_misuse(bent: sepcal.Calibration, tmp_path: Path):
    with pytest.raises(sepcal.Error, match="one effect at a time"):
        bent.diagnose(inject={"bias[time]": 1, "scale[time]": 1})
    with pytest.raises(sepcal.Error, match="simulations must be at least 2"):
        bent.diagnose(simulations=1)
    with pytest.raises(sepcal.Error, match="no effect 'lift'"):
        bent.diagnose(inject={"lift": 1})
    bent.save(tmp_path / "bent.json")
    with pytest.raises(sepcal.Error, match="a loaded calibration has no flight"):
        sepcal.load(tmp_path / "bent.json").diagnose()


# --- recorded flights


def diagnose_octocopter(mount: str) -> sepcal.Diagnosis:
    flight = sepcal.read_csv(find_fixture(f"octocopter_{mount}_mag.csv"))
    return sepcal.fit(OCTOCOPTER, flight, samples=100).diagnose(simulations=49)


@pytest.mark.slow
def test_an_octocopters_current():
    """Beside the power wiring: the battery's voltage or its current, which are one cause."""
    diagnosis = diagnose_octocopter("internal")
    first = diagnosis.effects[0]
    assert first.status == "found"
    assert {"bias[current_a]", "bias[voltage_v]"} <= {effect.name for effect in diagnosis.found}
    assert first.held_out_gain >= 0.5


def test_an_octocopters_mast():
    """The same flight far from the wiring: significant, and small."""
    diagnosis = diagnose_octocopter("external")
    first = diagnosis.effects[0]
    assert first.status == "found"
    assert 0 < first.held_out_gain < 0.25


@pytest.mark.parametrize("hide", [{}, {"bias[current_a]": 0.05}, {"bias_step": 4.0}])
def test_what_a_diagnosis_costs(hide: dict[str, float]):
    """Counted, not timed: screens are cheap, tests, draws and fits are few."""
    flight = sepcal.simulate("magnetometer", hide=hide, rows=600, seed=1)
    work = sepcal.fit(sepcal.Magnetometer(), flight).diagnose().work
    assert work.screened >= 30
    assert work.tested <= 20
    assert work.calibrated <= 6
    assert work.drawn <= 240
    assert work.refitted <= 12
