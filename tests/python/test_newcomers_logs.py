# SPDX-License-Identifier: BSD-3-Clause
"""Logs of a newcomer's own form reach a first fit, by what is said of them where need be."""

import re
import shlex
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from apps import Outcome, run

KNOT = 1852 / 3600
SCALE, OFFSET, WIND = 0.95, -0.6, (3.0, -2.0)
ROWS = 400


def fly() -> dict[str, np.ndarray]:
    """Turns in a wind, at 2 Hz: a tube that reads z = s_va |V - W| + c_va with noise."""
    draw = np.random.default_rng(11)
    time = np.arange(ROWS) * 0.5
    course = time / 10
    speed = 18 + 3 * np.sin(time / 7)
    return {
        "time": time,
        "north": speed * np.cos(course) + WIND[0],
        "east": speed * np.sin(course) + WIND[1],
        "read": SCALE * speed + OFFSET + draw.normal(0, 0.1, ROWS),
        "course": course,
    }


def write(
    file: Path, headers: str, row: Callable[[dict[str, float]], str], above: str = ""
) -> None:
    flown = fly()
    rows = [{name: float(column[i]) for name, column in flown.items()} for i in range(ROWS)]
    file.write_text(f"{headers}\n{above}" + "".join(f"{row(at)}\n" for at in rows))


def velocity(at: dict[str, float], unit: float = 1.0) -> str:
    return f"{at['north'] / unit:.4f},{at['east'] / unit:.4f},0"


def fit(folder: Path, *options: str) -> Outcome:
    return run("sepcal-pitot", "fit", "log.csv", *options, "--json", folder=folder)


def assert_true(fitted: Outcome) -> None:
    assert fitted.code == 0, fitted.err
    values = {name: entry["value"] for name, entry in fitted.result["parameters"].items()}
    assert abs(values["s_va"] - SCALE) < 0.02
    assert abs(values["w_n"] - WIND[0]) < 0.1
    assert abs(values["w_e"] - WIND[1]) < 0.1


def advised(said: str) -> list[str]:
    """The option that a message advises, as it is typed."""
    found = re.search(r"--map (\S+) reads it", said)
    assert found, said
    return ["--map", *shlex.split(found.group(1))]


def advised_of_all(said: str) -> list[str]:
    """The same, of several columns."""
    found = re.search(r"--map ('[^']*'|\S+) reads them so", said)
    assert found, said
    return ["--map", *shlex.split(found.group(1))]


@pytest.mark.parametrize(
    ("headers", "clock"),
    [
        ("time_s,GPS_N,GPS_E,GPS_D,AIRSPD", lambda at: str(at["time"])),
        ("Time_s,VN,VE,VD,TAS", lambda at: f"{at['time']:.1f}"),
        ("time_s,GPS_N (m/s),GPS_E (m/s),GPS_D (m/s),airspeed_mps", lambda at: str(at["time"])),
        ("timestamp,GPS N,GPS E,GPS D,true airspeed", lambda at: f"{1e6 * at['time']:.0f}"),
        ("t,vel_n,vel_e,vel_d,ias", lambda at: f"{1000 * at['time']:.0f}"),
        ("Time,/v/v-north-mps,/v/v-east-mps,/v/v-down-mps,/air/speed,TAS_mps",
         lambda at: f"{at['time']:.1f}"),
    ],
)  # fmt: skip
def test_one_option_for_all_columns(
    headers: str, clock: Callable[[dict[str, float]], str], tmp_path: Path
) -> None:
    """One line, and what it advises reads the log: units by the steps of time."""
    unread = ",0" * (headers.count(",") - 4)
    write(
        tmp_path / "log.csv",
        headers,
        lambda at: f"{clock(at)},{velocity(at)}{unread},{at['read']:.4f}",
    )
    refused = fit(tmp_path)
    assert refused.code == 2
    assert_true(fit(tmp_path, *advised_of_all(refused.err)))


