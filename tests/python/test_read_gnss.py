# SPDX-License-Identifier: BSD-3-Clause
"""IGC and NMEA, written by aerofiles and pynmea2, and by hand where these can't."""

import datetime

import numpy as np
import pytest

import sepcal
from refusals import refuse

KMH = 3.6
NIGHT = datetime.datetime(2026, 3, 1, 23, 55)
ROWS = 600
WIND = (-4.0, 2.5)
SCALE = 0.95
EXTENSIONS = [("FXA", 3), ("TAS", 5), ("GSP", 5), ("TRT", 3), ("OAT", 5), ("VAT", 4)]


def fly():
    """Circles in a wind, 1 Hz: true airspeed as read (n,), velocity over the ground, positions."""
    time = np.arange(ROWS, dtype=float)
    speed, course = 30 + 5 * np.sin(time / 40), time / 25
    north = np.cumsum(speed * np.cos(course) + WIND[0])
    east = np.cumsum(speed * np.sin(course) + WIND[1])
    velocity = np.stack([np.gradient(north), np.gradient(east)])
    air = velocity - np.array(WIND)[:, None]
    read = np.hypot(*air) / SCALE
    return {
        "time": time,
        "read": read,
        "velocity": velocity,
        "latitude": 47.0 + north / 111_194.9,
        "longitude": -8.5 + east / (111_194.9 * np.cos(np.radians(47.0))),
        "altitude": 1000 + 20 * np.sin(time / 60),
    }


def stamp(row, start=NIGHT, step=1.0):
    return start + datetime.timedelta(seconds=row * step)


@pytest.fixture(scope="module")
def flown():
    return fly()


@pytest.fixture
def igc(flown, tmp_path):
    """The flight as a recorder writes it: LX's five digits of km/h."""
    aerofiles = pytest.importorskip("aerofiles.igc")
    file = tmp_path / "a.igc"
    with open(file, "wb") as opened:
        writer = aerofiles.Writer(opened)
        words = (
            "pilot copilot glider_type glider_id firmware_version hardware_version logger_type "
            "gps_receiver pressure_sensor competition_id competition_class"
        )
        writer.write_headers(
            {
                **{"manufacturer_code": "XCS", "logger_id": "TBX", "fix_accuracy": 50},
                **dict.fromkeys(words.split(), "x"),
                "date": NIGHT.date(),
            }
        )
        writer.write_fix_extensions(EXTENSIONS)
        speed = np.hypot(*flown["velocity"]) * KMH
        track = np.degrees(np.arctan2(flown["velocity"][1], flown["velocity"][0])) % 360
        for row in range(ROWS):
            writer.write_fix(
                stamp(row).time(),
                latitude=flown["latitude"][row],
                longitude=flown["longitude"][row],
                valid=row != 7,
                pressure_alt=int(flown["altitude"][row]) - 1010,
                gps_alt=int(flown["altitude"][row]),
                extensions=[
                    "012",
                    f"{round(flown['read'][row] * KMH * 100):05d}",
                    f"{round(speed[row] * 100):05d}",
                    f"{int(track[row]):03d}",
                    f"{-35 if row < 9 else 125:05d}",
                    "-012",
                ],
            )
    return file


def test_igc_gives_what_was_flown(igc, flown):
    flight = sepcal.read(igc)
    kept = np.arange(ROWS) != 7  # which had no fix
    np.testing.assert_array_equal(flight["time_s"], 86100 + flown["time"][kept])
    for header, values, error in (
        ("lat_deg", flown["latitude"], 0.5e-3 / 60),
        ("lon_deg", flown["longitude"], 0.5e-3 / 60),
        ("altitude_m", flown["altitude"].astype(int), 0),
        ("pressure_altitude_m", flown["altitude"].astype(int) - 1010, 0),
        ("airspeed_kmh", flown["read"] * KMH, 0.005),
        ("gs_kmh", np.hypot(*flown["velocity"]) * KMH, 0.005),
    ):
        np.testing.assert_allclose(flight[header], values[kept], rtol=0, atol=error + 1e-9)
    assert flight["temp_degc"][[0, -1]].tolist() == [-3.5, 12.5]
    assert flight["vat_mps"][0] == pytest.approx(-1.2)
    assert flight["fxa_m"][0] == 12
    notes = " ".join(flight.notes)
    for words in (
        "since 2026-03-01 00:00 UTC",
        "1 B records without a 3D fix (V)",
        "TAS as airspeed_kmh",
    ):
        assert words in notes


def test_a_tube_is_calibrated_from_an_igc_file(igc):
    """Scale and wind, from the airspeed and positions in thousandths of minutes alone."""
    fitted = sepcal.fit(sepcal.PitotStatic(), igc, ignore=["gs_kmh", "track_deg"])
    truth = {"s_va": SCALE, "w_n": WIND[0], "w_e": WIND[1]}
    for name, value in truth.items():
        assert fitted[name].value == pytest.approx(value, abs=0.25), name
    assert any("rows" in note or "B records" in note for note in fitted.notes)


