# SPDX-License-Identifier: BSD-3-Clause
"""Flight modes and arming as labels of maneuvers."""

from __future__ import annotations

import numpy as np

from sepcal.columns import Array
from sepcal.logs.recording import Labels

DISARMED = "disarmed"
# PX4's vehicle_status.nav_state.
NAV_STATES = {
    0: "manual",
    1: "altitude",
    2: "position",
    3: "mission",
    4: "hold",
    5: "return",
    6: "position_slow",
    7: "return_to_ground_station",
    8: "land_engine_failure",
    9: "land_gps_failure",
    10: "acro",
    12: "descend",
    13: "termination",
    14: "offboard",
    15: "stabilized",
    16: "rattitude",
    17: "takeoff",
    18: "land",
    19: "follow",
    20: "precision_land",
    21: "orbit",
    22: "vtol_takeoff",
}


def combine(
    source: str, modes: tuple[Array, list[str]], armed: tuple[Array, np.ndarray] | None
) -> Labels | None:
    """One label from each change on: the mode, or "disarmed".

    Args:
        source: Their source.
        modes: Times (n,) and the mode from each on.
        armed: Times (m,) and whether the vehicle is armed from each on; before the first time it
            was the other way round. None: not logged.
    """
    times, names = modes
    if not len(times) and armed is None:
        return None
    if armed is None:
        on_times, on = np.empty(0), np.empty(0, dtype=bool)
    else:
        on_times, on = armed
    joined = np.unique(np.concatenate((times, on_times)))
    kept_times: list[float] = []
    kept: list[str] = []
    for time in joined:
        at = int(np.searchsorted(times, time, side="right")) - 1
        mode = names[max(at, 0)] if names else "armed"
        if on_times.size:
            at = int(np.searchsorted(on_times, time, side="right")) - 1
            if not (on[at] if at >= 0 else not on[0]):
                mode = DISARMED
        if not kept or kept[-1] != mode:
            kept_times.append(float(time))
            kept.append(mode)
    return Labels(source, np.array(kept_times), tuple(kept))
