# SPDX-License-Identifier: BSD-3-Clause
"""Flights with hidden effects, other noise and other probes: by the apps and by sepcal.simulate."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import sepcal
from apps import Bench, Log, parse_json


def test_the_app_hides_what_python_hides(pitot: Bench) -> None:
    options = ("--noise", "ar", "--decoys", "2", "--rows", "50", "--seed", "4")
    hidden = ("--hide", "wind_shear=0.01:-0.02", "--hide", "water_blockage=-0.05")
    done = pitot.run("simulate", "-o", "hidden.csv", "--truth", "t.json", *options, *hidden)
    assert (done.code, done.err) == (0, "")
    truth = parse_json((pitot.folder / "t.json").read_text())
    assert truth["effects"] == ["wind[altitude_m]", "water_blockage"]
    assert truth["parameters"]["wind[altitude_m].e"] == -0.02

    flight = sepcal.simulate(
        "five-hole",
        hide={"wind_shear": (0.01, -0.02), "water_blockage": -0.05},
        noise="ar",
        decoys=2,
        rows=50,
        seed=4,
    )
    log = Log(pitot.folder / "hidden.csv")
    assert log.headers[:-1] == list(flight)
    for header in flight:
        assert_array_equal(log.column(header), flight[header])
    assert flight.truth == truth["parameters"]
    assert flight.effects == ("wind[altitude_m]", "water_blockage")
    assert flight.truth["water_blockage.t0"] == pytest.approx(120 * 49 / 50 / 3)

    again = pitot.run("simulate", "-o", "again.csv", "--truth", "t.json", *options)
    assert again.code == 0
    assert (pitot.folder / "again.csv").read_bytes() == (pitot.folder / "hidden.csv").read_bytes()


def test_a_plain_tube(pitot: Bench) -> None:
    done = pitot.run("simulate", "--probe", "pitot-static", "-o", "tube.csv", "--rows", "80")
    assert (done.code, done.err) == (0, "")
    flight = sepcal.simulate("pitot-static", rows=80)
    assert "pt_pa" not in flight
    assert_array_equal(Log(pitot.folder / "tube.csv").column("dp_pa"), flight["dp_pa"])
    assert_allclose(
        flight["dp_pa"], 0.5 * flight["rho_kgpm3"] * flight["airspeed_mps"] ** 2, rtol=1e-12
    )
    refused = pitot.run("simulate", "--probe", "vane", "-o", "vane.csv")
    assert refused.code == 2
    assert "five-hole, pitot-static" in refused.err
    assert not Path(pitot.folder / "vane.csv").exists()
    wrong = pitot.run("simulate", "--probe", "pitot-static", "-o", "x.csv", "--truth", "t.json")
    assert wrong.code == 0
    mixed = pitot.run("simulate", "-o", "y.csv", "--truth", "t.json")
    assert mixed.code == 2
    assert "--probe" in mixed.err


def test_a_truth_flies_again() -> None:
    first = sepcal.simulate(
        "magnetometer", hide={"bias[current_a]": 0.5, "warm_up": (1, 2, 3, 20)}, rows=40
    )
    assert first.truth["warm_up.tau"] == 20
    by_parameters = sepcal.simulate("magnetometer", parameters=first.truth, rows=40)
    by_truth = sepcal.simulate("magnetometer", truth={"parameters": first.truth}, rows=40)
    for again in (by_parameters, by_truth):
        assert_array_equal(again["mx_ut"], first["mx_ut"])
        assert set(again.effects) == set(first.effects)


def test_noise_by_kind_and_by_size() -> None:
    loud = {"noise": {"mx": 3.0}}
    white = sepcal.simulate("magnetometer", rows=2000)
    bursty = sepcal.simulate("magnetometer", truth=loud, noise="bursty", rows=2000)
    quiet = sepcal.simulate("magnetometer", noise={"mx": 0.0, "my": 0.0, "mz": 0.0}, rows=2000)
    # Twice four standard errors of a standard deviation, five for a kurtosis of 13.
    assert np.std(white["mx_ut"] - quiet["mx_ut"]) == pytest.approx(0.3, rel=0.07)
    assert np.std(bursty["mx_ut"] - quiet["mx_ut"]) == pytest.approx(3.0, rel=0.2)
    poor = sepcal.simulate("magnetometer", excitation="poor", rows=50)
    assert np.abs(poor["roll_rad"]).max() < np.radians(16.1)


def test_the_fields_strength_alone() -> None:
    flight = sepcal.simulate("magnetometer", truth={"options": {"field_strength": 48.0}}, rows=10)
    field = [flight[name][0] for name in ("bn_ut", "be_ut", "bd_ut")]
    assert np.linalg.norm(field) == pytest.approx(48.0, rel=1e-14)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"hide": {"gusts": 1.0}}, ("'gusts'", "wind[DRIVER]")),
        ({"hide": {"wind[time]": (1, 2, 3)}}, ("3 sizes", "wind[time].n")),
        ({"hide": {"wind[time]": np.nan}}, ("wind[time].n", "finite")),
        ({"hide": {"wind[humidity]": 1}}, ("'humidity'", "altitude_m")),
        ({"excitation": "lively"}, ("'lively'", "rich, poor, third")),
        ({"noise": "brown"}, ("'brown'", "bursty")),
        ({"decoys": -1}, ("decoys=-1",)),
        ({"truth": {"parameters": {"w_n": np.inf}}}, ("finite",)),
        ({"truth": {"effects": ["icing_ramp"]}}, ("'icing_ramp.s' is missing",)),
    ],
)
def test_refusals(arguments: dict[str, object], words: tuple[str, ...]) -> None:
    with pytest.raises(sepcal.Error) as refused:
        sepcal.simulate("five-hole", rows=20, **arguments)  # type: ignore[arg-type]
    for word in words:
        assert word in str(refused.value)
