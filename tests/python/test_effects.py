# SPDX-License-Identifier: BSD-3-Clause
"""Effects by name from Python: on flights, added one after the other, kept; the catalogue."""

import pickle
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import sepcal
from refusals import refuse

PROBE = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
MAGNETOMETER = sepcal.Magnetometer(field=(19.7, -1.4, 49.4))
HIDDEN = {"wind[altitude_m]": 0.02, "pressure_offset[throttle]": 8.0}


@pytest.fixture(scope="module")
def flight() -> sepcal.Flight:
    """Wind shear and propwash."""
    return sepcal.simulate(PROBE, rows=600, seed=1, hide=HIDDEN)


@pytest.fixture(scope="module")
def base(flight: sepcal.Flight) -> sepcal.Calibration:
    """Fitted without them."""
    return sepcal.fit(PROBE, flight)


@pytest.fixture(scope="module")
def better(base: sepcal.Calibration) -> sepcal.Calibration:
    """Both of them added, one by its alias."""
    return base.add("wind_shear").add("propwash")


def total_rmse(calibration: sepcal.Calibration) -> float:
    """Over all outputs together."""
    return float(np.sqrt(np.mean(calibration.compare().residuals ** 2)))


# --- flights


def test_hidden_effects_are_estimated(flight: sepcal.SimulatedFlight) -> None:
    """Within five standard errors of the truth: a false alarm in a million."""
    fit = sepcal.fit(PROBE, flight, effects=list(HIDDEN))
    assert fit.status == "converged", fit.message
    assert [effect.name for effect in fit.effects] == list(HIDDEN)
    for name in fit.names:
        assert abs(fit[name].value - flight.truth[name]) < 5 * fit[name].standard_error, name
    assert set(fit.names) - set(PROBE.parameters) == {
        "wind[altitude_m].n",
        "wind[altitude_m].e",
        "pressure_offset[throttle].s",
    }


def test_what_effects_took_from_the_record(flight: sepcal.Flight) -> None:
    names = ["wind[altitude_m]", "wind[spline(time,5)]", "airspeed_scale[alpha^2]"]
    shear, smooth, loss = sepcal.fit(PROBE, flight, effects=names).effects
    time, altitude = flight["time_s"], flight["altitude_m"]
    assert shear.centre == pytest.approx(altitude.mean(), rel=1e-12)
    assert (shear.knots, shear.labels, shear.span, shear.t0) == ((), (), None, None)
    assert_allclose(smooth.knots, np.linspace(time[0], time[-1], 5), atol=2**-23, rtol=0)
    assert smooth.centre is None
    assert loss.centre == 0.0


def test_the_time_of_a_step() -> None:
    hide = {"bias_step": (3.0, -2.0, 4.0, 20.0)}
    flight = sepcal.simulate(MAGNETOMETER, rows=600, seed=2, hide=hide)
    (step,) = sepcal.fit(MAGNETOMETER, flight, effects=["bias_step"]).effects
    time = flight["time_s"]
    assert step.span == (time[0], time[-1])
    assert step.t0 is not None
    assert abs(step.t0 - 20.0) < 2 * np.diff(time).max()


def test_labels_in_order(flight: sepcal.Flight) -> None:
    (by_label,) = sepcal.fit(PROBE, flight, effects=["wind[maneuver]"]).effects
    assert by_label.labels == tuple(dict.fromkeys(flight.maneuvers))


def test_several_in_one_name(flight: sepcal.Flight) -> None:
    one = sepcal.fit(PROBE, flight, effects=["wind_shear+propwash"])
    two = sepcal.fit(PROBE, flight, effects=["wind[altitude_m]", "pressure_offset[throttle]"])
    assert one.to_json() == two.to_json()


def test_no_effects_are_no_effects(flight: sepcal.Flight, base: sepcal.Calibration) -> None:
    assert base.effects == base.history == base.own_effects == []
    assert sepcal.fit(PROBE, flight, effects=[]).to_json() == base.to_json()
    assert sepcal.fit(PROBE, flight, effects=None).to_json() == base.to_json()


# --- adding


