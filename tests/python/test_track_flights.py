# SPDX-License-Identifier: BSD-3-Clause
"""A sensor's flight followed row by row: from first rows, and from another flight's calibration."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import sepcal
from apps import run

Columns = Mapping[str, np.ndarray]


def tube(seed: int, wind: tuple[float, float] = (-3.8, 2.4), iced: float = 1.0) -> Columns:
    """A tube that reads 0.95 of its airspeed, circling for two minutes; iced from 60 s on."""
    draw = np.random.default_rng(seed)
    time = np.arange(2400) / 20.0
    yaw = 0.1 * time
    speed = 20.0 + 3.0 * np.sin(0.17 * time)
    air = np.column_stack([speed * np.cos(yaw), speed * np.sin(yaw)])
    scale = np.where(time < 60.0, 0.95, 0.95 * iced)
    reading = scale * speed + 0.3 * draw.standard_normal(time.size)
    return {
        "time_s": time,
        "airspeed_mps": reading,
        "vn_mps": air[:, 0] + wind[0],
        "ve_mps": air[:, 1] + wind[1],
        "vd_mps": np.zeros(time.size),
        "yaw_rad": np.arctan2(np.sin(yaw), np.cos(yaw)),
        "pitch_rad": np.zeros(time.size),
        "roll_rad": np.zeros(time.size),
    }


@pytest.mark.parametrize("method", ["rls", "ekf", "iekf", "srif"])
def test_first_rows_and_the_others_are_the_batch(method: str) -> None:
    """All rows together and one after another: to a tenth of a standard error."""
    flight = sepcal.Flight(tube(1))
    base = sepcal.fit(sepcal.PitotStatic(), flight)
    track = base.track(start_rows=1000, method=method, noise={"airspeed": 0.3})
    assert (track.rows[0], track.rows[-1]) == (1000, 2399)
    for name in ("s_va", "c_va", "w_n", "w_e"):
        error = base[name].standard_error_white
        assert abs(track[name][-1] - base[name].value) < 0.1 * error
        assert_allclose(track.standard_deviation(name)[-1], error, rtol=0.05)


@pytest.mark.parametrize("method", ["ekf", "iekf", "srif"])
def test_another_flight_has_a_wind_of_its_own(method: str) -> None:
    base = sepcal.fit(sepcal.PitotStatic(), sepcal.Flight(tube(1)))
    windy = sepcal.Flight(tube(2, wind=(6.0, -5.0)))
    noise = {"airspeed": 0.3}
    track = base.track(windy, start_rows=300, own=["w_n", "w_e"], method=method, noise=noise)
    alone = base.track(windy, start_rows=1000, method=method, noise=noise)
    for name, true in {"s_va": 0.95, "c_va": 0.0, "w_n": 6.0, "w_e": -5.0}.items():
        for row in (0, 500, -1):
            assert abs(track[name][row] - true) < 4 * track.standard_deviation(name)[row]
    for name in ("s_va", "c_va"):
        assert track.standard_deviation(name)[-1] < alone.standard_deviation(name)[-1]
    assert track.standard_deviation("s_va")[-1] < base["s_va"].standard_error
    assert not any("--own" in note for note in track.notes)
    shared = base.track(windy)
    assert any("--start-rows N --own wind" in note for note in shared.notes)
    assert abs(shared["w_n"][0] - 6.0) > 10 * shared.standard_deviation("w_n")[0]  # what it says


@pytest.mark.parametrize("seed", range(3))
def test_a_tube_that_ices_is_named(seed: int) -> None:
    base = sepcal.fit(sepcal.PitotStatic(), sepcal.Flight(tube(seed + 100)))
    data = tube(seed, iced=0.9)
    track = base.track(sepcal.Flight(data), changes="follow", noise={"airspeed": 0.3})
    (change,) = track.changes
    assert 58.5 <= change.onset_time <= 61.5 < change.found_time < 65.0
    assert data["time_s"][change.found] == change.found_time
    assert {moved.name for moved in change.parameters} <= {"s_va", "c_va"}
    for speed in (17.0, 20.0, 23.0):
        assert abs(track["s_va"][-1] * speed + track["c_va"][-1] - 0.855 * speed) < 0.15
    assert base.track(sepcal.Flight(tube(seed)), changes="find").changes == ()


def test_the_plot_shades_what_follows_a_jump() -> None:
    base = sepcal.fit(sepcal.PitotStatic(), sepcal.Flight(tube(100)))
    track = base.track(sepcal.Flight(tube(0, iced=0.9)), changes="follow", noise={"airspeed": 0.3})
    for what in ("estimates", "innovations"):
        drawn = track.plot(what)
        assert any("shaded since s_va" in str(trace.name) for trace in drawn.data)
        stripes = [shape for shape in drawn.layout.shapes if shape.x1 == track.time[-1]]
        assert any(shape.x0 == track.changes[0].onset_time for shape in stripes)


def test_the_program_writes_the_same(tmp_path: Path) -> None:
    for name, data in (("one", tube(1)), ("other", tube(2, iced=0.9))):
        table = np.column_stack(list(data.values()))
        np.savetxt(
            tmp_path / f"{name}.csv", table, "%.17g", ",", header=",".join(data), comments=""
        )
    one, base = str(tmp_path / "one.csv"), str(tmp_path / "base.json")
    other, out = str(tmp_path / "other.csv"), str(tmp_path / "track.csv")
    pitot = partial(run, "sepcal-pitot", folder=tmp_path)
    assert pitot("fit", one, "--probe", "pitot-static", "-o", base).code == 0
    done = pitot("track", other, base, "--own", "wind", "--start-rows", "300",
               "--changes", "follow",
               "--noise", "airspeed=0.3", "--walk", "w_n=0.01", "-o", out, "--json")  # fmt: skip
    assert done.code == 0, done.err
    fitted = sepcal.load(base)
    track = fitted.track(sepcal.read(other), own=["w_n", "w_e"], start_rows=300, changes="follow",
                         noise={"airspeed": 0.3}, walk={"w_n": 0.01})  # fmt: skip
    written = np.genfromtxt(out, delimiter=",", names=True)
    assert_array_equal(written["time_s"], track.time)
    assert_array_equal(written["s_va"], track["s_va"])
    assert_array_equal(written["w_n_sd_mps"], track.standard_deviation("w_n"))
    assert_array_equal(written["airspeed_innovation_mps"], track.innovations[:, 0])
    said = done.result["changes"]
    assert [one["found_s"] for one in said] == [change.found_time for change in track.changes]
    assert list(said[0]["parameters"]) == [moved.name for moved in track.changes[0].parameters]
    page = pitot("track", other, base, "--changes", "find", "-o", out).out
    assert "s on the parameters are others (said at" in page


def test_what_is_refused() -> None:
    flight = sepcal.Flight(tube(1))
    base = sepcal.fit(sepcal.PitotStatic(), flight)
    for said, options in (
        ("must not count twice; start from its first ones alone, by start_rows", {}),
        ("must not count twice", {"start_rows": 500, "own": ["w_n"]}),
        ("the first 4 rows", {"start_rows": 4}),
        ("'w_n' can't walk|the walk of 'w_n'", {"start_rows": 500, "walk": {"w_n": -1.0}}),
        ("rml is for models with a state", {"start_rows": 500, "method": "rml"}),
    ):
        with pytest.raises(sepcal.Error, match=said):
            base.track(**options)
    with pytest.raises(sepcal.Error, match="'w_x' is not estimated; there are s_va, c_va"):
        base.track(sepcal.Flight(tube(2)), start_rows=300, own=["w_x"])
    with pytest.raises(sepcal.Error, match="own is found in the first rows: give their number too"):
        base.track(sepcal.Flight(tube(2)), own=["w_n"])


def test_a_magnetometer_is_followed() -> None:
    flight = sepcal.Flight(sepcal.simulate("magnetometer", rows=1500, seed=2))
    base = sepcal.fit(sepcal.Magnetometer(field_strength=50.0), flight)
    track = base.track(start_rows=500)
    for name in track.names:
        assert abs(track[name][-1] - base[name].value) < 0.5 * base[name].standard_error


def test_a_drift_is_named_with_the_walk_that_follows_it() -> None:
    base = sepcal.fit(sepcal.Magnetometer(), sepcal.simulate("magnetometer", rows=3000, seed=1))
    steady = sepcal.simulate("magnetometer", rows=6000, seed=2)
    columns = {name: np.asarray(steady[name]) for name in steady}
    columns["mx_ut"] = columns["mx_ut"] + 3.0 * np.arange(6000) / 6000.0
    flight = sepcal.Flight(columns)
    track = base.track(flight, changes="follow")
    said = [note for note in track.notes if "it drifts" in note]
    assert len(said) == 1
    assert said[0].startswith("n_x jumped")
    assert "always up" in said[0]
    size = float(said[0].rpartition("=")[2])
    walks = base.track(flight, walk={"n_x": size})
    truth = (steady.truth["n_x"] + 3.0 * np.arange(6000) / 6000.0)[track.rows]
    for row in (3000, 4000, 5999):
        assert abs(walks["n_x"][row] - truth[row]) < 4 * walks.standard_deviation("n_x")[row]
    assert not [note for note in base.track(steady, changes="follow").notes if "drifts" in note]
