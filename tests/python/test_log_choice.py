# SPDX-License-Identifier: BSD-3-Clause
"""What is chosen of a log, its columns and rows, and how that travels with a result."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sepcal
from apps import Bench, Log, assert_refused, parse_json, values_of
from oracle.pitot_static import PitotStatic

SLOW = 4  # rows to a sample


@pytest.fixture
def tube(pitot: Bench) -> Bench:
    """A tube's log whose airspeed was sampled in every fourth row and held in between."""
    command = ("simulate", "--probe", "pitot-static", "-o", "flight.csv", "--rows", "800")
    assert pitot.run(*command, "--hide", "wind[time]=0.02:0").code == 0
    log = pitot.read_log()
    airspeed = log.column("airspeed_mps")
    log.replace("airspeed_mps", airspeed[np.arange(airspeed.size) // SLOW * SLOW])
    (pitot.folder / "flight.csv").write_text(log.text())
    return Bench(pitot.app, pitot.folder, (), PitotStatic())


def cut_by_hand(log: Log) -> Log:
    """The rows in which another value begins; a maneuver's first row begins one."""
    airspeed, maneuver = log.column("airspeed_mps"), log.index("maneuver")
    log.rows = [
        row
        for i, row in enumerate(log.rows)
        if i == 0 or airspeed[i] != airspeed[i - 1] or row[maneuver] != log.rows[i - 1][maneuver]
    ]
    return log


def test_a_fit_is_that_of_a_file_cut_by_hand(tube: Bench) -> None:
    """To the last digit, in every verb that reads the calibration."""
    cut = cut_by_hand(tube.read_log())
    (tube.folder / "cut.csv").write_text(cut.text())
    by_option = tube.fit("--drop-repeats", "airspeed", "-o", "option.json")
    by_hand = tube.fit("-o", "hand.json", flight="cut.csv")
    assert (by_option.code, by_hand.code) == (0, 0), by_option.err + by_hand.err
    assert by_option.result["parameters"] == by_hand.result["parameters"]
    assert by_option.result["inputs"]["rows_used"] == len(cut.rows)
    assert by_option.result["options"]["drop_repeats"] == ["airspeed"]
    assert "they lie between samples of airspeed" in by_option.err
    assert "drop-repeats" not in by_option.err  # it was done
    assert "drop_repeats" not in by_hand.result["options"]

    for verb in ("compare", "diagnose", "intervals"):
        one = tube.run(verb, "flight.csv", "option.json", "--json")
        other = tube.run(verb, "cut.csv", "hand.json", "--json")
        assert one.code == other.code
        told = [outcome.result for outcome in (one, other)]
        for result in told:
            result.pop("inputs", None)
        assert told[0] == told[1], verb


def test_apply_writes_every_row(tube: Bench) -> None:
    assert tube.fit("--drop-repeats", "airspeed", "-o", "tube.json").code == 0
    applied = tube.run("apply", "flight.csv", "tube.json", "-o", "applied.csv")
    assert applied.code == 0, applied.err
    written = Log(tube.folder / "applied.csv")
    assert len(written.rows) == 800
    assert np.all(np.isfinite(written.column(written.headers[-1])))


def test_check_says_how(tube: Bench) -> None:
    """The advice of its note is the option that ends it."""
    said = tube.run("check", "flight.csv").out
    assert "--drop-repeats airspeed_mps" in said


def test_python_takes_it_and_saves_it(tube: Bench) -> None:
    flight = sepcal.read_csv(tube.flight)
    fitted = sepcal.fit(sepcal.PitotStatic(), flight, drop_repeats=["airspeed_mps"])
    fitted.save(tube.folder / "python.json")
    saved = parse_json((tube.folder / "python.json").read_text())
    assert saved["options"]["drop_repeats"] == ["airspeed_mps"]
    by_app = tube.fit("--drop-repeats", "airspeed_mps").result
    assert np.array_equal(values_of(saved), values_of(by_app))
    several = sepcal.fit_many(
        sepcal.PitotStatic(), {"a": flight, "b": flight}, drop_repeats=["airspeed_mps"]
    )
    assert several.rows == 2 * fitted.rows


def test_what_is_refused(tube: Bench) -> None:
    words = ("--drop-repeats names speed", "airspeed_mps")
    assert_refused(tube, "fit", "flight.csv", "--drop-repeats", "speed", words=words)
    with pytest.raises(sepcal.Error, match="drop_repeats is for flights"):
        sepcal.fit(sepcal.PitotStatic(), {"vn": [1.0]}, drop_repeats=["vn"])
    with pytest.raises(TypeError, match=r"give \[column, \.\.\.\]"):
        sepcal.fit(sepcal.PitotStatic(), sepcal.read_csv(tube.flight), drop_repeats="airspeed")


REGION = ("--where", "vn > 2 and maneuver != 'none'", "--from", "20", "--to", "150.5")


def cut_to_region(log: Log) -> Log:
    """The same rows by hand."""
    vn, time = log.column("vn_mps"), log.column("time_s")
    log.rows = [row for i, row in enumerate(log.rows) if vn[i] > 2 and 20 <= time[i] <= 150.5]
    return log


def test_a_fit_on_a_region_is_that_of_a_file_cut_by_hand(tube: Bench) -> None:
    """To the last digit, in every verb, and with the same count of rows in every JSON."""
    cut = cut_to_region(tube.read_log())
    assert 100 < len(cut.rows) < 700
    (tube.folder / "cut.csv").write_text(cut.text())
    by_option = tube.fit(*REGION, "-o", "option.json")
    by_hand = tube.fit("-o", "hand.json", flight="cut.csv")
    assert (by_option.code, by_hand.code) == (0, 0), by_option.err + by_hand.err
    assert by_option.result["parameters"] == by_hand.result["parameters"]
    assert by_option.result["inputs"]["rows_used"] == len(cut.rows)
    assert by_option.result["options"]["where"] == REGION[1]
    assert "vn > 2 and maneuver != 'none' does not hold there" in by_option.err
    for verb in ("compare", "diagnose", "intervals"):
        one = tube.run(verb, "flight.csv", "option.json", "--json").result
        other = tube.run(verb, "cut.csv", "hand.json", "--json").result
        assert one.pop("inputs")["rows_used"] == other.pop("inputs")["rows_used"] == len(cut.rows)
        assert one == other, verb
    added = tube.run("add", "flight.csv", "option.json", "wind[time]", "--json").result
    by_hand = tube.run("add", "cut.csv", "hand.json", "wind[time]", "--json")
    assert added["parameters"] == by_hand.result["parameters"]
    assert added["inputs"]["rows_used"] == len(cut.rows)


def test_apply_flags_the_rows_outside(tube: Bench) -> None:
    assert tube.fit(*REGION, "-o", "region.json").code == 0
    applied = tube.run("apply", "flight.csv", "region.json", "-o", "applied.csv")
    assert applied.code == 0, applied.err
    written = Log(tube.folder / "applied.csv")
    assert len(written.rows) == 800
    vn, time = written.column("vn_mps"), written.column("time_s")
    inside = (vn > 2) & (time >= 20) & (time <= 150.5)
    assert np.array_equal(written.column("outside_fit") == 0, inside)


def test_times_are_of_the_fitted_flight_alone(tube: Bench) -> None:
    """A condition travels to another flight, times don't, and a line says so."""
    other = tube.read_log()
    other.replace("time_s", other.column("time_s") + 1e5)
    (tube.folder / "other.csv").write_text(other.text())
    assert tube.fit(*REGION, "-o", "region.json").code == 0
    compared = tube.run("compare", "other.csv", "region.json", "--json")
    assert compared.code == 0, compared.err
    assert compared.result["inputs"]["rows_used"] == int(np.sum(other.column("vn_mps") > 2))
    assert "are of another log's clock" in compared.err


def test_foreign_headers_and_units_are_read_by_options_alone(tube: Bench) -> None:
    """Headers, units and a clock of another maker; a column in the way; the same result."""
    clean = tube.fit("-o", "clean.json")
    log = tube.read_log()
    log.replace("airspeed_mps", log.column("airspeed_mps") * 3600 / 1852, "TAS (kn)")
    log.replace("vn_mps", log.column("vn_mps") * 3.6, "GS_N")
    log.replace("time_s", np.round(log.column("time_s") * 1e6), "micros")
    log.add("airspeed_kt", np.zeros(800))
    (tube.folder / "foreign.csv").write_text(log.text())
    names = "airspeed_kt=TAS (kn),vn_kmh=GS_N,time_us=micros"
    options = ("--map", names, "--ignore", "airspeed_kt")
    done = tube.fit(*options, "-o", "foreign.json", flight="foreign.csv")
    assert done.code == 0, done.err
    assert values_of(done.result) == pytest.approx(values_of(clean.result), rel=1e-9, abs=1e-9)
    for verb in ("compare", "diagnose", "intervals"):
        later = tube.run(verb, "foreign.csv", "foreign.json", "--json")
        assert later.code == tube.run(verb, "flight.csv", "clean.json", "--json").code, later.err
    assert tube.run("check", "foreign.csv", *options).code == 0
    python = sepcal.fit(
        sepcal.PitotStatic(),
        sepcal.read_csv(tube.folder / "foreign.csv"),
        map={"airspeed_kt": "TAS (kn)", "vn_kmh": "GS_N", "time_us": "micros"},
        ignore=["airspeed_kt"],
    )
    assert python["w_n"].value == done.result["parameters"]["w_n"]["value"]


def test_attitude_may_be_a_quaternion(magnetometer: Bench) -> None:
    """SciPy turns the angles into one; the fit is the same."""
    log = magnetometer.read_log()
    angles = np.column_stack([log.column(f"{name}_rad") for name in ("yaw", "pitch", "roll")])
    quaternions = Rotation.from_euler("ZYX", angles).as_quat()
    for name in ("roll", "pitch", "yaw"):
        log.drop(f"{name}_rad")
    for name, column in zip(("qx", "qy", "qz", "qw"), quaternions.T, strict=True):
        log.add(name, column)
    (magnetometer.folder / "turned.csv").write_text(log.text())
    done = magnetometer.fit(flight="turned.csv")
    assert done.code == 0, done.err
    expected = values_of(magnetometer.base)
    assert values_of(done.result) == pytest.approx(expected, rel=1e-7, abs=1e-9)


def test_joined_logs_are_fitted_as_they_are(tube: Bench) -> None:
    """Two clocks that start anew, and the fit of the same rows on one clock."""
    log = tube.read_log()
    time = log.column("time_s")
    continued = time.copy()
    continued[400:] += 1000.0  # a gap there too
    log.replace("time_s", continued)
    (tube.folder / "one_clock.csv").write_text(log.text())
    time[400:] -= time[400]
    log.replace("time_s", time)
    (tube.folder / "two_clocks.csv").write_text(log.text())
    one, two = (tube.fit(flight=name) for name in ("one_clock.csv", "two_clocks.csv"))
    assert two.code == 0, two.err
    assert "time_s runs back once, first at two_clocks.csv line 402" in two.err
    assert values_of(two.result) == pytest.approx(values_of(one.result), rel=1e-9)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--where", "airsped > 20"), ("--where", "'airsped' is no column", "airspeed_mps")),
        (("--where", "airspeed >"), ("--where", "ends where a number")),
        (("--where", "airspeed > 1e6"), ("no row is left of 800", "airspeed > 1e6 does not hold")),
        (("--from", "1e6"), ("no row is left of 800", "1000000")),
        (("--from", "5", "--to", "4"), ("--from", "5 is not before", "--to")),
        (("--from", "noon"), ("--from",)),
        (("--map", "airspeed_kt=IAS"), ("--map", "IAS names a column that is not there")),
        (("--map", "airspeed_kt"), ("--map airspeed_kt", "HEADER=COLUMN")),
        (("--map", "airspeed_kt=", "--json"), ("--map airspeed_kt=", "HEADER=COLUMN")),
        (("--map", "vn_mps=ve_mps"), ("--map", "there is a column 'vn_mps' already")),
        (("--ignore", "nothing"), ("--ignore", "nothing", "no column")),
        (("--ignore", "vn_mps"), ("vn_mps", "missing")),
    ],
)
def test_bad_choices(tube: Bench, options: tuple[str, ...], words: tuple[str, ...]) -> None:
    assert_refused(tube, "fit", "flight.csv", *options, words=words)