def test_units_of_a_magnetometer_and_its_angles(tmp_path: Path) -> None:
    """Gauss by the Earth's field, degrees by a turn."""
    draw = np.random.default_rng(3)
    rows = ["timestamp,MagX,MagY,MagZ,Roll,Pitch,Yaw"]
    for row in range(400):
        roll, pitch, yaw = draw.uniform((-3, -1.5, -3), (3, 1.5, 3))
        (cr, cp, cy), (sr, sp, sy) = np.cos((roll, pitch, yaw)), np.sin((roll, pitch, yaw))
        to_body = np.array(
            [[cp * cy, cp * sy, -sp],
             [sr * sp * cy - cr * sy, sr * sp * sy + cr * cy, sr * cp],
             [cr * sp * cy + sr * sy, cr * sp * sy - sr * cy, cr * cp]]
        )  # fmt: skip
        read = to_body @ (19.7, -1.4, 49.4) + (12, -7, 5) + draw.normal(0, 0.1, 3)
        cells = [*(read / 100), *np.degrees((roll, pitch, yaw))]
        rows.append(f"{50_000_000 + 100_000 * row}," + ",".join(f"{cell:.6f}" for cell in cells))
    (tmp_path / "log.csv").write_text("\n".join(rows) + "\n")
    options = ["fit", "log.csv", "--field", "19.7,-1.4,49.4", "--json"]
    for _ in range(4):
        fitted = run("sepcal-mag", *options, folder=tmp_path)
        if fitted.code != 2:
            break
        found = re.search(r"--map (\S+) reads (it|them)", fitted.err)
        assert found, fitted.err
        options += ["--map", found.group(1)]
    assert fitted.code == 0, fitted.err
    assert options.count("--map") <= 2
    values = {name: entry["value"] for name, entry in fitted.result["parameters"].items()}
    assert abs(values["n_x"] - 12) < 0.1
    assert abs(values["n_y"] + 7) < 0.1


def test_names_with_units_come_before_short_ones(tmp_path: Path) -> None:
    """Garmin's G3X has two lines of names, of which the upper one says the units."""
    write(
        tmp_path / "log.csv",
        '#airframe_info,log_version="1.03",product="GDU 460"\n'
        "UTC Time (s),GPS Velocity N (m/s),GPS Velocity E (m/s),GPS Velocity D (m/s),"
        "True Airspeed (kt)",
        lambda at: f"{at['time']},{velocity(at)},{at['read'] / KNOT:.5f}",
        "UTC Time,GPSVelN,GPSVelE,GPSVelD,TAS\n",
    )
    assert_true(fit(tmp_path))


def seconds(at: dict[str, float]) -> str:
    return f"{345600 + at['time']:.1f}"


def milliseconds(at: dict[str, float]) -> str:
    return f"{1000 * (345600 + at['time']):.0f}"


def packed(at: dict[str, float]) -> str:
    return f"{101430 + at['time'] // 60 * 100 + at['time'] % 60:.1f}"


def points(at: dict[str, float]) -> str:
    since = 600 + at["time"]
    return f"10.{int(since // 60):02d}.{since % 60:04.1f}"


def iso(at: dict[str, float]) -> str:
    return f"2024-05-04T10:{int(at['time'] // 60):02d}:{at['time'] % 60:06.3f}Z"


@pytest.mark.parametrize(
    ("headers", "clock", "told"),
    [
        ("tow,week", lambda at: seconds(at) + ",2300", "tow and week, taken for seconds"),
        ("tow,week", lambda at: milliseconds(at) + ",2300", "taken for milliseconds"),
        ("tow", seconds, "time is tow, taken for seconds"),
        ("UTC", points, "time is from 'UTC', a time of day"),
    ],
)
def test_clocks(
    headers: str, clock: Callable[[dict[str, float]], str], told: str, tmp_path: Path
) -> None:
    write(
        tmp_path / "log.csv",
        f"{headers},vn_mps,ve_mps,vd_mps,airspeed_mps",
        lambda at: f"{clock(at)},{velocity(at)},{at['read']:.4f}",
    )
    fitted = fit(tmp_path)
    assert_true(fitted)
    assert told in fitted.err


@pytest.mark.parametrize(
    ("header", "clock", "above"),
    [
        ("Elapsed Time (min)", lambda at: f"{at['time'] / 60:.6f}", ""),
        ("Uhrzeit", points, ""),
        ("GPS Time", iso, ""),
        ("Time", lambda at: f"{1000 * at['time']:.0f}", "ms,m/s,m/s,m/s,m/s\n"),
    ],
)
def test_apply_keeps_the_name_of_time(
    header: str, clock: Callable[[dict[str, float]], str], above: str, tmp_path: Path
) -> None:
    """And its cells, so that the corrected log is read as the log is."""
    write(
        tmp_path / "log.csv",
        f"{header},vn_mps,ve_mps,vd_mps,airspeed_mps",
        lambda at: f"{clock(at)},{velocity(at)},{at['read']:.4f}",
        above,
    )
    fitted = run("sepcal-pitot", "fit", "log.csv", "-o", "base.json", folder=tmp_path)
    assert fitted.code == 0, fitted.err
    applied = run("sepcal-pitot", "apply", "log.csv", "base.json", "-o", "out.csv", folder=tmp_path)
    assert applied.code == 0, applied.err
    log = (tmp_path / "log.csv").read_text().splitlines()
    out = (tmp_path / "out.csv").read_text().splitlines()
    name = f"{header} (ms)" if above else header
    assert out[0].split(",")[0] == name
    first = 2 if above else 1
    assert [row.split(",")[0] for row in out[1:]] == [row.split(",")[0] for row in log[first:]]
    again = run("sepcal-pitot", "fit", "out.csv", "--json", folder=tmp_path)
    assert_true(again)


