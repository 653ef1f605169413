# SPDX-License-Identifier: BSD-3-Clause
"""Every effect on every probe: its name, the oracle's own version of it, and a hidden size."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from oracle import drivers
from oracle.drivers import Driver, power
from oracle.effects import Effect
from oracle.model import Array

Columns = Mapping[str, Array]
WIND = {"n": "wind_n", "e": "wind_e"}
AXES = {axis: f"bias_{axis}" for axis in "xyz"}
AXIS_SCALES = {axis: f"axis_scale_{axis}" for axis in "xyz"}
LONGEST = 0.25  # [s], the bound of every delay and lag here; no multiple of a sample
OLDEST = 7.0459054023934655  # lags that a lagging output looks back: Laguerre's fifth node of eight


@dataclass(frozen=True)
class EffectCase:
    """One fit: `name` may join several effects by '+'.

    `effects` makes the oracle's, given the record and the times t0 of its steps. A smooth
    record gives what is interpolated along outputs to `tolerance` standard errors, all else to
    1e-8.
    """

    name: str
    effects: Callable[[Columns, Mapping[str, float]], tuple[Effect, ...]]
    sizes: Sequence[float]  # the truth of every parameter but t0
    start_time: str = ""  # the parameter that a scan finds
    held: Mapping[str, float] = field(default_factory=dict)
    delays: Sequence[str] = ()  # parameters within +-LONGEST
    lags: Sequence[str] = ()  # parameters from 0 to LONGEST
    reach: float = 0.0  # [s]: rows nearer than that to an end are not used
    airspeed: float = 15.0  # [m/s]
    pace: float = 1.0  # of a magnetometer's turning
    tolerance: float = 1e-8


def driven(
    name: str, ports: Mapping[str, str], driver: Callable[[Columns], Driver], *sizes: float
) -> EffectCase:
    """`port[driver]`."""
    return EffectCase(name, lambda record, _: (Effect(name, ports, driver(record)),), sizes)


def plain(
    name: str, ports: Mapping[str, str], *sizes: float, held: Mapping[str, float] | None = None
) -> EffectCase:
    """An effect without a driver."""
    return EffectCase(name, lambda *_: (Effect(name, ports),), sizes, held=held or {})


def time_offset(port: str, size: float, name: str = "time_offset") -> EffectCase:
    """Readings that come late."""
    return EffectCase(
        name,
        lambda *_: (Effect(name, {"tau": port}),),
        (size,),
        delays=(f"{name}.tau",),
        reach=LONGEST,
    )


def lag(
    name: str,
    port: str,
    size: float,
    reach: float = 0.0,
    tolerance: float = 1e-8,
    pace: float = 1.0,
) -> EffectCase:
    """A first-order lag, of a reading or of what a model predicts."""
    return EffectCase(
        name,
        lambda *_: (Effect(name, {"tau": port}),),
        (size,),
        lags=(f"{name}.tau",),
        reach=reach,
        tolerance=tolerance,
        pace=pace,
    )


def stepped(name: str, ports: Mapping[str, str], *sizes: float) -> EffectCase:
    """A step, whose t0 is whatever a scan found: it has no derivative."""
    start = f"{name}.t0"
    return EffectCase(
        name,
        lambda _, times: (Effect(name, ports, drivers.step(times[start])),),
        sizes,
        start_time=start,
    )


def centred(column: str) -> Callable[[Columns], Driver]:
    """The first power about the mean."""
    return lambda record: power(column, 1, float(record[column].mean()))


def about_zero(column: str, exponent: int = 1) -> Callable[[Columns], Driver]:
    """A power about zero."""
    return lambda record: power(column, exponent)


def smooth(column: str, knots: int) -> Callable[[Columns], Driver]:
    """A spline in the mean zero; evenly spaced knots, those of time in multiples of 2^-22 s."""

    def make(record: Columns) -> Driver:
        even = np.linspace(record[column].min(), record[column].max(), knots)
        rounded = np.round(even * 2.0**22) / 2.0**22 if column == "time" else even
        return drivers.about_mean(drivers.spline(column, rounded), record)

    return make


def by_label(record: Columns) -> Driver:
    """One function for each label but the first that appears."""
    labels = record["maneuver"]
    order = np.sort(np.unique(labels, return_index=True)[1])
    return drivers.categories(labels, [str(label) for label in labels[order][1:]])


def delayed(name: str, port: Mapping[str, str], column: str, *sizes: float) -> EffectCase:
    """`port[delay(column)]`."""
    return EffectCase(
        name,
        lambda *_: (Effect(name, port, drivers.delayed(column)),),
        sizes,
        delays=(f"{name}.tau",),
        reach=LONGEST,
    )


def together(*cases: EffectCase) -> EffectCase:
    """Several effects at once."""
    return EffectCase(
        "+".join(case.name for case in cases),
        lambda record, at: tuple(e for case in cases for e in case.effects(record, at)),
        [size for case in cases for size in case.sizes],
    )


ICING = {"s": "airspeed_scale"}
ON_AIRSPEED = (
    driven("wind[altitude_m]", WIND, centred("altitude_m"), 0.02, -0.03),
    driven("wind[time]", WIND, centred("time"), 0.05, 0.04),
    driven("wind[maneuver]", WIND, by_label, 0.8, -0.6, 0.5, 0.4),
    driven("wind[spline(time,4)]", WIND, smooth("time", 4), 0.8, -0.6, 0.5, 0.4, 0.3, -0.2),
    driven("airspeed_scale[throttle]", ICING, about_zero("throttle"), 0.08),
    driven("airspeed_bias[current_a]", {"s": "airspeed_bias"}, about_zero("current_a"), 0.06),
    driven("pressure_offset[throttle]", {"s": "pressure_offset"}, about_zero("throttle"), 30.0),
    plain("pressure_offset", {"s": "pressure_offset"}, 20.0),
    driven("icing_ramp", ICING, lambda _: drivers.ramp(), -0.006, 20.0),
    stepped("water_blockage", ICING, -0.06),
    plain("density_error", {"s": "temperature_error"}, 20.0),
)

ON_FLOW = (
    *ON_AIRSPEED,
    driven("airspeed_scale[alpha^2]", ICING, about_zero("alpha", 2), 2.0),
    driven("airspeed_scale[beta^2]", ICING, about_zero("beta", 2), 2.0),
    driven("airspeed_bias[throttle^n]", {"s": "airspeed_bias"},
           lambda _: drivers.fitted_power("throttle"), 1.5, 0.7),
    driven("alpha_offset[q]", {"s": "alpha_offset"}, about_zero("q"), 0.04),
    driven("beta_offset[r]", {"s": "beta_offset"}, about_zero("r"), 0.05),
    delayed("airspeed_bias[delay(throttle)]", {"s": "airspeed_bias"}, "throttle", 3.0, 0.08),
    plain("heading_bias", {"delta": "heading_error"}, 0.05),
    plain("lever_arm", {axis: f"lever_{axis}" for axis in "xyz"}, 0.3, -0.2, 0.15),
    plain("upwash", {"k": "upwash"}, 0.4),
    plain("sidewash", {"k": "sidewash"}, -0.5),
    plain("mounting_error", {"pitch": "mount_pitch", "yaw": "mount_yaw"}, 0.03, -0.02,
          held={"b_alpha": 0.0, "b_beta": 0.0}),
    EffectCase("compressibility", lambda *_: (Effect("compressibility", {"s": "compressibility"}),),
               (1.0,), airspeed=120.0),
    plain("angle_loss", {"s": "angle_loss"}, 1.5),
    time_offset("air_delay", 0.07),
    lag("pneumatic_lag", "air_lag", 0.06),
)  # fmt: skip
SEVERAL = together(
    plain("heading_bias", {"delta": "heading_error"}, 0.05),
    driven("pressure_offset[throttle]", {"s": "pressure_offset"}, about_zero("throttle"), 30.0),
    driven("wind[altitude_m]", WIND, centred("altitude_m"), 0.02, -0.03),
    plain("upwash", {"k": "upwash"}, 0.4),
)
FIVE_HOLE = (*ON_FLOW, SEVERAL)
VANE_BOOM = (
    *ON_FLOW,
    time_offset("vane_delay", 0.07, "vane_time_offset"),
    lag("vane_lag", "vane_lag", 0.06),
    SEVERAL,
)

PITOT_STATIC = (
    *ON_AIRSPEED,
    time_offset("delay", 0.07),
    lag("pneumatic_lag", "lag", 0.06, reach=OLDEST * LONGEST, tolerance=0.1),
    together(
        driven("pressure_offset[throttle]", {"s": "pressure_offset"}, about_zero("throttle"), 30.0),
        driven("wind[altitude_m]", WIND, centred("altitude_m"), 0.02, -0.03),
    ),
)  # fmt: skip

ON_FIELD = (
    driven("bias[current_a]", AXES, about_zero("current_a"), 0.5, -0.4, 0.3),
    driven("bias[temp_degc^2]", AXES,
           lambda record: power("temp_degc", 2, float(record["temp_degc"].mean())),
           0.02, -0.03, 0.01),
    driven("bias[time]", AXES, centred("time"), 0.05, 0.04, -0.06),
    driven("bias[maneuver]", AXES, by_label, 2.0, -1.0, 1.5, 1.0, -2.0, 0.5),
    driven("bias[throttle^n]", AXES, lambda _: drivers.fitted_power("throttle"),
           8.0, -6.0, 5.0, 0.7),
    driven("scale[temp_degc]", {"s": "scale"}, centred("temp_degc"), 0.002),
    driven("axis_scale[temp_degc]", AXIS_SCALES, centred("temp_degc"), 0.002, -0.003, 0.001),
    stepped("bias_step", AXES, 3.0, -2.0, 4.0),
    driven("warm_up", AXES, lambda _: drivers.decay(), 6.0, -4.0, 5.0, 8.0),
)  # fmt: skip

MAGNETOMETER = (
    *ON_FIELD,
    delayed("bias[delay(current_a)]", AXES, "current_a", 0.8, -0.6, 0.5, 0.08),
    plain("cubic_nonlinearity",
          {"d_x": "cubic_x", "d_y": "cubic_y", "d_z": "cubic_z",
           "c_x": "square_x", "c_y": "square_y", "c_z": "square_z"},
          2e-6, -1e-6, 1.5e-6, 1e-4, 2e-4, -1e-4),
    plain("eddy_currents", {i + j: f"eddy_{i}{j}" for i in "xyz" for j in "xyz"},
          0.02, 0.01, -0.01, 0.005, 0.03, 0.01, -0.02, 0.01, 0.015),
    plain("field_declination", {"delta": "declination"}, 0.06),
    plain("attitude_bias", {"x": "tilt_x", "y": "tilt_y"}, 0.02, -0.03,
          held={"eta_x": 0.0, "eta_y": 0.0}),
    time_offset("delay", 0.07),
    lag("sensor_lag", "lag", 0.06, reach=OLDEST * LONGEST, tolerance=0.1, pace=0.3),
    together(
        driven("scale[temp_degc]", {"s": "scale"}, centred("temp_degc"), 0.002),
        plain("field_declination", {"delta": "declination"}, 0.06),
        driven("bias[current_a]", AXES, about_zero("current_a"), 0.5, -0.4, 0.3),
    ),
)  # fmt: skip

ATTITUDE_INDEPENDENT = ON_FIELD
