# SPDX-License-Identifier: BSD-3-Clause
"""A boom with vanes, from its log to its correction: a flight by physics of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal
from apps import Log, run
from boom_flight import ARM, Boom, fly
from oracle.vane_boom import VaneBoom as Oracle
from oracle.vane_boom import flank_direction
from refusals import refuse
from sepcal.catalogue import PROBES
from sepcal.reporting import words

Columns = dict[str, np.ndarray]
BOOM = sepcal.VaneBoom(lever_arm=ARM)
IDEAL = Boom(gusts=0.0, noise=False)
TRUE = {
    "lambda_va": IDEAL.speed_scale,
    "lambda_alpha": IDEAL.alpha_scale,
    "b_alpha": IDEAL.alpha_zero,
    "lambda_beta": IDEAL.beta_scale,
    "b_beta": IDEAL.beta_zero,
    "w_n": 4.0,
    "w_e": -2.5,
    "w_d": 0.0,
    "b_va": 0.0,
    "eps_phi": 0.0,
}


@pytest.fixture(scope="module")
def columns() -> Columns:
    """A flight with noise and nothing hidden."""
    return fly()


def write(columns: Columns, file: Path) -> None:
    """A log on disc."""
    np.savetxt(
        file,
        np.stack(list(columns.values()), axis=-1),
        delimiter=",",
        header=",".join(columns),
        comments="",
        fmt="%.17g",
    )


def without(columns: Columns, *headers: str) -> Columns:
    return {header: values for header, values in columns.items() if header not in headers}


def test_without_noise_the_fit_is_the_truth() -> None:
    fitted = sepcal.fit(BOOM, sepcal.Flight(fly(IDEAL, rows=600)))
    assert fitted.status == "converged"
    for name, value in TRUE.items():
        assert fitted[name].value == pytest.approx(value, abs=1e-6), name


def test_with_noise_the_truth_is_within_the_errors(columns: Columns) -> None:
    fitted = sepcal.fit(BOOM, sepcal.Flight(columns))
    assert fitted.status == "converged"
    for name, value in TRUE.items():
        assert abs(fitted[name].value - value) < 5 * fitted[name].standard_error, name
    assert "wind" in fitted.restated


@pytest.mark.parametrize(
    ("hidden", "verdict", "name", "component", "size"),
    [
        (Boom(per_flap=0.0012), "effect_missing", "alpha_offset[flap_deg]", "s", 0.0012 / 0.92),
        (Boom(heading=0.05), "slow_change", "heading_bias", "delta", 0.05),
    ],
)
def test_what_is_hidden_is_named_and_added(
    hidden: Boom, verdict: str, name: str, component: str, size: float
) -> None:
    """A flap's share is of the angle as read. A heading might wander so: one flight can't tell."""
    flight = sepcal.Flight(fly(hidden))
    base = sepcal.fit(BOOM, flight)
    found = base.diagnose()
    assert (found.verdict, found.effects[0].name) == (verdict, name)
    added = base.add(name)
    assert added[f"{name}.{component}"].value == pytest.approx(size, rel=0.1)
    total = [np.linalg.norm(list(fit.rmse.values())) for fit in (base, added)]
    assert total[1] < 0.7 * total[0]


def test_nothing_hidden_is_nothing_found(columns: Columns) -> None:
    assert sepcal.fit(BOOM, sepcal.Flight(columns)).diagnose().verdict != "effect_missing"


def test_vanes_that_lag_are_undone() -> None:
    """By noise the slopes of the vanes, and so tau, would be off."""
    flight = sepcal.Flight(fly(Boom(lag=0.25, gusts=0.0, noise=False)))
    base = sepcal.fit(BOOM, flight)
    added = base.add("vane_lag")
    assert added["vane_lag.tau"].value == pytest.approx(0.25, abs=0.003)
    assert added.rmse["vd"] < 0.1 * base.rmse["vd"]
    assert added.rmse["vd"] < base.add("vane_time_offset").rmse["vd"]


def test_apply_gives_the_sideslip_of_the_flank_angle(columns: Columns) -> None:
    """airspeed, atan2(w, u) and asin(v / V) in body axes, by the oracle's own direction."""
    fitted = sepcal.fit(BOOM, sepcal.Flight(columns))
    applied = fitted.apply(sepcal.Flight(columns))
    value = {name: fitted[name].value for name in Oracle.linear + Oracle.nonlinear}
    density = columns["ps_pa"] / (287.05287 * columns["temp_k"])
    speed = (1 + value["lambda_va"]) * np.sqrt(2 * columns["dp_pa"] / density) + value["b_va"]
    level = {name: np.zeros(density.size) for name in ("roll", "pitch", "yaw", "p", "q", "r")}
    level |= {
        "airspeed": np.ones(density.size),
        "alpha": columns["alpha_rad"],
        "beta": columns["beta_rad"],
    }
    xi = np.array([0.0] * 5 + [value[name] for name in Oracle.nonlinear])
    u, v, w = Oracle().predict(level, xi)
    assert_allclose(applied["airspeed_cal_mps"], speed, rtol=1e-12)
    assert_allclose(applied["alpha_cal_rad"], np.arctan2(w, u), atol=1e-12)
    assert_allclose(applied["beta_cal_rad"], np.arcsin(v), atol=1e-12)
    flank = (1 + value["lambda_beta"]) * columns["beta_rad"] + value["b_beta"]
    straight = flank_direction(0 * flank, flank)
    assert_allclose(np.arcsin(straight[1]), flank, atol=1e-12)  # the same where alpha is zero


