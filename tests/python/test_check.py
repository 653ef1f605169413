# SPDX-License-Identifier: BSD-3-Clause
"""The verb check: what it says of a log, clean, spoilt or refused by a fit; what fit repeats."""

from pathlib import Path

import numpy as np
import pytest

import sepcal
from apps import Bench, Log, assert_refused, run
from recorded import find_fixture


@pytest.fixture
def tube(pitot: Bench) -> Bench:
    """A folder with tube.csv, 600 simulated rows and nothing hidden."""
    done = pitot.run("simulate", "--probe", "pitot-static", "-o", "tube.csv", "--rows", "600")
    assert done.code == 0, done.err
    return pitot


def spoil(bench: Bench, name: str, to: str, factor: float, file: str = "tube.csv") -> None:
    """Multiplies a column and names it anew."""
    log = Log(bench.folder / file)
    log.replace(name, factor * log.column(name), to)
    (bench.folder / file).write_text(log.text())


def kinds(result: dict) -> list[str]:
    """Of the notes, worst first."""
    return [note["kind"] for note in result["notes"]]


# --- what of a log


def test_python_chooses_as_the_app_does(tube: Bench) -> None:
    """Columns, rows and times."""
    log = Log(tube.folder / "tube.csv")
    log.replace("vn_mps", log.column("vn_mps"), "north")
    (tube.folder / "tube.csv").write_text(log.text())
    typed = tube.run(
        "check", "tube.csv", "--map", "vn_mps=north", "--where", "time_s < 40",
        "--from", "3.5", "--json",
    )  # fmt: skip
    assert typed.code == 0, typed.err
    check = sepcal.check(
        sepcal.PitotStatic(), tube.folder / "tube.csv", map={"vn_mps": "north"},
        where="time_s < 40", from_time=3.5,
    )  # fmt: skip
    told = check.to_dict()
    assert told["inputs"]["rows_used"] == typed.result["inputs"]["rows_used"]
    assert 0 < told["inputs"]["rows_used"] < told["inputs"]["rows"]
    assert told["columns"] == typed.result["columns"]
    whole = sepcal.check(sepcal.PitotStatic(), tube.folder / "tube.csv")
    assert "is missing" in whole.refused
    with pytest.raises(sepcal.Error, match="names a column that is not there"):
        sepcal.check(sepcal.PitotStatic(), sepcal.datasets.load("pitot"), map={"vn_kt": "VN"})


# --- clean logs


@pytest.mark.parametrize("noise", ["white", "ar", "pink", "bursty"])
@pytest.mark.parametrize("rows", ["400", "1500"])
def test_a_simulated_flight_has_no_note(bench: Bench, noise: str, rows: str) -> None:
    """Nor has its fit a line on standard error."""
    assert bench.run("simulate", "-o", "f.csv", "--rows", rows, "--noise", noise).code == 0
    checked = bench.run("check", "f.csv", *bench.options)
    assert (checked.code, checked.err) == (0, "")
    assert checked.out.endswith("\nnothing to note\n")
    assert bench.run("fit", "f.csv", *bench.options).err == ""


def test_every_column_is_described(bench: Bench) -> None:
    result = bench.run("check", "flight.csv", "--json", *bench.options).result
    log = bench.read_log()
    headers = [header for header in log.headers if header != "maneuver"]
    assert [column["column"] for column in result["columns"]] == headers
    assert result["inputs"]["rows"] == result["inputs"]["rows_used"] == len(log.rows)
    for column in result["columns"]:
        values = log.column(column["column"])
        assert column["least"] == values.min()
        assert column["largest"] == values.max()
        assert column["median"] == pytest.approx(np.median(values), rel=1e-12, abs=1e-15)
        assert column["missing"] == 0
    time = log.column("time_s")
    assert result["duration"] == pytest.approx(time[-1] - time[0])
    assert result["refused"] is None
    read = {column["quantity"]: column["column"] for column in result["columns"]}
    assert read["time"] == "time_s"


# --- spoilt ones


def test_metres_per_second_under_a_header_of_knots(tube: Bench) -> None:
    """The flight that was fitted with a scale of half and no word about it."""
    spoil(tube, "airspeed_mps", "airspeed_kt", 1.0)
    result = tube.run("check", "tube.csv", "--json").result
    note = result["notes"][0]
    assert (note["kind"], note["concern"]) == ("units", "wrong")
    assert "airspeed_kt" in note["columns"]
    assert "as mps under the header airspeed_kt" in note["found"]
    assert "--map airspeed_mps=airspeed_kt" in note["advice"]
    fitted = tube.run("fit", "tube.csv")
    assert "as mps under the header airspeed_kt" in fitted.err
    assert fitted.err.startswith("note: tube.csv: ")


