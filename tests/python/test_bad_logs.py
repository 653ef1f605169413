# SPDX-License-Identifier: BSD-3-Clause
"""Logs that can't be converted: one line names culprit and way out, and nothing is written."""

import contextlib
import random
import subprocess
import sys

import pytest

import flown_dataflash
import flown_flight as flown
import flown_ulog
import sepcal
from apps import small_files
from log_writers import DataFlashWriter, ULogWriter

pytest.importorskip("pyulog")
pytest.importorskip("pymavlink")
pytest.importorskip("pygeomag")


@pytest.fixture(scope="module")
def new_bin():
    return flown_dataflash.new_dataflash().data()


@pytest.fixture(scope="module")
def new_ulg():
    return flown_ulog.new_ulog().data()


def refuse(folder, *arguments, words=()):
    """Runs the command: one line, exit code 2, and the folder as it was."""
    before = {file.name: file.read_bytes() for file in folder.iterdir()}
    command = [sys.executable, "-m", "sepcal", "log", *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, ""), done
    assert done.stderr.count("\n") == 1, done.stderr
    assert done.stderr.startswith("sepcal log: ")
    for word in words:
        assert word in done.stderr
    assert {file.name: file.read_bytes() for file in folder.iterdir()} == before
    return done.stderr


def place(folder, name, data):
    (folder / name).write_bytes(data)
    return name


@pytest.mark.parametrize("kind", ["bin", "ulg"])
@pytest.mark.parametrize("share", [0.5, 0.9])
def test_cut_off(tmp_path, kind, share, new_bin, new_ulg):
    data = new_bin if kind == "bin" else new_ulg
    name = place(tmp_path, f"a.{kind}", data[: int(share * len(data)) // 7 * 7 + 3])
    refuse(
        tmp_path, name, "-o", "f.csv", words=[name, "cut off inside", "at byte", "--cut-off takes"]
    )
    refuse(tmp_path, name, "--list", words=["cut off inside"])
    flight = sepcal.read_log(tmp_path / name, cut_off=True)
    assert any("cut off" in note for note in flight.conversion["notes"])


@pytest.mark.parametrize("kind", ["bin", "ulg"])
@pytest.mark.parametrize("size", [3, 10, 60, 200])
def test_hardly_begun(tmp_path, kind, size, new_bin, new_ulg):
    data = new_bin if kind == "bin" else new_ulg
    name = place(tmp_path, f"a.{kind}", data[:size])
    refuse(tmp_path, name, "-o", "f.csv", words=[name])


def test_zeros_at_the_end_are_no_cut(tmp_path, new_bin):
    name = place(tmp_path, "a.bin", new_bin + b"\0" * 700)
    assert sepcal.read_log(tmp_path / name).rows > 500


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "the file is empty"),
        (b"\x89PNG\r\n\x1a\n" + bytes(100), "neither a ULog (.ulg) nor a DataFlash log (.bin)"),
        (b"time_s,mx_ut\n0,1\n", "a table as text, not a log; the apps read CSV files"),
        (b"FMT, 128, 89, FMT, BBnNZ, Type,Length\n", "no whole message is in it"),
        (bytes(8) + b"\xfd" + bytes(60), "a telemetry log (.tlog)"),
    ],
)
def test_foreign_files(tmp_path, data, words):
    name = place(tmp_path, "a.bin", data)
    refuse(tmp_path, name, "-o", "f.csv", words=[name, words])


def test_no_such_file(tmp_path):
    refuse(tmp_path, "b.bin", "-o", "f.csv", words=["b.bin: can't be read: No such file"])
    refuse(tmp_path, ".", "-o", "f.csv", words=["Is a directory"])


def test_without_a_sensor(tmp_path):
    log = DataFlashWriter()
    log.form("BARO", "Qff", "TimeUS,Alt,Press")
    for t in flown.at_rate(10):
        log.add(t, "BARO", round(t * 1e6), 0.0, 95000.0)
    name = place(tmp_path, "a.bin", log.data())
    refuse(
        tmp_path, name, "-o", "f.csv", words=["nothing to calibrate: of MAG and ARSP no message"]
    )
    assert "nothing can be calibrated" in str(sepcal.list_log(tmp_path / name))
    log = ULogWriter()
    log.form("vehicle_attitude", "float[4] q")
    for t in flown.at_rate(10):
        log.add(t, "vehicle_attitude", 1.0, 0.0, 0.0, 0.0)
    name = place(tmp_path, "a.ulg", log.data())
    refuse(tmp_path, name, "-o", "f.csv", words=["of sensor_mag, vehicle_magnetometer, "])


