# SPDX-License-Identifier: BSD-3-Clause
"""What is hidden in the study's flights. The simulator shares no code with the effects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sepcal.calibration import Calibration
from sepcal.fitting import fit
from sepcal.flight import Flight
from sepcal.models import FiveHoleProbe, Magnetometer, PitotStatic
from sepcal.simulation import SimulatedFlight, simulate

Probe = FiveHoleProbe | PitotStatic | Magnetometer

PROBES: dict[str, Probe] = {
    "five-hole": FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02)),
    "pitot-static": PitotStatic(),
    "magnetometer": Magnetometer(),
}
NOISE = {"five-hole": 0.15, "pitot-static": 0.3, "magnetometer": 0.3}  # the simulator's own
OUTPUTS = {
    "five-hole": ("vn", "ve", "vd"),
    "pitot-static": ("airspeed",),
    "magnetometer": ("mx", "my", "mz"),
}
NOISES = ("white", "ar", "pink", "bursty")


@dataclass(frozen=True)
class Case:
    """An effect of the catalogue in a flight; `size` is one that the flight shows clearly."""

    probe: str
    effect: str
    size: float | Sequence[float]
    rows: int = 500
    shapes: int = 0  # how many of the sizes, at the end, are no sizes but a delay or an exponent

    def sizes(self, factor: float) -> list[float]:
        """The sizes times a factor, its shape as it is."""
        sizes = np.atleast_1d(np.asarray(self.size, dtype=float)).copy()
        sizes[: sizes.size - self.shapes] *= factor
        return [float(size) for size in sizes]


CASES = (
    Case("five-hole", "wind[altitude_m]", 0.02),
    Case("five-hole", "wind[time]", (0.02, -0.01)),
    Case("five-hole", "wind[spline(time,6)]", (1, 0.5, -1, 0.3, 0.6, -0.4, 0.8, 1.2, -0.6, 0.2)),
    Case("five-hole", "wind[maneuver]", 0.7),
    Case("five-hole", "airspeed_scale[alpha^2]", 1.0),
    Case("five-hole", "airspeed_scale[beta^2]", 2.0),
    Case("five-hole", "airspeed_scale[flap]", 0.02),
    Case("five-hole", "airspeed_bias[throttle]", 2.0),
    Case("five-hole", "pressure_offset[throttle]", 25.0),
    Case("five-hole", "alpha_offset[beta]", 0.1),
    Case("five-hole", "alpha_offset[beta^2]", 0.6),
    Case("five-hole", "beta_offset[flap]", 0.02),
    Case("five-hole", "heading_bias", 0.05),
    Case("five-hole", "time_offset", 0.08, rows=1200),
    Case("five-hole", "pneumatic_lag", 0.08, rows=1200),
    Case("five-hole", "lever_arm", (0.5, -0.4, 0.3)),
    Case("five-hole", "upwash", 0.4),
    Case("five-hole", "sidewash", -0.3),
    Case("five-hole", "icing_ramp", -0.002),
    Case("five-hole", "water_blockage", -0.1),
    Case("pitot-static", "wind[altitude_m]", 0.05),
    Case("pitot-static", "wind[time]", 0.03),
    Case("pitot-static", "airspeed_scale[flap]", 0.03),
    Case("pitot-static", "airspeed_bias[throttle]", 2.0),
    Case("pitot-static", "pressure_offset[throttle]", 40.0),
    Case("pitot-static", "time_offset", 0.15, rows=1200),
    Case("pitot-static", "pneumatic_lag", 0.1, rows=1200),
    Case("pitot-static", "icing_ramp", -0.003),
    Case("pitot-static", "water_blockage", -0.15),
    Case("magnetometer", "bias[current_a]", (0.3, -0.2, 0.25)),
    Case("magnetometer", "bias[throttle^n]", (6.0, -4.0, 5.0)),
    Case("magnetometer", "bias[delay(current_a)]", (0.6, -0.5, 0.4, 0.06), rows=800, shapes=1),
    Case("magnetometer", "bias[panel_current_a]", 0.8),
    Case("magnetometer", "bias[temp_degc]", 0.3),
    Case("magnetometer", "bias[temp_degc^2]", 0.1),
    Case("magnetometer", "bias[time]", 0.02),
    Case("magnetometer", "scale[temp_degc]", 0.003),
    Case("magnetometer", "axis_scale[temp_degc]", (0.004, -0.003, 0.002)),
    Case("magnetometer", "bias_step", (2.0, -1.5, 1.0)),
    Case("magnetometer", "warm_up", (5.0, -4.0, 3.0)),
    Case("magnetometer", "cubic_nonlinearity", (1e-5, -1e-5, 2e-5, 1e-4, 2e-4, -1e-4)),
    Case("magnetometer", "eddy_currents", 0.02, rows=800),
    Case("magnetometer", "time_offset", 0.06, rows=800),
    Case("magnetometer", "sensor_lag", 0.06, rows=800),
    Case("magnetometer", "field_declination", 0.05),
)

PAIRS = (
    (CASES[0], CASES[8]),  # wind shear and propwash
    (CASES[12], CASES[7]),  # heading and throttle
    (CASES[22], CASES[21]),  # flap and wind drift on a tube
    (CASES[29], CASES[33]),  # current and temperature
    (CASES[36], CASES[30]),  # scale by temperature and throttle
)

PROXIED = CASES[29]  # by the battery's voltage
UNLOGGED = (
    CASES[6],  # flaps that are set from time to time
    CASES[11],
    CASES[32],  # a current that comes and goes like noise
)

INVISIBLE = (
    Case("five-hole", "mounting_error", (0.02, 0.03)),
    Case("magnetometer", "attitude_bias", (0.02, -0.02)),
)


def calibrate(
    probe: str, flight: Flight, *, segments: str = "", drop_repeats: Sequence[str] = ()
) -> Calibration:
    """The probe without effects, on one thread: the study runs flights side by side."""
    return fit(
        PROBES[probe],
        flight,
        stage_one_segments=segments,
        stage_two_segments=segments,
        drop_repeats=drop_repeats,
        threads=1,
    )


def fly(
    probe: str,
    hide: dict[str, list[float]],
    seed: int,
    rows: int,
    noise: str = "white",
    decoys: int = 0,
) -> SimulatedFlight:
    """A condensed flight of two minutes."""
    return simulate(probe, hide=hide, noise=noise, decoys=decoys, rows=rows, seed=seed)


def factor_for(case: Case, sigmas: float) -> float:
    """What to multiply a case's size by for a noncentrality of sigmas^2.

    That is what the best fit without the effect, in the study's weights, leaves of a flight without
    noise, in units of the noise's variance. It grows about as the size squared.
    """
    quiet = dict.fromkeys(OUTPUTS[case.probe], 1e-9)
    weights = dict.fromkeys(OUTPUTS[case.probe], NOISE[case.probe])
    factor = 1.0
    for _ in range(2):
        flight = simulate(
            case.probe, hide={case.effect: case.sizes(factor)}, noise=quiet, rows=case.rows, seed=7
        )
        left = fit(PROBES[case.probe], flight, noise=weights, threads=1)
        square = sum(rmse**2 for rmse in left.rmse.values()) * left.rows / NOISE[case.probe] ** 2
        factor *= sigmas / float(np.sqrt(square))
    return factor
