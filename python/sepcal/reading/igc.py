# SPDX-License-Identifier: BSD-3-Clause
"""IGC, the files of gliders' recorders (FAI, Technical specification for IGC-approved recorders).

Of each B record time, position, both altitudes and what the I record adds to it. A speed or an
angle has three whole digits, and further ones are decimals; VAT, VAR and an OAT of more than
three digits count tenths.
"""

from __future__ import annotations

import datetime
import re
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from sepcal import _core
from sepcal.reading.clock import DAY, TIME
from sepcal.reading.table import Table, listed

FIX = re.compile(rb"B(\d{6})(\d{2})(\d{5})([NS])(\d{3})(\d{5})([EW])([AV])([-\d]\d{4})([-\d]\d{4})")
FIX_LENGTH = 35
DATE = re.compile(rb"HFDTE(?:DATE)?\s*:?\s*(\d{2})(\d{2})(\d{2})")
EXTENSION = re.compile(rb"(\d{2})(\d{2})([A-Z0-9]{3})")
LONGEST = 4096
BACK = DAY / 2


def _whole(_: int) -> float:
    return 1.0


def _three_digits(width: int) -> float:
    return 10.0 ** (3 - max(width, 3))


def _tenths(_: int) -> float:
    return 0.1


def _degrees(width: int) -> float:
    return 1.0 if width <= 3 else 0.1


HEADERS: dict[str, tuple[str, Callable[[int], float]]] = {
    "TAS": ("airspeed_kmh", _three_digits),
    "IAS": ("ias_kmh", _three_digits),
    "GSP": ("gs_kmh", _three_digits),
    "TRT": ("track_deg", _three_digits),
    "HDT": ("heading_deg", _three_digits),
    "HDM": ("magnetic_heading_deg", _three_digits),
    "OAT": ("temp_degc", _degrees),
    "VAT": ("vat_mps", _tenths),
    "VAR": ("var_mps", _tenths),
    "FXA": ("fxa_m", _whole),
}
PARTS_OF_POSITION = {"LAD", "LOD", "TDS"}  # further digits of latitude, longitude, time


@dataclass
class Extension:
    """The name that the I record gives a B record's bytes from `start` to before `end`."""

    code: str
    start: int
    end: int
    values: list[float] = field(default_factory=list)

    def text(self, line: bytes) -> bytes:
        """Its digits in a line."""
        return line[self.start : self.end].strip()

    def value(self, line: bytes) -> float:
        """As a whole number, NaN for none."""
        try:
            return float(int(self.text(line)))
        except ValueError:
            return np.nan

    def share(self, line: bytes) -> float:
        """As further decimals: 0.25 of the digits "25"."""
        digits = self.text(line)
        return int(digits) / 10.0 ** len(digits) if digits.isdigit() else 0.0


def read(file: str, _: str | None) -> Table:
    """The table, a row a fix. Raises Error for a file without fixes."""
    recorder = _Recorder()
    with open(file, "rb") as opened:
        while line := opened.readline(LONGEST):
            recorder.take(line)
    if not recorder.rows:
        raise _core.Error(f"{file}: no B record with a 3D fix is in the IGC file")
    table = _to_table(np.array(recorder.rows), recorder.extensions)
    since = recorder.date or "the first day"
    table.notes.insert(0, f"time_s is seconds since {since} 00:00 UTC, of the B records")
    for what, count in recorder.left_out.items():
        table.notes.append(f"{count} B records {what} are left out")
    return table


class _Recorder:
    """Takes records line by line."""

    def __init__(self) -> None:
        self.extensions: list[Extension] = []
        self.rows: list[tuple[float, ...]] = []
        self.left_out: dict[str, int] = {}
        self.date = ""
        self._by_code: dict[str, Extension] = {}
        self._day = 0
        self._last = -1.0

    def take(self, line: bytes) -> None:
        """A record; others than B, I and the date's say nothing here."""
        if line.startswith(b"B"):
            if why := self._take_fix(line):
                self.left_out[why] = self.left_out.get(why, 0) + 1
        elif line.startswith(b"I") and not self.extensions:
            self.extensions = _read_extensions(line)
            self._by_code = {extension.code: extension for extension in self.extensions}
        elif not self.date and (found := DATE.match(line)):
            self.date = _to_date(found)

    def _take_fix(self, line: bytes) -> str:
        """A row. Returns why there is none."""
        fix = FIX.match(line)
        time = _seconds(fix[1]) if fix else None
        if fix is None or time is None:
            return "that are damaged"
        if fix[8] == b"V":
            return "without a 3D fix (V)"
        by_code = self._by_code
        time += by_code["TDS"].share(line) if "TDS" in by_code else 0.0
        if time + self._day < self._last - BACK:
            self._day += DAY
        if time + self._day <= self._last:
            return "whose time repeats or runs back"
        self._last = time + self._day
        latitude = _angle(fix[2], fix[3], by_code.get("LAD"), line, fix[4] == b"S")
        longitude = _angle(fix[5], fix[6], by_code.get("LOD"), line, fix[7] == b"W")
        self.rows.append((self._last, latitude, longitude, float(fix[9]), float(fix[10])))
        for extension in self.extensions:
            extension.values.append(extension.value(line))
        return ""


def _read_extensions(line: bytes) -> list[Extension]:
    """Those of an I record: how many, then of each first byte, last byte, code."""
    found = [
        Extension(code.decode(), int(first) - 1, int(last))
        for first, last, code in EXTENSION.findall(line[3:])
        if FIX_LENGTH < int(first) <= int(last)
    ]
    return list({extension.code: extension for extension in found}.values())


def _to_date(found: re.Match[bytes]) -> str:
    day, month, year = (int(part) for part in found.groups())
    try:
        return datetime.date((1900 if year >= 80 else 2000) + year, month, day).isoformat()
    except ValueError:
        return ""


def _seconds(digits: bytes) -> float | None:
    """Seconds since midnight from HHMMSS; None if there is no such time."""
    hours, minutes, seconds = int(digits[:2]), int(digits[2:4]), int(digits[4:])
    if hours > 23 or minutes > 59 or seconds > 60:
        return None
    return 3600.0 * hours + 60.0 * minutes + seconds


def _angle(
    degrees: bytes, thousandths: bytes, more: Extension | None, line: bytes, is_negative: bool
) -> float:
    """An angle [deg] from degrees and thousandths of minutes."""
    minutes = (int(thousandths) + (more.share(line) if more else 0.0)) / 1000.0
    angle = int(degrees) + minutes / 60.0
    return -angle if is_negative else angle


def _to_table(fixes: np.ndarray, extensions: list[Extension]) -> Table:
    time, latitude, longitude, pressure, gnss = fixes.T
    table = Table({TIME: time, "lat_deg": latitude, "lon_deg": longitude})
    if gnss.any():
        table.columns["altitude_m"] = gnss
        table.columns["pressure_altitude_m"] = pressure
        table.notes.append("altitude_m is the GNSS altitude; pressure_altitude_m the recorder's")
    else:
        table.columns["altitude_m"] = pressure
        table.notes.append("altitude_m is the pressure altitude: no GNSS altitude is recorded")
    said = []
    for extension in extensions:
        if extension.code in PARTS_OF_POSITION:
            continue
        width = extension.end - extension.start
        header, scale = HEADERS.get(extension.code, (extension.code, _whole))
        values = np.array(extension.values) * scale(width)
        if np.isfinite(values).any():
            table.columns[header] = values
            if extension.code in HEADERS:
                said.append(f"{extension.code} as {header} by {scale(width):g}")
    if said:
        table.notes.append(f"read {listed(said)}")
    return table
