# SPDX-License-Identifier: BSD-3-Clause
"""What must not matter to an estimate: here, from when on time is counted."""

import numpy as np
import pytest

import sepcal

EPOCH = 1.7e9  # [s] a stamp of today, counted from 1970
EFFECTS = [
    (),
    ("time_offset",),
    ("pneumatic_lag",),
    ("wind[delay(throttle)]",),
    ("airspeed_bias[time^2]",),
    ("airspeed_bias[spline(time,6)]",),
    ("airspeed_bias[step(time)]",),
    ("airspeed_bias[decay(time)]",),
]


def fly(start: float, step: float) -> sepcal.Flight:
    """A tube's flight whose rows are `step` seconds apart, the first at `start`."""
    columns = dict(sepcal.simulate("pitot-static", rows=600, seed=3))
    columns["time_s"] = start + step * np.arange(600)
    return sepcal.Flight(columns)


def shifted_by(flight: sepcal.Flight, other: sepcal.Flight, effects: tuple[str, ...]) -> float:
    """The largest difference of a parameter between two fits, in standard errors."""
    first, second = (
        sepcal.fit(sepcal.PitotStatic(), at, effects=effects) for at in (flight, other)
    )
    assert first.status == second.status
    shifts = []
    for name, parameter in first.parameters.items():
        difference = second[name].value - parameter.value
        if name.endswith(".t0"):
            difference -= EPOCH
        if parameter.standard_error > 0:
            shifts.append(abs(difference) / parameter.standard_error)
    return max(shifts)


@pytest.mark.parametrize("effects", EFFECTS, ids=lambda effects: " ".join(effects) or "none")
def test_stamps_of_today_in_binary_fractions(effects: tuple[str, ...]):
    """1/64 s at 1.7e9 s has every bit: nothing is lost but from knots, fifths of the record."""
    tolerance = 1e-6 if any("spline" in name for name in effects) else 1e-9
    assert shifted_by(fly(0.0, 1 / 64), fly(EPOCH, 1 / 64), effects) < tolerance


@pytest.mark.parametrize("effects", EFFECTS, ids=lambda effects: " ".join(effects) or "none")
def test_stamps_of_today_in_decimals(effects: tuple[str, ...]):
    """A stamp is then off by 1e-7 s, a step of time by 5e-6 of itself."""
    assert shifted_by(fly(0.0, 0.02), fly(EPOCH, 0.02), effects) < 1e-4
