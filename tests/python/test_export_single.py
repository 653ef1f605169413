# SPDX-License-Identifier: BSD-3-Clause
"""Headers in float: within a millionth of apply, drivers that a float can't hold among them."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import headers
import sepcal
from apps import Bench, assert_refused

Array = NDArray[np.float64]
FIELD = (19.7, -1.4, 49.4)
MILLIONTH = 1e-6

# Columns of 400 rows that a float holds badly: start, what they change over.
FAR = {
    "unix_s": (1764000000.0, 1000.0),
    "boot_us": (1e9, 4e7),
    "press_hpa": (1013.2, 3.0),
    "imu_temp_degc": (45.0, 1.5),
    "depth_m": (-11034.0, 25.0),
    "sway": (-0.3, 1.0),
}
FIELD_EFFECTS = {
    "plain": (),
    "a time": ("bias[unix_s]",),
    "its powers": ("bias[unix_s]", "bias[unix_s^2]", "bias[press_hpa^3]"),
    "a mean temperature": ("bias[imu_temp_degc^2]", "scale[imu_temp_degc]"),
    "splines": ("bias[spline(unix_s,5)]", "axis_scale[spline(boot_us,4)]"),
    "levels": ("bias[levels(unix_s,1764000300,1764000700.5)]",),
    "a product": ("bias[unix_s*sway]", "bias[press_hpa^2*sway]"),
    "products of two": ("bias[unix_s*press_hpa]", "scale[unix_s*abs(depth_m)]"),
    "a size": ("bias[sway*abs(sway)]", "bias[depth_m*abs(depth_m)*sway]"),
    "an exponent": ("bias[throttle^n]", "bias[throttle]"),
    "a curve": ("cubic_nonlinearity", "bias[unix_s]"),
}


def with_far(flight: sepcal.Flight, seed: int) -> sepcal.Flight:
    """The flight with columns of FAR, which wander over their range."""
    rng = np.random.default_rng(seed)
    columns = {name: flight[name] for name in flight}
    for name, (start, span) in FAR.items():
        steps = np.cumsum(rng.normal(size=flight.rows))
        columns[name] = start + span * (steps - steps.min()) / np.ptp(steps)
    return sepcal.Flight(columns)


def inputs_of(text: str, flight: sepcal.Flight) -> Array:
    """What the header asks for, from the flight's columns, in double: shape (N, inputs)."""
    origins = headers.origins_of(text)
    columns = []
    for name in headers.drivers_of(text):
        if name == "pt_less_ps_pa":
            columns.append(flight["pt_pa"] - flight["ps_pa"])
            continue
        if name.startswith("m_ut"):
            columns.append(flight[f"m{'xyz'[int(name[-1])]}_ut"])
            continue
        header = name.removesuffix("_less_origin")
        columns.append(flight[header] - origins.get(name, 0.0))
    return np.column_stack(columns)


def check(base: sepcal.Calibration, flight: sepcal.Flight, folder: Path, target: str) -> str:
    """Exports, compiles strictly and compares with apply; returns the header."""
    header = folder / "sensor.h"
    sepcal.export(base, header, target, single=True, force=True)
    text = header.read_text()
    code = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    doubles = [line for line in code.splitlines() if "double" in line]
    assert all("origin_" in line for line in doubles)
    inputs = inputs_of(text, flight)
    applied = base.apply(flight)
    expected = np.column_stack(list(applied.values()))
    known = np.isfinite(expected).all(axis=1)
    sizes = np.nanmax(np.abs(expected), axis=0)
    for column, name in enumerate(applied):
        if name.endswith("_rad"):
            sizes[column] = 1.0
        elif name.endswith("_ut"):
            sizes[column] = max(np.abs(inputs[:, :3]).max(), np.nanmax(np.abs(expected)))
    for standard in headers.STANDARDS[target]:
        program = headers.build(header, target, standard)
        status, found = headers.run_rows(program, inputs[known])
        assert set(status) <= {0.0, 3.0}
        assert (status == 0).mean() > 0.9
        assert np.max(np.abs(found - expected[known]) / sizes) < MILLIONTH
    return text


@pytest.mark.parametrize("what", FIELD_EFFECTS)
def test_a_magnetometer(what: str, tmp_path: Path) -> None:
    flight = with_far(sepcal.simulate("magnetometer", rows=400, seed=2), 5)
    base = sepcal.fit(sepcal.Magnetometer(field=FIELD), flight, effects=list(FIELD_EFFECTS[what]))
    check(base, flight, tmp_path, "c")
    check(base, flight, tmp_path, "cpp")


