# SPDX-License-Identifier: BSD-3-Clause
"""A five-hole probe's rows, as flight programs take them."""

from __future__ import annotations

import numpy as np

import sepcal
from target_checks.machines import Array

LINEAR = ("lambda_va", "b_va", "w_n", "w_e", "w_d")
NONLINEAR = ("lambda_alpha", "b_alpha", "lambda_beta", "b_beta", "eps_phi")
K = 4.5  # 1/rad, the simulated probe's sensitivities


def fly_probe(seed: int) -> sepcal.SimulatedFlight:
    """A simulated flight of a probe without a lever arm."""
    probe = sepcal.FiveHoleProbe(k_alpha=K, k_beta=K, lever_arm=(0.0, 0.0, 0.0))
    return sepcal.simulate(probe, seed=seed)


def probe_rows(flight: sepcal.Flight) -> Array:
    """A five-hole probe's 14 inputs and 3 outputs, (rows, 17), pressures as differences."""
    columns = (
        "roll_rad pitch_rad yaw_rad p_radps q_radps r_radps pt_pa ps_pa dpa_pa dpb_pa rho_kgpm3"
    )
    u = np.column_stack([flight[column] for column in columns.split()])
    u[:, 6] -= u[:, 7]
    u[:, 7] = 0.0
    z = np.column_stack([flight[column] for column in ("vn_mps", "ve_mps", "vd_mps")])
    return np.column_stack([u, np.zeros((u.shape[0], 3)), z])


def linear_rows(rows: Array, xi2: Array) -> tuple[Array, Array]:
    """A (3 rows, 5) and z - b of the five-hole probe's Eqs. 36 to 42, written down here anew."""
    roll, pitch, yaw = rows[:, :3].T
    pressure = rows[:, 6] - rows[:, 7]
    speed = np.sqrt(2.0 * pressure / rows[:, 10])
    alpha = (1 + xi2[0]) * rows[:, 8] / (K * pressure) + xi2[1]
    beta = (1 + xi2[2]) * rows[:, 9] / (K * pressure) + xi2[3]
    x = np.cos(alpha) * np.cos(beta)
    y = np.sin(beta)
    z = np.sin(alpha) * np.cos(beta)
    c, s = np.cos(xi2[4]), np.sin(xi2[4])
    y, z = c * y + s * z, c * z - s * y
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (np.cos, np.sin))
    north = cp * cy * x + (sr * sp * cy - cr * sy) * y + (cr * sp * cy + sr * sy) * z
    east = cp * sy * x + (sr * sp * sy + cr * cy) * y + (cr * sp * sy - sr * cy) * z
    down = -sp * x + sr * cp * y + cr * cp * z
    F = np.stack([north, east, down], axis=1)
    A = np.zeros((rows.shape[0], 3, 5))
    A[:, :, 0] = F * speed[:, None]
    A[:, :, 1] = F
    A[:, :, 2:] = np.eye(3)
    return A.reshape(-1, 5), (rows[:, 14:] - F * speed[:, None]).ravel()
