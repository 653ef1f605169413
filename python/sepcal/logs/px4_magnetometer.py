# SPDX-License-Identifier: BSD-3-Clause
"""Undoes what PX4 did to a magnetometer: the raw sensor, turned into body axes.

PX4 computes m = R S (raw + COMP power - OFF) in gauss, with S = [[XSCALE, XODIAG, YODIAG],
[XODIAG, YSCALE, ZODIAG], [YODIAG, ZODIAG, ZSCALE]] and COMP at full throttle or per kA. Parameters
are CAL_MAGn_..., n that whose CAL_MAGn_ID is the device. Before it knew XODIAG, drivers computed
S (raw - OFF) themselves, so that sensor_mag was no raw reading.
"""

from __future__ import annotations

import numpy as np

from sepcal.columns import Array
from sepcal.logs.mounting import CUSTOM, rotation_of, turn
from sepcal.logs.parameters import Parameters
from sepcal.logs.soft_iron import symmetric

AXES = "XYZ"
MOST = 4  # magnetometers


class Correction:
    """The correction that PX4 applies to one device.

    Attributes:
        place: n of CAL_MAGn_...; None where no parameters name the device.
        rotation: R, (3, 3).
        notes: What can't be known, in sentences.
    """

    def __init__(self, parameters: Parameters, device: int) -> None:
        self._parameters = parameters
        self.notes: tuple[str, ...] = ()
        places = [n for n in range(MOST) if f"CAL_MAG{n}_ID" in parameters]
        self.place = next(
            (n for n in places if device and parameters.first(f"CAL_MAG{n}_ID") == device), None
        )
        used = [n for n in places if parameters.first(f"CAL_MAG{n}_ID")]
        if self.place is None and not device and len(used) == 1:
            self.place = used[0]
        self.rotation = self._find_rotation()

    @property
    def drivers_correct(self) -> bool:
        """Whether sensor_mag was corrected already, as in logs before 2020."""
        return not any(f"CAL_MAG{n}_XODIAG" in self._parameters for n in range(MOST))

    def undo(self, corrected: Array, times: Array, power: Array) -> tuple[Array, tuple[str, ...]]:
        """R' of the corrected readings comes in, raw ones go out, both (n, 3) in gauss."""
        if self.place is None:
            said = "no CAL_MAGn_ID names this device: taken as uncorrected"
            return corrected, (said,)
        prefix = f"CAL_MAG{self.place}_"
        offset = self._stack("OFF", times)
        scale = self._stack("SCALE", times, 1.0)
        off = self._stack("ODIAG", times)
        comp = self._stack("COMP", times) * power[:, None]
        matrix = symmetric(scale, off)
        if (np.abs(np.linalg.det(matrix)) < 1e-3).any():
            return corrected, (f"{prefix}?SCALE is singular: taken as uncorrected",)
        raw = np.linalg.solve(matrix, corrected[..., None])[..., 0] + offset - comp
        done = []
        if np.abs(comp).any():
            done.append(f"{prefix}?COMP times the power")
        if not np.allclose(scale, 1) or off.any():
            parts = ", ".join(f"{v:g}" for v in (*scale[0], *off[0]))
            done.append(f"{prefix}?SCALE and ?ODIAG, {parts}")
        if offset.any():
            done.append(f"{prefix}?OFF, {', '.join(f'{v:g}' for v in offset[0])} G")
        return raw, tuple(f"undone: {text}" for text in done)

    def _stack(self, what: str, times: Array, default: float = 0.0) -> Array:
        names = [f"CAL_MAG{self.place}_{axis}{what}" for axis in AXES]
        return self._parameters.stack(names, times, default)

    def _find_rotation(self) -> Array:
        parameters = self._parameters
        prefix = f"CAL_MAG{self.place}_"
        number = int(parameters.first(prefix + "ROT", -1)) if self.place is not None else -1
        if number == CUSTOM:
            return turn(*(parameters.first(prefix + a) for a in ("ROLL", "PITCH", "YAW")))
        board = number < 0  # inside the autopilot, turned with its board
        if board:
            number = int(parameters.first("SENS_BOARD_ROT"))
        rotation = rotation_of(number)
        if rotation is None:
            self.notes = (f"mounted by rotation {number}, which is not known here: left unturned",)
            return np.eye(3)
        if board:
            trim = (parameters.first(f"SENS_BOARD_{axis}_OFF") for axis in AXES)
            rotation = turn(*trim) @ rotation
        return rotation
