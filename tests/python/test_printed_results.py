# SPDX-License-Identifier: BSD-3-Clause
"""What the apps and Python print for people: bounds, verdicts on residuals, notes, ways out."""

import numpy as np
import pytest

import sepcal
from apps import Bench, Outcome
from oracle.scalar_examples import ScalarExample1
from oracle.simulate import simulate_scalar


def line_of(outcome: Outcome, start: str) -> str:
    """The one line of standard output that starts so."""
    (line,) = [line for line in outcome.out.splitlines() if line.startswith(start)]
    return line


def hold_away(bench: Bench, names: tuple[str, ...]) -> tuple[str, ...]:
    """Bounds that keep these parameters ten standard errors below their estimates."""
    arguments = []
    for name in names:
        free = bench.base["parameters"][name]
        edge = free["value"] - 10 * free["standard_error"]
        arguments += ["--bounds", f"{name}={edge - 1!r},{edge!r}"]
    return tuple(arguments)


# --- parameters at their bounds


@pytest.mark.parametrize("count", [1, 2])
def test_the_status_line_names_parameters_at_their_bounds(bench: Bench, count: int):
    names = bench.model.linear[1 : 1 + count]
    fitted = bench.run(
        "fit", "flight.csv", *bench.options, *hold_away(bench, names), "-o", "held.json"
    )
    assert fitted.code == 0, fitted.err
    words = "1 parameter at its bound" if count == 1 else "2 parameters at their bounds"
    expected = f"status: converged, {words}: {', '.join(names)}"
    assert line_of(fitted, "status: ") == expected
    for verb in (("compare",), ("apply", "-o", "out.csv"), ("intervals", "--parameter", "b_va")):
        if verb[0] == "intervals" and bench.app != "sepcal-pitot":
            continue
        later = bench.run(verb[0], "flight.csv", "held.json", *verb[1:])
        assert line_of(later, "status: ") == expected


def test_python_prints_the_bounds_that_stopped_a_parameter():
    model = ScalarExample1()
    record = simulate_scalar(model, np.array([1.0, 1.0, 0.1]), seed=1)
    free = sepcal.fit(sepcal.ScalarExample1(), record)
    assert free.at_bound == []
    assert str(free).splitlines()[1] == "status: converged"
    held = sepcal.fit(sepcal.ScalarExample1(), record, bounds={"b": (-0.125, 0.0), "c": (-2, 0.5)})
    assert held.at_bound == ["c", "b"]
    lines = str(held).splitlines()
    assert lines[1] == "status: converged, 2 parameters at their bounds: c, b"
    (row,) = [line for line in lines if line.startswith("b ")]
    assert row.endswith("[-0.125, 0]  AT ITS BOUND")


# --- residuals


def write_with_trend(bench: Bench, size: float) -> None:
    """Adds a slow sine of that size to the first output."""
    log = bench.read_log()
    header = {"sepcal-pitot": "vn_mps", "sepcal-mag": "mx_ut"}[bench.app]
    slow = size * np.sin(np.linspace(0, 20, len(log.rows)))
    log.replace(header, log.column(header) + slow)
    (bench.folder / "slow.csv").write_text(log.text())


def test_a_verdict_for_each_output(bench: Bench):
    """A slow error in one output is told from the noise in the others."""
    write_with_trend(bench, size=2.0)
    shown = bench.run("compare", "slow.csv", "base.json")
    result = bench.run("compare", "slow.csv", "base.json", "--json").result
    first, *others = bench.model.outputs
    lag_one = result["residual"][first]["lag_one"]
    rows = result["inputs"]["rows_used"]
    assert lag_one > 0.5
    assert line_of(shown, f"{first}: ") == (
        f"{first}: not white: neighbouring residuals correlate "
        f"({lag_one:.3f}, noise alone within {3 / np.sqrt(rows):.2g})"
    )
    for name in others:
        white = abs(result["residual"][name]["lag_one"]) <= 3 / np.sqrt(rows)
        assert line_of(shown, f"{name}: ").startswith(f"{name}: {'white' if white else 'not'}")


