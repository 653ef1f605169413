# SPDX-License-Identifier: BSD-3-Clause
"""A tube's scale as the autopilots read each sensor: membranes, and SDP31, 32, 33 with their flow.

The flights are made here: air at a given density, a wind, and pressures that are the inverse of the
autopilot's own formula with a known scale, so that this scale is the right answer.
"""

from pathlib import Path

import numpy as np
import pytest

from apps import Bench, Outcome, assert_refused
from oracle import autopilots
from oracle.model import Array
from tube_flights import HIGH_AND_HOT, SEA_LEVEL, ardupilot_pressure, fly, px4_pressure

SDP33 = 0x4C2508  # a device id of PX4: kind, address, bus
MS4525 = 0x482801
NO_KIND = 0x0D0A01


def write(folder: Path, columns: dict[str, Array]) -> Bench:
    bench = Bench("sepcal-pitot", folder, (), None)  # type: ignore[arg-type]
    lines = [",".join(columns)]
    lines += [",".join(repr(float(v)) for v in row) for row in zip(*columns.values(), strict=True)]
    bench.flight.write_text("\n".join(lines) + "\n")
    return bench


def calibrate(bench: Bench) -> None:
    done = bench.run("fit", "flight.csv", "-o", "base.json")
    assert done.code == 0, done.err


def export(bench: Bench, target: str, *more: str) -> Outcome:
    done = bench.run("export", "base.json", "--to", target, "-o", "vehicle", "--json", *more)
    assert done.code == 0, done.err
    return done


def px4_flight(
    folder: Path, air: tuple[float, float], scale: float, offset: float = 0.0, **settings: float
) -> Bench:
    """A flight whose SDP3x reads so that ASPD_SCALE_1 and SENS_DPRES_OFF are these."""
    columns, at = fly(air)
    columns["dp_pa"] = px4_pressure(at, scale, **settings) + offset
    columns["dp_pa"] += np.random.default_rng(5).normal(0, 0.3, len(at.speed))
    bench = write(folder, columns)
    calibrate(bench)
    return bench


@pytest.mark.parametrize("air", [SEA_LEVEL, HIGH_AND_HOT], ids=["sea level", "high"])
@pytest.mark.parametrize("length", [0.05, 0.2, 0.35])
@pytest.mark.parametrize("model", [0, 1, 2])
def test_px4_with_a_flow_sensor(
    tmp_path: Path, air: tuple[float, float], length: float, model: int
) -> None:
    bench = px4_flight(tmp_path, air, 1.07, model=model, length=length)
    export(bench, "px4", "--airspeed-sensor", "sdp3x", "--cal-air", f"{model},{length},1.5")
    found = autopilots.read_px4(tmp_path / "vehicle")
    assert found["ASPD_SCALE_1"] == pytest.approx(1.07, rel=3e-3)
    assert found["SENS_DPRES_OFF"] == pytest.approx(0, abs=0.6)


def test_an_offset_of_a_flow_sensor(tmp_path: Path) -> None:
    """Offset and scale at once: the offset acts before the flow's losses."""
    bench = px4_flight(tmp_path, HIGH_AND_HOT, 0.93, offset=6.0)
    export(bench, "px4", "--airspeed-sensor", "sdp3x")
    found = autopilots.read_px4(tmp_path / "vehicle")
    assert found["ASPD_SCALE_1"] == pytest.approx(0.93, rel=3e-3)
    assert found["SENS_DPRES_OFF"] == pytest.approx(6.0, abs=0.6)


@pytest.mark.parametrize("air", [SEA_LEVEL, HIGH_AND_HOT], ids=["sea level", "high"])
def test_px4_with_a_membrane(tmp_path: Path, air: tuple[float, float]) -> None:
    columns, at = fly(air)
    columns["dp_pa"] = 0.5 * 1.225 * (at.equivalent / 1.07) ** 2
    bench = write(tmp_path, columns)
    calibrate(bench)
    export(bench, "px4", "--airspeed-sensor", "membrane")
    found = autopilots.read_px4(tmp_path / "vehicle")
    assert found["ASPD_SCALE_1"] == pytest.approx(1.07, rel=3e-3)


