# SPDX-License-Identifier: BSD-3-Clause
"""A plain Pitot-static tube by the app and from Python: what it gives and what it refuses."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal
from apps import Bench, Log, assert_refused
from oracle.maximum_likelihood import fit_at_fixed_noise
from oracle.model import Model
from oracle.pitot_static import PitotStatic

KNOTS = 3600 / 1852


class StillAirDown(Model):
    """The oracle's tube with w_d = 0."""

    outputs = PitotStatic.outputs
    linear = PitotStatic.linear
    nonlinear = ("w_n", "w_e")

    def predict(self, record, xi):
        """Shape (1, N)."""
        return PitotStatic().predict(record, np.append(xi, 0.0))

    def jacobian(self, record, xi):
        """Shape (1, N, 4)."""
        return PitotStatic().jacobian(record, np.append(xi, 0.0))[..., :4]


@pytest.fixture
def tube(pitot: Bench) -> Bench:
    """sepcal-pitot with a tube's log in the five-hole probe's place."""
    command = ("simulate", "--probe", "pitot-static", "-o", "flight.csv", "--rows", "400")
    assert pitot.run(*command).code == 0
    return Bench(pitot.app, pitot.folder, (), PitotStatic())


def record_of(log: Log) -> dict[str, np.ndarray]:
    """The model's inputs and outputs."""
    return {name: log.column(f"{name}_mps") for name in ("vn", "ve", "vd", "airspeed")}


def test_the_probe_is_chosen_by_the_columns(tube: Bench) -> None:
    """No dpa_*: a tube. The estimates are SciPy's, the derived ones the delta method's."""
    fitted = tube.fit("-o", "tube.json")
    assert (fitted.code, fitted.err) == (0, "")
    result = fitted.result
    assert result["model"] == "pitot-static"
    assert tuple(result["parameters"]) == PitotStatic().parameters
    assert result["options"]["fix"] == {"w_d": 0}
    record = record_of(tube.read_log())
    noise = [result["noise"]["airspeed"]]
    expected = fit_at_fixed_noise(StillAirDown(), record, noise, [1.0, 0.0, 0.0, 0.0])
    inflation = np.sqrt(400 / 396)
    for name, value, error in zip(
        ("s_va", "c_va", "w_n", "w_e"), expected.values, expected.standard_errors, strict=True
    ):
        entry = result["parameters"][name]
        assert abs(entry["value"] - value) < 1e-6 * error
        assert entry["standard_error_white"] == pytest.approx(inflation * error, rel=1e-5)
    s, c = expected.values[:2]
    derived = result["derived"]
    assert list(derived) == ["lambda_va", "b_va"]
    assert derived["lambda_va"]["value"] == pytest.approx(1 / s - 1, rel=1e-7)
    assert derived["b_va"]["value"] == pytest.approx(-c / s, rel=1e-7)
    slope = np.array([c / s**2, -1 / s])
    variance = slope @ expected.covariance[:2, :2] @ slope
    white = derived["b_va"]["standard_error_white"]
    assert white == pytest.approx(inflation * np.sqrt(variance), 1e-5)
    assert derived["b_va"]["unit"] == "m/s"

    printed = tube.run("fit", "flight.csv").out
    assert "lambda_va" in printed
    assert "derived" in printed


def test_apply_corrects_the_reading(tube: Bench) -> None:
    assert tube.fit("-o", "tube.json").code == 0
    applied = tube.run("apply", "flight.csv", "tube.json", "-o", "out.csv")
    assert applied.code == 0
    out = Log(tube.folder / "out.csv")
    assert out.headers == [*tube.read_log().headers, "airspeed_cal_mps"]
    loaded = sepcal.load(tube.folder / "tube.json")
    gain, bias = loaded.derived["lambda_va"].value, loaded.derived["b_va"].value
    expected = (1 + gain) * out.column("airspeed_mps") + bias
    assert_allclose(out.column("airspeed_cal_mps"), expected, rtol=1e-12)
    compared = tube.run("compare", "flight.csv", "tube.json", "--json")
    assert compared.code == 0
    assert compared.result["rmse"] == pytest.approx({"airspeed": loaded.rmse["airspeed"]}, rel=1e-9)


