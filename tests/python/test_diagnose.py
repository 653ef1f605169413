# SPDX-License-Identifier: BSD-3-Clause
"""diagnose from the command line: verdicts, exit codes, files, the JSON's keys."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from apps import Bench, Outcome, assert_refused, parse_json, read_folder

HIDDEN = {"sepcal-pitot": "airspeed_scale[alpha^2]=-1", "sepcal-mag": "bias[current_a]=0.06"}
KEYS = {
    *(
        "schema_version",
        "model",
        "inputs",
        "status",
        "message",
        "verdict",
        "sentence",
        "rmse",
        "advice",
    ),
    *("pairs", "noise_floor", "where", "residual", "effects", "unexplained", "unmeasured"),
    *("limits", "missing_channels", "pse", "rule"),
    *("correlation_time", "error_budget", "work", "left_undone"),
}
EFFECT_KEYS = {
    *("name", "sentence", "drivers", "estimate", "standard_error", "unit", "shapes", "p_value"),
    *("log10_p", "p_adjusted", "p_listed", "predicted_drop", "held_out_gain", "held_out_before"),
    *("outputs", "partial_f", "sse", "sse_reduction", "pse", "pse_without"),
    *("r_squared", "r_squared_without"),
    "share_after_selection",
    *("held_out_after", "held_out_passed", "held_out_interleaved", "visibility", "absorbed_by"),
    *("status", "beside"),
    *("held_out_refitted", "is_fitted", "excuse"),
}


@pytest.fixture(scope="module", params=list(HIDDEN))
def bent_bench(
    request: pytest.FixtureRequest,
    prepared: dict[str, Bench],
    tmp_path_factory: pytest.TempPathFactory,
) -> Bench:
    """Each app in turn, with bent.csv and bent.json, fitted without the effect that is in it."""
    bench = replace(prepared[request.param], folder=tmp_path_factory.mktemp("bent"))
    rows = ("--rows", "250", "--seed", "3")
    assert bench.run("simulate", "-o", "bent.csv", *rows, "--hide", HIDDEN[bench.app]).code == 0
    fitted = bench.run("fit", "bent.csv", "-o", "bent.json", "--samples", "100", *bench.options)
    assert fitted.code == 0, fitted.err
    return bench


@pytest.fixture(scope="module")
def missing(bent_bench: Bench) -> Outcome:
    """What the app says of it."""
    return bent_bench.run("diagnose", "bent.csv", "bent.json", "--json")


def shift_by_maneuver(bench: Bench) -> None:
    """Gives mx another offset in every maneuver, which no candidate does: odd.csv, odd.json."""
    log = bench.read_log()
    labels = [row[log.index("maneuver")] for row in log.rows]
    offsets = dict(zip(dict.fromkeys(labels), (1.5, -1.5, -0.6, 1.2), strict=True))
    log.replace("mx_ut", log.column("mx_ut") + [offsets[label] for label in labels])
    (bench.folder / "odd.csv").write_text(log.text())
    fitted = bench.run("fit", "odd.csv", "-o", "odd.json", *bench.options)
    assert fitted.code == 0, fitted.err


# --- verdicts and exit codes


def test_nothing_is_missing(bench: Bench):
    diagnosed = bench.run("diagnose", "flight.csv", "base.json", "--json")
    assert (diagnosed.code, diagnosed.err) == (0, "")
    assert diagnosed.result["verdict"] == "adequate"
    assert all(effect["status"] != "found" for effect in diagnosed.result["effects"])
    table = bench.run("diagnose", "flight.csv", "base.json")
    assert (table.code, table.err) == (0, "")
    assert "Nothing is missing that this flight can show" in table.out
    assert "smallest change over the flight that would have shown:" in table.out


def test_an_effect_is_missing(bent_bench: Bench, missing: Outcome):
    """The next command that the table proposes does what it says."""
    assert (missing.code, missing.err) == (3, "")
    result = missing.result
    assert result["verdict"] == "effect_missing"
    first = result["effects"][0]
    assert first["status"] == "found"
    hidden = HIDDEN[bent_bench.app].split("=")[0]
    as_good = [effect["name"] for effect in result["effects"] if effect["beside"] == "equivalent"]
    assert hidden in [first["name"], *as_good]
    table = bent_bench.run("diagnose", "bent.csv", "bent.json")
    assert table.code == 3
    assert table.out.startswith(f"{result['model']}: 250 of 250 rows of bent.csv\n")
    assert result["sentence"] in table.out
    command = ("add", "bent.csv", "bent.json", first["name"])
    proposed = f"next: {bent_bench.app} {' '.join(command[:3])} '{first['name']}' -o NEXT.json"
    assert proposed in table.out

    added = bent_bench.run(*command, "-o", "next.json", "--json")
    assert added.code == 0, added.err
    entry = added.result["history"][-1]
    drop = 1 - entry["rmse_after"] / entry["rmse_before"]
    assert drop == pytest.approx(first["predicted_drop"], rel=0.1)
    again = bent_bench.run("diagnose", "bent.csv", "next.json", "--json")
    assert again.code == 0
    assert first["name"] not in [effect["name"] for effect in again.result["effects"]]


def test_structure_that_nothing_explains(magnetometer: Bench):
    shift_by_maneuver(magnetometer)
    alone = ("--only", "cubic_nonlinearity")
    diagnosed = magnetometer.run("diagnose", "odd.csv", "odd.json", "--json", *alone)
    assert (diagnosed.code, diagnosed.err) == (6, "")
    assert diagnosed.result["verdict"] == "unexplained"
    unexplained = diagnosed.result["unexplained"]
    assert unexplained["p_adjusted"] < 0.01
    assert unexplained["significant"] is True
    assert len(unexplained["windows"]) >= 4
    table = magnetometer.run("diagnose", "odd.csv", "odd.json", *alone)
    assert table.code == 6
    assert "Something is missing that no candidate explains" in table.out
    assert "by window, in standard errors" in table.out


def test_another_flight_than_the_fitted(magnetometer: Bench):
    magnetometer.run("simulate", "-o", "bent.csv", "--rows", "300", "--hide", "bias[current_a]=0.1")
    diagnosed = magnetometer.run("diagnose", "bent.csv", "base.json", "--json")
    assert diagnosed.code == 3
    assert diagnosed.result["inputs"]["file"] == "bent.csv"


# --- the JSON


def test_keys(bent_bench: Bench, missing: Outcome):
    """To the letter of the interface, and numbers that agree with each other."""
    result = missing.result
    assert set(result) == KEYS
    assert list(result["residual"]) == list(bent_bench.model.outputs)
    for residual in result["residual"].values():
        assert list(residual) == ["unit", "rmse", "lag_one", "ljung_box_p", "noise", "floor"]
    assert {"segment", "output", "rmse"} <= set(result["where"][0])
    fitted = parse_json((bent_bench.folder / "bent.json").read_text())
    assert result["status"] == fitted["status"]
    squares = [rmse**2 for rmse in fitted["rmse"].values()]
    assert result["rmse"] == pytest.approx(math.sqrt(np.mean(squares)), rel=1e-6)
    for effect in result["effects"]:
        check_effect(effect, set(fitted["parameters"]))
    for limit in result["limits"].values():
        assert list(limit) == ["size", "unit"]


def check_effect(effect: dict[str, Any], parameters: set[str]) -> None:
    assert set(effect) == EFFECT_KEYS
    assert effect["beside"] in ("untried", "equivalent", "fades", "counts")
    assert effect["status"] in ("found", "slow_change", "not_seen", "cannot_be_seen")
    assert set(effect["estimate"]) == set(effect["standard_error"]) == set(effect["unit"])
    owners = effect["name"].split("+")
    assert all(name.rsplit(".", 1)[0] in owners for name in effect["estimate"])
    assert set(effect["absorbed_by"]) <= parameters
    assert 0 <= effect["p_value"] <= effect["p_adjusted"] * (1 + 1e-9) <= 1 + 1e-9
    if effect["held_out_gain"] is not None:
        ratio = effect["held_out_after"] / effect["held_out_before"]
        assert effect["held_out_gain"] == pytest.approx(1 - ratio)


def test_channels_that_are_not_logged(magnetometer: Bench):
    log = magnetometer.read_log()
    for header in ("current_a", "throttle"):
        log.drop(header)
    (magnetometer.folder / "bare.csv").write_text(log.text())
    result = magnetometer.run("diagnose", "bare.csv", "base.json", "--json").result
    assert result["missing_channels"] == ["current_a", "throttle"]
    assert all("[current_a]" not in effect["name"] for effect in result["effects"])


def test_the_output_is_what_json_prints(bench: Bench):
    printed = bench.run("diagnose", "flight.csv", "base.json", "--json", "-o", "d.json")
    assert (bench.folder / "d.json").read_text() == printed.out
    again = bench.run("diagnose", "flight.csv", "base.json", "-o", "e.json")
    assert again.out.endswith("wrote e.json\n")
    assert (bench.folder / "e.json").read_text() == printed.out


# --- an effect put in


@pytest.mark.parametrize(("size", "found"), [("0.1", True), ("0.0005", False)])
def test_inject(magnetometer: Bench, size: str, found: bool):
    inject = ("--inject", f"bias[current_a]={size}")
    diagnosed = magnetometer.run("diagnose", "flight.csv", "base.json", "--json", *inject)
    assert diagnosed.code == (3 if found else 0)
    injected = diagnosed.result["injected"]
    assert list(injected) == ["effect", "sizes", "found", "rank", "p_adjusted", "estimate"]
    assert injected["effect"] == "bias[current_a]"
    assert injected["sizes"] == [float(size)] * 3
    assert injected["found"] is found
    if found:
        assert injected["rank"] == 1
        assert list(injected["estimate"].values()) == pytest.approx([0.1] * 3, rel=0.3)
    table = magnetometer.run("diagnose", "flight.csv", "base.json", *inject)
    assert ("would have been found" in table.out) is found
    assert ("would have been missed" in table.out) is not found


# --- bad input: exit 2, nothing written


@pytest.mark.parametrize(
    ("inject", "words"),
    [
        ("bias_drift", ("bias_drift", "E=SIZE")),
        ("=0.1", ("E=SIZE",)),
        ("bias[time]=fast", ("bias[time]=fast", "'fast' is not a number")),
        ("bias[time]=1:", ("bias[time]=1:", "is not a number")),
        ("lift=1", ("there is no effect 'lift'",)),
        ("bias[engine_2]=1", ("bias[engine_2]", "no channel 'engine_2'")),
        ("bias[time]=1:2", ("bias[time]", "2 sizes", "bias[time].x")),
    ],
)
def test_bad_injections(magnetometer: Bench, inject: str, words: tuple[str, ...]):
    command = ("diagnose", "flight.csv", "base.json", "--inject", inject)
    assert_refused(magnetometer, *command, words=words)


def test_an_injection_that_the_calibration_has(magnetometer: Bench):
    magnetometer.run("add", "flight.csv", "base.json", "bias[time]", "-o", "next.json")
    command = ("diagnose", "flight.csv", "next.json", "--inject", "bias_drift=1")
    assert_refused(magnetometer, *command, words=("has the effect bias[time] already",))


@pytest.mark.parametrize(
    ("files", "words"),
    [
        (("absent.csv", "base.json"), ("absent.csv",)),
        (("flight.csv", "absent.json"), ("absent.json",)),
        (("flight.csv", "flight.csv"), ("flight.csv", "a calibration")),
    ],
)
def test_files_that_are_not_there(bench: Bench, files: tuple[str, str], words: tuple[str, ...]):
    assert_refused(bench, "diagnose", *files, words=words)


def test_the_other_apps_calibration(prepared: dict[str, Bench], bench: Bench):
    (other,) = (one for one in prepared.values() if one.app != bench.app)
    (bench.folder / "other.json").write_bytes((other.folder / "base.json").read_bytes())
    assert_refused(bench, "diagnose", "flight.csv", "other.json", words=(f"use {other.app}",))


@pytest.mark.parametrize("output", ["flight.csv", "base.json", "results/d.json"])
def test_an_output_that_would_do_harm(bench: Bench, output: str):
    before = read_folder(bench.folder)
    refused = bench.run("diagnose", "flight.csv", "base.json", "-o", output)
    assert (refused.code, refused.out) == (2, "")
    assert output in refused.err
    assert read_folder(bench.folder) == before
