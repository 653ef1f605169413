# SPDX-License-Identifier: BSD-3-Clause
"""Rows between the samples of a slow column are left out, and the choice travels with a result."""

import numpy as np
import pytest

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
