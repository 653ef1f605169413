# SPDX-License-Identifier: BSD-3-Clause
"""The loop on a model of one's own with a state: a pendulum whose encoder's zero warms up.

Its log is of Runge-Kutta steps of a tenth of the model's, with noise that goes on, an encoder's
steps, and channels that drive nothing.
"""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import sepcal
from example_models import FILE, models

Array = npt.NDArray[np.float64]
STEP = 0.05  # [s]
W2, D, K = 12.0, 0.3, 2.0
START = {"w2": 10.0, "d": 0.5, "k": 1.5}
PER_DEGREE = 0.002  # [rad/K] of the encoder's zero


def _swing(torque: Array, theta: float, rate: float) -> Array:
    """The angle at every row; the torque goes straight from row to row."""
    fine = 10
    h = STEP / fine

    def slope(x: Array, u: float) -> Array:
        return np.array([x[1], -W2 * np.sin(x[0]) - D * x[1] + K * u])

    x = np.array([theta, rate])
    angles = [x[0]]
    for before, after in pairwise(torque):
        for k in range(fine):
            at = [before + (after - before) * (k + share) / fine for share in (0.0, 0.5, 1.0)]
            s1 = slope(x, at[0])
            s2 = slope(x + 0.5 * h * s1, at[1])
            s3 = slope(x + 0.5 * h * s2, at[1])
            s4 = slope(x + h * s3, at[2])
            x = x + h / 6.0 * (s1 + 2.0 * s2 + 2.0 * s3 + s4)
        angles.append(x[0])
    return np.array(angles)


def _draw(seed: int, per_degree: float = PER_DEGREE, rows: int = 240) -> sepcal.Flight:
    rng = np.random.default_rng(seed)
    time = STEP * np.arange(rows)

    def wander(seconds: float) -> Array:
        keep = np.exp(-STEP / seconds)
        values = np.zeros(rows)
        values[0] = rng.normal()
        for row in range(1, rows):
            values[row] = keep * values[row - 1] + np.sqrt(1.0 - keep**2) * rng.normal()
        return values

    torque = np.round(1.5 * np.sin(time / 0.6) + 1.0 * wander(0.5), 3)
    temp = 20.0 + 8.0 * np.sin(time / 3.0 + seed) + wander(5.0)
    angle = _swing(torque, 0.3, -0.2) + 0.01 + per_degree * (temp - 20.0)
    read = angle + 0.002 * (rng.normal(size=rows) + 0.5 * wander(0.3))
    return sepcal.Flight(
        {
            "time_s": time,
            "torque": torque,
            "temp_degc": np.round(temp, 1),
            "supply_v": np.round(12.0 - time / 45.0 + 0.05 * wander(5.0), 2),
            "angle_deg": np.degrees(np.round(read / 0.0005) * 0.0005),
        },
        name=f"pendulum_{seed}",
    )


def _write(flight: sepcal.Flight, file: Path) -> None:
    rows = np.column_stack([flight[header] for header in flight.columns])
    np.savetxt(file, rows, delimiter=",", header=",".join(flight.columns), comments="", fmt="%.10g")


def _fit(flight: sepcal.Flight, **options: Any) -> sepcal.Calibration:
    base = sepcal.fit(models.Pendulum(), flight, start=START, **options)
    assert isinstance(base, sepcal.Calibration)
    return base


@pytest.fixture(scope="module")
def flight() -> sepcal.Flight:
    """With the encoder that warms."""
    return _draw(1)


@pytest.fixture(scope="module")
def base(flight: sepcal.Flight) -> sepcal.Calibration:
    """Without its effect."""
    return _fit(flight)


@pytest.fixture(scope="module")
def better(base: sepcal.Calibration) -> sepcal.Calibration:
    """With it."""
    return base.add("zero[temp_degc]")


@pytest.mark.slow
@pytest.mark.long
def test_the_hidden_effect_is_found(base: sepcal.Calibration, better: sepcal.Calibration) -> None:
    """Named, and the error falls as promised."""
    assert base.status == "converged"
    found = base.diagnose()
    assert found.verdict == "effect_missing", found.text
    assert found.effects[0].name in ("zero[temp_degc]", "angle_bias[temp_degc]"), found.text
    advised = found.advice.effect
    assert advised in ("zero[temp_degc]", "angle_bias[temp_degc]")
    entry = better.history[-1]
    achieved = 1.0 - entry.rmse_after / entry.rmse_before
    assert achieved == pytest.approx(found[advised].predicted_drop, abs=0.05)
    assert entry.rmse_after < 0.5 * entry.rmse_before


def test_the_estimates_come_right(better: sepcal.Calibration) -> None:
    """Within four standard errors, those of the hidden effect and of the first row among them."""
    truth = {"w2": W2, "d": D, "k": K, "zero[temp_degc].s": PER_DEGREE, "theta_0": 0.3}
    for name, true in truth.items():
        estimate = better[name]
        assert abs(estimate.value - true) < 4.0 * estimate.standard_error, name


@pytest.mark.slow
@pytest.mark.long
def test_nothing_is_called_missing_where_nothing_is() -> None:
    """The same pendulum with an encoder that does not warm."""
    base = _fit(_draw(3, per_degree=0.0))
    found = base.diagnose()
    assert found.verdict == "adequate", found.text


