# SPDX-License-Identifier: BSD-3-Clause
"""What an exported header says of itself: drivers beyond what the fit saw, which calibration."""

import hashlib
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import headers
from apps import Bench, Log

DOCUMENT = Path(__file__).parents[2] / "docs/export.md"
OUTSIDE = 3.0


def fit(bench: Bench, *effects: str) -> None:
    command = [word for effect in effects for word in ("--effect", effect)]
    done = bench.run("fit", "flight.csv", *bench.options, *command, "-o", "e.json")
    assert done.code in (0, 4, 5), done.err


def export(bench: Bench, *more: str, calibration: str = "e.json") -> str:
    done = bench.run("export", calibration, "--to", "c", "-o", "sensor.h", "--force", *more)
    assert done.code == 0, done.err
    return (bench.folder / "sensor.h").read_text()


def ranges_of(bench: Bench) -> dict[str, list[float]]:
    ranges: dict[str, list[float]] = json.loads((bench.folder / "e.json").read_text())[
        "driver_ranges"
    ]
    return ranges


def ends(log: Log, header: str) -> list[float]:
    column = log.column(header)
    return [float(column.min()), float(column.max())]


def test_a_calibration_keeps_what_its_drivers_were(magnetometer: Bench) -> None:
    log = magnetometer.read_log()
    fit(magnetometer, "bias[current_a]", "scale[temp_degc*abs(throttle)]", "field_declination")
    expected = {name: ends(log, name) for name in ("current_a", "temp_degc", "throttle")}
    assert ranges_of(magnetometer) == expected
    fit(magnetometer)
    assert "driver_ranges" not in json.loads((magnetometer.folder / "e.json").read_text())


def test_of_rows_that_were_fitted(magnetometer: Bench) -> None:
    log = magnetometer.read_log()
    current = log.column("current_a")
    limit = float(np.quantile(current, 0.8))
    done = magnetometer.run(
        *("fit", "flight.csv", "--effect", "bias[current_a]", "-o", "e.json"),
        *("--where", f"current_a < {limit!r}"),
    )
    assert done.code == 0, done.err
    seen = current[current < limit]
    assert ranges_of(magnetometer) == {"current_a": [seen.min(), seen.max()]}


def test_of_readings_that_are_followed(pitot: Bench) -> None:
    log = pitot.read_log()
    fit(pitot, "airspeed_scale[alpha^2]", "upwash", "density_error")
    found = ranges_of(pitot)
    k = (
        4.5
        if "--k-alpha" not in pitot.options
        else float(pitot.options[pitot.options.index("--k-alpha") + 1])
    )
    alpha = log.column("dpa_pa") / (k * (log.column("pt_pa") - log.column("ps_pa")))
    assert found["alpha"] == pytest.approx([alpha.min(), alpha.max()], rel=1e-12)
    assert found["q"] == ends(log, "q_radps")


@pytest.mark.parametrize("more", [(), ("--float",)])
def test_beyond_the_range_is_said(magnetometer: Bench, more: tuple[str, ...]) -> None:
    """On either side, with the outputs that apply gives."""
    fit(magnetometer, "bias[current_a]")
    export(magnetometer, *more)
    low, high = ranges_of(magnetometer)["current_a"]
    program = headers.build(magnetometer.folder / "sensor.h", "c", "c99")
    span = high - low
    currents = [low, high, 0.5 * (low + high), low - 1e-3 * span, high + 1e-3 * span, high + span]
    log = magnetometer.read_log()
    rows = np.array([[20.0, 1.0, 40.0, current] for current in currents])
    status, found = headers.run_rows(program, rows)
    assert list(status) == [0, 0, 0, OUTSIDE, OUTSIDE, OUTSIDE]
    for header, column in zip(("mx_ut", "my_ut", "mz_ut", "current_a"), rows.T, strict=True):
        log.replace(header, np.resize(column, len(log.rows)))
    (magnetometer.folder / "others.csv").write_text(log.text())
    done = magnetometer.run("apply", "others.csv", "e.json", "-o", "applied.csv")
    assert done.code == 0, done.err
    applied = Log(magnetometer.folder / "applied.csv")
    expected = np.column_stack([applied.column(f"m{axis}_cal_ut")[:6] for axis in "xyz"])
    tolerance = 1e-6 * 45 if more else 1e-12 * 45
    np.testing.assert_allclose(found, expected, atol=tolerance, rtol=0)


def test_a_wrong_range_fails_the_self_test(magnetometer: Bench) -> None:
    """The guard is tested: a range that is a tenth too wide is seen."""
    fit(magnetometer, "bias[current_a]")
    text = export(magnetometer)
    low, high = ranges_of(magnetometer)["current_a"]
    assert f"{{{low!r}, {high!r}}}" in text
    header = magnetometer.folder / "sensor.h"
    for spoilt in (f"{{{low!r}, {1.1 * high!r}}}", f"{{{low - 0.1 * high!r}, {high!r}}}"):
        header.write_text(text.replace(f"{{{low!r}, {high!r}}}", spoilt))
        program = headers.build(header, "c", "c99")
        assert subprocess.run([program], input="", text=True, check=False).returncode == 3