def every_fiftieth(rows: int) -> list[str]:
    """A channel of 1 Hz in a log of 50 Hz."""
    return [f"{12.5 - 0.001 * i:.4f}" if i % 50 == 0 else "" for i in range(rows)]


@pytest.mark.parametrize(
    ("header", "cells"),
    [
        ("voltage_v", every_fiftieth(800)),
        ("every_other", ["7.25" if i % 2 else "" for i in range(800)]),
        ("phase", ["climb" if i < 400 else "cruise" for i in range(800)]),
        ("clock", [f"10:{i // 60:02}:{i % 60:02}" for i in range(800)]),
        ("nothing", [""] * 800),
        ("holes", ["" if i % 40 == 7 else "3.5" for i in range(800)]),
    ],
)
def test_channels_that_hold_no_numbers_cost_nothing(
    tube: Bench, header: str, cells: list[str]
) -> None:
    """A merged or foreign log: the fit is that without the column, and a note says so."""
    log = tube.read_log()
    log.add(header, cells)
    (tube.folder / "merged.csv").write_text(log.text())
    checked = tube.run("check", "merged.csv")
    assert checked.code == 0, checked.err
    done = tube.fit(flight="merged.csv")
    assert done.code == 0, done.err
    assert done.result["parameters"] == tube.fit().result["parameters"]
    assert header in done.err


