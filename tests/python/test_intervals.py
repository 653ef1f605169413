# SPDX-License-Identifier: BSD-3-Clause
"""profile_intervals(), predict() and the methods of a calibration, against SciPy and NumPy."""

import json
from typing import ClassVar

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq, minimize_scalar
from scipy.stats import norm
from scipy.stats import t as student_t

import sepcal

PROBE = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))


class Decay:
    """z = exp(-k u): nothing linear, one parameter."""

    inputs: ClassVar = {"u": "s"}
    outputs: ClassVar = {"z": "1"}
    linear: ClassVar = {}
    nonlinear: ClassVar = {"k": ("1/s", 0.0, 10.0)}

    def at(self, u, xi2):
        """A (N, 1, 0) and b (N, 1)."""
        return np.zeros((len(u.u), 1, 0)), np.exp(-xi2[0] * u.u)[:, None]


def decay_data(seed=1, k=0.8):
    rng = np.random.default_rng(seed)
    u = np.linspace(0.0, 3.0, 9)
    return {"u": u, "z": np.exp(-k * u) + 0.15 * rng.standard_normal(u.size)}


def square(data, k):
    return float(np.sum((data["z"] - np.exp(-k * data["u"])) ** 2))


@pytest.fixture(scope="module")
def flown():
    return sepcal.simulate(PROBE, rows=300, seed=2)


@pytest.fixture(scope="module")
def base(flown):
    return sepcal.fit(PROBE, flown, samples=50)


def test_one_parameter_against_scipys_roots():
    data = decay_data()
    fit = sepcal.fit(Decay(), data)
    best = minimize_scalar(
        lambda k: square(data, k), bounds=(0, 3), method="bounded", options={"xatol": 1e-10}
    )
    reach = student_t.ppf(0.95, 8)
    height = best.fun * (1 + reach**2 / 8)
    found = sepcal.profile_intervals(Decay(), data, fit, level=0.9)
    at = found["k"]
    lower = brentq(lambda k: square(data, k) - height, 0.0, best.x, xtol=1e-13)
    upper = brentq(lambda k: square(data, k) - height, best.x, 10.0, xtol=1e-13)
    assert_allclose(at.profile, (lower, upper), rtol=1e-7)
    half = reach * fit["k"].standard_error
    assert_allclose(at.gaussian, (fit["k"].value - half, fit["k"].value + half), rtol=1e-12)
    assert at.ends == ("crossed", "crossed")
    assert found.level == 0.9


def test_a_bound_ends_it_and_the_table_says_so():
    data = decay_data(k=0.05)
    data["z"] += 0.1  # so that growth would fit better than decay
    fit = sepcal.fit(Decay(), data)
    assert fit.at_bound == ["k"]
    found = sepcal.profile_intervals(Decay(), data, fit)
    assert found["k"].ends == ("bound", "crossed")
    assert found["k"].profile[0] == 0.0
    assert np.isnan(found["k"].gaussian).all()
    height = square(data, 0.0) * (1 + student_t.ppf(0.975, 8) ** 2 / 8)
    upper = brentq(lambda k: square(data, k) - height, 0.0, 10.0, xtol=1e-13)
    assert found["k"].profile[1] == pytest.approx(upper, rel=1e-7)
    assert "lower: its bound ends it" in str(found)
    assert json.loads(found.to_json())["parameters"]["k"]["gaussian"] == [None, None]


def test_a_model_with_an_effect_and_given_noise():
    rng = np.random.default_rng(4)
    u = np.linspace(0.0, 6.0, 40)
    data = {"eta": u, "warmth": np.cos(0.5 * u)}
    data["z"] = (1.2 + 0.4 * data["warmth"]) * np.cos(u + 0.1) - 0.3
    data["z"] += 0.05 * rng.standard_normal(u.size)
    options = {"noise": {"z": 0.05}, "effects": ["a[warmth]"], "coloured_errors": False}
    model = sepcal.ScalarExample1()
    fit = sepcal.fit(model, data, **options)
    found = sepcal.profile_intervals(model, data, fit, **options)
    assert list(found.parameters) == list(fit.names)
    for at in found.parameters.values():
        half = norm.ppf(0.975) * fit[at.name].standard_error
        assert at.gaussian[1] - at.value == pytest.approx(half, rel=1e-9)
        assert_allclose(at.profile, at.gaussian, atol=0.02 * half)

    half_as_many = {name: values[::2] for name, values in data.items() if name != "z"}
    prediction = sepcal.predict(model, half_as_many, fit, **options)
    values = fit.values
    driver = data["warmth"] - fit.effects[0].centre
    wave = np.cos(u + fit["b"].value)
    names = list(fit.names)
    slope = values[names.index("a[warmth].s")]
    expected = (1 + fit["a"].value + slope * driver) * wave + fit["c"].value
    assert_allclose(prediction.value[:, 0], expected[::2], rtol=1e-9)
    columns = {
        "a": wave,
        "c": np.ones_like(u),
        "a[warmth].s": driver * wave,
        "b": -(1 + fit["a"].value + slope * driver) * np.sin(u + fit["b"].value),
    }
    g = np.stack([columns[name] for name in names], axis=1)
    error = np.sqrt(np.einsum("ni,ij,nj->n", g, fit.covariance, g))
    assert_allclose(prediction.standard_error[:, 0], error[::2], rtol=1e-7)
    assert_allclose(prediction.measurement_error[:, 0], np.hypot(error[::2], 0.05), rtol=1e-7)
    lower, upper = prediction.measurement_band
    assert_allclose(upper - lower, 2 * norm.ppf(0.975) * prediction.measurement_error)


