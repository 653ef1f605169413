# SPDX-License-Identifier: BSD-3-Clause
"""ULogs, damaged and with hostile names of topics, fields, parameters and firmware."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence

from log_target import check_log
from mutation import main

from hostile import hostile_words
from log_writers import ULogWriter

TIMES = [20 + 0.1 * k for k in range(12)]
PARAMETERS = (("CAL_MAG0_ID", 197388), ("CAL_MAG0_XOFF", 0.11), ("SENS_DPRES_OFF", 1.5))


def small_log(parameters: Sequence[tuple[str, float]] = PARAMETERS, firmware: str = "PX4") -> bytes:
    """A second of a magnetometer, a tube and what goes with them."""
    log = ULogWriter(parameters, [("sys_name", firmware), ("ver_hw", firmware)])
    log.form("sensor_mag", "uint64_t timestamp_sample;uint32_t device_id;float x;float y;float z")
    log.form("differential_pressure", "float differential_pressure_pa;float temperature")
    log.form("vehicle_attitude", "float[4] q")
    log.form("vehicle_local_position", "float vx;float vy;float vz;bool v_xy_valid;bool v_z_valid")
    log.form("vehicle_air_data", "float baro_alt_meter;float baro_pressure_pa;float rho")
    log.form("vehicle_status", "uint8_t nav_state;uint8_t arming_state")
    for k, t in enumerate(TIMES):
        turn = 0.3 * k
        sample = round(t * 1e6)
        log.add(t, "sensor_mag", sample, 197388, 0.2 * math.cos(turn), 0.2 * math.sin(turn), 0.4)
        log.add(t, "differential_pressure", 250.0 + k, 18.5)
        log.add(t, "vehicle_attitude", math.cos(turn / 2), 0.0, 0.0, math.sin(turn / 2))
        log.add(t, "vehicle_local_position", 20.0, 1.0, 0.0, True, True)
        log.add(t, "vehicle_air_data", 500.0, 95000.0, 1.15)
        log.add(t, "vehicle_status", 3 + k // 6, 2)
    return log.data()


def hostile_log(seed: int) -> bytes:
    """The same with names that are hostile."""
    words = [w for w in hostile_words(200, seed) if len(w.encode()) < 100][-3:]
    return small_log([*PARAMETERS, (words[0], 1), (words[1], 1.0)], words[2][:60])


def target(data: bytes) -> Hashable:
    """Of the command's answers."""
    return check_log("log.ulg", data)


if __name__ == "__main__":
    main(target, [small_log(), *map(hostile_log, range(4))])