def test_igc_by_hand(tmp_path):
    """Three whole digits of km/h; further digits of time and place; a repeat; a cut last line."""
    lines = [
        "AXXX001",
        "HFDTEDATE:280226,01",
        "I073638TAS3941IAS4242LAD4343LOD4444TDS4547OAT4850ZZZ",
        "B1200004730000S00815000WA0100001010120099550-05007",
        "B1200004730000S00815000WA0100001010121100556-05008",
        "B1200004730000S00815000WA0100001010121100556-05008",
        "B1200014730000S00815000WA-0100-010112210155x-05009",
        "B120002473",
    ]
    (tmp_path / "a.igc").write_text("\r\n".join(lines))
    flight = sepcal.read(tmp_path / "a.igc")
    assert flight["time_s"].tolist() == [43200.0, 43200.6, 43201.0]
    assert flight["temp_degc"].tolist() == [-5.0, -5.0, -5.0]
    assert flight["ZZZ"].tolist() == [7.0, 8.0, 9.0]
    assert flight["airspeed_kmh"].tolist() == [120.0, 121.0, 122.0]
    assert flight["ias_kmh"].tolist() == [99.0, 100.0, 101.0]
    assert flight["lat_deg"][0] == pytest.approx(-(47 + 30.0005 / 60), abs=1e-12)
    assert flight["lon_deg"][0] == pytest.approx(-(8 + 15.0005 / 60), abs=1e-12)
    assert flight["altitude_m"].tolist() == [1010.0, 1010.0, -101.0]
    notes = " ".join(flight.notes)
    assert "1 B records whose time repeats" in notes
    assert "1 B records that are damaged" in notes


def checked(body):
    total = 0
    for letter in body:
        total ^= ord(letter)
    return f"${body}*{total:02X}"


@pytest.fixture
def nmea(flown, tmp_path):
    """Two talkers, 2 Hz across midnight, GP with every other epoch, and a broken line."""
    pynmea2 = pytest.importorskip("pynmea2")
    lines = ["$GPTXT,01,01,02,u-blox*00", "garbage"]
    for row in range(100):
        moment = stamp(row, NIGHT + datetime.timedelta(seconds=280), 0.5)
        time, date = moment.strftime("%H%M%S.%f")[:9], moment.strftime("%d%m%y")
        place = ("4730.12345", "S", "00815.5000", "W")
        knots, track = f"{20 + row / 8:.3f}", f"{(350 + row) % 360:.1f}"
        for talker in ("GN", "GP")[: 1 + (row % 2)]:
            rmc = (time, "A", *place, knots, track, date, "", "")
            gga = (time, *place, "1", "08", "0.9", f"{500 + row}.0", "M", "46.9", "M", "", "")
            vtg = (track, "T", "", "M", knots, "N", "", "K")
            lines.append(str(pynmea2.GGA(talker, "GGA", gga)))
            lines.append("2026-03-01 log: " + str(pynmea2.RMC(talker, "RMC", rmc)))
            lines.append(str(pynmea2.VTG(talker, "VTG", vtg)))
    lines[10] = lines[10].replace("47", "48", 1)
    (tmp_path / "a.txt").write_text("\r\n".join(lines) + "\r\n$GNRMC,2359")
    return tmp_path / "a.txt"


def test_nmea_gives_what_was_sent(nmea):
    flight = sepcal.read(nmea)
    assert list(flight) == ["time_s", "lat_deg", "lon_deg", "altitude_m", "gs_kt", "track_deg"]
    rows = np.arange(100)
    np.testing.assert_array_equal(flight["time_s"], 86380 + rows / 2)
    np.testing.assert_allclose(flight["lat_deg"], -(47 + 30.12345 / 60), rtol=0, atol=1e-12)
    np.testing.assert_allclose(flight["lon_deg"], -(8 + 15.5 / 60), rtol=0, atol=1e-12)
    np.testing.assert_allclose(flight["gs_kt"], 20 + rows / 8, atol=1e-9)
    np.testing.assert_array_equal(flight["track_deg"], (350 + rows) % 360)
    known = np.isfinite(flight["altitude_m"])
    np.testing.assert_array_equal(flight["altitude_m"][known], 500 + rows[known])
    notes = " ".join(flight.notes)
    for words in (
        "since 2026-03-01 00:00 UTC, of talker GN",
        "talkers GP are left out",
        "checksum",
    ):
        assert words in notes


def test_vtg_gives_speed_where_rmc_is_not_sent(tmp_path):
    lines = [
        checked("GPGGA,120000,4730.0,N,00815.0,E,1,08,0.9,500,M,46,M,,"),
        checked("GPVTG,084.4,T,081.3,M,,N,37.04,K,A"),
        checked("GPGGA,120001,4730.0,N,00815.0,E,0,00,,,M,,M,,"),
        checked("GPGGA,120002,4730.0,N,00815.0,E,1,08,0.9,501,M,46,M,,"),
    ]
    (tmp_path / "a.nmea").write_text("\n".join(lines))
    flight = sepcal.read(tmp_path / "a.nmea")
    assert flight["time_s"].tolist() == [43200.0, 43202.0]
    assert flight["gs_kt"][0] == pytest.approx(20.0)
    assert flight["track_deg"][0] == 84.4
    assert any("1 epochs without a position" in note for note in flight.notes)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("AXXX001\nHFDTE010326\nLXXX nothing\n", "no B record"),
        (checked("GPRMC,120000,V,,,,,,,010326,,") + "\n", "no RMC or GGA sentence"),
        ("$GPRMC,120000,A,4730.0,N,00815.0,E,1,2,010326,,*00\n", "no RMC or GGA sentence"),
    ],
)
def test_files_without_a_position(text, words, tmp_path):
    (tmp_path / "a.log").write_text(text)
    refuse(lambda: sepcal.read(tmp_path / "a.log"), "a.log", words)