def test_a_quantity_may_be_named_in_any_unit(tube: Bench) -> None:
    """The file logs airspeed in m/s."""
    in_knots = tube.fit("--where", "airspeed_kt > 35").result
    inside = tube.fit("--where", f"airspeed > {35 * 1852 / 3600!r}").result
    assert in_knots["parameters"] == inside["parameters"]
    assert in_knots["inputs"]["rows_used"] < 800


def test_a_map_is_for_logs_that_need_it(tube: Bench) -> None:
    """A calibration of a foreign log looks at one with sepcal's own names."""
    log = tube.read_log()
    log.replace("airspeed_mps", log.column("airspeed_mps"), "TAS")
    (tube.folder / "foreign.csv").write_text(log.text())
    fitted = tube.fit("--map", "airspeed_mps=TAS", "-o", "f.json", flight="foreign.csv")
    assert fitted.code == 0, fitted.err
    compared = tube.run("compare", "flight.csv", "f.json", "--json")
    assert compared.code == 0, compared.err
    assert compared.result["inputs"]["rows_used"] == 800
    assert tube.run("apply", "flight.csv", "f.json", "-o", "out.csv").code == 0


@pytest.mark.parametrize("block", [(300, 301), (300, 302)])
def test_a_stamp_that_is_off_is_refused(tube: Bench, block: tuple[int, int]) -> None:
    """It is no clock that starts anew."""
    log = tube.read_log()
    time = log.column("time_s")
    time[slice(*block)] -= 10.0
    log.replace("time_s", time)
    (tube.folder / "flight.csv").write_text(log.text())
    assert_refused(tube, "fit", "flight.csv", words=("time_s runs back", "sort the rows"))