def test_beyond_a_bound_of_the_wind_along_the_track_the_profile_goes_on():
    """A tube on 30 degrees of track: w_n reaches -100 m/s before w_e's upper end."""
    flown = sepcal.simulate("pitot-static", rows=600, seed=42)
    rows = np.abs(np.arctan2(flown["ve_mps"], flown["vn_mps"])) < np.pi / 12
    part = sepcal.Flight({header: values[rows] for header, values in flown.items()})
    fit = sepcal.fit(sepcal.PitotStatic(), part, samples=100)
    assert fit.status == "converged"
    vn, ve, vd, z = (part[name] for name in ("vn_mps", "ve_mps", "vd_mps", "airspeed_mps"))

    def square(w_n, w_e):
        airspeed = np.sqrt((vn - w_n) ** 2 + (ve - w_e) ** 2 + vd**2)
        columns = np.stack([airspeed, np.ones_like(z)], axis=1)
        return np.linalg.lstsq(columns, z, rcond=None)[1].item()

    def least(w_e):
        options = {"xatol": 1e-9}
        inside = minimize_scalar(
            lambda w_n: square(w_n, w_e), bounds=(-100, 50), method="bounded", options=options
        )
        return min(inside.fun, square(-100.0, w_e))

    at = fit["w_e"]
    colour = (at.standard_error / at.standard_error_white) ** 2
    freedom = z.size - 4
    reach = student_t.ppf(0.975, freedom)
    height = least(at.value) * (1 + colour * reach**2 / freedom)
    lower = brentq(lambda w_e: least(w_e) - height, -5.0, at.value, xtol=1e-10)
    upper = brentq(lambda w_e: least(w_e) - height, at.value, 40.0, xtol=1e-10)
    assert square(-100.0, upper) < square(-99.9, upper)
    found = fit.intervals(names=["w_e"])["w_e"]
    assert found.ends == ("crossed", "crossed")
    assert_allclose(found.profile, (lower, upper), rtol=1e-6)


def test_a_calibrations_intervals_are_near_the_gaussian_ones(base, flown, tmp_path):
    found = base.intervals()
    assert list(found.parameters) == list(PROBE.parameters)
    for at in found.parameters.values():
        half = at.gaussian[1] - at.value
        assert_allclose(at.profile, at.gaussian, atol=0.05 * half)
    only = base.intervals(names=["w_n"])
    assert only["w_n"] == found["w_n"]
    base.save(tmp_path / "base.json")
    loaded = sepcal.load(tmp_path / "base.json")
    assert loaded.intervals(flown).to_json() == found.to_json()
    with pytest.raises(sepcal.Error, match="has no flight"):
        loaded.intervals()


def test_a_calibrations_prediction_is_what_compare_subtracts(base, flown):
    prediction = base.predict()
    measured = np.stack([flown[name] for name in ("vn_mps", "ve_mps", "vd_mps")], axis=1)
    assert_allclose(prediction.value, measured - base.compare().residuals, atol=1e-12)
    assert_allclose(prediction.time, flown["time_s"])
    low, high = prediction.measurement_band
    inside = np.mean((measured > low) & (measured < high))
    assert 0.92 < inside < 0.98  # 900 measurements: +- 4 standard errors


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        ({"names": ["w_x"]}, "the fit has: lambda_va"),
        ({"names": "eps_phi"}, r"names is 'eps_phi'; give a list of names, \['eps_phi'\]"),
        ({"level": 95}, "between 0 and 1"),
    ],
)
def test_bad_arguments(base, arguments, culprit):
    with pytest.raises(sepcal.Error, match=culprit):
        base.intervals(**arguments)


def test_one_name_in_place_of_names():
    data = decay_data()
    fit = sepcal.fit(Decay(), data)
    with pytest.raises(sepcal.Error, match=r"names is 'k'; give a list of names, \['k'\]"):
        sepcal.profile_intervals(Decay(), data, fit, names="k")


@pytest.mark.parametrize("verb", ["predict", "intervals", "compare", "diagnose", "apply"])
def test_a_file_or_columns_in_place_of_a_flight(base, verb):
    """Both are read, and what neither is is refused."""
    with pytest.raises(sepcal.Error, match=r"^f1.csv: no such file$"):
        getattr(base, verb)("f1.csv")
    with pytest.raises(sepcal.Error, match=r"flight: column '\w+' is missing.*has: pt_pa"):
        getattr(base, verb)({"pt_pa": [1.0]})
    words = rf"a float is no flight; give one: {verb}\(sepcal.read\(file\)\)"
    with pytest.raises(sepcal.Error, match=words):
        getattr(base, verb)(1.0)


def test_another_flight_or_a_calibration_in_the_wrong_place(base, flown):
    with pytest.raises(sepcal.Error, match="no minimum here"):
        base.intervals(sepcal.simulate(PROBE, rows=300, seed=3, parameters={"w_n": 20.0}))
    with pytest.raises(sepcal.Error, match="its own intervals"):
        sepcal.profile_intervals(PROBE, flown, base)
    with pytest.raises(KeyError, match="there are: lambda_va"):
        base.intervals(names=["lambda_va"])["w_x"]