def test_adding_one_after_the_other(
    flight: sepcal.Flight, base: sepcal.Calibration, better: sepcal.Calibration
) -> None:
    """As both at once; the history tells each step's errors, as the residuals have them."""
    at_once = sepcal.fit(PROBE, flight, effects=list(HIDDEN))
    errors = np.sqrt(np.diag(at_once.covariance))
    assert better.names == at_once.names
    assert_allclose(better.values / errors, at_once.values / errors, rtol=0, atol=1e-5)
    first, second = better.history
    assert [first.effect, second.effect] == list(HIDDEN)
    assert first.rmse_before == pytest.approx(total_rmse(base), rel=1e-12)
    assert first.rmse_after == pytest.approx(total_rmse(base.add("wind_shear")), rel=1e-12)
    assert second.rmse_before == first.rmse_after
    assert second.rmse_after == pytest.approx(total_rmse(better), rel=1e-12)
    assert second.rmse_after < second.rmse_before < first.rmse_before
    for entry in (first, second):
        assert entry.rmse_before
        assert entry.rmse_after
        assert entry.held_out_before
        assert entry.predicted_drop == pytest.approx(1 - entry.rmse_after / entry.rmse_before, 0.05)
        assert entry.held_out_after < entry.held_out_before
    assert base.history == []


def test_adding_two_at_once_is_one_step(base: sepcal.Calibration) -> None:
    pair = base.add("wind_shear + propwash")
    (step,) = pair.history
    assert step.effect == "wind[altitude_m]+pressure_offset[throttle]"
    assert [effect.name for effect in pair.effects] == list(HIDDEN)


def test_adding_to_a_loaded_calibration(
    flight: sepcal.Flight, base: sepcal.Calibration, better: sepcal.Calibration, tmp_path: Path
) -> None:
    base.add("wind_shear").save(tmp_path / "base.json")
    loaded = sepcal.load(tmp_path / "base.json")
    assert loaded.add("propwash", flight).to_json() == better.to_json()
    refuse(lambda: loaded.add("propwash"), "no flight", "add(..., sepcal.read('")


def test_effects_that_cannot_be_added(base: sepcal.Calibration) -> None:
    refuse(lambda: base.add("wind_shear").add("wind[altitude_m]"), "wind[altitude_m]", "already")
    refuse(lambda: base.add("gremlins"), "'gremlins'", "wind[driver]", "heading_bias")
    refuse(lambda: base.add(""), "name is missing")


# --- kept


def test_a_calibration_with_effects_is_kept(
    flight: sepcal.Flight, better: sepcal.Calibration, tmp_path: Path
) -> None:
    better.save(tmp_path / "better.json")
    for kept in (sepcal.load(tmp_path / "better.json"), pickle.loads(pickle.dumps(better))):
        assert kept.to_json() == better.to_json()
        assert (kept.effects, kept.history) == (better.effects, better.history)
        assert_array_equal(kept.compare(flight).residuals, better.compare().residuals)
        for header, values in better.apply(flight).items():
            assert_array_equal(kept.apply(flight)[header], values)


def test_the_record_of_a_flight(flight: sepcal.Flight) -> None:
    """A probe's effects on plain columns are those on a flight."""
    own = {*PROBE.inputs, *PROBE.outputs, "time"}
    bare = {header: header.rpartition("_")[0] for header in flight}
    record = {
        name if (name := bare[header]) in own else header: values
        for header, values in flight.items()
    }
    as_flight = sepcal.fit(PROBE, flight, effects=list(HIDDEN))
    as_record = sepcal.fit(PROBE, {**record, "maneuver": flight.maneuvers}, effects=list(HIDDEN))
    assert as_record.effects == as_flight.effects
    assert_array_equal(as_record.values, as_flight.values)


# --- the catalogue


@pytest.mark.parametrize(
    ("probe", "some"),
    [
        (PROBE, {"wind[altitude_m]", "heading_bias", "time_offset"}),
        (sepcal.PitotStatic(), {"wind[time]", "pneumatic_lag"}),
        (MAGNETOMETER, {"bias[current_a]", "cubic_nonlinearity"}),
        (sepcal.Magnetometer(field_strength=50.0), {"bias_step"}),
    ],
)
def test_the_catalogue(probe: sepcal.FiveHoleProbe, some: set[str]) -> None:
    listed = sepcal.effects(probe)
    assert listed == sepcal.effects(probe.name)
    names = [effect.name for effect in listed]
    assert some <= set(names)
    assert len(set(names)) == len(names)
    assert all(effect.equation and effect.drivers and effect.unit for effect in listed)


def test_the_catalogue_of_nothing() -> None:
    refuse(lambda: sepcal.effects("pendulum"), "'pendulum'", "five-hole", "magnetometer-norm")
