# SPDX-License-Identifier: BSD-3-Clause
"""compare, apply, simulate and effects, against NumPy and the oracle's own models."""

import hashlib
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.stats import t as student_t

from apps import Bench, Log, parse_json, values_of
from oracle.five_hole_probe import FiveHoleProbe, rotate_to_navigation
from oracle.magnetometer import compose
from oracle.model import Array, Model

INSIDE_UNITS = ("_s", "_rad", "_radps", "_mps", "_pa", "_kgpm3", "_ut")


def read_record(log: Log) -> dict[str, Array]:
    """The log's columns by quantity, and the true field in body axes where it follows."""
    record = {
        header.rsplit("_", 1)[0]: log.column(header)
        for header in log.headers
        if header.endswith(INSIDE_UNITS)
    }
    if "bn" in record:
        field = np.stack([record[name] for name in ("bn", "be", "bd")])
        body = np.einsum("kji,jk->ik", rotate_to_navigation(record), field)
        record |= dict(zip(("hx", "hy", "hz"), body, strict=True))
    return record


def find_residuals(model: Model, log: Log, values: Array) -> Array:
    """Measured minus modelled, shape (n_z, N)."""
    record = read_record(log)
    return model.measured(record) - model.predict(record, values)


def measure_lag_one(residual: Array, labels: Array, label: str | None = None) -> float:
    """About the common mean, over neighbours in time with the same label."""
    inside = np.full(labels.size, True) if label is None else labels == label
    centred = np.where(inside, residual - residual[inside].mean(), 0)
    neighbours = labels[1:] == labels[:-1]
    return float(np.sum((centred[1:] * centred[:-1])[neighbours]) / np.sum(centred**2))


def simulate_second_flight(bench: Bench) -> Log:
    assert bench.run("simulate", "-o", "second.csv", "--rows", "350", "--seed", "9").code == 0
    return Log(bench.folder / "second.csv")


@pytest.mark.parametrize("flight", ["flight.csv", "second.csv"])
def test_compare(bench: Bench, flight: str):
    """The fitted flight and another one: every number again in NumPy."""
    simulate_second_flight(bench)
    file = bench.folder / flight
    log = Log(file)
    labels = np.array([row[log.index("maneuver")] for row in log.rows])
    residuals = find_residuals(bench.model, log, values_of(bench.base))
    compared = bench.run("compare", flight, "base.json", "--json")
    assert compared.code == 0
    other = "note: second.csv: not the flight that the calibration was fitted to, flight.csv"
    assert compared.err.startswith(other) if flight == "second.csv" else not compared.err
    result = compared.result
    assert list(result) == [
        "schema_version", "model", "inputs", "status", "message", "rmse", "residual", "where",
        "channels", "windows", "validation",
    ]  # fmt: skip
    assert result["inputs"] == {
        "file": flight,
        "sha256": hashlib.sha256(file.read_bytes()).hexdigest(),
        "rows": len(log.rows),
        "rows_used": len(log.rows),
    }
    assert (result["status"], result["message"]) == ("converged", "")

    outputs = bench.model.outputs
    by_output = dict(zip(outputs, residuals, strict=True))
    assert result["rmse"] == pytest.approx(
        {name: np.sqrt(np.mean(r**2)) for name, r in by_output.items()}, rel=1e-9
    )
    for name, r in by_output.items():
        lag_one = measure_lag_one(r, labels)
        assert result["residual"][name]["lag_one"] == pytest.approx(lag_one, abs=1e-9)

    order = list(dict.fromkeys(labels))
    where = [(entry["segment"], entry["output"]) for entry in result["where"]]
    assert where == [(label, name) for label in order for name in outputs]
    for entry in result["where"]:
        r = by_output[entry["output"]]
        part = r[labels == entry["segment"]]
        assert entry["rows"] == part.size
        assert entry["rmse"] == pytest.approx(np.sqrt(np.mean(part**2)), rel=1e-9)
        assert entry["mean"] == pytest.approx(part.mean(), abs=1e-9)
        lag_one = measure_lag_one(r, labels, entry["segment"])
        assert entry["lag_one"] == pytest.approx(lag_one, abs=1e-9)


