# SPDX-License-Identifier: BSD-3-Clause
"""One flight as different people log it: units, order, wrapped angles, line ends; one estimate."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from apps import Bench, Log, values_of
from oracle.five_hole_probe import rotate_to_navigation

DEGREE = np.pi / 180
PITOT_UNITS = {
    "time": ("ms", 1e3), "roll": ("deg", 1 / DEGREE), "pitch": ("deg", 1 / DEGREE),
    "yaw": ("deg", 1 / DEGREE), "p": ("degps", 1 / DEGREE), "q": ("degps", 1 / DEGREE),
    "r": ("degps", 1 / DEGREE), "vn": ("kt", 3600 / 1852), "ve": ("kt", 3600 / 1852),
    "vd": ("kmh", 3.6), "pt": ("hpa", 1e-2), "ps": ("kpa", 1e-3), "dpa": ("torr", 760 / 101325),
    "dpb": ("psi", 0.0254**2 / (0.45359237 * 9.80665)),
}  # fmt: skip
MAGNETOMETER_UNITS = {
    "time": ("us", 1e6), "mx": ("nt", 1e3), "my": ("gauss", 1e-2), "mz": ("mgauss", 10),
    "roll": ("deg", 1 / DEGREE), "pitch": ("deg", 1 / DEGREE), "yaw": ("deg", 1 / DEGREE),
    "bn": ("nt", 1e3), "be": ("gauss", 1e-2), "bd": ("mgauss", 10),
}  # fmt: skip


def convert(log: Log, quantity: str, unit: str, factor: float) -> None:
    header = next(name for name in log.headers if name.rsplit("_", 1)[0] == quantity)
    log.replace(header, log.column(header) * factor, f"{quantity}_{unit}")


def assert_same_estimate(bench: Bench, log: Log, tolerance: float) -> None:
    """To `tolerance` of the larger of a value and its standard error."""
    (bench.folder / "other.csv").write_text(log.text())
    fitted = bench.fit(flight="other.csv")
    assert fitted.code == 0, fitted.err
    errors = [entry["standard_error"] for entry in bench.base["parameters"].values()]
    expected = values_of(bench.base)
    scale = np.maximum(np.abs(expected), errors)
    assert_allclose(values_of(fitted.result) / scale, expected / scale, rtol=0, atol=tolerance)


def test_units(bench: Bench):
    log = bench.read_log()
    units = PITOT_UNITS if bench.app == "sepcal-pitot" else MAGNETOMETER_UNITS
    for quantity, (unit, factor) in units.items():
        convert(log, quantity, unit, factor)
    assert_same_estimate(bench, log, 1e-9)


def test_density_from_temperature(pitot: Bench):
    """It is ps / (287.05287 T), T in kelvin or degrees Celsius."""
    log = pitot.read_log()
    temperature = log.column("temp_k") + 3.0  # off the standard atmosphere
    log.replace("rho_kgpm3", log.column("ps_pa") / (287.05287 * temperature))
    (pitot.folder / "warm.csv").write_text(log.text())
    warm = values_of(pitot.fit(flight="warm.csv").result)
    assert not np.allclose(warm, values_of(pitot.base), rtol=1e-5, atol=0)
    log.drop("rho_kgpm3")
    for header, values in (("temp_k", temperature), ("temp_degc", temperature - 273.15)):
        log.replace("temp_k", values, header)
        (pitot.folder / "warm.csv").write_text(log.text())
        assert_allclose(values_of(pitot.fit(flight="warm.csv").result), warm, rtol=1e-8, atol=1e-10)


def test_true_field_in_body_axes(magnetometer: Bench):
    """hx, hy, hz by the oracle's rotation instead of attitude and field; and --field."""
    log = magnetometer.read_log()
    with_field = magnetometer.fit("--field", "19.7,-1.4,49.4")
    assert values_of(with_field.result) == pytest.approx(values_of(magnetometer.base), rel=1e-12)
    assert with_field.result["options"]["field"] == [19.7, -1.4, 49.4]

    attitude = {name: log.column(f"{name}_rad") for name in ("roll", "pitch", "yaw")}
    field = np.stack([log.column(f"{name}_ut") for name in ("bn", "be", "bd")])
    body = np.einsum("kji,jk->ik", rotate_to_navigation(attitude), field)
    for header in ("roll_rad", "pitch_rad", "yaw_rad", "bn_ut", "be_ut", "bd_ut"):
        log.drop(header)
    for header, values in zip(("hx_ut", "hy_ut", "hz_ut"), body, strict=True):
        log.add(header, values)
    assert_same_estimate(magnetometer, log, 1e-9)


def test_column_order(bench: Bench):
    log = bench.read_log()
    order = np.random.default_rng(0).permutation(len(log.headers))
    log.headers = [log.headers[i] for i in order]
    log.rows = [[row[i] for i in order] for row in log.rows]
    assert_same_estimate(bench, log, 0)


def test_angles_wrap(bench: Bench):
    log = bench.read_log()
    for header in ("roll_rad", "yaw_rad"):
        turns = np.random.default_rng(0).integers(-3, 4, len(log.rows))
        log.replace(header, log.column(header) + 2 * np.pi * turns)
    assert_same_estimate(bench, log, 1e-9)


def test_files_of_other_habits(bench: Bench):
    """CRLF, a byte-order mark, quoted cells and blanks round cells are the same log."""
    log = bench.read_log()
    log.headers = [f' "{header}"' for header in log.headers]
    text = "\ufeff" + log.text().replace("\n", "\r\n").replace(",", " , ")
    (bench.folder / "other.csv").write_bytes(text.encode())
    fitted = bench.fit(flight="other.csv")
    assert (fitted.code, fitted.err) == (0, "")
    assert fitted.result["parameters"] == bench.base["parameters"]
