# SPDX-License-Identifier: BSD-3-Clause
"""A sensor's readings with all that goes with them, row by row: the flight that is fitted."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.logs.attitude import smooth_signs, to_euler
from sepcal.logs.earth import FieldColumns
from sepcal.logs.recording import MAGNETOMETER, Channel, Recording, Sensor
from sepcal.logs.time_base import bring, label_at

ENOUGH = 0.9  # a channel that has this share of the rows costs the others
VELOCITY = ("vn_mps", "ve_mps", "vd_mps")


@dataclass
class Table:
    """Columns of N rows.

    Attributes:
        columns: Arrays (N,) by header, time_s first; NaN where a channel has nothing.
        labels: A label a row; empty where the log has none.
        told: By header: where it is from ("source") and what was done to it ("done").
        left_out: Rows that are missing, by reason.
        notes: Sentences.
    """

    columns: dict[str, Array] = field(default_factory=dict)
    labels: list[str] = field(default_factory=list)
    told: dict[str, dict[str, object]] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    @property
    def rows(self) -> int:
        """N."""
        return len(next(iter(self.columns.values())))


def build_table(
    log: Recording,
    sensor: Sensor,
    start: float | None,
    end: float | None,
    earth: FieldColumns | None,
) -> Table:
    """The rows of a sensor from `start` to `end` on the log's clock [s].

    A row needs what is known in nine of ten rows, and a tube's the velocity; where less is known of
    another channel its cells are empty instead.

    Raises:
        Error: No row from `start` to `end`, or none for which all is known.
    """
    stamps = sensor.readings.times
    inside = (stamps >= (-math.inf if start is None else start)) & (
        stamps <= (math.inf if end is None else end)
    )
    if not inside.any():
        raise _core.Error(
            f"{log.file}: {sensor.name} has no reading {_describe_span(start, end)}; it has "
            f"{stamps.size} from {stamps[0]:.3f} to {stamps[-1]:.3f} s"
        )
    builder = _Builder(stamps[inside], () if sensor.kind == MAGNETOMETER else VELOCITY)
    headers = ("mx_ut", "my_ut", "mz_ut") if sensor.kind == MAGNETOMETER else (sensor.header,)
    readings = Channel(
        sensor.readings.source, stamps[inside], sensor.readings.values[inside], sensor.readings.done
    )
    builder.put(headers, readings.values, readings.source, [*readings.done])
    if log.attitude is not None:
        q = Channel(
            log.attitude.source,
            log.attitude.times,
            smooth_signs(log.attitude.values),
            (*log.attitude.done, "between samples along the shortest turn"),
        )
        builder.add(("roll_rad", "pitch_rad", "yaw_rad"), q, hold=False, after=to_euler)
    if log.rates is not None:
        builder.add(("p_radps", "q_radps", "r_radps"), log.rates, hold=False)
    if log.velocity is not None and sensor.kind != MAGNETOMETER:
        builder.add(VELOCITY, log.velocity, hold=False)
    elif log.velocity is None and log.position is not None and sensor.kind != MAGNETOMETER:
        builder.add(("lat_deg", "lon_deg"), _part(log.position, 2), hold=False)
    for header, channel in _drivers_of(log, sensor).items():
        builder.add((header,), channel, hold=True)
    if earth is not None:
        builder.fill(earth, with_parts=log.attitude is not None)
    table = builder.finish(stamps.size - int(inside.sum()), _describe_span(start, end, "outside"))
    if not table.rows:
        raise _core.Error(
            f"{log.file}: no reading of {sensor.name} has all that goes with it at its time; "
            "--list shows the spans"
        )
    if log.labels is not None:
        table.labels = label_at(log.labels.times, log.labels.names, table.columns["time_s"])
    return table


def _drivers_of(log: Recording, sensor: Sensor) -> dict[str, Channel]:
    """Columns that may drive an effect; only a tube needs more of the air than its temperature."""
    drivers = {**log.drivers, **sensor.own}
    if sensor.kind == MAGNETOMETER:
        return {h: c for h, c in drivers.items() if h not in ("ps_pa", "rho_kgpm3")}
    if "rho_kgpm3" in drivers and "cal_air_cmodel" not in sensor.own:  # a flow's losses need it
        drivers.pop("ps_pa", None)
    return drivers


def _part(channel: Channel, count: int) -> Channel:
    return Channel(channel.source, channel.times, channel.values[:, :count], channel.done)


def _describe_span(start: float | None, end: float | None, before: str = "") -> str:
    words = [before] if before else []
    if start is not None:
        words.append(f"from {start:g} s")
    if end is not None:
        words.append(f"to {end:g} s")
    return " ".join(words)


class _Builder:
    def __init__(self, stamps: Array, needed: tuple[str, ...]) -> None:
        self._stamps, self._needed = stamps, needed
        self._table = Table({"time_s": stamps})
        self._table.told["time_s"] = {
            "source": "the sensor's stamps",
            "done": ["the log's own clock, in seconds"],
        }

    def add(
        self,
        headers: tuple[str, ...],
        channel: Channel,
        hold: bool,
        after: Callable[[Array], Array] | None = None,
    ) -> None:
        """Columns of a channel at the stamps, through `after`."""
        values, how = bring(channel, self._stamps, hold)
        if after is not None:
            values = after(values)
        if not np.isfinite(values).any():
            self._table.notes.append(f"{channel.source} has nothing at the time of these rows")
            return
        self.put(headers, values, channel.source, [*channel.done, how])

    def put(self, headers: tuple[str, ...], values: Array, source: str, done: list[str]) -> None:
        """Columns as they are."""
        for header, column in zip(headers, values.T, strict=True):
            self._table.columns[header] = np.ascontiguousarray(column)
            self._table.told[header] = {"source": source, "done": done}

    def fill(self, earth: FieldColumns, with_parts: bool) -> None:
        """The Earth's field."""
        for header, column in earth.at(self._stamps).items():
            if with_parts or header == "field_strength_ut":
                self._table.columns[header] = column
                self._table.told[header] = {"source": earth.source, "done": [*earth.done]}

    def finish(self, outside: int, where: str) -> Table:
        """The table without the rows that lack what nearly all have."""
        table = self._table
        kept = np.ones(self._stamps.size, dtype=bool)
        if outside:
            table.left_out[where] = outside
        for header, column in table.columns.items():
            known = np.isfinite(column)
            if known.mean() >= ENOUGH or header in self._needed:
                if lost := int((kept & ~known).sum()):
                    table.left_out[f"nothing for {header}"] = lost
                kept &= known
        table.columns = {header: column[kept] for header, column in table.columns.items()}
        for header, column in table.columns.items():
            if empty := int(np.isnan(column).sum()):
                table.told[header]["empty_cells"] = empty
                table.notes.append(
                    f"{header} is empty in {empty} of {column.size} rows: {_lost_use(header)}"
                )
        return table


def _lost_use(header: str) -> str:
    needed = header.partition("_")[0] in ("roll", "pitch", "yaw", "vn", "ve", "vd")
    return "--drop-invalid drops them" if needed else "it can't drive an effect"
