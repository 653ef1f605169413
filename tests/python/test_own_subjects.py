# SPDX-License-Identifier: BSD-3-Clause
"""The loop on models that aren't sepcal's: found, added, the error fallen as promised, applied.

Each log is of instruments as they are: noise that is not white, quantised readings, channels that
go with the run and drive nothing.
"""

from __future__ import annotations

import hashlib
import json
import os
import pickle
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np
import numpy.typing as npt
import pytest

import sepcal
from example_models import FILE, models
from sepcal import _core
from sepcal.own_commands import EXIT_CODES
from sepcal.progress import show_engine

Array = npt.NDArray[np.float64]
ROWS = 1500
STEP = 0.1  # [s]


def _wander(rng: np.random.Generator, seconds: float) -> Array:
    """Gauss-Markov, of standard deviation one."""
    keep = np.exp(-STEP / seconds)
    values = np.zeros(ROWS)
    values[0] = rng.normal()
    for row in range(1, ROWS):
        values[row] = keep * values[row - 1] + np.sqrt(1 - keep**2) * rng.normal()
    return values


def _noise(rng: np.random.Generator, size: float, quantum: float, values: Array) -> Array:
    """White noise, a little that goes on, and a converter's steps."""
    read = values + size * (rng.normal(size=ROWS) + 0.5 * _wander(rng, 1.0))
    return np.round(read / quantum) * quantum


def _common(rng: np.random.Generator) -> dict[str, Array]:
    time = STEP * np.arange(ROWS)
    return {
        "time_s": time,
        "supply_v": np.round(12.0 - time / 400.0 + 0.05 * _wander(rng, 20.0), 2),
        "humidity_pct": np.round(50.0 + 10.0 * _wander(rng, 60.0), 1),
    }


def _hot_wire(rng: np.random.Generator, hidden: float) -> dict[str, Array]:
    log = _common(rng)
    temp = 20.0 + 8.0 * np.sin(log["time_s"] / 31.0) + 2.0 * _wander(rng, 30.0)
    speed = 15.0 + 9.0 * np.sin(log["time_s"] / 7.0) + _wander(rng, 2.0)
    clean = (2.0 + 1.1 * speed**0.45) * (1.0 - hidden * (temp - 20.0))
    return log | {
        "u_mps": speed,
        "temp_degc": np.round(temp, 1),
        "e2": _noise(rng, 0.01, 0.002, clean),
    }


def _potentiometer(rng: np.random.Generator, hidden: float) -> dict[str, Array]:
    log = _common(rng)
    angle = 1.2 * np.sin(log["time_s"] / 3.0) + 0.3 * _wander(rng, 5.0)
    direction = np.sign(np.gradient(np.convolve(angle, np.ones(9) / 9, mode="same")))
    clean = 2.5 + 0.8 * (angle + hidden * direction)
    return log | {
        "angle_deg": np.degrees(angle),
        "direction": direction,
        "wiper_v": _noise(rng, 0.004, 0.001, clean),
    }


def _thermistor(rng: np.random.Generator, hidden: float) -> dict[str, Array]:
    log = _common(rng)
    temp = 25.0 + 20.0 * np.sin(log["time_s"] / 25.0)
    power = 2.0 + 1.5 * np.sin(log["time_s"] / 9.0) + 0.3 * _wander(rng, 10.0)
    own = temp + hidden * power + 273.15
    clean = 10.0 * np.exp(3435.0 * (1.0 / own - 1.0 / 298.15))
    return log | {
        "T_degc": temp,
        "power_mw": np.round(power, 2),
        "R_kohm": _noise(rng, 0.01, 0.001, clean),
    }


def _radar_altimeter(rng: np.random.Generator, hidden: float) -> dict[str, Array]:
    log = _common(rng)
    height = 300.0 + 80.0 * np.sin(log["time_s"] / 40.0) + 5.0 * _wander(rng, 5.0)
    roll = np.radians(35.0) * np.tanh(2.0 * np.sin(log["time_s"] / 11.0))
    slant = 1.0 / np.cos(roll) - 1.0
    clean = 0.6 + height * (1.0 + hidden * slant)
    return log | {
        "height_ft": height / 0.3048,
        "roll_deg": np.degrees(roll),
        "range_m": _noise(rng, 0.5, 0.1, clean),
    }


