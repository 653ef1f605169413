# SPDX-License-Identifier: BSD-3-Clause
"""Sensors that ship without a probe of their own, triads of parts, and several as one model."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import sepcal
from refusals import refuse
from sepcal import triads

rng = np.random.default_rng(21)
MAG = {
    "lambda_x": 0.04, "lambda_y": -0.02, "lambda_z": 0.03, "n_x": 3.0, "n_y": -5.0, "n_z": 2.0,
    "eta_x": 0.02, "eta_y": -0.03, "eta_z": 0.015, "alpha_xy": 0.01, "alpha_xz": -0.02,
    "alpha_yz": 0.03,
}  # fmt: skip
ACC = {
    "lambda_x": 0.01, "lambda_y": -0.02, "lambda_z": 0.015, "n_x": 0.3, "n_y": -0.2, "n_z": 0.1,
    "eta_x": 0.01, "eta_y": 0.02, "eta_z": -0.015,
}  # fmt: skip


def read(f: np.ndarray, by: dict[str, float]) -> np.ndarray:
    """(I + alpha) (I + [eta x]) (I + lambda) f + n, of (N, 3)."""
    scaled = f * (1 + np.array([by[f"lambda_{axis}"] for axis in "xyz"]))
    turned = scaled + np.cross([by[f"eta_{axis}"] for axis in "xyz"], scaled)
    xy, xz, yz = (by.get(f"alpha_{axes}", 0.0) for axes in ("xy", "xz", "yz"))
    coupled = turned @ np.array([[1, xy, xz], [xy, 1, yz], [xz, yz, 1]])
    return coupled + np.array([by[f"n_{axis}"] for axis in "xyz"])


def turned_by_hand(rows: int = 400) -> tuple[np.ndarray, np.ndarray]:
    """Field [uT] and specific force [m/s^2] in body axes, (N, 3) each."""
    directions = np.cumsum(0.3 * rng.standard_normal((rows, 3)), axis=0) + rng.standard_normal(3)
    unit = directions / np.linalg.norm(directions, axis=1)[:, None]
    side = np.cross(unit, [0.3, -0.5, 0.8])
    side /= np.linalg.norm(side, axis=1)[:, None]
    return 48.0 * unit, -9.81 * side + rng.standard_normal((rows, 3))


def log() -> dict[str, np.ndarray]:
    h, f = turned_by_hand()
    m = read(h, MAG) + 0.3 * rng.standard_normal(h.shape)
    a = np.round((read(f, ACC) + 0.05 * rng.standard_normal(f.shape)) / 0.01) * 0.01
    columns = {"time_s": 0.1 * np.arange(len(h))}
    for prefix, values in (("h", h), ("f", f), ("mag.m", m), ("acc.a", a)):
        columns |= {prefix + axis: values[:, k].copy() for k, axis in enumerate("xyz")}
    return columns


def of_accelerometer(columns: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    names = {"acc.a" + axis: "a" + axis for axis in "xyz"}
    return {names.get(name, name): values for name, values in columns.items()}


def near(fit: sepcal.Fit, truth: dict[str, float], label: str = "") -> None:
    """Within 4.5 standard errors."""
    for name, value in truth.items():
        found = fit[label + name]
        assert abs(found.value - value) < 4.5 * found.standard_error, name


def test_an_accelerometer_has_every_verb(tmp_path: Path) -> None:
    """A hidden temperature effect is found, added, saved, loaded and applied."""
    columns = of_accelerometer(log())
    temperature = 20 + 15 * np.sin(0.05 * columns["time_s"])
    columns["ax"] = columns["ax"] + 0.06 * (temperature - 20)
    flight = sepcal.Flight({**columns, "temp_degc": temperature})
    base = sepcal.fit(sepcal.Accelerometer(), flight)
    assert isinstance(base, sepcal.Calibration)
    found = base.diagnose()
    assert found.verdict == "effect_missing"
    assert found.effects[0].name in {"n_x[temp_degc]", "fx[temp_degc]"}  # the same but for lambda
    better = base.add("n_x[temp_degc]")
    assert better["n_x[temp_degc].s"].value == pytest.approx(0.06, abs=0.002)
    assert better.rmse["ax"] < 0.6 * base.rmse["ax"]
    better.save(tmp_path / "acc.json")
    refuse(lambda: sepcal.load(tmp_path / "acc.json"), "accelerometer", "model")
    again = sepcal.load(tmp_path / "acc.json", model=sepcal.Accelerometer())
    assert_allclose(again.values, better.values)
    assert_allclose(again.apply(flight)["ax_fit_mps2"], better.apply(flight)["ax_fit_mps2"])
    assert_allclose(pickle.loads(pickle.dumps(better)).values, better.values)


def test_two_sensors_are_one_model() -> None:
    both = sepcal.concatenate(mag=sepcal.Magnetometer(), acc=sepcal.Accelerometer())
    assert both.outputs == ("mag.mx", "mag.my", "mag.mz", "acc.ax", "acc.ay", "acc.az")
    assert both.linear[0] == "mag.lambda_x"
    assert both.nonlinear[-1] == "acc.eta_z"
    assert both.units["acc.n_x"] == "m/s^2"
    columns = log()
    fitted = sepcal.fit(both, columns)
    near(fitted, MAG, "mag.")
    near(fitted, ACC, "acc.")
    alone = sepcal.fit(sepcal.Accelerometer(), of_accelerometer(columns))
    for name in ACC:
        assert fitted[f"acc.{name}"].value == pytest.approx(alone[name].value, rel=1e-5, abs=1e-7)
    again = pickle.loads(pickle.dumps(both))
    assert again.parameters == both.parameters
    assert repr(both) == "concatenate(mag=Magnetometer(), acc=Accelerometer())"


def test_a_calibration_of_labelled_sensors_is_read_back(tmp_path: Path) -> None:
    """Their parameters have dots in their names, as those of effects do."""
    columns = log()
    columns["temp_c"] = np.linspace(15.0, 35.0, len(columns["time_s"]))
    both = sepcal.concatenate(mag=sepcal.Magnetometer(), acc=sepcal.Accelerometer())
    flight = sepcal.Flight(columns)
    fitted = sepcal.fit(both, flight, effects=["acc.n_x[temp_c]"])
    file = tmp_path / "both.json"
    fitted.save(file)
    for again in (sepcal.load(file, model=both), pickle.loads(pickle.dumps(fitted))):
        assert [again[name].value for name in both.parameters] == [
            fitted[name].value for name in both.parameters
        ]
        for header, column in fitted.apply(flight).items():
            assert_array_equal(again.apply(flight)[header], column)
    text = file.read_text().replace('"acc.n_x[temp_c].s"', '"acc.n_q[temp_c].s"')
    file.write_text(text)
    refuse(lambda: sepcal.load(file, model=both), "damaged", "acc.n_q[temp_c].s", "does not list")


def test_the_rows_of_a_concatenation_are_those_of_its_sensors() -> None:
    one, other = sepcal.Magnetometer(), sepcal.ScalarExample2()
    whole = sepcal.concatenate(other, a=one)
    columns = {name: rng.standard_normal(7) for name in (*one.inputs, *other.inputs)}
    xi1, xi2 = rng.standard_normal(8), 0.1 * rng.standard_normal(8)
    A, b, D = whole.evaluate(columns, xi2, xi1)
    A_other, b_other, D_other = other.evaluate(columns, xi2[:2], xi1[:2])
    A_one, b_one, D_one = one.evaluate(columns, xi2[2:], xi1[2:])
    assert_allclose(A[:, :1, :2], A_other)
    assert_allclose(A[:, 1:, 2:], A_one)
    assert not A[:, :1, 2:].any()
    assert not A[:, 1:, :2].any()
    assert_allclose(b, np.hstack([b_other, b_one]))
    assert_allclose(D[:, :1, :2], D_other)
    assert_allclose(D[:, 1:, 2:], D_one)
    assert not D[:, 1:, :2].any()


class Offset:
    """A sensor of the caller's own."""

    inputs = (("hx", "uT"),)
    outputs = (("z", "uT"),)
    linear = (("offset", "uT"), ("slope", "1"))
    nonlinear = ()

    def at(self, u: Any, xi2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A and b."""
        return np.stack([np.ones_like(u.hx), u.hx], axis=1)[:, None, :], np.zeros((len(u.hx), 1))


def test_one_of_the_callers_own_joins() -> None:
    columns = log()
    columns["own.z"] = 2.0 + 0.5 * columns["hx"]
    both = sepcal.concatenate(own=Offset(), mag=sepcal.Magnetometer())
    assert both.inputs == ("hx", "hy", "hz")
    fitted = sepcal.fit(both, columns)
    assert fitted["own.slope"].value == pytest.approx(0.5, abs=1e-6)
    near(fitted, MAG, "mag.")


def test_what_can_not_be_put_together_is_refused() -> None:
    refuse(sepcal.concatenate, "none")
    mag = sepcal.Magnetometer()
    refuse(lambda: sepcal.concatenate(mag, mag), "mx")
    refuse(lambda: sepcal.concatenate(mag, path=sepcal.ShortPeriod()), "'path'", "state")

    class InNanotesla(Offset):
        inputs = (("hx", "nT"),)

    refuse(lambda: sepcal.concatenate(mag, own=InNanotesla()), "hx", "uT", "nT")


@pytest.mark.parametrize(
    ("triad", "model"),
    [
        (
            sepcal.Triad(triads.SpecificForceInBody(), triads.Misalignment()),
            sepcal.Accelerometer(),
        ),
        (
            sepcal.Triad(triads.FieldInBody(), triads.CrossCoupling(), triads.Misalignment()),
            None,
        ),
    ],
)
def test_a_triad_of_parts_is_the_sensor(triad: sepcal.Triad, model: sepcal.Model | None) -> None:
    own = sepcal.OwnModel(triad)
    xi1, xi2 = 0.1 * rng.standard_normal(6), 0.1 * rng.standard_normal(len(own.nonlinear))
    f = rng.standard_normal((9, 3))
    columns = dict(zip(own.inputs, f.T.copy(), strict=True))
    if model is not None:
        assert own.units == model.units
        assert own.bounds == model.bounds
        for mine, theirs in zip(
            own.evaluate(columns, xi2, xi1), model.evaluate(columns, xi2, xi1), strict=True
        ):
            assert_allclose(mine, theirs, atol=1e-9)
        return
    A, b = own.evaluate(columns, xi2)
    by = dict(zip(own.parameters, np.r_[xi1, xi2], strict=True))
    assert_allclose(A @ xi1 + b, read(f, by), atol=1e-12)


def test_what_is_no_part_of_a_triad_is_told() -> None:
    class Flat(triads.FieldInBody):
        outputs = (("mx", "uT"), ("my", "uT"))

    class Odd(triads.Misalignment):
        def matrix(self, eta: np.ndarray) -> np.ndarray:
            return np.eye(2)

    odd = sepcal.Triad(triads.FieldInBody(), Odd())
    inputs = {"hx": [1.0], "hy": [1.0], "hz": [1.0]}
    wrong = sepcal.own_model.OwnModel(odd)
    refuse(lambda: wrong.evaluate(inputs, np.zeros(3)), "Odd.matrix()", "(2, 2)", "(3, 3)")
    refuse(lambda: sepcal.Triad(Flat()), "three outputs", "Flat has 2")
    refuse(lambda: sepcal.Triad(triads.Misalignment()), "inputs")  # type: ignore[arg-type]
    refuse(lambda: sepcal.Triad(triads.FieldInBody(), triads.FieldInBody()), "matrix")  # type: ignore[arg-type]


@pytest.mark.parametrize("modes", [1, 2, 3, 4, 5, 6])
def test_damped_sinusoids_are_what_they_say(modes: int) -> None:
    model = sepcal.DampedSinusoids(modes)
    t = np.sort(rng.uniform(0, 5, 40))
    ratios = np.r_[3.0, rng.uniform(0.4, 0.9, modes - 1)]
    damping, sizes = rng.uniform(0.1, 1.0, modes), rng.standard_normal(2 * modes + 1)
    A, b = model.evaluate({"time": t}, np.r_[ratios, damping])
    omega = np.cumprod(ratios)
    expected = sizes[-1] + sum(
        np.exp(-d * t) * (c * np.cos(w * t) + s * np.sin(w * t))
        for d, w, c, s in zip(damping, omega, sizes[:-1:2], sizes[1:-1:2], strict=True)
    )
    assert_allclose((A @ sizes)[:, 0] + b[:, 0], expected, atol=1e-12)
    assert pickle.loads(pickle.dumps(model)).modes == modes


def test_a_decay_is_fitted_without_a_start() -> None:
    t = np.sort(rng.uniform(0, 8, 300))
    clean = np.exp(-0.3 * t) * (2 * np.cos(4 * t) - np.sin(4 * t)) + 0.5
    data = {"time": t, "z": clean + 0.02 * rng.standard_normal(300)}
    bounds = {"frequency_1": (0.0, 20.0), "damping_1": (0.0, 5.0)}
    fitted = sepcal.fit(sepcal.DampedSinusoids(), data, bounds=bounds)
    near(fitted, {"frequency_1": 4.0, "damping_1": 0.3, "cos_1": 2.0, "sin_1": -1.0, "offset": 0.5})
    refuse(lambda: sepcal.DampedSinusoids(7), "modes is 7", "1 to 6")
    refuse(lambda: sepcal.DampedSinusoids(0), "modes is 0")


def test_a_log_that_is_longer_than_memory_is_a_flight(tmp_path: Path) -> None:
    columns = of_accelerometer(log())
    kept = {name: columns[name] for name in columns if not name.startswith(("h", "mag"))}
    text = ",".join(kept) + "\n"
    for row in np.column_stack(list(kept.values())).tolist():
        text += ",".join(map(repr, row)) + "\n"
    file = tmp_path / "turned.csv"
    file.write_text(text)
    streamed, read_whole = sepcal.stream_csv(file, tmp_path), sepcal.read_csv(file)
    assert streamed.columns == read_whole.columns
    one, other = (sepcal.fit(sepcal.Accelerometer(), log) for log in (streamed, read_whole))
    assert_allclose(one.values, other.values, rtol=1e-9)
    near(one, ACC)
    refuse(lambda: sepcal.stream_csv(tmp_path / "none.csv"), "none.csv")
    refuse(lambda: sepcal.stream_csv(file, tmp_path / "nowhere"), "nowhere")