def test_a_tube_without_velocity(tmp_path):
    log = DataFlashWriter()
    log.form("ARSP", "QBff", "TimeUS,I,Airspeed,DiffPress")
    for t in flown.at_rate(10):
        log.add(t, "ARSP", round(t * 1e6), 0, 20.0, 250.0)
    name = place(tmp_path, "a.bin", log.data())
    words = ["pitot0 can't be calibrated: neither velocity over the ground nor position is logged"]
    refuse(tmp_path, name, "-o", "f.csv", words=words)
    assert sepcal.list_log(tmp_path / name).sensors == ()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--sensor", "mag7"), "no sensor 'mag7'; it has mag0, mag1, pitot0"),
        (("--from", "50", "--to", "40"), "nothing is from 50 to 40 s: the start comes after"),
        (("--from", "500"), "mag0 has no reading from 500 s; it has 600 from 19.996 to 79.896 s"),
        (("--to", "1"), "no reading to 1 s"),
        (("--from", "nan"), "start is nan"),
        (("--from", "soon"), "--from: invalid float value: 'soon'"),
        (("--date", "2031-01-01"), "the year 2031 is outside"),
        (("--date", "long ago"), "'long ago' is no date"),
    ],
)
def test_bad_options(tmp_path, new_bin, options, words):
    name = place(tmp_path, "a.bin", new_bin)
    refuse(tmp_path, name, "-o", "f.csv", *options, words=[words])


def test_bad_outputs(tmp_path, new_bin):
    name = place(tmp_path, "a.bin", new_bin)
    refuse(tmp_path, name, words=["-o FLIGHT.csv writes a flight, --list shows"])
    refuse(tmp_path, name, "-o", name, words=["it is an input"])
    refuse(tmp_path, name, "-o", "there/f.csv", words=["folder 'there' isn't there; make it first"])
    folder = tmp_path / "f.csv.json"
    before = new_bin
    folder.mkdir()
    with pytest.raises(sepcal.Error, match="is a folder; name a file in it"):
        sepcal.read_log(tmp_path / name).save(tmp_path / "f.csv")
    assert {file.name for file in tmp_path.iterdir()} == {"a.bin", "f.csv.json"}
    assert (tmp_path / name).read_bytes() == before


def test_an_interrupted_save_leaves_nothing(tmp_path, new_bin):
    flight = sepcal.read_log(tmp_path / place(tmp_path, "a.bin", new_bin))
    with small_files(4096), pytest.raises(sepcal.Error, match=r"f\.csv: writing failed: File too"):
        flight.save(tmp_path / "f.csv")
    assert [file.name for file in tmp_path.iterdir()] == ["a.bin"]


def test_positions_without_a_date(tmp_path):
    log = flown_ulog.new_ulog(utc=False)
    name = place(tmp_path, "a.ulg", log.data())
    words = ["a.ulg: positions without a date", "--date 2026-03-01 gives it", "--no-field does"]
    refuse(tmp_path, name, "-o", "f.csv", words=words)
    dated = sepcal.read_log(tmp_path / name, date="2024-03-18")
    assert dated.conversion["columns"]["bn_ut"]["done"][0] == "on the day that was given"
    assert "bn_ut" not in sepcal.read_log(tmp_path / name, field=False)
    assert "no date is logged" in str(sepcal.list_log(tmp_path / name))


def test_a_date_outside_the_models(tmp_path):
    """The GPS' week counter of ten bits began anew in 2019: receivers of old say 2004."""
    log = flown_dataflash.new_dataflash(week=flown_dataflash.WEEK - 1024)
    name = place(tmp_path, "a.bin", log.data())
    words = ["a.bin: the year 2004 is outside the field models", "--date gives another day"]
    refuse(tmp_path, name, "-o", "f.csv", words=words)


@pytest.mark.parametrize(
    ("name", "missing"), [("a.bin", "pymavlink"), ("a.ulg", "pyulog"), ("a.bin", "pygeomag")]
)
def test_without_the_extra(tmp_path, monkeypatch, name, missing, new_bin, new_ulg):
    from sepcal.geomagnetism import models

    models._model_of.cache_clear()
    place(tmp_path, name, new_bin if name == "a.bin" else new_ulg)
    for module in [m for m in sys.modules if m.split(".")[0] == missing]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(
        sepcal.Error, match=rf"{missing}.*not installed: pip install sepcal\[logs\]"
    ):
        sepcal.read_log(tmp_path / name)


@pytest.mark.parametrize("kind", ["bin", "ulg"])
def test_damaged_bytes(tmp_path, kind, new_bin, new_ulg):
    """Whatever is spoiled, a flight or one line comes out."""
    whole = new_bin if kind == "bin" else new_ulg
    dice = random.Random(5)
    for trial in range(12):
        data = bytearray(whole)
        first = 0 if trial % 2 else len(data) // 20
        for _ in range(dice.choice((1, 5, 50))):
            at = dice.randrange(first, len(data))
            data[at] = dice.randrange(256)
        name = place(tmp_path, f"a.{kind}", bytes(data))
        with contextlib.suppress(sepcal.Error):
            assert sepcal.read_log(tmp_path / name, cut_off=True, field=False).rows > 0


def test_a_damaged_format_is_said_on_one_line(tmp_path, new_bin):
    name = place(tmp_path, "a.bin", new_bin.replace(b"QNff\0", b"QN\nf\0"))
    refuse(tmp_path, name, "-o", "f.csv", words=["pymavlink can't read it", "format char: '?'"])
