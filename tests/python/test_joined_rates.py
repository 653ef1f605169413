# SPDX-License-Identifier: BSD-3-Clause
"""Sensors of different rates: in one file that never shares a row, and in two with two clocks."""

import re
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import sepcal
from apps import run

APP = "sepcal-pitot"
TRUTH = {"s_va": 0.95, "c_va": -0.6, "w_n": -3.8, "w_e": 2.4}
LATE = 0.15  # s, the tube's clock

Array = NDArray[np.float64]


def velocity(time: Array) -> Array:
    """North, east and down [m/s], shape (N, 3): circles at a speed that swells."""
    course = 2.0 * np.pi * time / 60.0
    speed = 22.0 + 4.0 * np.sin(2.0 * np.pi * time / 23.0)
    return np.c_[
        speed * np.cos(course) + TRUTH["w_n"],
        speed * np.sin(course) + TRUTH["w_e"],
        0.5 * np.sin(time / 9.0),
    ]


def airspeed(time: Array) -> Array:
    """As the tube reads it without noise [m/s], shape (N,)."""
    air = velocity(time) - [TRUTH["w_n"], TRUTH["w_e"], 0.0]
    return np.asarray(TRUTH["s_va"] * np.linalg.norm(air, axis=1) + TRUTH["c_va"])


def fly(rate: float, first: float, seed: int) -> tuple[Array, Array, Array]:
    """Times, and what a tube and a receiver read then, each with noise."""
    rng = np.random.default_rng(seed)
    time = np.arange(first, 300.0, 1.0 / rate)
    read = airspeed(time) + 0.1 * rng.standard_normal(time.size)
    fixed = velocity(time) + 0.03 * rng.standard_normal((time.size, 3))
    return time, read, fixed


def write(file: Path, header: str, columns: Array) -> Path:
    rows = [",".join(f"{x:.6f}" if np.isfinite(x) else "" for x in row) for row in columns]
    file.write_text("\n".join([header, *rows]) + "\n")
    return file


@pytest.fixture
def one_file(tmp_path: Path) -> Path:
    """A row of either sensor's, the tube's at 10 Hz and the receiver's at 5 Hz."""
    fast, read, _ = fly(10.0, 0.05, 1)
    slow, _, fixed = fly(5.0, 0.0, 2)
    rows = np.full((fast.size + slow.size, 5), np.nan)
    rows[: fast.size, 0], rows[: fast.size, 4] = fast, read
    rows[fast.size :, 0], rows[fast.size :, 1:4] = slow, fixed
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    return write(tmp_path / "log.csv", "time_s,vn_mps,ve_mps,vd_mps,airspeed_mps", rows)


@pytest.fixture
def two_files(tmp_path: Path) -> tuple[Path, Path]:
    """The tube's log, whose clock is late, and the receiver's."""
    fast, read, _ = fly(10.0, 10.02, 3)
    slow, _, fixed = fly(5.0, 0.0, 4)
    return (
        write(tmp_path / "tube.csv", "time_s,airspeed_mps", np.c_[fast + LATE, read]),
        write(tmp_path / "gnss.csv", "time_s,vn_mps,ve_mps,vd_mps", np.c_[slow, fixed]),
    )


def assert_true(fit: sepcal.Calibration, truth: dict[str, float] = TRUTH) -> None:
    for name, value in truth.items():
        assert abs(fit[name].value - value) < 4.0 * fit[name].standard_error, name


def test_the_advice_for_rates_that_never_share_a_row_works(one_file: Path) -> None:
    """One line, and what it says gives the truth."""
    for options in ((), ("--drop-invalid",)):
        refused = run(APP, "fit", one_file, *options, folder=one_file.parent)
        assert refused.code == 2
        assert len(refused.err.splitlines()) == 1
    advice = re.search(r"--join (\w+)", refused.err)
    assert advice
    for how in (advice.group(1), "linear"):
        fitted = run(
            APP, "fit", one_file, "--join", how, "-o", f"{how}.json", folder=one_file.parent
        )
        assert fitted.code == 0, fitted.err
        assert "vn_mps, ve_mps, vd_mps (5 Hz) are brought to the" in fitted.err
        fit = sepcal.load(one_file.parent / f"{how}.json")
        assert_true(fit)
        assert fit["s_va"].standard_error < 0.005


def test_later_verbs_join_as_the_fit_did(one_file: Path) -> None:
    """Without a word of it: the calibration says how."""
    folder = one_file.parent
    assert run(APP, "fit", one_file, "--join", "smooth", "-o", "base.json", folder=folder).code == 0
    for verb in ("compare", "intervals"):
        told = run(APP, verb, one_file, "base.json", folder=folder)
        assert told.code == 0, told.err
    diagnosed = run(APP, "diagnose", one_file, "base.json", folder=folder)
    assert diagnosed.code == 0, diagnosed.out  # nothing is missing
    applied = run(APP, "apply", one_file, "base.json", "-o", "corrected.csv", folder=folder)
    assert applied.code == 0, applied.err
    corrected = sepcal.read_csv(folder / "corrected.csv")
    read = np.isfinite(corrected["airspeed_mps"])
    assert np.array_equal(np.isfinite(corrected["airspeed_cal_mps"]), read)
    assert "outside_fit" not in corrected