def _turntable(rng: np.random.Generator, hidden: float) -> dict[str, Array]:
    log = _common(rng)
    rate = 2.0 * np.sin(log["time_s"] / 17.0) + 0.2 * _wander(rng, 3.0)
    angle = np.mod(np.cumsum(rate) * STEP + np.pi, 2 * np.pi) - np.pi
    clean = 0.05 + 1.01 * 9.80665 * np.sin(angle + 0.04) + hidden * rate**2
    return log | {
        "angle_rad": angle,
        "rate_radps": rate,
        "a_mps2": _noise(rng, 0.02, 0.005, clean),
    }


class Subject(NamedTuple):
    """A model, its instrument, what is hidden in it, and names that are right for that."""

    make: Callable[[], Any]
    draw: Callable[[np.random.Generator, float], dict[str, Array]]
    hidden: float
    names: tuple[str, ...]
    truth: Mapping[str, float]


SUBJECTS = {
    "HotWire": Subject(
        models.HotWire, _hot_wire, 0.004, ("A[temp_degc]+B[temp_degc]", "B[temp_degc]",
        "A[temp_degc]", "u[temp_degc]"), {"n": 0.45},
    ),
    "Potentiometer": Subject(
        models.Potentiometer, _potentiometer, 0.02, ("v0[direction]", "angle[direction]",
        "wiper_bias[direction]"), {"v0": 2.5, "k": 0.8},
    ),
    "Thermistor": Subject(
        models.Thermistor, _thermistor, 0.4, ("T[power_mw]", "R_25[power_mw]"), {"beta": 3435.0},
    ),
    "RadarAltimeter": Subject(
        models.RadarAltimeter, _radar_altimeter, 1.0, ("s[roll_deg^2]", "s[spline(roll_deg,4)]"),
        {"s": 1.0},
    ),
    "TurntableAccelerometer": Subject(
        models.TurntableAccelerometer, _turntable, 0.1, ("b[rate_radps^2]",), {"b": 0.05},
    ),
}  # fmt: skip


def _draw(name: str, seed: int, scale: float = 1.0) -> sepcal.Flight:
    subject = SUBJECTS[name]
    columns = subject.draw(np.random.default_rng(seed), scale * subject.hidden)
    return sepcal.Flight(columns, name=f"{name}_{seed}")


def _write(flight: sepcal.Flight, file: Path) -> None:
    rows = np.column_stack([flight[header] for header in flight.columns])
    np.savetxt(file, rows, delimiter=",", header=",".join(flight.columns), comments="", fmt="%.10g")


@pytest.mark.parametrize("name", SUBJECTS)
def test_the_loop(name: str, tmp_path: Path) -> None:
    """Found, named, added: the error falls as promised and the estimates come right."""
    subject = SUBJECTS[name]
    flight = _draw(name, 1)
    base = sepcal.fit(subject.make(), flight, seed=1)
    assert isinstance(base, sepcal.Calibration)
    assert base.status == "converged"
    found = base.diagnose()
    assert found.verdict == "effect_missing", found.text
    assert found.effects[0].name in subject.names, found.text
    advised = found.advice.effect
    assert advised is not None, found.text
    better = base.add(advised)
    entry = better.history[-1]
    achieved = 1.0 - entry.rmse_after / entry.rmse_before
    assert achieved == pytest.approx(found[advised].predicted_drop, abs=0.05)
    compared = better.compare()
    assert compared.overall[0].rmse < 0.7 * base.compare().overall[0].rmse
    file = tmp_path / "better.json"
    better.save(file)
    again = sepcal.load(file, model=subject.make())
    assert isinstance(again, sepcal.Calibration)
    assert again.to_json() == better.to_json()
    other = _draw(name, 2)
    ((header, fitted),) = again.apply(other).items()
    output = better.own_model.outputs[0] if better.own_model else ""
    read = next(other[column] for column in other.columns if column.split("_")[0] == output)
    assert header.startswith(f"{output}_fit")
    left = np.sqrt(np.nanmean((read - fitted) ** 2))
    assert left == pytest.approx(compared.overall[0].rmse, rel=0.2)


