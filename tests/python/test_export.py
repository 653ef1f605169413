# SPDX-License-Identifier: BSD-3-Clause
"""Parameters for autopilots: read back and applied by their own formulae, and what they lose."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import least_squares

import sepcal
from apps import Bench, Log, Outcome, assert_refused, parse_json
from oracle import autopilots
from oracle.five_hole_probe import rotate_to_navigation
from oracle.model import Array
from recorded import find_fixture

SINGLE = 3e-7  # relative, of numbers that a float holds, over a few operations
REFIT = ("--rotation", "refit")
READERS = {"px4": autopilots.read_px4, "ardupilot": autopilots.read_ardupilot}


def read_raw(log: Log) -> Array:
    return np.column_stack([log.column(f"m{axis}_ut") for axis in "xyz"])


def corrected_by(
    target: str, file: Path, raw: Array, sensor: int | None = None, motor: Array | float = 0.0
) -> Array:
    """The field, shape (N, 3), as the autopilot computes it with the exported parameters."""
    parameters = READERS[target](file)
    if target == "px4":
        return autopilots.px4_field(parameters, raw, sensor=sensor or 0, motor=motor)
    return autopilots.ardupilot_field(parameters, raw, sensor=sensor or 1, motor=motor)


def export(bench: Bench, target: str, *more: str, calibration: str = "base.json") -> Outcome:
    done = bench.run("export", calibration, "--to", target, "-o", "vehicle", "--json", *more)
    assert done.code == 0, done.err
    return done


def true_field(log: Log, field: Array | None = None) -> Array:
    """In body axes, of the logged field or another, in uT: shape (N, 3)."""
    attitude = {name: log.column(f"{name}_rad") for name in ("roll", "pitch", "yaw")}
    if field is None:
        field = np.column_stack([log.column(f"b{axis}_ut") for axis in "ned"])
    rows = np.broadcast_to(field, (len(log.rows), 3))
    return np.einsum("kji,kj->ki", rotate_to_navigation(attitude), rows)


def fit_motor(bench: Bench, header: str, size: float) -> Log:
    """Hides the field of a current or the throttle in the flight, and fits it to motor.json."""
    log = bench.read_log()
    for axis, share in zip("xyz", (1.0, -0.5, 0.75), strict=True):
        log.replace(f"m{axis}_ut", log.column(f"m{axis}_ut") + share * size * log.column(header))
    bench.flight.write_text(log.text())
    done = bench.run("fit", "flight.csv", "--effect", f"bias[{header}]", "-o", "motor.json")
    assert done.code == 0, done.err
    return log


@pytest.mark.parametrize("target", ["ardupilot", "px4"])
def test_a_field_is_what_the_best_symmetric_matrix_gives(magnetometer: Bench, target: str) -> None:
    """The matrix fitted anew in NumPy, by maximum likelihood."""
    log = magnetometer.read_log()
    export(magnetometer, target, *REFIT)
    C, n, _ = autopilots.fit_symmetric(true_field(log), read_raw(log))
    expected = (read_raw(log) - n) @ np.linalg.inv(C).T
    found = corrected_by(target, magnetometer.folder / "vehicle", read_raw(log))
    assert_allclose(found, expected, atol=SINGLE * 100)


@pytest.mark.parametrize(("header", "kind"), [("current_a", 2), ("throttle", 1)])
@pytest.mark.parametrize("target", ["ardupilot", "px4"])
def test_the_motors_field_is_compensated(
    magnetometer: Bench, target: str, header: str, kind: int
) -> None:
    log = fit_motor(magnetometer, header, 0.4 if header == "current_a" else 6.0)
    export(magnetometer, target, *REFIT, calibration="motor.json")
    driver = log.column(header)
    C, n, kappa = autopilots.fit_symmetric(true_field(log), read_raw(log), driver)
    expected = (read_raw(log) - n - np.outer(driver, kappa)) @ np.linalg.inv(C).T
    file = magnetometer.folder / "vehicle"
    found = corrected_by(target, file, read_raw(log), motor=driver)
    assert_allclose(found, expected, atol=SINGLE * 200)
    name = {"ardupilot": "COMPASS_MOTCT", "px4": "CAL_MAG_COMP_TYP"}[target]
    assert READERS[target](file)[name] == kind


@pytest.mark.parametrize(("target", "sensors"), [("ardupilot", (1, 2, 3)), ("px4", (0, 1, 2, 3))])
def test_every_sensor_gets_the_same_under_its_own_names(
    magnetometer: Bench, target: str, sensors: tuple[int, ...]
) -> None:
    raw = read_raw(fit_motor(magnetometer, "current_a", 0.4))
    found = []
    for sensor in sensors:
        export(magnetometer, target, "--sensor", str(sensor), calibration="motor.json")
        file = magnetometer.folder / "vehicle"
        found.append(corrected_by(target, file, raw, sensor, motor=12.0))
        assert len(READERS[target](file)) == {"ardupilot": 14, "px4": 13}[target]
    for other in found[1:]:
        np.testing.assert_array_equal(found[0], other)


def test_what_was_held_stays(magnetometer: Bench) -> None:
    """Soft iron held at none, as a flight asks for that hardly turns: no free off-diagonals."""
    held = [word for pair in ("xy", "xz", "yz") for word in ("--fix", f"alpha_{pair}=0")]
    eta = [word for axis in "xyz" for word in ("--fix", f"eta_{axis}=0")]
    assert magnetometer.run("fit", "flight.csv", *held, *eta, "-o", "held.json").code in (0, 4)
    done = export(magnetometer, "px4", "--force", calibration="held.json")
    loss = done.result["approximation"]
    assert loss["dropped"] == ["nothing, as the calibration does not turn the sensor"]
    text = (magnetometer.folder / "vehicle").read_text()
    assert "# heading: the calibration's\n# field's strength: the calibration's\n" in text
    parameters = autopilots.read_px4(magnetometer.folder / "vehicle")
    raw, field = read_raw(magnetometer.read_log()), true_field(magnetometer.read_log())
    for axis, name in enumerate("XYZ"):  # each axis a straight line of its own
        scale, bias = np.polyfit(field[:, axis], raw[:, axis], 1)
        assert parameters[f"CAL_MAG0_{name}SCALE"] == pytest.approx(1 / scale, rel=1e-6)
        assert parameters[f"CAL_MAG0_{name}OFF"] == pytest.approx(bias / 100, rel=1e-5)
        assert parameters[f"CAL_MAG0_{name}ODIAG"] == pytest.approx(0, abs=1e-15)


def test_names_and_units(magnetometer: Bench) -> None:
    export(magnetometer, "ardupilot", "--sensor", "2")
    expected = [
        *(f"COMPASS_{what}2_{axis}" for what in ("OFS", "DIA", "ODI") for axis in "XYZ"),
        "COMPASS_SCALE2",
        *(f"COMPASS_MOT2_{axis}" for axis in "XYZ"),
    ]
    assert list(autopilots.read_ardupilot(magnetometer.folder / "vehicle")) == expected
    export(magnetometer, "px4", "--sensor", "1", "--device-id", "396825")
    expected = [
        "CAL_MAG1_ID",
        *(f"CAL_MAG1_{a}{what}" for what in ("OFF", "SCALE", "ODIAG", "COMP") for a in "XYZ"),
    ]
    text = (magnetometer.folder / "vehicle").read_text()
    assert list(autopilots.read_px4(magnetometer.folder / "vehicle")) == expected
    assert "1\t1\tCAL_MAG1_ID\t396825\t6\n" in text
    assert "CAL_MAG1_ID is not in the file" not in text


def test_a_mounted_sensor_of_px4(magnetometer: Bench) -> None:
    """A log turned into body axes by R z y x; PX4 takes the sensor's own axes."""
    log = magnetometer.read_log()
    export(magnetometer, "px4")
    parameters = autopilots.read_px4(magnetometer.folder / "vehicle")
    expected = autopilots.px4_field(parameters, read_raw(log))
    roll, pitch, yaw = np.radians([180.0, 10.0, 90.0])
    R = (
        np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
        @ np.array(
            [[np.cos(pitch), 0, np.sin(pitch)], [0, 1, 0], [-np.sin(pitch), 0, np.cos(pitch)]]
        )
        @ np.array([[1, 0, 0], [0, np.cos(roll), -np.sin(roll)], [0, np.sin(roll), np.cos(roll)]])
    )
    export(magnetometer, "px4", "--mounting", "180,10,90")
    parameters = autopilots.read_px4(magnetometer.folder / "vehicle")
    in_sensor = read_raw(log) @ R  # R' of each
    found = autopilots.px4_field(parameters, in_sensor, mounting=R)
    assert_allclose(found, expected, atol=SINGLE * 200)