@pytest.mark.parametrize(
    "effects",
    [
        (),
        ("airspeed_scale[unix_s]", "alpha_offset[spline(alpha,4)]"),
        ("compressibility", "density_error", "upwash"),
        ("airspeed_scale[ps]", "alpha_offset[pt]", "beta_offset[ps^2]"),
        ("pressure_offset[unix_s]", "angle_loss"),
    ],
)
def test_a_five_hole_probe(effects: tuple[str, ...], tmp_path: Path) -> None:
    """Static pressure near 95,000 Pa, differences of some hundred."""
    flight = with_far(sepcal.simulate("five-hole", rows=400, seed=3), 6)
    model = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5)
    base = sepcal.fit(model, flight, effects=list(effects))
    text = check(base, flight, tmp_path, "c")
    assert "pt_less_ps_pa" in text
    assert ("float ps_pa" in text) == any(word in "".join(effects) for word in ("ps", "comp", "pt"))


@pytest.mark.parametrize(
    "effects",
    [(), ("airspeed_bias[unix_s]",), ("pressure_offset[rho]", "airspeed_scale[press_hpa]")],
)
def test_a_tube(effects: tuple[str, ...], tmp_path: Path) -> None:
    flight = with_far(sepcal.simulate("pitot-static", rows=400, seed=4), 7)
    base = sepcal.fit(sepcal.PitotStatic(), flight, effects=list(effects))
    check(base, flight, tmp_path, "c")


def test_the_driver_by_itself_would_be_lost(tmp_path: Path) -> None:
    """With the origin put back within the float the error is hundreds of times what is promised."""
    flight = with_far(sepcal.simulate("magnetometer", hide={"bias[current_a]": 0.3}, rows=400), 5)
    raw = {name: flight[name] for name in flight}
    raw["mx_ut"] = raw["mx_ut"] + 0.01 * (raw["unix_s"] - 1764000000.0)
    flight = sepcal.Flight(raw)
    base = sepcal.fit(sepcal.Magnetometer(field=FIELD), flight, effects=["bias[unix_s]"])
    text = check(base, flight, tmp_path, "c")
    inputs = inputs_of(text, flight)
    origin = headers.origins_of(text)["unix_s_less_origin"]
    lost = inputs.copy()
    lost[:, 3] = (inputs[:, 3] + origin).astype(np.float32).astype(float) - origin
    program = headers.build(tmp_path / "sensor.h", "c", "c99")
    _, right = headers.run_rows(program, inputs)
    _, wrong = headers.run_rows(program, lost)
    assert np.max(np.abs(right - wrong)) > 100 * MILLIONTH * np.abs(right).max()


def test_a_cortex_m4f_calls_no_double(tmp_path: Path) -> None:
    """Of a library's double arithmetic the object file names nothing."""
    compiler = shutil.which("arm-none-eabi-gcc")
    if compiler is None:
        pytest.skip("no arm-none-eabi-gcc on this machine")
    flight = with_far(sepcal.simulate("five-hole", rows=400, seed=3), 6)
    model = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5)
    effects = ["compressibility", "airspeed_scale[spline(unix_s,4)]", "alpha_offset[throttle^n]"]
    base = sepcal.fit(model, flight, effects=effects)
    (tmp_path / "main.c").write_text(
        '#include "sensor.h"\nint test(void);\n'
        "int test(void) { return sepcal_five_hole_self_test(); }\n"
    )
    command = [compiler, "-std=c99", *headers.STRICT, "-Wdouble-promotion", "-Wfloat-conversion"]
    command += ["-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard", "-O2"]
    called = {}
    for single in (True, False):
        sepcal.export(base, tmp_path / "sensor.h", "c", single=single, force=True)
        chosen = [word for word in command if single or not word.startswith("-Wdouble")]
        subprocess.run([*chosen, "-c", "main.c"], cwd=tmp_path, check=True)
        listed = subprocess.run(
            ["arm-none-eabi-nm", "-u", "main.o"], cwd=tmp_path, check=True, capture_output=True
        )
        called[single] = set(re.findall(r"__aeabi_d\w+|\b[a-z]+[0-9]*\b", listed.stdout.decode()))
    assert any(name.startswith("__aeabi_d") for name in called[False])
    assert not any(name.startswith("__aeabi_d") for name in called[True])
    assert {"sqrt", "pow", "sin", "cos", "asin"} & called[True] == set()