@pytest.mark.parametrize("name", SUBJECTS)
def test_nothing_is_called_missing_where_nothing_is(name: str) -> None:
    """The same instruments with nothing hidden."""
    base = sepcal.fit(SUBJECTS[name].make(), _draw(name, 3, scale=0.0), seed=1)
    assert base.diagnose().verdict == "adequate"  # type: ignore[union-attr]
    for parameter, true in SUBJECTS[name].truth.items():
        estimate = base[parameter]
        assert abs(estimate.value - true) < 4.0 * estimate.standard_error


def _run(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "sepcal", *words], capture_output=True, text=True, check=False,
        env=os.environ,
    )  # fmt: skip


def test_every_verb_from_the_command_line(tmp_path: Path) -> None:
    """check, fit, compare, diagnose, add, intervals, apply and report, by file and class."""
    model = ("--model", f"{FILE}:HotWire")
    log, base, better = (str(tmp_path / name) for name in ("tunnel.csv", "base.json", "b.json"))
    _write(_draw("HotWire", 1), Path(log))
    checked = _run("check", *model, log)
    assert checked.returncode == 0, checked.stderr
    assert "u_mps" in checked.stdout
    fitted = _run("fit", *model, log, "-o", base, "--seed", "1")
    assert fitted.returncode == 0, fitted.stderr
    assert json.loads(Path(base).read_text())["model"] == "HotWire"
    compared = _run("compare", *model, log, base)
    assert compared.returncode == 0
    assert "temp_degc" in compared.stdout
    found = _run("diagnose", *model, log, base, "--json")
    assert found.returncode == 3, found.stderr
    effect = json.loads(found.stdout)["advice"]["effect"]
    assert "temp_degc" in effect
    added = _run("add", *model, log, base, effect, "-o", better)
    assert added.returncode == 0, added.stderr
    intervals = _run("intervals", *model, log, better)
    assert intervals.returncode == 0, intervals.stderr
    assert "n " in intervals.stdout
    applied = _run("apply", *model, log, better, "-o", str(tmp_path / "applied.csv"))
    assert applied.returncode == 0, applied.stderr
    assert "e2_fit_v2" in (tmp_path / "applied.csv").read_text().splitlines()[0]
    page = tmp_path / "report.html"
    pytest.importorskip("plotly")
    told = _run("report", *model, log, base, better, "-o", str(page))
    assert told.returncode == 0, told.stderr
    assert "HotWire" in page.read_text()


@pytest.mark.parametrize(
    ("named", "said"),
    [
        ("HotWire", "FILE.py:CLASS"),
        ("nowhere.py:HotWire", "there is no file nowhere.py"),
        (f"{FILE}:ColdWire", "has no class ColdWire"),
        ("sepcal:ColdWire", "sepcal has no class ColdWire"),
        ("nowhere:HotWire", "there is no file nowhere"),
        ("sepcal:Magnetometer", "Magnetometer ships with sepcal"),
    ],
)
def test_a_model_that_is_not_there_is_named(named: str, said: str, tmp_path: Path) -> None:
    """One line, and no file."""
    log = tmp_path / "tunnel.csv"
    _write(_draw("HotWire", 1), log)
    refused = _run("fit", "--model", named, str(log), "-o", str(tmp_path / "base.json"))
    assert refused.returncode == 2
    assert said in refused.stderr
    assert len(refused.stderr.splitlines()) == 1
    assert not (tmp_path / "base.json").exists()