def test_the_strength_alone_is_held_whole(magnetometer: Bench) -> None:
    """No flight is needed: a rotation is not seen, so that the polar factor is as good."""
    log = magnetometer.read_log()
    strength = "53.2"
    fitted = magnetometer.run("fit", "flight.csv", "--field-strength", strength, "-o", "norm.json")
    assert fitted.code == 0, fitted.err
    base = parse_json((magnetometer.folder / "norm.json").read_text())
    magnetometer.run("apply", "flight.csv", "norm.json", "-o", "applied.csv")
    applied = Log(magnetometer.folder / "applied.csv")
    expected = np.column_stack([applied.column(f"m{axis}_cal_ut") for axis in "xyz"])
    raw = read_raw(log)
    magnetometer.flight.unlink()
    for target in READERS:
        export(magnetometer, target, calibration="norm.json")
        found = corrected_by(target, magnetometer.folder / "vehicle", raw)
        assert_allclose(
            np.linalg.norm(found, axis=1), np.linalg.norm(expected, axis=1), rtol=SINGLE * 10
        )
    assert base["model"] == "magnetometer-norm"


def test_a_motor_beside_the_strength(magnetometer: Bench) -> None:
    log = magnetometer.read_log()
    for axis, share in zip("xyz", (0.4, -0.2, 0.3), strict=True):
        log.replace(f"m{axis}_ut", log.column(f"m{axis}_ut") + share * log.column("current_a"))
    magnetometer.flight.write_text(log.text())
    effect = ("--effect", "bias[current_a]")
    fitted = magnetometer.run(
        "fit", "flight.csv", "--field-strength", "53.2", *effect, "-o", "norm.json"
    )
    assert fitted.code == 0, fitted.err
    assert magnetometer.run("apply", "flight.csv", "norm.json", "-o", "applied.csv").code == 0
    applied = Log(magnetometer.folder / "applied.csv")
    expected = np.column_stack([applied.column(f"m{axis}_cal_ut") for axis in "xyz"])
    for target in READERS:
        loss = export(magnetometer, target, calibration="norm.json").result["approximation"]
        found = corrected_by(
            target, magnetometer.folder / "vehicle", read_raw(log), motor=log.column("current_a")
        )
        strength = np.linalg.norm(found, axis=1)
        assert_allclose(strength, np.linalg.norm(expected, axis=1), rtol=SINGLE * 10)
        assert loss["strength_rms_ut"] == pytest.approx(0, abs=1e-9)
        assert loss["heading_rms_deg"] is None
        assert loss["rotation_deg"] is None
        assert loss["residual_after"] == loss["residual_before"]