def test_a_packed_clock(tmp_path: Path) -> None:
    """It begins at half a minute: 29 s of the first one are not there."""
    write(
        tmp_path / "log.csv",
        "hhmmss,vn_mps,ve_mps,vd_mps,airspeed_mps",
        lambda at: f"{packed(at | {'time': at['time'] / 20})},{velocity(at)},{at['read']:.4f}",
    )
    fitted = fit(tmp_path)
    assert_true(fitted)
    assert "'hhmmss', a time of day as HHMMSS" in fitted.err


def test_a_time_of_week_of_slow_rows_is_asked_about(tmp_path: Path) -> None:
    write(
        tmp_path / "log.csv",
        "tow,vn_mps,ve_mps,vd_mps,airspeed_mps",
        lambda at: f"{1000 * at['time']:.0f},{velocity(at)},{at['read']:.4f}",
    )
    refused = fit(tmp_path)
    assert refused.code == 2
    assert "'tow' is a time of week without its unit" in refused.err
    assert_true(fit(tmp_path, *advised(refused.err)))
    assert_true(fit(tmp_path, "--map", "gps_tow_ms=tow"))


def test_speed_over_ground_in_another_unit(tmp_path: Path) -> None:
    write(
        tmp_path / "log.csv",
        "time_s,gs_kt,track_deg,vd_mps,airspeed_mps",
        lambda at: (
            f"{at['time']},{np.hypot(at['north'], at['east']):.4f},"
            f"{np.degrees(np.arctan2(at['east'], at['north'])) % 360:.4f},0,{at['read']:.4f}"
        ),
    )
    warned = fit(tmp_path)
    assert "mps under the header gs_kt" in warned.err
    assert "--map gs_mps=gs_kt reads it so" in warned.err
    assert_true(fit(tmp_path, "--map", "gs_mps=gs_kt"))


def test_cells_in_two_units(tmp_path: Path) -> None:
    def airspeed(at: dict[str, float]) -> str:
        late = at["time"] > 150
        return f"{at['read']:.4f} m/s" if late else f"{at['read'] / KNOT:.4f} kt"

    write(
        tmp_path / "log.csv",
        "time_s,vn_mps,ve_mps,vd_mps,airspeed",
        lambda at: f"{at['time']},{velocity(at)},{airspeed(at)}",
    )
    refused = fit(tmp_path)
    assert refused.code == 2
    assert len(refused.err.splitlines()) == 1
    assert "'airspeed_kt' holds" in refused.err
    assert "m/s', with a unit of its own" in refused.err
    assert_true(fit(tmp_path, "--drop-invalid"))


def test_a_column_without_numbers(tmp_path: Path) -> None:
    write(
        tmp_path / "log.csv",
        "time_s,vn_mps,ve_mps,vd_mps,airspeed_mps,other",
        lambda at: f"{at['time']},{velocity(at)},off,{at['read']:.4f}",
    )
    for options in ((), ("--drop-invalid",)):
        refused = fit(tmp_path, *options)
        assert refused.code == 2
        assert "--drop-invalid" not in refused.err
        assert (
            "line 2: column 'airspeed_mps' holds 'off', not a finite number, and has none in any "
            f"of {ROWS} rows; --map reads it from another column"
        ) in refused.err
    assert_true(fit(tmp_path, "--map", "airspeed_mps=other", "--ignore", "airspeed_mps"))


def test_a_yaw_that_counts_its_turns(tmp_path: Path) -> None:
    write(
        tmp_path / "log.csv",
        "time_s,vn_mps,ve_mps,vd_mps,airspeed_mps,roll_rad,pitch_rad,yaw_rad",
        lambda at: f"{at['time']},{velocity(at)},{at['read']:.4f},0,0,{at['course']:.5f}",
    )
    fitted = fit(tmp_path)
    assert_true(fitted)
    assert "yaw_rad" not in fitted.err