def test_compare_repeats_the_fits_rmse(bench: Bench):
    compared = bench.run("compare", "flight.csv", "base.json", "--json").result
    assert compared["rmse"] == pytest.approx(bench.base["rmse"], rel=1e-12)


def test_compare_prints_a_table(bench: Bench):
    shown = bench.run("compare", "flight.csv", "base.json")
    assert (shown.code, shown.err) == (0, "")
    log = bench.read_log()
    for label in {row[log.index("maneuver")] for row in log.rows}:
        assert f"\n{label} " in shown.out
    assert "lag one" in shown.out


def test_compare_without_labels(bench: Bench):
    """Ten spans of time, which together hold every row."""
    log = bench.read_log()
    log.drop("maneuver")
    (bench.folder / "plain.csv").write_text(log.text())
    where = bench.run("compare", "plain.csv", "base.json", "--json").result["where"]
    spans = list(dict.fromkeys(entry["segment"] for entry in where))
    assert len(spans) == 10
    starts, ends = np.array([span.split(":") for span in spans], dtype=float).T
    assert np.all(starts[1:] > ends[:-1])
    time = log.column("time_s")
    assert_allclose([starts[0], ends[-1]], [time[0], time[-1]], rtol=1e-5)
    assert sum(entry["rows"] for entry in where) == 3 * len(log.rows)


def correct(bench: Bench, log: Log) -> dict[str, Array]:
    """What apply adds, from the parameters by name."""
    record, xi = read_record(log), values_of(bench.base)
    if bench.app == "sepcal-mag":
        reading = np.stack([record[name] for name in ("mx", "my", "mz")])
        field = np.linalg.solve(compose(xi), reading - xi[3:6, np.newaxis])
        return dict(zip(("mx_cal_ut", "my_cal_ut", "mz_cal_ut"), field, strict=True))
    read = FiveHoleProbe(4.5, 4.5).read(record)
    by_name = dict(zip(FiveHoleProbe.linear + FiveHoleProbe.nonlinear, xi, strict=True))
    alpha = (1 + by_name["lambda_alpha"]) * read.alpha + by_name["b_alpha"]
    beta = (1 + by_name["lambda_beta"]) * read.beta + by_name["b_beta"]
    u, v, w = np.cos(alpha) * np.cos(beta), np.sin(beta), np.sin(alpha) * np.cos(beta)
    eps = by_name["eps_phi"]
    v, w = np.cos(eps) * v + np.sin(eps) * w, np.cos(eps) * w - np.sin(eps) * v
    return {
        "airspeed_cal_mps": (1 + by_name["lambda_va"]) * read.speed + by_name["b_va"],
        "alpha_cal_rad": np.arctan2(w, u),
        "beta_cal_rad": np.arctan2(v, np.hypot(u, w)),
    }


@pytest.mark.parametrize("flight", ["flight.csv", "second.csv"])
def test_apply(bench: Bench, flight: str):
    """Every column and row byte for byte, and the corrected readings on the right."""
    simulate_second_flight(bench)
    applied = bench.run("apply", flight, "base.json", "-o", "corrected.csv", "--json")
    assert (applied.code, applied.err) == (0, "")
    log, corrected = Log(bench.folder / flight), Log(bench.folder / "corrected.csv")
    added = correct(bench, log)
    assert corrected.headers == [*log.headers, *added]
    assert [row[:-3] for row in corrected.rows] == log.rows
    for header, values in added.items():
        assert_allclose(corrected.column(header), values, rtol=1e-12, atol=1e-13)
    assert applied.result["rows"] == len(log.rows)
    assert applied.result["status"] == "converged"
    assert applied.result["columns"] == list(added)


def test_apply_brings_the_reading_nearer(bench: Bench):
    """A magnetometer against the field, a probe against the wind triangle of the truth."""
    log = bench.read_log()
    record = read_record(log)
    bench.run("apply", "flight.csv", "base.json", "-o", "corrected.csv")
    corrected = Log(bench.folder / "corrected.csv")
    if bench.app == "sepcal-mag":
        for axis in "xyz":
            raw = record[f"m{axis}"] - record[f"h{axis}"]
            left = corrected.column(f"m{axis}_cal_ut") - record[f"h{axis}"]
            assert np.std(left) < 0.1 * np.linalg.norm(raw) / np.sqrt(raw.size)
        return
    bench.run("simulate", "-o", "again.csv", "--rows", "400", "--truth", "truth.json")
    truth = parse_json((bench.folder / "truth.json").read_text())["parameters"]
    speed = (1 + truth["lambda_va"]) * FiveHoleProbe(4.5, 4.5).read(record).speed + truth["b_va"]
    assert_allclose(corrected.column("airspeed_cal_mps"), speed, atol=0.1)