def test_a_model_of_a_module_is_found(tmp_path: Path) -> None:
    """One that ships without a probe, say."""
    turned = np.random.default_rng(5).standard_normal((3, 60))
    turned *= 9.81 / np.linalg.norm(turned, axis=0)
    force = dict(zip(("fx", "fy", "fz"), turned, strict=True))
    read = {f"a{axis}": 1.01 * force[f"f{axis}"] + 0.2 for axis in "xyz"}
    log, base = tmp_path / "turntable.csv", tmp_path / "base.json"
    _write(sepcal.Flight({"time_s": 0.1 * np.arange(60.0), **force, **read}), log)
    fitted = _run("fit", "--model", "sepcal:Accelerometer", str(log), "-o", str(base))
    assert fitted.returncode == 0, fitted.stderr
    again = sepcal.load(base, model=sepcal.Accelerometer())
    assert again["n_z"].value == pytest.approx(0.2, abs=1e-9)


def test_a_calibration_needs_its_model(tmp_path: Path) -> None:
    """Without it, or with another one, the file is refused by one line."""
    file = tmp_path / "base.json"
    base = sepcal.fit(models.HotWire(), _draw("HotWire", 1), seed=1)
    assert isinstance(base, sepcal.Calibration)
    base.save(file)
    with pytest.raises(sepcal.Error, match="HotWire"):
        sepcal.load(file)
    with pytest.raises(sepcal.Error, match="'HotWire', and the one given is 'Thermistor'"):
        sepcal.load(file, model=models.Thermistor())
    again = pickle.loads(pickle.dumps(base))
    assert again.to_json() == base.to_json()
    assert again.compare(_draw("HotWire", 1)).overall[0].rmse == base.compare().overall[0].rmse


def test_headers_with_and_without_units() -> None:
    """u_mps, u_kt and u are one input; what is missing is named with what would do."""
    flight = _draw("HotWire", 1)
    columns = dict(flight)
    speed = columns.pop("u_mps")
    fits = [
        sepcal.fit(models.HotWire(), sepcal.Flight(columns | {header: values}), seed=1)
        for header, values in (("u_mps", speed), ("u", speed), ("u_kmh", speed * 3.6))
    ]
    np.testing.assert_allclose(fits[1].values, fits[0].values, rtol=1e-12)
    np.testing.assert_allclose(fits[2].values, fits[0].values, rtol=1e-7)
    with pytest.raises(sepcal.Error, match="column 'u_mps' is missing"):
        sepcal.fit(models.HotWire(), sepcal.Flight(columns))


def test_several_flights_together() -> None:
    """A zero of its own for every run, the rest shared."""
    flights = [_draw("Potentiometer", seed, scale=0.0) for seed in (4, 5)]
    joint = sepcal.fit_jointly(models.Potentiometer(), flights, own=["v0"])
    assert joint["k"].value == pytest.approx(0.8, abs=4 * joint["k"].standard_error)
    assert {"v0@Potentiometer_4", "v0@Potentiometer_5"} <= set(joint.names)


class Spring:
    """A force without a zero of its own; of a unit that no header spells."""

    inputs = (("x", "mm"),)
    outputs = (("y", "µN"),)
    linear = (("k", "µN/mm"),)
    nonlinear = ()

    def at(self, u: Any, xi2: Array) -> tuple[Array, Array]:  # noqa: D102
        return u.x[:, np.newaxis, np.newaxis], np.zeros((u.x.size, 1))


def _pull(zero: float) -> sepcal.Flight:
    rng = np.random.default_rng(8)
    log = _common(rng)
    x = 5.0 + 4.0 * np.sin(log["time_s"] / 5.0)
    return sepcal.Flight(log | {"x": x, "y_un": _noise(rng, 0.05, 0.01, 0.8 * x + zero)})


