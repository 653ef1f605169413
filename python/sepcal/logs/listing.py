# SPDX-License-Identifier: BSD-3-Clause
"""Lists what a log has and what can be calibrated from it."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

from sepcal import _core
from sepcal.arguments import checked
from sepcal.geomagnetism.command import describe_place, paste
from sepcal.logs.earth import find_field
from sepcal.logs.reading import find_lacking, open_log
from sepcal.logs.recording import MAGNETOMETER, Channel, Recording, Sensor
from sepcal.printing import in_shell, page_of
from sepcal.whole_files import name_of


@dataclass(frozen=True)
class LogContents:
    """The contents of a log. `print(contents)` shows the page.

    Attributes:
        sensors: Names of those that can be calibrated, "mag0", "pitot0".
        text: The page.

    Example:
        >>> contents = sepcal.list_log(folder / "flight.ulg")
        >>> contents.sensors
        ('mag0', 'pitot0')
    """

    sensors: tuple[str, ...]
    text: str
    _told: dict[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """The same as a dictionary; times in s on the log's clock, rates in Hz.

        Example:
            >>> sepcal.list_log(folder / "flight.ulg").to_dict()["format"]
            'ULog'
        """
        return self._told

    def __str__(self) -> str:
        return self.text


@checked
def list_log(file: str | os.PathLike[str], *, cut_off: bool = False) -> LogContents:
    """Sensors, channels, modes and spans of a log, and what can be calibrated from it.

    Args:
        file: The log.
        cut_off: Whether a log that ends inside a message is taken for what is whole.

    Raises:
        Error: As read_log() for a file that can't be read.

    Example:
        >>> sepcal.list_log(folder / "flight.ulg").sensors
        ('mag0', 'pitot0')
    """
    return list_recording(open_log(name_of(file), cut_off))


def list_recording(log: Recording) -> LogContents:
    """The same of a log that is open."""
    told: dict[str, Any] = {
        "file": log.file,
        "format": log.form,
        "vehicle": log.vehicle,
        "span": {"from_s": float(log.span[0]), "to_s": float(log.span[1])},
        "utc": None,
        "sensors": [_tell_sensor(log, sensor) for sensor in log.sensors],
        "channels": {name: _tell(channel) for name, channel in _channels_of(log).items()},
        "modes": _tell_modes(log),
        "field": _tell_field(log),
        "notes": list(log.notes),
    }
    if log.utc is not None:
        told["utc"] = {"start": log.utc.name(log.span[0]), "source": log.utc.source}
    names = tuple(sensor.name for sensor in log.sensors if not find_lacking(log, sensor))
    return LogContents(names, _page(told), told)


def _channels_of(log: Recording) -> dict[str, Channel]:
    channels = {
        "attitude": log.attitude,
        "body rates": log.rates,
        "velocity": log.velocity,
        "position": log.position,
        **log.drivers,
    }
    return {name: channel for name, channel in channels.items() if channel is not None}


def _tell(channel: Channel) -> dict[str, Any]:
    return {
        "source": channel.source,
        "samples": int(channel.times.size),
        "rate_hz": round(channel.rate, 3),
        "from_s": float(channel.times[0]),
        "to_s": float(channel.times[-1]),
        "done": list(channel.done),
    }


def _tell_sensor(log: Recording, sensor: Sensor) -> dict[str, Any]:
    lacking = find_lacking(log, sensor)
    return {
        "name": sensor.name,
        "kind": sensor.kind,
        "title": sensor.title,
        **_tell(sensor.readings),
        "calibrates": not lacking,
        "lacks": lacking,
    }


def _tell_modes(log: Recording) -> list[dict[str, Any]]:
    if log.labels is None:
        return []
    starts = [max(float(t), float(log.span[0])) for t in log.labels.times]
    ends = [*starts[1:], float(log.span[1])]
    return [
        {"maneuver": name, "from_s": start, "to_s": end}
        for name, start, end in zip(log.labels.names, starts, ends, strict=True)
        if end > start
    ]


def _tell_field(log: Recording) -> dict[str, Any]:
    try:
        earth = find_field(log, None)
    except _core.Error as error:
        return {"unknown": str(error).removeprefix(f"{log.file}: ")}
    if earth is None:
        return {"unknown": "no position is logged; python -m sepcal field tells it for a place"}
    field = earth.first
    return {
        "model": field.model,
        "place": f"{describe_place(field.latitude, field.longitude)}, {field.altitude:.0f} m",
        "field": paste(field),
        "strength_ut": round(field.strength, 4),
        "done": list(earth.done),
    }


def _page(told: dict[str, Any]) -> str:
    span = told["span"]
    start, end = span["from_s"], span["to_s"]
    lines = [
        f"{told['file']}: {told['format']}, {told['vehicle'] or 'vehicle unknown'}",
        f"from {start:.3f} to {end:.3f} s on its own clock, {end - start:.1f} s",
    ]
    if told["utc"] is not None:
        lines.append(f"starts {told['utc']['start']}: {told['utc']['source']}")
    else:
        lines.append("no date is logged")
    lines += [f"note: {note}" for note in told["notes"]]
    lines += ["", *_channel_table("sensor", {s["name"]: s for s in told["sensors"]})]
    lines += ["", *_channel_table("channel", told["channels"])]
    if told["modes"]:
        lines += ["", f"{'mode':<20}{'from s':>18}{'to s':>18}"]
        for mode in told["modes"]:
            lines.append(f"{mode['maneuver']:<20}{mode['from_s']:>18.3f}{mode['to_s']:>18.3f}")
    lines += ["", *_advise(told)]
    return page_of(lines)


def _channel_table(title: str, channels: dict[str, dict[str, Any]]) -> list[str]:
    lines = [f"{title:<12}{'samples':>8}{'Hz':>8}{'from s':>18}{'to s':>18}  source"]
    for name, channel in channels.items():
        lines.append(
            f"{name:<12}{channel['samples']:>8}{channel['rate_hz']:>8.3g}{channel['from_s']:>18.3f}"
            f"{channel['to_s']:>18.3f}  {channel['source']}"
        )
        if title == "sensor":
            said = [channel["title"], *channel["done"]]
            lines += [f"{'':<12}{text}" for text in said if text]
    return lines if channels else [f"no {title} is logged"]


def _advise(told: dict[str, Any]) -> list[str]:
    """Commands for what can be calibrated."""
    lines = ["can be calibrated:"]
    field = told["field"]
    for sensor in told["sensors"]:
        name = sensor["name"]
        if not sensor["calibrates"]:
            lines.append(f"  {name}: no, {sensor['lacks']} is logged")
            continue
        log = in_shell([told["file"]])
        lines.append(f"  python -m sepcal log {log} --sensor {name} -o {name}.csv, then")
        if sensor["kind"] != MAGNETOMETER:
            lines.append(f"    sepcal-pitot fit {name}.csv -o {name}_base.json")
            continue
        strength = f"{field['strength_ut']:.4f}" if "strength_ut" in field else "F"
        lines.append(f"    sepcal-mag fit {name}.csv --field-strength {strength} -o {name}.json")
        if "attitude" in told["channels"]:
            given = "" if "strength_ut" in field else " --field N,E,D"
            lines.append(
                f"    or, against attitude, sepcal-mag fit {name}.csv{given} -o {name}.json"
            )
    if not told["sensors"]:
        lines = ["nothing can be calibrated from it: no magnetometer, no pitot tube is logged"]
    elif "strength_ut" in field:
        lines.append(f"field: {field['model']} at {field['place']}: --field {field['field']}")
    else:
        lines.append(f"field: {field['unknown']}")
    return lines