def test_apply_keeps_what_it_does_not_know(bench: Bench):
    """CRLF, quoted cells with commas and quotes, blanks, text, a missing last line end."""
    log = bench.read_log()
    log.add("remark", ['"gust, says ""crew"""', "", " calm ", *["42.50"] * (len(log.rows) - 3)])
    log.replace("current_a", ["n/a"] * len(log.rows))
    lines = log.text().splitlines()
    (bench.folder / "odd.csv").write_bytes("\r\n".join(lines).encode())
    applied = bench.run("apply", "odd.csv", "base.json", "-o", "corrected.csv")
    assert applied.code == 0, applied.err
    copied = (bench.folder / "corrected.csv").read_bytes().decode().splitlines()
    assert [line.rsplit(",", 3)[0] for line in copied] == lines
    plain = bench.run("apply", "flight.csv", "base.json", "-o", "plain.csv")
    assert plain.code == 0
    added = [line.rsplit(",", 3)[1:] for line in copied]
    assert added == [
        row[-3:] for row in (lambda log: [log.headers, *log.rows])(Log(bench.folder / "plain.csv"))
    ]


def test_apply_twice_is_refused(bench: Bench):
    bench.run("apply", "flight.csv", "base.json", "-o", "corrected.csv")
    again = bench.run("apply", "corrected.csv", "base.json", "-o", "twice.csv")
    assert again.code == 2
    assert "corrected.csv" in again.err
    assert "already; apply the calibration to the original log" in again.err
    assert not (bench.folder / "twice.csv").exists()


def test_apply_needs_the_readings_alone(bench: Bench):
    """No attitude, no velocity, no time: a calibrated sensor has none of these."""
    log = bench.read_log()
    kept = {
        "sepcal-pitot": ("pt_pa", "ps_pa", "dpa_pa", "dpb_pa", "rho_kgpm3"),
        "sepcal-mag": ("mx_ut", "my_ut", "mz_ut"),
    }[bench.app]
    for header in [header for header in log.headers if header not in kept]:
        log.drop(header)
    (bench.folder / "bare.csv").write_text(log.text())
    assert bench.run("apply", "bare.csv", "base.json", "-o", "bare_corrected.csv").code == 0
    bench.run("apply", "flight.csv", "base.json", "-o", "corrected.csv")
    bare, whole = (Log(bench.folder / name) for name in ("bare_corrected.csv", "corrected.csv"))
    for header in bare.headers[-3:]:
        assert_array_equal(bare.column(header), whole.column(header))


def read_bytes(folder: Path, *names: str) -> list[bytes]:
    return [(folder / name).read_bytes() for name in names]


def test_simulate_seeds(bench: Bench):
    for name, seed in (("a", "1"), ("b", "1"), ("c", "2")):
        simulated = bench.run("simulate", "-o", name, "--rows", "50", "--seed", seed)
        assert (simulated.code, simulated.err) == (0, "")
    first, same, other = read_bytes(bench.folder, "a", "b", "c")
    assert first == same
    assert first != other


def test_simulate_writes_and_reads_the_truth(bench: Bench):
    """Written where the file isn't there, read and left alone where it is."""
    written = bench.run("simulate", "-o", "a", "--rows", "60", "--truth", "truth.json", "--json")
    assert written.code == 0
    text = (bench.folder / "truth.json").read_text()
    assert written.out == text
    truth = parse_json(text)
    assert list(truth) == ["model", "parameters", "options", "noise"]
    assert set(truth["parameters"]) == set(bench.model.parameters)
    bench.run("simulate", "-o", "b", "--rows", "60", "--truth", "truth.json")
    assert (bench.folder / "truth.json").read_text() == text
    first, same = read_bytes(bench.folder, "a", "b")
    assert first == same

    output = bench.model.outputs[0]
    (bench.folder / "quiet.json").write_text(f'{{"noise": {{"{output}": 0}}}}')
    bench.run("simulate", "-o", "c", "--rows", "60", "--truth", "quiet.json")
    noisy, quiet = Log(bench.folder / "a"), Log(bench.folder / "c")
    unit = {"vn": "mps", "mx": "ut"}[output]
    changed = [h for h in noisy.headers[:-1] if np.any(noisy.column(h) != quiet.column(h))]
    assert changed == [f"{output}_{unit}"]
    values = np.array([truth["parameters"][name] for name in bench.model.parameters])
    assert np.abs(find_residuals(bench.model, quiet, values)[0]).max() < 1e-9