def test_a_zero_that_the_model_lacks_is_found() -> None:
    """A constant, where no parameter is one."""
    base = sepcal.fit(Spring(), _pull(0.3))
    assert isinstance(base, sepcal.Calibration)
    found = base.diagnose()
    assert found.verdict == "effect_missing"
    assert found.effects[0].name == "y_bias", found.text
    better = base.add("y_bias")
    assert better["k"].value == pytest.approx(0.8, abs=4 * better["k"].standard_error)
    assert better["y_bias.s"].value == pytest.approx(0.3, abs=4 * better["y_bias.s"].standard_error)


def test_units_that_changed_are_refused(tmp_path: Path) -> None:
    """The same names in another unit are another model."""
    base = sepcal.fit(Spring(), _pull(0.0))
    assert isinstance(base, sepcal.Calibration)
    base.save(tmp_path / "base.json")
    changed = type("Spring", (Spring,), {"inputs": (("x", "m"),)})
    with pytest.raises(sepcal.Error, match="have changed since it was fitted"):
        sepcal.load(tmp_path / "base.json", model=changed())


def test_a_report_spares_the_model(tmp_path: Path) -> None:
    """The file of the model is an input of every verb."""
    model, log, base = tmp_path / "m.py", tmp_path / "tunnel.csv", tmp_path / "base.json"
    model.write_text(FILE.read_text())
    _write(_draw("HotWire", 1), log)
    named = ("--model", f"{model}:HotWire")
    assert _run("fit", *named, str(log), "-o", str(base)).returncode == 0
    refused = _run("report", *named, str(log), str(base), "-o", str(model))
    assert refused.returncode == 2
    assert model.read_text() == FILE.read_text()


def test_a_joint_fit_from_the_command_line(tmp_path: Path) -> None:
    """One of its logs is compared; to diagnose it all of them are needed, which is said."""
    logs = [str(tmp_path / f"{name}.csv") for name in ("monday", "tuesday")]
    for seed, log in enumerate(logs, 4):
        _write(_draw("Potentiometer", seed, scale=0.0), Path(log))
    named, base = ("--model", f"{FILE}:Potentiometer"), str(tmp_path / "base.json")
    fitted = _run("fit", *named, *logs, "--own", "v0", "-o", base)
    assert fitted.returncode == 0, fitted.stderr
    assert "v0@tuesday" in fitted.stdout
    assert _run("compare", *named, logs[0], base).returncode == 0
    refused = _run("diagnose", *named, logs[0], base)
    assert refused.returncode == 2
    assert "is of 2 flights; give them all" in refused.stderr


def test_exit_codes_are_those_of_the_apps() -> None:
    """A slow change or what nothing explains is 6, as docs/commands.md has it."""
    told = {"adequate": 0, "effect_missing": 3, "slow_change": 6, "unexplained": 6}
    told |= {"converged": 0, "not_identifiable": 4, "not_converged": 5}
    assert told == EXIT_CODES


# --- what others found with models of their own


class VoltAndLoad:
    """Two outputs of different units; the temperature shifts the first alone."""

    inputs: ClassVar = {"x": "m"}
    outputs: ClassVar = {"volt": "V", "load": "N"}
    linear: ClassVar = {"v0": "V", "gain": "V/m", "p": "N"}
    nonlinear: ClassVar = {"c": ("1/m", -2.0, 2.0)}

    def at(self, u: Any, xi2: Array) -> tuple[Array, Array]:
        """Z = A xi1 + b."""
        A = np.zeros((u.x.size, 2, 3))
        A[:, 0, 0], A[:, 0, 1], A[:, 1, 2] = 1.0, u.x, np.exp(xi2[0] * u.x)
        return A, np.zeros((u.x.size, 2))


def _volts_and_loads(seed: int) -> sepcal.Flight:
    rng = np.random.default_rng(seed)
    time = 0.05 * np.arange(800.0)
    x = np.sin(0.7 * time) + 0.3 * np.sin(0.19 * time)
    temp = 20.0 + 6.0 * np.sin(0.05 * time) + 0.05 * rng.standard_normal(time.size)
    volt = 0.5 + 0.02 * x + 0.002 * (temp - 20.0) + 0.001 * rng.standard_normal(time.size)
    load = 800.0 * np.exp(0.3 * x) + 2.5 * rng.standard_normal(time.size)
    return sepcal.Flight({"time_s": time, "x_m": x, "temp_degc": temp, "volt": volt, "load": load})