def test_apply_undoes_effects_of_the_reading() -> None:
    hidden = Boom(per_flap=0.0012, gusts=0.0)
    columns = fly(hidden)
    flight = sepcal.Flight(columns)
    plain = sepcal.fit(BOOM, flight)
    added = plain.add("alpha_offset[flap_deg]")
    truth = fly(Boom(gusts=0.0, noise=False, per_flap=0.0012))
    true_alpha = (1 - 0.08) * truth["alpha_rad"] + 0.02 + 0.0012 * truth["flap_deg"]
    misses = [np.std(fit.apply(flight)["alpha_cal_rad"] - true_alpha) for fit in (plain, added)]
    assert misses[1] < 0.4 * misses[0]


def test_units_and_the_order_of_ways_to_the_airspeed(columns: Columns) -> None:
    """Degrees are angles; dp goes before a logged airspeed, which serves where density lacks."""
    expected = sepcal.fit(BOOM, sepcal.Flight(columns)).to_dict()["parameters"]
    density = columns["ps_pa"] / (287.05287 * columns["temp_k"])
    speed = np.sqrt(2 * columns["dp_pa"] / density)
    in_degrees = without(columns, "alpha_rad", "beta_rad") | {
        "alpha_deg": np.rad2deg(columns["alpha_rad"]),
        "beta_deg": np.rad2deg(columns["beta_rad"]),
    }
    with_density = without(columns, "ps_pa", "temp_k") | {"rho_kgpm3": density}
    by_airspeed = without(columns, "dp_pa", "ps_pa", "temp_k") | {"airspeed_mps": speed}
    no_density = without(columns, "temp_k") | {"airspeed_mps": speed}
    indicated = columns | {"airspeed_mps": 0.9 * speed}
    for other in (in_degrees, with_density, by_airspeed, no_density, indicated):
        fitted = sepcal.fit(BOOM, sepcal.Flight(other))
        for name, entry in expected.items():
            close = 1e-5 * entry["standard_error"]
            assert abs(fitted[name].value - entry["value"]) < close, (name, list(other))
    notes = "\n".join(sepcal.fit(BOOM, sepcal.Flight(indicated)).notes)
    assert "'airspeed_mps' is not used: the airspeed is that of dp_pa and the density" in notes