def test_held_positions_give_every_row_a_velocity(tube: Bench) -> None:
    """Fixes of 5 Hz in a faster log, the last of them held for a while; no fix at first is said."""
    log = tube.read_log()
    time = log.column("time_s")
    east = np.cumsum(log.column("ve_mps") * np.gradient(time))
    north = np.cumsum(log.column("vn_mps") * np.gradient(time))
    fix = np.arange(800) // 4 * 4
    for name in ("vn_mps", "ve_mps", "vd_mps"):
        log.drop(name)
    if "altitude_m" in log.headers:
        log.drop("altitude_m")
    latitude = 45.0 + np.degrees(north / 6_367_382.0)[fix]
    longitude = 7.0 + np.degrees(east / 4_517_591.0)[fix]
    log.add("lat_deg", latitude)
    log.add("lon_deg", longitude)
    log.add("altitude_m", np.zeros(800))
    (tube.folder / "positions.csv").write_text(log.text())
    done = tube.fit(flight="positions.csv")
    assert done.code == 0, done.err
    assert done.result["inputs"]["rows_used"] == 800
    latitude[:50] = longitude[:50] = 0.0
    log.replace("lat_deg", latitude)
    log.replace("lon_deg", longitude)
    (tube.folder / "flight.csv").write_text(log.text())
    words = ("no velocity: no fix is near", "--drop-invalid")
    assert_refused(tube, "fit", "flight.csv", words=words)
    log.replace("lat_deg", latitude * 1e7)
    (tube.folder / "flight.csv").write_text(log.text())
    assert_refused(tube, "fit", "flight.csv", words=("lat_deg is", "beyond 90 degrees"))