@pytest.mark.parametrize("target", ["ardupilot", "px4"])
def test_the_loss_is_true(magnetometer: Bench, target: str) -> None:
    """Heading, strength, rotation and residuals again, by the exported numbers and by apply."""
    log = fit_motor(magnetometer, "current_a", 0.4)
    loss = export(magnetometer, target, *REFIT, calibration="motor.json").result["approximation"]
    driver, raw = log.column("current_a"), read_raw(log)
    held = corrected_by(target, magnetometer.folder / "vehicle", raw, motor=driver)
    done = magnetometer.run("apply", "flight.csv", "motor.json", "-o", "applied.csv")
    assert done.code == 0, done.err
    applied = Log(magnetometer.folder / "applied.csv")
    full = np.column_stack([applied.column(f"m{axis}_cal_ut") for axis in "xyz"])
    roll, pitch = log.column("roll_rad"), log.column("pitch_rad")
    turned = np.degrees(
        np.angle(
            np.exp(
                1j
                * (
                    autopilots.level_heading(held, roll, pitch)
                    - autopilots.level_heading(full, roll, pitch)
                )
            )
        )
    )
    assert loss["heading_rms_deg"] == pytest.approx(np.sqrt(np.mean(turned**2)), rel=1e-4)
    assert loss["heading_largest_deg"] == pytest.approx(np.abs(turned).max(), rel=1e-4)
    strength = np.linalg.norm(held, axis=1) - np.linalg.norm(full, axis=1)
    assert loss["strength_rms_ut"] == pytest.approx(np.sqrt(np.mean(strength**2)), rel=1e-4)
    assert loss["rows"] == len(raw)

    base = parse_json((magnetometer.folder / "motor.json").read_text())
    A = np.linalg.lstsq(np.column_stack([raw, np.ones(len(raw)), driver]), full, rcond=None)[0][
        :3
    ].T
    u, _, v = np.linalg.svd(A)
    angle = np.degrees(np.arccos((np.trace(u @ v) - 1) / 2))
    assert loss["rotation_deg"] == pytest.approx(angle, rel=1e-5)
    assert angle > 0.5

    before = np.sqrt(np.mean(np.square(list(base["rmse"].values()))))
    C, n, kappa = autopilots.fit_symmetric(true_field(log), raw, driver)
    residual = raw - true_field(log) @ C.T - n - np.outer(driver, kappa)
    assert loss["residual_before"] == pytest.approx(before, rel=1e-9)
    assert loss["residual_after"] == pytest.approx(np.sqrt(np.mean(residual**2)), rel=1e-6)
    assert loss["residual_after"] > loss["residual_before"]