def test_a_step_is_measured_as_it_was_promised_where_units_differ() -> None:
    """Each output by its own before: of two, one falls to a tenth and the other stays."""
    base = sepcal.fit(VoltAndLoad(), _volts_and_loads(1))
    assert isinstance(base, sepcal.Calibration)
    better = base.add("v0[temp_degc]")
    entry = better.history[0]
    ratios = [better.rmse[name] / base.rmse[name] for name in ("volt", "load")]
    assert entry.rmse_before == pytest.approx(1.0)
    assert entry.rmse_after == pytest.approx(np.sqrt(np.mean(np.square(ratios))))
    assert 1.0 - entry.rmse_after == pytest.approx(entry.predicted_drop, abs=0.02)
    assert "each by its own before" in better.text
    assert "volt" in repr(better)
    again = better.add("p[temp_degc]").history  # and the chain goes on where it ended
    assert again[1].rmse_before == pytest.approx(again[0].rmse_after)


@pytest.mark.parametrize("auto", [False, True])
def test_what_a_calibration_has_already_may_be_asked_for(*, auto: bool) -> None:
    """`only` what it has leaves nothing to ask, and a note says so."""
    base = sepcal.fit(VoltAndLoad(), _volts_and_loads(1), effects=["v0[temp_degc]"])
    assert isinstance(base, sepcal.Calibration)
    found = base.diagnose(auto=auto, only=["v0[temp_degc]"])
    last = found.diagnosis if isinstance(found, sepcal.Stepwise) else found
    assert list(last.effects) == []
    assert "has v0[temp_degc] already" in "".join(last.notes)


def test_squares_of_channels_are_candidates_at_inputs() -> None:
    base = sepcal.fit(VoltAndLoad(), _volts_and_loads(1))
    assert isinstance(base, sepcal.Calibration)
    asked = {effect.name for effect in base.diagnose().effects}
    assert {"x[temp_degc]", "x[temp_degc^2]", "v0[temp_degc^2]"} <= asked


def test_the_unit_of_a_square_is_that_of_the_whole() -> None:
    flight = _volts_and_loads(1)
    columns = {name: flight[name] for name in flight.columns}
    columns["rate_degps"] = np.cos(np.asarray(columns["time_s"]))
    effects = ["v0[rate_degps^2]", "v0[temp_degc^2]"]
    fit = sepcal.fit(VoltAndLoad(), sepcal.Flight(columns), effects=effects)
    assert fit["v0[rate_degps^2].s"].unit == "V per (deg/s)^2"
    assert fit["v0[temp_degc^2].s"].unit == "V per degC^2"


def test_a_file_that_has_changed_is_noted(tmp_path: Path) -> None:
    """The calibration keeps the model's file and its hash; commands that are printed name it."""
    file, log, base = tmp_path / "mine.py", tmp_path / "tunnel.csv", tmp_path / "base.json"
    file.write_text(FILE.read_text())
    _write(_draw("HotWire", 1), log)
    model = ("--model", f"{file}:HotWire")
    fitted = _run("fit", *model, str(log), "-o", str(base))
    assert fitted.returncode == 0, fitted.stderr
    source = json.loads(base.read_text())["source"]
    assert source["sha256"] == hashlib.sha256(file.read_bytes()).hexdigest()
    assert source["model"].endswith("mine.py:HotWire")
    same = _run("diagnose", *model, str(log), str(base))
    assert "has changed since the fit" not in same.stderr
    assert f"add --model {source['model']}" in same.stdout
    file.write_text(file.read_text() + "\n# another line\n")
    for verb in ("compare", "diagnose"):
        changed = _run(verb, *model, str(log), str(base))
        assert "mine.py:HotWire has changed since the fit" in changed.stderr