def test_effects(bench: Bench):
    """Every port and physical effect of interface.md, each with equation, drivers and unit."""
    result = bench.run("effects", "--json").result
    assert list(result) == ["schema_version", "effects"]
    names = [
        effect["name"] for effect in result["effects"] if effect["model"] == bench.base["model"]
    ]
    assert len(set(names)) == len(names)
    ports, own = {
        "sepcal-pitot": (
            "wind airspeed_scale airspeed_bias pressure_offset alpha_offset beta_offset",
            "heading_bias time_offset pneumatic_lag lever_arm density_error compressibility upwash "
            "sidewash icing_ramp water_blockage mounting_error wind_shear wind_drift propwash "
            "pressure_offset clock_drift angle_loss",
        ),
        "sepcal-mag": (
            "bias scale axis_scale",
            "bias_step cubic_nonlinearity time_offset sensor_lag field_declination warm_up "
            "eddy_currents attitude_bias bias_drift clock_drift",
        ),
    }[bench.app]
    assert {name.split("[")[0] for name in names if "[" in name} == set(ports.split())
    assert {name for name in names if "[" not in name} == set(own.split())
    table = bench.run("effects")
    assert (table.code, table.err) == (0, "")
    for effect in result["effects"]:
        assert list(effect) == ["model", "name", "equation", "drivers", "unit"]
        assert all(effect.values())
        assert f"\n{effect['name']} " in table.out


def test_intervals(bench: Bench):
    """Close to the Gaussian ones, which SciPy makes of the calibration."""
    printed = bench.run("intervals", "flight.csv", "base.json", "-o", "i.json", "--json")
    assert printed.code == 0
    assert (bench.folder / "i.json").read_text() == printed.out
    result = printed.result
    assert list(result) == [
        "schema_version", "model", "inputs", "status", "message", "level", "parameters",
    ]  # fmt: skip
    estimates = bench.base["parameters"]
    measured = result["inputs"]["rows_used"] * len(bench.model.outputs)
    reach = student_t.ppf(0.975, measured - len(estimates))
    for name, at in result["parameters"].items():
        half = reach * estimates[name]["standard_error"]
        value = estimates[name]["value"]
        assert at["gaussian"] == pytest.approx([value - half, value + half], rel=1e-9)
        assert at["profile"] == pytest.approx(at["gaussian"], abs=0.1 * half)
        assert at["ends"] == ["crossed", "crossed"]
    table = bench.run("intervals", "flight.csv", "base.json", "--level", "0.5")
    assert "50 % Gaussian" in table.out
    assert all(name in table.out for name in estimates)
    chosen = list(estimates)[-2:]
    named = [part for name in chosen for part in ("--parameter", name)]
    only = bench.run("intervals", "flight.csv", "base.json", "--json", *named)
    assert only.result["parameters"] == {name: result["parameters"][name] for name in chosen}
    typo = bench.run("intervals", "flight.csv", "base.json", "--parameter", "w_x")
    assert typo.code == 2
    assert "'w_x'" in typo.err


def test_intervals_of_another_flight_or_an_impossible_level_are_refused(bench: Bench):
    simulate_second_flight(bench)
    other = bench.run("intervals", "second.csv", "base.json", "-o", "i.json")
    assert other.code == 2
    assert "not the flight that the calibration was fitted to, flight.csv" in other.err
    level = bench.run("intervals", "flight.csv", "base.json", "--level", "95", "-o", "i.json")
    assert level.code == 2
    assert "between 0 and 1" in level.err
    assert not (bench.folder / "i.json").exists()
