# SPDX-License-Identifier: BSD-3-Clause
"""App and Python diagnose one file alike, byte for byte: same build, any number of threads."""

import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

import sepcal
from parity.programs import BUILD, write_flight


@dataclass(frozen=True)
class Setup:
    """A probe with an effect hidden from it, as both take it."""

    app: str
    model: sepcal.FiveHoleProbe | sepcal.PitotStatic | sepcal.Magnetometer
    hidden: dict[str, float]
    injected: tuple[str, float]


SETUPS = [
    Setup(
        "sepcal-pitot",
        sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5),
        {"airspeed_scale[alpha^2]": -1.5},
        ("wind[altitude_m]", 0.01),
    ),
    Setup(
        "sepcal-pitot", sepcal.PitotStatic(), {"airspeed_bias[throttle]": 1.5}, ("wind_drift", 0.02)
    ),
    Setup(
        "sepcal-mag",
        sepcal.Magnetometer(field=(19.7, -1.4, 49.4)),
        {"bias[current_a]": 0.05},
        ("scale[temp_degc]", 0.001),
    ),
    Setup(
        "sepcal-mag",
        sepcal.Magnetometer(field_strength=53.2),
        {"bias[current_a]": 0.1},
        ("scale[throttle]", 0.01),
    ),
]


@dataclass(frozen=True)
class Files:
    """A flight and its calibration, as files."""

    setup: Setup
    flight: Path
    base: Path

    def diagnose(self, *options: str) -> str:
        """What the app prints, whatever its verdict."""
        command = [BUILD / "apps" / self.setup.app, "diagnose", self.flight, self.base, "--json"]
        done = subprocess.run([*command, *options], capture_output=True, text=True, check=False)
        assert done.returncode in (0, 3, 6), done.stderr
        return done.stdout


@pytest.fixture(scope="module", params=SETUPS, ids=lambda setup: setup.model.name)
def files(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Files:
    """Each probe in turn; the calibration is Python's."""
    setup: Setup = request.param
    folder = tmp_path_factory.mktemp("same_diagnoses")
    flight, base = folder / "flight.csv", folder / "base.json"
    write_flight(sepcal.simulate(setup.model, rows=200, seed=7, hide=setup.hidden), flight)
    sepcal.fit(setup.model, sepcal.read_csv(flight)).save(base)
    return Files(setup, flight, base)


def test_the_app_diagnoses_as_python_does(files: Files) -> None:
    flight = sepcal.read_csv(files.flight)
    found = sepcal.load(files.base).diagnose(flight)
    assert found.to_json() == files.diagnose()
    assert found.verdict == "effect_missing"


def test_the_app_injects_as_python_does(files: Files) -> None:
    name, size = files.setup.injected
    found = sepcal.load(files.base).diagnose(sepcal.read_csv(files.flight), inject={name: size})
    assert found.injected is not None
    assert found.to_json() == files.diagnose("--inject", f"{name}={size}")