def test_a_model_that_fails_is_named_with_its_line(tmp_path: Path) -> None:
    file, log = tmp_path / "mine.py", tmp_path / "tunnel.csv"
    text = FILE.read_text().replace("def at(", "def at(", 1)
    at = text.index("def at(", text.index("class HotWire"))
    end = text.index(":\n", at) + 2
    file.write_text(text[:end] + "        raise ZeroDivisionError('oops')\n" + text[end:])
    line = text[:end].count("\n") + 1
    _write(_draw("HotWire", 1), log)
    refused = _run("fit", "--model", f"{file}:HotWire", str(log), "-o", str(tmp_path / "b.json"))
    assert refused.returncode == 2
    assert f"line {line}: ZeroDivisionError: oops" in refused.stderr
    assert len(refused.stderr.splitlines()) == 1


def test_options_are_named_as_they_are_typed(tmp_path: Path) -> None:
    log = tmp_path / "tunnel.csv"
    flight = _draw("HotWire", 1)
    _write(flight, log)
    rows = log.read_text().splitlines()
    rows[5] = "," + rows[5].partition(",")[2]
    log.write_text("\n".join(rows) + "\n")
    model = ("--model", f"{FILE}:HotWire")
    refused = _run("fit", *model, str(log), "-o", str(tmp_path / "b.json"))
    assert "--drop-invalid" in refused.stderr
    taken = _run(
        "fit", *model, str(log), "-o", str(tmp_path / "b.json"), "--drop-invalid",
        "--bounds", "n=0.2,0.9", "--bounds", "B=0,", "--prior", "n=0.45:0.2", "--explain",
    )  # fmt: skip
    assert taken.returncode == 0, taken.stderr
    options = json.loads((tmp_path / "b.json").read_text())["options"]
    assert options["bounds"] == {"n": [0.2, 0.9], "B": [0.0, None]}
    assert options["prior"] == {"n": [0.45, 0.2]}
    zero = ("--samples", "0", "--noise-tolerance", "0")  # a value like another
    none = _run("fit", *model, str(log), "-o", str(tmp_path / "c.json"), "--drop-invalid", *zero)
    assert none.returncode == 2
    assert "--noise-tolerance must be positive" in none.stderr


def test_apply_notes_what_the_fit_never_saw(tmp_path: Path) -> None:
    log, hot = tmp_path / "tunnel.csv", tmp_path / "hot.csv"
    flight = _draw("HotWire", 1)
    _write(flight, log)
    base, model = str(tmp_path / "base.json"), ("--model", f"{FILE}:HotWire")
    _run("fit", *model, str(log), "--effect", "A[temp_degc]", "-o", base)
    columns = {name: np.array(flight[name]) for name in flight.columns}
    columns["temp_degc"] += 60.0
    _write(sepcal.Flight(columns), hot)
    out = str(tmp_path / "out.csv")
    assert "beyond" not in _run("apply", *model, str(log), base, "-o", out).stderr
    noted = _run("apply", *model, str(hot), base, "-o", str(tmp_path / "out2.csv"))
    assert "rows have temp_degc beyond" in noted.stderr


def test_what_is_being_done_is_heard() -> None:
    """What the commands show: tasks, and how far each is."""
    heard: list[tuple[str, float]] = []
    _core.hear_progress(lambda task, fraction: heard.append((task, fraction)))
    try:
        base = sepcal.fit(models.HotWire(), _draw("HotWire", 1), seed=1)
        assert isinstance(base, sepcal.Calibration)
        base.diagnose()
    finally:
        _core.hear_progress(None)
    assert {"stage one", "screening effects", "testing effects"} <= {task for task, _ in heard}
    assert all(0.0 <= fraction <= 1.0 for _, fraction in heard)
    count = len(heard)
    base.compare()
    assert len(heard) == count


def test_long_work_is_told_off_a_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    """A line every ten seconds says what is done, and for how long."""
    with show_engine("sepcal fit", every=0.02):
        time.sleep(0.2)
    assert "sepcal fit: at work, 0 s" in capsys.readouterr().err
