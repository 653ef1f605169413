# SPDX-License-Identifier: BSD-3-Clause
"""A vehicle's log in sepcal's terms, whatever its format: sensors, channels, labels, place and day.

Times are in the log's own clock [s], mostly since the vehicle was switched on.
"""

from __future__ import annotations

import datetime
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from sepcal.columns import Array

MAGNETOMETER, TUBE = "magnetometer", "pitot-static tube"


@dataclass(frozen=True)
class Channel:
    """What one message of a log said, sample by sample.

    Attributes:
        source: The fields it is of, "ATT.Roll, Pitch, Yaw".
        times: Shape (n,), increasing [s].
        values: Shape (n, k), finite.
        done: What was done to the logged values, in sentences.
    """

    source: str
    times: Array
    values: Array
    done: tuple[str, ...] = ()

    @property
    def rate(self) -> float:
        """Samples a second, by the median step; NaN for fewer than two."""
        steps = np.diff(self.times)
        return float(1 / np.median(steps)) if steps.size else float("nan")


@dataclass(frozen=True)
class Sensor:
    """One that can be calibrated.

    Attributes:
        name: "mag0", "pitot0".
        kind: MAGNETOMETER or TUBE.
        readings: Of a magnetometer (n, 3) in uT, body axes, as the raw sensor read; of a tube
            (n, 1) in Pa, the differential pressure, or in m/s, the airspeed.
        header: Of a tube's reading, "dp_pa" or "airspeed_mps".
        own: Channels of the sensor itself by header, such as its temperature.
        title: What the log says of it, a device's number.
    """

    name: str
    kind: str
    readings: Channel
    header: str = ""
    own: Mapping[str, Channel] = field(default_factory=dict)
    title: str = ""


@dataclass(frozen=True)
class Labels:
    """A label from each time on, until the next."""

    source: str
    times: Array
    names: tuple[str, ...]


@dataclass(frozen=True)
class Utc:
    """The log's clock against UTC: `time` on the clock was `moment`."""

    time: float
    moment: datetime.datetime
    source: str

    def at(self, time: float) -> datetime.datetime:
        """UTC at a time on the log's clock."""
        return self.moment + datetime.timedelta(seconds=time - self.time)

    def name(self, time: float) -> str:
        """The same as text, to the millisecond: "2014-12-05T10:54:51.569Z"."""
        moment = self.at(time).isoformat(timespec="milliseconds")
        return moment.replace("+00:00", "Z")


@dataclass(frozen=True)
class Recording:
    """A log.

    Attributes:
        file: As it was named.
        form: "ULog" or "DataFlash".
        vehicle: Firmware and version as the log says; may be empty.
        sensors: Those that can be calibrated.
        attitude: Quaternions (n, 4), w first, body to north-east-down; None: not logged.
        velocity: Over the ground (n, 3): north, east, down [m/s]; None: not logged.
        position: (n, 3): latitude, longitude [deg], altitude above the sea [m].
        drivers: Other channels (n, 1) by header.
        labels: Modes, or None.
        utc: None where the log has no date.
        notes: What is odd about it, in sentences.
    """

    file: str
    form: str
    vehicle: str
    span: tuple[float, float]
    sensors: tuple[Sensor, ...]
    attitude: Channel | None
    velocity: Channel | None
    rates: Channel | None
    position: Channel | None
    drivers: Mapping[str, Channel]
    labels: Labels | None
    utc: Utc | None
    notes: tuple[str, ...]


def make_channel(
    source: str, times: Array, values: Array, done: tuple[str, ...] = ()
) -> Channel | None:
    """A channel of the samples that are finite and whose stamps increase; None of fewer than two.

    A stamp that jumps ahead for one sample is dropped, and not all that follow it.
    """
    values = np.asarray(values, dtype=float)
    values = values.reshape(len(times), -1)
    kept = np.flatnonzero(np.isfinite(values).all(axis=1) & np.isfinite(times))
    unread = len(times) - kept.size
    kept = kept[_increasing(np.asarray(times, dtype=float)[kept])]
    if kept.size < 2:
        return None
    if dropped := len(times) - unread - kept.size:
        done += (f"{dropped} samples whose time repeats or runs back are left out",)
    if unread:
        done += (f"{unread} samples that are no number are left out",)
    return Channel(source, np.asarray(times, dtype=float)[kept], values[kept], done)


def _increasing(times: Array) -> np.ndarray:
    """Indices of the times that come after all before, lone jumps ahead left out."""
    if times.size < 3:
        ahead = np.zeros(times.size, dtype=bool)
    else:
        back = np.append(times[:-1] > times[1:], False)
        ahead = back & np.append(np.append(True, times[:-2] < times[2:]), False)
    kept = np.flatnonzero(~ahead)
    highest = np.maximum.accumulate(times[kept]) if kept.size else times[kept]
    first = np.append(True, highest[1:] > highest[:-1]) if kept.size else highest.astype(bool)
    return np.asarray(kept[first])
