# SPDX-License-Identifier: BSD-3-Clause
"""What an instrument of the simulator is, and what its log is made of.

By the physics of docs/effects.md. `measure` makes a log of the true motion, `predict` the outputs
that a model with the true parameters expects of the logged inputs; of a log without noise the two
agree.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from studies.trust.noises import Array
from studies.trust.simulator.manoeuvres import Motion

Columns: TypeAlias = dict[str, Array]  # by header
Truth: TypeAlias = dict[str, float]  # by parameter
Change: TypeAlias = Mapping[str, Array]  # by port: (components, N), what is hidden there

ATTITUDE = ("roll_rad", "pitch_rad", "yaw_rad")
RATES = ("p_radps", "q_radps", "r_radps")
VELOCITY = ("vn_mps", "ve_mps", "vd_mps")
AIR_DATA = ("pt_pa", "ps_pa", "dpa_pa", "dpb_pa", "rho_kgpm3")
READINGS = ("mx_ut", "my_ut", "mz_ut")
SEA_LEVEL = 1.225  # [kg/m^3]
AIR_PORTS = {
    "wind": ("n", "e"),
    "airspeed_scale": ("s",),
    "airspeed_bias": ("s",),
    "pressure_offset": ("s",),
}


@dataclass(frozen=True)
class Instrument:
    """One of three."""

    name: str
    lively: bool  # whether its flights rock and nod
    outputs: tuple[str, ...]  # headers
    ports: Mapping[str, tuple[str, ...]]  # where something may be hidden, its components
    draw_truth: Callable[[np.random.Generator], Truth]  # parameters as such instruments have them
    measure: Callable[[Motion, Truth, Change, Array], Columns]  # gusts (N, 3) move the air alone
    predict: Callable[[Columns, Truth, Change], Array]  # (N, outputs)


def wind_of(truth: Truth, change: Change, rows: int) -> Array:
    """(N, 3), north, east and down."""
    wind = np.tile([truth["w_n"], truth["w_e"], truth.get("w_d", 0.0)], (rows, 1))
    wind[:, :2] += change.get("wind", np.zeros((2, 1))).T
    return wind


def driven(change: Change, port: str) -> Array:
    """(N,), or (1,) of zero where nothing drives the port."""
    return change[port][0] if port in change else np.zeros(1)


def density_of(motion: Motion) -> Array:
    """Of the standard atmosphere [kg/m^3]."""
    return SEA_LEVEL * (1.0 - 2.25577e-5 * motion.altitude) ** 4.2559


def stack(log: Columns, headers: tuple[str, ...]) -> Array:
    """(N, 3)."""
    return np.stack([log[header] for header in headers], axis=-1)


def turn(matrices: Array, vectors: Array) -> Array:
    """(N, 3, 3) on (N, 3)."""
    return np.asarray(np.einsum("nij,nj->ni", matrices, vectors))
