# SPDX-License-Identifier: BSD-3-Clause
"""GPS time and UTC. GPS counts no leap seconds; a log that has week and time of week has none."""

from __future__ import annotations

import datetime

import numpy as np

from sepcal.columns import Array
from sepcal.logs.recording import Utc

GPS_EPOCH = datetime.datetime(1980, 1, 6, tzinfo=datetime.UTC)
UNIX_EPOCH = datetime.datetime(1970, 1, 1, tzinfo=datetime.UTC)
# The days from which on GPS time is 1, 2, ... 18 s ahead of UTC (IERS Bulletin C).
LEAPS = tuple(
    datetime.datetime(*day, tzinfo=datetime.UTC)
    for day in (
        *((1981, 7, 1), (1982, 7, 1), (1983, 7, 1), (1985, 7, 1), (1988, 1, 1), (1990, 1, 1)),
        *((1991, 1, 1), (1992, 7, 1), (1993, 7, 1), (1994, 7, 1), (1996, 1, 1), (1997, 7, 1)),
        *((1999, 1, 1), (2006, 1, 1), (2009, 1, 1), (2012, 7, 1), (2015, 7, 1), (2017, 1, 1)),
    )
)


def from_gps(times: Array, weeks: Array, milliseconds: Array, source: str) -> Utc | None:
    """UTC from GPS weeks and milliseconds at times of the log's clock; None if all are zero."""
    known = weeks > 0
    if not known.any():
        return None
    seconds = weeks[known] * 604800.0 + milliseconds[known] / 1000
    time, gps = _match(times[known], seconds)
    moment = GPS_EPOCH + datetime.timedelta(seconds=gps)
    ahead = count_leaps(moment)
    leaps = f"{ahead} leap seconds, by their list up to 2017 as the log has none"
    said = f"{source}, GPS time less {leaps}"
    return Utc(time, moment - datetime.timedelta(seconds=ahead), said)


def from_unix(times: Array, microseconds: Array, source: str) -> Utc | None:
    """UTC from microseconds at times of the log's clock; None if it is set nowhere."""
    known = microseconds > 0
    if not known.any():
        return None
    time, seconds = _match(times[known], microseconds[known] / 1e6)
    said = f"{source}, UTC as the receiver gave it, its leap seconds counted there"
    return Utc(time, UNIX_EPOCH + datetime.timedelta(seconds=seconds), said)


def count_leaps(gps: datetime.datetime) -> int:
    """Seconds by which GPS time is ahead of UTC at a moment in GPS time."""
    return sum(
        gps >= day + datetime.timedelta(seconds=count) for count, day in enumerate(LEAPS, start=1)
    )


def _match(times: Array, seconds: Array) -> tuple[float, float]:
    """A time of the clock and the seconds then, by the median of the differences."""
    ahead = float(np.median(seconds - times))
    return float(times[-1]), float(times[-1]) + ahead