def test_what_is_missing_is_named(columns: Columns) -> None:
    def fit(*headers: str, model: sepcal.Model = BOOM) -> None:
        sepcal.fit(model, sepcal.Flight(without(columns, *headers)))

    refuse(lambda: fit("beta_rad"), "'beta_rad' is missing")
    refuse(lambda: fit("yaw_rad"), "'yaw_rad' is missing")
    refuse(lambda: fit("q_radps"), "'q_radps' is missing")
    refuse(lambda: fit("temp_k"), "the density is missing", "rho_kgpm3", "airspeed_mps")
    refuse(lambda: fit("dp_pa"), "the airspeed is missing", "dp_pa", "airspeed_mps")
    fit("p_radps", "q_radps", "r_radps", model=sepcal.VaneBoom())  # no lever arm, no rates
    refuse(lambda: sepcal.VaneBoom(lever_arm=(1.0, 2.0)), "lever_arm", "2 numbers")
    refuse(lambda: sepcal.VaneBoom(lever_arm=(1.0, 2.0, np.nan)), "lever_arm", "not finite")


def test_vanes_beyond_a_quarter_turn_are_left_out(columns: Columns) -> None:
    spoilt = dict(columns)
    spoilt["alpha_rad"] = columns["alpha_rad"].copy()
    spoilt["alpha_rad"][100:130] = 2.0
    fitted = sepcal.fit(BOOM, sepcal.Flight(spoilt))
    assert fitted.rows == columns["time_s"].size - 30
    assert any("beyond +-90 deg" in note for note in fitted.notes)
    applied = fitted.apply(sepcal.Flight(spoilt))["airspeed_cal_mps"]
    assert np.flatnonzero(np.isnan(applied)).tolist() == list(range(100, 130))
    as_degrees = columns | {"alpha_rad": np.rad2deg(columns["alpha_rad"])}
    refuse(lambda: sepcal.fit(BOOM, sepcal.Flight(as_degrees)), "beyond +-90 deg", "units")


def test_the_command_line_knows_a_boom_by_its_columns(columns: Columns, tmp_path: Path) -> None:
    write(columns, tmp_path / "boom.csv")
    arm = ("--lever-arm", ",".join(map(str, ARM)))

    def say(*arguments: str) -> str:
        done = run("sepcal-pitot", *arguments, folder=tmp_path)
        assert done.code == 2
        assert done.out == ""
        assert done.err.count("\n") == 1
        return done.err

    fitted = run("sepcal-pitot", "fit", "boom.csv", "-o", "boom.json", *arm, folder=tmp_path)
    assert fitted.code == 0, fitted.err
    calibration = sepcal.load(tmp_path / "boom.json")
    assert calibration.to_dict()["model"] == "vane-boom"
    named = run(
        "sepcal-pitot", "fit", "boom.csv", "--json", "--probe", "vane-boom", *arm, folder=tmp_path
    ).result
    for name, entry in named["parameters"].items():
        assert entry["value"] == calibration[name].value
    applied = run("sepcal-pitot", "apply", "boom.csv", "boom.json", "-o", "c.csv", folder=tmp_path)
    assert applied.code == 0, applied.err
    assert Log(tmp_path / "c.csv").headers[-3:] == [
        "airspeed_cal_mps", "alpha_cal_rad", "beta_cal_rad",
    ]  # fmt: skip
    assert "boom with vanes" in say("fit", "boom.csv", "--k-alpha", "4.5")
    refused = say("export", "boom.json", "--to", "c", "-o", "boom.h")
    for exported in ("vane-boom has no correction to export", "five-hole", "magnetometer-norm"):
        assert exported in refused
    unable = say("simulate", "--probe", "vane-boom", "-o", "x.csv")
    assert "can't be simulated; these can: five-hole, pitot-static" in unable
    assert "known: five-hole, vane-boom, pitot-static" in say("fit", "boom.csv", "--probe", "vane")
    refuse(lambda: sepcal.simulate("vane-boom"), "'vane-boom' to simulate", "five-hole")


def test_the_catalogue_and_the_report_ask_for_its_names() -> None:
    names = {effect.name for effect in sepcal.effects("vane-boom")}
    assert {"vane_lag", "vane_time_offset", "heading_bias", "alpha_offset[DRIVER]"} <= names
    refuse(lambda: sepcal.effects("vane"), "known: five-hole, vane-boom, pitot-static")
    assert words.MODELS["vane-boom"] == "boom with vanes"
    assert tuple(words.MODELS) == PROBES
