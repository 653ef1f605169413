# SPDX-License-Identifier: BSD-3-Clause
"""Exported headers: clean under strict compilers, equal to apply; their self-test can fail."""

import json
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import headers
from apps import Bench, Log
from oracle.model import Array

CASES = [(target, standard) for target, many in headers.STANDARDS.items() for standard in many]

MAGNETOMETER = {
    "plain": (),
    "a current": ("bias[current_a]",),
    "powers": ("bias[temp_degc]", "bias[temp_degc^3]", "bias[voltage_v^2]"),
    "a product": ("bias[current_a*throttle^2]", "bias[current_a*abs(voltage_v)]"),
    "an exponent": ("bias[throttle^n]",),
    "splines": ("bias[spline(temp_degc,5)]", "scale[spline(throttle,4)]"),
    "scales": ("scale[temp_degc]", "axis_scale[current_a]"),
    "a curve": ("cubic_nonlinearity",),
    "a curve and scales": ("cubic_nonlinearity", "axis_scale[temp_degc^2]", "bias[current_a]"),
    "rates": ("bias[p]",),
    "the reference's": ("field_declination",),
}
NORM = {
    "plain": (),
    "a current": ("bias[current_a]",),
    "scales": ("scale[temp_degc]", "axis_scale[throttle]"),
}
FIVE_HOLE = {
    "plain": (),
    "airspeed": ("airspeed_scale[alpha^2]", "airspeed_bias[altitude_m]", "airspeed_scale[flap]"),
    "angles": ("alpha_offset[throttle]", "beta_offset[alpha]", "alpha_offset[spline(beta,4)]"),
    "pressures": ("pressure_offset", "pressure_offset[throttle]", "pressure_offset[q]"),
    "physics": ("density_error", "compressibility", "upwash", "sidewash", "angle_loss"),
    "its own readings": ("airspeed_scale[rho]", "beta_offset[ps]", "alpha_offset[q]", "upwash"),
    "the wind's": ("wind_shear", "heading_bias", "lever_arm", "mounting_error"),
}
TUBE = {
    "plain": (),
    "airspeed": ("airspeed_scale[altitude_m]", "airspeed_bias[throttle]"),
    "pressure": ("pressure_offset[throttle]", "airspeed_scale[q]"),
    "the pressure's zero": ("pressure_offset",),
    "the pressure": ("pressure_offset", "pressure_offset[throttle]"),
    "density": ("density_error", "wind[altitude_m]"),
    "density as a driver": ("pressure_offset[throttle]", "airspeed_scale[rho]"),
    "its own temperature": ("density_error", "airspeed_bias[temp_k]"),
}


def fit(bench: Bench, effects: tuple[str, ...], *more: str) -> None:
    """Some of these can't all be told apart on so short a flight; apply corrects all the same."""
    command = [word for effect in effects for word in ("--effect", effect)]
    done = bench.run("fit", "flight.csv", *bench.options, *more, *command, "-o", "e.json")
    assert done.code in (0, 4, 5), done.err


def applied(bench: Bench) -> Array:
    done = bench.run("apply", "flight.csv", "e.json", "-o", "applied.csv")
    assert done.code == 0, done.err
    log = Log(bench.folder / "applied.csv")
    columns = [header for header in log.headers if "_cal_" in header]
    return np.column_stack(
        [[float(row[log.index(header)] or "nan") for row in log.rows] for header in columns]
    )


def inputs_of(text: str, log: Log) -> Array:
    """The header's inputs from the log, by the arguments' names."""
    columns = []
    for name in headers.drivers_of(text):
        header = f"m{'xyz'[int(name[-1])]}_ut" if name.startswith("m_ut") else name
        if header not in log.headers:  # a word of C, or of the header itself
            header = header.removesuffix("_in")
        columns.append(log.column(header))
    return np.column_stack(columns)


