# SPDX-License-Identifier: BSD-3-Clause
"""The Pitot-static tube: z = s_va V_met + c_va, V_met what the tube meets of V = |v_ground - W|.

V = V_met (1 + scale) + bias where rho V^2 / 2 is corrected by an offset, that is
V_met = sqrt(((V - bias) / (1 + scale))^2 - 2 offset / rho); the three are columns, zero if absent.
"""

from typing import ClassVar, NamedTuple

import numpy as np

from oracle.model import Array, Model, Record

SEA_LEVEL_DENSITY = 1.225  # [kg/m^3]


class Air(NamedTuple):
    """What the tube is in; each of shape (N,)."""

    velocity: Array  # v_ground - W [m/s], shape (3, N)
    speed: Array  # V, its length
    undisturbed: Array  # (V - bias) / (1 + scale)
    met: Array  # V_met


class PitotStatic(Model):
    """xi = (s_va, c_va | w_n, w_e, w_d)."""

    outputs: ClassVar = ("airspeed",)
    linear: ClassVar = ("s_va", "c_va")
    nonlinear: ClassVar = ("w_n", "w_e", "w_d")

    def predict(self, record: Record, xi: Array) -> Array:
        """The reading without noise [m/s], shape (1, N)."""
        return (xi[0] * find_air(record, xi[2:]).met + xi[1])[np.newaxis]

    def jacobian(self, record: Record, xi: Array) -> Array:
        """Its derivative, shape (1, N, 5); dV_met/dV = undisturbed / ((1 + scale) V_met)."""
        air = find_air(record, xi[2:])
        slope = air.undisturbed / ((1 + record.get("airspeed_scale", 0.0)) * air.met)
        by_wind = -xi[0] * slope * air.velocity / air.speed
        columns = [air.met, np.ones_like(air.met), *by_wind]
        return np.stack(columns, axis=-1)[np.newaxis]


def find_air(record: Record, wind: Array) -> Air:
    """The air that meets the tube, for wind [m/s] of shape (3,) or (3, N)."""
    velocity = np.stack(
        [record[name] - w for name, w in zip(("vn", "ve", "vd"), wind, strict=True)]
    )
    speed = np.sqrt(np.sum(velocity**2, axis=0))
    undisturbed = (speed - record.get("airspeed_bias", 0.0)) / (
        1 + record.get("airspeed_scale", 0.0)
    )
    density = record.get("rho", SEA_LEVEL_DENSITY)
    met = np.sqrt(undisturbed**2 - 2 * record.get("pressure_offset", 0.0) / density)
    return Air(velocity, speed, undisturbed, met)
