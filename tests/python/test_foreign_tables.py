# SPDX-License-Identifier: BSD-3-Clause
"""Recorded logs under foreign names, units and clocks are calibrated by options alone.

The result is that of the clean file. recorded.py says where the logs are; skipped where they are
not.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from apps import Log, run
from recorded import find_fixture

FOOT, KNOT = 0.3048, 1852 / 3600


@dataclass(frozen=True)
class Foreign:
    """A clean log's name, and each foreign column: its own name, the clean one, and its unit.

    A foreign number is the clean one times `scale` plus `offset`.
    """

    app: str
    file: str
    columns: dict[str, tuple[str, float, float]]
    maps: str
    options: tuple[str, ...] = ()
    foreign_options: tuple[str, ...] = ()


TABLES = [
    Foreign(
        "sepcal-pitot",
        "uav_pitot_static_2022_05_07_11.csv",
        {
            "Timestamp [ms]": ("time_s", 1000.0, 51_230_000.0),
            "V_north": ("vn_mps", 1 / KNOT, 0.0),
            "V_east": ("ve_mps", 1 / KNOT, 0.0),
            "climb": ("vd_mps", -60 / FOOT, 0.0),
            "TAS": ("airspeed_mps", 1 / KNOT, 0.0),
        },
        "time_ms=Timestamp [ms],vn_kt=V_north,ve_kt=V_east,vu_fpm=climb,airspeed_kt=TAS",
    ),
    Foreign(
        "sepcal-pitot",
        "airliner_mode_s.csv",
        {
            "t": ("time_s", 1e6, 1.4e15),
            "gs_n": ("vn_mps", 3.6, 0.0),
            "gs_e": ("ve_mps", 3.6, 0.0),
            "sink": ("vd_mps", 1 / FOOT, 0.0),
            "TAS (kn)": ("airspeed_mps", 1 / KNOT, 0.0),
            "alt": ("altitude_m", 1 / FOOT, 0.0),
        },
        "time_us=t,vn_kmh=gs_n,ve_kmh=gs_e,vd_ftps=sink,airspeed_kt=TAS (kn),altitude_ft=alt",
        ("--where", "altitude_m < 9000"),
        ("--where", f"altitude_ft < {9000 / FOOT}"),
    ),
    Foreign(
        "sepcal-pitot",
        "rv_deceleration_stall.csv",
        {
            "clock": ("time_s", 1000.0, 0.0),
            "vel0": ("vn_mps", 1 / FOOT, 0.0),
            "vel1": ("ve_mps", 1 / FOOT, 0.0),
            "vel2": ("vd_mps", 1 / FOOT, 0.0),
            "ias": ("airspeed_mps", 3.6, 0.0),
            "vn": ("boom_alpha_counts", 1.0, 0.0),  # a word that sepcal knows, for something else
        },
        "time_ms=clock,vn_ftps=vel0,ve_ftps=vel1,vd_ftps=vel2,airspeed_kmh=ias",
        (),
        ("--ignore", "vn"),
    ),
    Foreign(
        "sepcal-mag",
        "octocopter_external_mag.csv",
        {
            "sec": ("time_s", 1.0, 0.0),
            "MagX": ("mx_gauss", 1e5, 0.0),
            "MagY": ("my_gauss", 1e5, 0.0),
            "MagZ": ("mz_gauss", 1e5, 0.0),
            "Roll": ("roll_rad", 180 / np.pi, 0.0),
            "Pitch": ("pitch_rad", 180 / np.pi, 0.0),
            "Yaw": ("yaw_rad", 180 / np.pi, 0.0),
        },
        "time_s=sec,mx_nt=MagX,my_nt=MagY,mz_nt=MagZ,roll_deg=Roll,pitch_deg=Pitch,yaw_deg=Yaw",
        ("--field", "19.72,-1.41,49.44"),
        ("--field", "19.72,-1.41,49.44"),
    ),
    Foreign(
        "sepcal-mag",
        "bench_tilt_sphere_mag.csv",
        {
            "T": ("time_s", 1000.0, 0.0),
            "magnetometer x": ("mx_gauss", 1000.0, 0.0),
            "magnetometer y": ("my_gauss", 1000.0, 0.0),
            "magnetometer z": ("mz_gauss", 100.0, 0.0),
        },
        "time_ms=T,mx_mgauss=magnetometer x,my_mgauss=magnetometer y,mz_ut=magnetometer z",
        ("--field-strength", "48"),
        ("--field-strength", "48"),
    ),
]


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table.file)
def test_options_alone_calibrate_it(tmp_path: Path, table: Foreign) -> None:
    log = Log(find_fixture(table.file))
    columns = {
        name: log.column(clean) * scale + offset
        for name, (clean, scale, offset) in table.columns.items()
    }
    rows = np.column_stack(list(columns.values())).tolist()
    clean_rows = [log.column(clean).tolist() for clean, _, _ in table.columns.values()]
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
    (tmp_path / "foreign.csv").write_text("\n".join(lines) + "\n")
    headers = [clean for clean, _, _ in table.columns.values()]
    lines = [
        ",".join(headers),
        *(",".join(map(repr, row)) for row in zip(*clean_rows, strict=True)),
    ]
    (tmp_path / "clean.csv").write_text("\n".join(lines) + "\n")
    clean = run(table.app, "fit", "clean.csv", *table.options, "--json", folder=tmp_path)
    foreign = run(
        table.app, "fit", "foreign.csv", "--map", table.maps, *table.foreign_options, "--json",
        folder=tmp_path,
    )  # fmt: skip
    assert foreign.code == clean.code, foreign.err
    assert foreign.result["status"] == clean.result["status"]
    assert foreign.result["inputs"]["rows_used"] == clean.result["inputs"]["rows_used"]
    for name, entry in clean.result["parameters"].items():
        found = foreign.result["parameters"][name]
        error = entry["standard_error_white"] or 1.0
        assert abs(found["value"] - entry["value"]) < 1e-3 * error, name
