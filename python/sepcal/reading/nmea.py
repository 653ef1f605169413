# SPDX-License-Identifier: BSD-3-Clause
"""NMEA 0183 of a GNSS receiver: RMC, GGA and VTG, a row an epoch; checksums are verified."""

from __future__ import annotations

import datetime
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from sepcal import _core
from sepcal.reading.clock import DAY, TIME
from sepcal.reading.table import Table, listed

LONGEST = 4096
BACK = DAY / 2
KMH_IN_KT = 1 / 1.852
HEADERS = ("lat_deg", "lon_deg", "altitude_m", "gs_kt", "track_deg")


@dataclass
class Epoch:
    """The readings that the sentences of one time give."""

    time: float
    values: dict[str, float] = field(default_factory=dict)


class Talker:
    """The sentences of one talker, GP or GN, in order."""

    def __init__(self) -> None:
        self.epochs: list[Epoch] = []
        self.date = ""
        self.back = 0
        self._day = 0

    def take(self, kind: str, cells: Sequence[str]) -> None:
        """A sentence whose checksum is right. Raises ValueError, IndexError for a damaged cell."""
        if kind == "VTG":  # without a time: of the epoch that is open
            if self.epochs:
                self._set(self.epochs[-1], "track_deg", _number(cells[1]))
                speed = _number(cells[5])
                kmh = _number(cells[7]) if len(cells) > 7 else np.nan
                self._set(self.epochs[-1], "gs_kt", speed if speed == speed else kmh * KMH_IN_KT)
            return
        epoch = self._epoch_at(_seconds(cells[1]))
        if epoch is None:
            return
        first = 3 if kind == "RMC" else 2
        is_valid = cells[2] == "A" if kind == "RMC" else cells[6] not in ("", "0")
        if not is_valid:
            return
        self._set(epoch, "lat_deg", _angle(cells[first], cells[first + 1], 2))
        self._set(epoch, "lon_deg", _angle(cells[first + 2], cells[first + 3], 3))
        if kind == "GGA":
            self._set(epoch, "altitude_m", _number(cells[9]))
            return
        epoch.values["gs_kt"] = _number(cells[7])
        self._set(epoch, "track_deg", _number(cells[8]))
        if not self.date:
            self.date = _to_date(cells[9])

    def _epoch_at(self, time: float) -> Epoch | None:
        if not self.epochs or time + self._day != self.epochs[-1].time:
            last = self.epochs[-1].time if self.epochs else -np.inf
            if time + self._day < last - BACK:
                self._day += DAY
            if time + self._day < last:
                self.back += 1
                return None
            if time + self._day != last:
                self.epochs.append(Epoch(time + self._day))
        return self.epochs[-1]

    @staticmethod
    def _set(epoch: Epoch, header: str, value: float) -> None:
        if value == value:
            epoch.values.setdefault(header, value)


def read(file: str, _: str | None) -> Table:
    """The table of the talker with most positions. Raises Error for a file without any."""
    talkers: dict[str, Talker] = {}
    left_out: Counter[str] = Counter()
    with open(file, "rb") as opened:
        while line := opened.readline(LONGEST):
            _take(line, talkers, left_out)
    fixes = {name: _fixes(talker) for name, talker in talkers.items()}
    if not any(fixes.values()):
        raise _core.Error(
            f"{file}: no RMC or GGA sentence with a position and a right checksum is in it"
        )
    chosen = max(fixes, key=lambda name: len(fixes[name]))
    rows = fixes[chosen]
    table = Table({TIME: np.array([epoch.time for epoch in rows])})
    for header in HEADERS:
        values = np.array([epoch.values.get(header, np.nan) for epoch in rows])
        if np.isfinite(values).any():
            table.columns[header] = values
    since = talkers[chosen].date or "the first day"
    table.notes.append(f"time_s is seconds since {since} 00:00 UTC, of talker {chosen}")
    if others := [name for name in fixes if name != chosen]:
        table.notes.append(f"talkers {listed(others)} are left out: {chosen} has most positions")
    empty = len(talkers[chosen].epochs) - len(rows)
    for count, what in (
        (left_out["sum"], "lines with a wrong checksum"),
        (left_out["damaged"], "sentences that are damaged"),
        (empty, "epochs without a position"),
        (talkers[chosen].back, "sentences whose time runs back"),
    ):
        if count:
            table.notes.append(f"{count} {what} are left out")
    return table


def _fixes(talker: Talker) -> list[Epoch]:
    return [epoch for epoch in talker.epochs if "lat_deg" in epoch.values]


def _take(line: bytes, talkers: dict[str, Talker], left_out: Counter[str]) -> None:
    """A sentence behind whatever a logger wrote before its $."""
    start = line.rfind(b"$")
    body, star, rest = line[start + 1 :].partition(b"*")
    if start < 0 or body[2:5] not in (b"RMC", b"GGA", b"VTG"):
        return
    try:
        told = int(rest[:2], 16) if star else -1
    except ValueError:
        told = -1
    summed = 0
    for byte in body:
        summed ^= byte
    if told != summed:
        left_out["sum"] += 1
        return
    cells = body.decode("ascii", "replace").split(",")
    try:
        talkers.setdefault(cells[0][:2], Talker()).take(cells[0][2:5], cells)
    except (ValueError, IndexError):
        left_out["damaged"] += 1


def _number(cell: str) -> float:
    """NaN for an empty cell."""
    value = float(cell) if cell else np.nan
    return value if abs(value) < 1e9 or value != value else np.nan


def _seconds(cell: str) -> float:
    """Seconds since midnight from hhmmss.ss."""
    hours, minutes, seconds = int(cell[:2]), int(cell[2:4]), float(cell[4:])
    if hours > 23 or minutes > 59 or not 0 <= seconds < 61:
        raise ValueError(cell)
    return 3600.0 * hours + 60.0 * minutes + seconds


def _angle(cell: str, side: str, digits: int) -> float:
    """An angle [deg] from dddmm.mmm and N, S, E or W."""
    if not cell:
        return np.nan
    angle = int(cell[:digits]) + float(cell[digits:]) / 60.0
    return -angle if side in ("S", "W") else angle


def _to_date(cell: str) -> str:
    """A date from ddmmyy."""
    try:
        day, month, year = int(cell[:2]), int(cell[2:4]), int(cell[4:6])
        return datetime.date((1900 if year >= 80 else 2000) + year, month, day).isoformat()
    except ValueError:
        return ""


def looks_like(start: bytes) -> bool:
    """Whether a file begins with sentences, by its first lines."""
    lines = [line for line in start.splitlines()[:20] if line.strip()]
    found = [line for line in lines if b"$" in line and b"," in line and b"*" in line]
    return len(found) >= max(1, len(lines) // 2) and any(
        line[line.rfind(b"$") + 3 :][:3].isalpha() for line in found
    )