def simulate_tube(folder: Path, *more: str) -> Bench:
    """A Pitot-static tube with its pressure logged."""
    bench = Bench("sepcal-pitot", folder, (), None)  # type: ignore[arg-type]
    done = bench.run(
        "simulate", "--probe", "pitot-static", "-o", "flight.csv", "--rows", "900", *more
    )
    assert done.code == 0, done.err
    log = bench.read_log()
    log.drop("airspeed_mps")  # so that the pressure is what is read
    bench.flight.write_text(log.text())
    done = bench.run("fit", "flight.csv", "-o", "base.json")
    assert done.code == 0, done.err
    return bench


def fit_tube(log: Log) -> tuple[float, float, Array]:
    """s, the offset [Pa] and the wind of z = s sqrt(V^2 - 2 p / rho), in SciPy."""
    velocity = np.column_stack([log.column(f"v{axis}_mps") for axis in "ned"])
    rho, pressure = log.column("rho_kgpm3"), log.column("dp_pa")
    read = np.sqrt(2 * pressure / rho)

    def residual(xi: Array) -> Array:
        speed = np.linalg.norm(velocity - np.array([xi[2], xi[3], 0.0]), axis=1)
        return read - xi[0] * np.sqrt(speed**2 - 2 * xi[1] / rho)

    found = least_squares(residual, [1.0, 0.0, 0.0, 0.0], xtol=1e-15, ftol=1e-15, gtol=1e-15)
    return found.x[0], found.x[1], found.fun


@pytest.mark.parametrize("target", ["ardupilot", "px4"])
def test_an_airspeed(tmp_path: Path, target: str) -> None:
    """The fit without a bias and with a pressure offset in SciPy; EAS to TAS by the density."""
    bench = simulate_tube(tmp_path)
    log = bench.read_log()
    s, offset, residual = fit_tube(log)
    read = np.sqrt(2 * log.column("dp_pa") / log.column("rho_kgpm3"))
    expected = np.sqrt((read / s) ** 2 + 2 * offset / log.column("rho_kgpm3"))
    apply_to = {"ardupilot": autopilots.ardupilot_airspeed, "px4": autopilots.px4_airspeed}[target]
    for sensor in (1, 2):
        loss = export(bench, target, "--sensor", str(sensor)).result["approximation"]
        parameters = READERS[target](bench.folder / "vehicle")
        found = apply_to(parameters, log.column("dp_pa"), log.column("rho_kgpm3"), sensor=sensor)
        assert_allclose(found, expected, rtol=2e-6)
    bench.run("apply", "flight.csv", "base.json", "-o", "applied.csv")
    full = Log(bench.folder / "applied.csv").column("airspeed_cal_mps")
    assert loss["airspeed_rms_mps"] == pytest.approx(
        np.sqrt(np.mean((found - full) ** 2)), rel=1e-3
    )
    assert loss["airspeed_largest_mps"] == pytest.approx(np.abs(found - full).max(), rel=1e-3)
    assert loss["residual_after"] == pytest.approx(np.sqrt(np.mean(residual**2)), rel=1e-6)


