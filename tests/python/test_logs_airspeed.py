# SPDX-License-Identifier: BSD-3-Clause
"""From an autopilot's log of a tube to its parameters: the sensor's kind goes with the readings."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal
from log_writers import DataFlashWriter, ULogWriter
from oracle import autopilots
from oracle.model import Array
from tube_flights import HIGH_AND_HOT, Air, ardupilot_pressure, fly, px4_pressure

SDP32, MS4525, UNKNOWN = 0x4B2508, 0x482801, 0x0D0A01


def px4_log(
    columns: dict[str, Array], pressure: Array, device: int, **settings: float
) -> ULogWriter:
    """Of PX4 1.13 and later; the settings are parameters."""
    log = ULogWriter(tuple(settings.items()), [("sys_name", "PX4")])
    log.form(
        "differential_pressure",
        "uint32_t device_id;float differential_pressure_pa;float temperature",
    )
    log.form("vehicle_local_position", "float vx;float vy;float vz;bool v_xy_valid;bool v_z_valid")
    log.form("vehicle_air_data", "float baro_pressure_pa;float rho")
    for row, t in enumerate(columns["time_s"] + 20):
        velocity = [columns[f"v{axis}_mps"][row] for axis in "ned"]
        static, warm = columns["ps_pa"][row], columns["temp_degc"][row]
        log.add(t, "vehicle_local_position", *velocity, True, True)
        log.add(t, "vehicle_air_data", static, static / (287.05287 * (warm + 273.15)))
        log.add(t, "differential_pressure", device, pressure[row], warm)
    return log


def ardupilot_log(
    columns: dict[str, Array], pressure: Array, **parameters: float
) -> DataFlashWriter:
    """Of ArduPlane 4; DiffPress is what the sensor's driver hands on."""
    log = DataFlashWriter()
    log.form("PARM", "QNff", "TimeUS,Name,Value,Default")
    log.form("XKF1", "QBccCfff", "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD")
    log.form("BARO", "QBffc", "TimeUS,I,Alt,Press,Temp")
    log.form("ARSP", "QBffcff", "TimeUS,I,Airspeed,DiffPress,Temp,RawPress,Offset")
    for name, value in parameters.items():
        log.add(19, "PARM", 19e6, name, value, 0.0)
    for row, t in enumerate(columns["time_s"] + 20):
        us, warm = round(t * 1e6), columns["temp_degc"][row]
        velocity = [columns[f"v{axis}_mps"][row] for axis in "ned"]
        log.add(t, "XKF1", us, 0, 0, 0, 0, *velocity)
        log.add(t, "BARO", us, 0, 0.0, columns["ps_pa"][row], warm + 8)
        log.add(t, "ARSP", us, 0, 20.0, pressure[row], warm, pressure[row], 0.0)
    return log


def write(log: ULogWriter | DataFlashWriter, file: Path) -> None:
    file.write_bytes(log.data())


def export(flight: sepcal.Flight, target: str, folder: Path) -> sepcal.Exported:
    calibration = sepcal.fit(sepcal.PitotStatic(), flight)
    return sepcal.export(calibration, folder / "vehicle", target, flight=flight)


@pytest.mark.parametrize(("model", "length", "diameter"), [(0, 0.2, 1.5), (2, 0.35, 1.8)])
def test_px4_with_a_flow_sensor(tmp_path: Path, model: int, length: float, diameter: float) -> None:
    columns, at = fly(HIGH_AND_HOT)
    pressure = px4_pressure(at, 1.05, model=model, length=length, diameter_mm=diameter)
    air = {"CAL_AIR_CMODEL": model, "CAL_AIR_TUBELEN": length, "CAL_AIR_TUBED_MM": diameter}
    write(px4_log(columns, pressure, SDP32, **air), tmp_path / "flight.ulg")
    assert f"device {SDP32}, SDP32" in str(sepcal.list_log(tmp_path / "flight.ulg"))
    flight = sepcal.read_log(tmp_path / "flight.ulg")
    assert_allclose(flight["air_device_id"], SDP32)
    assert_allclose(flight["cal_air_tubelen_m"], length, rtol=1e-6)
    assert_allclose(flight["ps_pa"], at.static, rtol=1e-6)
    written = export(flight, "px4", tmp_path)
    assert written.parameters["ASPD_SCALE_1"] == pytest.approx(1.05, rel=3e-3)
    assert any("says SDP32" in note for note in written.notes)


