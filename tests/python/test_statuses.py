# SPDX-License-Identifier: BSD-3-Clause
"""Fits that end otherwise than well: exit 4 and 5, with the result written, printed and usable."""

import re

import numpy as np
import pytest

from apps import Bench, Outcome
from oracle.five_hole_probe import FiveHoleProbe
from oracle.model import Array

AIRSPEED, DENSITY, K = 20.0, 1.2, 4.5


def write_cruise(bench: Bench, alpha: Array, beta: Array) -> None:
    """Straight and level at one speed, due north, in still air: wind and airspeed are one."""
    rng = np.random.default_rng(1)
    rows = alpha.size
    dynamic = 0.5 * DENSITY * AIRSPEED**2
    zero = np.zeros(rows)
    columns = dict.fromkeys(("roll_rad", "yaw_rad", "p_radps", "q_radps", "r_radps"), zero)
    columns |= {
        "time_s": 0.1 * np.arange(rows),
        "pitch_rad": alpha,  # level flight: what the nose is up, the air comes from below
        "vn_mps": AIRSPEED * np.cos(beta) + 0.1 * rng.standard_normal(rows),
        "ve_mps": AIRSPEED * np.sin(beta) + 0.1 * rng.standard_normal(rows),
        "vd_mps": 0.1 * rng.standard_normal(rows),
        "pt_pa": 90_000 + np.full(rows, dynamic),
        "ps_pa": np.full(rows, 90_000.0),
        "dpa_pa": K * dynamic * alpha,
        "dpb_pa": K * dynamic * beta,
        "rho_kgpm3": np.full(rows, DENSITY),
    }
    cells = zip(*(map(repr, map(float, values)) for values in columns.values()), strict=True)
    lines = [",".join(columns), *(",".join(row) for row in cells)]
    (bench.folder / "cruise.csv").write_text("\n".join(lines) + "\n")


def assert_written_and_printed(bench: Bench, fitted: Outcome, code: int, status: str) -> None:
    """The status in exit code, JSON, table and later verbs; standard error has notes alone."""
    assert fitted.code == code
    assert all(line.startswith("note: ") for line in fitted.err.splitlines())
    assert fitted.result["status"] == status
    assert fitted.result["message"] != ""
    assert "\n" not in fitted.result["message"]
    assert fitted.out == (bench.folder / "next.json").read_text()
    flight = fitted.result["inputs"]["file"]
    for verb in (("compare", flight, "next.json"), ("apply", flight, "next.json", "-o", "out.csv")):
        later = bench.run(*verb)
        assert (later.code, later.err) == (0, "")
        (line,) = [line for line in later.out.splitlines() if line.startswith("status: ")]
        assert line.startswith(f"status: {status}")
        explained = bench.run(*verb, "--explain").out.splitlines()
        for sentence in fitted.result["message"].split("; "):
            assert f"  {sentence}" in explained
        assert bench.run(*verb, "--json").result["status"] == status


def test_straight_and_level_at_one_speed(pitot: Bench):
    """One heading and one speed: lambda_va, b_va and the wind along the track are one number."""
    write_cruise(pitot, alpha=np.full(600, 0.05), beta=np.zeros(600))
    fitted = pitot.fit("-o", "next.json", flight="cruise.csv")
    assert_written_and_printed(pitot, fitted, 4, "not_identifiable")
    named = {name for entry in fitted.result["unobservable"] for name in entry["parameters"]}
    assert {"lambda_va", "b_va", "w_n", "lambda_beta"} <= named
    for entry in fitted.result["unobservable"]:
        assert list(entry) == ["combination", "parameters", "standard_error"]
        if entry["combination"] in fitted.result["message"]:  # the first few are
            assert all(name in fitted.result["message"] for name in entry["parameters"])
    alike = re.search(r"(\w+), (\w+) and (\w+) can't be told apart", fitted.result["message"])
    assert alike is not None
    assert set(alike.groups()) == {"lambda_va", "b_va", "w_n"}  # in an order that rounding decides
    assert fitted.result["parameters"]["lambda_va"]["standard_error"] is None


def test_what_is_not_determined_does_not_run_away(pitot: Bench):
    """Estimates stay within what a probe can be, and the model still meets the record."""
    write_cruise(pitot, alpha=np.full(600, 0.05), beta=np.zeros(600))
    fitted = pitot.fit(flight="cruise.csv")
    values = {name: entry["value"] for name, entry in fitted.result["parameters"].items()}
    assert abs(values["lambda_va"]) < 2
    assert all(abs(values[name]) < 100 for name in ("b_va", "w_n", "w_e", "w_d"))
    assert all(value < 0.2 for value in fitted.result["rmse"].values())


def test_wiggles_in_alpha_and_beta_at_one_speed(pitot: Bench):
    """Angles vary, so their scales are seen; scale, bias and wind along the track still are not."""
    time = 0.1 * np.arange(900)
    write_cruise(pitot, 0.05 + 0.08 * np.sin(2 * time), 0.08 * np.sin(1.3 * time))
    fitted = pitot.fit("-o", "next.json", flight="cruise.csv")
    assert_written_and_printed(pitot, fitted, 4, "not_identifiable")
    named = {name for entry in fitted.result["unobservable"] for name in entry["parameters"]}
    assert {"lambda_va", "b_va"} <= named
    assert "lambda_beta" not in named
    all_held = ("--fix", "lambda_va=0", "--fix", "w_n=0", "--fix", "b_alpha=0")
    held = pitot.fit(*all_held, flight="cruise.csv")
    assert held.code == 0
    bias = held.result["parameters"]["b_va"]
    assert abs(bias["value"]) < 5 * bias["standard_error"]


