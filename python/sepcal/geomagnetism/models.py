# SPDX-License-Identifier: BSD-3-Clause
"""The Earth's magnetic field by the World Magnetic Model, as pygeomag evaluates it.

A model of the series holds for five years; pygeomag has those since 2010. For a day outside all of
them there is no field here, rather than one that was stretched.
"""

from __future__ import annotations

import datetime
import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from sepcal import _core
from sepcal.arguments import checked, shown

Date = datetime.date | datetime.datetime | str | float
NANOTESLA = 1e-3  # [uT]


@dataclass(frozen=True)
class EarthField:
    """The field at a place on a day.

    Attributes:
        north, east, down: [uT], true north.
        model: "WMM-2025".
        latitude, longitude: [deg], north and east positive.
        altitude: Above the sea [m].
        year: The day as a decimal year.

    Example:
        >>> field = sepcal.earth_field(47.4, 8.5, 400.0, 2025.5)
        >>> round(field.strength), round(field.inclination)  # uT, deg
        (48, 64)
    """

    north: float
    east: float
    down: float
    model: str
    latitude: float
    longitude: float
    altitude: float
    year: float

    @property
    def strength(self) -> float:
        """[uT]."""
        return math.hypot(self.north, self.east, self.down)

    @property
    def declination(self) -> float:
        """The angle from true to magnetic north, east positive [deg]."""
        return math.degrees(math.atan2(self.east, self.north))

    @property
    def inclination(self) -> float:
        """Below the horizon [deg]."""
        return math.degrees(math.atan2(self.down, math.hypot(self.north, self.east)))


@checked
def earth_field(latitude: float, longitude: float, altitude: float, date: Date) -> EarthField:
    """The Earth's field by the World Magnetic Model of the day.

    Args:
        latitude: [deg], north positive.
        longitude: [deg], east positive.
        altitude: Above the sea [m]. The model counts from the ellipsoid, which lies up to 100 m
            off the sea; that is 0.005 % of the field.
        date: A date or a datetime (UTC), "2026-03-01", or a decimal year.

    Returns:
        EarthField in uT, to within about 0.15 uT: the crust's own field is in no such model.

    Raises:
        Error: A place off the Earth, a day outside the models' spans, no pygeomag.

    Example:
        >>> field = sepcal.earth_field(47.4, 8.5, 400.0, 2025.5)
        >>> round(field.north), round(field.down)  # uT
        (22, 43)
    """
    if not -90 <= latitude <= 90:
        raise _core.Error(f"a latitude of {latitude:g} deg is off the Earth: -90 to 90")
    if not -180 <= longitude <= 360:
        raise _core.Error(f"a longitude of {longitude:g} deg is off the Earth: -180 to 360")
    if not -1e4 <= altitude <= 8.5e5:
        raise _core.Error(
            f"an altitude of {altitude:g} m is outside the model: -10,000 to 850,000 m"
        )
    year = decimal_year(date)
    model = _model_of(math.floor(year))
    at = model.calculate(glat=latitude, glon=longitude, alt=altitude / 1000, time=year)
    north, east, down = (float(part) * NANOTESLA for part in (at.x, at.y, at.z))
    return EarthField(north, east, down, model.model, latitude, longitude, altitude, year)


def decimal_year(date: Date) -> float:
    """2020-07-02 as 2020.5; raises Error for a text that is no date."""
    if isinstance(date, str):
        return decimal_year(_read_date(date))
    if isinstance(date, int | float):
        if not math.isfinite(date):
            raise _core.Error(f"{date} is no year")
        return float(date)
    if not isinstance(date, datetime.date):
        raise _core.Error(f"{shown(date)} is no date; give a date, 2025.5 or '2025-07-02'")
    if not isinstance(date, datetime.datetime):
        date = datetime.datetime(date.year, date.month, date.day)
    first = datetime.datetime(date.year, 1, 1, tzinfo=date.tzinfo)
    length = datetime.datetime(date.year + 1, 1, 1, tzinfo=date.tzinfo) - first
    return date.year + (date - first) / length


def warn_of_age(today: datetime.date | None = None) -> str:
    """A sentence where the newest model's span has ended; else nothing."""
    newest = _pygeomag().GeoMag()
    end = newest.life_span[1]
    if decimal_year(today or datetime.date.today()) < end:
        return ""
    return (
        f"the newest model here, {newest.model}, ended with {end - 1:.0f}; for later days: "
        "pip install --upgrade pygeomag"
    )


def _read_date(text: str) -> datetime.datetime | float:
    try:
        return datetime.datetime.fromisoformat(text)
    except ValueError:
        pass
    try:
        return float(text)
    except ValueError:
        raise _core.Error(f"'{text}' is no date; write it as 2026-03-01 or 2026.16") from None


@lru_cache
def _model_of(year: int) -> Any:  # noqa: ANN401, pygeomag has no types
    """The model whose span holds the year."""
    geomag = _pygeomag()
    try:
        model = geomag.GeoMag(base_year=year)
        start, end = model.life_span
    except ValueError:
        start = end = 0
    if start <= year < end:
        return model
    end = geomag.GeoMag().life_span[1]
    later = "; pip install --upgrade pygeomag brings newer ones" if year >= end else ""
    raise _core.Error(
        f"the year {year} is outside the field models here, 2010 to {end - 1:.0f}{later}"
    )


def _pygeomag() -> Any:  # noqa: ANN401
    try:
        import pygeomag
    except ImportError as error:
        raise _core.Error(
            "the Earth's field needs pygeomag, which is not installed: pip install sepcal[logs]"
        ) from error
    return pygeomag