def test_a_sensor_that_is_held(tube: Bench) -> None:
    log = Log(tube.folder / "tube.csv")
    rows = np.arange(len(log.rows))
    log.replace("airspeed_mps", log.column("airspeed_mps")[rows - rows % 5])
    (tube.folder / "tube.csv").write_text(log.text())
    result = tube.run("check", "tube.csv", "--json").result
    note = next(note for note in result["notes"] if note["kind"] == "held")
    assert note["columns"] == ["airspeed_mps"]
    assert "one row in 5" in note["found"]
    assert note["rows"] == pytest.approx(480, abs=10)
    column = next(c for c in result["columns"] if c["column"] == "airspeed_mps")
    assert column["repeated"] == pytest.approx(0.8, abs=0.02)
    assert column["rate"] == pytest.approx(result["rate"] / 5, rel=0.05)


def test_a_fit_shows_six_notes_and_the_way_to_the_rest(magnetometer: Bench) -> None:
    """Every column is held, each for another number of rows."""
    log = magnetometer.read_log()
    rows = np.arange(len(log.rows))
    columns = ["mx_ut", "my_ut", "mz_ut", "roll_rad", "pitch_rad", "yaw_rad", "bn_ut"]
    for held, header in enumerate(columns, start=2):
        if header == "bn_ut":  # the true field of the simulation is constant
            log.replace(header, log.column(header) + np.sin(rows))
        log.replace(header, log.column(header)[rows - rows % held])
    (magnetometer.folder / "spoilt.csv").write_text(log.text())
    lines = magnetometer.run("fit", "spoilt.csv").err.splitlines()
    checked = magnetometer.run("check", "spoilt.csv", "--json").result
    told = [n for n in checked["notes"] if n["concern"] != "slight" and n["kind"] != "implausible"]
    assert len(told) > 6
    for line, note in zip(lines, told[:6], strict=False):
        assert line == f"note: spoilt.csv: {note['found']}; {note['effect']}; {note['advice']}"
    assert lines[6:] == [f"note: {len(told) - 6} more: sepcal-mag check spoilt.csv"]


# --- what a fit would refuse


def test_a_fit_that_follows_a_note_does_not_repeat_it(tube: Bench) -> None:
    log = Log(tube.folder / "tube.csv")
    airspeed = log.column("airspeed_mps")
    airspeed[50::60] += 8.0
    log.replace("airspeed_mps", airspeed, "airspeed_mps")
    (tube.folder / "tube.csv").write_text(log.text())
    plain = tube.run("fit", "tube.csv", "--probe", "pitot-static")
    robust = tube.run("fit", "tube.csv", "--probe", "pitot-static", "--loss", "huber")
    assert "airspeed_mps jumps for 10 single readings" in plain.err
    assert (robust.code, robust.err) == (0, "")


def test_a_log_that_a_fit_refuses_is_described(tube: Bench) -> None:
    log = Log(tube.folder / "tube.csv")
    log.drop("ve_mps")
    log.drop("vd_mps")
    log.put(17, "airspeed_mps", "n/a")
    (tube.folder / "tube.csv").write_text(log.text())
    done = tube.run("check", "tube.csv", "--json")
    assert done.code == 0
    assert "column 've_mps' is missing" in done.result["refused"]
    assert "missing too: vd_mps" in done.result["refused"]
    assert done.result["inputs"]["rows_used"] == 0
    column = next(c for c in done.result["columns"] if c["column"] == "airspeed_mps")
    assert column["missing"] == 1
    page = tube.run("check", "tube.csv").out
    assert f"a fit would refuse it: {done.result['refused']}" in page


def test_a_clock_that_starts_again(tube: Bench) -> None:
    log = Log(tube.folder / "tube.csv")
    time = log.column("time_s")
    time[300:] -= time[300]
    log.replace("time_s", time)
    (tube.folder / "tube.csv").write_text(log.text())
    result = tube.run("check", "tube.csv", "--json").result
    assert "refused" not in result or not result["refused"]
    joined = next(note for note in result["notes"] if note["kind"] == "read")
    assert "time_s runs back once, first at tube.csv line 302" in joined["found"]


@pytest.mark.parametrize("cells", ["", "1,2\n", "x,y\n", "nan,\n", "0,1\n0,1\n0,1\n"])
def test_tables_of_nothing_much(pitot: Bench, cells: str) -> None:
    """One line or a page, never a crash."""
    (pitot.folder / "odd.csv").write_text("time_s,airspeed_mps\n" + cells)
    done = pitot.run("check", "odd.csv")
    assert done.code == (0 if cells else 2)
    assert done.out if cells else done.err.count("\n") == 1


def test_bad_input_is_one_line(bench: Bench) -> None:
    options = bench.options
    assert_refused(bench, "check", "nothing.csv", *options, words=("nothing.csv",))
    assert_refused(bench, "check", "base.json", *options, words=("base.json",))
    assert_refused(bench, "check", words=("FLIGHT",))
    assert_refused(bench, "check", "flight.csv", "--samples", "3", *options, words=("--samples",))


