# SPDX-License-Identifier: BSD-3-Clause
"""python -m sepcal field and earth_field(), against published values of the model."""

import datetime
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal
from oracle.world_magnetic_model import evaluate
from sepcal.geomagnetism import models

pygeomag = pytest.importorskip("pygeomag")

# Year, height [km], latitude, longitude [deg]; north, east, down [nT]: the tables of test values in
# NOAA's and BGS' technical reports on WMM2010, WMM2015 (version 2), WMM2020 and WMM2025.
PUBLISHED = [
    (2010.0, 0, 80, 0, 6649.5, -714.6, 54346.2),
    (2010.0, 100, 0, 120, 37452.0, 611.9, -11180.8),
    (2012.5, 0, -80, 240, 5713.6, 15731.8, -53184.3),
    (2015.0, 0, 80, 0, 6636.6, -451.9, 54408.9),
    (2015.0, 0, 0, 120, 39521.1, 377.7, -11228.8),
    (2017.5, 100, -80, 240, 5674.9, 14793.1, -50179.5),
    (2020.0, 0, 80, 0, 6570.4, -146.3, 54606.0),
    (2020.0, 0, 0, 120, 39624.3, 109.9, -10932.5),
    (2020.0, 100, -80, 240, 5744.9, 14799.5, -49969.4),
    (2022.5, 0, -80, 240, 6016.5, 15776.7, -52251.6),
    (2022.5, 100, 80, 0, 6224.0, -44.5, 52527.0),
    (2025.0, 0, 80, 0, 6521.6, 145.9, 54791.5),
    (2025.0, 0, 0, 120, 39677.8, -109.6, -10580.2),
    (2025.0, 0, -80, 240, 6117.5, 15751.9, -52022.5),
    (2025.0, 100, 80, 0, 6216.0, 92.4, 52598.8),
    (2025.0, 100, 0, 120, 37688.6, -96.2, -10152.1),
    (2025.0, 100, -80, 240, 5907.6, 14780.3, -49540.7),
    (2027.5, 0, 80, 0, 6500.8, 294.5, 54869.4),
    (2027.5, 0, 0, 120, 39701.6, -167.4, -10381.8),
    (2027.5, 0, -80, 240, 6200.7, 15730.3, -51783.7),
    (2027.5, 100, 80, 0, 6196.7, 233.8, 52670.5),
    (2027.5, 100, 0, 120, 37711.5, -148.7, -9969.8),
    (2027.5, 100, -80, 240, 5984.0, 14760.1, -49317.7),
]
NANOTESLA = 1e-3


def parts(field):
    return np.array([field.north, field.east, field.down])


@pytest.mark.parametrize("row", PUBLISHED, ids=lambda row: "_".join(f"{v:g}" for v in row[:4]))
def test_published_values(row):
    year, height, latitude, longitude, *expected = row
    field = sepcal.earth_field(latitude, longitude, 1000 * height, year)
    assert_allclose(parts(field), np.array(expected) * NANOTESLA, atol=0.1 * NANOTESLA)


@pytest.mark.parametrize("place", [(42.85, -2.64, 0.5), (-33.9, 151.2, 0.0), (64.1, -21.9, 30.0)])
@pytest.mark.parametrize("year", [2014.9, 2019.3, 2024.2, 2026.9])
def test_against_an_evaluation_written_anew(year, place):
    latitude, longitude, height = place
    field = sepcal.earth_field(latitude, longitude, 1000 * height, year)
    folder = Path(pygeomag.__file__).parent / "wmm"
    (file,) = folder.glob(f"{field.model.replace('-', '_')}.COF")
    expected = evaluate(file.read_text(), year, latitude, longitude, height)
    assert_allclose(parts(field), expected * NANOTESLA, atol=0.2 * NANOTESLA)


def test_what_it_says_of_itself():
    field = sepcal.earth_field(80, 0, 0, 2020.0)
    assert field.model == "WMM-2020"
    assert_allclose(field.strength, 55.0001, atol=1e-4)
    assert_allclose(field.declination, -1.28, atol=0.005)
    assert_allclose(field.inclination, 83.14, atol=0.005)


@pytest.mark.parametrize(
    ("date", "year"),
    [
        (datetime.date(2020, 1, 1), 2020.0),
        (datetime.date(2020, 7, 2), 2020.5),
        (datetime.datetime(2021, 7, 2, 12, tzinfo=datetime.UTC), 2021.5),
        ("2020-07-02", 2020.5),
        ("2020.5", 2020.5),
        (2020.5, 2020.5),
    ],
)
def test_dates(date, year):
    assert_allclose(sepcal.earth_field(0, 0, 0, date).year, year, atol=1e-9)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ((91, 0, 0, 2020), "latitude of 91 deg is off the Earth"),
        ((0, 400, 0, 2020), "longitude of 400 deg is off the Earth"),
        ((0, 0, 1e7, 2020), "altitude of 1e\\+07 m is outside the model"),
        ((0, 0, 0, 2009.99), "year 2009 is outside the field models here, 2010 to"),
        ((0, 0, 0, 2030.0), "year 2030 is outside .* brings newer ones"),
        ((0, 0, 0, "1.3.2020"), "'1.3.2020' is no date; write it as 2026-03-01"),
        ((0, 0, 0, float("nan")), "nan is no year"),
    ],
)
def test_refusals(call, words):
    with pytest.raises(sepcal.Error, match=words):
        sepcal.earth_field(*call)


def test_an_expired_model_is_said():
    assert models.warn_of_age(datetime.date(2026, 1, 1)) == ""
    assert "WMM-2025, ended with 2029" in models.warn_of_age(datetime.date(2030, 1, 1))


def test_without_pygeomag(monkeypatch):
    models._model_of.cache_clear()
    monkeypatch.setitem(sys.modules, "pygeomag", None)
    with pytest.raises(sepcal.Error, match=r"needs pygeomag.*pip install sepcal\[logs\]"):
        sepcal.earth_field(0, 0, 0, 2020)


def run(*arguments):
    command = [sys.executable, "-m", "sepcal", "field", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


PLACE = ("--lat", "80", "--lon", "0")


def test_the_command():
    done = run(*PLACE, "--altitude", "0", "--date", "2020-01-01")
    assert (done.returncode, done.stderr) == (0, "")
    first, angles, field, strength = done.stdout.splitlines()
    assert first == "WMM-2020 at 80.0000 N, 0.0000 E, 0 m, year 2020.000"
    assert angles == "declination -1.28 deg, inclination 83.14 deg"
    assert field == "--field 6.5704,-0.1463,54.6060"
    assert strength == "--field-strength 55.0001"


def test_the_command_in_the_southwest():
    done = run("--lat", "-80", "--lon", "240", "--date", "2025.0")
    assert done.stdout.startswith("WMM-2025 at 80.0000 S, 120.0000 W, 0 m")


def test_json():
    done = run(*PLACE, "--date", "2020-01-01", "--json")
    told = json.loads(done.stdout)
    assert_allclose(told["down_ut"], 54.6060, atol=1e-4)
    assert told["model"] == "WMM-2020"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (PLACE, "required: --date"),
        (("--lat", "80", "--date", "2020"), "required: --lon"),
        ((*PLACE, "--date", "2031-01-01"), "year 2031 is outside"),
        ((*PLACE, "--date", "yesterday"), "'yesterday' is no date"),
        (("--lat", "95", "--lon", "0", "--date", "2020"), "latitude of 95 deg"),
    ],
)
def test_bad_usage(arguments, words):
    done = run(*arguments)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert words in done.stderr
