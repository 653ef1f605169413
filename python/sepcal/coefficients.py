# SPDX-License-Identifier: BSD-3-Clause
"""The aerodynamic coefficients that a flight had."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sepcal.arguments import checked
from sepcal.columns import Array, Columns, by_name, labels_in, take_columns
from sepcal.geometry import Aircraft
from sepcal.matrices import to_number
from sepcal.states_module import states_module


@dataclass(frozen=True)
class AeroCoefficients:
    """The result of aero_coefficients().

    Attributes:
        columns: {name: (N,)}: those given, airspeed, alpha and beta moved to the centre of gravity,
            the coefficients and, where there are rates, p_hat, q_hat, r_hat, and pdot, qdot, rdot
            [rad/s^2]. NaN outside the segments.
        names: The coefficients that were computed.
        window: Window of the local cubic that differentiated the rates [s]; NaN where pdot, qdot,
            rdot were given.
        notes: Notes on how to read them, a sentence each.

    Example:
        >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
        >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
        >>> aircraft = sepcal.Aircraft(**size, **mass)
        >>> level = {"time": [0.0, 1.0, 2.0], "az": [-9.81] * 3, "rho": [1.2] * 3, "ax": [0.0] * 3}
        >>> flow = {"airspeed": [50.0] * 3, "alpha": [0.05] * 3, "beta": [0.0] * 3}
        >>> found = sepcal.aero_coefficients({**level, **flow}, aircraft, ["CZ"])
        >>> found.names, found.columns["CZ"].shape
        (['CZ'], (3,))
    """

    columns: dict[str, Array]
    names: list[str]
    window: float
    notes: list[str]


@checked
def aero_coefficients(
    data: Columns,
    aircraft: Aircraft,
    coefficients: Sequence[str] = (),
    *,
    window: float = 0.0,
) -> AeroCoefficients:
    """CX, CY, CZ, Cl, Cm, Cn of every sample, from what the inertial unit read (S 6.14 to 6.19).

    Args:
        data: Columns in SI, (N,) each: `time`; `ax ay az`, specific forces at aircraft.imu (level
            flight reads az = -9.81); `p q r`; `airspeed`, `alpha`, `beta` at aircraft.vane; `rho`
            or `qbar`. Where there are: `thrust` [N], `mass` [kg], `pdot qdot rdot`, `maneuver`.
            Only what the chosen coefficients need is asked for.
        aircraft: The aircraft that flew.
        coefficients: Which [all six].
        window: Window of the local cubic that differentiates p, q and r [s]; 0: seven rows.

    Raises:
        Error: What is missing, with the way out; degrees; a vertical acceleration that is no
            specific force.

    Example:
        >>> size = {"area": 16.2, "chord": 1.49, "span": 10.9}
        >>> mass = {"mass": 1100.0, "inertia": (1285.0, 1825.0, 2667.0, 0.0)}
        >>> aircraft = sepcal.Aircraft(**size, **mass)
        >>> level = {"time": [0.0, 1.0, 2.0], "az": [-9.81] * 3, "rho": [1.2] * 3, "ax": [0.0] * 3}
        >>> flow = {"airspeed": [50.0] * 3, "alpha": [0.05] * 3, "beta": [0.0] * 3}
        >>> found = sepcal.aero_coefficients({**level, **flow}, aircraft, ["CZ"])
        >>> lift = 1100.0 * 9.81 / (0.5 * 1.2 * 50.0**2 * 16.2)
        >>> bool(np.allclose(found.columns["CZ"], -lift))
        True
    """
    given = by_name(data)
    numbers = [name for name in given if name != "maneuver"]
    columns = take_columns("aero_coefficients", given, numbers)
    seconds = to_number("window", window)
    found, names, used, notes = states_module().aero_coefficients(
        columns,
        labels_in(given),
        aircraft.to_json(),
        list(coefficients),
        seconds,
    )
    return AeroCoefficients(found, names, used, notes)