def test_what_is_not_guarded_is_said(magnetometer: Bench) -> None:
    fit(magnetometer, "bias[current_a]")
    calibration = json.loads((magnetometer.folder / "e.json").read_text())
    del calibration["driver_ranges"]
    (magnetometer.folder / "old.json").write_text(json.dumps(calibration))
    with_flight = export(magnetometer, calibration="old.json")
    assert "range_1" in with_flight  # from the flight, which is there
    magnetometer.flight.unlink()
    text = export(magnetometer, calibration="old.json")
    assert "range_1" not in text
    assert "current_a is not guarded: over which values the fit saw it is not known" in text
    program = headers.build(magnetometer.folder / "sensor.h", "c", "c99")
    status, _ = headers.run_rows(program, np.array([[20.0, 1.0, 40.0, 1e6]]))
    assert list(status) == [0]


def test_a_driver_that_was_constant_is_not_guarded(pitot: Bench) -> None:
    log = pitot.read_log()
    log.replace("temp_k", np.full(len(log.rows), 288.15))
    pitot.flight.write_text(log.text())
    fit(pitot, "density_error")
    text = export(pitot)
    assert "temperature is not guarded: on the flight that was fitted it was constant" in text


@pytest.mark.parametrize("range_", [[3.0, 2.0], [1.0], "wide", [None, 2.0]])
def test_a_range_that_is_none_is_refused(magnetometer: Bench, range_: object) -> None:
    fit(magnetometer, "bias[current_a]")
    calibration = json.loads((magnetometer.folder / "e.json").read_text())
    calibration["driver_ranges"]["current_a"] = range_
    (magnetometer.folder / "e.json").write_text(json.dumps(calibration))
    done = magnetometer.run("export", "e.json", "--to", "c", "-o", "sensor.h")
    assert done.code == 2
    assert "e.json is damaged" in done.err
    assert done.err.count("\n") == 1


def documented_crc(header: Path) -> str:
    """What the line in docs/export.md prints of a header."""
    lines = [line for line in DOCUMENT.read_text().splitlines() if line.startswith("python3 -c")]
    assert len(lines) == 1
    command = lines[0].replace("python3", sys.executable, 1).replace("pitot.h", str(header))
    done = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=True)
    return done.stdout.strip()


@pytest.mark.parametrize("target", ["c", "cpp"])
@pytest.mark.parametrize("more", [(), ("--float",)])
def test_the_crc_is_of_the_constants(
    magnetometer: Bench, target: str, more: tuple[str, ...]
) -> None:
    log = magnetometer.read_log()
    time = log.column("time_s") + 1764000000.0
    log.add("unix_s", time)
    magnetometer.flight.write_text(log.text())
    fit(magnetometer, "bias[unix_s]", "scale[spline(temp_degc,4)]", "bias[current_a]")
    done = magnetometer.run("export", "e.json", "--to", target, "-o", "sensor.h", *more, "--force")
    assert done.code == 0, done.err
    header = magnetometer.folder / "sensor.h"
    said = re.findall(r"crc = 0x([0-9A-F]{8})UL;", header.read_text())
    assert said == [documented_crc(header)]
    assert said == [f"{headers.constants_crc(header.read_text()):08X}"]


def test_the_id_is_of_the_calibration(magnetometer: Bench) -> None:
    fit(magnetometer, "bias[current_a]", "bias[throttle]")
    text = export(magnetometer)
    expected = hashlib.sha256((magnetometer.folder / "e.json").read_bytes()).hexdigest()
    assert re.findall(r'calibration_id\[65\] = "(\w+)"', text) == [expected]
    fewer = export(magnetometer, "--without", "bias[throttle]")
    assert re.findall(r'calibration_id\[65\] = "(\w+)"', fewer) != [expected]
    (magnetometer.folder / "id.c").write_text(
        '#include "sensor.h"\n#include <stdio.h>\nint main(void) {\n'
        '  printf("%s %08lX\\n", sepcal_magnetometer_calibration_id, sepcal_magnetometer_crc);\n'
        "  return 0;\n}\n"
    )
    export(magnetometer)
    command = [headers.compiler_of("c"), "-std=c99", *headers.STRICT, "id.c", "-o", "id"]
    subprocess.run([*command, "-lm"], cwd=magnetometer.folder, check=True)
    done = subprocess.run([magnetometer.folder / "id"], capture_output=True, text=True, check=True)
    crc = headers.constants_crc(text)
    assert done.stdout == f"{expected} {crc:08X}\n"