@pytest.mark.parametrize("air", [SEA_LEVEL, HIGH_AND_HOT], ids=["sea level", "high"])
@pytest.mark.parametrize("ratio", [1.7, 2.4])
def test_ardupilot_with_a_flow_sensor(
    tmp_path: Path, air: tuple[float, float], ratio: float
) -> None:
    columns, at = fly(air)
    columns["dp_pa"] = ardupilot_pressure(at, ratio)
    bench = write(tmp_path, columns)
    calibrate(bench)
    done = export(bench, "ardupilot", "--airspeed-sensor", "sdp3x")
    found = autopilots.read_ardupilot(tmp_path / "vehicle")
    assert found == {"ARSPD_RATIO": pytest.approx(ratio, rel=6e-3)}  # of the speed 3e-3
    assert "sets an SDP3x's offset to zero" in done.err


@pytest.mark.parametrize(
    ("device", "is_flow", "said"),
    [
        (SDP33, True, "the sensor's device id, 4990216, says SDP33"),
        (MS4525, False, "the sensor's device id, 4728833, says MS4525DO"),
        (NO_KIND, False, "the sensor's device id, 854529, says a kind, 0xd, that is not known"),
        (None, False, "the sensor is not known, and its pressure is taken as it is"),
    ],
)
def test_the_sensor_is_known_by_its_id(
    tmp_path: Path, device: int | None, is_flow: bool, said: str
) -> None:
    """By the option and by the log's column alike; an unknown sensor is said."""
    bench = px4_flight(tmp_path, SEA_LEVEL, 1.0)
    option = [] if device is None else ["--device-id", str(device)]
    done = export(bench, "px4", *option)
    assert said in done.err
    scale = autopilots.read_px4(tmp_path / "vehicle")["ASPD_SCALE_1"]
    assert scale == pytest.approx(1.0, rel=3e-3) if is_flow else scale > 1.1
    assert said in (tmp_path / "vehicle").read_text()
    if device is None:
        return
    text = bench.flight.read_text().splitlines()
    bench.flight.write_text(
        "\n".join([text[0] + ",air_device_id", *(f"{row},{device}" for row in text[1:])]) + "\n"
    )
    calibrate(bench)
    done = export(bench, "px4")
    assert said in done.err
    assert autopilots.read_px4(tmp_path / "vehicle")["ASPD_SCALE_1"] == pytest.approx(
        scale, rel=1e-6
    )


def test_the_logs_own_compensation_is_taken(tmp_path: Path) -> None:
    bench = px4_flight(tmp_path, HIGH_AND_HOT, 1.07, model=2, length=1.2, diameter_mm=2.0)
    text = bench.flight.read_text().splitlines()
    head = ",air_device_id,cal_air_cmodel,cal_air_tubelen_m,cal_air_tubed_mm"
    rows = [f"{row},{SDP33},2,1.2,2" for row in text[1:]]
    bench.flight.write_text("\n".join([text[0] + head, *rows]) + "\n")
    calibrate(bench)
    done = export(bench, "px4")
    found = autopilots.read_px4(tmp_path / "vehicle")
    assert found["ASPD_SCALE_1"] == pytest.approx(1.07, rel=3e-3)
    notes = done.err
    assert "a CAL_AIR_CMODEL of 2, a CAL_AIR_TUBELEN of 1.2 m and a CAL_AIR_TUBED_MM of 2" in notes
    assert "ASPD_SCALE_n holds from the next start of the autopilot on" in notes
    bench.flight.write_text(
        "\n".join([text[0] + head, *rows[:-1], rows[-1].replace(",2,1.2,2", ",0,1.2,2")]) + "\n"
    )
    calibrate(bench)
    words = ("cal_air_cmodel changes within the flight", "take a part")
    assert_refused(bench, "export", "base.json", "--to", "px4", words=words)


