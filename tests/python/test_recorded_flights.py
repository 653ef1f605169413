# SPDX-License-Identifier: BSD-3-Clause
"""Recorded flights of magnetometers (recorded.py says where they are), and other files.

A magnetometer's C and n are a linear regression of m on [h, 1]: an answer that needs no sepcal.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from apps import FIVE_HOLE_OPTIONS, Log, Outcome, run, values_of
from oracle.closed_form import FieldMap, fit_field_map
from oracle.five_hole_probe import rotate_to_navigation
from oracle.magnetometer import compose
from oracle.model import Array
from recorded import FIXTURES, find_fixture

FIELD = np.array([19.72, -1.41, 49.44])  # north, east, down [uT]
GIVEN_FIELD = ("--field", "19.72,-1.41,49.44")


@dataclass(frozen=True)
class Regression:
    """m on [h, 1] for a log."""

    field_map: FieldMap
    residual: Array  # [uT], shape (N, 3)

    @property
    def rmse(self) -> Array:
        """By axis [uT], shape (3,)."""
        return np.sqrt(np.mean(self.residual**2, axis=0))


def regress(file: Path) -> Regression:
    log = Log(file)
    attitude = {name: log.column(f"{name}_rad") for name in ("roll", "pitch", "yaw")}
    body = np.einsum("kji,j->ki", rotate_to_navigation(attitude), FIELD)
    reading = np.stack([100 * log.column(f"m{axis}_gauss") for axis in "xyz"], axis=-1)
    columns = {"hx": body, "mx": reading}
    record = {
        f"{kind[0]}{axis}": values[:, i]
        for kind, values in columns.items()
        for i, axis in enumerate("xyz")
    }
    field_map = fit_field_map(record)
    return Regression(field_map, reading - body @ field_map.matrix.T - field_map.bias)


def fit_octocopter(name: str, folder: Path, *options: str) -> tuple[Outcome, Regression]:
    file = find_fixture(name)
    command = ("fit", file, *GIVEN_FIELD, "-o", "base.json", "--json", *options)
    fitted = run("sepcal-mag", *command, folder=folder)
    assert fitted.out == (folder / "base.json").read_text()
    return fitted, regress(file)


def test_external_magnetometer_is_its_regression(tmp_path: Path):
    """On its mast: no bound is active, so C recomposed and n are the regression's."""
    fitted, expected = fit_octocopter("octocopter_external_mag.csv", tmp_path)
    assert fitted.code == 0, fitted.err
    result = fitted.result
    assert result["inputs"]["rows_used"] == expected.residual.shape[0] == 3094
    assert not any(entry["at_bound"] for entry in result["parameters"].values())
    xi = values_of(result)
    errors = np.outer(expected.rmse, np.sqrt(np.diag(expected.field_map.unit_covariance)))
    assert np.all(np.abs(compose(xi) - expected.field_map.matrix) < 1e-6 * errors[:, :3])
    assert np.all(np.abs(xi[3:6] - expected.field_map.bias) < 1e-6 * errors[:, 3])
    assert_allclose(list(result["rmse"].values()), expected.rmse, rtol=1e-9)
    assert_allclose(list(result["rmse"].values()), [0.689, 0.644, 0.313], atol=0.001)
    assert np.linalg.norm(xi[3:6]) < 20  # a clean mount: hard iron of a few uT
    assert "hard to tell apart" in result["message"]  # attitude within 16 deg, and it says so
    assert result["weak"]


def test_internal_magnetometer_meets_a_bound(tmp_path: Path):
    """Beside the power wiring a constant C can't be right: a bound is met and flagged."""
    fitted, expected = fit_octocopter("octocopter_internal_mag.csv", tmp_path)
    assert fitted.code == 0, fitted.err
    result = fitted.result
    at_bound = [name for name, entry in result["parameters"].items() if entry["at_bound"]]
    assert at_bound != []
    for name in at_bound:
        entry = result["parameters"][name]
        assert min(abs(entry["value"] - entry[end]) for end in ("lower", "upper")) < 1e-9
        assert entry["standard_error"] is None
    rmse = np.array(list(result["rmse"].values()))
    assert np.all(rmse > (1 - 1e-9) * expected.rmse)
    assert np.sum(rmse**2) > np.sum(expected.rmse**2)
    assert np.all(rmse < 10)  # [uT]; about 5 to 9
    assert np.all(rmse > 8 * np.array([0.689, 0.644, 0.313]))