def test_the_ratio_in_use(tmp_path: Path) -> None:
    """A logged airspeed that the autopilot read with its own ratio or scale."""
    bench = simulate_tube(tmp_path)
    log = bench.read_log()
    pressure, rho = log.column("dp_pa"), log.column("rho_kgpm3")
    export(bench, "ardupilot")
    plain = autopilots.ardupilot_airspeed(
        autopilots.read_ardupilot(tmp_path / "vehicle"), pressure, rho
    )
    eas2tas = np.sqrt(1.225 / rho)
    for target, value, logged, apply_to in (
        ("ardupilot", 1.9936, np.sqrt(1.9936 * pressure) * eas2tas, autopilots.ardupilot_airspeed),
        ("px4", 1.1, 1.1 * np.sqrt(2 * pressure / 1.225) * eas2tas, autopilots.px4_airspeed),
    ):
        other = bench.read_log()
        other.replace("dp_pa", logged, to="airspeed_mps")
        (tmp_path / "speed.csv").write_text(other.text())
        assert bench.run("fit", "speed.csv", "-o", "speed.json").code == 0
        export(bench, target, "--in-use", str(value), calibration="speed.json")
        found = apply_to(READERS[target](tmp_path / "vehicle"), pressure, rho)
        assert_allclose(found, plain, rtol=1e-5)


def test_a_ratio_in_use_is_of_an_airspeed_alone(tmp_path: Path) -> None:
    bench = simulate_tube(tmp_path)
    command = ("export", "base.json", "--to", "px4", "--in-use")
    assert_refused(bench, *command, "1.1", words=("--in-use is of a logged airspeed", "dp_pa"))
    assert_refused(bench, *command, "-1", words=("--in-use is -1", "above zero"))


def test_without_an_effect(magnetometer: Bench) -> None:
    """What is left out is fitted around, and the loss says what that costs."""
    done = magnetometer.run("fit", "flight.csv", "--effect", "scale[temp_degc]", "-o", "warm.json")
    assert done.code == 0, done.err
    plain = export(magnetometer, "ardupilot").result
    found = export(
        magnetometer, "ardupilot", "--without", "scale[temp_degc]", calibration="warm.json"
    ).result
    for name, value in plain["parameters"].items():
        assert found["parameters"][name] == pytest.approx(value, rel=1e-6, abs=1e-6)
    assert "the effect scale[temp_degc]" in found["approximation"]["dropped"]
    assert found["approximation"]["residual_before"] < plain["approximation"]["residual_before"]


REFUSALS = {
    "an effect that follows time": (
        "bias[time]",
        "ardupilot",
        ("ArduPilot can't hold bias[time]", "--without bias[time]"),
    ),
    "a scale": ("scale[temp_degc]", "px4", ("PX4 can't hold scale[temp_degc]", "--without")),
    "a second driver": (
        "bias[current_a]+bias[throttle]",
        "px4",
        ("PX4 can't hold bias[throttle]", "bias[current_a] is there already"),
    ),
    "two effects": (
        "bias[temp_degc]+scale[temp_degc]",
        "px4",
        ("bias[temp_degc], scale[temp_degc]", "--without bias[temp_degc] --without scale[temp"),
    ),
    "a delay": (
        "bias[delay(current_a)]",
        "c",
        ("bias[delay(current_a)] can't be exported", "--without"),
    ),
    "a drift in c": ("bias[time]", "cpp", ("bias[time] can't be exported", "time since")),
    "a lag": ("sensor_lag", "c", ("sensor_lag can't be exported", "other moments")),
    "currents": ("eddy_currents", "c", ("eddy_currents can't be exported", "rate")),
}


@pytest.mark.parametrize("what", REFUSALS)
def test_an_effect_that_has_no_home(magnetometer: Bench, what: str) -> None:
    effect, target, words = REFUSALS[what]
    magnetometer.run("add", "flight.csv", "base.json", effect, "-o", "more.json")
    assert_refused(
        magnetometer, "export", "more.json", "flight.csv", "--to", target, "--force", words=words
    )


def test_what_is_not_fit_to_fly(magnetometer: Bench) -> None:
    base = magnetometer.base
    base["parameters"]["n_x"]["at_bound"] = True
    (magnetometer.folder / "bound.json").write_text(json.dumps(base))
    command = ("export", "bound.json", "--to", "c")
    assert_refused(magnetometer, *command, words=("n_x at its bound", "--force"))
    assert magnetometer.run(*command, "-o", "forced", "--force").code == 0

    text = (magnetometer.folder / "base.json").read_text()
    for status, words in (
        ("not_converged", "did not converge"),
        ("not_identifiable", "not all determined"),
    ):
        spoilt = text.replace('"status": "converged"', f'"status": "{status}"', 1)
        (magnetometer.folder / "spoilt.json").write_text(spoilt)
        assert_refused(
            magnetometer, "export", "spoilt.json", "--to", "ardupilot", words=(words, "--force")
        )


