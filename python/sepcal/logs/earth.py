# SPDX-License-Identifier: BSD-3-Clause
"""The Earth's field along a flight, from its positions and its day."""

from __future__ import annotations

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.geomagnetism.models import Date, EarthField, earth_field
from sepcal.logs.recording import Channel, Recording

HIGHEST = 1e5  # [m]
MOVED = 100.0  # [m]: the field is evaluated anew after so much of the way
DIGITS = 4  # of a microtesla: finer than the model is known, and steady where nothing moves
MOST_KNOTS = 2000
METRES_A_DEGREE = 111_200.0


class FieldColumns:
    """bn_ut, be_ut, bd_ut and field_strength_ut at any time of a flight.

    Attributes:
        first: The field where the flight was first known.
        source: Its source.
        done: How, in sentences.
    """

    def __init__(self, positions: Channel, date: Date, said: str) -> None:
        knots = _choose_knots(positions.values)
        fields = []
        for knot in knots:
            latitude, longitude, altitude = (float(v) for v in positions.values[knot])
            fields.append(earth_field(latitude, longitude, altitude, date))
        self.first: EarthField = fields[0]
        self._times = positions.times[knots]
        self._parts = np.array([(f.north, f.east, f.down) for f in fields])
        self.source = f"{self.first.model} at {positions.source}"
        evaluated = f"{len(knots)} times, at every {MOVED:g} m of the way"
        self.done = (said, f"evaluated {evaluated}; lines between, held before the first position")

    def at(self, times: Array) -> dict[str, Array]:
        """Columns (N,) in uT by header."""
        parts = np.stack([np.interp(times, self._times, column) for column in self._parts.T])
        strength = np.linalg.norm(parts, axis=0)
        headers = ("bn_ut", "be_ut", "bd_ut", "field_strength_ut")
        return dict(zip(headers, np.round((*parts, strength), DIGITS), strict=True))


def find_field(log: Recording, date: Date | None) -> FieldColumns | None:
    """The field of a log; None where it has no positions.

    Raises:
        Error: Positions without a date, none given; a day outside the models; no pygeomag.
    """
    positions = _keep_plausible(log.position)
    if positions is None:
        return None
    said = "on the day that was given"
    if date is None:
        if log.utc is None:
            raise _core.Error(
                f"{log.file}: positions without a date give no field of the Earth; --date "
                "2026-03-01 gives it, --no-field does without (in Python date=..., field=False)"
            )
        date = log.utc.at(float(positions.times[0]))
        said = f"on {date:%Y-%m-%d}, by {log.utc.source.split(',')[0]}"
    try:
        return FieldColumns(positions, date, said)
    except _core.Error as error:
        raise _core.Error(
            f"{log.file}: {error}; --date gives another day, --no-field does without"
        ) from error


def _keep_plausible(positions: Channel | None) -> Channel | None:
    """Those on the Earth, and not far off it; None where there are none."""
    if positions is None:
        return None
    kept = (np.abs(positions.values) <= (90.0, 180.0, HIGHEST)).all(axis=1)
    if not kept.any():
        return None
    return Channel(positions.source, positions.times[kept], positions.values[kept], positions.done)


def _choose_knots(positions: Array) -> list[int]:
    """Indices at every MOVED metres of the way, the last one too."""
    scale = METRES_A_DEGREE * np.array((1.0, np.cos(np.radians(positions[0, 0])), 0.0))
    scale[2] = 1.0
    way = np.append(0, np.cumsum(np.linalg.norm(np.diff(positions, axis=0) * scale, axis=1)))
    spacing = max(MOVED, way[-1] / MOST_KNOTS)
    at = np.searchsorted(way, np.arange(0.0, way[-1], spacing))
    return [int(i) for i in np.unique((*at, len(way) - 1))]