def test_internal_magnetometer_with_room_is_its_regression(tmp_path: Path):
    """With bounds wide enough to hold alpha_xz = -0.68: the closed form again."""
    wide = [
        part
        for name in ("eta_x", "eta_y", "eta_z", "alpha_xy", "alpha_xz", "alpha_yz")
        for part in ("--bounds", f"{name}=-0.8,0.8")
    ]
    fitted, expected = fit_octocopter("octocopter_internal_mag.csv", tmp_path, *wide)
    assert fitted.code == 0, fitted.err
    assert_allclose(list(fitted.result["rmse"].values()), expected.rmse, rtol=1e-6)
    assert_allclose(compose(values_of(fitted.result)), expected.field_map.matrix, atol=1e-3)


@pytest.mark.parametrize("mount", ["internal", "external"])
def test_later_verbs(tmp_path: Path, mount: str):
    """The same rmse by compare; apply restores the field's strength from what was read."""
    name = f"octocopter_{mount}_mag.csv"
    fitted, _ = fit_octocopter(name, tmp_path)
    file = find_fixture(name)
    compared = run("sepcal-mag", "compare", file, "base.json", "--json", folder=tmp_path)
    assert compared.code == 0
    assert compared.result["rmse"] == pytest.approx(fitted.result["rmse"], rel=1e-9)
    applied = run("sepcal-mag", "apply", file, "base.json", "-o", "out.csv", folder=tmp_path)
    assert applied.code == 0
    corrected = Log(tmp_path / "out.csv")
    strength = np.linalg.norm([corrected.column(f"m{axis}_cal_ut") for axis in "xyz"], axis=0)
    raw = 100 * np.linalg.norm([corrected.column(f"m{axis}_gauss") for axis in "xyz"], axis=0)
    true = np.linalg.norm(FIELD)
    assert np.sqrt(np.mean((strength - true) ** 2)) < np.sqrt(np.mean((raw - true) ** 2))


@pytest.mark.parametrize(
    ("app", "name", "words"),
    [
        ("sepcal-pitot", "uav_pitot_static_2022_05_07_11.csv",
         ("no column dpa_*", "for a five-hole probe", "the file has: time_s, ")),
        ("sepcal-pitot", "airliner_mode_s.csv", ("no column dpa_*", "the file has: ")),
        ("sepcal-pitot", "octocopter_internal_mag.csv", ("no column dpa_*", "the file has: ")),
        ("sepcal-pitot --probe pitot-static", "octocopter_internal_mag.csv",
         ("column 'vn_mps' is missing", "the file has: ")),
        ("sepcal-mag", "uav_pitot_static_2022_05_07_11.csv",
         ("column 'mx_ut' is missing", "the file has: time_s, ")),
        ("sepcal-mag", "octocopter_internal_mag.csv",
         ("the true field is missing", "--field N,E,D", "the file has: time_s, mx_gauss, ")),
        ("sepcal-mag", "bench_tilt_sphere_mag.csv",
         ("the true field is missing", "--field N,E,D", "the file has: ")),
        ("sepcal-mag", "nist/Misra1a.dat", ("nist/Misra1a.dat", "column_1, column_2")),
        ("sepcal-pitot", "nist", ("nist: is a folder", "name a CSV file in it")),
    ],
)  # fmt: skip
def test_other_files_say_what_they_lack(
    tmp_path: Path, app: str, name: str, words: tuple[str, ...]
):
    if not (FIXTURES / name).exists():
        find_fixture(name)
    app, *probe = app.split()
    options = probe or (FIVE_HOLE_OPTIONS if app == "sepcal-pitot" else ())
    refused = run(app, "fit", FIXTURES / name, *options, "-o", "base.json", folder=tmp_path)
    assert (refused.code, refused.out) == (2, "")
    assert refused.err.startswith(f"{app}: ")
    assert refused.err.count("\n") == 1
    assert Path(name).name in refused.err
    for word in words:
        assert word in refused.err
    assert list(tmp_path.iterdir()) == []