def test_a_compass_scale_that_ardupilot_would_ignore(magnetometer: Bench) -> None:
    """A sensor that reads half the field: DIA and ODI hold the scale, and nothing is lost."""
    near = export(magnetometer, "ardupilot")
    assert "to be scaled by" not in near.err + (magnetometer.folder / "vehicle").read_text()
    log = magnetometer.read_log()
    for axis in "xyz":
        log.replace(f"m{axis}_ut", log.column(f"m{axis}_ut") / 2)
    magnetometer.flight.write_text(log.text())
    assert magnetometer.run("fit", "flight.csv", "-o", "half.json").code == 0
    C, n, _ = autopilots.fit_symmetric(true_field(log), read_raw(log))
    W = np.linalg.inv(C)
    for target in READERS:
        done = export(magnetometer, target, *REFIT, calibration="half.json")
        found = corrected_by(target, magnetometer.folder / "vehicle", read_raw(log))
        assert_allclose(found, (read_raw(log) - n) @ W.T, atol=SINGLE * 200)
    said = f"to be scaled by {np.trace(W) / 3:.4g}, and ArduPilot ignores a COMPASS_SCALE outside"
    for text in (done.err, (magnetometer.folder / "vehicle").read_text()):
        assert (said in text) == (target == "ardupilot")
    assert autopilots.read_ardupilot(magnetometer.folder / "vehicle")["COMPASS_SCALE"] == 1


def test_what_an_autopilot_does_not_take(magnetometer: Bench) -> None:
    """A sensor that reads a twentieth of the field."""
    log = magnetometer.read_log()
    for axis in "xyz":
        log.replace(f"m{axis}_ut", log.column(f"m{axis}_ut") / 20)
    magnetometer.flight.write_text(log.text())
    assert magnetometer.run("fit", "flight.csv", "-o", "twentieth.json").code in (0, 4)
    for target, name in (("px4", "CAL_MAG0_XSCALE"), ("ardupilot", "COMPASS_DIA_X")):
        command = ("export", "twentieth.json", "--to", target, "--force")
        assert_refused(magnetometer, *command, words=(f"{name} would be", "--to c"))


def test_usage(bench: Bench) -> None:
    """One line for each slip; nothing is written."""
    of_magnetometer = bench.app == "sepcal-mag"
    for more, words in (
        (("--to", "betaflight"), ("--to 'betaflight' is unknown", "'ardupilot'")),
        (("--to", "c", "--without", "bias[x]"), ("--without bias[x]", "it has none")),
        (("--to", "c", "--device-id", "7"), ("--device-id", "leave it out")),
        (("--to", "c", "--mounting", "0,0,90"), ("--mounting", "leave it out")),
        (("--to", "c", "--in-use", "2"), ("--in-use", "leave it out")),
        (("--to", "c", "--rotation", "keep"), ("--rotation", "leave it out")),
        (("--to", "px4", "--rotation", "turn"), ("--rotation 'turn' is unknown", "'refit'")),
        (("--to", "c", "--sensor", "x"), ("--sensor",)),
    ):
        assert_refused(bench, "export", "base.json", *more, words=words)
    for target, last in (("ardupilot", 3), ("px4", 3)):
        command = ("export", "base.json", "--to", target, "--sensor", "4")
        words = (f"to {last}",) if of_magnetometer else ("a five-hole probe has no home",)
        assert_refused(bench, *command, words=words)
    before = bench.flight.read_bytes()
    for output in ("flight.csv", "base.json"):
        done = bench.run("export", "base.json", "--to", "c", "-o", output)
        assert done.code == 2
        assert "input" in done.err or "read" in done.err
    assert bench.flight.read_bytes() == before


def test_the_flight_that_is_not_there(magnetometer: Bench) -> None:
    log = magnetometer.read_log()
    (magnetometer.folder / "copy.csv").write_bytes(magnetometer.flight.read_bytes())
    log.put(5, "mx_ut", "12.5")
    magnetometer.flight.write_text(log.text())  # changed since
    command = ("export", "base.json", "--to", "px4", *REFIT)
    assert_refused(magnetometer, *command, words=("flight.csv is not there as it was fitted",))
    magnetometer.flight.unlink()
    assert_refused(magnetometer, *command, words=("flight.csv is not there as it was fitted",))
    assert magnetometer.run("export", "base.json", "copy.csv", "--to", "px4", "-o", "x").code == 0


