# SPDX-License-Identifier: BSD-3-Clause
"""Aerodynamic coefficients from Python: the equations of motion written out."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal
from refusals import refuse

AIRCRAFT = sepcal.Aircraft(
    area=12.0, chord=1.2, span=10.0, mass=900.0, inertia=(1200.0, 1500.0, 2500.0, 80.0)
)


def flown() -> dict[str, np.ndarray]:
    t = np.arange(0.0, 4.0, 0.02)
    p, q, r = 0.3 * np.sin(2 * t), 0.2 * np.cos(3 * t), 0.1 * np.sin(t + 1)
    return {
        "time": t, "p": p, "q": q, "r": r,
        "pdot": 0.6 * np.cos(2 * t), "qdot": -0.6 * np.sin(3 * t), "rdot": 0.1 * np.cos(t + 1),
        "ax": 0.3 * np.sin(t), "ay": 0.2 * np.cos(t), "az": -9.81 + np.sin(2 * t),
        "airspeed": 45 + np.sin(t), "alpha": 0.05 + 0.02 * np.sin(t), "beta": 0.01 * np.cos(t),
        "rho": np.full_like(t, 1.1), "thrust": np.full_like(t, 700.0),
    }  # fmt: skip


def test_they_are_the_equations_of_motion() -> None:
    data = flown()
    found = sepcal.aero_coefficients(data, AIRCRAFT)
    p, q, r = data["p"], data["q"], data["r"]
    force = 0.5 * data["rho"] * data["airspeed"] ** 2 * 12.0
    roll = 1200 * data["pdot"] - 80 * (data["rdot"] + p * q) + (2500 - 1500) * q * r
    pitch = 1500 * data["qdot"] + (1200 - 2500) * p * r + 80 * (p**2 - r**2)
    yaw = 2500 * data["rdot"] - 80 * (data["pdot"] - q * r) + (1500 - 1200) * p * q
    expected = {
        "CX": (900 * data["ax"] - 700) / force, "CY": 900 * data["ay"] / force,
        "CZ": 900 * data["az"] / force, "Cl": roll / (force * 10.0),
        "Cm": pitch / (force * 1.2), "Cn": yaw / (force * 10.0),
        "q_hat": q * 1.2 / (2 * data["airspeed"]),
    }  # fmt: skip
    assert set(found.names) == set(expected) - {"q_hat"}
    for name, values in expected.items():
        assert_allclose(found.columns[name], values, rtol=1e-10, atol=1e-15)
    assert np.isnan(found.window)
    assert any("q c/2V" in note for note in found.notes)


def test_rates_are_differentiated_where_their_derivatives_are_missing() -> None:
    data = flown()
    whole = sepcal.aero_coefficients(data, AIRCRAFT, ["Cm"])
    less = {name: data[name] for name in data if not name.endswith("dot")}
    found = sepcal.aero_coefficients(less, AIRCRAFT, ["Cm"], window=0.2)
    assert found.window == pytest.approx(0.2)
    assert found.names == ["Cm"]
    inner = slice(10, -10)
    assert_allclose(found.columns["Cm"][inner], whole.columns["Cm"][inner], atol=2e-4)


def test_what_is_missing_is_told() -> None:
    data = flown()
    del data["ax"]
    refuse(lambda: sepcal.aero_coefficients(data, AIRCRAFT), "ax")
    refuse(lambda: sepcal.aero_coefficients(flown(), AIRCRAFT, ["CQ"]), "CQ")


@pytest.mark.parametrize("name", ["rho", "mass"])
def test_what_the_coefficients_divide_by_is_above_zero(name: str) -> None:
    data = flown()
    data[name] = np.full(len(data["time"]), 1.0)
    data[name][3] = -1.0
    refuse(lambda: sepcal.aero_coefficients(data, AIRCRAFT), f"{name} is -1 in row 3")


def test_what_is_not_used_may_be_anything() -> None:
    data = flown()
    rows = len(data["time"])
    data["qbar"] = 0.5 * data["rho"] * data["airspeed"] ** 2
    data["rho"], data["mass"] = np.zeros(rows), np.zeros(rows)
    found = sepcal.aero_coefficients(data, AIRCRAFT, ["Cm"])
    assert np.isfinite(found.columns["Cm"]).all()


@pytest.mark.parametrize("window", [np.inf, np.nan, -1.0])
def test_a_window_is_a_time(window: float) -> None:
    refuse(lambda: sepcal.aero_coefficients(flown(), AIRCRAFT, window=window), "window is")