def test_how_is_one_of_three(one_file: Path) -> None:
    flight = sepcal.read_csv(one_file)
    with pytest.raises(sepcal.Error, match="join is smooth, linear or held, not 'cubic'"):
        sepcal.fit(sepcal.PitotStatic(), flight, join="cubic")
    assert_true(sepcal.fit(sepcal.PitotStatic(), flight, join="smooth"))


def test_two_files_and_what_is_left_between_their_clocks(two_files: tuple[Path, Path]) -> None:
    """Scale, bias, wind and the clock's lateness, each within its error."""
    tube, receiver = map(sepcal.read_csv, two_files)
    joined = sepcal.join(tube, receiver)
    assert joined.columns == ("time_s", "airspeed_mps", "vn_mps", "ve_mps", "vd_mps")
    assert any("vn_mps, ve_mps, vd_mps (5 Hz)" in note for note in joined.notes)
    fit = sepcal.fit(sepcal.PitotStatic(), joined, effects=["time_offset"])
    assert_true(fit, TRUTH | {"time_offset.tau": LATE})
    assert fit["time_offset.tau"].standard_error < 0.02
    again = sepcal.join(tube, receiver, offset=fit["time_offset.tau"].value)
    left = sepcal.fit(sepcal.PitotStatic(), again, effects=["time_offset"])["time_offset.tau"]
    assert abs(left.value) < 0.005


def test_the_verb_writes_what_python_joins(two_files: tuple[Path, Path]) -> None:
    tube, receiver = two_files
    folder = tube.parent
    options = ("--how", "linear", "--offset", "0.15", "-o", "joined.csv")
    done = run(APP, "join", tube, receiver, *options, folder=folder)
    assert done.code == 0, done.err
    assert "--effect time_offset" in done.out
    written = sepcal.read_csv(folder / "joined.csv")
    joined = sepcal.join(sepcal.read_csv(tube), sepcal.read_csv(receiver), "linear", 0.15)
    assert written.columns == joined.columns
    for header in joined:
        assert np.array_equal(written[header], joined[header]), header


def test_clocks_without_a_common_time_are_refused_and_the_advice_joins(
    two_files: tuple[Path, Path],
) -> None:
    tube, receiver = two_files
    folder = tube.parent
    flight = sepcal.read_csv(receiver)
    columns = {header: np.array(flight[header]) for header in flight}
    columns["time_s"] = columns["time_s"] + 1.7e9
    far = write(folder / "far.csv", ",".join(columns), np.c_[tuple(columns.values())])
    refused = run(APP, "join", tube, far, "-o", "joined.csv", folder=folder)
    assert refused.code == 2
    assert len(refused.err.splitlines()) == 1
    assert not (folder / "joined.csv").exists()
    advice = re.search(r"--offset S .*: (\S+) lets", refused.err)
    assert advice
    done = run(
        APP, "join", tube, far, f"--offset={advice.group(1)}", "-o", "joined.csv", folder=folder
    )
    assert done.code == 0, done.err


def test_headings_are_joined_the_short_way_round() -> None:
    """Of a magnetometer's attitude: 359 to 1 deg by way of north."""
    fast = np.arange(1.0, 100.0, 0.1)
    slow = np.arange(0.03, 100.0, 0.2)

    def turned(time: Array) -> Array:
        return np.asarray((20.0 * time) % 360.0)

    other = sepcal.Flight({"time_s": slow, "yaw_deg": turned(slow)}, name="attitude")
    for how in ("smooth", "linear"):
        joined = sepcal.join(sepcal.Flight({"time_s": fast, "mx_ut": fast}), other, how)
        off = (joined["yaw_deg"] - turned(np.array(joined["time_s"])) + 180.0) % 360.0 - 180.0
        assert np.abs(off).max() < 1e-6, how


def test_what_cannot_be_joined_is_refused_in_python() -> None:
    tube = sepcal.Flight({"time_s": [0.0, 1.0], "airspeed_mps": [20.0, 20.0]}, name="tube")
    other = sepcal.Flight({"time_s": [0.0, 1.0], "vn_mps": [1.0, 1.0]}, name="gnss")
    with pytest.raises(sepcal.Error, match="offset"):
        sepcal.join(tube, other, offset=float("nan"))
    with pytest.raises(sepcal.Error, match="offset"):
        sepcal.join(tube, other, offset="late")  # type: ignore[arg-type]
    with pytest.raises(sepcal.Error, match="no such file"):
        sepcal.join(tube, "gnss.csv")  # type: ignore[arg-type]
    with pytest.raises(sepcal.Error, match="no column that tube does not have"):
        sepcal.join(tube, tube)