@pytest.mark.parametrize("sensor", ["membrane", "sdp3x"])
def test_an_equivalent_airspeed_that_was_logged(tmp_path: Path, sensor: str) -> None:
    """What PX4 calls indicated, with the scale that was in use taken out again."""
    columns, at = fly(HIGH_AND_HOT)
    columns["airspeed_mps"] = at.equivalent * 1.1 / 1.04
    bench = write(tmp_path, columns)
    calibrate(bench)
    more = ("--logged-airspeed", "equivalent", "--in-use", "1.1", "--airspeed-sensor", sensor)
    export(bench, "px4", *more)
    found = autopilots.read_px4(tmp_path / "vehicle")
    assert found["ASPD_SCALE_1"] == pytest.approx(1.04, rel=3e-3)


def test_an_equivalent_airspeed_of_ardupilot(tmp_path: Path) -> None:
    """By ARSPD_RATIO 1.9936 in use; the right one is that times the square of the error."""
    columns, at = fly(HIGH_AND_HOT)
    columns["airspeed_mps"] = at.equivalent / 1.04
    bench = write(tmp_path, columns)
    calibrate(bench)
    export(bench, "ardupilot", "--logged-airspeed", "equivalent", "--in-use", "1.9936",
           "--airspeed-sensor", "membrane")  # fmt: skip
    found = autopilots.read_ardupilot(tmp_path / "vehicle")
    assert found["ARSPD_RATIO"] == pytest.approx(1.9936 * 1.04**2, rel=6e-3)


def test_what_can_not_be_held_is_refused(tmp_path: Path) -> None:
    bench = px4_flight(tmp_path, SEA_LEVEL, 1.0)
    export_px4 = ("export", "base.json", "--to", "px4")
    flow = (*export_px4, "--airspeed-sensor", "sdp3x")
    for more, words in (
        ((*flow, "--cal-air", "4,0.2,1.5"), ("--cal-air", "CAL_AIR_CMODEL 4", "0 to 3")),
        ((*flow, "--cal-air", "0,-1,1.5"), ("--cal-air", "CAL_AIR_TUBELEN -1")),
        ((*flow, "--cal-air", "0,1,0"), ("--cal-air", "CAL_AIR_TUBED_MM 0")),
        ((*flow, "--cal-air", "0,1"), ("--cal-air", "0,0.2,1.5")),
        (
            (*export_px4, "--cal-air", "0,0.2,1.5", "--airspeed-sensor", "membrane"),
            ("--cal-air is of PX4 with an SDP3x",),
        ),
        ((*export_px4, "--airspeed-sensor", "sdp4"), ("--airspeed-sensor", "'membrane', 'sdp3x'")),
        (
            (*export_px4, "--logged-airspeed", "equivalent"),
            ("--logged-airspeed is of a logged airspeed", "dp_pa"),
        ),
        (
            ("export", "base.json", "--to", "c", "--airspeed-sensor", "sdp3x"),
            ("--airspeed-sensor is of an autopilot's airspeed",),
        ),
    ):
        assert_refused(bench, *more, words=words)


def test_a_flow_sensor_needs_the_air(tmp_path: Path) -> None:
    columns, at = fly(SEA_LEVEL)
    del columns["ps_pa"], columns["temp_degc"]
    columns |= {"rho_kgpm3": at.density, "dp_pa": 0.5 * at.density * at.speed**2}
    bench = write(tmp_path, columns)
    calibrate(bench)
    words = ("an SDP3x is corrected by the static pressure", "ps_pa and temp_degc")
    command = ("export", "base.json", "--to", "px4", "--airspeed-sensor", "sdp3x")
    assert_refused(bench, *command, words=words)


def test_an_offset_that_ardupilot_does_not_keep(tmp_path: Path) -> None:
    bench = px4_flight(tmp_path, SEA_LEVEL, 1.0)
    done = bench.run("fit", "flight.csv", "--effect", "pressure_offset", "--fix", "c_va=0", "-o",
                     "base.json")  # fmt: skip
    assert done.code == 0, done.err
    command = ("export", "base.json", "--to", "ardupilot", "--airspeed-sensor", "sdp3x")
    words = ("ArduPilot sets an SDP3x's offset to zero", "--without pressure_offset")
    assert_refused(bench, *command, words=words)
    export(bench, "ardupilot", "--airspeed-sensor", "sdp3x", "--without", "pressure_offset")
    assert list(autopilots.read_ardupilot(tmp_path / "vehicle")) == ["ARSPD_RATIO"]
