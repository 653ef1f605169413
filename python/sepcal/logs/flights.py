# SPDX-License-Identifier: BSD-3-Clause
"""A flight from a vehicle's log, and what was done to it."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Callable
from typing import Any, Literal

import numpy as np

from sepcal import _core
from sepcal.arguments import checked
from sepcal.flight import Flight, csv_of
from sepcal.geomagnetism.models import Date
from sepcal.logs.earth import FieldColumns, find_field
from sepcal.logs.reading import choose_sensor, open_log
from sepcal.logs.recording import MAGNETOMETER, Recording, Sensor
from sepcal.logs.table import Table, build_table
from sepcal.progress import show_steps
from sepcal.whole_files import name_of, write_whole


class LoggedFlight(Flight):
    """A flight out of a vehicle's log: columns of `sensor` and of what goes with it.

    Attributes:
        sensor: Whose readings they are, "mag0" or "pitot0".
        conversion: Steps of the conversion: the log, the sensor, UTC, the Earth's field, rows that
            were left out, and of each column its source and what was done to it. It is what stands
            beside the CSV file as JSON.

    Example:
        >>> flight = sepcal.read_log(folder / "flight.ulg")
        >>> flight.sensor, flight.conversion["rows"] == flight.rows
        ('mag0', True)
    """

    def __init__(self, file: str, sensor: Sensor, table: Table, conversion: dict[str, Any]) -> None:
        super().__init__(table.columns, table.labels or None, name=file)
        self.sensor = sensor.name
        self.conversion = conversion

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes FILE, a CSV that read_csv() and the apps read, and FILE.json, the conversion.

        Both appear whole or none does. Raises Error where they can't be written.

        Example:
            >>> flight = sepcal.read_log(folder / "flight.ulg")
            >>> flight.save(folder / "mag0.csv")
            >>> sorted(path.name for path in folder.glob("mag0.csv*"))
            ['mag0.csv', 'mag0.csv.json']
        """
        target = name_of(file)
        write_whole({target: csv_of(self), sidecar_of(target): to_json(self.conversion)})


@checked
def read_log(
    file: str | os.PathLike[str],
    sensor: str | None = None,
    *,
    start: float | None = None,
    end: float | None = None,
    date: Date | None = None,
    field: bool = True,
    cut_off: bool = False,
    progress: bool | Literal["tqdm"] | Callable[[str], None] | None = None,
) -> LoggedFlight:
    """A flight from an autopilot's own log: PX4's ULog or ArduPilot's DataFlash.

    Its rows are the readings of one sensor, at its stamps; all else is brought there, averaged
    where it was logged at least twice as fast, interpolated where not, and never across a gap. What
    the autopilot had corrected is undone from its parameters.

    Args:
        file: The log.
        sensor: "mag0", "mag1", "pitot0" (list_log() names them); None: the first.
        start: From which time on the log's clock rows are taken [s]; None: from the first.
        end: Up to which time [s]; None: to the last.
        date: The day for the Earth's field, instead of the log's: a date, a datetime (UTC),
            "2026-03-01" or a decimal year.
        field: Whether the Earth's field is filled in where positions are logged.
        cut_off: Whether a log that ends inside a message is taken for what is whole.
        progress: As in sepcal.report().

    Returns:
        LoggedFlight with columns of shape (rows,): time_s on the log's clock; of a magnetometer
        mx_ut, my_ut, mz_ut in body axes as the raw sensor read, and bn_ut, be_ut, bd_ut,
        field_strength_ut by the World Magnetic Model; of a tube dp_pa or airspeed_mps, vn_mps,
        ve_mps, vd_mps, and rho_kgpm3 or ps_pa and temp_degc; roll_rad, pitch_rad, yaw_rad;
        p_radps, q_radps, r_radps; altitude_m, temp_degc, throttle (0 to 1), current_a, voltage_v;
        each where the log has it. Labels are flight modes.

    Raises:
        Error: No such file or another format, a log cut off, an unknown sensor or one that lacks
            what its calibration needs, no reading from `start` to `end`, positions without a date,
            a day outside the field's models, no pyulog, pymavlink or pygeomag.

    Example:
        >>> flight = sepcal.read_log(folder / "flight.ulg", "mag0", end=30.0)
        >>> flight.columns[:4]
        ('time_s', 'mx_ut', 'my_ut', 'mz_ut')
    """
    with show_steps("sepcal log", progress) as told:
        return convert(open_log(name_of(file), cut_off, told), sensor, start, end, date, field)


def convert(
    log: Recording,
    name: str | None,
    start: float | None,
    end: float | None,
    date: Date | None,
    field: bool,
) -> LoggedFlight:
    """The same of a log that is open."""
    for what, limit in (("start", start), ("end", end)):
        if limit is not None and not math.isfinite(limit):
            raise _core.Error(f"{what} is {limit}; give a time in seconds")
    if start is not None and end is not None and start > end:
        raise _core.Error(
            f"{log.file}: nothing is from {start:g} to {end:g} s: the start comes after the end"
        )
    sensor = choose_sensor(log, name)
    earth = find_field(log, date) if field and sensor.kind == MAGNETOMETER else None
    with np.errstate(all="ignore"):  # of damaged numbers, which are dropped
        table = build_table(log, sensor, start, end, earth)
    return LoggedFlight(log.file, sensor, table, _tell(log, sensor, table, earth))


def to_json(conversion: dict[str, Any]) -> str:
    """The conversion as JSON's text."""
    return json.dumps(conversion, indent=2, allow_nan=False) + "\n"


def sidecar_of(file: str) -> str:
    """Where the conversion of a CSV file stands."""
    return f"{file}.json"


def _tell(
    log: Recording, sensor: Sensor, table: Table, earth: FieldColumns | None
) -> dict[str, Any]:
    times = table.columns["time_s"]
    told: dict[str, Any] = {
        "schema_version": 1,
        "log": {
            "file": log.file,
            "sha256": _sha256(log.file),
            "format": log.form,
            "vehicle": log.vehicle,
        },
        "sensor": {"name": sensor.name, "kind": sensor.kind, "title": sensor.title},
        "rows": table.rows,
        "span": {"from_s": float(times[0]), "to_s": float(times[-1])},
        "left_out": table.left_out,
        "utc": None,
        "field": None,
        "maneuver": log.labels.source if log.labels is not None else None,
        "columns": table.told,
        "notes": [*log.notes, *table.notes],
    }
    if log.utc is not None:
        told["utc"] = {"first_row": log.utc.name(float(times[0])), "source": log.utc.source}
    if earth is not None:
        field = earth.first
        told["field"] = {
            "model": field.model,
            "latitude_deg": field.latitude,
            "longitude_deg": field.longitude,
            "altitude_m": field.altitude,
            "year": field.year,
            "north_ut": field.north,
            "east_ut": field.east,
            "down_ut": field.down,
            "strength_ut": field.strength,
        }
    return told


def _sha256(file: str) -> str:
    with open(file, "rb") as opened:
        return hashlib.file_digest(opened, "sha256").hexdigest()