def test_an_open_direction_that_ends_at_a_bound(pitot: Bench):
    """Level with the nose where the air comes from: b_alpha and w_d turn the same airspeed.

    (V + b_va) (cos b_alpha, sin b_alpha) + (0, w_d) is all that is seen, a curve through three
    parameters; to stop on it at a bound of b_alpha determines neither w_d nor b_va.
    """
    time = 0.1 * np.arange(900)
    write_cruise(pitot, 0.05 + 0.08 * np.sin(2 * time), 0.08 * np.sin(1.3 * time))
    fitted = pitot.fit("--fix", "lambda_va=0", "--fix", "w_n=0", flight="cruise.csv")
    assert fitted.code == 4
    assert {"w_d", "b_alpha"} <= {
        name for entry in fitted.result["unobservable"] for name in entry["parameters"]
    }


def test_a_magnetometer_that_never_moved(magnetometer: Bench):
    log = magnetometer.read_log()
    for header in ("roll_rad", "pitch_rad", "yaw_rad"):
        log.replace(header, np.zeros(len(log.rows)))
    rng = np.random.default_rng(2)
    for header, mean in (("mx_ut", 20), ("my_ut", 1), ("mz_ut", 50)):
        log.replace(header, mean + 0.3 * rng.standard_normal(len(log.rows)))
    (magnetometer.folder / "shelf.csv").write_text(log.text())
    fitted = magnetometer.fit("-o", "next.json", flight="shelf.csv")
    assert_written_and_printed(magnetometer, fitted, 4, "not_identifiable")


@pytest.mark.parametrize("second_stage", ["joint", "projected", "auto"])
def test_second_stages_agree_on_the_verdict(pitot: Bench, second_stage: str):
    write_cruise(pitot, alpha=np.full(600, 0.05), beta=np.zeros(600))
    fitted = pitot.fit("--second-stage", second_stage, flight="cruise.csv")
    assert fitted.code == 4
    notes = fitted.err
    assert "tracks over the ground cover 2 of 360 degrees" in notes
    assert "dpa_pa reads 54 pa in every row" in notes


def test_bounds_that_lead_astray(pitot: Bench):
    """Angles bounded by thousands of turns and a single sample: no descent finds its way."""
    astray = ("--samples", "1", "--second-stage", "joint", "--bounds", "b_alpha=-1e9,1e9")
    for seed in range(8):
        fitted = pitot.fit(*astray, "--seed", str(seed), "-o", "next.json")
        assert fitted.code in (0, 4, 5)
        if fitted.code == 5:
            assert_written_and_printed(pitot, fitted, 5, "not_converged")
            return
    pytest.fail("every one of eight fits converged")


def test_exact_measurements(pitot: Bench):
    """Without any noise the truth comes back, and R stops at its floor instead of at nothing."""
    (pitot.folder / "truth.json").write_text('{"noise": {"vn": 0, "ve": 0, "vd": 0}}')
    pitot.run("simulate", "-o", "exact.csv", "--rows", "400", "--truth", "truth.json")
    fitted = pitot.fit(flight="exact.csv")
    assert (fitted.code, fitted.err) == (0, "")
    truth = pitot.run("simulate", "-o", "x", "--truth", "truth.json", "--json").result["parameters"]
    for name in FiveHoleProbe.linear + FiveHoleProbe.nonlinear:
        assert fitted.result["parameters"][name]["value"] == pytest.approx(truth[name], abs=1e-9)


def test_ceres_stays_silent(pitot: Bench):
    """Noise that overflows every cost: whatever the status, no logging library speaks."""
    noise = [part for name in ("vn", "ve", "vd") for part in ("--noise", f"{name}=1e-300")]
    fitted = pitot.fit(*noise)
    assert fitted.err.count("\n") == (1 if fitted.code == 2 else 0), fitted.err
    assert "trust_region" not in fitted.err


@pytest.mark.long
def test_a_long_log(pitot: Bench):
    """110 MB of text are read, fitted and checked against the truth."""
    rows = 300_000
    simulated = pitot.run("simulate", "-o", "long.csv", "--rows", str(rows))
    assert simulated.code == 0, simulated.err
    fitted = pitot.fit("--samples", "20", flight="long.csv")
    (pitot.folder / "long.csv").unlink()
    assert (fitted.code, fitted.err) == (0, "")
    assert fitted.result["inputs"]["rows_used"] == rows
    truth = pitot.run("simulate", "-o", "x", "--rows", "5", "--truth", "t.json", "--json").result
    for name, entry in fitted.result["parameters"].items():
        assert entry["value"] == pytest.approx(
            truth["parameters"][name], abs=5 * entry["standard_error"]
        )
        assert entry["standard_error"] < 0.01
