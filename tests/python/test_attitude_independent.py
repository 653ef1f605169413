# SPDX-License-Identifier: BSD-3-Clause
"""A magnetometer of which only the field's strength is known: intervals, poor coverage, the app.

Few seeds each of the study: `scripts/study field-strength`.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal
from apps import Bench, Log, parse_json
from oracle.model import Array
from studies.field_strength import (
    CAPS,
    ROWS,
    STRENGTH,
    TRUTH,
    WIDE,
    collapse,
    cover,
    fit,
    is_honest,
    is_refused,
    one_heading,
    read_field,
)
from studies.study import pooled_limits

SEEDS = range(8)


def test_every_interval_covers_the_truth() -> None:
    """Of eight records of each noise and share of the sphere; the study has 400.

    Of 8 a count below 4 comes once in 65,000, of all 54 counts together: four standard errors.
    """
    counts: list[int] = []
    for noise, covered in WIDE:
        fits = [fit(read_field(seed, noise, covered)) for seed in SEEDS]
        findings, held = cover(noise, covered, fits)
        assert [one for one in findings if not one.holds] == []
        counts += held
    fewest, most = pooled_limits([(len(TRUTH), len(SEEDS) * len(WIDE))], 0.95)
    assert fewest <= sum(counts) <= most


@pytest.mark.parametrize(("noise", "covered"), CAPS)
def test_a_collapse_is_never_a_result(noise: float, covered: float) -> None:
    """On a small cap a fit is either good, with honest errors, or says that it isn't.

    One cap each of the study's eight, of a seed that does not take long.
    """
    finding = collapse(noise, covered, [fit(read_field(4, noise, covered))])
    assert finding.holds, finding


def test_a_fit_that_is_far_from_the_truth_is_not_honest() -> None:
    columns = read_field(1, 0.5)
    assert is_honest(fit(columns))
    assert not is_honest(fit({**columns, "mx": columns["mx"] + 1.0}))


def test_a_cap_that_shows_nothing_is_named() -> None:
    result = fit(read_field(0, 0.5, 0.02))
    assert result.status == "not_identifiable"
    open_ones = {name for entry in result.unobservable for name in entry.parameters}
    assert {"lambda_z", "n_z"} <= open_ones or {"lambda_z", "lambda_x"} <= open_ones
    assert "can't be told apart" in result.message or "bound" in result.message


def test_a_rotation_is_listed_and_the_noise_settles() -> None:
    result = fit(read_field(1, 0.5))
    assert result.status == "converged"
    assert [entry.text for entry in result.unobservable] == ["eta_x", "eta_y", "eta_z"]
    assert "a rotation" in result.message
    assert tuple(result.names) == tuple(TRUTH)
    assert result.noise["field"] == pytest.approx(0.5, rel=0.15)  # 4 sigma of 400 rows
    assert result.stage_one.samples.size == 0


def test_the_field_column_may_be_there() -> None:
    columns = read_field(2, 0.3)
    with_zeros = fit({**columns, "field": np.zeros(ROWS)})
    assert_allclose(with_zeros.values, fit(columns).values, rtol=1e-12)


def test_field_and_strength_contradict_each_other() -> None:
    with pytest.raises(sepcal.Error, match="field and field_strength contradict"):
        sepcal.Magnetometer(field=(20, 0, 40), field_strength=48)
    with pytest.raises(sepcal.Error, match="field_strength is -1; give the field's strength in uT"):
        sepcal.Magnetometer(field_strength=-1)
    assert repr(sepcal.Magnetometer(field_strength=48)) == "Magnetometer(field_strength=48.0)"


def test_a_strength_of_the_readings() -> None:
    """The mean radius of the ellipsoid; the shape is that against a given strength."""
    flight = sepcal.datasets.load("magnetometer")
    auto = sepcal.fit(sepcal.Magnetometer(field_strength="auto"), flight)
    found = auto.to_dict()["options"]["field_strength"]
    given = sepcal.fit(sepcal.Magnetometer(field_strength=found), flight)
    for name in given.parameters:
        assert auto[name].value == given[name].value
    truth = float(np.linalg.norm([19.7, -1.4, 49.4]))
    assert abs(found / truth - 1) < 0.05  # scale errors of some per cent
    told = "the field's strength is taken for the mean radius of the readings' ellipsoid"
    assert sum(told in note for note in auto.notes) == 1
    assert not any(told in note for note in given.notes)
    assert auto.apply(flight)


def test_a_strength_of_the_readings_needs_a_flight() -> None:
    sensor = sepcal.Magnetometer(field_strength="auto")
    assert repr(sensor) == "Magnetometer(field_strength='auto')"
    with pytest.raises(sepcal.Error, match="'auto' is found in a Flight; give these"):
        sepcal.fit(sensor, read_field(2, 0.3))
    with pytest.raises(sepcal.Error, match="'auto' is found in the flight of a fit"):
        sensor.at_noise({"field": 0.1})
    with pytest.raises(sepcal.Error, match="field_strength is 'much'; give a number in uT, or"):
        sepcal.Magnetometer(field_strength="much")


def test_readings_that_show_no_strength(tmp_path: Path) -> None:
    """A fit and a check say so; and no calibration is without its strength."""
    time = np.arange(50) * 0.1
    flight = sepcal.Flight({
        "time_s": time,
        "mx_ut": 20 + 0.01 * np.sin(time),
        "my_ut": np.full(50, 5.0),
        "mz_ut": np.full(50, 45.0),
    })  # fmt: skip
    sensor = sepcal.Magnetometer(field_strength="auto")
    with pytest.raises(sepcal.Error, match="lie on no ellipsoid"):
        sepcal.fit(sensor, flight)
    assert sepcal.check(sensor, flight).refused
    base = sepcal.fit(sepcal.Magnetometer(field_strength=53), sepcal.datasets.load("magnetometer"))
    damaged = base.to_dict()
    damaged["options"]["field_strength"] = []
    (tmp_path / "damaged.json").write_text(json.dumps(damaged))
    with pytest.raises(sepcal.Error, match="where the field's strength should"):
        sepcal.load(tmp_path / "damaged.json")


def test_the_app_takes_the_strength_of_the_readings(magnetometer: Bench) -> None:
    put_readings(magnetometer, read_field(3, 0.4), 10, "mgauss")
    fitted = magnetometer.run("fit", "flight.csv", "--field-strength", "auto", "-o", "auto.json")
    assert fitted.code == 0, fitted.err
    assert "taken for the mean radius of the readings' ellipsoid" in fitted.err
    checked = magnetometer.run("check", "flight.csv", "--field-strength", "auto", "--json")
    assert checked.result["refused"] is None


def put_readings(bench: Bench, columns: dict[str, Array], factor: float, unit: str) -> None:
    """A log of time and readings alone."""
    header = ["time_s", *(f"{name}_{unit}" for name in columns)]
    rows = np.column_stack([0.02 * np.arange(ROWS), *columns.values()])
    rows[:, 1:] *= factor
    lines = [",".join(header), *(",".join(map(repr, map(float, row))) for row in rows)]
    bench.flight.write_text("\n".join(lines) + "\n")


def test_the_app_needs_nothing_but_readings(magnetometer: Bench) -> None:
    """Fit, compare, apply; the same numbers as from arrays, in whatever unit."""
    columns = read_field(3, 0.4)
    put_readings(magnetometer, columns, 10, "mgauss")
    fitted = magnetometer.fit("--field-strength", "48", "-o", "norm.json")
    assert (fitted.code, fitted.err) == (0, "")
    result = fitted.result
    assert result["model"] == "magnetometer-norm"
    assert result["options"]["field_strength"] == 48
    assert result["stage_one"]["samples"] == 0
    values = [entry["value"] for entry in result["parameters"].values()]
    assert_allclose(values, fit(columns).values, rtol=1e-7)
    assert [entry["combination"] for entry in result["unobservable"]] == ["eta_x", "eta_y", "eta_z"]

    compared = magnetometer.run("compare", "flight.csv", "norm.json", "--json")
    assert compared.code == 0
    assert compared.result["rmse"] == pytest.approx(result["rmse"], rel=1e-9)

    applied = magnetometer.run("apply", "flight.csv", "norm.json", "-o", "out.csv")
    assert applied.code == 0
    assert "up to a rotation" in applied.err
    corrected = Log(magnetometer.folder / "out.csv")
    strength = np.linalg.norm([corrected.column(f"m{axis}_cal_ut") for axis in "xyz"], axis=0)
    assert np.sqrt(np.mean((strength - STRENGTH) ** 2)) < 0.6  # the noise is 0.4
    loaded = sepcal.load(magnetometer.folder / "norm.json")
    assert loaded.to_json() == (magnetometer.folder / "norm.json").read_text()


def test_the_app_names_what_poor_coverage_leaves_open(magnetometer: Bench) -> None:
    put_readings(magnetometer, read_field(4, 0.5, 0.02), 1, "ut")
    refused = magnetometer.fit("--field-strength", "48")
    assert refused.code == 4
    assert refused.result["status"] == "not_identifiable"
    assert len(refused.result["unobservable"]) > 3


def test_readings_in_a_unit_that_the_header_does_not_say(magnetometer: Bench) -> None:
    put_readings(magnetometer, read_field(5, 0.4), 0.01, "ut")
    refused = magnetometer.fit("--field-strength", "48")
    assert (refused.code, refused.out) == (2, "")
    assert "an ellipsoid of" in refused.err
    assert "check the unit in the headers" in refused.err


def test_a_small_cap_in_noise_is_no_result() -> None:
    """On one heading at 1 uT: exit 4, whatever converged; the study has thirty of them."""
    assert one_heading([is_refused(seed) for seed in range(1000, 1002)]).holds


def test_a_field_that_falls_with_height_is_followed(magnetometer: Bench) -> None:
    """A balloon's, by 6 %: taken for constant, it is a scale error and more noise."""
    folder = magnetometer.folder
    made = magnetometer.run("simulate", "-o", "flight.csv", "--truth", "t.json", "--rows", "2000")
    assert made.code == 0, made.err
    truth = parse_json((folder / "t.json").read_text())["parameters"]
    log = magnetometer.read_log()
    field = np.linalg.norm([log.column(f"b{axis}_ut") for axis in "ned"], axis=0)
    lost = 0.06 * np.linspace(0, 1, field.size)
    for axis in "xyz":
        reading = log.column(f"m{axis}_ut")
        log.replace(f"m{axis}_ut", reading - lost * (reading - truth[f"n_{axis}"]))
    (folder / "constant.csv").write_text(log.text())
    log.add("field_strength_ut", field * (1 - lost))
    (folder / "balloon.csv").write_text(log.text())
    strength = ("--field-strength", f"{field[0]:.6f}", "--json")
    constant = magnetometer.run("fit", "constant.csv", *strength)
    balloon = magnetometer.run("fit", "balloon.csv", *strength)
    assert balloon.code == 0, balloon.err
    assert "field_strength is logged and gives each row's field" in balloon.err
    level = magnetometer.run("fit", "flight.csv", *strength)
    for axis in "xyz":
        found = balloon.result["parameters"][f"lambda_{axis}"]
        expected = level.result["parameters"][f"lambda_{axis}"]["value"]
        assert abs(found["value"] - expected) < 0.3 * found["standard_error"]
        assert abs(constant.result["parameters"][f"lambda_{axis}"]["value"] - found["value"]) > 0.02
    assert balloon.result["rmse"]["field"] < 0.7 * constant.result["rmse"]["field"]
    ignored = magnetometer.run("fit", "balloon.csv", *strength, "--ignore", "field_strength_ut")
    assert ignored.result["parameters"] == constant.result["parameters"]