def test_several_flights(magnetometer: Bench) -> None:
    magnetometer.run("simulate", "-o", "second.csv", "--rows", "300", "--seed", "5")
    fitted = magnetometer.run("fit", "flight.csv", "second.csv", "--own", "n_x", "-o", "joint.json")
    assert fitted.code == 0, fitted.err
    command = ("export", "joint.json")
    words = ("2 flights jointly", "fit one of them alone")
    assert_refused(magnetometer, *command, "--to", "px4", *REFIT, words=words)
    assert_refused(magnetometer, *command, "--to", "px4", words=("2 flights; give the one",))
    assert_refused(magnetometer, *command, "--to", "c", words=("2 flights", "second.csv"))
    done = magnetometer.run("export", "joint.json", "second.csv", "--to", "c", "-o", "second.h")
    assert done.code == 0, done.err
    base = parse_json((magnetometer.folder / "joint.json").read_text())
    assert (
        repr(base["parameters"]["n_x@second"]["value"])
        in (magnetometer.folder / "second.h").read_text()
    )


@pytest.mark.parametrize("target", ["ardupilot", "px4"])
def test_recorded_magnetometer(tmp_path: Path, target: str) -> None:
    """An octocopter's internal compass beside its motors' current."""
    flight = find_fixture("octocopter_internal_mag.csv")
    bench = Bench("sepcal-mag", tmp_path, (), None)  # type: ignore[arg-type]
    fitted = bench.run(
        "fit", flight, "--field", "19.72,-1.41,49.44", "--effect", "bias[current_a]", "-o", "m.json"
    )
    assert fitted.code == 0, fitted.err
    done = export(bench, target, *REFIT, calibration="m.json")
    log = Log(flight)
    raw = 100 * np.column_stack([log.column(f"m{axis}_gauss") for axis in "xyz"])
    found = corrected_by(target, tmp_path / "vehicle", raw, motor=log.column("current_a"))
    field = true_field(log, np.array([19.72, -1.41, 49.44]))
    C, n, kappa = autopilots.fit_symmetric(field, raw, log.column("current_a"))
    expected = (raw - n - np.outer(log.column("current_a"), kappa)) @ np.linalg.inv(C).T
    assert_allclose(found, expected, atol=1e-4)
    loss = done.result["approximation"]
    assert loss["residual_after"] < 1.05 * loss["residual_before"]


@pytest.mark.parametrize("target", ["ardupilot", "px4"])
def test_recorded_tube(tmp_path: Path, target: str) -> None:
    """A small aircraft's airspeed, in the words of a page."""
    flight = find_fixture("uav_pitot_static_2022_05_07_11.csv")
    bench = Bench("sepcal-pitot", tmp_path, (), None)  # type: ignore[arg-type]
    assert bench.run("fit", flight, "-o", "p.json").code == 0
    done = bench.run("export", "p.json", "--to", target, "-o", "vehicle")
    assert done.code == 0, done.err
    assert "dropped: the airspeed's constant c_va" in done.out
    assert "the one in use" in done.err
    log = Log(flight)
    rho = np.full(len(log.rows), 1.225)
    pressure = 0.5 * rho * log.column("airspeed_mps") ** 2
    apply_to = {"ardupilot": autopilots.ardupilot_airspeed, "px4": autopilots.px4_airspeed}[target]
    found = apply_to(READERS[target](tmp_path / "vehicle"), pressure, rho)
    full = sepcal.load(tmp_path / "p.json").apply(sepcal.read_csv(flight))["airspeed_cal_mps"]
    loss = export(bench, target, calibration="p.json").result["approximation"]
    assert loss["airspeed_rms_mps"] == pytest.approx(
        np.sqrt(np.mean((found - full) ** 2)), rel=1e-4
    )


def test_the_winds_effects_stay_in_the_fit(tmp_path: Path) -> None:
    """They are no part of a correction, and what is fitted anew has them."""
    bench = simulate_tube(tmp_path, "--hide", "wind[altitude_m]=0.1")
    done = bench.run("fit", "flight.csv", "--effect", "wind[altitude_m]", "-o", "shear.json")
    assert done.code == 0, done.err
    plain = export(bench, "px4").result
    found = export(bench, "px4", calibration="shear.json").result
    assert found["left_to_others"] == ["wind[altitude_m]"]
    assert set(found["parameters"]) == set(plain["parameters"])
    assert found["approximation"]["residual_after"] < 0.9 * plain["approximation"]["residual_after"]