def test_python_gives_the_same_verdict():
    probe = sepcal.Magnetometer()
    flight = sepcal.simulate(probe, rows=400)
    calibration = sepcal.fit(probe, flight, samples=50)
    columns = {header: values.copy() for header, values in flight.items()}
    columns["mx_ut"] = columns["mx_ut"] + 3 * (-1.0) ** np.arange(400)
    compared = calibration.compare(sepcal.Flight(columns))
    first, second, _ = compared.overall
    limit = 3 / np.sqrt(400)
    assert not first.is_white
    assert first.verdict == (
        "not white: neighbouring residuals alternate "
        f"({first.lag_one:.3f}, noise alone within {limit:.2g})"
    )
    assert f"mx: {first.verdict}" in str(compared).splitlines()
    assert second.is_white == (abs(second.lag_one) <= limit)


def test_a_mean_of_rounding_is_printed_as_zero(magnetometer: Bench):
    """A free bias takes the mean out of the residuals but for 1e-15 or so."""
    shown = magnetometer.run("compare", "flight.csv", "base.json")
    rows = [line.split() for line in shown.out.splitlines() if line.startswith("all ")]
    assert len(rows) == 3
    for _, output, _, rmse, mean, _ in rows:
        assert output in magnetometer.model.outputs
        assert float(rmse) > 0.1
        assert mean == "0"
    flight = sepcal.read_csv(magnetometer.flight)
    printed = str(sepcal.load(magnetometer.folder / "base.json").compare(flight)).splitlines()
    rows = [line.split() for line in printed if line.startswith("all ")]
    assert [row[4] for row in rows] == ["0", "0", "0"]


# --- rows that are dropped, columns that are missing, units that can't be


def test_later_verbs_drop_invalid_rows_too(bench: Bench):
    """A calibration fitted without --drop-invalid meets a log with a hole in it."""
    log = bench.read_log()
    header = {"sepcal-pitot": "dpa_pa", "sepcal-mag": "mx_ut"}[bench.app]
    log.put(9, header, "lost")
    (bench.folder / "holes.csv").write_text(log.text())
    for verb in (("compare",), ("apply", "-o", "out.csv")):
        command = (verb[0], "holes.csv", "base.json", *verb[1:], "--json")
        refused = bench.run(*command)
        assert refused.code == 2
        assert "--drop-invalid drops such rows" in refused.err
        dropped = bench.run(*command, "--drop-invalid")
        assert dropped.code == 0, dropped.err
        assert dropped.err.startswith(f"note: holes.csv: 1 of {len(log.rows)} rows ")
        if verb[0] == "compare":
            assert dropped.result["inputs"]["rows_used"] == len(log.rows) - 1
        else:
            assert dropped.result["rows_left_empty"] == 1


def test_a_header_that_nearly_is_one(bench: Bench):
    log = bench.read_log()
    log.replace("pitch_rad", log.column("pitch_rad"), "pich_rad")
    (bench.folder / "near.csv").write_text(log.text())
    refused = bench.fit(flight="near.csv")
    assert refused.code == 2
    said = "did you mean 'pich_rad'? --map pitch_rad=pich_rad reads it so; the file has: "
    assert said in refused.err
    if bench.app == "sepcal-pitot":
        assert "column 'pitch_rad' is missing (pitch_deg would do as well); " in refused.err
    mapped = bench.fit("--map", "pitch_rad=pich_rad", flight="near.csv")
    assert mapped.result["parameters"] == bench.fit().result["parameters"]


def test_degrees_under_radians_are_noted(bench: Bench):
    """A note, whatever comes of the fit; nothing where the header says degrees."""
    log = bench.read_log()
    degrees = np.degrees(np.unwrap(log.column("yaw_rad")) + 1.0)
    log.replace("yaw_rad", degrees)
    (bench.folder / "degrees.csv").write_text(log.text())
    fitted = bench.fit("--samples", "20", flight="degrees.csv")
    assert fitted.code in (0, 4, 5)
    assert fitted.err.startswith("note: degrees.csv: column 'yaw_rad' lies outside -6.3 to 6.3 rad")
    log.headers[log.index("yaw_rad")] = "yaw_deg"
    (bench.folder / "degrees.csv").write_text(log.text())
    assert "yaw" not in bench.fit("--samples", "20", flight="degrees.csv").err
