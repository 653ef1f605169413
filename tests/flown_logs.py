# SPDX-License-Identifier: BSD-3-Clause
"""The flight's logs by name, and what a test looks at in a flight that was read of one."""

import numpy as np
from scipy.spatial.transform import Rotation

from flown_dataflash import new_dataflash, old_dataflash
from flown_ulog import new_ulog, old_ulog

LOGS = {
    "new.bin": new_dataflash,
    "old.bin": old_dataflash,
    "new.ulg": new_ulog,
    "corrected.ulg": lambda: new_ulog(raw_rate=1.0, corrected_rate=20.0),
    "old.ulg": old_ulog,
    "older.ulg": lambda: old_ulog(relative=False),
}


def write_logs(folder):
    """All of them."""
    for name, make in LOGS.items():
        (folder / name).write_bytes(make().data())
    return folder


def write(folder, name, log):
    file = folder / name
    file.write_bytes(log.data() if hasattr(log, "data") else log)
    return file


def stack(flight, headers):
    return np.stack([flight[header] for header in headers.split()], axis=-1)


def magnetic(flight):
    return stack(flight, "mx_ut my_ut mz_ut")


def turns_between(flight, angles):
    """By how much the flight's attitude is turned from these Euler angles [rad], (n,)."""
    logged = Rotation.from_euler("ZYX", stack(flight, "yaw_rad pitch_rad roll_rad"))
    return (logged.inv() * Rotation.from_euler("ZYX", angles[:, ::-1])).magnitude()
