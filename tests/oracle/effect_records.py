# SPDX-License-Identifier: BSD-3-Clause
"""Records in which an effect is hidden: the oracle's inputs, drivers beside them, outputs anew."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from oracle.attitude_independent_magnetometer import AttitudeIndependentMagnetometer
from oracle.cases import K_ALPHA, K_BETA, LEVER_ARM
from oracle.effect_cases import EffectCase
from oracle.effects import (
    FiveHoleWithEffects,
    MagnetometerWithEffects,
    NormWithEffects,
    PitotStaticWithEffects,
    VaneBoomWithEffects,
    WithEffects,
)
from oracle.five_hole_probe import FiveHoleProbe
from oracle.magnetometer import Magnetometer
from oracle.model import Array, Held, Model
from oracle.pitot_static import PitotStatic
from oracle.simulate import (
    FIVE_HOLE_NOISE,
    FIVE_HOLE_TRUTH,
    MAGNETOMETER_NOISE,
    MAGNETOMETER_TRUTH,
    Columns,
    draw_smooth,
    simulate_five_hole,
    simulate_magnetometer,
    simulate_vane_boom,
)
from oracle.vane_boom import VaneBoom

ROWS = 600
PITOT_STATIC_TRUTH = np.array([0.96, 0.5, -3.8, 2.4, 0.0])
PITOT_STATIC_NOISE = np.array([0.1])  # [m/s]
NORM_NOISE = 0.3  # [uT]
GAS_CONSTANT = 287.05287  # of air [J/(kg K)]


@dataclass(frozen=True)
class Hidden:
    """A record with an effect in it, and what it takes to fit it again."""

    case: EffectCase
    record: Columns
    times: Mapping[str, float]  # the true t0 by parameter
    truth: Array  # of the model's own parameters, then the effects'
    noise: Array  # standard deviation of each output
    kind: type[WithEffects]
    base: Model

    def model(self, times: Mapping[str, float] | None = None) -> Held:
        """The composition with its held parameters, for t0 as found (by default the true one)."""
        whole = self._compose(self.times if times is None else times)
        return Held(whole, self.held)

    @property
    def held(self) -> dict[str, float]:
        """What a fit of this record has to hold, by name."""
        return dict(self.case.held) | ({"w_d": 0.0} if "w_d" in self.base.nonlinear else {})

    @property
    def start(self) -> Array:
        """The truth of what is not held."""
        names = self._compose(self.times).parameters
        return self.truth[[name not in self.held for name in names]]

    def _compose(self, times: Mapping[str, float]) -> WithEffects:
        return self.kind(self.base, self.case.effects(self.record, times), self.case.reach)


def hide_in_five_hole(case: EffectCase) -> Hidden:
    """A circle in the wind, as for the plain probe."""
    probe = FiveHoleProbe(K_ALPHA, K_BETA, LEVER_ARM)
    inputs = simulate_five_hole(probe, seed=11, rows=ROWS, airspeed=case.airspeed)
    as_read = probe.read(inputs)
    record = _add_air_drivers(inputs) | {"alpha": as_read.alpha, "beta": as_read.beta}
    return _hide(case, record, FIVE_HOLE_TRUTH, FIVE_HOLE_NOISE, FiveHoleWithEffects, probe)


def hide_in_vane_boom(case: EffectCase) -> Hidden:
    """The same circle with vanes, of other draws."""
    boom = VaneBoom(LEVER_ARM)
    inputs = simulate_vane_boom(boom, seed=18, rows=ROWS, airspeed=case.airspeed)
    record = _add_air_drivers(inputs | {"ps": np.full(ROWS, 95_000.0)})
    return _hide(case, record, FIVE_HOLE_TRUTH, FIVE_HOLE_NOISE, VaneBoomWithEffects, boom)


def hide_in_pitot_static(case: EffectCase) -> Hidden:
    """The same flight with a plain tube; its ground velocity is exact."""
    probe = FiveHoleProbe(K_ALPHA, K_BETA, LEVER_ARM)
    inputs = simulate_five_hole(probe, seed=12, rows=ROWS, airspeed=case.airspeed)
    velocity = probe.predict(inputs, FIVE_HOLE_TRUTH)
    record = {name: inputs[name] for name in ("p", "q", "r", "rho", "ps")}
    record |= dict(zip(("vn", "ve", "vd"), velocity, strict=True))
    record["dp"] = inputs["pt"] - inputs["ps"]
    record = _add_air_drivers(record)
    return _hide(
        case,
        record,
        PITOT_STATIC_TRUTH,
        PITOT_STATIC_NOISE,
        PitotStaticWithEffects,
        PitotStatic(),
    )


def hide_in_magnetometer(case: EffectCase) -> Hidden:
    """A field over the whole sphere; attitude and rates smooth, and of no other meaning."""
    record = _add_field_drivers(
        simulate_magnetometer(Magnetometer(), seed=13, rows=ROWS, pace=case.pace)
    )
    return _hide(
        case,
        record,
        MAGNETOMETER_TRUTH,
        MAGNETOMETER_NOISE,
        MagnetometerWithEffects,
        Magnetometer(),
    )


def hide_in_norm(case: EffectCase) -> Hidden:
    """The same without eta, equal noise on every axis, and of the field its strength alone."""
    truth = MAGNETOMETER_TRUTH.copy()
    truth[6:9] = 0.0
    record = _add_field_drivers(simulate_magnetometer(Magnetometer(), seed=14, rows=ROWS))
    hidden = _hide(
        case, record, truth, np.full(3, NORM_NOISE), MagnetometerWithEffects, Magnetometer()
    )
    strength = float(np.sqrt(sum(record[name][0] ** 2 for name in ("hx", "hy", "hz"))))
    own = np.concatenate([truth[:3], truth[9:], truth[3:6]])
    columns = {
        name: values
        for name, values in hidden.record.items()
        if name not in ("hx", "hy", "hz", "roll", "pitch", "yaw")
    }
    return Hidden(
        case,
        columns,
        hidden.times,
        np.concatenate([own, hidden.truth[truth.size :]]),
        np.array([NORM_NOISE]),
        NormWithEffects,
        AttitudeIndependentMagnetometer(strength, noise=NORM_NOISE),
    )


def _hide(
    case: EffectCase,
    record: Columns,
    own: Array,
    noise: Array,
    kind: type[WithEffects],
    base: Model,
) -> Hidden:
    """Computes the outputs with the effects at their true size and adds white noise."""
    if "maneuver" not in case.name:  # labels cut a record, and nothing is interpolated across
        record = {name: values for name, values in record.items() if name != "maneuver"}
    times = {case.start_time: float(record["time"][ROWS // 3])} if case.start_time else {}
    truth = own.copy()
    for name, value in case.held.items():
        truth[base.parameters.index(name)] = value
    truth = np.concatenate([truth, case.sizes])
    exact = kind(base, case.effects(record, times)).respond(record, truth)
    noisy = exact + noise[:, np.newaxis] * np.random.default_rng(15).standard_normal(exact.shape)
    record = record | dict(zip(base.outputs, noisy, strict=True))
    return Hidden(case, record, times, truth, noise, kind, base)


def _add_air_drivers(inputs: Columns) -> Columns:
    """Time, labels and channels that are independent of the motion; the air cools with height."""
    rng = np.random.default_rng(16)
    time = 0.1 * np.arange(ROWS)
    altitude = 300.0 + draw_smooth(rng, time, 60.0)[0]
    temperature = 265.0 + draw_smooth(rng, time, 20.0)[0]
    return inputs | {
        "time": time,
        "altitude_m": altitude,
        "temperature": temperature,
        "rho": inputs["ps"] / (GAS_CONSTANT * temperature) if "pt" not in inputs else inputs["rho"],
        "throttle": np.clip(0.5 + draw_smooth(rng, time, 0.25)[0], 0.0, 1.0),
        "current_a": 12.0 + draw_smooth(rng, time, 6.0)[0],
        "maneuver": _label(time),
    }


def _add_field_drivers(inputs: Columns) -> Columns:
    rng = np.random.default_rng(17)
    time = 0.1 * np.arange(ROWS)
    motion = {
        name: draw_smooth(rng, time, 0.4)[0] for name in ("roll", "pitch", "yaw", "p", "q", "r")
    }
    return (
        inputs
        | motion
        | {
            "time": time,
            "temp_degc": 25.0 + draw_smooth(rng, time, 8.0)[0],
            "throttle": np.clip(0.5 + draw_smooth(rng, time, 0.25)[0], 0.0, 1.0),
            "current_a": 12.0 + draw_smooth(rng, time, 6.0)[0],
            "maneuver": _label(time),
        }
    )


def _label(time: Array) -> Array:
    """Three labels, one of which returns."""
    names = np.array(["climb", "turn", "cruise", "turn"])
    return names[(4 * np.arange(time.size)) // time.size]
