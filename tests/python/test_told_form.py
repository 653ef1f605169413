# SPDX-License-Identifier: BSD-3-Clause
"""A table that can be read in two ways: the fit is told how, and what comes after remembers it."""

from pathlib import Path

import numpy as np
import pytest

import sepcal
from refusals import refuse
from sepcal.__main__ import main

TURN = np.concatenate([np.linspace(0.3, 1.2, 60), np.linspace(1.9, 2.8, 60)])
SPEED = 20.0 + 3.0 * np.sin(0.3 * np.arange(120.0))
COLUMNS = {
    "time_s": 1.0 + 0.5 * np.arange(120),
    "airspeed_mps": SPEED + 0.1 * np.sin(9.0 * np.arange(120.0)),
    "vn_mps": SPEED * np.cos(TURN) + 3.0,
    "ve_mps": SPEED * np.sin(TURN) - 2.0,
    "vd_mps": np.full(120, 1.5),
}
TOLD = {"delimiter": ";", "decimal": ","}


def write(folder: Path, name: str = "log.csv", later: float = 0.0) -> Path:
    """1,500 in every cell may be one and a half, or fifteen hundred."""
    file = folder / name
    columns = COLUMNS | {"time_s": COLUMNS["time_s"] + later}
    rows = zip(*columns.values(), strict=True)
    lines = [";".join(f"{number:.3f}".replace(".", ",") for number in row) for row in rows]
    file.write_text("\n".join([";".join(COLUMNS), *lines]) + "\n")
    return file


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return write(tmp_path)


@pytest.fixture
def base(log: Path) -> sepcal.Calibration:
    refuse(lambda: sepcal.fit(sepcal.PitotStatic(), log), "decimal ','", "decimal '.'")
    sepcal.fit(sepcal.PitotStatic(), log, **TOLD).save(log.with_suffix(".json"))
    loaded = sepcal.load(log.with_suffix(".json"))
    assert isinstance(loaded, sepcal.Calibration)
    return loaded


def test_later_verbs_read_as_the_fit_did(base: sepcal.Calibration, log: Path) -> None:
    clean = sepcal.Flight({name: values.round(3) for name, values in COLUMNS.items()})
    assert base.compare(log).overall[0].rmse == base.compare(clean).overall[0].rmse
    assert np.array_equal(
        base.apply(log)["airspeed_cal_mps"], base.apply(clean)["airspeed_cal_mps"]
    )
    assert len(base.residuals(log)["why_not"]) == 120
    assert base.predict(log).value.shape == (120, 1)
    assert base.export(log.with_suffix(".h"), "c", flight=log).notes == []
    assert base.diagnose(log, only=["time_offset"], simulations=2).effects[0].name == "time_offset"


def test_a_file_of_another_form_has_no_such_marks(base: sepcal.Calibration, tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    pandas.DataFrame(COLUMNS).to_parquet(tmp_path / "log.parquet")
    assert base.compare(tmp_path / "log.parquet").overall[0].rows == 120


def test_what_is_asked_before_and_of_several(log: Path, tmp_path: Path) -> None:
    tube, other = sepcal.PitotStatic(), write(tmp_path, "other.csv", later=100.0)
    assert sepcal.check(tube, log, **TOLD).refused == ""
    refuse(lambda: sepcal.check(tube, log), "decimal ','")
    joint = sepcal.fit_jointly(tube, [log, other], **TOLD)
    assert joint.rows == 240
    assert joint.join([log, other]).rows == 240
    assert sepcal.fit_many(tube, [log, other], **TOLD).rows == 240


def test_a_path_and_its_later_verbs(tmp_path: Path) -> None:
    flown = sepcal.datasets.load("aircraft")
    flown.to_csv(tmp_path / "log.csv")
    semicolons = (tmp_path / "log.csv").read_text().replace(",", ";").replace(".", ",")
    (tmp_path / "log.csv").write_text(semicolons)
    path = sepcal.fit(sepcal.FlightPath(), tmp_path / "log.csv", **TOLD)
    assert path.rows == flown.rows
    assert path.compare(tmp_path / "log.csv").overall[0].rows == flown.rows


def test_the_report_of_a_log_of_its_own_form(log: Path, tmp_path: Path, capfd) -> None:
    """What one line advises is an option that the command has."""
    pytest.importorskip("plotly")
    clean = sepcal.Flight({name: values.round(3) for name, values in COLUMNS.items()})
    sepcal.fit(sepcal.PitotStatic(), clean).save(tmp_path / "plain.json")
    words = ["report", str(log), str(tmp_path / "plain.json"), "-o", str(tmp_path / "r.html")]
    assert main(words) == 2
    assert "say --decimal ','" in capfd.readouterr().err
    assert main([*words, "--decimal", ","]) == 0
    assert (tmp_path / "r.html").is_file()


def test_the_report_reads_as_the_fit_did(base: sepcal.Calibration, log: Path) -> None:
    pytest.importorskip("plotly")
    base.report(log.with_suffix(".html"), log)
    words = ["report", str(log), str(log.with_suffix(".json")), "-o", str(log.with_suffix(".htm"))]
    assert main(words) == 0