def test_it_does_not_write_over_the_log(bench: Bench) -> None:
    before = bench.flight.read_bytes()
    done = bench.run("check", "flight.csv", "-o", "flight.csv", *bench.options)
    assert done.code == 2
    assert bench.flight.read_bytes() == before


# --- files, JSON, Python


def test_the_file_the_page_and_python_say_the_same(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(bench.folder)
    is_pitot = bench.app == "sepcal-pitot"
    probe = (
        sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0, -0.02))
        if is_pitot
        else sepcal.Magnetometer()
    )
    checked = sepcal.check(probe, sepcal.read_csv("flight.csv"))
    printed = bench.run("check", "flight.csv", "-o", "c.json", *bench.options)
    assert printed.out == f"{checked}\nwrote c.json\n"
    assert (bench.folder / "c.json").read_text() == checked.to_json()
    assert bench.run("check", "flight.csv", "--json", *bench.options).out == checked.to_json()
    assert checked.to_dict()["model"] == checked.model == probe.name
    assert "0 notes" in repr(checked)


def test_python_has_the_notes_and_columns(tube: Bench) -> None:
    spoil(tube, "airspeed_mps", "airspeed_kt", 1.0)
    flight = sepcal.read_csv(tube.folder / "tube.csv")
    checked = sepcal.check(sepcal.PitotStatic(), flight)
    note = checked.notes[0]
    assert (note.kind, note.concern, note.rows) == ("units", "wrong", 600)
    assert np.isnan(note.first_s)
    assert [column.header for column in checked.columns] == list(flight.columns)
    assert "units" in checked._repr_html_() or "wrong" in checked._repr_html_()
    fitted = sepcal.fit(sepcal.PitotStatic(), flight)
    assert any("as mps under the header airspeed_kt" in line for line in fitted.notes)


def test_python_refuses_what_is_no_flight() -> None:
    path = sepcal.check(sepcal.FlightPath(), sepcal.Flight({"time_s": [0.0, 1.0]}))
    assert "ax" in path.refused
    with pytest.raises(sepcal.Error, match="the model comes first"):
        sepcal.check(sepcal.Flight({"time_s": [0.0]}), sepcal.PitotStatic())  # type: ignore[arg-type]


# --- recorded logs: what is known of each, and nothing wrong

RECORDED = {
    "uav_pitot_static_2022_05_07_11.csv": ("sepcal-pitot", (), {"held"}),
    "airliner_mode_s.csv": ("sepcal-pitot", (), {"held", "headings"}),
    "rv_deceleration_stall.csv": ("sepcal-pitot", (), {"headings"}),
    "bench_tilt_sphere_mag.csv": ("sepcal-mag", ("--field-strength", "48"), {"bursts"}),
    "octocopter_internal_mag.csv": ("sepcal-mag", ("--field", "19.72,-1.41,49.44"), {"sphere"}),
    "octocopter_external_mag.csv": ("sepcal-mag", ("--field", "19.72,-1.41,49.44"), {"sphere"}),
}


@pytest.mark.parametrize("name", RECORDED)
def test_a_recorded_log(name: str, tmp_path) -> None:
    file = find_fixture(name)
    app, options, known = RECORDED[name]
    result = run(app, "check", file, "--json", *options, folder=tmp_path).result
    assert {note["kind"] for note in result["notes"] if note["concern"] != "slight"} == known


def test_the_air_data_of_a_small_aircraft_is_slower_than_its_log(tmp_path) -> None:
    """Its airspeed was logged five times as often as it was measured: 10 Hz."""
    file = find_fixture("uav_pitot_static_2022_05_07_11.csv")
    result = run("sepcal-pitot", "check", file, "--json", folder=tmp_path).result
    held = {tuple(n["columns"]): n["found"] for n in result["notes"] if n["kind"] == "held"}
    assert "one row in 5 (10 Hz in a log of 50 Hz)" in held[("airspeed_mps",)]


def test_a_hover_covers_little_of_the_sphere(tmp_path: Path) -> None:
    """The middle of what readings within a few degrees lie on is off their patch."""
    draw = np.random.default_rng(1)
    tilt = draw.normal(0, 0.04, (2000, 2))
    field = np.column_stack([20 - 45 * tilt[:, 0], 45 * tilt[:, 1], 45 + 20 * tilt[:, 0]])
    readings = field + np.array([10, -20, 5]) + draw.normal(0, 0.3, (2000, 3))
    table = np.column_stack([0.02 * np.arange(2000), readings])
    header = "time_s,mx_ut,my_ut,mz_ut"
    np.savetxt(tmp_path / "f.csv", table, "%.6f", ",", header=header, comments="")
    options = ("--field-strength", "49.24", "--json")
    checked = run("sepcal-mag", "check", "f.csv", *options, folder=tmp_path).result
    (note,) = [note for note in checked["notes"] if note["kind"] == "sphere"]
    covered = float(note["found"].split(" % of all")[0].split()[-1])
    assert covered < 10