def test_a_venturi_reads_the_other_way(tmp_path: Path) -> None:
    """CAL_AIR_CMODEL 3: PX4 changes the sign, and so does the import."""
    columns, at = fly(HIGH_AND_HOT)
    pressure = px4_pressure(at, 1.05)
    write(px4_log(columns, -pressure, SDP32, CAL_AIR_CMODEL=3), tmp_path / "flight.ulg")
    flight = sepcal.read_log(tmp_path / "flight.ulg")
    assert_allclose(flight["dp_pa"], pressure, rtol=1e-6)
    assert "CAL_AIR_CMODEL is 3" in " ".join(flight.conversion["columns"]["dp_pa"]["done"])
    scale = export(flight, "px4", tmp_path).parameters["ASPD_SCALE_1"]
    assert scale == pytest.approx(1.05, rel=3e-3)


@pytest.mark.parametrize(
    ("device", "said"),
    [(MS4525, "says MS4525DO"), (UNKNOWN, "a kind, 0xd, that is not known"), (0, "is not known")],
)
def test_px4_with_another_sensor(tmp_path: Path, device: int, said: str) -> None:
    columns, at = fly(HIGH_AND_HOT)
    pressure = 0.5 * 1.225 * (at.equivalent / 1.05) ** 2
    write(px4_log(columns, pressure, device), tmp_path / "flight.ulg")
    flight = sepcal.read_log(tmp_path / "flight.ulg")
    assert ("air_device_id" in flight) == (device != 0)
    assert "cal_air_cmodel" not in flight
    written = export(flight, "px4", tmp_path)
    assert written.parameters["ASPD_SCALE_1"] == pytest.approx(1.05, rel=3e-3)
    assert any(said in note for note in written.notes)


def handed_on(at: Air, pressure: Array, ratio: float) -> Array:
    return np.array(
        [
            autopilots.ardupilot_sdp3x(np.array(p), static, kelvin, ratio)
            for p, static, kelvin in zip(pressure, at.static, at.kelvin, strict=True)
        ]
    )


def test_ardupilot_with_a_flow_sensor(tmp_path: Path) -> None:
    """The driver's correction, which holds the ratio in use, is undone; another ratio is right."""
    columns, at = fly(HIGH_AND_HOT)
    pressure = ardupilot_pressure(at, 2.2)
    logged = handed_on(at, pressure, 1.9)
    log = ardupilot_log(columns, logged, ARSPD_TYPE=6, ARSPD_RATIO=1.9)
    write(log, tmp_path / "flight.bin")
    flight = sepcal.read_log(tmp_path / "flight.bin")
    assert_allclose(flight["dp_pa"], pressure, rtol=1e-4)  # Temp is logged in hundredths
    assert "undone: what ArduPilot adds" in " ".join(flight.conversion["columns"]["dp_pa"]["done"])
    written = export(flight, "ardupilot", tmp_path)
    assert written.parameters == {"ARSPD_RATIO": pytest.approx(2.2, rel=6e-3)}


def test_ardupilot_with_a_membrane(tmp_path: Path) -> None:
    columns, at = fly(HIGH_AND_HOT)
    pressure = at.equivalent**2 / 1.8
    log = ardupilot_log(columns, pressure, ARSPD_TYPE=1, ARSPD_RATIO=1.9936)
    write(log, tmp_path / "flight.bin")
    flight = sepcal.read_log(tmp_path / "flight.bin")
    assert_allclose(flight["dp_pa"], pressure, rtol=1e-6)
    written = export(flight, "ardupilot", tmp_path)
    assert written.parameters["ARSPD_RATIO"] == pytest.approx(1.8, rel=6e-3)
    assert any("ARSPD_TYPE, 1" in note for note in written.notes)