def test_check_describes_the_rows_that_are_taken(tube: Bench) -> None:
    """As it describes a file of these rows; fit's notes are of them, too."""
    log = tube.read_log()
    speed = log.column("airspeed_mps")
    limit = float(np.median(speed))
    taken = speed > limit
    options = ("--where", f"airspeed > {limit!r}")
    by_option = tube.run("check", "flight.csv", *options, "--json")
    assert by_option.code == 0, by_option.err
    told = by_option.result
    assert told["inputs"]["rows_used"] == np.count_nonzero(taken)
    columns = {column["column"]: column for column in told["columns"]}
    assert columns["airspeed_mps"]["least"] > limit
    assert columns["airspeed_mps"]["missing"] == 0
    wind = log.column("vn_mps")[taken]
    assert columns["vn_mps"]["median"] == pytest.approx(np.median(wind))
    assert not [note for note in told["notes"] if note["kind"] == "at_rest"]
    whole = tube.run("check", "flight.csv", "--json").result
    assert {column["column"]: column for column in whole["columns"]}["airspeed_mps"][
        "least"
    ] < limit


def test_climb_is_read_as_velocity_down(tube: Bench) -> None:
    log = tube.read_log()
    clean = tube.fit("-o", "clean.json")
    log.replace("vd_mps", -log.column("vd_mps") / 0.3048 * 60)
    text = log.text().replace("vd_mps", "climb rate", 1)
    (tube.folder / "climb.csv").write_text(text)
    read = tube.fit("--map", "vu_fpm=climb rate", "-o", "climb.json", flight="climb.csv")
    assert read.code == 0, read.err
    assert "vd is climb rate turned downwards" in read.err
    assert values_of(read.result) == pytest.approx(values_of(clean.result), rel=1e-6, abs=1e-6)


@pytest.mark.parametrize(
    ("opening", "name"), [(b"\xa3\x95\x80\x80", "DataFlash"), (b"ULog\x01\x12\x35", "ULog")]
)
def test_an_autopilots_log_is_told(tube: Bench, opening: bytes, name: str) -> None:
    (tube.folder / "flight.log").write_bytes(opening + bytes(range(200)))
    words = (name, "python -m sepcal log flight.log -o flight.csv")
    assert_refused(tube, "fit", "flight.log", words=words)