def test_it_is_saved_loaded_and_applied(
    better: sepcal.Calibration, flight: sepcal.Flight, tmp_path: Path
) -> None:
    """To its own log with the initial states that were fitted, to another with new ones."""
    better.save(tmp_path / "better.json")
    again = sepcal.load(tmp_path / "better.json", model=models.Pendulum())
    assert isinstance(again, sepcal.Calibration)
    assert again.to_json() == better.to_json()
    assert pickle.loads(pickle.dumps(better)).to_json() == better.to_json()
    for one in (flight, _draw(2)):
        ((header, fitted),) = again.apply(one).items()
        assert header == "angle_fit_rad"
        left = np.radians(one["angle_deg"]) - fitted
        assert np.sqrt(np.mean(left**2)) == pytest.approx(better.rmse["angle"], rel=0.3)
    compared = again.compare(_draw(2))
    assert any("initial states are estimated anew" in note for note in compared.notes)
    assert compared.overall[0].rmse == pytest.approx(better.rmse["angle"], rel=0.3)


def test_intervals_and_injection(better: sepcal.Calibration) -> None:
    """The interval of a parameter holds the truth; what is injected is found."""
    lower, upper = better.intervals(names=["w2"])["w2"].profile
    assert lower < W2 < upper
    found = better.diagnose(inject={"zero[supply_v]": 0.2}, only=["zero[supply_v]"])
    assert found.injected is not None
    assert found.injected.found


def test_every_stretch_has_initial_states(flight: sepcal.Flight) -> None:
    """A maneuver begins where it begins; another log with other ones is compared all the same."""
    columns: dict[str, Any] = dict(flight)
    labels = ["first"] * 120 + ["second"] * 120
    cut = sepcal.Flight(columns | {"maneuver": labels}, name="two")
    base = _fit(cut)
    assert {"theta_0[first]", "theta_0[second]"} <= set(base.names)
    assert base.compare().where[0].segment == "first"
    assert base.compare(_draw(2)).overall[0].rmse < 0.1


def test_flights_are_fitted_together() -> None:
    """They share all but their initial states; own parameters are refused in a line."""
    flights = [_draw(seed, per_degree=0.0, rows=200) for seed in (4, 5)]
    joint = sepcal.fit_jointly(models.Pendulum(), flights, start=START)
    assert joint["w2"].value == pytest.approx(W2, abs=4 * joint["w2"].standard_error)
    assert sum(name.startswith("theta_0") for name in joint.names) == 2
    whole = joint.compare().overall[0].rmse
    assert whole == pytest.approx(joint.rmse["angle"])
    assert joint.compare(flights[1]).overall[0].rmse == pytest.approx(whole, rel=0.2)
    with pytest.raises(sepcal.Error, match="own zero: flights of a model with a state"):
        sepcal.fit_jointly(models.Pendulum(), flights, own=["zero"])


def test_the_way_it_is_laid_is_the_users(flight: sepcal.Flight, tmp_path: Path) -> None:
    """Options of a Trajectory hold; filter error takes columns, which is said."""
    cut = sepcal.Trajectory(models.Pendulum(), shoot=5.0, substeps=2)
    base = sepcal.fit(cut, flight, start=START)
    assert isinstance(base, sepcal.Calibration)
    assert sum(name.startswith("theta_0") for name in base.names) == 3
    base.save(tmp_path / "base.json")
    again = sepcal.load(tmp_path / "base.json", model=cut)
    assert isinstance(again, sepcal.Calibration)
    assert again.compare(flight).overall == base.compare().overall
    with pytest.raises(sepcal.Error, match="by filter error give"):
        _fit(flight, method="filter-error")


def _run(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "sepcal", *words], capture_output=True, text=True, check=False,
        env=os.environ,
    )  # fmt: skip


@pytest.mark.slow
def test_every_verb_from_the_command_line(flight: sepcal.Flight, tmp_path: Path) -> None:
    """By file and class, as of a model without a state."""
    model = ("--model", f"{FILE}:Pendulum")
    log, base, better = (str(tmp_path / name) for name in ("log.csv", "base.json", "b.json"))
    _write(flight, Path(log))
    assert _run("check", *model, log).returncode == 0
    known = _run("effects", *model)
    assert "zero[DRIVER]" in known.stdout
    assert "torque_late" in known.stdout
    assert "theta_0" not in known.stdout
    fitted = _run(
        "fit",
        *model,
        log,
        "-o",
        base,
        *(word for name, value in START.items() for word in ("--start", f"{name}={value}")),
    )
    assert fitted.returncode == 0, fitted.stderr
    compared = _run("compare", *model, log, base)
    assert compared.returncode == 0
    assert "temp_degc" in compared.stdout
    asked = ("--only", "zero[temp_degc]", "--only", "torque[supply_v]")
    found = _run("diagnose", *model, log, base, *asked, "--json")
    assert found.returncode == 3, found.stderr
    effect = json.loads(found.stdout)["advice"]["effect"]
    added = _run("add", *model, log, base, effect, "-o", better)
    assert added.returncode == 0, added.stderr
    applied = _run("apply", *model, log, better, "-o", str(tmp_path / "applied.csv"))
    assert applied.returncode == 0, applied.stderr
    assert "angle_fit_rad" in (tmp_path / "applied.csv").read_text().splitlines()[0]
    pytest.importorskip("plotly")
    page = tmp_path / "report.html"
    told = _run("report", *model, log, base, better, "-o", str(page))
    assert told.returncode == 0, told.stderr
    assert "Pendulum" in page.read_text()