def test_it_is_of_a_header(magnetometer: Bench) -> None:
    command = ("export", "base.json", "--to", "px4", "--float", "--force")
    assert_refused(magnetometer, *command, words=("--single is of a header",))


def test_the_app_does_the_same(magnetometer: Bench) -> None:
    for option in ("--float", "--single"):
        done = magnetometer.run("export", "base.json", "--to", "c", option, "-o", f"{option[2:]}.h")
        assert done.code == 0, done.err
    base = sepcal.load(magnetometer.folder / "base.json")
    written = sepcal.export(base, magnetometer.folder / "python.h", "c", single=True).text
    texts = [(magnetometer.folder / f"{name}.h").read_text() for name in ("float", "single")]

    def without_place(text: str) -> str:
        return re.sub(r" \* (calibration|flight): .*", "", text)

    assert texts[0] == texts[1]
    assert without_place(texts[0]) == without_place(written)


def test_a_number_beyond_a_float_is_refused(magnetometer: Bench) -> None:
    calibration = magnetometer.base
    calibration["parameters"]["n_x"]["value"] = 1e39
    (magnetometer.folder / "base.json").write_text(json.dumps(calibration))
    command = ("export", "base.json", "--to", "c", "--float", "--force")
    assert_refused(magnetometer, *command, words=("1e+39", "beyond what a float holds"))


def test_a_power_beyond_a_float_is_refused(magnetometer: Bench) -> None:
    """Of revolutions a minute, up to 20,000: their ninth power is 5e38."""
    log = magnetometer.read_log()
    turns = 20000.0 * np.linspace(0.0, 1.0, len(log.rows)) ** 2
    log.replace("current_a", turns)
    (magnetometer.folder / "rpm.csv").write_text(log.text())
    effect = ("--effect", "bias[current_a^9]")
    assert magnetometer.run("fit", "rpm.csv", *effect, "-o", "rpm.json").code in (0, 5)
    command = ("export", "rpm.json", "--to", "c", "--float", "--force")
    assert_refused(magnetometer, *command, words=("current_a^9", "beyond what a float holds"))


@pytest.mark.parametrize("threshold", ["3.6", "10.2", "1.8"])
def test_the_self_test_meets_no_round_threshold(magnetometer: Bench, threshold: str) -> None:
    """Of a driver from 0 to 12: as a float a value at the threshold falls to the other side."""
    log = magnetometer.read_log()
    log.replace("current_a", 12.0 * np.linspace(0.0, 1.0, len(log.rows)))
    (magnetometer.folder / "steps.csv").write_text(log.text())
    effect = ("--effect", f"bias[levels(current_a,{threshold})]")
    assert magnetometer.run("fit", "steps.csv", *effect, "-o", "steps.json").code in (0, 5)
    done = magnetometer.run("export", "steps.json", "--to", "c", "--float", "--force", "-o", "f.h")
    assert done.code == 0, done.err
    program = headers.build(magnetometer.folder / "f.h", "c", headers.STANDARDS["c"][0])
    row = [[*(log.column(f"m{axis}_ut")[0] for axis in "xyz"), 6.0]]
    status, _ = headers.run_rows(program, np.array(row, dtype=float))  # which asks it first
    assert status == 0


def test_without_ranges_it_is_refused(magnetometer: Bench) -> None:
    """A file from before calibrations kept them, whose flight is gone."""
    done = magnetometer.run("fit", "flight.csv", "--effect", "bias[current_a]", "-o", "e.json")
    assert done.code == 0
    calibration = json.loads((magnetometer.folder / "e.json").read_text())
    del calibration["driver_ranges"]
    (magnetometer.folder / "old.json").write_text(json.dumps(calibration))
    there = magnetometer.run("export", "old.json", "--to", "c", "--float", "-o", "old.h")
    assert there.code == 0, there.err
    magnetometer.flight.rename(magnetometer.folder / "archived.csv")
    command = ("export", "old.json", "--to", "c", "--float", "--force")
    assert_refused(magnetometer, *command, words=("current_a", "fit the flight again", "--single"))
    given = magnetometer.run(
        "export", "old.json", "archived.csv", "--to", "c", "--float", "-o", "again.h"
    )
    assert given.code == 0, given.err