def test_a_tube_without_an_effect(tmp_path: Path) -> None:
    bench = simulate_tube(tmp_path)
    done = bench.run("fit", "flight.csv", "--effect", "airspeed_scale[throttle]", "-o", "e.json")
    assert done.code == 0, done.err
    plain = export(bench, "ardupilot").result
    command = ("export", "e.json", "--to", "ardupilot")
    words = ("ArduPilot can't hold airspeed_scale[throttle]", "--without airspeed_scale[throttle]")
    assert_refused(bench, *command, words=words)
    found = export(
        bench, "ardupilot", "--without", "airspeed_scale[throttle]", calibration="e.json"
    ).result
    for name, value in plain["parameters"].items():
        assert found["parameters"][name] == pytest.approx(value, rel=1e-6)
    assert found["approximation"]["residual_before"] < plain["approximation"]["residual_before"]


def test_a_header_without_an_effect(magnetometer: Bench) -> None:
    """What is left is the fit that never had it."""
    done = magnetometer.run("fit", "flight.csv", "--effect", "bias[time]", "-o", "drift.json")
    assert done.code == 0, done.err
    export(magnetometer, "c")
    plain = (magnetometer.folder / "vehicle").read_text()
    found = export(magnetometer, "c", "--without", "bias[time]", calibration="drift.json").result
    text = (magnetometer.folder / "vehicle").read_text()
    numbers = [
        [
            float(v)
            for v in re.findall(r"-?\d+\.\d+(?:e-?\d+)?", one.partition("self_test")[0][600:])
        ]
        for one in (plain, text)
    ]
    count = min(map(len, numbers))
    assert_allclose(numbers[0][-count:], numbers[1][-count:], rtol=1e-5, atol=1e-8)
    assert found["approximation"]["dropped"] == ["the effect bias[time]"]
    assert found["approximation"]["heading_rms_deg"] > 0


def test_an_effect_of_ones_own_is_refused(magnetometer: Bench) -> None:
    flight = sepcal.read_csv(magnetometer.flight)
    motor = sepcal.Effect("motor", lambda log: log["current_a"], port="bias", unit="uT/A")
    calibration = sepcal.fit(sepcal.Magnetometer(), flight).add(motor)
    for target, words in (("c", "of your own making"), ("px4", "PX4 can't hold motor")):
        with pytest.raises(sepcal.Error, match=words):
            sepcal.export(calibration, magnetometer.folder / "python", target, force=True)
    calibration.save(magnetometer.folder / "motor.json")
    words = ("motor can't be exported", "of your own making")
    assert_refused(magnetometer, "export", "motor.json", "--to", "c", "--force", words=words)


def test_python_does_the_same(magnetometer: Bench) -> None:
    calibration = sepcal.load(magnetometer.folder / "base.json")
    flight = sepcal.read_csv(magnetometer.flight)
    with pytest.raises(sepcal.Error, match="is not there as it was fitted"):
        sepcal.export(calibration, magnetometer.folder / "python", "px4", rotation="refit")
    written = sepcal.export(
        calibration, magnetometer.folder / "python", "px4", flight=flight, sensor=1, device_id=7
    )
    app = export(magnetometer, "px4", "--sensor", "1", "--device-id", "7")
    assert written.rotation == app.result["rotation"]
    assert written.other_approximation is not None
    assert (
        written.other_approximation.heading_rms_deg
        == app.result["other_approximation"]["heading_rms_deg"]
    )
    assert written.parameters == app.result["parameters"]
    assert written.approximation is not None
    assert written.approximation.heading_rms_deg == app.result["approximation"]["heading_rms_deg"]
    assert (magnetometer.folder / "python").read_text() == written.text
    assert written.page in str(written)
    with pytest.raises(sepcal.Error, match="three angles"):
        sepcal.export(calibration, "x", "px4", flight=flight, mounting=(1.0, 2.0))
    with pytest.raises(sepcal.Error, match="rotation 'turn' is unknown"):
        sepcal.export(calibration, magnetometer.folder / "python", "px4", rotation="turn")
    with pytest.raises(sepcal.Error, match="to 'x' is unknown"):
        sepcal.export(calibration, magnetometer.folder / "python", "x", flight=flight)