def test_pressure_and_density_do_as_well_as_an_airspeed(tube: Bench) -> None:
    """The simulated dp_pa is that of the reading; knots are converted."""
    by_airspeed = tube.fit().result
    log = tube.read_log()
    log.replace("airspeed_mps", KNOTS * log.column("airspeed_mps"), to="airspeed_kt")
    tube.flight.write_text(log.text())
    by_knots = tube.fit().result
    log.drop("airspeed_kt")
    tube.flight.write_text(log.text())
    by_pressure = tube.fit().result
    log.drop("rho_kgpm3")
    tube.flight.write_text(log.text())
    by_temperature = tube.fit().result
    for other in (by_knots, by_pressure, by_temperature):
        for name, entry in by_airspeed["parameters"].items():
            close = 1e-3 * (entry["standard_error"] or 1.0)
            assert abs(other["parameters"][name]["value"] - entry["value"]) < close


def test_the_vertical_wind_is_freed_by_name(tube: Bench) -> None:
    freed = tube.fit("--free", "w_d")
    assert freed.result["parameters"]["w_d"]["standard_error"] > 0
    assert freed.result["options"]["fix"] == {}
    assert_refused(
        tube, "fit", "flight.csv", "--bounds", "w_d=-1,1", words=("w_d", "held", "--free w_d")
    )


def test_options_of_a_five_hole_probe_are_refused(tube: Bench) -> None:
    command = ("fit", "flight.csv", "--k-alpha", "4.5")
    assert_refused(tube, *command, words=("no column dpa_*", "Pitot-static", "--k-alpha"))
    command = ("fit", "flight.csv", "--lever-arm", "0,0,0")
    assert_refused(tube, *command, words=("no column dpa_*", "--lever-arm"))


@pytest.mark.parametrize(
    ("gone", "words"),
    [
        (("airspeed_mps", "dp_pa"), ("the airspeed is missing", "log airspeed_mps, or dp_pa")),
        (("airspeed_mps", "rho_kgpm3", "temp_k"), ("the density is missing", "temp_k and ps_pa")),
        (("vn_mps",), ("column 'vn_mps' is missing",)),
        (("time_s",), ("column 'time_s' is missing",)),
    ],
)
def test_missing_columns(tube: Bench, gone: tuple[str, ...], words: tuple[str, ...]) -> None:
    log = tube.read_log()
    for header in gone:
        log.drop(header)
    tube.flight.write_text(log.text())
    assert_refused(tube, "fit", "flight.csv", words=("flight.csv: ", *words))


def test_bad_cells_and_still_air(tube: Bench) -> None:
    log = tube.read_log()
    log.put(7, "airspeed_mps", "fast")
    tube.flight.write_text(log.text())
    words = ("line 7", "airspeed_mps", "'fast'", "--drop-invalid")
    assert_refused(tube, "fit", "flight.csv", words=words)
    assert tube.fit("--drop-invalid").result["inputs"]["rows_used"] == 399
    log.put(7, "airspeed_mps", "0")
    tube.flight.write_text(log.text())
    fitted = tube.fit()
    assert fitted.result["inputs"]["rows_used"] == 399
    assert "airspeed is not above zero" in fitted.err
    log.replace("airspeed_mps", np.zeros(400))
    tube.flight.write_text(log.text())
    words = ("airspeed is not above zero in 400 of 400 rows", "more than a fifth")
    assert_refused(tube, "fit", "flight.csv", words=words)


def test_python_is_the_same(tube: Bench) -> None:
    """A flight, its columns as arrays, and the app: one answer; w_d is held in all of them."""
    result = tube.fit().result
    flight = sepcal.read_csv(tube.flight)
    calibration = sepcal.fit(sepcal.PitotStatic(), flight)
    expected = [entry["value"] for entry in result["parameters"].values()]
    assert_allclose(calibration.values, expected, rtol=1e-12)
    assert calibration["w_d"].fixed
    assert calibration.derived["b_va"].value == result["derived"]["b_va"]["value"]
    arrays = sepcal.fit(sepcal.PitotStatic(), record_of(tube.read_log()))
    assert_allclose(arrays.values, expected, rtol=1e-7)
    assert arrays["w_d"].fixed
    freed = sepcal.fit(sepcal.PitotStatic(), record_of(tube.read_log()), free=["w_d"])
    assert not freed["w_d"].fixed
    with pytest.raises(sepcal.Error, match="w_up: there is no such parameter"):
        sepcal.fit(sepcal.PitotStatic(), flight, free=["w_up"])
