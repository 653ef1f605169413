# SPDX-License-Identifier: BSD-3-Clause
"""A vehicle's log in sepcal's terms, whatever its format: sensors, channels, labels, place and day.

Times are in the log's own clock [s], mostly since the vehicle was switched on.
"""

from __future__ import annotations

import bisect
import datetime
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from sepcal.columns import Array

ABSURD = 1e12  # no unit that is used here has such values: the bytes are damaged
MAGNETOMETER, TUBE = "magnetometer", "pitot-static tube"


@dataclass(frozen=True)
class Channel:
    """The readings of one message of a log, sample by sample.

    Attributes:
        source: The fields it is of, "ATT.Roll, Pitch, Yaw".
        times: Shape (n,), increasing [s].
        values: Shape (n, k), finite.
        done: Changes made to the logged values, in sentences.
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
        header: Header of a tube's reading, "dp_pa" or "airspeed_mps".
        own: Channels of the sensor itself by header, such as its temperature.
        title: The device's number, as the log has it.
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
        notes: Oddities, in sentences.
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
    """A channel of the samples that are finite and in order; None of fewer than two."""
    if len(times) < 2:
        return None
    values = np.asarray(values, dtype=float)
    values = values.reshape(len(times), -1)
    kept = np.flatnonzero((np.abs(values) < ABSURD).all(axis=1) & (np.abs(times) < ABSURD))
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
    """Indices of as many times as possible that increase: lone jumps and repeats go.

    The longest increasing subsequence: ends[k] is the smallest time that ends one of k + 1.
    """
    if not (np.diff(times) <= 0).any():
        return np.arange(times.size)
    ends: list[float] = []
    at: list[int] = []
    before = np.full(times.size, -1)
    for i, time in enumerate(times.tolist()):
        k = bisect.bisect_left(ends, time)
        if k < len(ends) and ends[k] == time:
            continue
        ends[k : k + 1] = [time]
        at[k : k + 1] = [i]
        before[i] = at[k - 1] if k else -1
    kept = [at[-1]]
    while before[kept[-1]] >= 0:
        kept.append(int(before[kept[-1]]))
    return np.array(kept[::-1])