def assert_equal_to_apply(bench: Bench, target: str, standards: tuple[str, ...]) -> None:
    name = f"sensor.{'h' if target == 'c' else 'hpp'}"
    done = bench.run("export", "e.json", "--to", target, "-o", name, "--force")
    assert done.code == 0, done.err
    text = (bench.folder / name).read_text()
    assert re.findall("#include.*", text) == ["#include <math.h>"]
    inputs = inputs_of(text, bench.read_log())
    for standard in standards:
        program = headers.build(bench.folder / name, target, standard)
        status, found = headers.run_rows(program, inputs)
        assert not status.any()
        assert_allclose(found, applied(bench), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("what", MAGNETOMETER)
def test_a_magnetometer(magnetometer: Bench, what: str) -> None:
    fit(magnetometer, MAGNETOMETER[what])
    assert_equal_to_apply(magnetometer, "c", ("c99",))
    assert_equal_to_apply(magnetometer, "cpp", ("c++17",))


@pytest.mark.parametrize("what", NORM)
def test_a_magnetometer_by_strength(magnetometer: Bench, what: str) -> None:
    fit(magnetometer, NORM[what], "--field-strength", "53.2")
    assert_equal_to_apply(magnetometer, "c", ("c99",))


@pytest.mark.parametrize("what", FIVE_HOLE)
def test_a_five_hole_probe(pitot: Bench, what: str) -> None:
    fit(pitot, FIVE_HOLE[what])
    assert_equal_to_apply(pitot, "c", ("c99",))
    assert_equal_to_apply(pitot, "cpp", ("c++20",))


@pytest.mark.parametrize("what", TUBE)
def test_a_tube(tmp_path: Path, what: str) -> None:
    bench = Bench("sepcal-pitot", tmp_path, (), None)  # type: ignore[arg-type]
    bench.run("simulate", "--probe", "pitot-static", "-o", "flight.csv", "--rows", "600")
    fit(bench, TUBE[what])
    assert_equal_to_apply(bench, "c", ("c99",))
    assert_equal_to_apply(bench, "cpp", ("c++17",))


def test_columns_under_names_that_the_language_has(magnetometer: Bench) -> None:
    names = ("double", "y", "x_1", "namespace", "A")
    log = magnetometer.read_log()
    rng = np.random.default_rng(3)
    for name in names:
        log.add(name, rng.normal(size=len(log.rows)))
    magnetometer.flight.write_text(log.text())
    fit(magnetometer, (*(f"bias[{name}]" for name in names), "cubic_nonlinearity"))
    assert_equal_to_apply(magnetometer, "c", ("c99",))
    assert_equal_to_apply(magnetometer, "cpp", ("c++17",))


@pytest.mark.parametrize(("target", "standard"), CASES)
def test_every_standard(magnetometer: Bench, target: str, standard: str) -> None:
    """With Newton's steps, splines and drivers: all that a header can have."""
    fit(magnetometer, ("cubic_nonlinearity", "bias[spline(temp_degc,5)]", "scale[throttle]"))
    assert_equal_to_apply(magnetometer, target, (standard,))


def test_a_c_header_in_cpp(magnetometer: Bench) -> None:
    fit(magnetometer, ("cubic_nonlinearity", "bias[current_a]"))
    done = magnetometer.run("export", "e.json", "--to", "c", "-o", "sensor.h", "--force")
    assert done.code == 0
    (magnetometer.folder / "both.cpp").write_text(
        '#include "sensor.h"\nint main() { return sepcal_magnetometer_self_test(); }\n'
    )
    built = subprocess.run(
        [headers.compiler_of("cpp"), "-std=c++17", *headers.STRICT, "both.cpp", "-o", "both"],
        cwd=magnetometer.folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stderr
    assert subprocess.run([str(magnetometer.folder / "both")], check=False).returncode == 0


@pytest.mark.parametrize("constant", ["n", "inverse", "s_1"])
def test_the_self_test_can_fail(magnetometer: Bench, constant: str) -> None:
    """A constant that is a millionth off is seen."""
    fit(magnetometer, ("bias[current_a]",))
    magnetometer.run("export", "e.json", "--to", "c", "-o", "sensor.h")
    header = magnetometer.folder / "sensor.h"
    text = header.read_text()
    start = re.search(rf"double sepcal_magnetometer_{constant}\[[^=]*= [{{\s]*(-?[0-9.e-]+)", text)
    assert start is not None
    value = float(start[1])
    spoilt = text[: start.start(1)] + repr(value * (1 + 1e-6)) + text[start.end(1) :]
    header.write_text(spoilt)
    program = headers.build(header, "c", "c99")
    done = subprocess.run([str(program)], input="", text=True, check=False)
    assert done.returncode == 3


def test_what_is_no_number(magnetometer: Bench) -> None:
    fit(magnetometer, ("bias[current_a]",))
    magnetometer.run("export", "e.json", "--to", "c", "-o", "sensor.h")
    program = headers.build(magnetometer.folder / "sensor.h", "c", "c99")
    a = float(np.median(magnetometer.read_log().column("current_a")))
    rows = np.array([[20.0, 1.0, 40.0, a], [np.nan, 1.0, 40.0, a], [20.0, 1.0, 40.0, np.inf]])
    status, _ = headers.run_rows(program, rows)
    assert list(status) == [0, 1, 1]


def test_a_reading_that_no_field_gives(magnetometer: Bench) -> None:
    """Of m = h - 0.01 h^2 none is above 25 uT; apply leaves that row empty, and no other.

    h = (1 - sqrt(1 - 0.04 m)) / 0.02.
    """
    fit(magnetometer, ("cubic_nonlinearity",))
    calibration = json.loads((magnetometer.folder / "e.json").read_text())
    for parameter in calibration["parameters"].values():
        parameter["value"] = 0.0
    calibration["parameters"]["cubic_nonlinearity.c_x"]["value"] = -0.01
    (magnetometer.folder / "e.json").write_text(json.dumps(calibration))
    log = magnetometer.read_log()
    m = np.resize([10.0, 60.0, -30.0, 24.9, 26.0], len(log.rows))
    log.replace("mx_ut", m)
    magnetometer.flight.write_text(log.text())
    h = (1.0 - np.sqrt(np.where(m > 25.0, np.nan, 1.0 - 0.04 * m))) / 0.02
    corrected = applied(magnetometer)
    assert_allclose(corrected[:, 0], h, rtol=1e-9)
    done = magnetometer.run("export", "e.json", "--to", "c", "-o", "sensor.h", "--force")
    assert done.code == 0, done.err
    program = headers.build(magnetometer.folder / "sensor.h", "c", "c99")
    status, found = headers.run_rows(program, np.column_stack([m, np.zeros((len(m), 2))]))
    assert list(status[:5]) == [0, 2, 0, 0, 2]
    assert_allclose(found[:, 0], h, rtol=1e-9)


def test_a_still_probe(pitot: Bench) -> None:
    """Total below static pressure is nothing to correct, as apply leaves it empty."""
    fit(pitot, ())
    pitot.run("export", "e.json", "--to", "c", "-o", "sensor.h")
    program = headers.build(pitot.folder / "sensor.h", "c", "c99")
    rows = np.array([[95100.0, 95000.0, 1.0, 1.0, 1.2], [94999.0, 95000.0, 1.0, 1.0, 1.2]])
    status, _ = headers.run_rows(program, rows)
    assert list(status) == [0, 1]


def test_two_sensors_in_one_program(magnetometer: Bench) -> None:
    fit(magnetometer, ())
    for number in (1, 2):
        done = magnetometer.run(
            "export", "e.json", "--to", "c", "-o", f"m{number}.h", "--sensor", str(number)
        )
        assert done.code == 0
    (magnetometer.folder / "both.c").write_text(
        '#include "m1.h"\n#include "m2.h"\n'
        "int main(void) { return sepcal_magnetometer_1_self_test() +"
        " sepcal_magnetometer_2_self_test(); }\n"
    )
    built = subprocess.run(
        [headers.compiler_of("c"), "-std=c99", *headers.STRICT, "both.c", "-o", "both", "-lm"],
        cwd=magnetometer.folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stderr
    assert subprocess.run([str(magnetometer.folder / "both")], check=False).returncode == 0


def test_the_documented_lines_compile(tmp_path: Path) -> None:
    """Of docs/export.md, in a program around them."""
    bench = Bench("sepcal-pitot", tmp_path, (), None)  # type: ignore[arg-type]
    bench.run("simulate", "--probe", "pitot-static", "-o", "flight.csv", "--rows", "600")
    fit(bench, ())
    assert bench.run("export", "e.json", "--to", "c", "-o", "pitot.h").code == 0
    page = (Path(__file__).parents[2] / "docs/export.md").read_text()
    shown = re.findall(r"^```c\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    assert len(shown) == 1
    include, _, lines = shown[0].partition("\n\n")
    shown_main = f"{include}\nint main(void) {{\n{lines}return airspeed > 0.0 ? 0 : 1;\n}}\n"
    (tmp_path / "shown.c").write_text(shown_main)
    command = [headers.compiler_of("c"), "-std=c99", *headers.STRICT, "-Wno-empty-body"]
    built = subprocess.run(
        [*command, "shown.c", "-o", "shown", "-lm"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stderr
    assert subprocess.run([str(tmp_path / "shown")], check=False).returncode == 0


def test_a_header_says_where_it_is_from(magnetometer: Bench) -> None:
    fit(magnetometer, ("bias[current_a]", "field_declination"))
    magnetometer.run("export", "e.json", "--to", "c", "-o", "sensor.h", "--force")
    text = (magnetometer.folder / "sensor.h").read_text()
    for words in (
        "made by sepcal",
        "calibration: e.json",
        "flight: flight.csv, sha256",
        "residuals mx",
        "field_declination: on the reference or the wind",
        "uT per A",
        "current_a",
    ):
        assert words in text
